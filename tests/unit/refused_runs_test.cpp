// SPDX-License-Identifier: BSD-3-Clause
// Runs in C++ that cannot be meant: settings, states and events are refused by name, value, limit and next move.
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/assembly.h>
#include <lockstep/author/passes.h>
#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/chain.h"
#include "tests/support/messages.h"
#include "tests/support/refusals.h"

namespace refused_runs_test {

using namespace lockstep;
using lockstep::testing::check_refusals, lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A door that is fixed to a wall, which hangs on a hinge: fixed links are merged.
void add_door(System& system) {
  Body& wall = system.add_body("wall", shapes::box(1, {1, 1, 1}));
  Body& door = system.add_body("door", shapes::box(1, {1, 1, 1}));
  system.add<Revolute>("hinge", wall, system.ground(), Pose{});
  system.add<Fixed>("bolt", door, wall, Pose{});
  system.set_merge(true);
}

/// Runs until 1 s with an event that has this effect at 0.5 s.
void run_with(Event event) {
  System system;
  add_door(system);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  event.at = 0.5;
  loop.add_event(event);
  loop.run_until(1);
}

}  // namespace

TEST_CASE("an event rejects merged joints, and changes that it may not make", "[unit][refusals]") {
  check_refusals({
      {"a merged link",
       [] { run_with({.name = "e", .deactivate = {"bolt"}}); },
       {"event 'e'", "joint 'bolt' is merged into one rigid group and cannot be switched",
        "set_merge(true, {&joint})"}},
      {"the time",
       [] { run_with({.name = "e", .change = [](State& state) { state.t = 0.25; }}); },
       {"event 'e'", "set the time from 0.5 s to 0.25 s", "only coordinates"}},
      {"what is in force",
       [] { run_with({.name = "e", .change = [](State& state) { state.modes[0] = false; }}); },
       {"event 'e'", "switched joint 'hinge' at t = 0.5 s", "deactivate"}},
      {"sizes",
       [] { run_with({.name = "e", .change = [](State& state) { state.v.resize(3); }}); },
       {"event 'e'", "at t = 0.5 s left 3 velocities instead of 6"}},
  });
}

TEST_CASE("a grid and a recorded run reject late and excessive data", "[unit][refusals]") {
  System system;
  add_door(system);
  Simulation run(system);
  run.record({"door.x"});
  run.run_until(0.1);
  check_refusals({
      {"columns",
       [&] { run.record({"door.y"}); },
       {"record() after the start of the run", "directly after the Simulation is made"}},
      {"runs",
       [] {
         Grid({100'000, 100'000});
       },
       {"the grid has more than 1000000000 runs", "use fewer values"}},
  });
}

namespace {

/// A hinge that is driven by its speed.
struct Driven {
  System system;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  Revolute& hinge = system.add<Revolute>("hinge", body, system.ground(), Pose{});
  Driven() { hinge.drive_speed(Axis::rz, laws::constant(1)); }
  Dynamics dynamics(Formulation formulation = Formulation::omega, const Stabilization& stabilization = {}) {
    return {system, std::make_unique<SchurSolver>(), {formulation, stabilization}};
  }
};

void loop_with(const StepLoopOptions& options) {
  Driven driven;
  Dynamics dynamics = driven.dynamics();
  const StepLoop loop(dynamics, std::make_unique<Dopri5>(), options);
}

}  // namespace

TEST_CASE("a state of another size is rejected by every function, not written past", "[unit][refusals]") {
  Driven driven;
  driven.system.setup();
  const auto cut = GENERATE(0, 1, 2, 3, 4);
  CAPTURE(cut);
  State wrong = driven.system.start();
  if (cut == 0) wrong.q.conservativeResize(3);
  if (cut == 1) wrong.v.conservativeResize(2);
  if (cut == 2) wrong = State{};
  if (cut == 3) wrong.s.resize(0);
  if (cut == 4) wrong.modes.clear();
  Dynamics dynamics = driven.dynamics(), joint = driven.dynamics(Formulation::joint);
  const std::vector<std::string> words{"a state of", "does not fit"};
  const auto refused = [&](const char* what, auto&& call) {
    INFO(what);
    State s = wrong;
    check_words(message_of<ModelError>([&] { call(s); }), words);
  };
  refused("assemble", [&](State& s) { assemble(dynamics, s); });
  refused("project", [&](State& s) { dynamics.project(s); });
  refused("project_velocity", [&](State& s) { dynamics.project_velocity(s); });
  refused("normalize", [&](State& s) { dynamics.normalize(s); });
  refused("advance", [&](State& s) { dynamics.advance(s, 0.1, driven.system.start().v); });
  refused("accept", [&](State& s) { dynamics.accept(s); });
  refused("to_slots", [&](State& s) { dynamics.to_slots(s); });
  refused("to_formulation", [&](State& s) { joint.to_formulation(s); });
  refused("evaluate", [&](State& s) { dynamics.evaluate(s); });
  refused("inputs", [&](State& s) { dynamics.inputs(s); });
  refused("violation_of_closures", [&](State& s) { dynamics.violation_of_closures(s); });
  refused("set_state", [&](State& s) { StepLoop(dynamics, std::make_unique<Dopri5>()).set_state(s); });
  for (const char* name : {"dopri5", "dop853", "rk4", "radau5", "generalized_alpha", "semi_implicit_euler"}) {
    const std::unique_ptr<Integrator> method = make_integrator({name}, builtin_registry(), "test");
    refused(name, [&](State& s) { method->begin(dynamics, s); });
    method->begin(dynamics, driven.system.start());
    refused(name, [&](State& s) { method->step(dynamics, s, 1e-3); });
  }
}

TEST_CASE("passes over a system and poses of bodies reject vectors and states of another size", "[unit][refusals]") {
  const auto in = GENERATE(Formulation::omega, Formulation::joint);
  Driven driven;
  Body& door = driven.system.add_body("door", shapes::box(1, {1, 1, 1}));
  driven.system.add<Revolute>("free", door, driven.system.ground(), Pose{});
  Dynamics dynamics = driven.dynamics(in);
  State right = driven.system.start();
  dynamics.to_formulation(right);
  REQUIRE((right.coordinates != nullptr) == (in == Formulation::joint));
  State short_q = right, short_v = right;
  short_q.q.conservativeResize(right.q.size() - 1);
  short_v.v.conservativeResize(right.v.size() - 1);
  const Inputs& inputs = dynamics.inputs(right);
  std::vector<Motion> motions;
  RowTable rows;
  VecX none;
  State no_memory = right;
  no_memory.z = VecX::Zero(right.z.size() + 1);
  const Solution& solution = dynamics.evaluate(right);
  const std::vector<std::string> counted{"numbers, but", "are needed", "System::start()"},
      holds{"does not hold body 'door'", "System::start()"};
  check_refusals({
      {"motions, q", [&] { passes::motions(driven.system, short_q, motions); }, counted},
      {"motions, v", [&] { passes::motions(driven.system, short_v, motions); }, counted},
      {"rows", [&] { passes::lay_out(driven.system, {}, rows); }, counted},
      {"forces", [&] { passes::gather_forces(driven.system, inputs, none); }, counted},
      {"sums of forces", [&] { passes::check_forces(driven.system, inputs, none); }, counted},
      {"rates", [&] { passes::state_rates(driven.system, solution, none); }, counted},
      {"memory", [&] { passes::accept(driven.system, inputs, no_memory); }, counted},
      {"a pose, q", [&] { body_pose(door, short_q); }, holds},
      {"a pose, v", [&] { body_pose(door, short_v); }, holds},
      {"a twist", [&] { body_twist(door, State{}); }, holds},
      {"to set a twist",
       [&] {
         State s;
         StateEditor(s).set_twist(door, {});
       },
       holds},
  });
  Dopri5 method;
  method.begin(dynamics, right);
  check_words(message_of<ModelError>([&] { method.first_step(dynamics, short_v, 1); }), {"does not fit"});
}

TEST_CASE("a run rejects impossible settings and states", "[unit][refusals]") {
  Driven driven;
  Dynamics dynamics = driven.dynamics();
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  State no_number = driven.system.start();
  no_number.s[0] = kNaN;
  check_refusals({
      {"a step", [] { loop_with({.step = -1}); }, {"the step of -1 s", "greater than 0"}},
      {"an output", [] { loop_with({.output = -1}); }, {"the output interval of -1 s", "greater than 0"}},
      {"a tolerance",
       [] {
         loop_with({.tolerance = {-1, 0}});
       },
       {"the tolerance is -1", "must be greater than 0"}},
      {"times",
       [] {
         loop_with({.output_times = {1, 0.5}});
       },
       {"the output times must be finite and ascending", "sort them"}},
      {"one step", [&] { loop.step(-1); }, {"a step of -1 s must be greater than 0"}},
      {"a state", [&] { loop.set_state(no_number); }, {"StepLoop::set_state", "an integrated state", "is not finite"}},
      {"a tolerance of an event",
       [&] { loop.add_event({.name = "e", .at = 1, .tolerance = 0, .stop = true}); },
       {"event 'e': its tolerance of 0 s must be greater than 0"}},
      {"a change",
       [] { run_with({.name = "e", .change = [](State& state) { state.q[0] = kNaN; }}); },
       {"event 'e' made the state not finite at t = 0.5 s"}},
      {"a condition",
       [] {
         System own;
         add_door(own);
         Dynamics of_own(own, std::make_unique<SchurSolver>());
         StepLoop run(of_own, std::make_unique<Dopri5>());
         run.add_event({.name = "e", .value = [](const Sample&) { return kNaN; }, .stop = true});
         run.run_until(1);
       },
       {"the condition of event 'e' is nan", "must be a finite number"}},
      {"rates",
       [&] { Driven().dynamics(Formulation::omega, {.kind = Stabilization::Kind::baumgarte, .alpha = -1}); },
       {"stabilisation: alpha -1", "alpha and beta must be 0 or more"}},
      {"a formulation", [] { formulation_from("omegas"); }, {"unknown formulation 'omegas'", "omega"}},
      {"coordinates",
       [] {
         const auto one = test::chain(1);
         Dynamics along(*one, std::make_unique<SchurSolver>(), {Formulation::joint, {}});
         State state = one->start();
         along.to_formulation(state);
         StateRate rate;
         along.rate(state, rate);
       },
       {"Dynamics::rate", "body coordinates", "call rates()"}},
  });
}

}  // namespace refused_runs_test
