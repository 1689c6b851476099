// SPDX-License-Identifier: BSD-3-Clause
// The verb assemble.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include <lockstep/assembly.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {

int assemble_command(const Arguments& args) {
  if (!args["--branches"].empty()) return branches_command(args);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State state = m.system.start();
  const AssemblyReport r = assemble(dynamics, state, m.start_speeds, m.assembly);
  nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
  if (!args.has("--json")) fmt::print("{}\n  assembled  {}\n", loaded.title(), r.text());
  for (const Body& body : m.system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    bodies[body.name] = {{"position", {at.x[0], at.x[1], at.x[2]}}, {"orientation", {at.q.w, at.q.x, at.q.y, at.q.z}}};
    if (!args.has("--json"))
      fmt::print("  {:<14} at [{}, {}, {}] m, orientation [{}, {}, {}, {}]\n", body.name, at.x[0], at.x[1], at.x[2],
                 at.q.w, at.q.x, at.q.y, at.q.z);
  }
  const nlohmann::ordered_json report = {{"before", r.before},           {"after", r.after},
                                         {"before_v", r.before_v},       {"after_v", r.after_v},
                                         {"iterations", r.iterations},   {"largest_move", r.largest_move},
                                         {"moved_most", r.moved_most},   {"largest_turn", r.largest_turn},
                                         {"turned_most", r.turned_most}, {"bodies", bodies}};
  const double far = std::max(r.largest_move, m.system.length() * r.largest_turn);
  const double within = args.has("--within") ? positive_number("--within", args["--within"], Unit::length, "0.1m")
                                             : std::numeric_limits<double>::infinity();
  const Finding found{
      &finding::start_far,
      "body '" + r.moved_most + "'",
      fmt::format("the assembled start is {:.3g} m from the one given (turns by the length of the mechanism), beyond "
                  "{:g} m: moved '{}' by {:.3g} m, turned '{}' by {:.3g} rad",
                  far, within, r.moved_most, r.largest_move, r.turned_most, r.largest_turn),
      "",
      far,
      within,
      "m"};
  if (far > within) CommandFindings::add(found);
  if (args.has("--json")) print_result(report);
  if (!args.has("--within")) return r.findings.empty() ? kExitOk : kExitDoubtful;
  if (far <= within) return kExitOk;
  fmt::print(stderr, "lockstep: --within: {}\n", found.text());
  return kExitDoubtful;
}

}  // namespace lockstep
