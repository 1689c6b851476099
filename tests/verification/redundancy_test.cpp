// SPDX-License-Identifier: BSD-3-Clause
// Which rows are redundant: a function of the links in force and of the branch, whatever state is asked, and when.
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include <lockstep/assembly.h>
#include <lockstep/author/passes.h>
#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/doors.h"
#include "tests/support/driven_parallelogram.h"
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
  passes::motions(dynamics.system(), state, motions);
  double turn = 0;
  for (const Motion& O : motions) turn = std::max(turn, O.w.norm());
  for (int k = 0; k < 40; ++k) {
    dynamics.advance(state, angle / 40 / turn, state.v);
    REQUIRE(dynamics.project(state, 0).converged);
  }
  return state;
}

}  // namespace

TEST_CASE("redundant constraints are those of the branch, at each pose of it", "[verification]") {
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

// The rod from the arm lies in line with the arm's hinge: the arm does not move along it, but what it holds does.
TEST_CASE("no solver treats a constraint as singular because one of its bodies does not move along it",
          "[verification]") {
  const std::string solver = GENERATE("schur", "block", "dense", "sparse");
  const bool arm_first = GENERATE(true, false);
  CAPTURE(solver, arm_first);
  System sys;
  const auto add_arm = [&] { return &sys.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0})); };
  Body* arm = arm_first ? add_arm() : nullptr;
  Body& held = sys.add_body("held", shapes::rod(1.0, {2, 0, 0}, {3, 0.5, 0}));
  Body& other = sys.add_body("other", shapes::rod(1.0, {3, 0.5, 0}, {3.2, -0.5, 0}));
  if (!arm_first) arm = add_arm();
  sys.add<Revolute>("A", *arm, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Revolute>("B", other, held, pose_at({3, 0.5, 0}));
  sys.add<Revolute>("C", other, sys.ground(), pose_at({3.2, -0.5, 0}));
  sys.add<Distance>("rod", sys.add_marker_at("P", *arm, pose_at({1, 0, 0})),
                    sys.add_marker_at("S", held, pose_at({2, 0, 0})), 1.0);
  Dynamics dynamics(sys, builtin_registry().solvers.make(solver, Params{}, nullptr, "run.solver"),
                    {Formulation::omega, {}});
  const State state = sys.start();
  CHECK(dynamics.evaluate(state).full_report().detector > 1e-4);
}

// At 1e-3 rad beside the flat position rows have pivots as small as those of redundant rows, and a law that begins at rest
// shows no pose beside it.
TEST_CASE("redundancy is not decided by a start before the first motion of its laws", "[verification]") {
  const Formulation formulation = GENERATE(Formulation::omega, Formulation::joint);
  const double angle = GENERATE(3e-3, 1e-3);
  CAPTURE(to_string(formulation), angle);
  const std::string text = testing::driven_parallelogram(angle, R"({"type": "poly345", "rise": 6, "duration": 1})",
                                                         R"("integrator": "dopri5", "tolerance": 1e-8, "until": 1)");
  Mechanism m = build_mechanism(scene_from_text(text, "parallelogram.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {formulation, {}});
  State state = m.system.start();
  dynamics.to_formulation(state);
  CHECK(dynamics.redundancy(state).rows <= 0);
  m.run.formulation = formulation;
  Simulation run(std::move(m));
  run.run();
  const RunVerdict verdict = run.verdict();
  CHECK(verdict.right);
  CHECK(verdict.audit.imbalance < 1e-7 * verdict.audit.scale);
  CHECK(run.loop().report().manifold_steps > 0);
}

// In joint coordinates of a tree the rows of closures are some of all rows.
TEST_CASE("joint coordinates have no more redundant constraints than all", "[verification]") {
  const std::string text =
      testing::driven_parallelogram(0, R"({"type": "ramp", "slope": 3})", R"("integrator": "dopri5", "until": 0.3)");
  Mechanism m = build_mechanism(scene_from_text(text, "parallelogram.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::joint, {}});
  State slots = m.system.start();
  assemble(dynamics, slots, m.start_speeds, m.assembly);
  State joint = slots;
  dynamics.to_formulation(joint);
  CHECK(dynamics.redundancy(joint).rows == 0);
  CHECK(dynamics.redundancy(slots).rows == 0);
}

// A parallelogram of cranks that turn at 2 rad/s: a row fades as the square of the distance from the flat position, and
// poses up to 0.4 rad beside it are looked at. Beside a regular position those of 0.1 rad are enough.
TEST_CASE("a singular configuration is judged by the most regular of the nearby poses", "[verification][joint]") {
  const double angle = GENERATE(0.0, 0.15);
  const Vec3 B(0.2 * std::cos(angle), 0.2 * std::sin(angle), 0), D(0.6, 0, 0), C = B + D;
  System sys;
  Body& left = sys.add_body("left", shapes::rod(1, {0, 0, 0}, B));
  Body& right = sys.add_body("right", shapes::rod(1, D, C));
  Body& coupler = sys.add_body("coupler", shapes::rod(1, B, C));
  const Vec3 v(-B[1], B[0], 0);
  left.start = right.start = {v, {0, 0, 2}}, coupler.start.v = 2 * v;
  sys.add<Revolute>("A", left, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Revolute>("B", coupler, left, pose_at(B));
  sys.add<Revolute>("C", coupler, right, pose_at(C));
  sys.add<Revolute>("D", right, sys.ground(), pose_at(D));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {Formulation::joint, {}});
  State state = sys.start();
  dynamics.to_formulation(state);
  const Redundancy found = dynamics.redundancy(state);
  CHECK(found.rows == 0);
  StateRate rate;
  const State beside = moved(dynamics, state, angle > 0 ? 0.1 : 0.4);
  CHECK(found.regular == Approx(dynamics.rates_with_report(beside, rate).detector));
}

/// The detector of a parallelogram of slender rods that turns, at an angle from its flat position.
double detector_of(const std::string& solver, const Quat& turned, double angle) {
  const Mat3 frame = rotation(turned);
  const Vec3 A(0, 0, 0), D(0.5, 0, 0), B(0.2 * std::cos(angle), 0.2 * std::sin(angle), 0), C = B + D;
  System sys;
  Body& left = sys.add_body("left", shapes::slender_rod(1, frame * A, frame * B, 1e-6));
  Body& right = sys.add_body("right", shapes::slender_rod(1, frame * D, frame * C, 1e-6));
  Body& coupler = sys.add_body("coupler", shapes::slender_rod(1, frame * B, frame * C, 1e-6));
  const auto at = [&](const Vec3& x) { return Pose{frame * x, turned}; };
  sys.add<Revolute>("A", left, sys.ground(), at(A));
  sys.add<Revolute>("B", coupler, left, at(B));
  sys.add<Revolute>("C", coupler, right, at(C));
  sys.add<Revolute>("D", right, sys.ground(), at(D));
  for (const auto& [body, arm] : {std::pair<Body*, Vec3>{&left, 0.5 * B}, {&right, 0.5 * B}, {&coupler, B}}) {
    body->start.v = frame * Vec3(-arm.y(), arm.x(), 0);
    if (body != &coupler) body->start.w = rotation(body->home.q).transpose() * frame * Vec3::UnitZ();
  }
  RunSettings settings;
  settings.solver = {solver};
  Dynamics dynamics(sys, make_solver(settings, builtin_registry()), {Formulation::omega, {}});
  return dynamics.evaluate(sys.start()).full_report().detector;
}

// Redundant constraints leave pivots of the solvers that are larger, where moments about slender axes are redundant too.
TEST_CASE("near a singular configuration of slender rods the detector falls as the square, by any solver",
          "[verification]") {
  const std::string solver = GENERATE("schur", "block", "sparse", "dense");
  const Quat turned = normalized(Quat{0.3, -0.5, 0.7, 0.4});
  CAPTURE(solver);
  CHECK(detector_of(solver, turned, kPi / 2) > 1e-2);
  CHECK(std::log10(detector_of(solver, turned, 0.01) / detector_of(solver, turned, 0.001)) == Approx(2).margin(0.01));
}

TEST_CASE("the detector shows a singular configuration in every frame, close to it and in it", "[verification]") {
  std::minstd_rand random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int k = 0; k < 40; ++k) {
    const Quat turned = normalized(Quat{number(random), number(random), number(random), number(random)});
    CAPTURE(k);
    const double near = detector_of("schur", turned, 0.01) / 1e-4;
    CHECK(near == Approx(0.1115).epsilon(0.01));  // as in the world's axes
    for (const double angle : {1e-3, 1e-4, 3e-5, 1e-5, 1e-6}) {
      CAPTURE(angle);
      CHECK(detector_of("schur", turned, angle) / (angle * angle) == Approx(near).epsilon(0.1));
    }
    CHECK(detector_of("schur", turned, 0) < 1e-12);
  }
}

// The line of a joint would rotate with a body.
TEST_CASE("constraints on a particle are dependent by its three coordinates", "[verification]") {
  Mechanism m = build_mechanism(scene_from_text(R"({"lockstep": 1, "planar": "off",
    "bodies": [{"name": "bead", "particle": 1, "position": [0.3, 0, 0]}],
    "joints": [{"name": "L", "type": "point_on_line", "p": "ground", "s": "bead", "at_p": [0, 0, 0],
                "at_s": [0.3, 0, 0], "axis": "x"},
               {"name": "M", "type": "point_on_line", "p": "ground", "s": "bead", "at_p": [1, 0, 0],
                "at_s": [0.3, 0, 0], "axis": "x"}],
    "run": {"until": 0}})",
                                                "bead.json"),
                                builtin_registry());
  System& sys = system_of(m);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  CHECK(dynamics.dependent_rows(sys.start()) == 2);
}

namespace {

/// A coupler on three equal cranks that lean, the foot of the third lower by `lower`: parallel hinges, redundant but for
/// that. `base`: to which they are hinged.
void add_cranks(System& sys, Body& base, const std::string& name, double size, double lower) {
  Body& coupler = sys.add_body(name, shapes::rod(1, {0.5 * size, size, 0}, {2.5 * size, size, 0}));
  for (int k = 0; k < 3; ++k) {
    const Vec3 foot(k * size, k == 2 ? -lower : 0, 0), to((k + 0.5) * size, size, 0);
    Body& crank = sys.add_body(name + std::to_string(k), shapes::rod(1, foot, to));
    sys.add<Revolute>(crank.name + " foot", crank, base, pose_at(foot));
    sys.add<Revolute>(crank.name + " head", coupler, crank, pose_at(to));
  }
}

int dependent_in(System& sys, Formulation formulation) {
  sys.setup();
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {formulation, {}});
  State start = sys.start();
  dynamics.to_formulation(start);
  return dynamics.dependent_rows(start);
}

}  // namespace

TEST_CASE("the number of dependent constraints is that of each loop alone", "[verification]") {
  const auto formulation = GENERATE(Formulation::omega, Formulation::joint);
  const double lower = GENERATE(0.0, 2e-5, 0.4);
  CAPTURE(formulation == Formulation::joint, lower);
  System one;
  add_cranks(one, one.ground(), "cranks", 1, lower);
  const int n = dependent_in(one, formulation);
  if (formulation == Formulation::omega) CHECK(n == (lower > 0.1 ? 6 : 7));  // of 30 on 24 velocities, 1 of them free

  System many;  // of 330 rows
  for (int k = 0; k < 11; ++k) add_cranks(many, many.ground(), "unit" + std::to_string(k) + "-", 1, lower);
  CHECK(dependent_in(many, formulation) == 11 * n);

  // Of 1 mm, on a hull of 1000 t whose centre of mass is 100 m away, and beside a pendulum of 50 m.
  System small;
  Body& hull = small.add_body("hull", shapes::box(1e6, {10, 10, 10}), {Vec3(30, -100, 8), Quat{}});
  small.add<Fixed>("weld", hull, small.ground(), pose_at({30, -90, 8}));
  add_cranks(small, hull, "cranks", 1e-3, 1e-3 * lower);
  Body& pendulum = small.add_body("pendulum", shapes::rod(1, {0, 0, 0}, {0, -50, 0}));
  small.add<Revolute>("pivot", pendulum, small.ground(), pose_at({0, 0, 0}));
  CHECK(dependent_in(small, formulation) == n);
}

// A door 20 m high counts as on its constraints up to 1e-6 m.
TEST_CASE("redundant constraints are found up to violations of the order of the mechanism's length", "[verification]") {
  System sys;
  Body& door = sys.add_body("door", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  for (const double z : {-10.0, 10.0})
    sys.add<Revolute>(z < 0 ? "low" : "high", door, sys.ground(), pose_at({0, 0, z}));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State state = sys.start();
  state.q[0] += 3e-7;
  CHECK(dynamics.gather(state).redundant() == 5);
}

// Masses that differ by 2e4: a row that fades in the flat position has a pivot as small as that of a redundant row up to
// 0.15 rad from there, but not at 0.45 rad. Of the 20 rows of four hinges 17 hold three bodies.
TEST_CASE("redundant constraints are distinguished from those that fade near a singular configuration of heavy cranks",
          "[verification]") {
  const double c = std::cos(0.05), s = -std::sin(0.05);
  const Vec3 B1(0.2 * c, 0.2 * s, 0), A2(0.3, 0, 0), B2 = A2 + B1;
  System sys;
  Body& crank1 = sys.add_body("crank1", shapes::rod(200, {0, 0, 0}, B1));
  Body& crank2 = sys.add_body("crank2", shapes::rod(200, A2, B2));
  Body& coupler = sys.add_body("coupler", shapes::rod(0.01, B1, B2));
  sys.add<Revolute>("A1", crank1, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Revolute>("B1", coupler, crank1, pose_at(B1));
  sys.add<Revolute>("A2", crank2, sys.ground(), pose_at(A2));
  sys.add<Revolute>("B2", coupler, crank2, pose_at(B2));
  crank1.start.w = crank2.start.w = {0, 0, 2};
  crank2.start.v = {0, -0.6, 0}, coupler.start.v = {-0.4 * s, 0.4 * c, 0};
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  CHECK(dynamics.redundancy(sys.start()).rows == 3);
}

// The first hinge leaves its own turn free; the row y of the second, of length 1, has this share of it. The hinges are 1.6 m
// apart.
TEST_CASE("nearly dependent constraints that hold report their singular value", "[verification]") {
  const auto two = doors::door({}, true);
  two->begin(NearlyRedundant::held, "schur");
  const double l = 0.8, row = std::hypot(1, 0.8 / l, 0.45 / l), turn = std::hypot(0.45, l);
  CHECK(two->system.held_down_to() == Approx(doors::kApart / (row * turn)).epsilon(doors::kApart));
}

}  // namespace redundancy_test
