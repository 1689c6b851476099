// The option --branches of the verb assemble: all ways in which a scene fits together.
#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include <lockstep/branches.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/pose_columns.h"
#include "framework/tools/sweep/scene_run.h"

namespace lockstep {
namespace {

int starts_of(const std::string& text) {
  constexpr int kMost = 1'000'000;
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n < 1 || n > kMost)
    throw UsageError("--branches: \"" + text + "\" is no number of starts from 1 to 1000000; take 200");
  return n;
}

}  // namespace

int branches_command(const Arguments& args) {
  const int starts = starts_of(args.branches);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const BranchReport report = find_branches(dynamics, m.system.start(), {.starts = starts});
  if (args.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const AssemblyBranch& b : report.branches)
      all.push_back({{"found", b.found},
                     {"distance", b.distance},
                     {"farthest", b.farthest},
                     {"bodies", pose_json(m.system, b.state)}});
    fmt::print(
        "{}\n",
        nlohmann::ordered_json({{"starts", report.starts}, {"failed", report.failed}, {"branches", all}}).dump(1, ' '));
    return kExitOk;
  }
  fmt::print("{}\n  branches   {}, from {} starts, of which {} led nowhere\n", loaded.title(), report.branches.size(),
             report.starts, report.failed);
  int number = 0;
  for (const AssemblyBranch& b : report.branches) {
    fmt::print("branch {}, found {} times{}:\n{}", ++number, b.found,
               b.distance > 0 ? fmt::format(", '{}' is {:.3g} m from the first (turns by the length of the mechanism)",
                                            b.farthest, b.distance)
                              : ", that of the start",
               pose_text(m.system, b.state));
  }
  return kExitOk;
}

}  // namespace lockstep
