// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/lock/stiffness.h"

#include <complex>

#include <lockstep/author/phi_links.h>
#include <lockstep/author/relative.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/lock_inputs.h"

namespace geometric_stiffness_test {

// Oracle: the rows' own code on complex numbers. With x + i h dx and q + i h (1/2) q dth the imaginary part of
// Jh^T lambda is h K d, exactly for a small enough h (theory, (9.6)).
using namespace lockstep;

namespace {

using C = std::complex<double>;
using Mat12 = Eigen::Matrix<double, 12, 12>;
constexpr double kTiny = 1e-40;

MotionT<C> stepped(const Motion& O, int k) {
  MotionT<C> r;
  r.x = O.x.cast<C>(), r.v = O.v.cast<C>(), r.w = O.w.cast<C>();
  r.e = {O.e.w, O.e.x, O.e.y, O.e.z};
  const C h(0, kTiny);
  if (k >= 0 && k < 3) r.x[k] += h;
  if (k >= 3) {
    const Quat d = rate(O.e, Vec3(Vec3::Unit(k - 3)));
    r.e = {r.e.w + h * d.w, r.e.x + h * d.x, r.e.y + h * d.y, r.e.z + h * d.z};
  }
  r.A = rotation(r.e);
  return r;
}
MarkerMotionT<C> complex_of(const MarkerMotion& m) {
  MarkerMotionT<C> r;
  r.u = m.u.cast<C>(), r.ud = m.ud.cast<C>(), r.udd = m.udd.cast<C>(), r.A = m.A.cast<C>();
  r.q = {m.q.w, m.q.x, m.q.y, m.q.z};
  r.w = m.w.cast<C>(), r.a = m.a.cast<C>();
  return r;
}

/// Columns of K from `force`: (O1, O2) on complex numbers -> Jh^T lambda, 12 numbers.
template <class Force>
Mat12 stiffness_by_complex_step(const Motion& O1, const Motion& O2, Force force) {
  Mat12 K;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Matrix<C, 12, 1> F = force(stepped(O1, k < 6 ? k : -1), stepped(O2, k < 6 ? -1 : k - 6));
    K.col(k) = F.imag() / kTiny;
  }
  return K;
}

Mat12 matrix_of(const TangentSum& sum) {
  Mat12 K = Mat12::Zero();
  for (std::size_t p = 0; p < sum.pairs().size(); ++p) {
    CHECK(sum.D(p).isZero(0));
    K.block<6, 6>(6 * sum.pairs()[p].row, 6 * sum.pairs()[p].column) = sum.K(p);
  }
  return K;
}

double largest(const Mat12& x) { return x.cwiseAbs().maxCoeff(); }

/// A function of everything, without meaning.
struct Everything {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::exp, std::sqrt;
    return y.x * y.y * y.e1 + exp(0.3 * y.z) * y.e0 * y.e2 + sqrt(2.0 + y.e3) * y.x * y.x - y.t * y.y;
  }
};
class EverythingLock final : public PhiLock<Everything> {
 public:
  using PhiLock::PhiLock;
  std::string_view type() const override { return "everything"; }
};

/// phi_y Jh_y, complex, times its multiplier.
template <class Phi>
Eigen::Matrix<C, 12, 1> function_force(const Phi& phi, double lambda, double t, const MotionT<C>& O1,
                                       const MotionT<C>& O2, const MarkerMotion& P, const MarkerMotion& S) {
  const RelativeKinematicsT<C> L = relative_kinematics<C>(O1, O2, complex_of(P), complex_of(S), 1u);
  using J = Jet<7, C>;
  const auto v = [&](int k) { return J::variable(k, L.y[k], C(0)); };
  LockCoords<J> y{v(0), v(1), v(2), v(3), v(4), v(5), v(6), J(t)};
  const Eigen::Matrix<C, 7, 1> g = lambda * phi(y).g;
  Eigen::Matrix<C, 12, 1> F;
  F << L.Jv1.transpose() * g, L.Jw1.transpose() * g, -(L.Jv1.transpose() * g), L.Jw2.transpose() * g;
  return F;
}

}  // namespace

TEST_CASE("The stiffness of a lock is the derivative of its constraints, all laws active, constraints violated",
          "[unit][lock]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const unsigned laws : {0u, unsigned(oracle::kAllLaws)}) {
      CAPTURE(seed, laws);
      const oracle::Configuration c = oracle::random_configuration(seed, {laws});
      inputs::TwoBodies two(c, laws);
      GenericLock& lock = two.lock(c, Mask::all, laws);
      const std::vector<double> lambda{1.1, -2.0, 0.6, 0.9, -1.4, 2.2};
      Dynamics dynamics(two.system, std::make_unique<DenseSolver>());
      const Evaluation& here = dynamics.gather(two.system.start());
      TangentSum sum;
      sum.lay_out(2);
      add_tangent(lock, here.inputs(), lambda, sum);

      const inputs::KernelInputs k(c);
      const Mat12 K = stiffness_by_complex_step(k.O1, k.O2, [&](const MotionT<C>& O1, const MotionT<C>& O2) {
        constexpr unsigned kAll = with::all_laws;
        TranslationRowsT<C> t;
        RotationRowsT<C> r;
        ImposedTranslationT<C> p;
        p.p = k.p.p.cast<C>();
        ImposedRotationT<C> D;
        D.q = {k.D.q.w, k.D.q.x, k.D.q.y, k.D.q.z}, D.A = k.D.A.cast<C>();
        translation<kAll>(O1, O2, complex_of(k.P), complex_of(k.S), p, Mask::xyz, t);
        rotation<kAll>(O1, O2, complex_of(k.P), complex_of(k.S), D, Mask::e123, r);
        const Vec3T<C> lt(lambda[0], lambda[1], lambda[2]), lr(lambda[3], lambda[4], lambda[5]);
        Eigen::Matrix<C, 12, 1> F;
        F << t.Jv.transpose() * lt, t.Jw1.transpose() * lt + r.Jw1.transpose() * lr, -(t.Jv.transpose() * lt),
            t.Jw2.transpose() * lt + r.Jw2.transpose() * lr;
        return F;
      });
      CHECK(largest(matrix_of(sum) - K) <= 1e-13 * largest(K));
    }
}

TEST_CASE("A lock's stiffness leaves out what the mask leaves out, and the ground", "[unit][lock]") {
  const oracle::Configuration c = oracle::random_configuration(3, {0});
  inputs::TwoBodies two(c, 0), grounded(c, 0, 2);
  const Lock& lock = two.lock(c, Mask::x | Mask::e2, 0);
  const Lock& to_ground = grounded.lock(c, Mask::x | Mask::e2, 0);
  Dynamics dynamics(two.system, std::make_unique<DenseSolver>()), one(grounded.system, std::make_unique<DenseSolver>());
  const Evaluation &here = dynamics.gather(two.system.start()), &there = one.gather(grounded.system.start());
  TangentSum some, all, ground;
  some.lay_out(2), all.lay_out(2), ground.lay_out(1);
  const std::vector<double> lambda{1.5, -0.7};
  add_tangent(lock, here.inputs(), lambda, some);
  const MarkerMotion P = MarkerFrame(*two.P).at(0), S = MarkerFrame(*two.S).at(0);
  add_translation_stiffness(here.inputs(), 0, 1, P, S, Vec3(1.5, 0, 0), all);
  add_rotation_stiffness(here.inputs(), 0, 1, P, S, Quat{}, Quat{0, 0, -0.7, 0}, all);
  CHECK(largest(matrix_of(some) - matrix_of(all)) <= 1e-14);
  add_tangent(to_ground, there.inputs(), lambda, ground);
  REQUIRE(ground.pairs().size() == 1);
  CHECK((ground.K(0) - matrix_of(all).topLeftCorner<6, 6>()).cwiseAbs().maxCoeff() <= 1e-14);
}

TEST_CASE("The stiffness of a function joint is the derivative of its constraint", "[unit][lock]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    constexpr unsigned kMarkers = oracle::kUP | oracle::kQP | oracle::kUS | oracle::kQS;
    const oracle::Configuration c = oracle::random_configuration(seed, {kMarkers});
    inputs::TwoBodies two(c, kMarkers);
    const Lock& any = two.system.add(std::make_unique<EverythingLock>("any", *two.P, *two.S, Mask::none, Everything{}));
    const Distance& rod = two.system.add<Distance>("rod", *two.P, *two.S, 0.8);
    Dynamics dynamics(two.system, std::make_unique<DenseSolver>());
    const Evaluation& here = dynamics.gather(two.system.start());
    const inputs::KernelInputs k(c);
    const double lambda = -1.7;
    for (const Lock* lock : {&any, static_cast<const Lock*>(&rod)}) {
      TangentSum sum;
      sum.lay_out(2);
      add_tangent(*lock, here.inputs(), {&lambda, 1}, sum);
      const Mat12 K = stiffness_by_complex_step(k.O1, k.O2, [&](const MotionT<C>& O1, const MotionT<C>& O2) {
        if (lock == &any) return function_force(Everything{}, lambda, 0, O1, O2, k.P, k.S);
        const auto length = [](const auto& y) { return sqrt(y.x * y.x + y.y * y.y + y.z * y.z); };
        return function_force(length, lambda, 0, O1, O2, k.P, k.S);
      });
      CHECK(largest(matrix_of(sum) - K) <= 1e-13 * std::max(1.0, largest(K)));
    }
  }
}

TEST_CASE("K less the half moments is symmetric", "[unit][lock]") {
  // (9.4) K = K_sym + (1/2) diag(0, F_th1~, 0, F_th2~)
  const oracle::Configuration c = oracle::random_configuration(9);
  inputs::TwoBodies two(c, oracle::kAllLaws);
  const Lock& lock = two.lock(c, Mask::all, oracle::kAllLaws);
  Dynamics dynamics(two.system, std::make_unique<DenseSolver>());
  const Evaluation& here = dynamics.gather(two.system.start());
  const std::vector<double> lambda{1.1, -2.0, 0.6, 0.9, -1.4, 2.2};
  TangentSum sum;
  sum.lay_out(2);
  add_tangent(lock, here.inputs(), lambda, sum);
  const MatX J = inputs::gathered(two.system, two.system.start()).J;
  const VecX F = J.transpose() * Eigen::Map<const VecX>(lambda.data(), 6);
  Mat12 K = matrix_of(sum);
  K.block<3, 3>(3, 3) -= 0.5 * skew(Vec3(F.segment<3>(3)));
  K.block<3, 3>(9, 9) -= 0.5 * skew(Vec3(F.segment<3>(9)));
  CHECK(largest(K - K.transpose()) <= 1e-14 * largest(K));
}

}  // namespace geometric_stiffness_test
