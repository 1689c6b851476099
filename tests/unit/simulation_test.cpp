// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/step_loop.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/simulation.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"
#include "tests/support/worst.h"

namespace simulation_test {

using lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;

namespace {

/// Keeps what it is shown.
struct Log final : Observer {
  std::vector<double> outputs, heights, steps;
  int starts = 0, finishes = 0;
  void start(const Sample&) override { ++starts; }
  void step(const Sample& s) override { steps.push_back(s.state.t); }
  void output(const Sample& s) override { outputs.push_back(s.state.t), heights.push_back(s.state.q[2]); }
  void finish(const Sample&) override { ++finishes; }
};

/// A push along z whose law jumps.
class Push final : public Force {
 public:
  Push(std::function<double(double)> f, std::vector<double> jumps)
      : Force("push"), f_(std::move(f)), jumps_(std::move(jumps)) {}
  std::string_view type() const override { return "push"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { out.force(0, Vec3(0, 0, f_(in.t)), in.slot(0).x); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const double t : jumps_)
      if (t > t0 && t < t1) out.push_back(t);
  }

 private:
  std::function<double(double)> f_;
  std::vector<double> jumps_;
};

/// A stone of 1 kg at height 2 m under 10 m/s^2: z = 2 - 5 t^2, on the floor at sqrt(0.4) s.
struct Stone {
  System system{System::Options{{0, 0, -10}}};
  Stone() { system.add_particle("stone", 1, {0, 0, 2}); }
  const double floor = std::sqrt(0.4);
};

Event floor_event() {
  Event e;
  e.name = "floor";
  e.value = [](const Sample& s) { return s.state.q[2]; };
  e.crossing = Event::Crossing::falling;
  e.change = [](State& s) { s.v[2] = -s.v[2]; };
  return e;
}

std::unique_ptr<Integrator> method_of(const std::string& name) {
  if (name == "rk4") return std::make_unique<Rk4>();
  if (name == "dopri5") return std::make_unique<Dopri5>();
  return std::make_unique<Dop853>();
}

}  // namespace

TEST_CASE("output times are exact and the states between steps are the motion's", "[unit][dynamics]") {
  const std::string name = GENERATE("rk4", "dopri5", "dop853");
  CAPTURE(name);
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoopOptions options;
  options.step = 0.013;
  options.tolerance = {1e-10, 1e-12};
  options.output = 0.1;
  StepLoop run(dynamics, method_of(name), options);
  struct : Observer {
    std::vector<double> times;
    double worst = 0, off = 0;
    const RodPendulum* motion = nullptr;
    void output(const Sample& s) override {
      times.push_back(s.state.t);
      keep_worst(worst, motion->error(s.state));
      keep_worst(off, s.dynamics().violation(s.state));
    }
  } seen;
  seen.motion = &pendulum;
  run.add_observer(seen);
  run.run_until(1.05);
  REQUIRE(seen.times.size() == 12);
  for (int k = 0; k <= 10; ++k) CHECK(seen.times[k] == 0.1 * k);
  CHECK(seen.times.back() == 1.05);
  CHECK(run.state().t == 1.05);
  CHECK(seen.worst < (name == "rk4" ? 1e-6 : 1e-8));
  CHECK(seen.off < 1e-10);
}

TEST_CASE("listed output times are put out and nothing else", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoopOptions options;
  options.output_times = {0, 0.05, 0.3, 0.31, 0.4};
  StepLoop run(dynamics, method_of("dopri5"), options);
  Log log;
  run.add_observer(log);
  run.run_until(0.5);
  CHECK(log.outputs == options.output_times);
  for (std::size_t i = 0; i < log.outputs.size(); ++i)
    CHECK(log.heights[i] == Approx(2 - 5 * log.outputs[i] * log.outputs[i]).epsilon(1e-13));
}

TEST_CASE("a run continues at its end, and every step is output when no times were requested", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoopOptions options;
  options.step = 0.1;
  StepLoop run(dynamics, method_of("rk4"), options);
  Log log;
  run.add_observer(log);
  CHECK(run.run_until(0.3).steps == 3);
  CHECK(run.run_until(1.0).steps == 10);  // no sliver at the end
  CHECK(run.state().t == 1.0);
  CHECK(log.starts == 1);
  CHECK(log.finishes == 2);
  CHECK(log.steps.size() == 10);
  CHECK(log.outputs.size() == 11);
  CHECK(run.step(0.05).h == Approx(0.05).epsilon(1e-14));
  testing::check_words(message_of<ModelError>([&] { run.run_until(0.5); }),
                       {"the end time of 0.5 s", "not before the present time of 1.05 s"});
}

TEST_CASE("thousands of fixed steps end at the right times", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoopOptions options;
  options.step = 1e-3;
  options.output = 7;
  StepLoop run(dynamics, method_of("rk4"), options);
  CHECK(run.run_until(7).steps == 7000);
}

TEST_CASE("the loop ends a step at the jump of a law, with each side's value", "[unit][dynamics]") {
  const std::string name = GENERATE("rk4", "dopri5", "dop853");
  CAPTURE(name);
  System system;
  system.add_particle("cart", 2, {0, 0, 0});
  system.add(std::make_unique<Push>([](double t) { return t < 0.3   ? 4.0
                                                          : t < 0.7 ? -6.0
                                                                    : 0.0; },
                                    std::vector<double>{0.3, 0.7}));
  Dynamics dynamics = dynamics_of(system);
  StepLoopOptions options;
  options.step = 0.11;
  StepLoop run(dynamics, method_of(name), options);
  Log log;
  run.add_observer(log);
  run.run_until(1);
  CHECK(std::count(log.steps.begin(), log.steps.end(), 0.3) + std::count(log.steps.begin(), log.steps.end(), 0.7) == 2);
  // v: 0.6 at 0.3; -0.6 at 0.7. z: 0.09, then + 0.6 0.4 - 1.5 0.16, then - 0.6 0.3
  CHECK(run.state().v[2] == Approx(-0.6).epsilon(1e-12));
  CHECK(run.state().q[2] == Approx(0.09 + 0.24 - 0.24 - 0.18).epsilon(1e-12));
}

TEST_CASE("a condition is located to its tolerance and the motion continues from there", "[unit][dynamics]") {
  const std::string name = GENERATE("rk4", "dopri5", "dop853");
  CAPTURE(name);
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoopOptions options;
  options.step = 0.2;
  StepLoop run(dynamics, method_of(name), options);
  std::vector<double> hits;
  Event event = floor_event();
  event.once = false;
  event.tolerance = 1e-11;
  event.change = [&hits](State& s) { hits.push_back(s.t), s.v[2] = -s.v[2]; };
  run.add_event(event);
  run.run_until(3);
  REQUIRE(hits.size() == 2);
  CHECK(hits[0] == Approx(stone.floor).margin(2e-11));
  CHECK(hits[1] == Approx(3 * stone.floor).margin(2e-10));
  const double t = 3 - 4 * stone.floor;  // from the second top
  CHECK(run.state().q[2] == Approx(2 - 5 * t * t).epsilon(1e-8));
}

TEST_CASE("an event that undoes itself does not loop for ever", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, method_of("dopri5"));
  Event event = floor_event();
  event.crossing = Event::Crossing::any;
  event.once = false;
  int hits = 0;
  event.change = [&hits](State& s) { ++hits, s.v[2] = -s.v[2]; };
  run.add_event(event);
  run.run_until(1.5);
  CHECK(hits == 1);
  CHECK(run.state().t == 1.5);
}

TEST_CASE("an event at an instant switches a joint off, the body flies on freely", "[unit][dynamics]") {
  const std::string name = GENERATE("rk4", "dopri5", "dop853");
  CAPTURE(name);
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoopOptions options;
  options.step = 0.01;
  options.tolerance = {1e-11, 1e-13};
  StepLoop run(dynamics, method_of(name), options);
  State at_release;
  Event event;
  event.name = "let go";
  event.at = 0.315;
  event.deactivate = {"hinge"};
  event.change = [&at_release](State& s) { at_release = s; };
  run.add_event(event);
  run.run_until(0.6);
  CHECK(at_release.t == 0.315);
  CHECK(pendulum.error(at_release) < 1e-7);
  const double t = 0.6 - 0.315;
  const Vec3 fall = at_release.q.head<3>() + t * at_release.v.head<3>() - Vec3(0, 0, 0.5 * 9.81 * t * t);
  CHECK((run.state().q.head<3>() - fall).norm() < 1e-12);
  CHECK_FALSE(run.state().modes[0]);
}

TEST_CASE("a joint that becomes active takes up the velocity, far from its place it is rejected by name",
          "[unit][dynamics]") {
  Stone stone;
  Lock& hook = stone.system.add<Spherical>("hook", stone.system.body("stone"), stone.system.ground(), pose_at({0, 0, 2}));
  hook.set_active_at_start(false);
  Dynamics dynamics = dynamics_of(stone.system);
  Event event;
  event.name = "catch";
  event.activate = {"hook"};

  SECTION("at its place") {
    State s = stone.system.start();
    s.v[0] = 3;
    event.at = 0;
    StepLoop run(dynamics, method_of("dopri5"));
    run.set_state(s);
    run.add_event(event);
    run.run_until(0.5);
    CHECK(run.state().modes[0]);
    CHECK(run.state().slot_twist(0).v.norm() < 1e-10);
    CHECK(run.state().slot_pose(0).x[2] == Approx(2).epsilon(1e-10));
  }
  SECTION("far from it") {
    event.at = 0.2;
    StepLoop run(dynamics, method_of("dopri5"));
    Log log;
    run.add_observer(log);
    run.add_event(event);
    const std::string said = message_of<AssemblyError>([&] { run.run_until(1); });
    CHECK(says(said, {"catch", "hook", "0.2"}));
    CHECK(log.finishes == 1);
    CHECK(log.outputs.back() == 0.2);
  }
  SECTION("unknown") {
    event.at = 0.2;
    event.activate = {"hok"};
    StepLoop run(dynamics, method_of("dopri5"));
    testing::check_words(message_of<ModelError>([&] { run.add_event(event); }), {"\"hok\"", "did you mean"});
  }
}

TEST_CASE("an event ends the run and reports it, the last state is output", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoopOptions options;
  options.output = 0.25;
  StepLoop run(dynamics, method_of("dop853"), options);
  Log log;
  run.add_observer(log);
  Event event = floor_event();
  event.change = {};
  event.stop = true;
  run.add_event(event);
  const SimulationReport& report = run.run_until(2);
  CHECK(report.stopped);
  CHECK(report.stopped_by == "floor");
  REQUIRE(log.outputs.size() == 4);
  CHECK(log.outputs.back() == Approx(stone.floor).margin(2e-9));
  run.progress = [](const State&) { return false; };
  CHECK(run.run_until(3).stopped);
  CHECK(run.state().t < 3);
}

TEST_CASE("an error keeps computed results and gives its time", "[unit][dynamics]") {
  System system;
  system.add_particle("cart", 2, {0, 0, 0});
  system.add(std::make_unique<Push>([](double t) { return t < 0.5 ? 1.0 : std::numeric_limits<double>::quiet_NaN(); },
                                    std::vector<double>{}));
  Dynamics dynamics = dynamics_of(system);
  StepLoopOptions options;
  options.step = 0.03;
  StepLoop run(dynamics, method_of("rk4"), options);
  Log log;
  run.add_observer(log);
  try {
    run.run_until(1);
    FAIL("no error came");
  } catch (const NonFiniteError& e) {
    CHECK(e.t >= 0.5);
    CHECK(std::string(e.what()).find("push") != std::string::npos);
  }
  CHECK(log.finishes == 1);
  CHECK(log.steps.size() == 16);
  CHECK(run.state().t == Approx(0.48));
}

TEST_CASE("a start off the constraints and impossible settings are rejected", "[unit][dynamics]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, method_of("dopri5"));
  State off = pendulum.system.start();
  off.q[0] += 0.01;
  CHECK(says(message_of<AssemblyError>([&] { run.set_state(off); }), {"hinge", "0.01", "assemble"}));
  off = pendulum.system.start();
  off.v[1] = 1;
  testing::check_words(message_of<AssemblyError>([&] { run.set_state(off); }), {"hinge", "m/s"});
  testing::check_words(message_of<ModelError>([&] { run.set_state(State{}); }), {"a state of 0 coordinates"});
  testing::check_words(message_of<ModelError>([&] { run.add_event(Event{}); }),
                       {"neither a time", "nor a condition"});
  CHECK(says(message_of<ModelError>([&] { StepLoop(dynamics, method_of("rk4")); }), {"rk4", "--step"}));
  testing::check_words(message_of<ModelError>([&] { StepLoop(dynamics, nullptr); }), {"needs an integrator"});
}

TEST_CASE("the loop allocates nothing in its steps and outputs", "[unit][dynamics]") {
  if (!allocations_are_counted()) return;
  const std::string name = GENERATE("rk4", "dopri5", "dop853");
  CAPTURE(name);
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoopOptions options;
  options.step = 0.0123456;
  options.output = 0.05;
  StepLoop run(dynamics, method_of(name), options);
  run.run_until(0.3);
  run.step();
  const auto steps = [&] {
    for (int i = 0; i < 30; ++i) run.step();
  };
  steps();
  CHECK(allocations_of(steps) == 0);
}

TEST_CASE("a state that is not finite is rejected, with or without constraints", "[unit]") {
  System system;
  system.add_body("ball", shapes::sphere(1, 0.1));
  Simulation run(system, {.output = 0.1});
  run.loop();  // sets the system up
  const auto refused = [&]<class E>(auto&& spoil) {
    State state = run.state();
    spoil(state);
    return message_of<E>([&] { run.loop().set_state(std::move(state)); });
  };
  lockstep::testing::check_words(refused.operator()<ModelError>([](State& s) { s.t = NAN; }), {"time", "nan"});
  lockstep::testing::check_words(refused.operator()<NonFiniteError>([](State& s) { s.v[2] = INFINITY; }),
                                 {"ball", "not finite"});
  lockstep::testing::check_words(refused.operator()<NonFiniteError>([](State& s) { s.q[0] = NAN; }),
                                 {"ball", "not finite"});
  run.run_until(0.2);  // the state before is untouched
  CHECK(run.state().t == Approx(0.2));
}

}  // namespace simulation_test
