// SPDX-License-Identifier: BSD-3-Clause
// The lock as a link, gathered by the system: each of the 63 masks with rows, every set of the six laws, either body on
// the ground, drives, free turns through 180 and 360 degrees, all against exact derivatives of the constraint.
#include <cmath>
#include <vector>

#include <lockstep/author/passes.h>
#include "tests/support/catch.h"
#include "tests/support/constraint.h"
#include "tests/support/dense.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace masks_test {

using namespace lockstep;
using namespace lockstep::inputs;
using oracle::Configuration;

namespace {

constexpr double kTolerance = 1e-11;

std::vector<int> rows_of(Mask mask) {
  std::vector<int> rows;
  for (int k = 0; k < 6; ++k)
    if (includes(mask, row_bit(k))) rows.push_back(k);
  return rows;
}

/// Exact rows of a configuration, six of them, made once for all masks.
struct Exact {
  oracle::Vector6 C, Ct, Qhat;
  oracle::Matrix6x12 J;
  explicit Exact(const Configuration& c)
      : C(oracle::six<1>(oracle::exact_C(c))),
        Ct(oracle::six<1>(oracle::exact_Ct(c))),
        Qhat(oracle::six<1>(oracle::exact_Qhat(c))),
        J(oracle::six<12>(oracle::exact_Jh(c))) {}
};

/// Rows of the mask out of the exact ones; the columns of a grounded body are left out.
double worst(const Rows& got, const Exact& exact, Mask mask, int grounded) {
  const std::vector<int> rows = rows_of(mask);
  const int n = static_cast<int>(rows.size());
  if (got.C.size() != n) return HUGE_VAL;
  double w = 0;
  for (int i = 0; i < n; ++i) {
    const int k = rows[i];
    keep_worst(w, difference(got.C.segment(i, 1), exact.C.segment(k, 1)));
    keep_worst(w, difference(got.Ct.segment(i, 1), exact.Ct.segment(k, 1)));
    keep_worst(w, difference(got.Qhat.segment(i, 1), exact.Qhat.segment(k, 1)));
    const MatX J = grounded == 0 ? MatX(exact.J.row(k)) : MatX(exact.J.row(k).segment(grounded == 1 ? 6 : 0, 6));
    keep_worst(w, difference(got.J.row(i), J));
  }
  return w;
}

/// Body 1 or 2 brought to rest.
Configuration at_rest(Configuration c, int which) {
  if (which == 1) c.v1.setZero(), c.w1.setZero(), c.qd1.setZero();
  if (which == 2) c.v2.setZero(), c.w2.setZero(), c.qd2.setZero();
  return c;
}

void check_all_masks(const Configuration& c, unsigned laws, int grounded) {
  const Exact exact(c);
  for (unsigned m = 1; m < 64; ++m) {
    const Mask mask = Mask(std::uint8_t(m));
    TwoBodies two(c, laws, grounded);
    two.lock(c, mask, laws);
    two.system.setup();
    const double w = worst(gathered(two.system, two.system.start()), exact, mask, grounded);
    if (w < kTolerance) continue;
    CAPTURE(laws, grounded, to_string(mask));
    CHECK(w < kTolerance);
  }
}

}  // namespace

TEST_CASE("every mask with every set of laws gives the exact constraints", "[verification][lock]") {
  long n = 0;
  for (unsigned laws = 0; laws < 64; ++laws) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
      check_all_masks(oracle::random_configuration(1000 * seed + laws, {laws}), laws, 0);
    ++n;
  }
  CHECK(n == 64);
}

TEST_CASE("markers parallel to their bodies give the exact constraints", "[verification][lock]") {
  for (unsigned laws : {0u, unsigned(oracle::kP), unsigned(oracle::kQD), unsigned(oracle::kP | oracle::kQD)})
    check_all_masks(oracle::random_configuration(40 + laws, {laws, true}), laws, 0);
  // q_P = -1 is the same turn as +1; the rows keep the sign that r = q_S' q_2' q_1 q_P has
  Configuration c = oracle::random_configuration(44, {0, true});
  c.qP = -c.qP;
  check_all_masks(c, 0, 0);
}

TEST_CASE("every mask with P or S on the ground gives the exact constraints", "[verification][lock]") {
  for (unsigned laws = 0; laws < 64; ++laws)
    for (int grounded : {1, 2})
      check_all_masks(at_rest(oracle::random_configuration(7000 + laws, {laws}), grounded), laws, grounded);
}

TEST_CASE("the constraints of an empty mask are rejected", "[verification][lock]") {
  TwoBodies two(oracle::random_configuration(3), 0);
  two.lock(oracle::random_configuration(3), Mask::none, 0);
  testing::check_words(testing::message_of<ModelError>([&] { two.system.setup(); }),
                       {"joint", "a joint has 1 to", "give it a mask"});
}

TEST_CASE("drives add the constraints of their axes with the laws as p and q_D", "[verification][lock]") {
  const LawValue law{0.7, -1.3, 2.1};
  for (int axis = 0; axis < 6; ++axis) {
    for (unsigned m = 0; m < 64; ++m) {
      const Mask mask = Mask(std::uint8_t(m)), bit = row_bit(axis);
      if (includes(mask, bit) || (axis >= 3 && !includes(mask | bit, Mask::e123))) continue;
      for (unsigned laws : {0u, 15u, 32u, 63u}) {
        Configuration c = oracle::random_configuration(90 + laws, {laws});
        // what the drive makes of the imposed laws, by the oracle's own products: p_k = y;  q_D <- q_D Rot_k(y), (1.8),
        // (1.9)
        TwoBodies two(c, laws);
        GenericLock& link = two.lock(c, mask, laws);
        if (!overlaps(mask, Mask::xyz)) c.pD.setZero(), c.pDd.setZero(), c.pDdd.setZero();
        if (!overlaps(mask, Mask::e123)) c.qD = Vec4::UnitX(), c.qDd.setZero(), c.qDdd.setZero();
        link.drive(Axis(axis), std::make_shared<Number>(law));
        if (axis < 3) {
          c.pD[axis] = law.y, c.pDd[axis] = law.yd, c.pDdd[axis] = law.ydd;
        } else {
          const Vec3 n = Vec3::Unit(axis - 3);
          Vec4 turn, turnd, turndd;
          turn << std::cos(law.y / 2), std::sin(law.y / 2) * n;
          oracle::set_rates(turn, law.yd * n, law.ydd * n, turnd, turndd);
          const Vec4 q = c.qD, qd = c.qDd, qdd = c.qDdd;
          using oracle::quaternion_product;
          c.qD = quaternion_product(q, turn);
          c.qDd = quaternion_product(qd, turn) + quaternion_product(q, turnd);
          c.qDdd = quaternion_product(qdd, turn) + 2.0 * quaternion_product(qd, turnd) + quaternion_product(q, turndd);
        }
        two.system.setup();
        const double w = worst(gathered(two.system, two.system.start()), Exact(c), mask | bit, 0);
        CAPTURE(laws, axis, to_string(mask));
        CHECK(w < kTolerance);
      }
    }
  }
}

TEST_CASE("a driven speed takes its value from the state and its rates from the law", "[verification][lock]") {
  Configuration c = oracle::random_configuration(5, {0});
  TwoBodies two(c, 0);
  GenericLock& link = two.lock(c, mask_from("x y e1 e2"), 0);
  link.drive_speed(Axis::z, std::make_shared<Number>(LawValue{0.4, -0.9, 5.0}));
  link.drive_speed(Axis::rz, std::make_shared<Number>(LawValue{1.7, 0.3, 5.0}));
  two.system.setup();
  State state = two.system.start();
  REQUIRE(state.s.size() == 2);
  // it starts where the mechanism does: no residual in its own coordinate where the other turns hold
  CHECK(std::abs(gathered(two.system, state).C[2]) < 1e-12);
  state.s << 0.25, -2.2;
  c.pD[2] = 0.25, c.pDd[2] = 0.4, c.pDdd[2] = -0.9;
  c.qD << std::cos(-1.1), 0, 0, std::sin(-1.1);
  oracle::set_rates(c.qD, 1.7 * Vec3::UnitZ(), 0.3 * Vec3::UnitZ(), c.qDd, c.qDdd);
  CHECK(worst(gathered(two.system, state), Exact(c), Mask::all, 0) < kTolerance);

  std::vector<Motion> motions;
  passes::motions(two.system, state, motions);
  Inputs in;
  in.motions = motions, in.s = {state.s.data(), 2};
  VecX sd(2);
  link.state_rates(in, {sd.data(), 2});
  CHECK(sd == Eigen::Vector2d(0.4, 1.7));
}

TEST_CASE("a revolute joint driven at rest starts at the present angle of the mechanism", "[verification][lock]") {
  for (double angle : {0.0, 0.5, -2.0, kPi, 3.5, -6.0}) {
    Configuration c = oracle::random_configuration(6, {0});
    oracle::place_body_1(c, Vec4(std::cos(angle / 2), 0, 0, std::sin(angle / 2)));
    TwoBodies two(c, 0);
    GenericLock& link = two.lock(c, mask_from("x y z e1 e2"), 0);
    link.drive_speed(Axis::rz, std::make_shared<Number>(LawValue{1.0, 0, 0}));
    two.system.setup();
    CAPTURE(angle);
    CHECK(gathered(two.system, two.system.start()).C.norm() < 1e-12);
  }
}

TEST_CASE("free rotations through half and full revolutions remain correct", "[verification][lock]") {
  for (const char* words : {"x y z e1 e2", "e1 e2", "x y e1 e2", "x y z e3", "x y z", "e3"}) {
    const Mask mask = mask_from(words);
    for (int degrees = -720; degrees <= 720; degrees += 45) {
      const double angle = degrees * kPi / 180;
      Configuration c = oracle::random_configuration(8, {oracle::kP | oracle::kUP});
      // turn about the free axis: z for those that hold e1 e2, an axis normal to z for those that hold e3
      const Vec3 n = includes(mask, Mask::e3) ? Vec3(0.6, 0.8, 0) : Vec3(0, 0, 1);
      Vec4 e;
      e << std::cos(angle / 2), std::sin(angle / 2) * n;
      oracle::place_body_1(c, e);
      TwoBodies two(c, oracle::kP | oracle::kUP);
      two.lock(c, mask, oracle::kP | oracle::kUP);
      two.system.setup();
      const Rows rows = gathered(two.system, two.system.start());
      CAPTURE(words, degrees);
      CHECK(worst(rows, Exact(c), mask, 0) < kTolerance);
      CHECK(rows.C.norm() < 1e-12);
      CHECK(dense::rank(rows.J, 1e-9) == count_rows(mask));
      // (4.19) on the constraint set the rotational rows of each body are orthogonal and of length 1/2
      const int first = count_rows(mask & Mask::xyz), n_turns = count_rows(mask & Mask::e123);
      const MatX B = rows.J.block(first, 3, n_turns, 3);
      CHECK(difference(B * B.transpose(), 0.25 * MatX::Identity(n_turns, n_turns)) < 1e-12);
    }
  }
}

TEST_CASE("a driven rotation continues through full revolutions", "[verification][lock]") {
  for (int degrees = -1080; degrees <= 1080; degrees += 60) {
    const double angle = degrees * kPi / 180;
    Configuration c = oracle::random_configuration(9, {0});
    oracle::place_body_1(c, Vec4(std::cos(angle / 2), 0, 0, std::sin(angle / 2)));
    TwoBodies two(c, 0);
    two.lock(c, mask_from("x y z e1 e2"), 0).drive(Axis::rz, std::make_shared<Number>(LawValue{angle, 0.3, 0.1}));
    two.system.setup();
    CAPTURE(degrees);
    const Rows rows = gathered(two.system, two.system.start());
    CHECK(rows.C.norm() < 1e-12);
    CHECK(dense::rank(rows.J, 1e-9) == 6);
    // a full turn more in the law is the same place: only the sign of the turning rows may differ
    TwoBodies more(c, 0);
    more.lock(c, mask_from("x y z e1 e2"), 0)
        .drive(Axis::rz, std::make_shared<Number>(LawValue{angle + kTwoPi, 0.3, 0.1}));
    more.system.setup();
    const Rows other = gathered(more.system, more.system.start());
    CHECK(difference(other.J.topRows(3), rows.J.topRows(3)) < 1e-12);
    CHECK(difference(-other.J.bottomRows(3), rows.J.bottomRows(3)) < 1e-12);
    CHECK(difference(-other.Qhat.tail(3), rows.Qhat.tail(3)) < 1e-11);
  }
}

TEST_CASE("every mask has full rank on its whole constraint set", "[verification][lock]") {
  // (4.23); points of the set: e any quaternion whose masked components are zero, the free translations anywhere
  for (unsigned m = 1; m < 64; ++m) {
    const Mask mask = Mask(std::uint8_t(m));
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      oracle::Draw draw(seed * 64 + m);
      Configuration c = oracle::random_configuration(seed * 64 + m);
      Vec4 e = draw.quaternion();
      Vec3 C = draw.vector(1.0);
      if (seed == 5) e[0] = 0;  // half a turn
      for (int k = 0; k < 3; ++k) {
        if (includes(mask, row_bit(k))) C[k] = 0;
        if (includes(mask, row_bit(k + 3))) e[k + 1] = 0;
      }
      if (e.norm() < 1e-6) e = Vec4::UnitX();
      oracle::place_body_1(c, e.normalized(), C);
      TwoBodies two(c, 63);
      two.lock(c, mask, 63);
      two.system.setup();
      const Rows rows = gathered(two.system, two.system.start());
      CAPTURE(to_string(mask), seed);
      CHECK(rows.C.norm() < 1e-12);
      CHECK(dense::rank(rows.J, 1e-9) == count_rows(mask));
    }
  }
}

}  // namespace masks_test
