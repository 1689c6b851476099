#include <lockstep/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/tools/check/lock_check.h"
#include "framework/tools/check/sample_system.h"
#include <lockstep/error.h>

namespace lockstep {

CheckReport check_lock(System& system, const Lock& link, const CheckOptions& options) {
  const auto& all = system.links();
  if (std::none_of(all.begin(), all.end(), [&](const auto& l) { return l.get() == &link; }))
    throw ModelError(fmt::format("check_lock: link '{}' is not in the system; add it by System::add", link.name()));
  CheckReport report(fmt::format("link '{}' ({})", link.name(), link.type()), options.seed);
  try {
    system.setup();
  } catch (const UserCodeError& error) {  // it writes where it must not: no use to look further
    report.add("setup", {error.what(), "what it says"});
    return report;
  }
  LockCheck(system, link, nullptr, report, options).run();
  return report;
}

CheckReport check_lock(const Registry& registry, const std::string& type, const Params& params,
                       const CheckOptions& options) {
  CheckReport report(fmt::format("link type '{}'", type), options.seed);
  for (const SampleKind kind : kAllSamples) {
    SampleSystem sample(kind, options);
    System& system = sample.system;
    std::vector<Lock*> links;
    try {
      for (const char* name : {"first", "second"})  // two, for the test of groups
        links.push_back(&system.add(
            registry.links.make(type, sample.attachment(name), params, &registry, fmt::format("link '{}'", name))));
      system.setup();
    } catch (const UserCodeError& error) {
      report.add("setup", {error.what(), "what it says"});
      break;
    } catch (const ModelError& error) {
      if (kind == SampleKind::moving) throw;
      report.note(fmt::format("not tried with {}: {}", words_of(kind), error.what()));
      continue;
    }
    CheckReport one(report.subject(), options.seed);
    LockCheck(system, *links[0], links[1], one, options).run();
    report.take(one);
    if (one.ok()) continue;
    report.note(fmt::format("the first findings came with {}", words_of(kind)));
    break;
  }
  return report;
}

}  // namespace lockstep
