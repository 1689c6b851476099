// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/force.h>

#include <complex>

#include <lockstep/author/relative.h>
#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"

namespace force_tangent_test {

// Oracle: every force's formula of its header once more, on complex numbers: with x + i h dx, q + i h (1/2) q dth,
// v + i h, w + i h the imaginary part is h times the derivative, exactly for a small enough h.
using namespace lockstep;
using oracle::ForceBench;

namespace {

using C = std::complex<double>;
using Vec = Vec3T<C>;
using Mat = Mat3T<C>;
using Wrench = Eigen::Matrix<C, 12, 1>;
using Tangent = Eigen::Matrix<double, 12, 24>;  // columns: poses of both slots, then velocities
constexpr double kTiny = 1e-40;

C dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
C norm(const Vec& a) { return std::sqrt(dot(a, a)); }

struct At {  // a marker in the world, on complex numbers
  Vec x, v, w;
  Mat A;
  QuatT<C> q;
};

/// Both slots, moved along unknown k of 24 (-1: not moved), and the force that a formula gives.
struct Moved {
  MotionT<C> O[2];
  At P, S;
  const ForceBench& bench;

  Moved(const ForceBench& b, int k) : bench(b) {
    for (int side = 0; side < 2; ++side) {
      const Motion& o = b.motions[side + 1];
      MotionT<C>& r = O[side];
      r.x = o.x.cast<C>(), r.v = o.v.cast<C>(), r.w = o.w.cast<C>();
      r.e = {o.e.w, o.e.x, o.e.y, o.e.z};
      const C h(0, kTiny);
      const int j = k < 0 || k % 12 / 6 != side ? -1 : k % 6 + (k >= 12 ? 6 : 0);
      if (j >= 0 && j < 3) r.x[j] += h;
      if (j >= 3 && j < 6) {
        const Quat d = rate(o.e, Vec3(Vec3::Unit(j - 3)));
        r.e = {r.e.w + h * d.w, r.e.x + h * d.x, r.e.y + h * d.y, r.e.z + h * d.z};
      }
      if (j >= 6 && j < 9) r.v[j - 6] += h;
      if (j >= 9) r.w[j - 9] += h;
      r.A = rotation(r.e);
    }
    P = at(0, b.p), S = at(1, b.s);
  }
  At at(int side, const Marker& marker) const {
    const MarkerMotion m = MarkerFrame(marker).at(bench.t);
    const MotionT<C>& o = O[side];
    At r;
    r.q = o.e * QuatT<C>{m.q.w, m.q.x, m.q.y, m.q.z};
    r.A = o.A * m.A.cast<C>();
    r.x = o.x + o.A * m.u.cast<C>();
    r.v = o.v + o.A * (cross(o.w, Vec(m.u.cast<C>())) + m.ud.cast<C>());
    r.w = o.A * o.w + r.A * m.w.cast<C>();
    return r;
  }
  /// F at x and M on slot 0, the opposite on slot 1 at x_S.
  Wrench pair(const Vec& F, const Vec& x, const Vec& x_S, const Vec& M) const {
    Wrench r;
    r << F, O[0].A.transpose() * (cross(Vec(x - O[0].x), F) + M), -F,
        -(O[1].A.transpose() * (cross(Vec(x_S - O[1].x), F) + M));
    return r;
  }
};

Tangent by_hand(const Force& force, const ForceBench& bench) {
  TangentSum sum;
  sum.lay_out(2);
  force.tangent(bench.in(), sum);
  Tangent r = Tangent::Zero();
  for (std::size_t p = 0; p < sum.pairs().size(); ++p) {
    const int row = 6 * sum.pairs()[p].row, column = 6 * sum.pairs()[p].column;
    r.block<6, 6>(row, column) = sum.K(p);
    r.block<6, 6>(row, 12 + column) = sum.D(p);
  }
  return r;
}

/// The force's wrench is the formula's, and its tangent minus the formula's derivative.
template <class Formula>
void check(const Force& force, const ForceBench& bench, Formula formula) {
  const VecX f = bench.wrench(force);
  CHECK((f - formula(Moved(bench, -1)).real()).cwiseAbs().maxCoeff() <= 1e-12 * std::max(1.0, f.cwiseAbs().maxCoeff()));
  Tangent truth;
  for (int k = 0; k < 24; ++k) truth.col(k) = -formula(Moved(bench, k)).imag() / kTiny;
  CHECK(truth.cwiseAbs().maxCoeff() > 0.1);
  CHECK((by_hand(force, bench) - truth).cwiseAbs().maxCoeff() <= 1e-12 * std::max(1.0, truth.cwiseAbs().maxCoeff()));
}

/// Markers that move on their bodies.
ForceBench moving(std::uint64_t seed) {
  ForceBench bench(seed);
  bench.p.translation_law = std::make_shared<oracle::SineSlide>(Vec3(0.1, 0.3, -0.2));
  bench.p.rotation_law = std::make_shared<oracle::SteadySpin>(Vec3(0.4, -0.3, 0.9));
  bench.s.translation_law = std::make_shared<oracle::SineSlide>(Vec3(-0.2, 0.1, 0.1));
  bench.s.rotation_law = std::make_shared<oracle::SteadySpin>(Vec3(-0.5, 0.8, 0.2));
  bench.at(0.3);
  return bench;
}

}  // namespace

TEST_CASE("Tangent of the spring-damper", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    ForceBench bench = moving(seed);
    const double k = 30, c = 4, l0 = 0.7, T0 = 3;
    SpringDamper force("spring", bench.p, bench.s,
                       {k, c, l0, T0, oracle::value_law([](double t) { return 5 + 10 * t; })});
    force.setup();
    check(force, bench, [&](const Moved& m) {
      const Vec d = m.P.x - m.S.x;
      const C l = norm(d);
      const Vec n = d / l;
      const C T = k * (l - l0) + T0 + c * dot(n, m.P.v - m.S.v) + 5.0 + 10.0 * bench.t;
      return m.pair(-T * n, m.P.x, m.S.x, Vec::Zero());
    });
  }
}

TEST_CASE("Tangent of a spring of no free length where its ends meet", "[unit][force]") {
  ForceBench bench;
  bench.place(bench.p, {Vec3(0.3, 0.2, 0.1), {}});
  bench.place(bench.s, {Vec3(0.3, 0.2, 0.1), {}});
  SpringDamper force("spring", bench.p, bench.s, {.stiffness = 30});
  force.setup();
  bench.motions[1].x += in_world(MarkerFrame(bench.s), bench.in()).x - in_world(MarkerFrame(bench.p), bench.in()).x;
  const Tangent K = by_hand(force, bench);
  CHECK(K.allFinite());
  CHECK((K.block<3, 3>(0, 0) - 30 * Mat3::Identity()).cwiseAbs().maxCoeff() <= 1e-12);
}

TEST_CASE("Tangent of the torsion spring-damper", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    ForceBench bench = moving(seed);
    const double k = 3, c = 0.4, a0 = 0.7, T0 = 0.3;
    TorsionSpringDamper force("spring", bench.p, bench.s, {k, c, a0, T0, {}});
    force.setup();
    check(force, bench, [&](const Moved& m) {
      const QuatT<C> e = conjugate(m.S.q) * m.P.q;
      C angle = 2.0 * std::atan(e.z / e.w);
      angle -= kTwoPi * std::round(angle.real() / kTwoPi);
      const Vec zP = m.P.A.col(2), zS = m.S.A.col(2), g = (zP + zS) / (1.0 + dot(zP, zS));
      const C T = k * (angle - a0) + T0 + c * dot(g, m.P.w - m.S.w);
      return m.pair(Vec::Zero(), m.P.x, m.S.x, -T * g);
    });
  }
}

TEST_CASE("Tangent of the bushing, small rotations and large", "[unit][force]") {
  const Vec3 K(40, 20, 10), D(3, 2, 1), Kt(5, 4, 2), Dt(0.3, 0.5, 0.2);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    ForceBench bench = moving(seed);
    Bushing force("bushing", bench.p, bench.s, {K, D, Kt, Dt});
    force.setup();
    if (seed > 4) {  // nearly aligned
      const MarkerMotion P = MarkerFrame(bench.p).at(bench.t), S = MarkerFrame(bench.s).at(bench.t);
      const Vec3 small = 0.1 * std::pow(0.1, static_cast<double>(seed - 5)) * Vec3(1, -2, 3);
      Motion& O = bench.motions[1];
      O.e = bench.motions[2].e * S.q * exponential(small) * conjugate(P.q);
      O.A = rotation(O.e);
    }
    check(force, bench, [&](const Moved& m) {
      const Mat At = m.S.A.transpose();
      const Vec d = At * (m.P.x - m.S.x);
      const Vec dd = At * (m.P.v - m.S.v) - cross(Vec(At * m.S.w), d), w = At * (m.P.w - m.S.w);
      QuatT<C> e = conjugate(m.S.q) * m.P.q;
      if (e.w.real() < 0) e = -e;
      const C n = norm(e.vec()), a = 2.0 * std::atan(n / e.w);
      const Vec th = a / n * e.vec();
      const C c = std::abs(a) < 0.3
                      ? 1.0 / 12 + a * a / 720.0 + a * a * a * a / 30240.0 + a * a * a * a * a * a / 1209600.0 +
                            std::pow(a, 8) / 47900160.0 + 691.0 * std::pow(a, 10) / 1307674368000.0
                      : (1.0 - 0.5 * a / std::tan(0.5 * a)) / (a * a);
      const Vec b = Kt.cast<C>().cwiseProduct(th), thb = cross(th, b);
      const Vec F = -(K.cast<C>().cwiseProduct(d) + D.cast<C>().cwiseProduct(dd));
      const Vec M = -(b + 0.5 * thb + c * cross(th, thb) + Dt.cast<C>().cwiseProduct(w));
      return m.pair(m.S.A * F, m.P.x, m.P.x, m.S.A * M);
    });
  }
}

TEST_CASE("Tangents of applied forces and torques in all axes", "[unit][force]") {
  const Vec3 value(3, -4, 5);
  for (const AppliedAxes axes : {AppliedAxes::world, AppliedAxes::body, AppliedAxes::marker}) {
    ForceBench bench = moving(2);
    AppliedForce force("force", bench.p, bench.s, {.force = value, .axes = axes});
    AppliedTorque torque("torque", bench.p, bench.s, {.torque = value, .axes = axes});
    force.setup(), torque.setup();
    const Mat3 body = rotation(bench.a.in_slot.q);
    const auto turned = [&](const Moved& m) -> Vec {
      if (axes == AppliedAxes::body) return m.O[0].A * body.cast<C>() * value.cast<C>();
      if (axes == AppliedAxes::marker) return m.P.A * value.cast<C>();
      return value.cast<C>();
    };
    check(force, bench, [&](const Moved& m) { return m.pair(turned(m), m.P.x, m.P.x, Vec::Zero()); });
    check(torque, bench, [&](const Moved& m) { return m.pair(Vec::Zero(), m.P.x, m.S.x, turned(m)); });
  }
}

TEST_CASE("A force without S has a tangent on its own body alone", "[unit][force]") {
  ForceBench bench = moving(2);
  AppliedForce force("force", bench.p, {.force = Vec3(3, -4, 5)});
  force.setup();
  TangentSum sum;
  sum.lay_out(2);
  force.tangent(bench.in(), sum);
  REQUIRE(sum.pairs().size() == 1);
  const MarkerMotion P = MarkerFrame(bench.p).at(bench.t);
  const Vec3 f = bench.motions[1].A.transpose() * Vec3(3, -4, 5);  // (9.14) p~ (A^T f)~
  Mat6 K = Mat6::Zero();
  K.block<3, 3>(3, 3) = -skew(P.u) * skew(f);
  CHECK((sum.K(0) - K).cwiseAbs().maxCoeff() <= 1e-13);
  CHECK(sum.D(0).isZero(0));
}

TEST_CASE("Tangents of the motors", "[unit][force]") {
  ForceBench bench = moving(3);
  const auto law = oracle::value_law([](double t) { return 5 + 10 * t; });
  ForceMotor force("force", bench.p, bench.s, {law});
  TorqueMotor torque("torque", bench.p, bench.s, {law});
  force.setup(), torque.setup();
  check(force, bench,
        [&](const Moved& m) { return m.pair(C(5 + 10 * m.bench.t) * m.S.A.col(2), m.P.x, m.P.x, Vec::Zero()); });
  check(torque, bench,
        [&](const Moved& m) { return m.pair(Vec::Zero(), m.P.x, m.S.x, C(5 + 10 * m.bench.t) * m.S.A.col(2)); });
}

TEST_CASE("A function of the user's is differenced", "[unit][force]") {
  ForceBench bench = moving(4);
  SpringDamper spring("spring", bench.p, bench.s, {.stiffness = 30, .damping = 4, .free_length = 0.7});
  spring.setup();
  const auto same =
      function_force("same", {&bench.p, &bench.s}, [&](const Inputs& in, WrenchSum& out) { spring.apply(in, out); });
  same->setup();
  same->place(0);
  const Tangent exact = by_hand(spring, bench);
  CHECK((by_hand(*same, bench) - exact).cwiseAbs().maxCoeff() <= 1e-8 * exact.cwiseAbs().maxCoeff());
  CHECK((by_hand(*same, bench) - exact).cwiseAbs().maxCoeff() > 0);
}

}  // namespace force_tangent_test
