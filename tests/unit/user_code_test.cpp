// What users' code throws: its name reaches the host, and the run goes on from the last accepted state.
#include <lockstep/step_loop.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/recorder.h>
#include <lockstep/registry.h>
#include "framework/dynamics/simulate/detail_observer.h"
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

TEST_CASE("what a force throws has its name, whichever call of whichever method it is", "[unit][dynamics]") {
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
    CHECK(n_named > 3);
  }
}

TEST_CASE("what an observer throws has a name, and the run goes on as if it had not", "[unit][dynamics]") {
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
struct Looker final : DetailObserver {
  bool throws = false;
  std::vector<double> before, after;
  double spacing() const override { return HUGE_VAL; }
  void between(const Sample&) override {}
  void before_jump(const Sample& s) override {
    if (throws) throws = false, throw 7;
    before.push_back(s.state.t);
  }
  void jumped(const Sample& s) override { after.push_back(s.state.t); }
};

}  // namespace

TEST_CASE("what an observer throws before a jump has a name, and nobody is told of the jump twice",
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

TEST_CASE("what an integrated state or a channel of the user's own throws has a name", "[unit][dynamics]") {
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
