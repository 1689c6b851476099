// Which rows are redundant: a function of the links in force and of the branch.
#include <lockstep/dynamics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/joint_coordinates.h"
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

constexpr double kBeside = 0.1;  // rad, or parts of the length: to the nearest pose that is looked at

// Turns are measured as lengths of the whole mechanism.
MatX rows_transposed(const Evaluation& e) {
  const double per_turn = 1 / e.system().length();
  MatX Jt = MatX::Zero(e.force().size(), e.rows().n_rows);
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int i = 0; i < entry.slots.n; ++i)
      for (int k = 0; k < entry.m; ++k) {
        const std::array<double, 6> J = block.J(i, k);
        for (int c = 0; c < 6; ++c)
          Jt(6 * entry.slots[i] + c, entry.first_row + k) += (c < 3 ? 1 : per_turn) * J[static_cast<std::size_t>(c)];
      }
  }
  return Jt;
}

}  // namespace

bool loses_rank(Dynamics& dynamics, const State& state) {
  State slots = state;
  dynamics.to_slots(slots);
  const bool held = dynamics.holds_rows();
  const int beside = dynamics.redundancy(slots).rows;
  const Evaluation& e = dynamics.gather_rows(slots);
  const MatX Jt = e.rows().n_rows > kDenseRows ? MatX() : rows_transposed(e);
  if (!held) dynamics.forget_rows(state);
  return beside < 0 || Jt.size() == 0 || Jt.cols() - RowSpace(Jt.sparseView()).rank(kNearlyDependent) > beside;
}

bool Dynamics::is_assembled(const State& state) {
  return violation_of_closures(state) <= kOnConstraints * system_.length();
}

// Pivots of the rows at this state.
SolveReport Dynamics::pivots(const State& state) {
  SolveReport report;
  if (state.coordinates) {
    tree(state.modes).of(state).pivots(system_, state, report);
    return report;
  }
  Evaluation& e = own();
  e.rows_at(state);
  e.check();
  factor_.compute(e);
  factor_.complete(report);
  return report;
}

Redundancy Dynamics::redundancy(const State& state) {
  check_state(system_, state);
  if (redundancies_of_ != system_.revision()) redundancies_.clear(), redundancies_of_ = system_.revision();
  std::vector<bool> key = state.modes;
  key.push_back(state.coordinates != nullptr);
  if (const auto known = redundancies_.find(key); known != redundancies_.end()) return known->second;
  Redundancy found;
  if (!has_loops(system_, state.modes) || (state.coordinates && !state.coordinates->has_rows())) {
    found.rows = 0;
  } else {
    int most = std::numeric_limits<int>::max();
    if (state.coordinates) {  // rows of closures are some of all rows; before a singular pose asks for these
      State slots = state;
      to_slots(slots);
      const bool held = holds_rows();
      if (const int all = redundancy(slots).rows; all >= 0) most = all;
      if (!held) forget_rows(state);
    }
    const WorkCount before = work_;
    try {
      found = find_redundancy(state, most);
    } catch (...) {  // nothing stays of what was not found to the end
      state.coordinates ? tree(state.modes).closures().set_redundant(Kkt::kUnknown)
                        : own().set_redundant(Kkt::kUnknown);
      work_ = before;
      throw;
    }
    work_ = before;
  }
  if (found.rows >= 0) redundancies_.emplace(std::move(key), found);
  return found;
}

// The least number of small pivots in poses on both sides, `most` at most: along the motion itself, at rest along the
// accelerations, which stay on its branch; and if this is no singular position also along a free motion of all parts. If
// fewer rows depend on others before these poses are projected, or their C contradict one another, some do so on the
// constraints only. Unknown as long as laws have yet to move what has small pivots.
Redundancy Dynamics::find_redundancy(const State& state, int most) try {
  if (!is_assembled(state)) return {};
  const auto know = [&](int n) {
    state.coordinates ? tree(state.modes).closures().set_redundant(n) : own().set_redundant(n);
  };
  const auto small = [&](const State& at) {
    know(Kkt::kUnknown);
    return pivots(at).small_pivots;
  };
  struct Look {
    int dependent;
    bool agrees;  // J d = -C has a solution
  };
  const auto look_off = [&](const State& at) {
    MatX Jt = at.coordinates ? tree(at.modes).rows_transposed(system_, at) : rows_transposed(gather_rows(at));
    const double least = kRoundOff * Jt.norm();  // a row that vanishes is one of round-off
    for (Eigen::Index row = 0; row < Jt.cols(); ++row)
      if (!(Jt.col(row).norm() > least)) Jt.col(row).setZero();
    const Eigen::Index n_rows = Jt.cols();
    const RowSpace space(Jt.sparseView());
    Look look{static_cast<int>(n_rows) - space.rank(), true};
    if (is_assembled(at)) return look;
    const VecX& C = at.coordinates ? tree(at.modes).C : C_;
    const MatX circuits = space.circuits();
    for (Eigen::Index k = 0; k < circuits.cols(); ++k)
      look.agrees = look.agrees && std::abs(circuits.col(k).dot(C)) <= kSlight * circuits.col(k).norm() * C.norm();
    return look;
  };
  State here = state;
  project(here, 0);
  const int of_here = small(here);
  Redundancy found{.rows = std::min(of_here, most)};
  std::vector<State> poses = {here};
  const auto look_along = [&](const State& moving, bool from_rest) {  // then its velocities are accelerations
    std::vector<Motion> motions;
    system_.motions(moving, motions);
    const double speed = speed_of(motions, system_.length());
    if (!(speed > kNegligible)) return false;
    for (const double angle : {kBeside, -kBeside, 2 * kBeside, -2 * kBeside, 4 * kBeside, -4 * kBeside}) try {
        State beside = here;
        advance(beside, angle / speed, moving.v);
        normalize(beside);
        const double x = std::abs(angle) / speed;  // v t, or a t^2/2
        beside.t += std::copysign(from_rest ? std::sqrt(2 * x) : x, angle);
        const bool few = of_here > 0 && std::abs(angle) == kBeside &&
                         (state.coordinates ? tree(state.modes).closure_rows : own().rows()).n_rows <= kDenseRows;
        const Look off = few ? look_off(beside) : Look{0, true};
        if (!(project(beside, 0).after <= kRoundOff * system_.length())) continue;
        found.rows = std::min(found.rows, small(beside));
        if (few && (off.dependent < look_off(beside).dependent || !off.agrees)) found.on_constraints = true;
        poses.push_back(std::move(beside));
      } catch (const Error&) {  // what cannot be evaluated there answers nothing
      }
    return true;
  };
  State moving = here;
  bool moves = look_along(here, false);
  if (!moves) try {
      know(found.rows);
      StateRate rate = sized_like(here);
      rates(here, rate);
      moving.v = rate.v;
      moves = look_along(moving, true);
    } catch (const Error&) {
    }
  if (found.rows == of_here) {
    for (Eigen::Index i = 0; i < moving.v.size(); ++i) moving.v[i] = std::cos(1.0 + 2.3 * static_cast<double>(i));
    project_velocity(moving);
    moves = look_along(moving, false) || moves;
  }
  if (!moves && of_here > 0 && may_have_laws(system_)) return know(Kkt::kUnknown), Redundancy{};
  found.regular = 0;
  know(found.rows);
  for (const State& pose : poses) found.regular = std::max(found.regular, std::min(1.0, pivots(pose).detector));
  return found;
} catch (const Error&) {  // named by the evaluation of this state that follows
  return {};
}

}  // namespace lockstep
