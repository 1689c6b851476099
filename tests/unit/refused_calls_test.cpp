// Calls in C++ that cannot be meant: each is refused by name, value, limit and next move.
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/batch.h>
#include <lockstep/charts.h>
#include <lockstep/check.h>
#include <lockstep/couplings.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/params.h>
#include <lockstep/recorder.h>
#include <lockstep/registry.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include <lockstep/step_loop.h>
#include "framework/mechanism/params/read.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/load_cell.h"
#include "tests/support/messages.h"

namespace refused_calls_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

/// A call, and words that its error has.
struct Refused {
  const char* what;
  std::function<void()> call;
  std::vector<std::string> words;
};

void check_refusals(const std::vector<Refused>& all) {
  for (const Refused& one : all) {
    INFO(one.what);
    check_words(message_of<Error>(one.call), one.words);
  }
}

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

void make_copies(const std::function<void(CopiesOptions&)>& change) {
  test::Family family(2, [](int k) { return test::chain(1, k); });
  CopiesOptions options;
  change(options);
  const Copies copies(family.pointers(), options);
}

/// Two columns and two rows.
MapSpec map_with(const std::function<void(MapSpec&)>& change) {
  MapSpec map;
  map.title = "a map", map.x = map.y = {1, 2};
  map.cells = {1, 2, 3, 4};
  change(map);
  return map;
}
void draw(const std::function<void(MapSpec&)>& change) { write_map("nothing", map_with(change)); }

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("a mechanism refuses what is not there", "[unit][refusals]") {
  System system;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  Revolute& hinge = system.add<Revolute>("hinge", body, system.ground(), Pose{});
  check_refusals({
      {"no link", [&] { system.add(std::unique_ptr<Lock>()); }, {"no link was given", "make one first"}},
      {"no force", [&] { system.add(std::unique_ptr<Force>()); }, {"no force was given", "make one first"}},
      {"no state", [&] { system.add(std::unique_ptr<Auxiliary>()); }, {"no auxiliary was given", "make one first"}},
      {"no solver", [&] { Dynamics(system, nullptr); }, {"dynamics: no solver was given", "SparseSolver"}},
      {"no law", [&] { hinge.drive(Axis::rz, nullptr); }, {"link 'hinge'", "drive on rz", "has no law", "give it one"}},
      {"a row twice", [] { mask_from("x y x"); }, {"mask", "names row \"x\" twice", "name each row once"}},
  });
}

TEST_CASE("an event refuses links that are merged, and changes that it may not make", "[unit][refusals]") {
  check_refusals({
      {"a merged link",
       [] { run_with({.name = "e", .deactivate = {"bolt"}}); },
       {"event 'e'", "link 'bolt' is merged into one slot and cannot be switched", "set_merge(true, {&link})"}},
      {"the time",
       [] { run_with({.name = "e", .change = [](State& state) { state.t = 0.25; }}); },
       {"event 'e'", "set the time from 0.5 s to 0.25 s", "it may change coordinates"}},
      {"what is in force",
       [] { run_with({.name = "e", .change = [](State& state) { state.modes[0] = false; }}); },
       {"event 'e'", "switched link 'hinge' at t = 0.5 s", "deactivate"}},
      {"sizes",
       [] { run_with({.name = "e", .change = [](State& state) { state.v.resize(3); }}); },
       {"event 'e'", "at t = 0.5 s left 3 velocities where there were 6"}},
  });
}

TEST_CASE("parameters refuse laws that nobody can make, numbers that are none and empty choices", "[unit][refusals]") {
  const TypeInfo with_law{"driven", "", {{"law", Form::law, Unit::any, kRequired, ""}}};
  const TypeInfo no_choice{"chosen", "", {{"how", Form::choice, Unit::none, kRequired, ""}}};
  check_refusals({
      {"a law",
       [&] {
         Params(Value::object({{"law", 1.0}}), with_law, "link 'A'").law("law");
       },
       {"link 'A', law", "nothing here can make laws", "pass a registry"}},
      {"a choice",
       [&] { check_type_info(no_choice); },
       {"type 'chosen', key 'how'", "a choice without choices", "list them"}},
      {"a number",
       [] { read_number(Value(kNaN), Unit::none, "stiffness"); },
       {"stiffness", "the number is nan", "a finite one"}},
  });
}

TEST_CASE("laws by points refuse what does not close", "[unit][refusals]") {
  const SplineSettings closed{.ends = SplineEnds::periodic};
  check_refusals({
      {"a curve",
       [&] {
         laws::spline({{0, 1}, {1, 2}, {2, 1.5}}, closed);
       },
       {"spline", "points end 0.5 away from where they start", "the last must equal the first"}},
      {"repeat",
       [] {
         laws::spline({{0, 1}, {1, 2}}, {.outside = SplineOutside::repeat});
       },
       {"outside is \"repeat\"", "needs periodic ends", "\"hold\""}},
      {"turns",
       [&] {
         laws::spline_rotation({{0, {}}, {1, {1, 1, 0, 0}}, {2, {1, 0.1, 0, 0}}}, closed);
       },
       {"points end", "rad away from where they start", "the last must equal the first"}},
  });
}

TEST_CASE("copies refuse options that cannot be", "[unit][refusals]") {
  check_refusals({
      {"a step below zero",
       [] { make_copies([](CopiesOptions& o) { o.step = -1; }); },
       {"copies: step -1 s", "none is negative"}},
      {"no step",
       [] { make_copies([](CopiesOptions& o) { o.integrator = "rk4"; }); },
       {"copies: step 0 s", "rk4 needs a step above zero"}},
      {"tolerances",
       [] { make_copies([](CopiesOptions& o) {
              o.tolerance = {0, 0};
            }); },
       {"copies: tolerances 0 and 0", "one of them above zero"}},
      {"Baumgarte",
       [] { make_copies([](CopiesOptions& o) { o.stabilization.kind = Stabilization::Kind::baumgarte; }); },
       {"no lanes for Baumgarte's stabilisation", "take project or none"}},
      {"tolerance of the constraints",
       [] { make_copies([](CopiesOptions& o) { o.stabilization.tolerance = 0; }); },
       {"copies: tolerance of the constraints 0 m", "above zero"}},
      {"no mechanism",
       [] {
         const auto one = test::chain(1, 0);
         const Copies copies({one.get(), nullptr});
       },
       {"copy 1 is null", "give a mechanism"}},
      {"rates",
       [] {
         test::Family family(2, [](int k) { return test::chain(1, k); });
         Copies copies(family.pointers());
         std::vector<StateRate> rates(1);
         copies.rate(family.starts(), rates);
       },
       {"copies: as many rates as states are wanted"}},
  });
}

TEST_CASE("pictures refuse what cannot be drawn", "[unit][refusals]") {
  check_refusals({
      {"one column",
       [] { draw([](MapSpec& m) { m.x = {1}; }); },
       {"map \"a map\"", "1 columns and 2 rows", "at least two"}},
      {"cells",
       [] { draw([](MapSpec& m) {
              m.cells = {1, 2, 3};
            }); },
       {"3 cells for 2 x 2 centres", "give one a centre"}},
      {"falling", [] { draw([](MapSpec& m) {
                         m.y = {2, 1};
                       }); }, {"the centres along y must rise"}},
      {"a logarithm",
       [] { draw([](MapSpec& m) {
              m.x = {0, 1}, m.log_x = true;
            }); },
       {"along x must rise from above zero"}},
      {"nothing",
       [] { draw([](MapSpec& m) {
              m.cells = {kNaN, kNaN, kNaN, kNaN};
            }); },
       {"has no cell to draw", "give it numbers"}},
      {"a kind",
       [] { draw([](MapSpec& m) {
              m.kinds = {{"good", ""}, {"bad", ""}};
            }); },
       {"a cell of kind 4", "the kinds are 0 to 1"}},
      {"bars",
       [] {
         write_bars("nothing", {"bars", "y", {"a", "b"}, {{"one", {1}}}});
       },
       {"bars \"bars\"", "group \"one\" has 1 values for 2 categories", "give one each"}},
      {"no file",
       [] { write_map("", map_with([](MapSpec&) {})); },
       {"cannot write a chart to \"\"", "give a file name"}},
      {"no runs",
       [] { integrators_chart({}, "costs", {}, CostKind::cpu); },
       {"chart \"costs\" has no runs", "give it more time (--budget)"}},
  });
}

TEST_CASE("a grid and a recorded run refuse what comes too late or is too much", "[unit][refusals]") {
  System system;
  add_door(system);
  Simulation run(system);
  run.record({"door.x"});
  run.run_until(0.1);
  check_refusals({
      {"columns", [&] { run.record({"door.y"}); }, {"record() after the run began", "before run_until()"}},
      {"runs",
       [] {
         Grid({100'000, 100'000});
       },
       {"the grid has more than 1000000000 runs", "take fewer values"}},
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

TEST_CASE("a state of another size is refused by whoever takes one, not written past", "[unit][refusals]") {
  Driven driven;
  driven.system.setup();
  const auto cut = GENERATE(0, 1, 2);
  CAPTURE(cut);
  State wrong = driven.system.start();
  if (cut == 0) wrong.q.conservativeResize(3);
  if (cut == 1) wrong.v.conservativeResize(2);
  if (cut == 2) wrong = State{};
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
  if (cut < 2) refused("normalize", [&](State& s) { dynamics.normalize(s); });
  if (cut == 0) refused("advance", [&](State& s) { dynamics.advance(s, 0.1, driven.system.start().v); });
  if (cut < 2) refused("to_formulation", [&](State& s) { joint.to_formulation(s); });
  refused("set_state", [&](State& s) { StepLoop(dynamics, std::make_unique<Dopri5>()).set_state(s); });
  for (const char* name : {"dopri5", "dop853", "rk4", "radau5", "generalized_alpha", "semi_implicit_euler"}) {
    const std::unique_ptr<Integrator> method = make_integrator({name}, builtin_registry(), "test");
    refused(name, [&](State& s) { method->begin(dynamics, s); });
    method->begin(dynamics, driven.system.start());
    refused(name, [&](State& s) { method->step(dynamics, s, 1e-3); });
  }
}

TEST_CASE("a run refuses settings and states that cannot be", "[unit][refusals]") {
  Driven driven;
  Dynamics dynamics = driven.dynamics();
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  State no_number = driven.system.start();
  no_number.s[0] = kNaN;
  check_refusals({
      {"a step", [] { loop_with({.step = -1}); }, {"the step of -1 s", "> 0"}},
      {"an output", [] { loop_with({.output = -1}); }, {"the output interval of -1 s", "> 0"}},
      {"a tolerance",
       [] {
         loop_with({.tolerance = {-1, 0}});
       },
       {"the tolerance (relative -1, absolute 0 m)", "> 0"}},
      {"times",
       [] {
         loop_with({.output_times = {1, 0.5}});
       },
       {"the output times must be finite and rising", "sort them"}},
      {"one step", [&] { loop.step(-1); }, {"a step of -1 s must be > 0"}},
      {"a state", [&] { loop.set_state(no_number); }, {"StepLoop::set_state", "an integrated state", "is not finite"}},
      {"a tolerance of an event",
       [&] { loop.add_event({.name = "e", .at = 1, .tolerance = 0, .stop = true}); },
       {"event 'e': its tolerance of 0 s must be > 0"}},
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
       {"stabilisation: alpha -1", "must not be negative"}},
      {"a formulation", [] { formulation_from("omegas"); }, {"there is no formulation 'omegas'", "omega"}},
      {"coordinates",
       [] {
         test::Family family(1, [](int k) { return test::chain(1, k); });
         Dynamics along(*family.systems[0], std::make_unique<SchurSolver>(), {Formulation::joint, {}});
         State state = family.starts()[0];
         along.to_formulation(state);
         StateRate rate;
         along.rate(state, rate);
       },
       {"Dynamics::rate", "slots' own coordinates", "call rates()"}},
  });
}

namespace {

/// A link of the user's own with a state: of which it forgets the start, or that touches no body.
class Careless final : public Lock, public Stateful {
 public:
  Careless(std::string name, Marker& p, Marker& s, bool touches)
      : Lock(std::move(name)), p_(&p), s_(&s), touches_(touches) {}
  std::string_view type() const override { return "careless"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  RowPlan plan_rows() override {
    RowPlan plan;
    plan.add({RowKind::function, "row"});
    if (touches_) plan.slots.add(p_->body->slot);
    return plan;
  }
  void gather(Group, const Inputs&, RowSpan) const override {}
  const Stateful* stateful() const override { return this; }
  int n_states() const override { return 1; }
  void start_states(std::span<double>) const override {}
  void state_rates(const Inputs&, std::span<double> rates) const override { rates[0] = 0; }

 private:
  Marker *p_, *s_;
  bool touches_;
};

void set_up_careless(bool touches) {
  System system;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  system.add<Careless>("careless", system.add_marker("p", body), system.add_marker("s", system.ground()), touches);
  system.setup();
}

}  // namespace

TEST_CASE("a link of the user's own that forgets a number or its bodies is refused by name", "[unit][refusals]") {
  check_refusals({
      {"a start",
       [] { set_up_careless(true); },
       {"link 'careless'", "leaves some of its 1 numbers unwritten in start_states()"}},
      {"no body",
       [] { set_up_careless(false); },
       {"link 'careless'", "touches 0 moving bodies", "add their slots in setup()"}},
  });
}

TEST_CASE("links, bodies and laws refuse numbers that cannot be", "[unit][refusals]") {
  System system, other;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  Marker &p = system.add_marker("p", body), &s = system.add_marker("s", system.ground());
  Revolute& elsewhere =
      other.add<Revolute>("elsewhere", other.add_body("a", shapes::box(1, {1, 1, 1})), other.ground(), Pose{});
  const double inf = std::numeric_limits<double>::infinity();
  check_refusals({
      {"no law",
       [&] { Distance("rope", p, s, LawPtr<MotionLaw>()); },
       {"link 'rope'", "no law for its length", "give one, or a number"}},
      {"a stop", [&] { TurnStop("stop", p, s, {.limit = inf}); }, {"link 'stop'", "the limit inf of a stop", "finite"}},
      {"a speed of rest",
       [&] { Distance("rope", p, s, 1.0).set_unilateral({.rest_speed = 0}); },
       {"link 'rope' is one-sided with rest_speed 0", "above zero"}},
      {"a rod",
       [] {
         shapes::rod(0, {0, 0, 0}, {1, 0, 0});
       },
       {"rod: the mass is 0", "greater than zero"}},
      {"a cylinder", [] { shapes::cylinder(0, 1, 1); }, {"cylinder: the mass is 0", "greater than zero"}},
      {"a direction",
       [] {
         laws::axis_rotation({kNaN, 0, 1}, laws::ramp(1));
       },
       {"axis", "not finite", "give a direction"}},
      {"an orientation",
       [] {
         laws::constant_rotation({kNaN, 0, 0, 1});
       },
       {"not finite", "give a quaternion"}},
      {"a type",
       [] {
         check_type_info({"a\nb", "", {}});
       },
       {"its name is not a plain line of text", "rewrite it"}},
      {"a link of another system",
       [&] {
         system.add(std::make_unique<testing::LoadCell>("reader", elsewhere));
         system.setup();
       },
       {"reader", "link 'elsewhere', whose reactions it reads, is of another System"}},
  });
}

TEST_CASE("checks, tables and pictures refuse what has nothing in it", "[unit][refusals]") {
  Driven driven;
  driven.system.setup();
  check_refusals({
      {"no integrator",
       [] { check_integrator(IntegratorMaker{}); },
       {"its maker gives no integrator", "give one that does"}},
      {"no time",
       [] { check_law(*laws::ramp(1), {.from = 2, .to = 1}); },
       {"check_law: from 2 s to 1 s", "a later end"}},
      {"bars",
       [] {
         write_bars("nothing", {"bars", "y", {"a"}, {{"one", {kNaN}}}});
       },
       {"bars \"bars\" have nothing to draw", "give them numbers"}},
      {"copies in other coordinates",
       [] {
         test::Family family(1, [](int k) { return test::chain(1, k); });
         Dynamics along(*family.systems[0], std::make_unique<SchurSolver>(), {Formulation::joint, {}});
         std::vector<State> states = family.starts();
         along.to_formulation(states[0]);
         Copies(family.pointers()).run(states, std::vector<double>{1}, {});
       },
       {"the state of copy 0 is in joint coordinates", "Dynamics::to_slots"}},
      {"copies that start late",
       [] {
         test::Family family(1, [](int k) { return test::chain(1, k); });
         std::vector<State> states = family.starts();
         states[0].t = 0.5;
         Copies(family.pointers()).run(states, std::vector<double>{0.1}, {});
       },
       {"a start at 0.5 s lies behind the first wanted time, 0.1 s", "leave out the times"}},
      {"copies with other links",
       [] {
         test::Family family(1, [](int k) { return test::chain(1, k); });
         std::vector<State> states = family.starts();
         states[0].modes[0] = false;
         Copies(family.pointers()).run(states, std::vector<double>{1}, {});
       },
       {"link 'hinge 0' is not in the state that it has at the start", "one set of links"}},
      {"near rows", [] { nearly_redundant_from("maybe"); }, {"auto, told, free or held", "not 'maybe'"}},
      {"no methods",
       [] { work_precision({.make = {}, .length = 1.0}, {}); },
       {"a chart needs an integrator", "take them from the registry"}},
      {"a column",
       [&] {
         Recorder recorder(driven.system);
         recorder.add({"empty", "m", nullptr});
       },
       {"column \"empty\" has no function", "give it one"}},
  });
}

}  // namespace refused_calls_test
