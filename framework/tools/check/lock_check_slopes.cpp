// The derivatives of a link against differences: jacobian, Ct, Qhat, tangent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/check/lock_check.h"

namespace lockstep {
namespace {

constexpr double kTurnReach = 0.1;   // rad, of differences
constexpr double kMoveReach = 0.05;  // of the length

}  // namespace

bool LockCheck::compare(double is, double should_be, double error, double size) {
  report_.compared(error / std::max(size, std::abs(should_be)));
  return std::abs(is - should_be) <= error + 1e-11 * size;
}

// dC/d(x, turn), column by column.
void LockCheck::jacobian() {
  LockRows r;
  for (int slot = 0; slot < n_; ++slot) {
    const bool particle = system_.slot(slot).freedoms == Freedoms::particle;
    Eigen::Matrix<double, Eigen::Dynamic, 6> should_be(m_, 6), error(m_, 6);
    should_be.setZero(), error.setZero();
    for (int j = 0; j < (particle ? 3 : 6); ++j) {
      Place on = place_;
      const Slope d = first_derivative(
          [&](double x, VecX& out) {
            on.slot(slot) = Differences::moved(place_.slot(slot), j, x);
            bench_.rows(on, r);
            out = r.C;
          },
          j < 3 ? kMoveReach * length_ : kTurnReach);
      should_be.col(j) = d.value, error.col(j) = d.error;
    }
    for (int k = 0; k < m_; ++k) {
      const auto is = rows_.J.block<1, 6>(k, 6 * slot);
      if (link_.slots().position(slot) < 0) {  // columns that the link does not have
        if ((should_be.row(k).cwiseAbs() - error.row(k)).maxCoeff() > 1e-9)
          add(fmt::format("column {}", slot),
              fmt::format("{} depends on body '{}', which is not among slots() {}", row(k),
                          system_.body_of_slot(slot).name, here()),
              "slots(), which setup() fills");
        continue;
      }
      const double size = std::max(rows_.J.row(k).cwiseAbs().maxCoeff(), should_be.row(k).cwiseAbs().maxCoeff());
      for (int j = 0; j < (particle ? 3 : 6); ++j) {
        if (compare(is[j], should_be(k, j), error(k, j), size)) continue;
        const bool turn = j >= 3;
        add(fmt::format("J {} {} {}", k, slot, turn),
            fmt::format("jacobian of {} with respect to {} is {:.6g}, differences say {:.6g}{} {}", row(k),
                        velocity_name(system_, slot, j), is[j], should_be(k, j), likeness(is[j], should_be(k, j)),
                        here()),
            jacobian_hint(k, slot, turn, should_be.row(k).segment<3>(turn ? 3 : 0)), std::abs(is[j] - should_be(k, j)));
      }
      if (link_.row_kind(k) == RowKind::rotation && should_be.row(k).head<3>().norm() > 1e-6 * size)
        add("kind",
            fmt::format("{} is of the kind rotation, but moves of body '{}' change it", row(k),
                        system_.body_of_slot(slot).name),
            "plan_rows(): RowKind::translation for metres, RowKind::function for anything else");
    }
  }
}

std::string LockCheck::jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const {
  const Vec3 is = rows_.J.block<1, 3>(k, 6 * slot + (turn ? 3 : 0)).transpose();
  const Mat3& A = place_.slot(slot).A;
  const double near = 1e-5 * should_be.norm();
  if (turn && (is - A * should_be).norm() <= near)
    return "the axes: its three numbers are right in world axes, and the angular velocity is in the body's own";
  if (!turn && (is - A.transpose() * should_be).norm() <= near)
    return "the axes: its three numbers are right in body axes, and the velocity is in the world's";
  const std::string body = system_.body_of_slot(slot).name;
  if (is.isZero(0)) return fmt::format("set() for body '{}' in gather(), which gives it nothing", body);
  return fmt::format("the {} vector of set() for body '{}' in gather(), in {} axes", turn ? "second" : "first", body,
                     turn ? "its own" : "world");
}

// Ct = dC/dt with the bodies held; what the link integrates goes on.
void LockCheck::time_derivative() {
  LockRows r;
  Place held = place_;
  for (Motion& O : held.motions) O.v.setZero(), O.w.setZero();
  const Slope d = first_derivative(
      [&](double x, VecX& out) {
        Place on = held;
        on.t += x;
        bench_.move_states(held, on);
        bench_.rows(on, r);
        out = r.C;
      },
      quiet_);
  for (int k = 0; k < m_; ++k) {
    const double is = rows_.Ct[k], should_be = d.value[k];
    if (compare(is, should_be, d.error[k], std::max({std::abs(is), std::abs(should_be), std::abs(rows_.C[k])})))
      continue;
    add(fmt::format("Ct {}", k),
        fmt::format("Ct of {} is {:.6g}, differences in time with the bodies held say {:.6g}{} {}", row(k), is,
                    should_be, likeness(is, should_be), here()),
        "Ct in gather(): the rate of C by its laws alone, the markers' own motion included, with the sign that the law "
        "has in C",
        std::abs(is - should_be));
  }
}

void LockCheck::velocities_leave_alone() {
  Place on = place_;
  for (Motion& O : on.motions) O.v *= 1.7, O.w *= -0.6;
  LockRows r;
  bench_.rows(on, r);
  const auto differ = [](const auto& a, const auto& b) {
    return (a - b).cwiseAbs().sum() > 1e-9 * (1 + b.cwiseAbs().sum());
  };
  for (int k = 0; k < m_; ++k) {
    const char* what = std::abs(r.C[k] - rows_.C[k]) > 1e-9 * (1 + std::abs(rows_.C[k]))      ? "C"
                       : std::abs(r.Ct[k] - rows_.Ct[k]) > 1e-9 * (1 + std::abs(rows_.Ct[k])) ? "Ct"
                       : differ(r.J.row(k), rows_.J.row(k))                                   ? "the jacobian"
                                                                                              : nullptr;
    if (what != nullptr)
      add(fmt::format("velocity {}", k), fmt::format("{} of {} changes with the velocities {}", what, row(k), here()),
          "gather(): C, Ct and the jacobian follow from the pose and the time; velocities go into Qhat alone");
  }
}

// Qhat = Jh a - Cdd (4.14), so without accelerations it is -Cdd.
Slope LockCheck::minus_Cdd(const Place& from, double reach) {
  LockRows r;
  Place on;
  Slope d = second_derivative(
      [&](double x, VecX& out) {
        coast(from, x, on);
        bench_.move_states(from, on);
        bench_.rows(on, r);
        out = r.C;
      },
      reach);
  d.value = -d.value;
  return d;
}

void LockCheck::right_side() {
  const Slope d = minus_Cdd(place_, std::min(0.05, quiet_));
  for (int k = 0; k < m_; ++k) {
    const double is = rows_.Qhat[k], should_be = d.value[k];
    if (compare(is, should_be, d.error[k], std::max(std::abs(is), std::abs(should_be)))) continue;
    add(fmt::format("Qhat {}", k),
        fmt::format("Qhat of {} is {:.6g}, second differences of C along a motion say {:.6g}{}{} {}", row(k), is,
                    should_be, likeness(is, should_be), diagnose_right_side(k), here()),
        "Qhat = -(dJh/dt v + dCt/dt) in gather(), its part that is named here", std::abs(is - should_be));
  }
}

// Which part of Qhat is wrong: at rest, linear or quadratic in one velocity, or a product of two of them.
std::string LockCheck::diagnose_right_side(int k) {
  struct Part {
    int slot;
    bool turn;
  };
  std::vector<Part> parts;
  for (int i = 0; i < link_.slots().n; ++i)
    for (const bool turn : {false, true}) parts.push_back({link_.slots()[i], turn});
  const auto name = [&](const Part& g) {
    return fmt::format("the {}velocity of body '{}'", g.turn ? "angular " : "", system_.body_of_slot(g.slot).name);
  };
  struct Value {
    double is, should_be, error;
    Value operator+(const Value& o) const { return {is + o.is, should_be + o.should_be, error + o.error}; }
    Value operator-(const Value& o) const { return {is - o.is, should_be - o.should_be, error + o.error}; }
    bool wrong() const { return std::abs(is - should_be) > error + 1e-9 * std::max(std::abs(is), std::abs(should_be)); }
  };
  const auto with = [&](std::initializer_list<std::pair<Part, double>> moving) {
    Place on = place_;
    for (Motion& O : on.motions) O.v.setZero(), O.w.setZero();
    for (const auto& [g, sign] : moving) {
      const Motion& was = place_.slot(g.slot);
      (g.turn ? on.slot(g.slot).w : on.slot(g.slot).v) = sign * (g.turn ? was.w : was.v);
    }
    LockRows r;
    bench_.rows(on, r);
    const Slope d = minus_Cdd(on, std::min(0.05, quiet_));
    return Value{r.Qhat[k], d.value[k], d.error[k]};
  };
  const auto say = [](const std::string& part, const Value& v) {
    return fmt::format("; {} is {:.6g} and should be {:.6g}{}", part, v.is, v.should_be, likeness(v.is, v.should_be));
  };
  const Value rest = with({});
  if (rest.wrong()) return say("its part with all bodies at rest, the second time derivative of the laws,", rest);
  for (const Part& g : parts) {
    const Value plus = with({{g, 1}}), minus = with({{g, -1}});
    const Value even{0.5 * (plus.is + minus.is) - rest.is, 0.5 * (plus.should_be + minus.should_be) - rest.should_be,
                     plus.error + minus.error + rest.error};
    if (even.wrong()) return say("its part that is quadratic in " + name(g), even);
    const Value odd{0.5 * (plus.is - minus.is), 0.5 * (plus.should_be - minus.should_be), plus.error + minus.error};
    if (odd.wrong()) return say("its part that is the product of " + name(g) + " and the rate of a law", odd);
  }
  for (std::size_t a = 0; a < parts.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Value both = with({{parts[a], 1}, {parts[b], 1}}) - with({{parts[a], 1}}) - with({{parts[b], 1}}) + rest;
      if (both.wrong())
        return say("its part that is the product of " + name(parts[b]) + " and " + name(parts[a]), both);
    }
  return "";
}

// K = d(Jh^T lambda)/d(x, turn), (9.4).
void LockCheck::tangent() {
  Draw draw(options_.seed + 1000 + static_cast<std::uint64_t>(state_));
  VecX lambda(m_);
  for (int k = 0; k < m_; ++k) lambda[k] = draw.number(-1, 1);
  TangentSum sum;
  sum.lay_out(n_);
  add_tangent(link_, place_.in(), {lambda.data(), static_cast<std::size_t>(m_)}, sum);
  MatX K = MatX::Zero(6 * n_, 6 * n_);
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    K.block<6, 6>(6 * sum.pairs()[p].row, 6 * sum.pairs()[p].column) += sum.K(p);
  LockRows r;
  for (int slot = 0; slot < n_; ++slot) {
    if (link_.slots().position(slot) < 0) continue;
    const bool particle = system_.slot(slot).freedoms == Freedoms::particle;
    for (int j = 0; j < (particle ? 3 : 6); ++j) {
      Place on = place_;
      const Slope d = first_derivative(
          [&](double x, VecX& out) {
            on.slot(slot) = Differences::moved(place_.slot(slot), j, x);
            bench_.rows(on, r);
            out = r.J.transpose() * lambda;
          },
          j < 3 ? kMoveReach * length_ : kTurnReach);
      const int column = 6 * slot + j;
      const double size =
          std::max({K.cwiseAbs().maxCoeff(), d.value.cwiseAbs().maxCoeff(), rows_.J.cwiseAbs().maxCoeff()});
      for (int i = 0; i < 6 * n_; ++i) {
        if (i % 6 >= 3 && system_.slot(i / 6).freedoms == Freedoms::particle) continue;
        // the default tangent() differences too, to some 1e-9 of what it finds
        if (compare(K(i, column), d.value[i], d.error[i] + 1e-7 * size, size)) continue;
        add(fmt::format("K {} {} {}", i / 6, slot, j >= 3),
            fmt::format(
                "tangent(): the change of the {} on body '{}' along its {} axis with {} is {:.6g}, differences of "
                "Jh^T lambda say {:.6g}{} {}",
                i % 6 < 3 ? "force" : "moment", system_.body_of_slot(i / 6).name, "xyz"[i % 3],
                move_name(system_, slot, j), K(i, column), d.value[i], likeness(K(i, column), d.value[i]), here()),
            "tangent(); leave it out, and the library differences gather() for implicit methods",
            std::abs(K(i, column) - d.value[i]));
      }
    }
  }
}

}  // namespace lockstep
