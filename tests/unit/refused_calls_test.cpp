// SPDX-License-Identifier: BSD-3-Clause
// Calls in C++ that cannot be meant: each is refused by name, value, limit and next move. Those of runs:
// refused_runs_test.cpp.
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/check.h>
#include <lockstep/author/params.h>
#include <lockstep/author/registry.h>
#include <lockstep/couplings.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include <lockstep/step_loop.h>
#include "framework/mechanism/params/read.h"
#include "framework/tools/charts/chart_grid.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "tests/support/catch.h"
#include "tests/support/load_cell.h"
#include "tests/support/messages.h"
#include "tests/support/refusals.h"

namespace refused_calls_test {

using namespace lockstep;
using lockstep::testing::check_refusals;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("a mechanism rejects unknown names", "[unit][refusals]") {
  System system;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  Revolute& hinge = system.add<Revolute>("hinge", body, system.ground(), Pose{});
  check_refusals({
      {"no link", [&] { system.add(std::unique_ptr<Lock>()); }, {"no joint was given", "make one first"}},
      {"no force", [&] { system.add(std::unique_ptr<Force>()); }, {"no force was given", "make one first"}},
      {"no state", [&] { system.add(std::unique_ptr<Auxiliary>()); }, {"no auxiliary was given", "make one first"}},
      {"no solver", [&] { Dynamics(system, nullptr); }, {"dynamics: no solver is given", "SparseSolver"}},
      {"no law",
       [&] { hinge.drive(Axis::rz, nullptr); },
       {"joint 'hinge'", "drive on rz", "has no law", "give it one"}},
      {"a row twice", [] { mask_from("x y x"); }, {"mask", "has the word \"x\" twice", "give it once"}},
  });
}

TEST_CASE("parameters reject laws without a maker, numbers that are none and empty choices", "[unit][refusals]") {
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

TEST_CASE("laws by points reject open periods", "[unit][refusals]") {
  const SplineSettings closed{.ends = SplineEnds::periodic};
  check_refusals({
      {"a curve",
       [&] {
         laws::spline({{0, 1}, {1, 2}, {2, 1.5}}, closed);
       },
       {"spline", "points end 0.5 away from the first", "the last must equal the first"}},
      {"repeat",
       [] {
         laws::spline({{0, 1}, {1, 2}}, {.outside = SplineOutside::repeat});
       },
       {"outside is \"repeat\"", "needs periodic ends", "\"hold\""}},
      {"turns",
       [&] {
         laws::spline_rotation({{0, {}}, {1, {1, 1, 0, 0}}, {2, {1, 0.1, 0, 0}}}, closed);
       },
       {"points end", "rad away from the first", "the last must equal the first"}},
  });
}

TEST_CASE("pictures reject impossible data", "[unit][refusals]") {
  check_refusals({
      {"no file",
       [] {
         const MapSpec map{
             "a map", "", "", {1, 2}, {1, 2}, false, false, {0, 1, 0, 1}, {{"good", "#2a9d6f"}, {"bad", "#c8443c"}}};
         write_map_grid("", {.title = "maps", .maps = {map}});
       },
       {"cannot write a chart to \"\"", "give a file name"}},
      {"no runs",
       [] { integrators_chart({}, "costs", {}, CostKind::cpu); },
       {"chart \"costs\" has no runs", "give it more time (--budget)"}},
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

TEST_CASE("a custom joint that omits a number or its bodies is rejected by name", "[unit][refusals]") {
  check_refusals({
      {"a start",
       [] { set_up_careless(true); },
       {"joint 'careless'", "leaves some of its 1 numbers unwritten in start_states()"}},
      {"no body",
       [] { set_up_careless(false); },
       {"joint 'careless'", "connects 0 moving bodies", "add their slots in setup()"}},
  });
}

TEST_CASE("joints, bodies and laws reject impossible numbers", "[unit][refusals]") {
  System system, other;
  Body& body = system.add_body("body", shapes::box(1, {1, 1, 1}));
  Marker &p = system.add_marker("p", body), &s = system.add_marker("s", system.ground());
  Revolute& elsewhere =
      other.add<Revolute>("elsewhere", other.add_body("a", shapes::box(1, {1, 1, 1})), other.ground(), Pose{});
  const double inf = std::numeric_limits<double>::infinity();
  check_refusals({
      {"no law",
       [&] { Distance("rope", p, s, LawPtr<MotionLaw>()); },
       {"joint 'rope'", "no law for its length", "give one"}},
      {"a stop", [&] { TurnStop("stop", p, s, {.limit = inf}); }, {"joint 'stop'", "limit is inf", "finite"}},
      {"a speed of rest",
       [&] { Distance("rope", p, s, 1.0).set_unilateral({.rest_speed = 0}); },
       {"joint 'rope' is one-sided with rest_speed 0", "above zero"}},
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
      {"a joint of another system",
       [&] {
         system.add(std::make_unique<testing::LoadCell>("reader", elsewhere));
         system.setup();
       },
       {"reader", "joint 'elsewhere', whose reactions it reads, belongs to another System"}},
  });
}

TEST_CASE("checks, tables and pictures reject empty data", "[unit][refusals]") {
  System system;
  system.setup();
  check_refusals({
      {"no integrator", [] { check_integrator(IntegratorMaker{}); }, {"the maker returns no integrator", "return one"}},
      {"no time",
       [] { check_law(*laws::ramp(1), {.from = 2, .to = 1}); },
       {"check_law: the end 1 s must be after the start 2 s", "a later end"}},
      {"near rows", [] { nearly_redundant_from("maybe"); }, {"auto, report, free or held", "is 'maybe'"}},
      {"no methods",
       [] { work_precision({.make = {}, .length = 1.0}, {}); },
       {"a chart needs an integrator", "give one of each"}},
      {"a column",
       [&] {
         Recorder recorder(system);
         recorder.add({"empty", "m", nullptr});
       },
       {"column \"empty\" has no function", "give it one"}},
  });
}

}  // namespace refused_calls_test
