// The derivatives of a link against differences: jacobian, Ct, Qhat, tangent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/tools/check/lock_check.h"

namespace lockstep {

bool LockCheck::compare(double is, double should_be, double error, double size) {
  report_.compared(error / std::max(size, std::abs(should_be)));
  return std::abs(is - should_be) <= error + 1e-11 * size;
}

// dC/d(x, turn), column by column.
void LockCheck::jacobian() {
  const auto C = [&](const TestState& at, VecX& out) { out = bench_.rows(at).C(); };
  for (int slot = 0; slot < n_; ++slot) {
    MatX should_be = MatX::Zero(m_, 6), error = should_be;
    for (int j = 0; j < n_freedoms(slot); ++j) {
      const Slope d = derivative(slot, j, C);
      should_be.col(j) = d.value, error.col(j) = d.error;
    }
    for (int k = 0; k < m_; ++k) {
      if (link_.slots().position(slot) < 0) {
        if ((should_be.row(k).cwiseAbs() - error.row(k)).maxCoeff() > 1e-9)
          add(fmt::format("column {}", slot),
              fmt::format("{} depends on body '{}', which is not among slots() {}", row(k), body(slot), here()),
              "slots(), which setup() fills");
        continue;
      }
      const auto is = rows_.J.block<1, 6>(k, 6 * slot);
      const double size = std::max(rows_.J.row(k).cwiseAbs().maxCoeff(), should_be.row(k).cwiseAbs().maxCoeff());
      for (int j = 0; j < n_freedoms(slot); ++j) {
        if (compare(is[j], should_be(k, j), error(k, j), size)) continue;
        const bool turn = j >= 3;
        add(fmt::format("J {} {} {}", k, slot, turn),
            fmt::format("jacobian of {} with respect to {} is {:.6g}, differences say {:.6g}{} {}", row(k),
                        unknown_name(slot, j + 6), is[j], should_be(k, j), likeness(is[j], should_be(k, j)), here()),
            jacobian_hint(k, slot, turn, should_be.row(k).segment<3>(turn ? 3 : 0)), std::abs(is[j] - should_be(k, j)));
      }
      if (link_.row_kind(k) == RowKind::rotation && should_be.row(k).head<3>().norm() > 1e-6 * size)
        add("kind", fmt::format("{} is of the kind rotation, but moves of body '{}' change it", row(k), body(slot)),
            "plan_rows(): RowKind::translation for metres, RowKind::function for anything else");
    }
  }
}

std::string LockCheck::jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const {
  const Vec3 is = rows_.J.block<1, 3>(k, 6 * slot + (turn ? 3 : 0)).transpose();
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

// Ct = dC/dt with the bodies held; the link's own states go on.
void LockCheck::time_derivative() {
  TestState held = state_;
  held.stop();
  const auto C = [&](double x, VecX& out) {
    TestState on = held;
    on.t += x;
    bench_.move_states(held, on);
    out = bench_.rows(on).C();
  };
  const Slope d = first_derivative(C, quiet_);
  for (int k = 0; k < m_; ++k) {
    const double is = rows_.parts(k, 1), should_be = d.value[k];
    if (compare(is, should_be, d.error[k], std::max({std::abs(is), std::abs(should_be), std::abs(rows_.C()[k])})))
      continue;
    add(fmt::format("Ct {}", k),
        fmt::format("{} is {:.6g}, differences in time with the bodies held say {:.6g}{} {}", part(1, k), is, should_be,
                    likeness(is, should_be), here()),
        "Ct in gather(): the rate of C by its laws alone, the markers' own motion included, with the sign that the law "
        "has in C",
        std::abs(is - should_be));
  }
}

// Qhat = Jh a - Cdd (4.14), so without accelerations it is -Cdd.
Slope LockCheck::minus_Cdd(const TestState& from) {
  const auto C = [&](double x, VecX& out) {
    TestState on = coasted(from, x);
    bench_.move_states(from, on);
    out = bench_.rows(on).C();
  };
  Slope d = second_derivative(C, std::min(0.05, quiet_));
  d.value = -d.value;
  return d;
}

void LockCheck::right_side() {
  const Slope d = minus_Cdd(state_);
  for (int k = 0; k < m_; ++k) {
    const double is = rows_.parts(k, 2), should_be = d.value[k];
    if (compare(is, should_be, d.error[k], std::max(std::abs(is), std::abs(should_be)))) continue;
    add(fmt::format("Qhat {}", k),
        fmt::format("{} is {:.6g}, second differences of C along a motion say {:.6g}{}{} {}", part(2, k), is, should_be,
                    likeness(is, should_be), diagnose_right_side(k), here()),
        "Qhat = -(dJh/dt v + dCt/dt) in gather(), its part that is named here", std::abs(is - should_be));
  }
}

// Which term of Qhat is wrong: constant, linear or quadratic in one velocity, or a product of two velocities.
std::string LockCheck::diagnose_right_side(int k) {
  struct Velocity {
    int slot;
    bool turn;
  };
  struct Term {
    double is, should_be, error;
    Term operator+(const Term& o) const { return {is + o.is, should_be + o.should_be, error + o.error}; }
    Term operator-(const Term& o) const { return {is - o.is, should_be - o.should_be, error + o.error}; }
    Term half() const { return {0.5 * is, 0.5 * should_be, error}; }
    bool wrong() const { return std::abs(is - should_be) > error + 1e-9 * std::max(std::abs(is), std::abs(should_be)); }
  };
  std::vector<Velocity> velocities;
  for (const int slot : slots_) velocities.push_back({slot, false}), velocities.push_back({slot, true});
  const auto name = [&](const Velocity& g) {
    return fmt::format("the {}velocity of body '{}'", g.turn ? "angular " : "", body(g.slot));
  };
  const auto with = [&](std::initializer_list<std::pair<Velocity, double>> moving) {
    TestState on = state_;
    on.stop();
    for (const auto& [g, sign] : moving) {
      const Motion& was = state_.slot(g.slot);
      (g.turn ? on.slot(g.slot).w : on.slot(g.slot).v) = sign * (g.turn ? was.w : was.v);
    }
    const double is = bench_.rows(on).parts(k, 2);
    const Slope d = minus_Cdd(on);
    return Term{is, d.value[k], d.error[k]};
  };
  const auto text = [](const std::string& part, const Term& v) {
    return fmt::format("; {} is {:.6g} and should be {:.6g}{}", part, v.is, v.should_be, likeness(v.is, v.should_be));
  };
  const Term rest = with({});
  if (rest.wrong()) return text("its part with all bodies at rest, the second time derivative of the laws,", rest);
  for (const Velocity& g : velocities) {
    const Term plus = with({{g, 1}}), minus = with({{g, -1}});
    if (const Term even = (plus + minus).half() - rest; even.wrong())
      return text("its part that is quadratic in " + name(g), even);
    if (const Term odd = (plus - minus).half(); odd.wrong())
      return text("its part that is the product of " + name(g) + " and the rate of a law", odd);
  }
  for (auto b = velocities.begin(); b != velocities.end(); ++b)
    for (auto a = velocities.begin(); a != b; ++a) {
      const Term both = with({{*a, 1}, {*b, 1}}) - with({{*a, 1}}) - with({{*b, 1}}) + rest;
      if (both.wrong()) return text("its part that is the product of " + name(*a) + " and " + name(*b), both);
    }
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
  check_tangent(sum, false, slots_,
                [&](const TestState& at, VecX& out) { out = bench_.rows(at).J.transpose() * lambda; },
                rows_.J.cwiseAbs().maxCoeff(),
                {"the change", "Jh^T lambda",
                 "tangent(); leave it out, and the library differences gather() for implicit methods"});
}

}  // namespace lockstep
