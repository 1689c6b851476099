#include <lockstep/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/tools/check/force_check.h"
#include "framework/tools/check/sample_system.h"
#include <lockstep/joints.h>
#include <lockstep/error.h>

namespace lockstep {

CheckReport check_force(System& system, const Force& force, const CheckOptions& options) {
  const auto& all = system.forces();
  if (std::none_of(all.begin(), all.end(), [&](const auto& f) { return f.get() == &force; }))
    throw ModelError(fmt::format("check_force: force '{}' is not in the system; add it by System::add", force.name()));
  CheckReport report(fmt::format("force '{}' ({})", force.name(), force.type()), options.seed);
  try {
    system.setup();
  } catch (const UserCodeError& error) {  // it writes where it must not: no use to look further
    report.add("setup", {error.what(), "what it says"});
    return report;
  }
  ForceCheck(system, force, report, options).run();
  return report;
}

CheckReport check_force(const Registry& registry, const std::string& type, const Params& params,
                        const CheckOptions& options) {
  CheckReport report(fmt::format("force type '{}'", type), options.seed);
  for (const SampleKind kind : kAllSamples) {
    SampleSystem sample(kind, options);
    Attachment attachment = sample.attachment("tried");
    Force* made = nullptr;
    try {
      attachment.link = &sample.system.add<Revolute>("hinge", attachment.p(), attachment.s());  // for forces that act in a link
      made = &sample.system.add(registry.forces.make(type, attachment, params, &registry, "force 'tried'"));
      sample.system.setup();
    } catch (const UserCodeError& error) {
      report.add("setup", {error.what(), "what it says"});
      break;
    } catch (const ModelError& error) {
      if (kind == SampleKind::moving) throw;
      report.note(fmt::format("not tried with {}: {}", words_of(kind), error.what()));
      continue;
    }
    const Force& force = *made;
    if (kind == SampleKind::p_on_ground && force.slots().empty()) continue;  // it acts at P alone
    CheckReport one(report.subject(), options.seed);
    ForceCheck(sample.system, force, one, options).run();
    report.take(one);
    if (one.ok()) continue;
    report.note(fmt::format("the first findings came with {}", words_of(kind)));
    break;
  }
  return report;
}

}  // namespace lockstep
