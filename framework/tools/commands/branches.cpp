// SPDX-License-Identifier: BSD-3-Clause
// The option --branches of the command assemble: all ways in which a scene fits together.
#include <lockstep/branches.h>
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr int kMostStarts = 1'000'000;

struct Branches {
  BranchReport report;
  const System* system = nullptr;
};
struct Placed {
  const AssemblyBranch& branch;
  NamedPoses poses;
};

const Fields<Branches>& branch_fields() {
  const auto placed = [](const Branches& b) {
    std::vector<Placed> all;
    for (const AssemblyBranch& each : b.report.branches) all.push_back({each, poses_of(*b.system, each.state)});
    return all;
  };
  static const Fields<Placed> kPlaced{
      {"found", "", "found by starts", [](const Placed& p) { return p.branch.found; }},
      {"freedoms", "", "freedoms, of which this is one position", [](const Placed& p) { return p.branch.freedoms; }},
      {"distance", "m", "from the first, turns by the length of the mechanism",
       [](const Placed& p) { return p.branch.distance; }},
      {"farthest", "", "most of all", [](const Placed& p) { return p.branch.farthest; }},
      {"bodies", "bodies", &Placed::poses, pose_fields()}};
  static const Fields<Branches> kFields{
      {"starts", "", "starts", [](const Branches& b) { return b.report.starts; }},
      {"failed", "", "led nowhere", [](const Branches& b) { return b.report.failed; }},
      {"branches", "branch", placed, kPlaced}};
  return kFields;
}

}  // namespace

const Schema& branch_schema() { return branch_fields().schema(); }

Result find_all_branches(const Arguments& args) {
  const int starts = whole_number("--branches", args["--branches"], kMostStarts);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  return {loaded, branch_fields(), Branches{find_branches(dynamics, m.system.start(), {.starts = starts}), &m.system}};
}

}  // namespace lockstep
