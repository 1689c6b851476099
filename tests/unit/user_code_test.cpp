// SPDX-License-Identifier: BSD-3-Clause
// What users' code throws: its name reaches the host, and the run goes on from the last accepted state.
#include <lockstep/step_loop.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace user_code_test {

using lockstep::testing::check_words, lockstep::testing::message_of;

using namespace lockstep;

namespace {

/// Throws where it is told to, once.
struct Thrower final : Observer {
  std::string where;
  double from = 0;
  int starts = 0, finishes = 0;
  std::vector<double> steps, outputs, jumps;
  void may(const char* here, double t) {
    if (where != here || t < from) return;
    where.clear();
    throw 7;
  }
  void start(const Sample& s) override { may("start", s.state.t), ++starts, outputs.clear(); }
  void step(const Sample& s) override { may("step", s.state.t), steps.push_back(s.state.t); }
  void output(const Sample& s) override { may("output", s.state.t), outputs.push_back(s.state.t); }
  void jumped(const Sample& s) override { may("jumped", s.state.t), jumps.push_back(s.state.t); }
  void finish(const Sample& s) override { ++finishes, may("finish", s.state.t); }
};

}  // namespace

TEST_CASE("an exception of a force has its name, in every call of every method", "[unit][dynamics]") {
  const Registry registry = builtin_registry();
  for (const std::string& method : registry.integrators.names()) {
    long n_named = 0, n = 0;
    const auto said_at = [&](long call) {
      System system;
      Body& body = system.add_body("bob", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
      Marker& at = system.add_marker("at", body);
      n = 0;
      system.add(function_force("pull", {&at}, [&](const Inputs& in, WrenchSum& out) {
        if (++n == call) throw "a text";
        out.force(body.slot, {1, 0, 0}, in.slot(body.slot).x);
      }));
      Dynamics dynamics = dynamics_of(system);
      StepLoop run(dynamics, make_integrator(MethodSpec{method}, registry, "integrator"), {.step = 0.01});
      return message_of<UserCodeError>([&] { run.run_until(0.03); });
    };
    for (long call = 1; call < 60; ++call) {
      const std::string said = said_at(call);
      if (n < call) break;               // the run makes no more calls
      if (said == "no error") continue;  // one that set-up tries things out by
      INFO(method << ", call " << call);
      check_words(said, {"force 'pull'"});
      ++n_named;
    }
    INFO(method);
    CHECK(n_named >= 3);  // in each step
  }
}

namespace {

/// Throws at one of its calls, once it is armed.
struct Fuse {
  bool armed = false;
  long n = 0, call = 0;
  void burn() {
    if (armed && ++n == call) throw 7;
  }
};

struct GrowingLength final : MotionLaw {
  Fuse& fuse;
  explicit GrowingLength(Fuse& f) : fuse(f) {}
  LawValue at(double t) const override {
    fuse.burn();
    return {0.9 + 0.2 * t, 0.2, 0};
  }
};

// Two rods on the ground, their ends held apart by a law; a force on one of them. What throws is the force or the law.
State end_of_loop(bool by_force, long call, long& n, int& errors) {
  Fuse of_force, of_law;
  Fuse& fuse = by_force ? of_force : of_law;
  fuse.call = call;
  System system({.gravity = Vec3(0, -9.81, 0)});
  Body& left = system.add_body("left", shapes::rod(1.0, {0, 0, 0}, {0, 0.4, 0}));
  Body& right = system.add_body("right", shapes::rod(2.0, {0.9, 0.4, 0}, {0.9, 0, 0}));
  system.add<Revolute>("A", left, system.ground(), pose_at(Vec3(0, 0, 0)));
  system.add<Revolute>("B", right, system.ground(), pose_at(Vec3(0.9, 0, 0)));
  Marker &p = system.add_marker_at("p", left, pose_at(Vec3(0, 0.4, 0))),
         &q = system.add_marker_at("q", right, pose_at(Vec3(0.9, 0.4, 0)));
  system.add<Distance>("reach", p, q, std::make_shared<GrowingLength>(of_law));
  system.add(function_force("pull", {&p}, [&](const Inputs& in, WrenchSum& out) {
    of_force.burn();
    out.force(left.slot, {1, 0, 0}, in.slot(left.slot).x);
  }));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
  State start = system.start();
  assemble(dynamics, start);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.tolerance = {1e-10, 1e-10}});
  run.set_state(start);
  fuse.armed = true;
  for (std::string said; said != "no error";) {
    said = message_of<UserCodeError>([&] { run.run_until(0.2); });
    if (said == "no error") break;
    check_words(said, {by_force ? "force 'pull'" : "joint 'reach'", "int"});
    REQUIRE(++errors < 3);
  }
  n = fuse.n;
  CHECK(run.state().t == 0.2);
  CHECK(run.state().coordinates != nullptr);
  State end = run.state();
  dynamics.to_slots(end);
  return end;
}

}  // namespace

TEST_CASE("an exception of a force or a law in the joint coordinates of a loop leaves the run unchanged",
          "[unit][dynamics]") {
  const bool by_force = GENERATE(true, false);
  long calls = 0, n = 0;
  int errors = 0;
  const State expected = end_of_loop(by_force, -1, calls, errors);
  CHECK(errors == 0);
  REQUIRE(calls > 40);
  int seen = 0;  // what throws in a pose that is only tried, for the redundant rows, answers nothing
  for (long call = 1; call <= calls; call += 1 + calls / 40) {
    CAPTURE(by_force, call);
    errors = 0;
    const State end = end_of_loop(by_force, call, n, errors);
    CHECK(errors <= 1);
    seen += errors;
    CHECK((end.q - expected.q).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((end.v - expected.v).cwiseAbs().maxCoeff() < 1e-8);
  }
  CHECK(seen > 20);
}

TEST_CASE("an exception of a force in a repeated call has its name too", "[unit][dynamics]") {
  // A first call that is wrong in some way, and a second one, to find out whose fault that is, which throws.
  struct Wrong {
    const char* what;
    bool particle, planar;
    Vec3 force, moment;
  };
  const double infinite = std::numeric_limits<double>::infinity();
  for (const Wrong& wrong : {Wrong{"not finite", false, false, {infinite, 0, 0}, {0, 0, 0}},
                             Wrong{"a moment on a particle", true, false, {0, 0, 0}, {0, 0, 1}},
                             Wrong{"out of the plane", false, true, {1, 0, 1}, {0, 0, 0}}}) {
    CAPTURE(wrong.what);
    System system;
    if (wrong.planar) system.set_planar(Plane{2});
    Body& body = wrong.particle ? system.add_particle("bob", 1, Vec3::Zero())
                                : system.add_body("bob", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
    Marker& at = system.add_marker("at", body);
    bool armed = false;
    int n = 0;
    system.add(function_force("pull", {&at}, [&](const Inputs& in, WrenchSum& out) {
      if (!armed) return;
      if (++n == 2) throw 7;
      out.force(body.slot, wrong.force, in.slot(body.slot).x);
      out.torque(body.slot, wrong.moment);
    }));
    Dynamics dynamics = dynamics_of(system);
    const State start = system.start();
    armed = true;
    check_words(message_of<UserCodeError>([&] {
                  State state = start;
                  dynamics.project_velocity(state);
                  dynamics.evaluate(state);
                }),
                {"force 'pull'", "int"});
    CHECK(n == 2);
  }
  System system;
  Body& body = system.add_body("bob", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  Marker& at = system.add_marker("at", body);
  int n = 0, last = -1;
  system.add(function_force("pull", {&at}, [&](const Inputs& in, WrenchSum& out) {
    if (++n == last) throw 7;
    out.force(body.slot, Vec3(1, 0, 0), in.slot(body.slot).x);
  }));
  const Channel power = make_channel(system, "pull.power");
  Dynamics dynamics = dynamics_of(system);
  const State state = system.start();
  const StepReport report;
  const Sample sample(dynamics, state, report);
  sample.values();
  last = n + 1;
  check_words(message_of<UserCodeError>([&] { power.value(sample); }), {"force 'pull'", "int"});
}

TEST_CASE("an exception of an observer has a name, and the run continues as without it", "[unit][dynamics]") {
  const auto [where, from] = GENERATE(table<std::string, double>({{"start", 0.0},
                                                                  {"jumped", 0.0},
                                                                  {"step", 0.1},
                                                                  {"output", 0.1},
                                                                  {"output", 0.31},
                                                                  {"jumped", 0.2},
                                                                  {"finish", 0.0}}));
  CAPTURE(where, from);
  const bool at_end = where == "finish";  // the run is over then
  const auto outputs_of = [at_end](Thrower& before, Thrower& after) {
    Stone stone;
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, std::make_unique<Dopri5>(), {.step = 0.05, .output = 0.02});
    run.add_observer(before), run.add_observer(after);
    for (const double t : {0.0, 0.17}) {
      Event push{.name = "push", .at = t};
      push.change = [](State& s) { s.v[2] += 1; };
      run.add_event(push);
    }
    Event stop{.name = "stop", .at = 0.2, .stop = true};
    stop.change = [](State& s) { s.v[0] += 1; };
    run.add_event(stop);
    int errors = 0;
    const auto go_on = [&](double t) {
      std::string said;
      do {
        said = message_of<UserCodeError>([&] { run.run_until(t); });
        if (said != "no error") ++errors, check_words(said, {"observer", "int"});
      } while (said != "no error" && errors < 5 && !at_end);
    };
    go_on(0.315);
    CHECK(run.report().stopped_by == "stop");
    CHECK(run.state().t == 0.2);
    go_on(0.315);
    CHECK(run.state().t == 0.315);
    CHECK(errors <= 1);
    return run.state().q[2];
  };
  Thrower calm_before, calm_after, before, after;
  const double expected = outputs_of(calm_before, calm_after);
  before.where = where, before.from = from;
  const double found = outputs_of(before, after);
  CHECK(found == Approx(expected).epsilon(1e-12));
  const auto rise = [](const std::vector<double>& t) {
    return std::ranges::adjacent_find(t, std::greater_equal<>()) == t.end();
  };
  CHECK(after.outputs == calm_after.outputs);
  CHECK(calm_after.outputs.back() == 0.315);
  for (const Thrower* o : {&before, &after}) {
    CHECK(rise(o->steps));
    CHECK(rise(o->outputs));
  }
  const bool again = where == "jumped" && from == 0;  // the start is made again, and told again
  CHECK(after.jumps == calm_after.jumps);
  if (where == "step" || where == "finish" || again) CHECK(before.outputs == calm_before.outputs);
  if (where == "output") CHECK(before.outputs.size() + 1 == calm_before.outputs.size());
}

namespace {

/// Looks before jumps; the one that is to throw does so once.
struct Looker final : Observer {
  bool throws = false;
  std::vector<double> before, after;
  void before_jump(const Sample& s) override {
    if (throws) throws = false, throw 7;
    before.push_back(s.state.t);
  }
  void jumped(const Sample& s) override { after.push_back(s.state.t); }
};

}  // namespace

TEST_CASE("an exception of an observer before a jump has a name, and no observer receives the jump twice",
          "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.step = 0.05});
  Looker first, second, third;
  second.throws = true;
  for (Looker* o : {&first, &second, &third}) run.add_observer(*o);
  Event push{.name = "push", .at = 0.17};
  push.change = [](State& s) { s.v[2] += 1; };
  run.add_event(push);
  check_words(message_of<UserCodeError>([&] { run.run_until(0.3); }), {"observer", "int", "0.17"});
  CHECK(run.state().t == 0.17);
  CHECK(third.before.empty());
  run.run_until(0.3);
  CHECK(first.before == std::vector<double>{0.17});
  CHECK(second.before.empty());
  CHECK(third.before == std::vector<double>{0.17});
  for (const Looker* o : {&first, &second, &third}) CHECK(o->after == std::vector<double>{0.17});
}

TEST_CASE("a change that throws leaves the state, and its event is due again", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  int calls = 0;
  Event first{.name = "first", .at = 0.5};
  first.change = [](State& s) { s.v[0] += 1; };
  Event second{.name = "second", .at = 0.5};
  second.change = [&](State& s) {
    s.v[1] = 100, s.q[0] = 100;
    if (++calls == 1) throw std::runtime_error("not yet");
    s.q[0] = 0.25;
  };
  run.add_event(first), run.add_event(second);
  check_words(message_of<UserCodeError>([&] { run.run_until(1); }), {"event 'second'", "0.5", "not yet"});
  CHECK(run.state().t == 0.5);
  CHECK(run.state().v[0] == 0);
  CHECK(run.state().v[1] == 0);
  CHECK(run.state().q[0] == 0);
  run.run_until(1);
  CHECK(calls == 2);
  CHECK(run.state().v[0] == 1);
  CHECK(run.state().q[0] == Approx(0.75));
}

TEST_CASE("user code may neither run the loop nor set its time", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  Event event{.name = "eager", .at = 0.5};
  SECTION("run") {
    event.change = [&](State&) { run.run_until(2); };
    run.add_event(event);
    check_words(message_of<ModelError>([&] { run.run_until(1); }), {"run_until", "inside the run"});
  }
  SECTION("time") {
    event.change = [](State& s) { s.t = 0; };
    run.add_event(event);
    check_words(message_of<ModelError>([&] { run.run_until(1); }), {"event 'eager'", "from 0.5 s to 0 s"});
  }
  SECTION("progress") {
    run.progress = [](const State&) -> bool { throw std::runtime_error("window closed"); };
    check_words(message_of<UserCodeError>([&] { run.run_until(1); }), {"progress", "window closed"});
  }
  CHECK(run.state().t <= 0.5);
}

TEST_CASE("an exception of a custom integrated state or channel has a name", "[unit][dynamics]") {
  struct Failing final : Auxiliary {
    Failing() : Auxiliary("controller") {}
    int size() const override { return 1; }
    void rates(const Evaluated& at, std::span<double> sd) const override {
      if (at.in.t > 0.2) throw 7;
      sd[0] = 1;
    }
  };
  Stone stone;
  SECTION("state") {
    stone.system.add(std::make_unique<Failing>());
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.1});
    try {
      run.run_until(1);
      FAIL("nothing was thrown");
    } catch (const UserCodeError& error) {
      check_words(error.what(), {"integrated state 'controller'", "t = 0.25"});
      CHECK(error.thing.name == "controller");
      CHECK_THROWS_AS(std::rethrow_if_nested(error), int);
    }
    CHECK(run.state().t == Approx(0.2));
  }
  SECTION("channel") {
    Recorder recorder(stone.system);
    recorder.add("price", "EUR", [](const Sample& s) -> double { return s.state.t > 0.2 ? throw 7 : 1.0; });
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.1});
    run.add_observer(recorder);
    const std::string said = message_of<UserCodeError>([&] { run.run_until(1); });
    check_words(said, {"channel 'price'", "t = 0.3"});
  }
}

}  // namespace user_code_test
