// SPDX-License-Identifier: BSD-3-Clause
// Which rows depend on which: by name, in any order and frame, of any size, and those that nearly do.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include <lockstep/analysis.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "tests/support/catch.h"

namespace mobility_test {

using namespace lockstep;

namespace {

using Names = std::vector<std::string>;

MobilityReport report_of(System& sys) {
  sys.setup();
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  return mobility(dynamics, sys.start());
}

// A door on two hinges whose axes are d apart, m.
MobilityReport door(double d) {
  System sys;
  Body& leaf = sys.add_body("leaf", shapes::box(20.0, {0.9, 0.04, 2.0}), pose_at({0.45, 0, 1}));
  sys.add<Revolute>("low", leaf, sys.ground(), pose_at({0, 0, 0.2}));
  sys.add<Revolute>("high", leaf, sys.ground(), pose_at({d, 0, 1.8}));
  return report_of(sys);
}

// A ladder of n square bays of hinges about z, in a frame of the world turned by `turn`; links added in this order.
System ladder(int n, const Quat& turn, bool backwards) {
  System sys;
  const Mat3 A = rotation(turn);
  const auto at = [&](double x, double y) { return Pose{Vec3(A * Vec3(x, y, 0)), turn}; };
  const auto rod = [&](const std::string& name, const Vec3& a, const Vec3& b) {
    return &sys.add_body(name, shapes::rod(1.0, A * a, A * b));
  };
  std::vector<Body*> posts, beams;
  for (int k = 0; k <= n; ++k) posts.push_back(rod("post" + std::to_string(k), Vec3(k, 0, 0), Vec3(k, 1, 0)));
  for (int k = 0; k < n; ++k) beams.push_back(rod("beam" + std::to_string(k), Vec3(k, 1, 0), Vec3(k + 1, 1, 0)));
  const int from = backwards ? n : 0, step = backwards ? -1 : 1;
  for (int i = 0, k = from; i <= n; ++i, k += step) {
    const std::string number = std::to_string(k);
    const auto foot = [&] { sys.add<Revolute>("A" + number, *posts[k], sys.ground(), at(k, 0)); };
    if (!backwards) foot();
    if (k < n) {
      sys.add<Revolute>("B" + number, *beams[k], *posts[k], at(k, 1));
      sys.add<Revolute>("C" + number, *beams[k], *posts[k + 1], at(k + 1, 1));
    }
    if (backwards) foot();
  }
  return sys;
}

std::set<std::string> names(const Names& rows) { return {rows.begin(), rows.end()}; }

}  // namespace

TEST_CASE("two hinges on one axis: their dependent constraints", "[unit][analysis]") {
  const MobilityReport r = door(0);
  CHECK(r.freedoms == 1);
  CHECK(r.redundant == 5);
  REQUIRE(r.dependencies.size() == 3);
  CHECK(r.dependencies[0].rows == Names{"low.x", "low.e2", "high.x", "high.e2"});
  CHECK(r.dependencies[0].too_many == 2);
  CHECK(r.dependencies[1].rows == Names{"low.y", "low.e1", "high.y", "high.e1"});
  CHECK(r.dependencies[1].too_many == 2);
  CHECK(r.dependencies[2].rows == Names{"low.z", "high.z"});
  CHECK(r.dependencies[2].too_many == 1);
  for (const Dependency& d : r.dependencies) CHECK(d.nearly == 0);
}

TEST_CASE("two hinges nearly on one axis: near redundancy is reported with its pivot", "[unit][analysis]") {
  for (const double d : {1e-3, 1e-6, 1e-7, 1e-8}) {
    CAPTURE(d);
    const MobilityReport r = door(d);
    CHECK(r.freedoms == 0);
    const auto near = std::ranges::find(r.dependencies, 1, &Dependency::nearly);
    REQUIRE(near != r.dependencies.end());
    CHECK(near->rows == Names{"low.y", "low.e1", "high.y", "high.e1"});
    CHECK(near->too_many == 1);
    CHECK(near->pivot > 0.1 * d);
    CHECK(near->pivot < 10 * d);
  }
  for (const double d : {0.0, 1e-12, 2e-3, 1e-2})
    for (const Dependency& found : door(d).dependencies) CHECK(found.nearly == 0);
  CHECK(door(1e-12).freedoms == 1);
  CHECK(door(1e-2).freedoms == 0);
}

TEST_CASE("dependencies do not know the order of the joints or the world's axes", "[unit][analysis]") {
  System first = ladder(3, Quat{}, false);
  const MobilityReport r = report_of(first);
  CHECK(r.freedoms == 1);
  CHECK(r.redundant == 9);
  REQUIRE(r.dependencies.size() == 1);
  const std::set<std::string> rows = names(r.dependencies[0].rows);
  for (const std::string row : {"A0.z", "A0.e1", "A3.e2", "B1.z", "C2.e1"}) CHECK(rows.count(row) == 1);
  for (const std::string row : {"A0.x", "A3.y", "B1.x"}) CHECK(rows.count(row) == 0);
  CHECK(rows.size() == 3 * 10);
  for (int i = 1; i <= 20; ++i) {
    const Quat turn = exponential(Vec3(0.3 * i, -0.7 + 0.1 * i, 1.0 / i));
    System other = ladder(3, turn, i % 2 == 1);
    const MobilityReport o = report_of(other);
    CAPTURE(i);
    CHECK(o.freedoms == 1);
    REQUIRE(o.dependencies.size() == 1);
    CHECK(o.dependencies[0].too_many == 9);
    CHECK(names(o.dependencies[0].rows) == rows);
  }
}

TEST_CASE("loops that share a body only, or nothing, are counted by themselves", "[unit][analysis]") {
  // a slab on the ground by a ball, and on the slab two doors, each on two hinges
  System sys;
  Body& slab = sys.add_body("slab", shapes::box(1.0, {4, 1, 0.1}));
  sys.add<Spherical>("ball", slab, sys.ground(), pose_at({0, 0, 0}));
  for (const std::string side : {"left", "right"}) {
    const double x = side == "left" ? -1 : 1;
    Body& leaf = sys.add_body(side, shapes::box(20.0, {0.9, 0.04, 2.0}), pose_at({x + 0.45, 0, 1}));
    sys.add<Revolute>(side + "_low", leaf, slab, pose_at({x, 0, 0.2}));
    sys.add<Revolute>(side + "_high", leaf, slab, pose_at({x, 0, 1.8}));
  }
  const MobilityReport r = report_of(sys);
  CHECK(r.freedoms == 3 + 2);
  CHECK(r.redundant == 10);
  REQUIRE(r.dependencies.size() == 6);
  for (const Dependency& d : r.dependencies) {
    const std::string side = d.rows[0].substr(0, d.rows[0].find('_'));
    for (const std::string& row : d.rows) CHECK(row.substr(0, side.size()) == side);
  }
  CHECK(r.redundant_links == Names{"left_low", "left_high", "right_low", "right_high"});
}

TEST_CASE("one long loop: its dependency extends over all constraints, and is counted", "[unit][analysis]") {
  // n bodies on a circle, each fixed to the next or hinged to it about z, the first and the last on the ground
  for (const bool hinged : {false, true})
    for (const int n : {40, 60, 100, 400}) {
      System sys;
      const auto at = [&](double k) { return Vec3(std::cos(k / n * 6.0), std::sin(k / n * 6.0), 0); };
      const auto join = [&](const std::string& name, Body& p, Body& s, const Vec3& x) {
        if (hinged)
          sys.add<Revolute>(name, p, s, pose_at(x));
        else
          sys.add<Fixed>(name, p, s, pose_at(x));
      };
      Body* last = &sys.ground();
      for (int k = 0; k < n; ++k) {
        const std::string name = std::to_string(k);
        Body& body = sys.add_body(name, shapes::rod(1.0, at(k), at(k + 1)));
        join("j" + name, body, *last, at(k));
        last = &body;
      }
      join("end", *last, sys.ground(), at(n));
      sys.set_merge(false);
      const MobilityReport r = report_of(sys);
      CAPTURE(hinged, n);
      CHECK(r.freedoms == (hinged ? n - 2 : 0));
      CHECK(r.redundant == (hinged ? 3 : 6));
      int too_many = 0;
      for (const Dependency& d : r.dependencies) too_many += d.too_many;
      CHECK(too_many == r.redundant);
      CHECK(r.redundant_links.size() == static_cast<std::size_t>(n + 1));
    }
}

TEST_CASE("degrees of freedom and redundant constraints of large loops are those of small ones, bay by bay",
          "[unit][analysis]") {
  for (const int n : {10, 24, 25, 60, 400}) {  // 300 rows are those of 19 bays
    System sys = ladder(n, exponential(Vec3(0.3, 0.2, -0.5)), false);
    const MobilityReport r = report_of(sys);
    CAPTURE(n);
    CHECK(r.rows == 5 * (3 * n + 1));
    CHECK(r.freedoms == 1);
    CHECK(r.redundant == 3 * n);
    REQUIRE(r.dependencies.size() == 1);
    CHECK(r.dependencies[0].rows.size() == static_cast<std::size_t>(3 * (3 * n + 1)));
    CHECK(r.redundant_links.size() == static_cast<std::size_t>(3 * n + 1));
  }
}

// Vectors of one loop have the rows of that loop alone: those of all rows would fill the memory.
TEST_CASE("reactions of many loops are judged loop by loop, and of a long loop as of a short one", "[unit][analysis]") {
  const auto not_unique = [](System& sys) {
    sys.setup();
    Dynamics dynamics(sys, std::make_unique<SchurSolver>());
    return uniqueness(dynamics, sys.start());
  };
  System many;
  constexpr int kLoops = 500;
  for (int k = 0; k < kLoops; ++k) {
    const std::string number = std::to_string(k);
    Body& leaf = many.add_body("leaf" + number, shapes::box(20.0, {0.9, 0.04, 2.0}), pose_at({0.45 + k, 0, 1}));
    many.add<Revolute>("low" + number, leaf, many.ground(), pose_at({0.0 + k, 0, 0.2}));
    many.add<Revolute>("high" + number, leaf, many.ground(), pose_at({0.0 + k, 0, 1.8}));
  }
  const UniquenessReport doors = not_unique(many);
  CHECK(doors.undetermined == 5 * kLoops);
  CHECK(doors.rows.size() == 10 * kLoops);
  CHECK_FALSE(doors.unique("high499.force_on_p_world_z"));
  CHECK_FALSE(doors.unique("low0.torque_on_p_link_x"));
  CHECK(doors.unique("low0.torque_on_p_link_z"));
  for (const int bays : {3, 40}) {  // 50 and 605 rows, densely and sparsely
    CAPTURE(bays);
    System sys = ladder(bays, Quat{}, false);
    const UniquenessReport found = not_unique(sys);
    CHECK(found.undetermined == 3 * bays);
    CHECK(names(found.rows).size() == 3 * (3 * static_cast<std::size_t>(bays) + 1));
    for (const std::string& row : found.rows)
      CHECK((row.ends_with(".z") || row.ends_with(".e1") || row.ends_with(".e2")));
    CHECK(found.unique("B1.force_on_p_world_x"));
    CHECK_FALSE(found.unique("B1.force_on_p_world_z"));
    CHECK_FALSE(found.unique("B1.torque_on_s_world_y"));
  }
}

}  // namespace mobility_test
