// SPDX-License-Identifier: BSD-3-Clause
// What a host switches, sets and loads between two calls of a run: what is refused leaves the run, what is set of a drive
// jumps as its law would, and no call of one kind is judged by those of another.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/simulate/decided_rows.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace hosts_switches_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

/// A stone of 2 kg without gravity that flies along x at 1 m/s.
struct Flight {
  System system;
  Body& stone = system.add_particle("stone", 2, {0, 0, 0});
  Marker& p = system.add_marker("p", stone);
  explicit Flight(double v = 1) {
    stone.start.v = {v, 0, 0};
    system.add(std::make_unique<AppliedForce>("push", p, AppliedForce::Options{{8, 0, 0}})).set_switched(false);
  }
};

/// A rod on a hinge that a law of an input drives, and what the run tells.
struct Driven {
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  Revolute& hinge = system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  ControlInput& u = system.add_input("u", 0);
  ControlInput& torque = system.add_input("torque", 0, "N m");
  struct Causes final : Observer {
    std::vector<std::string> seen;
    void jumped(const Sample& s) override { seen.emplace_back(s.cause); }
  } causes;
  std::unique_ptr<Simulation> run;
  Driven() {
    system.add(function_force("motor", {&system.marker("hinge.P")}, [this](const Inputs&, WrenchSum& out) {
      out.torque(rod.slot, {0, 0, torque.value()});
    }));
  }
  void begin(const char* method, Formulation formulation) {
    SimulationOptions options{.integrator = method};
    options.dynamics.formulation = formulation;
    if (std::string(method) == "rk4" || std::string(method) == "generalized_alpha") options.step = 0.0625;
    run = std::make_unique<Simulation>(system, options);
    run->add_observer(causes);
  }
  double angle() { return 2 * std::atan2(body_pose(rod, run->state()).q.vec()[2], body_pose(rod, run->state()).q.w); }
  double rate() { return body_twist(rod, run->state()).w.z(); }
};

}  // namespace

TEST_CASE("short steps that a host asked for are no pace of the run that follows", "[unit][dynamics]") {
  struct Case {
    int n;
    double h, end;
  };
  const auto [n, h, end] = GENERATE(values<Case>({{20000, 1e-6, 3600}, {10000, 1e-4, 2000}, {15000, 1e-6, 3600}}));
  const bool by_steps = GENERATE(true, false);
  CAPTURE(n, by_steps);
  Flight flight;
  Simulation run(flight.system, {.output = 1000});
  for (int k = 0; k < n; ++k) by_steps ? void(run.loop().step(h)) : void(run.advance(h));
  CHECK(run.run_until(end).findings.empty());
  CHECK(run.state().q[0] == Approx(end).epsilon(1e-12));
}

TEST_CASE("a rejected snapshot leaves the run unchanged", "[unit][checkpoint]") {
  const bool of_events = GENERATE(false, true);
  const auto make = [](Flight& of, bool event) {
    auto run = std::make_unique<Simulation>(of.system, SimulationOptions{.output = 0.125});
    run->record({"stone.x"});
    Event& halt = run->add_event({.name = "halt", .at = 9, .stop = true});
    if (event) run->add_event({.name = "more", .at = 9});
    halt.on = false;
    return run;
  };
  Flight mine, same, other;
  if (!of_events) other.system.add_body("more", shapes::sphere(1, 1));
  const auto run = make(mine, false), undisturbed = make(same, false), stranger = make(other, of_events);
  for (Simulation* each : {run.get(), undisturbed.get(), stranger.get()}) each->run_until(0.25);
  stranger->run_until(0.5);
  Snapshot saved;
  stranger->loop().save(saved);
  check_words(message_of<ModelError>([&] { run->loop().load(saved); }), {of_events ? "2 events" : "another run"});
  CHECK(run->state().t == 0.25);
  run->run_until(1), undisturbed->run_until(1);
  CHECK(run->table()["t"] == undisturbed->table()["t"]);  // observers were not started again
  CHECK(run->state().q[0] == Approx(1).epsilon(1e-12));
}

TEST_CASE("after a snapshot that fails half-way the run continues as it was", "[unit][checkpoint]") {
  Flight flight;
  Simulation run(flight.system, {.integrator = "rk4", .step = 0.0001220703125, .output = 0.5});
  run.run_until(1);
  Snapshot saved;
  run.loop().save(saved);
  saved.put(1);
  run.run_until(1.5);
  REQUIRE(run.loop().report().steps > 12000);
  check_words(message_of<ModelError>([&] { run.loop().load(saved); }), {"more numbers"});
  CHECK(run.state().t == 1.5);
  CHECK(run.run_until(2).steps == 16384);
  CHECK(run.state().q[0] == Approx(2).epsilon(1e-12));
}

TEST_CASE("an event that is added inactive and activated before the next step meets its first crossing",
          "[unit][events]") {
  Flight flight;
  Simulation run(flight.system);
  run.run_until(0.5);
  long met = 0;
  Event& gate = run.add_event({.name = "gate",
                               .value = [](const Sample& s) { return s.state.q[0] - 0.5625; },
                               .on = false,
                               .change = [&](State&) { ++met; }});
  gate.on = true;
  run.run_until(1);
  CHECK(met == 1);
  CHECK(run.loop().event_courses().front().last == Approx(0.5625).epsilon(1e-9));
}

TEST_CASE("an event by time misses the steps that are accepted, and no others", "[unit][events]") {
  const bool taken_back = GENERATE(false, true);
  CAPTURE(taken_back);
  bool broken = taken_back;
  Flight flight;
  Simulation run(flight.system, {.integrator = "rk4", .step = 0.5});
  double acted = 0;
  Event& clock = run.add_event({.name = "clock", .at = 1.25, .on = false, .change = [&](State& s) { acted = s.t; }});
  run.add_event({.name = "gate",
                 .value =
                     [&](const Sample& s) {
                       if (broken && s.state.t > 1.125) throw 7;
                       return s.state.q[0] - 1.125;
                     },
                 .stop = true});
  message_of<UserCodeError>([&] { run.run_until(2); });
  CHECK(run.state().t == Approx(taken_back ? 1 : 1.125));
  broken = false, clock.on = true;
  run.run_until(2), run.run_until(2);
  CHECK(acted == 1.25);
}

TEST_CASE("an event is activated and deactivated by a call", "[unit][events]") {
  Flight flight;
  Simulation run(flight.system);
  run.add_event({.name = "halt", .at = 1, .stop = true});
  run.deactivate("halt");
  run.run_until(0.5);
  run.activate("halt");
  CHECK(run.run_until(2).stopped_by == "halt");
  CHECK(run.state().t == 1);
  check_words(message_of<ModelError>([&] { run.activate("hald"); }),
              {"a call", "unknown joint, force or event \"hald\"", "did you mean \"halt\"?"});
}

TEST_CASE("a call that switches does not use up a stop", "[unit][events]") {
  Flight flight;
  Simulation run(flight.system);
  run.run_until(1);
  run.add_event({.name = "halt", .at = 1, .stop = true});
  run.deactivate("push"), run.deactivate("push");
  Snapshot saved;
  run.loop().save(saved);
  CHECK(run.run_until(4).stopped_by == "halt");
  run.loop().load(saved);
  CHECK(run.run_until(4).stopped_by == "halt");
  CHECK(run.state().t == 1);
  run.deactivate("push");
  CHECK_FALSE(run.run_until(4).stopped);
  CHECK(run.state().t == 4);
}

TEST_CASE("an input that a drive reads may not move it at once", "[unit][dynamics]") {
  const auto method = GENERATE("dopri5", "rk4", "radau5");
  const auto formulation = GENERATE(Formulation::automatic, Formulation::omega);
  CAPTURE(method, formulation);
  Driven driven;
  driven.hinge.drive(Axis::rz, laws::law([&](auto t) { return driven.u.value() + 0.5 * t; }));
  driven.begin(method, formulation);
  Simulation& run = *driven.run;
  run.run_until(1);
  driven.u.set(0.25);
  for (int k = 0; k < 2; ++k)
    check_words(message_of<AssemblyError>([&] { run.run_until(2); }),
                {"input 'u' was changed from 0 to 0.25", "jumps in position at t = 1 s", "hinge", "use a continuous law",
                 "reset the input"});
  CHECK(run.state().t == 1);
  driven.u.set(0);
  run.run_until(2);
  CHECK(driven.angle() == Approx(1).epsilon(1e-9));
  CHECK(driven.causes.seen.empty());
}

TEST_CASE("an input that sets the speed of a drive jumps as its law would", "[unit][dynamics]") {
  const auto method = GENERATE("dopri5", "rk4", "radau5", "generalized_alpha");
  const auto formulation = GENERATE(Formulation::automatic, Formulation::omega);
  const bool by_speed = GENERATE(false, true);
  CAPTURE(method, formulation, by_speed);
  Driven driven;
  if (by_speed)
    driven.hinge.drive_speed(Axis::rz, laws::law([&](auto t) { return driven.u.value() + 0 * t; }));
  else
    driven.hinge.drive(Axis::rz, laws::law([&](auto t) { return driven.u.value() * (t - 1.0); }));
  driven.begin(method, formulation);
  Simulation& run = *driven.run;
  run.run_until(1);
  driven.u.set(0.5);
  run.advance(0.0625);
  CHECK(driven.rate() == Approx(0.5).epsilon(1e-9));
  run.run_until(2);
  CHECK(driven.angle() == Approx(0.5).epsilon(1e-6));
  CHECK(driven.causes.seen == std::vector<std::string>{"the jump of a law"});
  driven.torque.set(3);  // reads no law
  run.run_until(3);
  CHECK(driven.rate() == Approx(0.5).epsilon(1e-9));
  CHECK(driven.causes.seen.size() == 1);
}

TEST_CASE("a second run does not continue the revolutions of the first", "[unit][dynamics]") {
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  rod.start = {cross(Vec3(0, 0, 20), Vec3(0.5, 0, 0)), Vec3(0, 0, 20)};
  Simulation run(system);
  run.add_event({.name = "mark", .at = 1, .change = [](State&) {}});
  run.run_until(1.25);
  REQUIRE(run.state().q.size() == 1);
  run.loop().set_state(system.start());
  run.loop().step(1e-3);
  CHECK(run.state().q[0] == Approx(20 * run.state().t).epsilon(1e-9));
}

namespace {

/// v <- v + h (3 a - a before)/2, x <- x + h v: begun with a of its own.
class TwoSteps final : public Integrator {
 public:
  IntegratorInfo info() const override { return {.name = "two steps", .order = 2, .joint = true}; }
  void begin(Dynamics& dynamics, const State& y) override { dynamics.rates(y, before_); }
  StepReport step(Dynamics& dynamics, State& y, double h) override {
    dynamics.rates(y, now_);
    y.t += h, y.q += h * now_.q, y.v += 0.5 * h * (3 * now_.v - before_.v);
    before_ = now_;
    return {.h = h};
  }

 private:
  StateRate before_, now_;
};

}  // namespace

TEST_CASE("a host's multistep method restarts at a changed input", "[unit][dynamics]") {
  System system;
  Body& stone = system.add_particle("stone", 2, {0, 0, 0});
  ControlInput& push = system.add_input("push", 8, "N");
  system.add(function_force("motor", {&system.add_marker("p", stone)}, [&](const Inputs& in, WrenchSum& out) {
    out.force(stone.slot, {push.value(), 0, 0}, in.slot(stone.slot).x);
  }));
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<TwoSteps>(), {.step = 0.125});
  run.run_until(1);
  push.set(-4);
  run.run_until(2);
  CHECK(run.state().v[0] == Approx((8 - 4) / 2.0).epsilon(1e-12));
}

TEST_CASE("only what could hold is advised to hold", "[unit][events]") {
  const bool driven = GENERATE(false, true);
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  Revolute& pin = system.add<Revolute>("pin", system.add_marker_at("end", rod, pose_at({0, 0, 0})),
                                       system.add_marker("hook", system.ground(), pose_at({0, 0, 0.25})));
  if (driven) pin.drive(Axis::rz, laws::ramp(1.0));
  pin.set_active_at_start(false);
  Simulation run(system);
  run.run_until(1);
  const std::string message = message_of<AssemblyError>([&] { run.activate("pin"); });
  check_words(message, {"'pin'", "m apart"});
  CHECK((message.find("\"hold\"") == std::string::npos) == driven);
}

TEST_CASE("a call that switches a joint decided at the start is rejected by the joint's name", "[unit][events]") {
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("low", rod, system.ground(), pose_at({0, 0, 0}));
  system.add<Revolute>("high", rod, system.ground(), pose_at({0, 0, 1}));
  system.hold_down_to(1e-7);
  Simulation run(system);
  run.run_until(0.125);
  try {
    run.deactivate("high");
    FAIL("not refused");
  } catch (const ModelError& error) {
    CHECK(error.thing.kind == "joint");
    CHECK(error.thing.name == "high");
  }
}

TEST_CASE("a step of another length leaves the steps of the method their length", "[unit][dynamics]") {
  Flight flight;
  Simulation run(flight.system, {.integrator = "rk4", .step = 0.1});
  run.run_until(1);
  run.loop().step(0.05);
  CHECK(run.state().t == Approx(1.05).margin(1e-12));
  run.loop().step();
  CHECK(run.state().t == Approx(1.15).margin(1e-12));
  run.loop().step(0.25);
  run.run_until(2);
  CHECK(run.state().t == 2);
}

TEST_CASE("a force that fails when it is switched on can be switched off", "[unit][dynamics]") {
  const std::string method = GENERATE("dopri5", "rk4", "generalized_alpha");
  CAPTURE(method);
  Flight flight;
  bool broken = true;
  Force& wind = flight.system.add(function_force("wind", {&flight.p}, [&](const Inputs&, WrenchSum&) {
    if (broken) throw 7;
  }));
  wind.set_switched(false);
  Simulation run(flight.system, {.integrator = method, .step = method == "dopri5" ? 0.0 : 0.125});
  run.run_until(1);
  try {
    run.activate("wind");
    run.run_until(1.5);
    FAIL("a force that throws was evaluated by nobody");
  } catch (const UserCodeError&) {
  }
  run.deactivate("wind");
  run.run_until(2);
  CHECK(run.state().q[0] == Approx(2));
}

TEST_CASE("an event whose condition throws when it joins is not in the run", "[unit][dynamics]") {
  Flight flight;
  Simulation run(flight.system, {.integrator = "dopri5"});
  run.run_until(1);
  CHECK_THROWS_AS(run.add_event({.name = "bad", .value = [](const Sample&) -> double { throw 7; }}), UserCodeError);
  run.run_until(2);
  CHECK(run.state().q[0] == Approx(2));
}

// sqrt of a height that falls below zero between two steps.
TEST_CASE("a one-sided joint whose gap has no value is named", "[unit][dynamics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, 0, -9.81],
    "bodies": [{"name": "b", "sphere": {"mass": 1, "radius": 0.1}, "position": [0, 0, 1]}],
    "links": [{"name": "floor", "type": "function", "p": "b", "s": "ground", "at_p": [0, 0, 1], "at_s": [0, 0, 0],
               "phi": "=sqrt(z)-0.5", "unilateral": {"restitution": 0.8}}],
    "run": {"integrator": "dop853", "until": 2}})";
  Simulation run(build_mechanism(scene_from_text(text, "floor.json"), builtin_registry()));
  try {
    run.run();
    CHECK(run.state().q[2] > 0.25);  // steps that are short enough meet the floor
  } catch (const NonFiniteError& e) {
    check_words(e.what(), {"one-sided joint 'floor'"});
  }
}

// k = 1e6 N/m and m = 1 kg: 1000 1/s.
TEST_CASE("a run of a scene that fails gives a host the cause that the program prints", "[unit][dynamics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, 0, 0],
    "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0], "velocity": [1, 0, 0]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "b", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0],
                "stiffness": 1e6, "free_length": 1}],
    "run": {"integrator": "rk4", "step": 0.01, "until": 2}})";
  for (const bool with_event : {false, true}) {  // with one, the start is judged alone
    Simulation run(build_mechanism(scene_from_text(text, "spring.json"), builtin_registry()));
    if (with_event) run.add_event({.name = "never", .at = 1e3});
    try {
      run.run();
      FAIL("the step is stable");
    } catch (const Error& e) {
      INFO(e.what());
      check_words(e.problem, {"the step of 0.01 s is too long", "the fastest motion has a rate of 1e+03 1/s"});
      check_words(e.advice, {"take a step of 0.0001 to 0.001 s"});
      check_words(e.what(), {e.problem, e.advice, "solver: "});
    }
  }
}

}  // namespace hosts_switches_test
