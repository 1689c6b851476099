// SPDX-License-Identifier: BSD-3-Clause
// All equilibria of a mechanism, by closed forms: families count as one, and starts reach as far as springs.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/equilibrium.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"

namespace equilibria_test {

using namespace lockstep;
using Kind = Stability::Kind;

// The bob rests where the spring is unstrained, at x = +-0.6, and stands at x = 0; the wheel rests at any angle.
TEST_CASE("statics: a wheel that nothing holds makes no two equilibria of another part one",
          "[verification][statics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "bob", "mass": 1, "inertia": [0.01, 0.01, 0.01], "position": [0, 0.8, 0]},
               {"name": "wheel", "mass": 1, "inertia": [1, 1, 1], "position": [5, 0, 0]}],
    "links": [{"name": "G", "type": "prismatic", "p": "bob", "s": "ground", "at": [0, 0.8, 0], "axis": [1, 0, 0]},
              {"name": "W", "type": "revolute", "p": "wheel", "s": "ground", "at": [5, 0, 0]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [0, 0.8, 0],
                "at_s": [0, 0, 0], "stiffness": 1000, "free_length": 1}]})";
  Mechanism m = build_mechanism(scene_from_text(text, "wheelwell.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  const EquilibriaReport found = find_equilibria(dynamics, m.system.start(), {.starts = 40});
  CHECK(found.failed == 0);
  REQUIRE(found.all.size() == 3);
  std::vector<double> x;
  for (const Equilibrium& e : found.all) {
    x.push_back(body_pose(m.system.body("bob"), e.state).x[0]);
    REQUIRE(e.report.stability.neutral.size() == 1);
    CHECK(e.report.stability.neutral.front().words == "'wheel' rotates about z");
  }
  CHECK(std::abs(x[0] * x[1] + 0.36) <= 1e-9);
  CHECK(std::abs(x[0] + x[1]) <= 1e-9);
  CHECK(std::abs(x[2]) <= 1e-9);
  CHECK(found.all[2].report.stability.kind == Kind::unstable);
}

// Folded, with the slider at the pivot, both rods turn about it as one. Hanging they meet the motion in which it
// slides, which the spring drives: the reaction there has no limit.
TEST_CASE("statics: poses near a singular configuration count as one and come last", "[verification][statics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "left", "rod": {"mass": 0.4, "from": [0, 0, 0], "to": [0.3, 0.08, 0]}},
               {"name": "right", "rod": {"mass": 0.4, "from": [0.3, 0.08, 0], "to": [0.6, 0, 0]}},
               {"name": "slider", "sphere": {"mass": 0.6, "radius": 0.02}, "position": [0.6, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "left", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "right", "s": "left", "at": [0.3, 0.08, 0]},
              {"name": "C", "type": "revolute", "p": "slider", "s": "right", "at": [0.6, 0, 0]},
              {"name": "D", "type": "prismatic", "p": "slider", "s": "ground", "at": [0.6, 0, 0], "axis": [1, 0, 0]}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "slider", "s": "ground", "at_p": [0.6, 0, 0],
                "at_s": [0.9, 0, 0], "stiffness": 2000, "free_length": 0.3}]})";
  Mechanism m = build_mechanism(scene_from_text(text, "toggle.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  const EquilibriaReport found = find_equilibria(dynamics, m.system.start(), {.starts = 100});
  const auto n = std::ranges::count_if(found.all, [](const Equilibrium& e) { return e.report.singular; });
  CHECK(found.unassembled <= found.failed);
  CHECK((n >= 1 && n <= 4));  // hanging and standing; each within 1e-3 of them
  REQUIRE(found.all.size() > static_cast<std::size_t>(n) + 1);
  CHECK_FALSE(found.all[1].report.singular);  // the two that are stable
  for (std::size_t k = 0; k < found.all.size(); ++k)
    CHECK(found.all[k].report.singular == (k >= found.all.size() - static_cast<std::size_t>(n)));
}

// A small node on a long spring rests on both sides of the line of its ends.
TEST_CASE("statics: starts are scattered as far as springs reach", "[verification][statics]") {
  const std::string text = R"({"lockstep": 1,
    "bodies": [{"name": "node", "sphere": {"mass": 1, "radius": 0.02}, "position": [0, 0.1, 0]}],
    "links": [{"name": "G", "type": "prismatic", "p": "node", "s": "ground", "at": [0, 0.1, 0], "axis": [0, 1, 0]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "node", "s": "ground", "at_p": [0, 0.1, 0],
                "at_s": [0.5, 0, 0], "stiffness": 10000, "free_length": 0.509902}]})";
  Mechanism m = build_mechanism(scene_from_text(text, "snap.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  double lowest = 0;
  for (const Equilibrium& e : find_equilibria(dynamics, m.system.start(), {.starts = 40}).all)
    lowest = std::min(lowest, body_pose(m.system.body("node"), e.state).x[1]);
  CHECK(lowest == Approx(-0.1).epsilon(1e-4));
}

}  // namespace equilibria_test
