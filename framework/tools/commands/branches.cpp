// SPDX-License-Identifier: BSD-3-Clause
// The option --branches of the verb assemble: all ways in which a scene fits together.
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include <lockstep/branches.h>
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
constexpr int kMostStarts = 1'000'000;

int branches_command(const Arguments& args) {
  const int starts = whole_number("--branches", args["--branches"], kMostStarts);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const BranchReport report = find_branches(dynamics, m.system.start(), {.starts = starts});
  if (args.has("--json")) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const AssemblyBranch& b : report.branches)
      all.push_back({{"found", b.found},
                     {"freedoms", b.freedoms},
                     {"distance", b.distance},
                     {"farthest", b.farthest},
                     {"bodies", pose_json(m.system, b.state)}});
    print_result(nlohmann::ordered_json({{"starts", report.starts}, {"failed", report.failed}, {"branches", all}}));
    return kExitOk;
  }
  fmt::print("{}\n  branches   {}, from {} starts, of which {} led nowhere\n", loaded.title(), report.branches.size(),
             report.starts, report.failed);
  int number = 0;
  for (const AssemblyBranch& b : report.branches) {
    fmt::print("branch {}, found {} times{}{}:\n{}", ++number, b.found,
               b.freedoms > 0 ? fmt::format(", loose: {} freedom{} here, of which this is one position", b.freedoms,
                                            b.freedoms == 1 ? "" : "s")
                              : "",
               b.distance > 0 ? fmt::format(", '{}' is {:.3g} m from the first (turns by the length of the mechanism)",
                                            b.farthest, b.distance)
                              : ", that of the start",
               pose_text(m.system, b.state));
  }
  return kExitOk;
}

}  // namespace lockstep
