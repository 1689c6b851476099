// SPDX-License-Identifier: BSD-3-Clause
// Bodies that differ much in mass, in chains and in loops whose rows are redundant: forces and motions from every solver.
#include <cmath>
#include <string>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/sweep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"

namespace mass_ratio_test {

using namespace lockstep;

namespace {

constexpr double kG = 9.81;

/// A plank of this mass, kg, on two parallel legs of 1 kg each and 0.1 m apart in height: four hinges in space, of whose
/// 20 rows three are redundant. `rate`: of the crank at the start, rad/s.
std::string plank(double mass, double rate, const std::string& planar, const std::string& run) {
  return fmt::format(
      R"({{"lockstep": 1, "planar": "{2}", "gravity": [0, -9.81, 0],
  "bodies": [{{"name": "crank", "rod": {{"mass": 1, "from": [0, 0, 0], "to": [0, 0.1, 0]}}}},
             {{"name": "plank", "rod": {{"mass": {0}, "from": [0, 0.1, 0], "to": [0.3, 0.2, 0]}}}},
             {{"name": "rocker", "rod": {{"mass": 1, "from": [0.3, 0, 0], "to": [0.3, 0.2, 0]}}}}],
  "links": [{{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0], "start": {{"velocity": {{"rz": {1}}}}}}},
            {{"name": "B", "type": "revolute", "p": "plank", "s": "crank", "at": [0, 0.1, 0]}},
            {{"name": "C", "type": "revolute", "p": "plank", "s": "rocker", "at": [0.3, 0.2, 0]}},
            {{"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": [0.3, 0, 0]}}],
  "run": {{{3}}}}})",
      mass, rate, planar, run);
}

/// A load of this mass, kg, that hangs on a rod of 1 kg.
std::string hanging(double mass, const std::string& run) {
  return fmt::format(
      R"({{"lockstep": 1, "planar": "{2}", "gravity": [0, -9.81, 0],
  "bodies": [{{"name": "rod", "rod": {{"mass": 1, "from": [0, 0, 0], "to": [0, -1, 0]}}}},
             {{"name": "load", "mass": {0}, "inertia": [{0}, {0}, {0}], "position": [0, -1, 0]}}],
  "links": [{{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}},
            {{"name": "B", "type": "revolute", "p": "load", "s": "rod", "at": [0, -1, 0]}}],
  "run": {{{1}}}}})",
      mass, run, "off");
}

struct Run {
  Table table;
  SimulationReport report;
};

Run run(const std::string& text) {
  const Registry& registry = builtin_registry();
  const Scene scene = scene_from_text(text, "mass_ratio.json");
  Mechanism mechanism = build_mechanism(scene, registry);
  const RunSettings& settings = mechanism.run;
  const std::unique_ptr<Recorder> recorder = make_recorder(mechanism);
  Dynamics dynamics(system_of(mechanism), make_solver(settings, registry),
                    {settings.formulation, settings.stabilization});
  State start = mechanism.system.start();
  assemble(dynamics, start, mechanism.start_speeds);
  StepLoop loop(dynamics, make_integrator(settings, registry),
                {.tolerance = settings.tolerance, .output = settings.output});
  loop.set_state(start);
  loop.add_observer(*recorder);
  Run out;
  out.report = loop.run_until(settings.until);
  out.table = recorder->table();
  return out;
}

}  // namespace

TEST_CASE("a heavy plank stands on light legs: its weight is carried to round-off", "[stability][solvers]") {
  const std::string way = GENERATE(R"("solver": "schur")", R"("solver": "block")", R"("solver": "sparse")",
                                   R"("solver": "dense")", R"("formulation": "joint")");
  const std::string planar = GENERATE("off", "auto");
  const std::string settings = way + R"(, "until": 0.01, "output": 0.01,
                                          "record": [{"reaction": "A.force_on_p_world_y"}, "plank.ay"])";
  for (const double mass : {1.0, 1e3, 1e5, 1e6, 1e7, 1e8, 1e9}) {
    CAPTURE(way, planar, mass);
    const Run at = run(plank(mass, 0, planar, settings));
    REQUIRE(at.table.n_rows() == 2);
    CHECK(at.table["reaction"][0] == Approx((0.5 * mass + 1) * kG).epsilon(1e-12));
    CHECK(std::abs(at.table["plank.ay"][0]) < 1e-12);
  }
}

TEST_CASE("a heavy load on a light rod: its weight is carried to 1e-9", "[stability][solvers]") {
  const std::string solver = GENERATE("schur", "block", "sparse", "dense");
  const std::string formulation = GENERATE("omega", "quaternion", "auto");
  if (formulation == "quaternion" && solver == "schur") return;  // refused by name
  for (const double mass : {1.0, 1e3, 1e6, 1e8, 1e9}) {
    CAPTURE(solver, formulation, mass);
    const Run at = run(hanging(mass, fmt::format(R"("solver": "{}", "formulation": "{}", "until": 0.01,
                                           "output": 0.01, "record": [{{"reaction": "A.force_on_p_world_y"}}])",
                                                 solver, formulation)));
    CHECK(at.table["reaction"][0] == Approx((mass + 1) * kG).epsilon(1e-9));
    CHECK(at.report.steps < 50);
  }
}

// The plank's motion tends to that of a plank on legs without mass: what is left falls as 1/mass.
TEST_CASE("a heavy plank moves alike by every solver, in space and in the plane", "[stability][solvers]") {
  const double mass = GENERATE(1.0, 1e4, 1e6, 1e8, 1e9);
  const auto settings = [](const std::string& solver) {
    return fmt::format(
        R"("solver": "{}", "integrator": "dop853", "tolerance": 1e-10, "until": 2, "output": 0.5,
                          "record": ["plank.x", "plank.y", {{"energy": "energy.total"}}])",
        solver);
  };
  const Run plane = run(plank(mass, 1, "z", settings("dense")));
  for (const std::string solver : {"schur", "block", "sparse", "dense"}) {
    const Run space = run(plank(mass, 1, "off", settings(solver)));
    CAPTURE(mass, solver);
    REQUIRE(space.table.n_rows() == plane.table.n_rows());
    for (std::size_t i = 0; i < space.table.n_rows(); ++i) {
      CHECK(std::abs(space.table["plank.x"][i] - plane.table["plank.x"][i]) < 1e-9);
      CHECK(std::abs(space.table["plank.y"][i] - plane.table["plank.y"][i]) < 1e-9);
      CHECK(space.table["energy"][i] == Approx(space.table["energy"][0]).margin(1e-10 * mass * kG));
    }
  }
}

// Between heavy bodies what rounding leaves of the accelerations of light ones is that of their load, which is more than the
// tolerance.
TEST_CASE("joint coordinates take no shorter steps where bodies differ in mass", "[stability]") {
  const std::string planar = GENERATE("off", "auto");
  const auto settings = [](const std::string& formulation) {
    return R"("formulation": ")" + formulation +
           R"(", "integrator": "dop853", "tolerance": 1e-11, "until": 1.2, "output": 1.2, "record": ["plank.x"])";
  };
  for (const double mass : {1.0, 1e4, 1e6, 1e7}) {
    const Run joint = run(plank(mass, 1, planar, settings("joint"))),
              omega = run(plank(mass, 1, planar, settings("omega")));
    CAPTURE(planar, mass, joint.report.steps, omega.report.steps);
    CHECK(2 * joint.report.steps < 3 * omega.report.steps);
    CHECK(joint.table["plank.x"][1] == Approx(omega.table["plank.x"][1]).margin(1e-8));
  }
}

}  // namespace mass_ratio_test
