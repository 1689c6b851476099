// SPDX-License-Identifier: BSD-3-Clause
// The command assemble: the start of a scene on its constraints, or all ways in which it fits together.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/assembly.h>
#include <lockstep/branches.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/tree.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

struct Moved {
  Pose pose;
  double moved = 0, rotated = 0;
  std::vector<Vec3> ends{};  // of a rod
};
struct Assembled {
  AssemblyReport report;
  std::vector<std::pair<std::string, Moved>> bodies;
};

// With the ends of those that the scene gives as rods, as it would give them.
std::vector<std::pair<std::string, Moved>> moved_bodies(const System& system, Value scene, const State& from,
                                                        const State& to) {
  std::vector<std::pair<std::string, Moved>> all;
  for (const Value& given : items(scene, "bodies")) {
    const Body& body = system.body(*text_under(given, "name"));
    if (body.fixed) continue;
    const Pose a = from.slot_pose(body.slot), b = to.slot_pose(body.slot);
    Moved m{body_pose(body, to), (b.x - a.x).norm(), rotation_vector(conjugate(normalized(a.q)) * b.q).norm()};
    if (const Value* rod = given.find("rod"))
      for (const char* end : {"from", "to"})
        m.ends.push_back(
            (m.pose * inverse(body_pose(body, from)) * Pose{read_vector3(*rod->find(end), Unit::length, end), {}}).x);
    all.emplace_back(body.name, m);
  }
  return all;
}

const Fields<OpenJoint> kOpenFields{{"joint", "", "joint", &OpenJoint::joint}, {"gap", "m", "by", &OpenJoint::gap}};
const Fields<AssemblyReport> kAssemblyFields{
    {"before", "m", "constraint error of the given poses", &AssemblyReport::before},
    {"after", "m", "  after assembly", &AssemblyReport::after},
    {"before_v", "m/s", "velocity error before", &AssemblyReport::before_v, json_only},
    {"after_v", "m/s", "  after", &AssemblyReport::after_v, json_only},
    {"iterations", "", "iterations", &AssemblyReport::iterations, json_only},
    {"largest_move", "m", "largest move", &AssemblyReport::largest_move},
    {"moved_most", "", "  of", &AssemblyReport::moved_most},
    {"largest_turn", "rad", "largest rotation", &AssemblyReport::largest_turn},
    {"turned_most", "", "  of", &AssemblyReport::turned_most},
    {"open", "joints that the given poses violate", &AssemblyReport::open, kOpenFields}};
const Fields<Moved> kMovedFields =
    Fields<Moved>{{"moved", "m", "moved", &Moved::moved}, {"rotated", "rad", "rotated", &Moved::rotated}}
        .with(&Moved::pose, kPoseFields)
        .with({{"ends", "m", "rod from, to", &Moved::ends}});
const Fields<Assembled> kAssembleFields = Fields<Assembled>{}
                                              .with(&Assembled::report, kAssemblyFields)
                                              .with({{"bodies", "bodies", &Assembled::bodies, kMovedFields}});

struct Branches {
  BranchReport report;
  const System* system = nullptr;
};
struct Placed {
  const AssemblyBranch& branch;
  NamedPoses poses;
};

std::vector<Placed> placed(const Branches& b) {
  std::vector<Placed> all;
  for (const AssemblyBranch& each : b.report.branches) all.push_back({each, named_poses(*b.system, each.state)});
  return all;
}
const Fields<Placed> kPlacedFields{
    {"found", "", "starts that lead here", [](const Placed& p) { return p.branch.found; }},
    {"freedoms", "", "remaining degrees of freedom", [](const Placed& p) { return p.branch.freedoms; }},
    {"distance", "m", "", [](const Placed& p) { return p.branch.distance; }},
    {"farthest", "", "farthest from the first", [](const Placed& p) { return p.branch.farthest; }},
    {"bodies", "bodies", &Placed::poses, kPoseFields}};
const Fields<Branches> kBranchesFields{{"starts", "", "starts", [](const Branches& b) { return b.report.starts; }},
                                       {"failed", "", "  failed", [](const Branches& b) { return b.report.failed; }},
                                       {"branches", "branch", placed, kPlacedFields}};

Result show_assembled(const Arguments& args) {
  const int starts = args["--branches"].empty() ? 0 : whole_number("--branches", args["--branches"], kMostStarts);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const State given = m.system.start();
  if (starts > 0)
    return {loaded, kBranchesFields, Branches{find_branches(dynamics, given, {.starts = starts}), &m.system}};
  NearRows near;
  State state = decided_start(dynamics, m, &near);
  note_near(near.all, m.run.nearly_redundant);
  const AssemblyReport r = assemble_scene(dynamics, m, state, near);
  StepLoop run(dynamics, make_integrator(m.run, *m.methods), loop_options(m.run));
  run.set_state(state), run.run_until(state.t);  // as a run begins: it reports a start beyond a stop
  Result result(loaded, kAssembleFields, Assembled{r, moved_bodies(m.system, loaded.scene.root, given, state)});
  if (!args.has("--within") && !r.findings.empty()) result.code = kExitDoubtful;
  if (!args.has("--within")) return result;
  const double within = positive_number("--within", args["--within"], Unit::length, "0.1m");
  const double far = std::max(r.largest_move, m.system.length() * r.largest_turn);
  if (far <= within) return result;
  CommandFindings::add({&finding::start_far, "body '" + r.moved_most + "'",
                        fmt::format("the assembled start is {:.3g} m from the given one (limit {:g} m; rotations times "
                                    "the length of the mechanism)",
                                    far, within),
                        "", far, within, "m"});
  result.code = kExitDoubtful;
  return result;
}

}  // namespace

Command assemble_command() {
  return {"assemble",
          join({scene_options(),
                {kJson,
                 {"--branches", "N", "find all assemblies of a driven scene from N random starts"},
                 Option{"--within", "D",
                        "exit code 11 if a body moves farther than D (rotations times the length of the mechanism); "
                        "default: if assembly gives a warning"}
                     .without("--branches")}}),
          show_assembled,
          "Example:\n  lockstep assemble samples/scenes/four_bar.json",
          {&kAssembleFields.schema(), &kBranchesFields.schema()}};
}

}  // namespace lockstep
