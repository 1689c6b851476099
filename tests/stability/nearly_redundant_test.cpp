// SPDX-License-Identifier: BSD-3-Clause
// Rows that depend on others but for a very small singular value: told, and where that is asked for held or free,
// decided once at the start, and then the same motion from every solver and in every frame of the world.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/LU>

#include <lockstep/analysis.h>
#include <lockstep/author/registry.h>
#include <lockstep/explain.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/doors.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace nearly_redundant_test {

using namespace lockstep;
using doors::distance, doors::door, doors::Frame, doors::frames, doors::Model, doors::Names;
using doors::kApart, doors::kMass, doors::kSideways, doors::kSolvers;
using testing::message_of;

namespace {

/// A four-bar of hinges in space, that at C tilted; a couple of 1 N m turns the crank.
std::unique_ptr<Model> four_bar(const Frame& frame, double tilt) {
  auto out = std::make_unique<Model>();
  Model& m = *out;
  m.frame = frame;
  const auto rod = [&](const char* name, const Vec3& a, const Vec3& b) -> Body& {
    return m.system.add_body(name, shapes::rod(1, m.at(a).x, m.at(b).x));
  };
  Body& crank = rod("crank", {0, 0, 0}, {0, 0.1, 0});
  Body& coupler = rod("coupler", {0, 0.1, 0}, {0.3, 0.2, 0});
  Body& rocker = rod("rocker", {0.3, 0, 0}, {0.3, 0.2, 0});
  m.system.add<Revolute>("A", crank, m.system.ground(), m.at({0, 0, 0}));
  m.system.add<Revolute>("B", coupler, crank, m.at({0, 0.1, 0}));
  m.system.add<Revolute>("C", coupler, rocker, m.at({0.3, 0.2, 0}, {std::sin(tilt), 0, std::cos(tilt)}));
  m.system.add<Revolute>("D", rocker, m.system.ground(), m.at({0.3, 0, 0}));
  Marker& on = m.system.add_marker_at("on", crank, m.at({0, 0, 0}));
  m.system.add(std::make_unique<AppliedTorque>("couple", on, AppliedTorque::Options{.torque = m.turned({0, 0, 1})}));
  return out;
}

/// Multipliers of as many independent rows as there are unknowns: J^T lambda = f, in extended precision.
VecX carried(const Evaluation& e) {
  using Real = long double;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index n = e.force().size();
  REQUIRE(e.rows().n_rows == n);
  Matrix Jt = Matrix::Zero(n, n);
  for (const RowEntry& entry : e.rows().entries)
    for (int k = 0; k < entry.m; ++k)
      for (int i = 0; i < entry.slots.n; ++i) {
        const std::array<double, 6> J = e.rows().block(entry).J(i, k);
        for (int c = 0; c < 6; ++c) Jt(6 * entry.slots[i] + c, entry.first_row + k) = J[c];
      }
  return Jt.fullPivLu().solve(e.force().cast<Real>()).cast<double>();
}

}  // namespace

TEST_CASE("a door on two hinges 1e-7 m apart, free: it rotates as on one of them", "[stability][redundancy]") {
  const auto one = door({}, false);
  one->begin(NearlyRedundant::free, "schur");
  CHECK(one->near.empty());
  State truth;
  one->run(0.8, truth);
  for (const std::string& solver : kSolvers)
    for (const Frame& frame : frames(solver == "schur" ? 20 : 4)) {
      const auto two = door(frame, true);
      CAPTURE(solver, frame.x.transpose());
      two->begin(NearlyRedundant::free, solver);
      REQUIRE(two->near.size() == 1);
      const NearDependency& found = two->near.front();
      CHECK(found.rows == Names{"low.y", "low.e1", "high.y", "high.e1"});
      CHECK(found.nearly == 1);
      CHECK(found.singular_value > 0.1 * kApart);
      CHECK(found.singular_value < 10 * kApart);
      CHECK_FALSE(found.in_passing);
      CHECK(found.violation < 2 * kApart);
      CHECK(found.left_out == Names{"high.x", "high.y", "high.z", "high.e1", "high.e2"});
      CHECK(mobility(*two->dynamics, two->start).freedoms == 1);
      State end;
      const SimulationReport report = two->run(0.8, end);
      CHECK(report.steps < 100);
      CHECK(distance(two->system, end, frame, one->system, truth) < 1e-9);
    }
}

TEST_CASE("a door on two hinges 1e-7 m apart, held: it stands still, by huge forces", "[stability][redundancy]") {
  for (const std::string& solver : kSolvers)
    for (const Frame& frame : frames(solver == "schur" ? 20 : 4)) {
      const auto two = door(frame, true);
      CAPTURE(solver, frame.x.transpose());
      two->begin(NearlyRedundant::held, solver);
      REQUIRE(two->near.size() == 1);
      CHECK_FALSE(two->near.front().in_passing);
      CHECK(mobility(*two->dynamics, two->start).freedoms == 0);
      const Solution& v = two->dynamics->evaluate(two->start);
      // The moment of its weight about the axis, 0.45 m m g_y, by forces along y 1e-7 m apart.
      const double force = 0.45 * kMass * kSideways / kApart;
      const auto reaction = [&](const char* name) {
        const Lock& link = two->system.link(name);
        const MarkerFrame p(*link.pairs().front().first);
        return Vec3(rotation(frame.q).transpose() * Reactions(v).on_body_of(p, link, v.in).force);
      };
      CHECK(reaction("high")[1] == Approx(-force).epsilon(1e-6));
      CHECK(reaction("low")[1] == Approx(force).epsilon(1e-6));
      CHECK(v.a.lpNorm<Eigen::Infinity>() < 1e-6);
      State end;
      const SimulationReport report = two->run(0.1, end);
      CHECK(report.steps < 1000);
      double moved = 0;
      for (Eigen::Index i = 0; i < end.q.size(); ++i) keep_worst(moved, std::abs(end.q[i] - two->start.q[i]));
      CHECK(moved < 1e-7);
    }
}

TEST_CASE("a four-bar of hinges, one tilted by 1e-5: held it carries the couple, free it moves as a planar one",
          "[stability][redundancy]") {
  const auto flat = four_bar({}, 0);
  flat->begin(NearlyRedundant::free, "schur");
  CHECK(flat->near.empty());
  State planar;
  flat->run(0.2, planar);
  State first;
  for (const std::string& solver : kSolvers)
    for (const Frame& frame : frames(solver == "schur" ? 10 : 3)) {
      CAPTURE(solver, frame.x.transpose());
      const auto held = four_bar(frame, 1e-5);
      held->begin(NearlyRedundant::held, solver);
      REQUIRE(held->near.size() == 1);
      CHECK(mobility(*held->dynamics, held->start).freedoms == 0);
      const Solution& v = held->dynamics->evaluate(held->start);
      const VecX lambda = carried(v.evaluation);
      CHECK(v.a.lpNorm<Eigen::Infinity>() < 1e-6);
      CHECK((v.lambda - lambda).lpNorm<Eigen::Infinity>() < 1e-7 * lambda.lpNorm<Eigen::Infinity>());

      const auto free = four_bar(frame, 1e-5);
      free->begin(NearlyRedundant::free, solver);
      CHECK(mobility(*free->dynamics, free->start).freedoms == 1);
      CHECK(free->near.front().left_out.size() == 3);
      State end;
      const SimulationReport report = free->run(0.2, end);
      CHECK(report.steps < 300);
      if (first.q.size() == 0) first = end;  // in the world's own frame
      CHECK(distance(free->system, end, frame, flat->system, first) < 1e-8);
      CHECK(distance(free->system, end, frame, flat->system, planar) < 1e-3);
      double moved = 0;
      for (Eigen::Index i = 0; i < end.q.size(); ++i) keep_worst(moved, std::abs(end.q[i] - free->start.q[i]));
      CHECK(moved > 1e-2);
    }
}

// Beside a flat position of a parallelogram rows nearly depend as well, and hold what matters as soon as it moves on.
TEST_CASE("constraints that nearly depend in a single configuration continue to hold", "[stability][redundancy]") {
  for (const NearlyRedundant choice : {NearlyRedundant::free, NearlyRedundant::held}) {
    Model m;
    const double phi = 1e-6;
    const Vec3 way(std::cos(phi), std::sin(phi), 0);
    Body& crank = m.system.add_body("crank", shapes::rod(1, {0, 0, 0}, 0.1 * way));
    Body& coupler = m.system.add_body("coupler", shapes::rod(1, 0.1 * way, 0.1 * way + Vec3(0.3, 0, 0)));
    Body& rocker = m.system.add_body("rocker", shapes::rod(1, {0.3, 0, 0}, Vec3(0.3, 0, 0) + 0.1 * way));
    m.system.set_planar(Plane{2});
    m.system.add<Revolute>("A", crank, m.system.ground(), pose_at({0, 0, 0}));
    m.system.add<Revolute>("B", coupler, crank, pose_at(0.1 * way));
    m.system.add<Revolute>("C", coupler, rocker, pose_at(0.1 * way + Vec3(0.3, 0, 0)));
    m.system.add<Revolute>("D", rocker, m.system.ground(), pose_at({0.3, 0, 0}));
    m.begin(choice, "schur");
    REQUIRE(m.near.size() == 1);
    CHECK(m.near.front().in_passing);
    CHECK(m.near.front().left_out.empty());
    for (const auto& link : m.system.links()) CHECK(m.system.left_out(*link) == 0);
  }
}

TEST_CASE("a left-out constraint is monitored: its violation is an error that names it", "[stability][redundancy]") {
  Model m;
  m.system.set_gravity({0, -9.81, 0});
  Body& rod = m.system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  Lock& hinge = m.system.add<Revolute>("A", rod, m.system.ground(), pose_at({0, 0, 0}));
  m.begin(NearlyRedundant::free, "schur");
  m.system.leave_out(hinge, 2U);  // y: it falls
  m.system.setup();
  m.start = m.system.start();
  State end;
  const std::string said = message_of<ModelError>([&] { m.run(1, end); });
  CHECK(said.find("joint 'A', constraint y") != std::string::npos);
  CHECK(said.find("left out at the start as redundant or nearly redundant") != std::string::npos);
  CHECK(said.find("\"held\" or \"report\"") != std::string::npos);
  testing::check_words(message_of<ModelError>([&] { m.system.leave_out(hinge, 1U << 5); }),
                       {"joint 'A'", "not its own"});
}

TEST_CASE("a drive that is left out is released", "[stability][redundancy]") {
  Model m;
  m.system.set_gravity({0, -9.81, 0});
  Body& rod = m.system.add_body("rod", shapes::rod(1, {0, 0, 0}, {1, 0, 0}));
  auto& hinge = m.system.add<Revolute>("A", rod, m.system.ground(), pose_at({0, 0, 0}));
  hinge.drive(Axis::rz, laws::ramp(1));
  m.begin(NearlyRedundant::reported, "schur");
  m.system.leave_out(hinge, 1U << 5);
  m.system.setup();
  m.start = m.system.start();
  State end;
  m.run(0.3, end);  // it falls: by 3 g/(2 l) t^2/2 = 0.66 rad, less a little, and the drive would lift it by 0.3 rad
  CHECK(body_pose(rod, end).x[1] < -0.25);
}

TEST_CASE("in C++ nothing is decided by default: dependencies are reported, and none is left out or held",
          "[stability][redundancy]") {
  for (const Frame& frame : frames(5)) {
    const auto two = door(frame, true);
    two->dynamics = std::make_unique<Dynamics>(two->system, make_solver(RunSettings{}, builtin_registry()),
                                               DynamicsOptions{Formulation::omega, {}});
    const std::vector<NearDependency> near = decide_nearly_redundant(two->system, *two->dynamics, two->system.start());
    REQUIRE(near.size() == 1);
    CHECK(near.front().rows == Names{"low.y", "low.e1", "high.y", "high.e1"});
    CHECK(near.front().singular_value > 0.1 * kApart);
    CHECK(near.front().singular_value < 10 * kApart);
    CHECK_FALSE(near.front().decided);
    CHECK_FALSE(near.front().in_passing);
    CHECK(near.front().undecided.empty());
    CHECK(near.front().left_out.empty());
    for (const auto& link : two->system.links()) CHECK(two->system.left_out(*link) == 0);
    CHECK(two->system.held_down_to() == 0);
    CHECK(mobility(*two->dynamics, two->system.start()).freedoms == 0);
  }
}

TEST_CASE("by default nearly redundant constraints are released, up to 300 constraints, and reported beyond",
          "[stability][redundancy]") {
  CHECK(RunSettings{}.nearly_redundant == NearlyRedundant::automatic);
  for (const int more : {0, 58, 59}) {  // 10 rows of the door, 5 of each rod that hangs on it
    CAPTURE(more);
    const auto two = door({}, true);
    Body* last = &two->system.body("door");
    for (int k = 0; k < more; ++k) {
      const std::string name = "rod " + std::to_string(k);
      const Vec3 from(0.9 + k, 0, 1), to(1.9 + k, 0, 1);
      Body& rod = two->system.add_body(name, shapes::rod(0.1, from, to));
      two->system.add<Revolute>(name + " hinge", rod, *last, pose_at(from));
      last = &rod;
    }
    two->begin(NearlyRedundant::automatic, "schur");
    REQUIRE(two->near.size() == 1);
    const bool released = more < 59;
    CHECK(two->near.front().free == released);
    CHECK(two->system.held_down_to() == 0);
    CHECK((two->system.left_out(two->system.link("high")) != 0) == released);
  }
}

TEST_CASE("a decision is reversed by the next report", "[stability][redundancy]") {
  const auto two = door({}, true);
  for (const NearlyRedundant choice : {NearlyRedundant::free, NearlyRedundant::held}) {
    two->begin(choice, "schur");
    CHECK(two->near.front().decided);
    CHECK(two->system.left_out(two->system.link("high")) != 0);
    CHECK((two->system.held_down_to() > 0) == (choice == NearlyRedundant::held));
    decide_nearly_redundant(two->system, *two->dynamics, two->system.start());
    for (const auto& link : two->system.links()) CHECK(two->system.left_out(*link) == 0);
    CHECK(two->system.held_down_to() == 0);
  }
}

TEST_CASE("sets with a law are not decided, and no constraint of a law is left out", "[stability][redundancy]") {
  for (const NearlyRedundant choice : {NearlyRedundant::free, NearlyRedundant::held})
    for (const char* const moved : {"low", "high"}) {
      CAPTURE(moved);
      const auto two = door({}, true);
      Lock& hinge = two->system.link(moved);
      REQUIRE(hinge.jointed() != nullptr);
      hinge.jointed()->move(laws::constant_translation(Vec3::Zero()));
      two->system.setup();
      Dynamics dynamics(two->system, make_solver(RunSettings{}, builtin_registry()),
                        DynamicsOptions{Formulation::omega, {}});
      const std::vector<NearDependency> near =
          decide_nearly_redundant(two->system, dynamics, two->system.start(), choice);
      REQUIRE(near.size() == 1);
      CHECK_FALSE(near.front().decided);
      CHECK(near.front().undecided == "one of them is driven");
      CHECK(near.front().left_out.empty());
      for (const auto& link : two->system.links()) CHECK(two->system.left_out(*link) == 0);
      CHECK(two->system.held_down_to() == 0);
    }
}

TEST_CASE("reactions that left-out constraints would share are not unique", "[stability][redundancy]") {
  const auto one = door({}, false);
  one->begin(NearlyRedundant::free, "schur");
  CHECK(uniqueness(*one->dynamics, one->start).all_unique());
  for (const Frame& frame : frames(4)) {
    const auto two = door(frame, true);
    two->begin(NearlyRedundant::free, "schur");
    const UniquenessReport free = uniqueness(*two->dynamics, two->start);
    CHECK(free.undetermined == 5);
    for (const char* const row : {"low.x", "low.y", "low.z", "low.e1", "low.e2", "high.x", "high.y", "high.e2"}) {
      CAPTURE(row);
      CHECK(std::ranges::find(free.rows, row) != free.rows.end());
    }
    CHECK_FALSE(free.unique("low.force_on_p_link_y"));
    CHECK_FALSE(free.unique("high.force_on_p_link_y"));
    CHECK_FALSE(free.unique("low.lambda_y"));
    two->begin(NearlyRedundant::held, "schur");  // then y of both hinges holds, and is determined
    const UniquenessReport held = uniqueness(*two->dynamics, two->start);
    CHECK(held.undetermined == 4);
  }
}

TEST_CASE("a joint with left-out constraints is active, and lists them", "[stability][redundancy]") {
  const auto two = door({}, true);
  two->begin(NearlyRedundant::free, "schur");
  const LinkAccount high = account_of(*two->dynamics, two->start, two->system.link("high"));
  CHECK(high.in_force);
  CHECK(high.rows.empty());
  CHECK(high.left_out == Names{"x", "y", "z", "e1", "e2"});
  const LinkAccount low = account_of(*two->dynamics, two->start, two->system.link("low"));
  CHECK(low.left_out.empty());
  CHECK(low.rows.size() == 5);
}

}  // namespace nearly_redundant_test
