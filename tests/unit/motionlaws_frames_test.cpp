// SPDX-License-Identifier: BSD-3-Clause
// Translation and rotation laws. Oracle of rotations: w = 2 vec(q' qd), a = 2 vec(q' qdd) on jets of the quaternion's
// formula, not the library's G; of the spline of orientations: differences of its own orientations, and motions that
// are known.

#include <lockstep/error.h>
#include <lockstep/frame_laws.h>
#include <lockstep/laws.h>
#include <lockstep/math.h>
#include <lockstep/splines.h>
#include "tests/support/law_checks.h"
#include "tests/support/worst.h"

namespace motionlaws_frames_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

template <class T>
QuatT<T> about(const Vec3& axis, const T& angle) {
  const Vec3 n = axis.normalized();
  const T s = sin(0.5 * angle);
  return {cos(0.5 * angle), n[0] * s, n[1] * s, n[2] * s};
}

// q, w and a of a unit quaternion's formula, from its derivatives.
RotationValue oracle(const QuatT<Time>& q) {
  const Quat v{q.w.v, q.x.v, q.y.v, q.z.v}, d{q.w.d, q.x.d, q.y.d, q.z.d}, h{q.w.h, q.x.h, q.y.h, q.z.h};
  return {v, 2.0 * (conjugate(v) * d).vec(), 2.0 * (conjugate(v) * h).vec()};
}

template <class F>
void check_rotation(const RotationLaw& law, F f) {
  for (const double t : {-1.3, -0.2, 0.0, 0.4, 1.0, 2.7}) {
    INFO("t = " << t);
    const RotationValue r = law.at(t), o = oracle(f(Time(t, 1.0, 0.0)));
    CHECK(std::abs(r.q.coefficients().dot(o.q.coefficients())) == Approx(1).epsilon(1e-14));
    CHECK(norm2(r.q) == Approx(1).epsilon(1e-14));
    CHECK((r.w - o.w).norm() < 1e-13 * (1 + o.w.norm()));
    CHECK((r.a - o.a).norm() < 1e-13 * (1 + o.a.norm()));
  }
}

// Component k of a rotation law as a scalar law: a component of A(q) (the sign of q is free), of w and of a.
class Component final : public MotionLaw {
 public:
  Component(LawPtr<RotationLaw> law, int k) : law_(std::move(law)), k_(k) {}
  LawValue at(double t) const override {
    const RotationValue r = law_->at(t);
    return {rotation(r.q)(k_, (k_ + 1) % 3), r.w[k_], r.a[k_]};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law_->breakpoints(t0, t1, out); }

 private:
  LawPtr<RotationLaw> law_;
  int k_;
};

// Central differences of order 4 of the law's own orientations.
void check_rates_by_differences(const RotationLaw& law, double t) {
  constexpr double h = 1e-3;
  INFO("t = " << t);
  const RotationValue r = law.at(t);
  const auto turn = [&](double dt) {
    const Quat d = conjugate(r.q) * law.at(t + dt).q;
    return Vec3((d.w < 0 ? -2.0 : 2.0) * d.vec());
  };
  const Vec3 w = (8.0 * (turn(h) - turn(-h)) - (turn(2 * h) - turn(-2 * h))) / (12 * h);
  const Vec3 a = (8.0 * (law.at(t + h).w - law.at(t - h).w) - (law.at(t + 2 * h).w - law.at(t - 2 * h).w)) / (12 * h);
  CHECK((w - r.w).norm() < 1e-8 * (1 + r.w.norm()));
  CHECK((a - r.a).norm() < 1e-7 * (1 + r.a.norm()));
}

const RotationPoints kPoses{
    {0.0, {1, 0, 0, 0}},          {0.3, {0.8, 0.5, -0.1, 0.2}}, {0.7, {-0.2, -0.9, 0.3, -0.1}},
    {1.2, {-0.1, 0.7, 0.2, 0.6}}, {1.5, {0.3, 0.2, 0.4, 0.9}},  {2.0, {-2, 0, 0, 0}}};

}  // namespace

TEST_CASE("translation laws: constant, components, along", "[unit][motionlaws]") {
  const auto kick = laws::harmonic_rise({.duration = 0.5});
  const auto three = laws::components(laws::sine({}), laws::polynomial({1, 2, 3}), kick);
  const TranslationValue v = three->at(0.2);
  CHECK((v.x - Vec3(std::sin(0.2), 1.52, kick->at(0.2).y)).norm() < 1e-15);
  CHECK((v.v - Vec3(std::cos(0.2), 3.2, kick->at(0.2).yd)).norm() < 1e-15);
  CHECK((v.a - Vec3(-std::sin(0.2), 6, kick->at(0.2).ydd)).norm() < 1e-14);
  const auto way = laws::along(Vec3(0, 3, 4), kick, Vec3(1, 0, 0));
  CHECK((way->at(0.2).x - Vec3(1, 0.6 * kick->at(0.2).y, 0.8 * kick->at(0.2).y)).norm() < 1e-15);
  CHECK((way->at(0.2).v - kick->at(0.2).yd * Vec3(0, 0.6, 0.8)).norm() < 1e-15);
  CHECK((way->at(0.2).a - kick->at(0.2).ydd * Vec3(0, 0.6, 0.8)).norm() < 1e-14);
  for (const auto& law : {three, way}) {
    std::vector<double> b;
    law->breakpoints(-1, 1, b);
    CHECK(b == std::vector<double>{0.0, 0.5});
  }
  const TranslationValue c = laws::constant_translation(Vec3(1, 2, 3))->at(9);
  CHECK((c.x == Vec3(1, 2, 3) && c.v.norm() == 0 && c.a.norm() == 0));
}

TEST_CASE("path: each component is the scalar spline", "[unit][motionlaws]") {
  const PathPoints points{{0, {1, 2, 3}}, {0.4, {-1, 0, 3}}, {1, {2, 2, 0}}, {1.5, {0, 1, 1}}};
  for (const int degree : {3, 5}) {
    const SplineSettings k{degree, SplineEnds::clamped, SplineOutside::hold};
    const auto curve = laws::path(points, k, {.start_velocity = {1, 2, 3}, .end_acceleration = {4, 5, 6}});
    for (int i = 0; i < 3; ++i) {
      SplinePoints own;
      for (const auto& [t, x] : points) own.emplace_back(t, x[i]);
      const auto one = laws::spline(own, k, {.start_rate = 1.0 + i, .end_acceleration = 4.0 + i});
      for (const double t : {-1.0, 0.0, 0.2, 0.4, 0.9, 1.4, 3.0}) {
        CHECK(curve->at(t).x[i] == Approx(one->at(t).y).margin(1e-14));
        CHECK(curve->at(t).v[i] == Approx(one->at(t).yd).margin(1e-13));
        CHECK(curve->at(t).a[i] == Approx(one->at(t).ydd).margin(1e-12));
      }
    }
    std::vector<double> b;
    curve->breakpoints(-1, 2, b);
    CHECK(b == std::vector<double>{0.0, 1.5});
  }
}

TEST_CASE("rotation laws: constant, about an axis, product, from a function", "[unit][motionlaws]") {
  const Vec3 n1(1, 2, -1), n2(0.3, -0.5, 2), n3(-1, 0.2, 0.4);
  const auto y1 = [](auto t) { return 0.4 + 1.3 * sin(2.0 * t); };
  const auto y2 = [](auto t) { return 1.0 - 2.0 * t + 0.7 * t * t; };
  const auto y3 = [](auto t) { return 5.0 * t; };
  const auto q1 = laws::axis_rotation(n1, laws::law(y1)), q2 = laws::axis_rotation(n2, laws::polynomial({1, -2, 0.7})),
             q3 = laws::axis_rotation(n3, laws::ramp(5));
  check_rotation(*q1, [&](auto t) { return about(n1, y1(t)); });
  check_rotation(*q2, [&](auto t) { return about(n2, y2(t)); });
  check_rotation(*laws::rotation_product(q1, q2), [&](auto t) { return about(n1, y1(t)) * about(n2, y2(t)); });
  check_rotation(*laws::rotation_product(laws::rotation_product(q1, q2), q3),
                 [&](auto t) { return about(n1, y1(t)) * about(n2, y2(t)) * about(n3, y3(t)); });
  check_rotation(*laws::rotation_product(q1, laws::rotation_product(q2, q3)),
                 [&](auto t) { return about(n1, y1(t)) * about(n2, y2(t)) * about(n3, y3(t)); });
  const auto fixed = laws::constant_rotation({2, 0, 0, 2});
  check_rotation(*laws::rotation_product(fixed, q1),
                 [&](auto t) { return about(Vec3(0, 0, 1), 0.0 * t + kPi / 2) * about(n1, y1(t)); });
  // Not of length 1 before it is normalised.
  check_rotation(*laws::rotation([&](auto t) {
    const auto q = about(n1, y1(t));
    const auto s = 2.0 + t * t;
    return decltype(q){s * q.w, s * q.x, s * q.y, s * q.z};
  }),
                 [&](auto t) { return about(n1, y1(t)); });
  CHECK(laws::axis_rotation(Vec3(0, 0, 2), laws::constant(kPi))->at(0).q.z == Approx(1));
}

TEST_CASE("rotation laws pass breakpoints on", "[unit][motionlaws]") {
  const auto a = laws::axis_rotation(Vec3(1, 2, 3), laws::harmonic_rise({.duration = 0.5}));
  const auto b = laws::axis_rotation(Vec3(1, -1, 0), laws::harmonic_rise({.t0 = 0.7}));
  for (int k = 0; k < 3; ++k) check_breakpoints(Component(a, k), -1, 3, {0, 0.5});
  check_breakpoints(Component(laws::rotation_product(a, b), 0), -1, 3, {0, 0.5, 0.7, 1.7});
  check_breakpoints(
      Component(
          laws::rotation([](auto t) { return about(Vec3(1, 1, 0), t < 0.3 ? 0.0 * t : (t - 0.3) * (t - 0.3)); }, {0.3}),
          0),
      -1, 1, {0.3});
}

TEST_CASE("spline of orientations: through its points, twice differentiable, rates that belong to it",
          "[unit][motionlaws]") {
  for (const int degree : {3, 5})
    for (const SplineEnds ends : {SplineEnds::natural, SplineEnds::clamped, SplineEnds::periodic}) {
      INFO("degree " << degree << ", ends " << static_cast<int>(ends));
      const SplineSettings k{degree, ends,
                             ends == SplineEnds::periodic ? SplineOutside::repeat : SplineOutside::refuse};
      const auto law = laws::spline_rotation(kPoses, k);
      for (const auto& [t, q] : kPoses)
        CHECK(std::abs(law->at(t).q.coefficients().dot(normalized(q).coefficients())) == Approx(1).epsilon(1e-13));
      for (const double t : {0.1, 0.31, 0.5, 0.9, 1.3, 1.8}) {
        check_rates_by_differences(*law, t);
        CHECK(norm2(law->at(t).q) == Approx(1).epsilon(1e-14));
      }
      const double from = ends == SplineEnds::periodic ? -2.7 : 0.0, to = ends == SplineEnds::periodic ? 4.4 : 2.0;
      for (int i = 0; i < 3; ++i) check_breakpoints(Component(law, i), from, to, {});
      if (ends == SplineEnds::clamped) {
        CHECK(law->at(0).w.norm() < 1e-14);
        CHECK(law->at(2).w.norm() < 1e-12);
        if (degree == 5) CHECK(law->at(2).a.norm() < 1e-10);
      }
    }
}

TEST_CASE("spline of orientations: many revolutions about an axis, converging to the uniform rotation",
          "[unit][motionlaws]") {
  const Vec3 n = Vec3(1, 2, 2) / 3.0;
  double last = 0;
  for (const int n_points : {13, 25}) {  // 720 degrees: 60, then 30 degrees apart
    RotationPoints p;
    for (int i = 0; i < n_points; ++i) {
      const double t = 2.0 * i / (n_points - 1);
      Quat q = axis_angle(n, kTwoPi * t);
      p.emplace_back(t, i % 3 == 1 ? -q : q);  // the sign of what is given does not matter
    }
    const auto law = laws::spline_rotation(p, {.ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
    double error = 0;
    for (int i = 0; i <= 100; ++i) keep_worst(error, (law->at(0.033 * i).w - kTwoPi * n).norm());
    CHECK(error < 0.02 * kTwoPi);
    if (last > 0) CHECK(error < last / 6);  // at least third order: 8 less rounding of the measure
    last = error;
  }
}

TEST_CASE("spline of orientations: an odd number of revolutions closes too, quaternions with the other sign",
          "[unit][motionlaws]") {
  RotationPoints p;
  for (int i = 0; i <= 6; ++i) p.emplace_back(0.5 * i, axis_angle(Vec3(0, 0, 1), kTwoPi * i / 6));
  const auto law = laws::spline_rotation(p, {.ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
  for (int i = 0; i < 3; ++i) check_breakpoints(Component(law, i), -4, 7, {});
  CHECK(law->at(0.2).q.w == Approx(-law->at(3.2).q.w));  // q itself goes on, too
  CHECK(law->at(0.2).w[2] == Approx(kTwoPi / 3).epsilon(0.02));
}

TEST_CASE("spline of orientations does not depend on the axes that are used", "[unit][motionlaws]") {
  const Quat left = axis_angle(Vec3(1, -2, 0.5), 1.1), right = axis_angle(Vec3(0.2, 1, 1), -0.7);
  RotationPoints turned;
  for (const auto& [t, q] : kPoses) turned.emplace_back(t, left * normalized(q) * right);
  const auto a = laws::spline_rotation(kPoses), b = laws::spline_rotation(turned);
  for (const double t : {0.1, 0.8, 1.7}) {
    CHECK(std::abs((left * a->at(t).q * right).coefficients().dot(b->at(t).q.coefficients())) ==
          Approx(1).epsilon(1e-13));
    CHECK((rotation(right).transpose() * a->at(t).a - b->at(t).a).norm() < 1e-10);
  }
}

TEST_CASE("translation and rotation laws reject impossible arguments", "[unit][motionlaws]") {
  CHECK_THROWS_WITH(laws::constant_translation(Vec3(0, std::nan(""), 0)), says("constant") && says("value is nan"));
  CHECK_THROWS_WITH(laws::components(laws::ramp(1), nullptr, laws::ramp(1)), says("components") && says("y is null"));
  CHECK_THROWS_WITH(laws::along(Vec3::Zero(), laws::ramp(1)), says("along") && says("axis is [0, 0, 0]"));
  CHECK_THROWS_WITH(laws::path({{0, Vec3::Zero()}, {0, Vec3::Zero()}}), says("path") && says("must increase"));
  CHECK_THROWS_WITH(laws::path({{0, Vec3::Zero()}}), says("at least 2"));
  CHECK_THROWS_WITH(laws::path({{0, Vec3::Zero()}, {1, Vec3::Zero()}})->at(2), says("path") && says("from 0 to 1"));
  CHECK_THROWS_WITH(laws::constant_rotation({0, 0, 0, 0}), says("constant") && says("not an orientation"));
  CHECK_THROWS_WITH(laws::axis_rotation(Vec3::Zero(), laws::ramp(1)), says("axis_rotation") && says("axis"));
  CHECK_THROWS_WITH(laws::axis_rotation(Vec3(0, 0, 1), nullptr), says("axis_rotation") && says("null"));
  CHECK_THROWS_WITH(laws::rotation_product(nullptr, laws::constant_rotation({})), says("product") && says("first is null"));
  CHECK_THROWS_WITH(laws::spline_rotation({{0, {}}, {1, {0, 1, 0, 0}}}), says("number 1 and 2 are 180 deg apart"));
  CHECK_THROWS_WITH(laws::spline_rotation({{0, {}}, {1, {0, 0, 0, 0}}}), says("not an orientation"));
  CHECK_THROWS_WITH(laws::spline_rotation({}), says("spline_rotation") && says("at least 2"));
  CHECK_THROWS_WITH(laws::spline_rotation({{0, {}}, {1, {1, 1, 0, 0}}, {2, {1, 0, 1, 0}}}, {.ends = SplineEnds::periodic}),
                    says("rad away"));
}

}  // namespace motionlaws_frames_test
