// SPDX-License-Identifier: BSD-3-Clause
// A sweep of pendulums against their closed forms.
#include <lockstep/sweep.h>

#include <array>
#include <cmath>

#include <lockstep/analysis.h>
#include <lockstep/author/registry.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace sweep_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

// Starts at sin(angle) = 0.6 beside the lowest point; an event ends the run there.
const char* const kPendulum = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "bob", "particle": 1, "position": [0.6, -0.8, 0]}],
  "links": [{"name": "bar", "type": "distance", "p": "bob", "s": "ground", "at_s": [0, 0, 0], "length": 1}],
  "events": [{"name": "lowest", "when": {"channel": "bob.x", "crosses": 0}, "stop": true}],
  "run": {"until": 10, "integrator": "dop853", "tolerance": 1e-11, "record": ["bob.x", {"speed": "bob.vx"}]}})";

struct Swept {
  Registry registry = builtin_registry();
  Scene scene;
  std::vector<Variable> variables;
  Grid grid;
  Table columns;
  Swept(const char* text, const std::vector<std::string>& vary)
      : scene(scene_from_text(text, "scene.json")),
        variables(read_variables(vary, scene, registry)),
        grid(sizes()),
        columns(recorded_columns(scene, registry)) {}
  std::vector<std::size_t> sizes() const {
    std::vector<std::size_t> all;
    for (const Variable& v : variables) all.push_back(v.values.size());
    return all;
  }
  SweepRun run(long number, Table* history = nullptr) const {
    return sweep_run(vary_scene(scene, variables, grid.at(number), registry), registry, columns, {}, history);
  }
  std::string row(long number) const { return sweep_row(number, variables, grid.at(number), columns, run(number)); }
};

}  // namespace

TEST_CASE("pendulums of several lengths reach their lowest point after a quarter of their period", "[unit][scene]") {
  const Swept sweep(kPendulum, {"links.bar.length=250 mm:1.5 m:6", "gravity.1=-9.81,-1.62"});
  REQUIRE(sweep.grid.n_runs() == 12);
  for (long k = 1; k <= 12; ++k) {
    const auto choice = sweep.grid.at(k);
    const double length = *sweep.variables[0].values[choice[0]].number();
    const double g = -*sweep.variables[1].values[choice[1]].number();
    const SweepRun r = sweep.run(k);
    INFO(setting_text(sweep.variables, choice) << ": " << r.status);
    CHECK(r.status == "stopped by 'lowest'");
    CHECK_FALSE(r.failed);
    // T = 4 sqrt(l / g) K(sin(angle / 2)); the energy gives the speed.
    const double quarter = std::sqrt(length / g) * std::comp_ellint_1(std::sin(0.5 * std::asin(0.6)));
    const double speed = std::sqrt(2 * g * length * (1 - 0.8)), instant = 1.1e-9;  // events are located to 1e-9 s
    CHECK(std::abs(r.t - quarter) < instant);
    REQUIRE(r.columns.size() == 2);
    CHECK(std::abs(r.columns[0].last) < instant * speed);
    CHECK(r.columns[0].most == Approx(0.6 * length).epsilon(1e-12));
    CHECK(r.columns[0].least == r.columns[0].last);
    CHECK(r.columns[1].least == Approx(-speed).epsilon(1e-9));
    CHECK(r.columns[1].most == 0);
    CHECK(r.steps > 0);
    CHECK(r.cpu > 0);
  }
}

TEST_CASE("a run that fails is a line with its reason, the others stay", "[unit][scene]") {
  const Swept sweep(kPendulum, {"bodies.bob.particle=1,-1,2"});
  CHECK(sweep_header(sweep.variables, sweep.columns) ==
        "run,bodies.bob.particle [kg],t final [s],bob.x final [m],bob.x min [m],bob.x max [m],"
        "speed final [m/s],speed min [m/s],speed max [m/s],energy,imbalance,violation [m],steps,cpu [s],status\n");
  const std::string failed = sweep.row(2);
  CHECK(failed.rfind("2,-1,,,,,,,,,,,0,", 0) == 0);
  check_words(failed, {"\"failed: scene.json:2:", "body 'bob'", "must be greater than 0"});
  CHECK(failed.find('\n') == failed.size() - 1);
  for (const long k : {1l, 3l}) CHECK(sweep.row(k).find(",stopped by 'lowest'\n") != std::string::npos);
  CHECK(sweep.run(1).t == Approx(sweep.run(3).t).epsilon(1e-9));  // the period knows no mass
}

TEST_CASE("the line of a run reports whether it failed, was wrong, and how it ended", "[unit][scene]") {
  SweepRun run;
  run.status = "ok";
  CHECK(run.outcome() == "ok");
  run.wrong = true;
  CHECK(run.outcome() == "wrong");
  Table columns;
  columns.add_column("t", "s");
  CHECK(sweep_row(7, {}, {}, columns, run).ends_with(",wrong\n"));
  run.status = "stopped by 'landed'";
  CHECK(run.outcome() == "wrong: stopped by 'landed'");
  run.failed = true, run.status = "no way on";
  CHECK(run.outcome() == "failed: no way on");
}

TEST_CASE("a wrong run is read back from its outcome, with any other words in it", "[unit][scene]") {
  for (const std::string status : {"ok", "stopped by 'landed'", "stopped by 'wrong; it was'"})
    for (const long passed : {0l, 1l, 3l})
      for (const bool wrong : {false, true}) {
        SweepRun run;
        run.status = status, run.wrong = wrong, run.passed = passed, run.first_passed = 0.25;
        CAPTURE(run.outcome());
        CHECK(wrong_by(run.outcome()) == wrong);
      }
  SweepRun run;
  run.failed = true, run.status = "wrong: it was";
  CHECK_FALSE(wrong_by(run.outcome()));
}

TEST_CASE("a run that fails on its way keeps its steps and its history", "[unit][scene]") {
  // The law of the arm ends in numbers beyond all bounds for the second value.
  const Swept sweep(R"({"lockstep": 1, "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", "law":
      {"type": "sequence", "durations": [0.5, 9], "laws": [{"type": "constant", "value": 0},
        {"type": "polynomial", "coefficients": [0, 0, 1]}]}}}],
    "run": {"integrator": "rk4", "step": 0.1, "until": 1, "record": ["arm.x"]}})",
                    {"links.A.drive.law.laws.1.coefficients.2=1,1e308,2"});
  CHECK(sweep.run(1).status == "ok");
  Table history;
  const SweepRun broken = sweep.run(2, &history);
  CHECK(broken.failed);
  INFO(broken.status);
  CHECK(broken.status.find("joint 'A'") != std::string::npos);
  CHECK(broken.steps >= 4);
  CHECK(broken.columns.empty());
  CHECK(history.n_rows() == static_cast<std::size_t>(broken.steps) + 1);
  CHECK(history.last("t") == Approx(0.1 * static_cast<double>(broken.steps)));
  CHECK(sweep.run(3, &history).status == "ok");
  CHECK(history.last("t") == Approx(1));
}

TEST_CASE("other columns, no end and no output are failures or gaps, not numbers", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const char* const kBob = R"({"lockstep": 1, "bodies": [{"name": "bob", "particle": 1}], "run": {)";
  const auto scene = [&](const std::string& run) { return scene_from_text(kBob + run + "}}", "bob.json"); };
  const Scene places = scene(R"("until": 1)");
  const Table columns = recorded_columns(places, registry);
  CHECK(columns.names() == std::vector<std::string>{"t", "bob.x", "bob.y", "bob.z"});
  CHECK(sweep_run(places, registry, columns).status == "ok");
  CHECK(sweep_run(scene(R"("until": 1, "record": ["bob.x"])"), registry, columns).failed);
  check_words(sweep_run(scene(""), registry, columns).status, {"no end time", "add \"until\" to \"run\""});
  const SweepRun none = sweep_run(scene(R"("until": 1, "times": [2])"), registry, columns);
  CHECK_FALSE(none.failed);
  CHECK(sweep_row(1, {}, {}, columns, none).rfind("1,,,,,,,,,,,", 0) == 0);
  const SweepRun off = sweep_run(places, registry, columns, [](const State&) { return false; });
  CHECK(off.broken_off);
  CHECK_FALSE(off.failed);
}

}  // namespace sweep_test
