// SPDX-License-Identifier: BSD-3-Clause
// LoopSizes: what is rounding in the rows of a loop is told by its own size, whatever hangs on it or moves beside it.
#include "framework/dynamics/evaluate/loop_rows.h"

#include <lockstep/author/passes.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"

namespace lockstep::testing::loop_sizes_test {

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// A square of three rods on the ground, turned by R about the origin.
Body& add_square(System& s, const std::string& name, double size, const Mat3& R = Mat3::Identity()) {
  const Vec3 corners[] = {Vec3::Zero(), R * Vec3(0, size, 0), R * Vec3(size, size, 0), R * Vec3(size, 0, 0)};
  const Vec3 axis = R.col(2);
  Body* rods[3];
  for (int k = 0; k < 3; ++k)
    rods[k] = &s.add_body(name + std::to_string(k), shapes::rod(1.0, corners[k], corners[k + 1]));
  for (int k = 0; k < 4; ++k)
    s.add<Revolute>(name + "ABCD"[k], k < 3 ? *rods[k] : s.ground(), k > 0 ? *rods[k - 1] : s.ground(),
                    pose_at(corners[k], axis));
  return *rods[1];
}

struct Sized {
  explicit Sized(System& s) : start((s.setup(), s.start())), sizes(s, start.modes) {
    passes::lay_out(s, start.modes, table);
    passes::motions(s, start, motions);
  }
  // A residual of the first translation of a joint.
  VecX only(const Lock& link, double value) const {
    VecX c = VecX::Zero(table.n_rows);
    for (const RowEntry& e : table.entries)
      if (e.link == link.number()) c[e.first_row] = value;
    return c;
  }
  State start;
  LoopSizes sizes;
  RowTable table;
  std::vector<Motion> motions;
};

}  // namespace

TEST_CASE("residuals of a small loop are rounding by its own size, beside a large one", "[unit][loops]") {
  System s;
  Body& coupler = add_square(s, "small", 0.005);
  add_square(s, "large", 20);
  Body& hung = s.add_body("hung", shapes::rod(1.0, Vec3(0, 0.005, 0), Vec3(0, -20, 0)));
  s.add<Revolute>("H", hung, coupler, pose_at(Vec3(0, 0.005, 0)));
  Sized of(s);
  for (Motion& O : of.motions) O.w = Vec3(0, 0, -3);
  for (const auto& [joint, size] : {std::pair{"smallA", 0.005}, std::pair{"largeC", 20.0}}) {
    CAPTURE(joint);
    const Lock& link = s.link(joint);
    const double position = 0.5e-14 * size + 4 * kEps * 1.5 * size, rate = 8 * kEps * 1.5 * size;
    for (const double sign : {-1.0, 1.0}) {
      CHECK(of.sizes.are_met(of.table, of.only(link, sign * 0.99 * position), of.motions));
      CHECK_FALSE(of.sizes.are_met(of.table, of.only(link, sign * 1.01 * position), of.motions));
      CHECK(of.sizes.are_rates_met(of.table, of.only(link, sign * 0.99 * rate), of.motions));
      CHECK_FALSE(of.sizes.are_rates_met(of.table, of.only(link, sign * 1.01 * rate), of.motions));
    }
    CHECK_FALSE(of.sizes.are_met(of.table, of.only(link, NAN), of.motions));
    CHECK_FALSE(of.sizes.are_rates_met(of.table, of.only(link, NAN), of.motions));
  }
  CHECK(of.sizes.length(coupler.slot) == Approx(0.0025));  // although a rod of 20 m hangs on it
  CHECK(of.sizes.length(hung.slot) == s.length());
}

TEST_CASE("the size of a loop is the same in all axes", "[unit][loops]") {
  const auto length = [](const Mat3& R) {
    System s;
    Body& plate = s.add_body("plate", MassProperties{1, Vec3::Zero(), 1e-3 * Mat3::Identity()});
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0.8, 0)}) {
      const std::string name = "r" + std::to_string(s.bodies().size());
      Body& rod = s.add_body(name, shapes::rod(1.0, R * x, R * (x + Vec3(0, -0.1, 0))));
      s.add<Revolute>(name + "p", rod, plate, pose_at(R * x, R.col(2)));
      s.add<Revolute>(name + "g", rod, s.ground(), pose_at(R * (x + Vec3(0, -0.1, 0)), R.col(2)));
    }
    Sized of(s);
    return of.sizes.length(plate.slot);
  };
  const double upright = length(Mat3::Identity());
  CHECK(upright == Approx((Vec3(1.0, 0, 0) - Vec3(1.3, 0.8, 0) / 3).norm()));
  CHECK(length(rotation(axis_angle(Vec3(1, -2, 0.5), 1.1))) == Approx(upright).epsilon(1e-12));
}

}  // namespace lockstep::testing::loop_sizes_test
