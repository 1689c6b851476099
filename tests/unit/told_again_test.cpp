// SPDX-License-Identifier: BSD-3-Clause
// A table loses no row, whoever throws while a row is made: the recorder is told of that output again when the run goes
// on, and nobody else is.
#include <lockstep/recorder.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/tools/scene_run/rows_at_jumps.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace told_again_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

/// A stone thrown upwards, in a loop with a recorder between two observers that count their outputs.
struct Throw {
  System system{System::Options{{0, 0, -10}}};
  Body& stone = system.add_particle("stone", 1, Vec3::Zero());
  Recorder recorder{system};
  struct Counter final : Observer {
    std::vector<double> outputs;
    void output(const Sample& s) override { outputs.push_back(s.state.t); }
  } before, after;
  std::unique_ptr<Dynamics> dynamics;
  std::unique_ptr<StepLoop> loop;

  void begin(const std::string& method, StepLoopOptions options) {
    stone.start.v = {0, 0, 10};
    recorder.add("z", "m", [](const Sample& s) { return s.state.q[2]; });
    dynamics = std::make_unique<Dynamics>(system, std::make_unique<SchurSolver>());
    loop = std::make_unique<StepLoop>(*dynamics, make_integrator(MethodSpec{method}, builtin_registry(), "integrator"),
                                      std::move(options));
    loop->add_observer(before), loop->add_observer(recorder), loop->add_observer(after);
  }
};

/// Counts its calls, and fails between 0.3 and 0.42 s.
struct FailingMemory final : Observer {
  int calls = 0;
  void start(const Sample& s) override { step(s); }
  void step(const Sample& s) override {
    ++calls;
    if (s.state.t > 0.3 && s.state.t < 0.42) throw 7;
  }
};

// Rows 0, 0.1, ... 1 of z = 10 t - 5 t^2.
void check_rows(const Table& table, std::size_t n = 11) {
  REQUIRE(table.n_rows() == n);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    CHECK(table["t"][i] == Approx(t).margin(1e-12));
    CHECK(table["z"][i] == Approx(10 * t - 5 * t * t).margin(1e-9));
  }
}

}  // namespace

TEST_CASE("a channel that throws once loses no output, wherever it is", "[unit][record]") {
  const auto method = GENERATE(as<std::string>(), "rk4", "dopri5", "radau5", "generalized_alpha");
  for (const double at : {0.1, 0.5, 1.0}) {
    CAPTURE(method, at);
    Throw run;
    bool armed = true;
    run.recorder.add("price", "EUR", [&](const Sample& s) {
      if (armed && std::abs(s.state.t - at) < 1e-9) armed = false, throw 7;
      return 1.0;
    });
    const bool adaptive = method == "dopri5" || method == "radau5";
    run.begin(method, {.step = adaptive ? 0.0 : 0.05, .output = 0.1});
    check_words(message_of<UserCodeError>([&] { run.loop->run_until(1); }), {"channel 'price'", "int"});
    CHECK(run.recorder.table().n_rows() == static_cast<std::size_t>(std::lround(10 * at)));
    run.loop->run_until(1);
    check_rows(run.recorder.table());
    const std::vector<double>& times = run.recorder.table()["t"];
    CHECK(run.before.outputs == times);
    CHECK(run.after.outputs == times);
  }
}

TEST_CASE("a channel that throws always ends every run at its instant, by name", "[unit][record]") {
  Throw run;
  bool mended = false;
  run.recorder.add("price", "EUR", [&](const Sample& s) { return s.state.t > 0.45 && !mended ? throw 7 : 1.0; });
  run.begin("dopri5", {.output = 0.1});
  for (int k = 0; k < 3; ++k) {
    check_words(message_of<UserCodeError>([&] { run.loop->run_until(1); }),
                {"t = 0.5 s: channel 'price' threw", "int"});
    CHECK(run.recorder.table().n_rows() == 5);
    CHECK(run.before.outputs.size() == 6);
    CHECK(run.after.outputs.size() == 5);
  }
  mended = true;
  run.loop->run_until(1);
  check_rows(run.recorder.table());
  CHECK(run.before.outputs == run.recorder.table()["t"]);
}

TEST_CASE("a force that throws at any of its calls loses no output and doubles none", "[unit][record]") {
  const auto method = GENERATE(as<std::string>(), "rk4", "dopri5", "radau5", "generalized_alpha");
  const bool adaptive = method == "dopri5" || method == "radau5";
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  Marker& p = system.add_marker("p", rod);
  long n = 0, at = -1;
  system.add(function_force("pull", {&p}, [&](const Inputs& in, WrenchSum& out) {
    if (n++ == at) throw 7;
    out.force(rod.slot, {0, 1, 0}, in.slot(rod.slot).x);
  }));
  int thrown = 0;
  const auto table_of = [&](long call) {
    Simulation run(system, {.integrator = method, .step = adaptive ? 0.0 : 0.01, .output = 0.01});
    run.record({"rod.x", "pull.power", "energy.total"});
    at = -1, run.state();
    n = 0, at = call;
    int errors = 0;
    while (errors < 3 && message_of<UserCodeError>([&] { run.run_until(0.2); }) != "no error") ++errors;
    CHECK(errors <= 1);
    thrown += errors;
    return run.table();
  };
  const Table calm = table_of(-1);
  REQUIRE(calm.n_rows() == 21);
  const long calls = n;
  for (long call = 0; call < calls; ++call) {
    CAPTURE(method, call);
    const Table table = table_of(call);
    REQUIRE(table["t"] == calm["t"]);
    for (std::size_t i = 0; i < calm.n_rows(); ++i) CHECK(table["rod.x"][i] == Approx(calm["rod.x"][i]).margin(1e-6));
  }
  CHECK(thrown > calls / 2);
}

TEST_CASE("outputs at a jump are made again too", "[unit][record]") {
  Throw run;
  int calls = 0, fails_at = GENERATE(0, 1);
  std::vector<double> speeds;
  RowsAtJumps rows(
      [&](const Sample& s) {
        if (calls++ == fails_at) throw 7;
        speeds.push_back(s.state.v[0]);
      },
      run.recorder);
  run.begin("dopri5", {.output = 0.1});
  run.loop->add_observer(rows);
  Event push{.name = "push", .at = 0.25};
  push.change = [](State& s) { s.v[0] += 3; };
  run.loop->add_event(push);
  CHECK(message_of<UserCodeError>([&] { run.loop->run_until(1); }) != "no error");
  run.loop->run_until(1);
  CHECK(speeds == std::vector<double>{0, 3});
  check_rows(run.recorder.table());
}

TEST_CASE("a recorder that fails outside of a run is not called twice in it", "[unit][record]") {
  Throw run;
  bool armed = false;
  const auto memory = std::make_shared<FailingMemory>();
  run.recorder.add({"price", "EUR", [&](const Sample&) { return armed ? throw 7 : 1.0; }, memory});
  run.begin("rk4", {.step = 0.05, .output = 0.1});
  run.loop->run_until(0.3);
  const StepReport report;
  const Sample outside(*run.dynamics, run.loop->state(), report);
  armed = true;
  check_words(message_of<UserCodeError>([&] { run.recorder.output(outside); }), {"price", "an object of type int"});
  armed = false;
  const int before = memory->calls;
  const long steps = run.loop->report().steps;
  int errors = 0;
  while (errors < 9 && message_of<UserCodeError>([&] { run.loop->run_until(1); }) != "no error") ++errors;
  CHECK(errors == 2);  // after the steps to 0.35 and 0.4 s
  CHECK(memory->calls - before == run.loop->report().steps - steps);
  check_rows(run.recorder.table());
}

}  // namespace told_again_test
