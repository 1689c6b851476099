// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/system_of.h"
#include "framework/tools/sweep/step_limit.h"

#include <cmath>
#include <complex>
#include <limits>
#include <span>

#include <Eigen/Eigenvalues>

#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using Eigenvalues = Eigen::VectorXcd;

constexpr double kGrows = 1.01;  // a step: more than what differences and double zeros make of 1

Eigenvalues rates_of(const SmallMotions& s) {
  const Eigen::Index n = s.A.rows();
  MatX M = MatX::Zero(2 * n, 2 * n);
  M.topRightCorner(n, n).setIdentity();
  M.bottomLeftCorner(n, n) = s.A, M.bottomRightCorner(n, n) = s.B;
  return M.eigenvalues();
}

// R(z) of a Runge-Kutta method, its coefficients from z^0 on.
Complex polynomial(std::span<const double> c, Complex z) {
  Complex sum = 0;
  for (std::size_t k = c.size(); k-- > 0;) sum = sum * z + c[k];
  return sum;
}

// Growth in a step, of motions that do not grow themselves.
double growth_of_runge_kutta(std::span<const double> c, const Eigenvalues& rates, double h) {
  double most = 0;
  for (const Complex rate : rates)
    if (rate.real() <= 0.05 * std::abs(rate)) most = std::max(most, std::abs(polynomial(c, h * rate)));
  return most;
}

// v += h (A x + B v), x += h v
double growth_of_semi_implicit_euler(const SmallMotions& s, double h) {
  const Eigen::Index n = s.A.rows();
  MatX M = MatX::Identity(2 * n, 2 * n);
  M.bottomLeftCorner(n, n) = h * s.A, M.bottomRightCorner(n, n) += h * s.B;
  M.topLeftCorner(n, n) += h * M.bottomLeftCorner(n, n), M.topRightCorner(n, n) = h * M.bottomRightCorner(n, n);
  return M.eigenvalues().cwiseAbs().maxCoeff();
}

// v += h/2 A x, x += h v, v += h/2 A x
double growth_of_rattle2(const SmallMotions& s, double h) {
  const Eigen::Index n = s.A.rows();
  MatX kick = MatX::Identity(2 * n, 2 * n), drift = kick;
  kick.bottomLeftCorner(n, n) = 0.5 * h * s.A;
  drift.topRightCorner(n, n) = h * MatX::Identity(n, n);
  return MatX(kick * drift * kick).eigenvalues().cwiseAbs().maxCoeff();
}

bool is_on(const MethodSpec& method, const char* key) {
  const Value* value = method.keys.find(key);
  return value != nullptr && value->boolean() != nullptr && *value->boolean();
}

}  // namespace

SmallMotions small_motions(const Scene& scene, const Registry& registry) {
  Mechanism m = build_mechanism(in_space(scene), registry);
  Stabilization stabilization = m.run.stabilization;
  if (stabilization.kind == Stabilization::Kind::project) stabilization.kind = Stabilization::Kind::none;
  Dynamics dynamics(system_of(m), make_solver(m.run, registry), {Formulation::omega, stabilization});
  State start = assembled_start(dynamics, m);
  dynamics.to_slots(start);
  const Eigen::Index n = 6 * m.system.n_slots();
  const double length = m.system.length();
  SmallMotions s{MatX::Zero(n, n), MatX::Zero(n, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double eps = 1e-6 * (i % 6 < 3 ? length : 1.0);
    const auto moved = [&](double by) {
      State at = start;
      VecX along = VecX::Zero(n);
      along[i] = 1;
      dynamics.advance(at, by, along);
      return VecX(dynamics.evaluate(at).a);
    };
    const auto pushed = [&](double by) {
      State at = start;
      at.v[i] += by;
      return VecX(dynamics.evaluate(at).a);
    };
    s.A.col(i) = (moved(eps) - moved(-eps)) / (2 * eps);
    s.B.col(i) = (pushed(eps) - pushed(-eps)) / (2 * eps);
  }
  return s;
}

double step_limit(const MethodSpec& method, const SmallMotions& s, double low, double high) {
  constexpr double kRk4[] = {1, 1, 1. / 2, 1. / 6, 1. / 24};
  constexpr double kDopri5[] = {1, 1, 1. / 2, 1. / 6, 1. / 24, 1. / 120, 1. / 600};
  constexpr int kScan = 100, kBisections = 30;
  std::function<double(double)> growth;
  const Eigenvalues rates = rates_of(s);
  if (method.type == "rk4") growth = [&](double h) { return growth_of_runge_kutta(kRk4, rates, h); };
  if (method.type == "dopri5" && is_on(method, "fixed"))
    growth = [&](double h) { return growth_of_runge_kutta(kDopri5, rates, h); };
  if (method.type == "semi_implicit_euler") growth = [&](double h) { return growth_of_semi_implicit_euler(s, h); };
  if (method.type == "rattle2") growth = [&](double h) { return growth_of_rattle2(s, h); };
  if (!growth) return std::numeric_limits<double>::quiet_NaN();
  double own = 0;  // growth of the motions themselves
  for (const Complex rate : rates) own = std::max(own, rate.real());
  const auto grows = [&](double h) {
    return growth(h) > kGrows * std::exp(2 * h * own);
  };  // twice: an explicit step overshoots
  double before = low;
  for (int k = 0; k <= kScan; ++k) {
    double h = low * std::pow(high / low, static_cast<double>(k) / kScan);
    if (!grows(h)) {
      before = h;
      continue;
    }
    for (int i = 0; i < kBisections && k > 0; ++i) {
      const double middle = std::sqrt(before * h);
      (grows(middle) ? h : before) = middle;
    }
    return h;
  }
  return HUGE_VAL;
}

}  // namespace lockstep
