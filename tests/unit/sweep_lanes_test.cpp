// SPDX-License-Identifier: BSD-3-Clause
// Runs of a sweep eight at a time against the same runs one by one.
#include "framework/description/scene/system_of.h"
#include "framework/tools/sweep/sweep_lanes.h"

#include <lockstep/batch.h>

#include <cmath>
#include <initializer_list>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace sweep_lanes_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

std::string scene_text(const std::string& run, const std::string& more = "") {
  return R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
               {"name": "bob", "sphere": {"mass": 2, "radius": 0.1}, "position": [1.3, 0, 0.2]}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "spherical", "p": "bob", "s": "rod", "at": [1, 0, 0]}],)" +
         more + R"("run": {)" + run + "}}";
}
const std::string kRun = R"("until": 1, "output": 0.1, "integrator": "dop853", "tolerance": 1e-10,
  "record": ["bob.x", "bob.y", "A.force_on_p_world_y"])";

struct Runs {
  Registry registry = builtin_registry();
  std::vector<Scene> scenes;
  Table columns;
  Runs(const std::string& text, const std::string& vary) {
    const Scene scene = scene_from_text(text, "scene.json");
    const std::vector<Variable> variables = read_variables({vary}, scene, registry);
    for (std::size_t k = 0; k < variables[0].values.size(); ++k)
      scenes.push_back(vary_scene(scene, variables, {k}, registry));
    columns = recorded_columns(scene, registry);
  }
  std::string unsuited() const { return unsuited_for_lanes(scenes.front(), registry); }
  std::vector<SweepRun> lanes(std::vector<Table>* histories = nullptr) {
    return sweep_lanes(scenes, registry, columns, {}, histories);
  }
};

}  // namespace

TEST_CASE("vectorised runs record the same as single runs, from start to end", "[unit][scene]") {
  Runs group(scene_text(kRun), "bodies.bob.sphere.mass=0.5:4:8");
  std::vector<Table> histories(8);
  const std::vector<SweepRun> lanes = group.lanes(&histories);
  INFO(group.unsuited());
  REQUIRE(lanes.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) {
    Table history;
    const SweepRun alone = sweep_run(group.scenes[k], group.registry, group.columns, {}, &history);
    INFO("copy " << k << ": " << alone.status << ", " << lanes[k].status);
    CHECK(lanes[k].status == "ok");
    CHECK(lanes[k].t == alone.t);
    CHECK(lanes[k].steps > 0);
    REQUIRE(histories[k].n_rows() == history.n_rows());
    for (const char* column : {"t", "bob.x", "bob.y", "A.force_on_p_world_y"})
      for (std::size_t i = 0; i < history.n_rows(); ++i)
        CHECK(std::abs(histories[k][column][i] - history[column][i]) < 1e-6);
    for (std::size_t c = 0; c < alone.columns.size(); ++c) {
      const double part = 2e-4 * (alone.columns[c].most - alone.columns[c].least);
      CHECK(std::abs(lanes[k].columns[c].least - alone.columns[c].least) < part);
      CHECK(std::abs(lanes[k].columns[c].most - alone.columns[c].most) < part);
    }
  }
  CHECK(std::abs(lanes[0].columns[0].last - lanes[7].columns[0].last) > 1e-3);  // the runs do differ
}

TEST_CASE("extremes of vectorised runs are those inside their steps", "[unit][scene]") {
  Runs group(scene_text(R"~("until": 2, "output": 1, "integrator": "dop853", "tolerance": 1e-7,
      "record": ["bob.y", {"F": "=norm(A.force_on_p_world)"}, "bob.vx"])~"),
             "bodies.bob.sphere.mass=0.5:4:8");
  const std::vector<SweepRun> lanes = group.lanes();
  REQUIRE(lanes.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) {
    Scene finely = group.scenes[k];
    finely.run.integrator.type = "rk4", finely.run.step = 2e-4, finely.run.output = 2e-4;
    const SweepRun rows = sweep_run(finely, group.registry, group.columns);
    for (std::size_t c = 0; c < rows.columns.size(); ++c) {
      INFO("copy " << k << ", column " << c << ", " << lanes[k].steps << " steps");
      const double part = 1e-4 * (rows.columns[c].most - rows.columns[c].least);
      CHECK(lanes[k].columns[c].least == Approx(rows.columns[c].least).margin(part));
      CHECK(lanes[k].columns[c].most == Approx(rows.columns[c].most).margin(part));
    }
  }
}

TEST_CASE("types that cannot be vectorised are reported, errors of one run are left to it", "[unit][scene]") {
  const auto why = [](const std::string& text) {
    Runs group(text, "bodies.bob.sphere.mass=1,2,3");
    CHECK(group.lanes().empty());
    return group.unsuited();
  };
  const std::string event = R"("events": [{"name": "low", "when": {"channel": "bob.y"}, "stop": true}],)";
  CHECK(says(why(scene_text(kRun, event)), {"events"}));
  CHECK(says(why(scene_text(R"("until": 1)")), {"every step is recorded"}));
  CHECK(says(why(scene_text(R"("until": 1, "output": 0.1, "integrator": "rk4", "step": 0.01)")), {"dop853"}));
  CHECK(says(why(scene_text(R"("until": 1, "output": 0.1, "record": ["rejected"])")), {"\"rejected\""}));
  CHECK(says(why(scene_text(R"("until": 1, "output": 0.1, "record": ["evaluations"])")), {"\"evaluations\""}));
  CHECK(says(why(scene_text(R"("until": 1, "output": 0.1, "record": ["solver.residual"])")), {"\"solver.residual\""}));
  CHECK(says(why(scene_text(R"("until": 1, "output": 0.1, "solver": "dense")")), {"schur"}));
  for (const char* vary : {"bodies.bob.sphere.mass=1,-1,2", "run.until=1,2,3"}) {
    Runs group(scene_text(kRun), vary);
    INFO(vary << ": " << group.unsuited());
    CHECK(group.lanes().empty());
    CHECK(group.unsuited().empty());
  }
}

namespace {

// A wheel on a hinge, a second one on the first, a spring and a damper between them.
std::string wheels_text(const std::string& links_and_forces, const std::string& run) {
  return R"({"lockstep": 1, "gravity": [0, 0, 0], "parameters": {"speed": "40 rad/s"},
    "bodies": [{"name": "rim", "cylinder": {"mass": 1, "radius": 0.3, "length": 0.1}},
               {"name": "hub", "cylinder": {"mass": 2, "radius": 0.1, "length": 0.1}}],)" +
         links_and_forces + R"("run": {"until": 3, "output": 0.5, "integrator": "dop853", "tolerance": 1e-10,)" + run +
         "}}";
}
const std::string kFreeWheels = R"("links": [
    {"name": "A", "type": "revolute", "p": "rim", "s": "ground", "at": [0,0,0], "start": {"velocity": {"rz": "=speed"}}},
    {"name": "B", "type": "revolute", "p": "hub", "s": "rim", "at": [0,0,0], "start": {"velocity": {"rz": "=-2*speed"}}}],)";

}  // namespace

TEST_CASE("angles count their revolutions in vectorised runs", "[unit][scene]") {
  const std::string pushed = kFreeWheels + R"("forces": [{"name": "push", "type": "applied_torque", "p": "rim",
    "at": [0,0,0], "direction": "z", "law": {"type": "sine", "amplitude": 0.9, "omega": 2}}],)";  // 20 rad/s^2 sin(2 t)
  Runs group(wheels_text(pushed, R"("record": ["A.rz", "B.rz", "hub.angle_z"])"), "parameters.speed=10:45:8");
  INFO(group.unsuited());
  std::vector<Table> histories(8);
  const std::vector<SweepRun> lanes = group.lanes(&histories);
  REQUIRE(lanes.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) {
    const double speed = 10 + 5.0 * static_cast<double>(k);  // rad/s: up to eight turns from output to output
    REQUIRE(lanes[k].status == "ok");
    REQUIRE(histories[k].n_rows() == 7);
    for (std::size_t i = 0; i < 7; ++i) {
      const double t = histories[k]["t"][i];
      const double pushed_by = 10 * t - 5 * std::sin(2 * t);  // more than the mean of two rates tells, by turns
      CHECK(std::abs(histories[k]["A.rz"][i] - speed * t - pushed_by) < 1e-7);
      CHECK(std::abs(histories[k]["B.rz"][i] + 2 * speed * t + pushed_by) < 1e-7);
      CHECK(std::abs(histories[k]["hub.angle_z"][i] + speed * t) < 1e-7);
    }
  }
}

TEST_CASE("vectorised runs have verdicts on their energy if no law does work", "[unit][scene]") {
  const std::string record = R"("record": ["A.rz", "energy.dissipated", "energy.balance"])";
  const std::string damped = kFreeWheels + R"("forces": [{"name": "brake", "type": "torsion_spring_damper", "p": "hub",
    "s": "rim", "at": [0,0,0], "stiffness": 3, "damping": 0.05}],)";
  Runs group(wheels_text(damped, record), "parameters.speed=10:24:8");
  INFO(group.unsuited());
  const std::vector<SweepRun> braked = group.lanes();
  REQUIRE(braked.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) {
    const SweepRun alone = sweep_run(group.scenes[k], group.registry, group.columns);
    CHECK(braked[k].energy == "conserved");
    CHECK(alone.energy == "conserved");
    CHECK_FALSE(braked[k].wrong);
    CHECK(braked[k].imbalance < 1e-7);
    REQUIRE(alone.columns.size() == 3);
    CHECK(alone.columns[1].last > 1);  // J
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(braked[k].columns[c].last - alone.columns[c].last) < 1e-6);
  }
  Runs coarse(R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]}],
    "run": {"until": 20, "output": 5, "integrator": "dopri5", "tolerance": 0.1, "record": ["A.rz"]}})",
              "bodies.arm.rod.mass=1,2,3");
  const std::vector<SweepRun> lost = coarse.lanes();
  REQUIRE(lost.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(sweep_run(coarse.scenes[k], coarse.registry, coarse.columns).energy == "not conserved");
    CHECK(lost[k].energy == "not conserved");
    CHECK(lost[k].wrong);
    CHECK(lost[k].imbalance > 1e-3);
  }
  // Works of laws that move links are not integrated in lanes.
  Runs driven(wheels_text(R"("links": [
    {"name": "A", "type": "revolute", "p": "rim", "s": "ground", "at": [0,0,0],
     "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "=speed"}}},
    {"name": "B", "type": "revolute", "p": "hub", "s": "rim", "at": [0.1,0,0]}],)",
                          R"("record": ["A.rz"])"),
              "parameters.speed=10:24:8");
  const std::vector<SweepRun> lanes = driven.lanes();
  REQUIRE(lanes.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) {
    CHECK(lanes[k].energy.empty());
    CHECK_FALSE(lanes[k].wrong);
    CHECK(std::abs(lanes[k].columns[0].last - 3 * (10 + 2.0 * static_cast<double>(k))) < 1e-7);
  }
}

TEST_CASE("vectorised runs can be interrupted", "[unit][scene]") {
  Runs group(scene_text(kRun), "bodies.bob.sphere.mass=1,2,3");
  const std::vector<SweepRun> lanes =
      sweep_lanes(group.scenes, group.registry, group.columns, [](double t) { return t < 0.5; });
  REQUIRE(lanes.size() == 3);
  CHECK(lanes.front().broken_off);
}

TEST_CASE("vectorised runs obey the same limits: too many steps, too short ones, an open start", "[unit][scene]") {
  const auto compared = [](const std::string& text, const std::string& vary, std::size_t n_failed,
                           std::initializer_list<const char*> words) {
    Runs group(text, vary);
    INFO(group.unsuited());
    REQUIRE(group.unsuited().empty());
    const std::vector<SweepRun> lanes = group.lanes();
    if (lanes.empty()) {  // they go one by one
      CHECK(n_failed > 0);
      return;
    }
    std::size_t failed = 0;
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      const SweepRun alone = sweep_run(group.scenes[k], group.registry, group.columns);
      CHECK(lanes[k].failed == alone.failed);
      CHECK(lanes[k].status == alone.status);
      failed += alone.failed ? 1 : 0;
      if (!alone.failed) continue;
      INFO(alone.status);
      CHECK(says(alone.status, words));
    }
    CHECK(failed == n_failed);
  };
  compared(scene_text(kRun + R"(, "max_steps": 5)"), "bodies.bob.sphere.mass=1,2,3", 3, {"used its 5 steps"});
  compared(scene_text(kRun + R"(, "max_steps": 5000)"), "bodies.bob.sphere.mass=1,2,3", 0, {});
  compared(R"({"lockstep": 1, "bodies": [{"name": "p", "particle": 1, "position": [1, 0, 0]}], "links": [],
    "forces": [{"name": "K", "type": "spring_damper", "p": "p", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0],
                "stiffness": 1e14, "free_length": 0.999}],
    "run": {"until": 1000, "output": 100, "integrator": "dop853", "tolerance": 1e-6, "record": ["p.x"]}})",
           "bodies.p.particle=1:2:4", 4, {"the rest of the run would take"});
  compared(scene_text(kRun + R"(, "assemble": false)"), "links.B.at.0=1,1.1,1.2", 0, {});
  Runs open(R"({"lockstep": 1, "parameters": {"m": 0.5}, "bodies": [
      {"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.5, 0, 0]}},
      {"name": "b", "rod": {"mass": 1, "from": [0.5, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "b", "s": "a", "at_p": ["=m", 0, 0], "at_s": [0.5, 0, 0]}],
    "run": {"until": 1, "output": 0.5, "integrator": "dop853", "assemble": false, "record": ["b.x"]}})",
            "parameters.m=0.5,0.5000001,0.6,0.7");
  const std::vector<SweepRun> lanes = open.lanes();
  for (std::size_t k = 0; k < open.scenes.size(); ++k) {
    const SweepRun alone = sweep_run(open.scenes[k], open.registry, open.columns);
    CHECK(alone.failed == (k > 1));
    if (lanes.empty()) continue;
    CHECK(lanes[k].failed == alone.failed);
    CHECK(lanes[k].status == alone.status);
  }
}

// A driven four-bar whose base is too short for its crank to go round: it locks at about 0.43 s.
TEST_CASE("a copy near a locked position ends soon, by counts", "[unit][scene]") {
  const Scene scene = in_space(scene_from_text(R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "points": {"A": [0,0,0], "B": [0,0.1,0], "C": [0.25,0.15,0], "D": [0.16,0,0]},
    "bodies": [{"name": "crank", "rod": {"mass": 1, "from": "A", "to": "B"}},
               {"name": "coupler", "rod": {"mass": 1, "from": "B", "to": "C"}},
               {"name": "rocker", "rod": {"mass": 1, "from": "C", "to": "D"}}],
    "links": [{"name": "a", "type": "revolute", "p": "crank", "s": "ground", "at": "A",
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 10}}},
              {"name": "b", "type": "revolute", "p": "coupler", "s": "crank", "at": "B"},
              {"name": "c", "type": "revolute", "p": "coupler", "s": "rocker", "at": "C"},
              {"name": "d", "type": "revolute", "p": "rocker", "s": "ground", "at": "D"}]})",
                                               "locks.json"));
  for (const char* integrator : {"dopri5", "dop853"}) {
    INFO(integrator);
    Mechanism one = build_mechanism(scene, builtin_registry()), other = build_mechanism(scene, builtin_registry());
    CopiesOptions options;
    options.integrator = integrator, options.tolerance = {1e-11, 1e-13};
    Copies copies({&system_of(one), &system_of(other)}, options);
    std::vector<State> starts;
    for (System* system : {&system_of(one), &system_of(other)}) {
      Dynamics dynamics(*system, std::make_unique<SchurSolver>());
      starts.push_back(system->start());
      assemble(dynamics, starts.back());
      dynamics.to_slots(starts.back());
    }
    const std::vector<double> times{0, 0.2, 1};
    for (const CopyReport& r : copies.run(starts, times, [](int, std::size_t, const State&) {})) {
      INFO(r.steps << " steps, " << r.rejected << " tries, " << r.error);
      CHECK_FALSE(r.finished);
      CHECK(r.t > 0.4);
      CHECK(r.t < 0.45);
      CHECK(r.error != "");
      CHECK(r.steps + r.rejected < 20000);
    }
  }
}

}  // namespace sweep_lanes_test
