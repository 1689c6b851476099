// SPDX-License-Identifier: BSD-3-Clause
// The verb mobility: how a scene can move, which of its rows are too many, and which reactions are not unique.
#include <spdlog/fmt/fmt.h>

#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/mobility_findings.h"

namespace lockstep {

int mobility_command(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const MobilityFindings found = mobility_of(dynamics, m, m.system.start());
  if (args.has("--json")) {
    nlohmann::ordered_json j = {{"scene", loaded.scene.file}, {"title", loaded.scene.title}};
    put_mobility(j, found, m.run);
    print_result(j);
    return kExitOk;
  }
  fmt::print("{}\n", loaded.title());
  if (const Plane plane = m.system.plane())
    fmt::print("  plane               normal {}; rows out of it are left out (--full counts them too)\n",
               "xyz"[plane.n]);
  print_freedoms(found);
  fmt::print("  rank                {}\n", found.mobility.rank);
  print_dependencies(found, m.run);
  if (found.mobility.redundant == 0 && found.reactions.all_unique())
    fmt::print("  redundant rows      none: all reactions are unique\n");
  return kExitOk;
}

}  // namespace lockstep
