// Which rows are redundant: a function of the links in force and of the branch, whatever state is asked, and when.
#include <cmath>
#include <memory>
#include <string>

#include <lockstep/assembly.h>
#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include <lockstep/registry.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace redundancy_test {

using namespace lockstep;

namespace {

struct Linkage {
  const char* name;
  Formulation formulation;
  int rows;
  bool on_constraints;
};

Mechanism of_scene(const std::string& name) {
  return build_mechanism(read_scene(std::string(paths::kSource) + "/samples/scenes/overconstrained/" + name + ".json"),
                         builtin_registry());
}

/// Along the motion by this angle of the fastest body, rad, and back onto the constraints.
State moved(Dynamics& dynamics, const State& from, double angle) {
  State state = from;
  std::vector<Motion> motions;
  dynamics.system().motions(state, motions);
  double turn = 0;
  for (const Motion& O : motions) turn = std::max(turn, O.w.norm());
  for (int k = 0; k < 40; ++k) {
    dynamics.advance(state, angle / 40 / turn, state.v);
    REQUIRE(dynamics.project(state, 0).converged);
  }
  return state;
}

}  // namespace

TEST_CASE("redundant rows are those of the branch, at each pose of it", "[verification]") {
  constexpr auto kOmega = Formulation::omega, kJoint = Formulation::joint;
  const Linkage of = GENERATE(values<Linkage>({{"bennett", kOmega, 3, true},
                                               {"bennett", kJoint, 3, true},
                                               {"bricard", kOmega, 1, true},
                                               {"bricard", kJoint, 1, true},
                                               {"sarrus", kOmega, 1, false},
                                               {"sarrus", kJoint, 1, false},
                                               {"spherical_four_bar", kOmega, 3, true},
                                               {"four_bar", kOmega, 3, false},
                                               {"four_bar", kJoint, 0, false},
                                               {"antiparallelogram", kOmega, 3, false},
                                               {"antiparallelogram", kJoint, 0, false},
                                               {"parallel_cranks_3", kOmega, 7, false},
                                               {"parallel_cranks_3", kJoint, 1, false}}));
  CAPTURE(of.name, to_string(of.formulation));
  Mechanism m = of_scene(of.name);
  for (const double angle : {0.0, 0.03, 0.2, -0.2, 0.5}) {
    CAPTURE(angle);
    Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {of.formulation, {}});
    State state = m.system.start();
    assemble(dynamics, state, m.start_speeds, m.assembly);
    if (angle != 0) state = moved(dynamics, state, angle);
    dynamics.to_formulation(state);
    const Redundancy found = dynamics.redundancy(state);
    CHECK(found.rows == of.rows);
    CHECK(found.on_constraints == of.on_constraints);
    CHECK(found.regular > 1e-6);
  }
}

}  // namespace redundancy_test
