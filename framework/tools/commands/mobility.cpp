// SPDX-License-Identifier: BSD-3-Clause
// The command mobility: free motions of a scene, redundant constraints, and reactions that are not unique.
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/mobility_findings.h"

namespace lockstep {
namespace {

Result find_mobility(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  return {loaded, mobility_fields(), mobility_of(dynamics, m, m.system.start())};
}

}  // namespace

Command mobility_command() {
  return {"mobility",
          join({scene_options(), {kJson}}),
          find_mobility,
          "Counted at the assembled start, in its plane if it has one; --full counts in space. `lockstep check "
          "--verbose` prints the same, and how a run solves the scene.\n\n"
          "Example:\n  lockstep mobility samples/scenes/four_bar.json --full",
          {&mobility_fields().schema()}};
}

}  // namespace lockstep
