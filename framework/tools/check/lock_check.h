// SPDX-License-Identifier: BSD-3-Clause
// The check of a link: its description, its memory, what its rows may depend on, and their derivatives against differences.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <limits>
#include <set>

#include <lockstep/author/check.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/check/state_check.h"

namespace lockstep {

// Gathers links of one pattern in one call. A row has C, Ct, Qhat, and the Jacobian with 6 columns per slot of the
// system; it holds `before` when the links begin to write. `outside`: whether they wrote outside of their rows.
inline std::vector<MatX> gathered(const System& system, Group links, const TestState& at, double before = 0,
                                  bool* outside = nullptr) {
  const RowShape s = links.front()->shape();
  const std::size_t stride = RowSpan::stride(s), ld = std::max(s.ld(), 1);
  const std::size_t n_turned_columns = n_turned(s.layout);
  // The rows, padded with zeros, between two fences.
  Aligned<double> numbers((links.size() + 2) * stride, std::numeric_limits<double>::max());
  std::fill(numbers.begin() + stride, numbers.end() - stride, 0.0);
  const auto fill_rows = [&](double x) {
    for (std::size_t lane = 1; lane <= links.size(); ++lane)
      for (std::size_t c = 0; c < s.size() / ld; ++c) {
        const bool turned = c >= 3 && c < 3 + n_turned_columns;  // the columns of R have three rows
        std::fill_n(numbers.data() + lane * stride + c * ld, turned ? std::min(s.m, 3) : s.m, x);
      }
  };
  const Aligned<double> empty = numbers;
  fill_rows(before);
  const RowSpan out(numbers.data() + stride, s);
  links.front()->gather(links, at.in(), out);
  std::vector<MatX> all(links.size(), MatX::Zero(s.m, 3 + 6 * system.n_slots()));
  for (std::size_t lane = 0; lane < links.size(); ++lane)
    for (int k = 0; k < s.m; ++k) {
      const RowView block = out.lane(lane);
      auto row = all[lane].row(k);
      row.head<3>() << block.C(k), block.Ct(k), block.Qhat(k);
      for (int i = 0; i < s.n; ++i)
        row.segment<6>(3 + 6 * links[lane]->slots()[i]) =
            Eigen::Map<const Eigen::RowVector<double, 6>>(block.J(i, k).data());
    }
  fill_rows(0);
  if (outside != nullptr) *outside = numbers != empty;
  return all;
}

inline MatX rows_of(const System& system, const Lock& link, const TestState& at) {
  const Lock* self = &link;
  return gathered(system, Group(&self, 1), at)[0];
}

// `sign` times C over time, along the motion without accelerations; the link's own states advance by their rates.
// The states by Gauss's rule over the rates along the motion; at each point s itself is extrapolated linearly.
inline Curve C_along(const System& system, const Lock& link, TestState from, double sign) {
  return [&system, &link, sign, from = std::move(from)](double end) -> VecX {
    const int n = link.n_own_states(), first = link.first_state();
    const auto rates = [&](const TestState& at) {
      VecX rate(n);
      link.stateful()->state_rates(at.in(), {rate.data(), static_cast<std::size_t>(n)});
      return rate;
    };
    TestState to = coasted(from, end);
    for (int i = 0; i < n; ++i) {
      const auto rate = [&](double x) {
        TestState on = coasted(from, x);
        on.s.segment(first, n) += x * rates(from);
        return rates(on)[i];
      };
      to.s[first + i] += boost::math::quadrature::gauss<double, 5>::integrate(rate, 0.0, end);
    }
    return sign * rows_of(system, link, to).col(0);
  };
}

class LockCheck : public StateCheck {
 public:
  // `sibling`: another link of the type, to form a group; null: the link is twice in the group.
  LockCheck(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
            const CheckOptions& options)
      : StateCheck(system, report, options, link.remembering(), link.first_memory()),
        link_(link),
        sibling_(sibling),
        m_(link.row_count()),
        idle_(m_, true) {
    is_link_ = true, n_timed_ = 3, n_turned_ = 1;
    for (int i = 0; i < link.slots().n; ++i) slots_.push_back(link.slots()[i]);
  }

 protected:
  ErrorContext context() const override { return context_of(link_, state_.t); }
  MatX numbers(const TestState& at) override { return rows_of(system_, link_, at); }
  std::string row(int k) const { return "constraint " + link_.row_name(k); }
  auto J(int k, int slot) const { return is_.block<1, 6>(k, 3 + 6 * slot); }

  std::string name(Eigen::Index k, Eigen::Index column) const override {
    constexpr const char* kParts[] = {"C of ", "Ct of ", "Qhat of "};
    const std::string its = row(static_cast<int>(k));
    if (column < 3) return kParts[column] + its;
    return fmt::format("the Jacobian of {} on body '{}'", its, body(static_cast<int>(column - 3) / 6));
  }

  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (link_.driven()) link_.driven()->breakpoints(t0, t1, out);
  }

  std::string why_not_finite() const override {
    const std::string fault = link_.driven() ? link_.driven()->diagnose(state_.t) : "";
    return fault.empty() ? StateCheck::why_not_finite() : fault;
  }

  void at_state() override {
    everything_written();
    group();
    pose_alone();
    idle();
    if (!fits()) return;
    jacobian();
    time_derivatives();
    tangent();
  }

  bool description() override {
    const int n_drives = link_.driven() ? link_.driven()->n_drives() : 0;
    std::set<std::string> names;
    for (int k = 0; k < m_; ++k) {
      if (link_.row_name(k).empty()) add("names", fmt::format("constraint {} has no name", k), "plan_rows()");
      if (!names.insert(link_.row_name(k)).second)
        add("names", fmt::format("two constraints are called '{}'", link_.row_name(k)), "plan_rows()");
      if (const int drive = link_.row(k).drive; drive < -1 || drive >= n_drives)
        add("drives", fmt::format("{} belongs to drive {}, of {} drives", row(k), drive, n_drives),
            "plan_rows() (LinkRow::drive) and n_drives()");
    }
    if (link_.pairs().empty()) add("pairs", "has no pair of markers", "pairs()");
    bool moves = false;
    for (const auto& [p, s] : link_.pairs())
      for (const Marker* marker : {p, s}) {
        const int slot = marker->body->slot;
        if (slot == kGround) continue;
        moves = true;
        if (link_.slots().position(slot) < 0)
          add("slots",
              fmt::format("slots() lacks body '{}', which has its marker '{}'", marker->body->name, marker->name),
              "the slots that plan_rows() returns");
      }
    if (const Observable* own = link_.observable())
      for (const Quantity& q : own->quantities())
        if (q.name.empty()) add("quantities", "has a quantity without a name", "quantities()");
    if (n_ == 0 || !moves)
      add("slots", "touches no moving body, so nothing can be checked", "the bodies of its markers");
    return n_ > 0 && moves;
  }

  void everything_written() {
    const Lock* self = &link_;
    bool outside = false;
    const MatX r = gathered(system_, Group(&self, 1), state_, std::numeric_limits<double>::quiet_NaN(), &outside)[0];
    for (int k = 0; k < m_; ++k)
      for (int c = 0; c < r.cols(); ++c)
        if (std::isnan(r(k, c)))
          add("written " + name(k, c), name(k, c) + " is not written: it keeps the number from before",
              "gather(): write every number of every row and slot by set(), zeros too");
    if (outside)
      add("outside", "writes outside of its rows",
          "gather(): row numbers from 0 to row_count() - 1, slots from slots().position()");
  }

  void group() {
    const bool grouped = sibling_ != nullptr && sibling_->pattern() == link_.pattern() && sibling_->row_count() == m_ &&
                         sibling_->slots().n == link_.slots().n;
    const Lock& other = grouped ? *sibling_ : link_;
    const Lock* both[2] = {&link_, &other};
    const std::vector<MatX> as_one = gathered(system_, Group(both, 2), state_);
    // Equal up to rounding: a group may be gathered in packs.
    const auto near = [](const MatX& a, const MatX& b) {
      return !((a - b).colwise().norm().array() > kRounding * (1 + b.colwise().norm().array())).any();
    };
    if (!near(as_one[0], is_) || !near(as_one[1], rows_of(system_, other, state_)))
      add("group", "two joints gathered as one group differ from each one alone",
          "gather(): for each i, links[i] (not this) writes to out.lane(i)");
  }

  // C, Ct and the Jacobian do not depend on velocities.
  void pose_alone() {
    TestState on = state_;
    for (Motion& O : on.motions) O.v *= 1.7, O.w *= -0.6;
    MatX r = numbers(on);
    r.col(2) = is_.col(2);
    for (int k = 0; k < m_; ++k)
      for (int c = 0; c < r.cols(); ++c)
        if (std::abs(r(k, c) - is_(k, c)) > kNegligible * (1 + std::abs(is_(k, c))))
          add(fmt::format("velocity {}", k), name(k, c) + " changes with the velocities",
              "gather(): C, Ct and the Jacobian depend on pose and time alone; velocities belong to Qhat");
  }

  // Rows that remove no degree of freedom: no gradient, or a combination of those before.
  void idle() {
    std::vector<VecX> basis;
    for (int k = 0; k < m_; ++k) {
      VecX rest = is_.row(k).tail(6 * n_).normalized().transpose();
      for (const VecX& q : basis) rest -= q.dot(rest) * q;
      if (rest.norm() > kNegligible) idle_[k] = false, basis.push_back(rest.normalized());
    }
  }

  void turns() override {
    for (int k = 0; k < m_; ++k)
      if (idle_[k])
        add(fmt::format("idle {}", k), row(k) + " removes no degree of freedom in any state",
            "its equation: it has no gradient, or repeats another constraint");
    for (const auto& [p, s] : link_.pairs()) {
      const bool move_p = p->body->slot != kGround;
      turn_about_z((move_p ? p : s)->body->slot, *s, move_p ? 1 : -1, fmt::format("'{}'", (move_p ? p : s)->name));
    }
  }

  // Whether what the numbers follow from is right; what does not fit is reported.
  virtual bool fits() { return true; }

  // dC/d(x, rotation), column by column.
  void jacobian() {
    const auto C = [&](const TestState& at) -> VecX { return numbers(at).col(0); };
    const VecX size = is_.rightCols(6 * n_).cwiseAbs().rowwise().maxCoeff();
    for (int slot = 0; slot < n_; ++slot) {
      std::vector<Slope> columns;
      for (int j = 0; j < n_freedoms(slot); ++j) columns.push_back(derivative(state_, slot, j, C));
      for (int j = 0; j < n_freedoms(slot); ++j)
        compare(
            report_,
            {fmt::format("J {} {}", slot, j / 3), is_.col(3 + 6 * slot + j), size,
             [&](int k) { return fmt::format("Jacobian of {} with respect to {}", row(k), unknown_name(slot, j + 6)); },
             "finite differences give", here(),
             [&](int k) {
               const auto of = columns.begin() + j / 3 * 3;
               return blame(jacobian_hint(k, slot, j >= 3, {of[0].value[k], of[1].value[k], of[2].value[k]}));
             }},
            columns[j]);
      for (int k = 0; k < m_; ++k)
        if (link_.row_kind(k) == RowKind::rotation && J(k, slot).head<3>().norm() > kSlight * size[k])
          add("kind",
              fmt::format("{} is of the kind rotation, but translations of body '{}' change it", row(k), body(slot)),
              "plan_rows(): RowKind::translation for metres, RowKind::function for anything else");
    }
  }

  std::string jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const {
    if (link_.slots().position(slot) < 0)
      return fmt::format("slots(), which setup() fills: {} depends on body '{}', which slots() lacks", row(k),
                         body(slot));
    const Vec3 is = J(k, slot).segment<3>(turn ? 3 : 0).transpose();
    const Mat3& A = state_.slot(slot).A;
    const double near = 1e-5 * should_be.norm();
    if (turn && (is - A * should_be).norm() <= near)
      return "the axes: its three numbers are in world axes, but the angular velocity is in body axes";
    if (!turn && (is - A.transpose() * should_be).norm() <= near)
      return "the axes: its three numbers are in body axes, but the velocity is in world axes";
    if (is.isZero(0)) return fmt::format("set() for body '{}' in gather(), which is missing", body(slot));
    return fmt::format("the {} vector of set() for body '{}' in gather(), in {} axes", turn ? "second" : "first",
                       body(slot), turn ? "body" : "world");
  }

  // Ct = dC/dt with the bodies at rest; the link's own states advance. Qhat = Jh a - Cdd (4.14), so without
  // accelerations it is -Cdd.
  void time_derivatives() {
    TestState held = state_;
    held.stop();
    compare(report_,
            {"Ct", is_.col(1), is_.col(0).cwiseAbs(), [&](int k) { return name(k, 1); },
             "finite differences in time with bodies at rest give", here(),
             [&](int) {
               return blame(
                   "Ct in gather(): the rate of C by its laws and its markers' motion, with the sign of the law in C");
             }},
            first_derivative(C_along(system_, link_, held, 1), quiet_));
    compare(report_,
            {"Qhat", is_.col(2), VecX::Zero(m_), [&](int k) { return name(k, 2); },
             "second finite differences of C along a motion give", here(),
             [&](int k) { return blame("Qhat = -(dJh/dt v + dCt/dt) in gather()" + diagnose_right_side(k)); }},
            minus_Cdd(state_));
  }

  Slope minus_Cdd(const TestState& from) const {
    return second_derivative(C_along(system_, link_, from, -1), std::min(0.05, quiet_));
  }

  // Which term of Qhat is wrong: constant, linear or quadratic in one velocity, or a product of two velocities.
  std::string diagnose_right_side(int k) {
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
      found =
          fmt::format("; its part {} is {:.6g} and should be {:.6g}{}", part, is, should_be, likeness(is, should_be));
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

  // K = d(Jh^T lambda)/d(x, rotation), (9.4).
  void tangent() {
    Draw draw(options_.seed + 1000 + static_cast<std::uint64_t>(index_));
    VecX lambda(m_);
    for (double& x : lambda) x = draw.number(-1, 1);
    TangentSum sum;
    sum.lay_out(n_);
    add_tangent(link_, state_.in(), {lambda.data(), static_cast<std::size_t>(m_)}, sum);
    const auto pull = [&](const TestState& at) -> VecX { return numbers(at).rightCols(6 * n_).transpose() * lambda; };
    check_tangent(sum, false, pull, is_.rightCols(6 * n_).cwiseAbs().maxCoeff());
  }

  const Lock& link_;
  const Lock* sibling_;
  int m_;                   // rows
  std::vector<bool> idle_;  // rows that remove no degree of freedom in any state so far
};

}  // namespace lockstep
