// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of a link against differences: jacobian, Ct, Qhat, tangent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/tools/check/lock_check.h"

namespace lockstep {

// dC/d(x, turn), column by column.
void LockCheck::jacobian() {
  const auto C = [&](const TestState& at) -> VecX { return numbers(at).col(0); };
  const VecX size = is_.rightCols(6 * n_).cwiseAbs().rowwise().maxCoeff();
  for (int slot = 0; slot < n_; ++slot) {
    std::vector<Slope> columns;
    for (int j = 0; j < n_freedoms(slot); ++j) columns.push_back(derivative(state_, slot, j, C));
    for (int j = 0; j < n_freedoms(slot); ++j)
      compare(
          report_,
          {fmt::format("J {} {}", slot, j / 3), is_.col(3 + 6 * slot + j), size,
           [&](int k) { return fmt::format("jacobian of {} with respect to {}", row(k), unknown_name(slot, j + 6)); },
           "differences say", here(),
           [&](int k) {
             const auto of = columns.begin() + j / 3 * 3;
             return jacobian_hint(k, slot, j >= 3, {of[0].value[k], of[1].value[k], of[2].value[k]});
           }},
          columns[j]);
    for (int k = 0; k < m_; ++k)
      if (link_.row_kind(k) == RowKind::rotation && J(k, slot).head<3>().norm() > kSlight * size[k])
        add("kind", fmt::format("{} is of the kind rotation, but moves of body '{}' change it", row(k), body(slot)),
            "plan_rows(): RowKind::translation for metres, RowKind::function for anything else");
  }
}

std::string LockCheck::jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const {
  if (link_.slots().position(slot) < 0)
    return fmt::format("slots(), which setup() fills: {} depends on body '{}', which is not among slots()", row(k),
                       body(slot));
  const Vec3 is = J(k, slot).segment<3>(turn ? 3 : 0).transpose();
  const Mat3& A = state_.slot(slot).A;
  const double near = 1e-5 * should_be.norm();
  if (turn && (is - A * should_be).norm() <= near)
    return "the axes: its three numbers are right in world axes, and the angular velocity is in the body's own";
  if (!turn && (is - A.transpose() * should_be).norm() <= near)
    return "the axes: its three numbers are right in body axes, and the velocity is in the world's";
  if (is.isZero(0)) return fmt::format("set() for body '{}' in gather(), which gives it nothing", body(slot));
  return fmt::format("the {} vector of set() for body '{}' in gather(), in {} axes", turn ? "second" : "first",
                     body(slot), turn ? "its own" : "world");
}

// Ct = dC/dt with the bodies held; the link's own states go on. Qhat = Jh a - Cdd (4.14), so without accelerations it
// is -Cdd.
void LockCheck::time_derivatives() {
  TestState held = state_;
  held.stop();
  compare(report_,
          {"Ct", is_.col(1), is_.col(0).cwiseAbs(), [&](int k) { return name(k, 1); },
           "differences in time with the bodies held say", here(),
           [](int) {
             return "Ct in gather(): the rate of C by its laws alone, the markers' own motion included, with the sign "
                    "that the law has in C";
           }},
          first_derivative(C_along(system_, link_, held, 1), quiet_));
  compare(report_,
          {"Qhat", is_.col(2), VecX::Zero(m_), [&](int k) { return name(k, 2); },
           "second differences of C along a motion say", here(),
           [&](int k) { return "Qhat = -(dJh/dt v + dCt/dt) in gather()" + diagnose_right_side(k); }},
          minus_Cdd(state_));
}

Slope LockCheck::minus_Cdd(const TestState& from) const {
  return second_derivative(C_along(system_, link_, from, -1), std::min(0.05, quiet_));
}

// Which term of Qhat is wrong: constant, linear or quadratic in one velocity, or a product of two velocities.
std::string LockCheck::diagnose_right_side(int k) {
  const auto n = static_cast<int>(2 * slots_.size());  // velocities: v and w of each slot
  const auto velocity = [&](int g) {
    return fmt::format("the {}velocity of body '{}'", g % 2 == 0 ? "" : "angular ", body(slots_[g / 2]));
  };
  std::string found;
  // A part of Qhat as a sum over motions, each with a weight and the velocities by factors.
  const auto wrong = [&](const std::string& part, std::initializer_list<std::pair<double, VecX>> sum) {
    double is = 0, should_be = 0, error = 0;
    for (const auto& [weight, moving] : sum) {
      TestState on = state_;
      on.stop();
      for (int g = 0; g < n; g += 2) {
        const Motion& O = state_.slot(slots_[g / 2]);
        on.slot(slots_[g / 2]).v = moving[g] * O.v, on.slot(slots_[g / 2]).w = moving[g + 1] * O.w;
      }
      const Slope d = minus_Cdd(on);
      is += weight * numbers(on)(k, 2), should_be += weight * d.value[k], error += std::abs(weight) * d.error[k];
    }
    if (std::abs(is - should_be) <= error + kRounding * std::max(std::abs(is), std::abs(should_be))) return false;
    found = fmt::format("; its part {} is {:.6g} and should be {:.6g}{}", part, is, should_be, likeness(is, should_be));
    return true;
  };
  const VecX rest = VecX::Zero(n);
  const MatX one = MatX::Identity(n, n);
  if (wrong("with all bodies at rest, the second time derivative of the laws,", {{1, rest}})) return found;
  for (int g = 0; g < n; ++g) {
    const VecX on = one.col(g);
    if (wrong("that is quadratic in " + velocity(g), {{0.5, on}, {0.5, -on}, {-1, rest}}) ||
        wrong("that is the product of " + velocity(g) + " and the rate of a law", {{0.5, on}, {-0.5, -on}}))
      return found;
  }
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < b; ++a)
      if (wrong("that is the product of " + velocity(a) + " and " + velocity(b),
                {{1, one.col(a) + one.col(b)}, {-1, one.col(a)}, {-1, one.col(b)}, {1, rest}}))
        return found;
  return "";
}

// K = d(Jh^T lambda)/d(x, turn), (9.4).
void LockCheck::tangent() {
  Draw draw(options_.seed + 1000 + static_cast<std::uint64_t>(index_));
  VecX lambda(m_);
  for (double& x : lambda) x = draw.number(-1, 1);
  TangentSum sum;
  sum.lay_out(n_);
  add_tangent(link_, state_.in(), {lambda.data(), static_cast<std::size_t>(m_)}, sum);
  const auto pull = [&](const TestState& at) -> VecX { return numbers(at).rightCols(6 * n_).transpose() * lambda; };
  check_tangent(sum, false, pull, is_.rightCols(6 * n_).cwiseAbs().maxCoeff());
}

}  // namespace lockstep
