// SPDX-License-Identifier: BSD-3-Clause
// What a host does between two calls of a run acts at once: events, switches, inputs; a failed call is tried again as
// often as one likes, a snapshot loaded as often, and a controller's calls cost no memory.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/simulation.h>
#include <lockstep/step_loop.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace hosts_now_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

constexpr const char* kMethods[] = {
    "dopri5", "dop853", "rk4", "radau5", "rattle2", "rattle4", "generalized_alpha", "semi_implicit_euler"};

bool adaptive(const std::string& method) { return method.starts_with("do") || method == "radau5"; }

SimulationOptions options_of(const std::string& method, double step = 0.125) {
  return {.integrator = method, .step = adaptive(method) ? 0.0 : step};
}

/// A stone of 2 kg at rest without gravity, which a force of 8 N pushes along x when it is switched on.
struct Stone {
  System system;
  Body& stone = system.add_particle("stone", 2, {0, 0, 0});
  Marker& p = system.add_marker("p", stone);
  Stone() {
    system.add(std::make_unique<AppliedForce>("push", p, AppliedForce::Options{{8, 0, 0}})).set_switched(false);
  }
};

double speed(Simulation& run) { return run.state().v[0]; }

/// A stone of 2 kg that a host pushes along x by an input.
struct Pushed {
  System system;
  Body& stone = system.add_particle("stone", 2, {0, 0, 0});
  Marker& p = system.add_marker("p", stone);
  ControlInput& u = system.add_input("push", 0, "N");
  Pushed() {
    system.add(function_force("motor", {&p}, [this](const Inputs& in, WrenchSum& out) {
      out.force(stone.slot, {u.value(), 0, 0}, in.slot(stone.slot).x);
    }));
  }
};

/// A four-bar with a torque on its crank that a host sets.
struct FourBar {
  System system{System::Options{{0, -9.81, 0}}};
  Body& crank = system.add_body("crank", shapes::rod(1, {0, 0, 0}, {0, 0.3, 0}));
  ControlInput& torque = system.add_input("torque", 1, "N m");
  FourBar() {
    Body& coupler = system.add_body("coupler", shapes::rod(1, {0, 0.3, 0}, {0.8, 0.7, 0}));
    Body& rocker = system.add_body("rocker", shapes::rod(1, {1, 0, 0}, {0.8, 0.7, 0}));
    system.add<Revolute>("A", crank, system.ground(), pose_at({0, 0, 0}));
    system.add<Revolute>("B", coupler, crank, pose_at({0, 0.3, 0}));
    system.add<Spherical>("C", rocker, coupler, pose_at({0.8, 0.7, 0}));
    system.add<Revolute>("D", rocker, system.ground(), pose_at({1, 0, 0}));
    system.add(function_force("motor", {&system.marker("A.P")}, [this](const Inputs&, WrenchSum& out) {
      out.torque(crank.slot, {0, 0, torque.value()});
    }));
  }
};

}  // namespace

TEST_CASE("an event of the present time acts before the next step", "[unit][dynamics]") {
  const auto method = GENERATE(from_range(std::begin(kMethods), std::end(kMethods)));
  const bool by_steps = GENERATE(false, true);
  CAPTURE(method, by_steps);
  Stone stone;
  Simulation run(stone.system, options_of(method));
  const auto go_on = [&](double t) {
    if (!by_steps) run.run_until(t);
    while (run.state().t < t) run.loop().step(t - run.state().t);
  };
  go_on(1);
  run.add_event({.name = "go", .at = run.state().t, .activate = {"push"}});
  CHECK(speed(run) == 0);
  go_on(2);
  CHECK(speed(run) == Approx(4).epsilon(1e-12));  // 8 N on 2 kg for 1 s
  run.add_event({.name = "turn", .at = run.state().t, .change = [](State& s) { s.v[0] = -1; }});
  run.add_event({.name = "let go", .at = run.state().t, .deactivate = {"push"}});
  go_on(3);
  CHECK(speed(run) == -1);
}

TEST_CASE("a past event is rejected in a run that has begun, by name and times", "[unit][dynamics]") {
  Stone stone;
  Simulation run(stone.system);
  const Event late{.name = "late", .at = 0.5, .activate = {"push"}};
  run.run_until(1);
  check_words(message_of<ModelError>([&] { run.add_event(late); }),
              {"event 'late'", "0.5 s", "1 s", "past", "state().t"});
  run.add_event({.name = "rounded", .at = std::nextafter(1.0, 0.0), .activate = {"push"}});
  run.run_until(2);
  CHECK(speed(run) == Approx(4).epsilon(1e-12));
  CHECK_FALSE(run.run_until(3).stopped);
  run.add_event({.name = "halt", .at = 3, .stop = true});
  CHECK(run.run_until(4).stopped_by == "halt");
  CHECK(run.state().t == 3);
}

TEST_CASE("an event of the present time that fails leaves the state, and is due again", "[unit][dynamics]") {
  Stone stone;
  Marker& hook = stone.system.add_marker("hook", stone.system.ground(), pose_at({0, 0, 0.25}));
  stone.system.add<Spherical>("catch", stone.p, hook).set_active_at_start(false);
  Simulation run(stone.system);
  run.run_until(1);
  const State before = run.state();
  Event& grab = run.add_event({.name = "grab", .at = 1, .activate = {"catch"}});
  for (int k = 0; k < 2; ++k) {
    check_words(message_of<AssemblyError>([&] { run.run_until(2); }), {"event 'grab'", "'catch'", "0.25 m apart"});
    CHECK(run.state().modes == before.modes);
    CHECK(run.state().t == 1);
  }
  grab.on = false;
  run.run_until(2);
  CHECK(run.state().t == 2);
}

TEST_CASE("a force is switched by a call", "[unit][dynamics]") {
  const auto method = GENERATE(from_range(std::begin(kMethods), std::end(kMethods)));
  CAPTURE(method);
  Stone stone;
  Simulation run(stone.system, options_of(method));
  run.activate("push");  // begins the run
  run.run_until(1);
  CHECK(speed(run) == Approx(4).epsilon(1e-12));
  run.deactivate("push");
  run.run_until(3);
  CHECK(speed(run) == Approx(4).epsilon(1e-12));
  run.activate("push"), run.deactivate("push"), run.activate("push");
  run.advance(0.5);
  CHECK(speed(run) == Approx(6).epsilon(1e-12));
}

// Momentum about the end that is caught: m v c = (J + m c^2) w, c from there to the mass centre.
TEST_CASE("a joint that a call brings into force stops what it holds, as an event's does", "[unit][dynamics]") {
  const bool by_event = GENERATE(false, true);
  CAPTURE(by_event);
  constexpr double kSpeed = 1.5, kLength = 0.5;
  System system;
  Body& rod = system.add_body("rod", shapes::rod(2, {0, 0, 0}, {kLength, 0, 0}));
  const double m = rod.mass.mass, c = 0.5 * kLength, w = m * kSpeed * c / (rod.mass.J(2, 2) + m * c * c);
  rod.start.v = {0, kSpeed, 0};
  Marker &end = system.add_marker_at("end", rod, pose_at({0, 0, 0})),
         &pin = system.add_marker("pin", system.ground(), pose_at({0, kSpeed, 0}));
  system.add<Revolute>("catch", end, pin).set_active_at_start(false);
  struct Causes final : Observer {
    std::vector<std::string> seen;
    void jumped(const Sample& s) override { seen.emplace_back(s.cause); }
  } causes;
  Simulation run(system, {.output = 0.5});
  run.add_observer(causes);
  run.run_until(0.5);
  const State before = run.state();
  check_words(message_of<AssemblyError>([&] { run.activate("catch"); }), {"a call", "'catch'", "0.75 m apart"});
  CHECK((run.state().q == before.q && run.state().v == before.v && run.state().modes == before.modes));
  run.run_until(1);
  if (by_event)
    run.add_event({.name = "grab", .at = 1, .activate = {"catch"}});
  else
    run.activate("catch");
  if (!by_event) CHECK(run.state().modes[0]);
  run.run_until(1.25);
  CHECK(body_twist(rod, run.state()).w.z() == Approx(w).epsilon(1e-9));
  CHECK(causes.seen == std::vector<std::string>{by_event ? "event 'grab'" : "a call"});
  run.deactivate("catch");
  const Vec3 x = body_pose(rod, run.state()).x, thrown = body_twist(rod, run.state()).v;  // of its centre
  CHECK(thrown.norm() == Approx(w * c).epsilon(1e-9));
  run.run_until(2.25);
  CHECK((body_pose(rod, run.state()).x - x - thrown).norm() < 1e-9);
}

TEST_CASE("an impossible switch by a call is rejected by name", "[unit][dynamics]") {
  Stone stone;
  stone.system.add(std::make_unique<AppliedForce>("steady", stone.p, AppliedForce::Options{{0, 0, 0}}));
  Simulation run(stone.system);
  run.run_until(1);
  check_words(message_of<ModelError>([&] { run.activate("pusch"); }), {"a call", "pusch", "did you mean \"push\"?"});
  check_words(message_of<ModelError>([&] { run.deactivate("steady"); }), {"a call", "force 'steady'", "set_switched"});
  run.loop().progress = [&](const State&) {
    run.activate("push");
    return true;
  };
  check_words(message_of<ModelError>([&] { run.run_until(2); }), {"activate", "inside the run"});
  run.loop().progress = {};
  run.run_until(3);
  CHECK(speed(run) == 0);
}

TEST_CASE("crossings during the inactive time of an event are missed", "[unit][dynamics]") {
  const bool first_off = GENERATE(false, true);
  Stone stone;
  stone.stone.start.v = {1, 0, 0};
  Simulation run(stone.system, {.integrator = "rk4", .step = 0.0625});
  long met = 0, timed = 0;
  Event& gate = run.add_event({.name = "gate",
                               .value = [](const Sample& s) { return std::sin(kPi * s.state.q[0]); },
                               .once = false,
                               .change = [&](State&) { ++met; }});
  Event& clock = run.add_event({.name = "clock", .at = 1.5, .change = [&](State&) { ++timed; }});
  run.run_until(0.5);
  gate.on = clock.on = !first_off;
  run.run_until(2.5);  // x = 1, 2 and t = 1.5
  CHECK(met == (first_off ? 0 : 2));
  CHECK(timed == (first_off ? 0 : 1));
  gate.on = clock.on = first_off;
  run.run_until(4.5);  // x = 3, 4
  CHECK(met == 2);
  CHECK(timed == (first_off ? 0 : 1));
}

TEST_CASE("a host may try a failed step as often as it likes", "[unit][dynamics]") {
  const bool by_event = GENERATE(false, true);
  const std::string method = by_event ? "dopri5" : "rk4";
  const long tries = by_event ? 1100 : 2000;  // a pace is judged over 1000 steps
  CAPTURE(method);
  bool broken = true;
  Stone stone;
  stone.system.add(function_force("wire", {&stone.p}, [&](const Inputs& in, WrenchSum& out) {
    if (!by_event && broken && in.t > 0.5) throw 7;
    out.force(stone.stone.slot, {0, 6, 0}, in.slot(stone.stone.slot).x);
  }));
  Simulation run(stone.system, options_of(method, 0.015625));
  run.add_event({.name = "watch", .value = [&](const Sample& s) {
                   if (by_event && broken && s.state.t > 0.5) throw 7;
                   return s.state.t - 0.75;
                 }});
  long refused = 0;
  std::string last;
  for (long k = 0; k < tries; ++k)
    last = message_of<UserCodeError>([&] { run.run_until(1); }), refused += last != "no error";
  CHECK(refused == tries);
  check_words(last, {by_event ? "'watch'" : "'wire'", "int"});
  CHECK(run.state().t <= 0.5);
  broken = false;
  const SimulationReport& report = run.run_until(1);
  CHECK(run.state().v[1] == Approx(3).epsilon(1e-12));
  if (method == "rk4") CHECK(report.steps == 64);
  CHECK(report.findings.empty());
}

TEST_CASE("one snapshot is loaded twice, and by several threads at once", "[unit][checkpoint]") {
  const auto make = [](FourBar& bar) {
    auto run = std::make_unique<Simulation>(bar.system, SimulationOptions{.output = 0.125});
    run->record({"crank.angle_z", "energy.total", "torque.value"});
    return run;
  };
  FourBar bar;
  const auto whole = make(bar);
  bar.torque.set(2.5);
  whole->run_until(0.5);
  Snapshot saved;
  whole->loop().save(saved);
  const std::vector<double> numbers = saved.numbers();
  const Snapshot& at_half = saved;
  whole->run_until(1);
  constexpr int kThreads = 4;
  std::vector<std::vector<double>> ends(kThreads);
  std::vector<double> torques(kThreads);
  std::vector<std::thread> threads;
  for (int k = 0; k < kThreads; ++k)
    threads.emplace_back([&, k] {
      FourBar own;
      const auto run = make(own);
      for (int twice = 0; twice < 2; ++twice) {
        run->loop().load(at_half);
        run->run_until(1);
      }
      ends[k] = run->table()["crank.angle_z"];
      torques[k] = run->table()["torque.value"].back();
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& end : ends) CHECK(end == whole->table()["crank.angle_z"]);
  for (const double torque : torques) CHECK(torque == 2.5);
  CHECK(saved.numbers() == numbers);
  whole->loop().load(saved);
  CHECK(whole->state().t == 0.5);
  Snapshot more = saved;
  more.put(1);
  check_words(message_of<ModelError>([&] { whole->loop().load(more); }), {"more numbers", "checkpoint"});
}

TEST_CASE("the value of an input acts from its time on, in every method", "[unit][dynamics]") {
  const auto method = GENERATE(from_range(std::begin(kMethods), std::end(kMethods)));
  const bool inside = GENERATE(false, true);  // of one call, between its steps
  CAPTURE(method, inside);
  Pushed pushed;
  Simulation run(pushed.system, {.integrator = method, .step = 0.125});
  ControlInput& push = run.input("push");
  CHECK(&push == &pushed.u);
  const auto next = [&](double t) { push.set(t < 1 ? 6 : t < 2 ? -2 : 1); };
  double impulse = 0, to = 0;
  next(0);
  const auto after = [&](double t) { impulse += push.value() * (t - to), to = t, next(t); };
  if (inside) {
    run.loop().progress = [&](const State& s) { return after(s.t), true; };
    run.run_until(4);
  } else {
    while (run.state().t < 4) run.advance(0.5), after(run.state().t);
  }
  if (!inside || !adaptive(method)) CHECK(impulse == Approx(6).epsilon(1e-12));
  CHECK(speed(run) == Approx(impulse / 2).epsilon(1e-12));
}

TEST_CASE("laws read inputs, checkpoints keep them, channels show them", "[unit][dynamics]") {
  struct Led {
    System system;
    Body& stone = system.add_particle("stone", 2, {0, 0, 0});
    ControlInput& u = system.add_input("push", 4, "N");
    std::unique_ptr<Simulation> run;
    Led() {
      system.add(std::make_unique<AppliedForce>(
          "motor", system.add_marker("p", stone),
          AppliedForce::Options{.law = laws::law([this](auto t) { return u.value() + 0 * t; }),
                                .direction = {1, 0, 0}}));
      run = std::make_unique<Simulation>(system, SimulationOptions{.integrator = "radau5", .output = 0.5});
      run->record({"stone.vx", "push.value"});
    }
  } led, other;
  led.run->run_until(1);
  led.u.set(-1);
  led.run->run_until(2);
  Snapshot saved;
  led.run->loop().save(saved);
  led.run->run_until(3);
  CHECK(led.run->table()["stone.vx"].back() == Approx(2 - 0.5 - 0.5).epsilon(1e-9));
  CHECK(led.run->table()["push.value"] == std::vector<double>{4, 4, 4, -1, -1, -1, -1});
  CHECK(led.run->table().column("push.value").unit == "N");
  other.run->loop().load(saved);
  CHECK(other.u.value() == -1);
  other.run->run_until(3);
  CHECK(other.run->table()["stone.vx"] == led.run->table()["stone.vx"]);
}

TEST_CASE("impossible inputs are rejected by name", "[unit][dynamics]") {
  Pushed pushed;
  Simulation run(pushed.system);
  pushed.u.set(3);
  for (const double odd : {std::nan(""), std::numeric_limits<double>::infinity()})
    check_words(message_of<ParameterError>([&] { pushed.u.set(odd); }), {"input 'push'", "value", "finite", "stays 3"});
  CHECK(pushed.u.value() == 3);
  check_words(message_of<ModelError>([&] { run.input("pusch"); }), {"unknown input \"pusch\"", "push"});
  check_words(message_of<ModelError>([&] { pushed.system.add_input("stone"); }),
              {"input 'stone'", "already taken", "body"});
  check_words(message_of<ModelError>([&] { pushed.system.add_body("push", shapes::sphere(1, 1)); }),
              {"body 'push'", "taken by a control input"});
}

TEST_CASE("advance ends at exactly t + h, in the steps that it needs", "[unit][dynamics]") {
  Stone stone;
  stone.stone.start.v = {1, 0, 0};
  const auto steps_of = [&](double step, double h) {
    Simulation run(stone.system, {.integrator = "rk4", .step = step});
    for (int k = 0; k < 50; ++k) {
      const double t = run.state().t;
      run.advance(h);
      CHECK(run.state().t == t + h);
    }
    return run.loop().report().steps;
  };
  CHECK(steps_of(1e-4, 1e-3) == 50 * 10);
  CHECK(steps_of(3e-4, 1e-3) == 50 * 4);
  CHECK(steps_of(1e-3, 1e-3) == 50);
  CHECK(steps_of(1, 1e-3) == 50);
  Simulation run(stone.system);
  long rows = 0;
  run.on_row([&](std::span<const double>) { ++rows; });
  for (int k = 0; k < 1000; ++k) run.advance(1e-3);
  CHECK(run.loop().report().steps == 1000);
  const double t = run.state().t;
  run.advance(1000);  // the step has grown all the while
  CHECK(run.state().t == t + 1000);
  CHECK(run.loop().report().steps <= 1000 + 12);
  CHECK(rows == run.loop().report().steps + 1);
  for (const double odd : {-1e-3, std::nan(""), std::numeric_limits<double>::infinity(), 1e-17})
    check_words(message_of<ModelError>([&] { run.advance(odd); }), {"an advance of", "must be greater than 0", "round-off"});
  run.advance(0);
  CHECK(run.state().t == t + 1000);
}

TEST_CASE("advance gives the same as one call, and output at the requested times alone", "[unit][dynamics]") {
  FourBar one, many;
  Simulation whole(one.system, {.tolerance = 1e-10, .output = 0.125}),
      parts(many.system, {.tolerance = 1e-10, .output = 0.125});
  whole.record({"crank.angle_z"}), parts.record({"crank.angle_z"});
  whole.run_until(1);
  while (parts.state().t < 1) parts.advance(0.0078125);
  CHECK(parts.table()["t"] == whole.table()["t"]);
  for (std::size_t k = 0; k < 9; ++k)
    CHECK(parts.table()["crank.angle_z"][k] == Approx(whole.table()["crank.angle_z"][k]).margin(1e-8));
}

TEST_CASE("a controller's calls take no memory and no more evaluations than their steps", "[unit][dynamics]") {
  struct Expected {
    const char* method;
    long evaluations;  // a call; 0: as many as Newton's method takes
  };
  const auto [method, evaluations] = GENERATE(from_range(std::vector<Expected>{
      {"semi_implicit_euler", 1}, {"rk4", 4}, {"dopri5", 7}, {"dop853", 12}, {"generalized_alpha", 0}, {"radau5", 0}}));
  const int way = GENERATE(0, 1, 2);
  CAPTURE(method, way);
  FourBar bar;
  Simulation run(bar.system,
                 {.integrator = method, .tolerance = 1e-6, .step = adaptive(method) ? 0.0 : 1e-3, .output = 0.25});
  ControlInput& torque = run.input("torque");
  StepLoop& loop = run.loop();
  const auto calls = [&](int n) {
    for (int k = 0; k < n; ++k) {
      torque.set(1 + 0.25 * std::sin(20 * loop.state().t) -
                 0.01 * body_twist(bar.system.body("crank"), loop.state()).w.z());
      if (way == 0) loop.run_until(loop.state().t + 1e-3);
      if (way == 1) loop.step(1e-3);
      if (way == 2) loop.advance(1e-3);
    }
  };
  run.recorder().reserve(1000);
  calls(60);
  const long before = run.dynamics().work().evaluations;
  const long taken = allocations_of([&] { calls(100); });
  if (allocations_are_counted()) CHECK(taken == 0);
  if (evaluations > 0) CHECK(run.dynamics().work().evaluations - before <= evaluations * 100 + 10);
}

TEST_CASE("outputs reach the host as they are made", "[unit][record]") {
  const bool keep = GENERATE(false, true);
  Stone stone;
  stone.stone.start.v = {3, 0, 0};
  Simulation run(stone.system, {.output = 0.25});
  run.record({"stone.x", {"v", "stone.vx"}});
  std::vector<std::vector<double>> rows;
  bool broken = true;
  run.on_row(
      [&](std::span<const double> row) {
        if (broken && row[0] == 0.5) throw 7;
        rows.emplace_back(row.begin(), row.end());
      },
      keep);
  for (int k = 0; k < 3; ++k)
    check_words(message_of<UserCodeError>([&] { run.run_until(1); }), {"on_row", "int", "0.5 s"});
  broken = false;
  run.run_until(1);
  REQUIRE(rows.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    const double t = 0.25 * static_cast<double>(k);
    CHECK(rows[k].size() == 3);
    CHECK(rows[k][0] == t);
    CHECK(rows[k][1] == Approx(3 * t).epsilon(1e-12));
    CHECK(rows[k][2] == 3);
  }
  CHECK(run.table().n_rows() == (keep ? 5 : 0));
  run.on_row({});
  run.run_until(2);
  CHECK(rows.size() == 5);
  CHECK(run.table().n_rows() == (keep ? 9 : 4));
}

}  // namespace hosts_now_test
