// SPDX-License-Identifier: BSD-3-Clause
// Which rows are redundant: a function of the links in force and of the branch.
#include <lockstep/dynamics.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/joint_coordinates.h"
#include "framework/dynamics/evaluate/loop_rows.h"
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/at_end.h"

namespace lockstep {

namespace {

constexpr double kBeside = 0.1;  // rad, or parts of the length: to the nearest pose that is looked at

SparseMat all_rows(const Evaluation& e) {
  std::vector<int> entries(e.rows().entries.size());
  std::iota(entries.begin(), entries.end(), 0);
  return rows_of_loop(e.system(), e.rows(), entries);
}

struct Loops {
  std::vector<SparseMat> Jt;  // rows of each, transposed
  int n_rows = 0;             // of all links
};

Loops loops_at(Dynamics& dynamics, const State& state) {
  State slots = state;
  dynamics.to_slots(slots);
  const bool held = dynamics.holds_rows();
  const Evaluation& e = dynamics.gather_rows(slots);
  Loops loops{.Jt = {}, .n_rows = e.rows().n_rows};
  for (const std::vector<int>& entries : closed_loops(e.system(), e.rows()))
    loops.Jt.push_back(rows_of_loop(e.system(), e.rows(), entries));
  if (!held) dynamics.forget_rows(state);
  return loops;
}

// How many rows of loops that are factored densely nearly depend on others.
int nearly_dependent(const Loops& loops, double least) {
  int n = 0;
  for (const SparseMat& Jt : loops.Jt)
    if (Jt.cols() <= kDenseRows) n += RowSpace(Jt).nearly(least);
  return n;
}

}  // namespace

// Alike in all frames, units and orders, and whatever else moves, as pivots of solvers are not.
// Rows of closures leave as many coordinates free as all rows leave velocities. Many rows are factored sparsely.
int Dynamics::dependent_rows(const State& state) {
  const Loops loops = loops_at(*this, state);
  int dependent = 0;
  for (const SparseMat& Jt : loops.Jt) {
    const int n = static_cast<int>(Jt.cols());
    dependent += n - (n > kDenseRows ? Dependencies(Jt).rank : RowSpace(Jt).rank(kNearlyDependent));
  }
  if (!state.coordinates) return dependent;
  const int free = system_.n_velocities() - (loops.n_rows - dependent);
  return tree(state.modes).closure_rows.n_rows - (static_cast<int>(state.v.size()) - free);
}

bool loses_rank(Dynamics& dynamics, const State& state) {
  const int beside = dynamics.redundancy(state).rows;
  return beside < 0 || dynamics.dependent_rows(state) > beside;
}

bool nearly_loses_rank(Dynamics& dynamics, const State& state) {
  return nearly_dependent(loops_at(dynamics, state), kDependent) > 0;
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
  factor_.complete(e, report);
  return report;
}

Redundancy Dynamics::redundancy(const State& state) {
  check_state(system_, state);
  if (redundancies_of_ != system_.revision()) redundancies_.clear(), redundancies_of_ = system_.revision();
  std::vector<bool> key = state.modes;
  key.push_back(state.coordinates != nullptr);
  if (const auto known = redundancies_.find(key); known != redundancies_.end()) return known->second;
  Redundancy found{.rows = 0};
  if (has_loops(system_, state.modes) && (!state.coordinates || state.coordinates->has_rows())) {
    const AtEnd back([&, before = work_] { work_ = before; });
    const auto forget = [&] {  // nothing stays of what was not found to the end
      state.coordinates ? tree(state.modes).closures().set_redundant(Kkt::kUnknown)
                        : own().set_redundant(Kkt::kUnknown);
    };
    try {
      found = find_redundancy(state);
    } catch (const Error&) {  // named by the evaluation of this state that follows
      forget(), found = {};
    } catch (...) {
      forget();
      throw;
    }
  }
  if (found.rows >= 0) redundancies_.emplace(std::move(key), found);
  return found;
}

// The least number of dependent rows in poses on both sides. The poses lie along the motion itself, at rest along the
// accelerations, which stay on its branch; and if this is no singular position also along a free motion of all parts,
// unless that is the same one. If fewer rows depend on others before these poses are projected, or their C contradict
// one another, some do so on the constraints only. Unknown as long as laws have yet to move what depends. The nearest
// poses are enough if no row depends on others, and the farthest with them if some do, as long as the numbers are the
// same and this pose is not near a singular position by the limit that they give. If that limit can rise no more, and no
// row depends, no pose is asked.
Redundancy Dynamics::find_redundancy(const State& state) {
  if (!is_assembled(state)) return {};
  const auto know = [&](int n, bool nearly = false) {
    state.coordinates ? tree(state.modes).closures().set_redundant(n) : own().set_redundant(n, nearly);
  };
  // If n rows are redundant, which the search does not know: none stay unmet on its ways.
  const auto look = [&](const State& at, int n) {
    Redundancy found{.rows = n};
    if (!state.coordinates && n > 0)  // not by what projections leave of poses
      found.nearly = nearly_dependent(loops_at(*this, at), kNegligible) > 0;
    know(n, found.nearly);
    found.regular = std::min(1.0, pivots(at).detector);
    return know(Kkt::kUnknown), found;
  };
  // How many rows depend on others, and whether J d = -C has a solution.
  const auto look_off = [&](const State& at) {
    MatX Jt = at.coordinates ? tree(at.modes).rows_transposed(system_, at) : MatX(all_rows(gather_rows(at)));
    const double least = kRoundOff * Jt.norm();  // a row that vanishes is one of round-off
    for (Eigen::Index row = 0; row < Jt.cols(); ++row)
      if (!(Jt.col(row).norm() > least)) Jt.col(row).setZero();
    const RowSpace space(Jt.sparseView());
    std::pair off{static_cast<int>(Jt.cols()) - space.rank(), true};
    if (is_assembled(at)) return off;
    const VecX& C = at.coordinates ? tree(at.modes).C : C_;
    const MatX circuits = space.circuits();
    for (Eigen::Index k = 0; k < circuits.cols(); ++k)
      off.second = off.second && std::abs(circuits.col(k).dot(C)) <= kSlight * circuits.col(k).norm() * C.norm();
    return off;
  };
  State here = state;
  project(here, 0);
  const Redundancy of_here = look(here, dependent_rows(here));
  if (of_here.rows == 0 && near_singular_below(of_here.regular) == near_singular_below(1)) return know(0), of_here;
  int all = of_here.rows;
  if (state.coordinates) {  // those of closures are some of all
    State slots = here;
    to_slots(slots);
    const bool held = holds_rows();
    if (const int n = redundancy(slots).rows; n >= 0) all = n;
    if (!held) forget_rows(state);
  }
  Redundancy found = of_here;
  int looked = 0;
  const auto look_along = [&](const State& moving, bool from_rest) {  // then its velocities are accelerations
    know(Kkt::kUnknown);
    std::vector<Motion> motions;
    passes::motions(system_, moving, motions);
    const double speed = speed_of(motions, system_.length());
    if (!(speed > kNegligible)) return false;
    int n = 0;
    for (const double angle : {kBeside, -kBeside, 4 * kBeside, -4 * kBeside, 2 * kBeside, -2 * kBeside}) try {
        State beside = here;
        advance(beside, angle / speed, moving.v);
        normalize(beside);
        const double x = std::abs(angle) / speed;  // v t, or a t^2/2
        beside.t += std::copysign(from_rest ? std::sqrt(2 * x) : x, angle);
        const bool few = of_here.rows > 0 && !found.on_constraints && std::abs(angle) == kBeside &&
                         (state.coordinates ? tree(state.modes).closure_rows : own().rows()).n_rows <= kDenseRows;
        const auto [dependent, agrees] = few ? look_off(beside) : std::pair{0, true};
        if (!(project(beside, 0).after <= kRoundOff * system_.length())) continue;
        const Redundancy there = look(beside, std::min(found.rows, dependent_rows(beside)));
        const bool first = looked + n == 0 || there.rows < found.rows;  // of those that count
        if (there.rows < found.rows) found.rows = there.rows, found.regular = 0;
        found.regular = std::max(found.regular, there.regular);
        found.nearly = there.nearly && (first || found.nearly);
        if (few && (!agrees || dependent < look_off(beside).first)) found.on_constraints = true;
        const bool both = ++n == (of_here.rows > 0 ? 4 : 2) && angle < 0;
        if (both && found.rows == of_here.rows && of_here.regular >= near_singular_below(found.regular)) break;
      } catch (const Error&) {  // poses that cannot be evaluated are skipped
        know(Kkt::kUnknown);
      }
    return looked += n, true;
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
  // Where laws move all, nearly dependent rows seem to leave something free.
  const int n_rows = (state.coordinates ? tree(state.modes).closure_rows : own().rows()).n_rows;
  const auto n_free = state.coordinates ? state.v.size() : system_.n_velocities();
  const bool frees = !may_have_laws(system_) || n_rows > kDenseRows || n_rows - look_off(here).first < n_free;
  if (found.rows == of_here.rows && frees) {
    know(Kkt::kUnknown);
    const VecX first = moving.v;
    for (Eigen::Index i = 0; i < moving.v.size(); ++i) moving.v[i] = std::cos(1.0 + 2.3 * static_cast<double>(i));
    project_velocity(moving);
    const bool other = std::abs(first.dot(moving.v)) < (1 - kSlight) * first.norm() * moving.v.norm();
    moves = ((other || !moves) && look_along(moving, false)) || moves;
  }
  if ((!moves || looked == 0) && all > 0 && may_have_laws(system_)) return know(Kkt::kUnknown), Redundancy{};
  if (all < found.rows) found.rows = all, found.regular = look(here, all).regular;
  know(found.rows, found.nearly);
  return found;
}

}  // namespace lockstep
