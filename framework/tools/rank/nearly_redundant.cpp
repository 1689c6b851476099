// SPDX-License-Identifier: BSD-3-Clause
// Constraints that nearly depend on others: found, tested, and decided if requested.
#include <algorithm>
#include <deque>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <Eigen/Geometry>

#include <lockstep/analysis.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/at_end.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/left_out_rows.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {
namespace {

constexpr double kPersists = 1e-3;  // of the length: rows that are violated by less nearly depend everywhere

/// Why a row of a link cannot be left out: "one of them is driven"; "" if it can.
std::string keeper_of(const NamedRow& row) {
  const std::string law = "one of them is driven";
  const Lock& link = *row.link;
  if (link.unilateral() != nullptr) return "one of them is one-sided";
  if (link.jointed() == nullptr) return "one of them is of a coupling";
  if (link.row(row.own).drive >= 0 || (link.pattern().laws & (with::uP | with::qP | with::uS | with::qS)) != 0)
    return law;
  const ImposedMotion& imposed = link.jointed()->imposed();
  const bool along = link.row_kind(row.own) == RowKind::translation;
  return imposed.hold || (along ? imposed.move != nullptr : imposed.turn != nullptr) ? law : "";
}

/// The rows of a loop that is not too large, in the order of the links.
class LoopChoice {
 public:
  LoopChoice(const System& system, const RowTable& table, const LoopRows& loop)
      : space(loop.Jt), J_(loop.Jt.rows(), loop.n()) {
    for (const int number : loop.numbers) rows.emplace_back(system, table, number);
    order_.resize(rows.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::ranges::stable_sort(order_, {}, [&](int row) { return rows[row].link->number(); });
    for (Eigen::Index k = 0; k < J_.cols(); ++k) J_.col(k) = VecX(loop.Jt.col(order_[k])) / space.length(order_[k]);
  }

  RowSpace space;
  std::vector<NamedRow> rows;
  bool released = false;  ///< those that nearly depend are left out

  struct Choice {
    std::vector<NamedRow> gone;
    double smallest = 1;  ///< pivot of those that stay
    std::string kept;     ///< why a row of `gone` cannot be left out
  };
  /// The next that stays is the first of which others leave at least half of the most. Rows that may not go come first
  /// as long as they are a tenth of the most. Ends if no row is left above `limit`.
  Choice above(double limit) const {
    constexpr double kKeeps = 10;
    Choice out;
    MatX left = J_;
    VecX weights = VecX::Ones(left.cols());
    for (Eigen::Index k = 0; k < left.cols(); ++k)
      if (!keeper_of(ordered(k)).empty()) weights[k] = kKeeps;
    std::vector<bool> stays(rows.size(), false);
    while (left.colwise().norm().maxCoeff() > limit) {
      const VecX sizes = left.colwise().norm().transpose().cwiseProduct(weights);
      Eigen::Index next = 0;
      while (sizes[next] < 0.5 * sizes.maxCoeff()) ++next;
      stays[next] = true;
      out.smallest = std::min(out.smallest, left.col(next).norm());
      const VecX along = left.col(next).normalized();
      for (int twice = 0; twice < 2; ++twice) left -= along * (along.transpose() * left);
      left.col(next).setZero();
    }
    for (Eigen::Index k = 0; k < left.cols(); ++k) {
      if (stays[k]) continue;
      out.gone.push_back(ordered(k));
      if (out.kept.empty()) out.kept = keeper_of(ordered(k));
    }
    return out;
  }
  /// Of its joints: the diagonal of a box around them, m; the length of the system if they are in one place.
  double span(const Inputs& in, double length) const {
    Eigen::AlignedBox3d box;
    for (const NamedRow& row : rows)
      for (const auto& [p, s] : row.link->pairs()) box.extend(in_world(MarkerFrame(*p), in).x);
    const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
    return diagonal > kSlight * length ? diagonal : length;
  }
  void add_links(std::vector<std::string>& names) const {
    for (std::size_t k = 0; k < rows.size(); ++k) add_name(ordered(k).link->name(), names);
  }

 private:
  const NamedRow& ordered(Eigen::Index place) const { return rows[order_[place]]; }

  std::vector<int> order_;  // of the links, then of their rows
  MatX J_;                  // of length 1, in this order
};

/// Rows on common loops of which some nearly depend on others, and what to do with them. All that depend go, exactly or
/// nearly: those that do exactly here do so nearly when it has moved.
struct NearSet {
  NearDependency told;
  std::vector<NamedRow> gone;
  LoopChoice* of = nullptr;
  double span = 0;  // of the joints, m
};

std::vector<NearSet> nearly_dependent(std::deque<LoopChoice>& loops, const Inputs& in, double length) {
  std::vector<NearSet> all;
  for (LoopChoice& loop : loops) {
    NearSet one;
    for (const DependentRows& set : loop.space.sets()) {
      if (set.nearly == 0) continue;
      for (const int row : set.rows) {
        const NamedRow& named = loop.rows[row];
        one.told.rows.push_back(named.name());
        if (one.told.undecided.empty()) one.told.undecided = keeper_of(named);
      }
      one.told.nearly += set.nearly, one.told.singular_value = std::max(one.told.singular_value, set.pivot);
    }
    if (one.told.nearly == 0) continue;
    LoopChoice::Choice choice = loop.above(kNearlyDependent);
    if (choice.gone.size() == loop.above(kDependent).gone.size()) continue;  // of those that others may replace, none
    one.gone = std::move(choice.gone);
    if (one.told.undecided.empty()) one.told.undecided = choice.kept;
    loop.add_links(one.told.links);
    one.of = &loop, one.span = loop.span(in, length);
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<std::string> names_of(const std::vector<NamedRow>& rows) {
  std::vector<std::string> names;
  for (const NamedRow& row : rows) names.push_back(row.name());
  return names;
}

/// Which of them nearly depend in this position only: without them, what they held leads away from them.
void try_out(System& system, Dynamics& dynamics, const State& state, std::vector<NearSet>& all) {
  std::vector<NamedRow> gone;
  for (const NearSet& f : all)
    if (f.told.undecided.empty()) gone.insert(gone.end(), f.gone.begin(), f.gone.end());
  for (NearSet& f : all) {
    if (!f.told.undecided.empty()) continue;
    const std::optional<Violation> found = violation_without(system, dynamics, state, f.gone, gone);
    f.told.violation = found.value_or(Violation{}).most;
    f.told.in_passing = !(f.told.violation < kPersists * system.length());
    const auto folded = std::ranges::find_if(f.gone, [&](const NamedRow& row) {  // its pivot is at least half of e0
      return 0.5 * unfolded(*row.link, dynamics.inputs(state)) < kNearlyDependent;
    });
    if (folded != f.gone.end())
      f.told.needed =
          "joint '" + folded->link->name() + "' is folded by nearly 180 deg, and nothing else holds its rotation";
    else if (!found)
      f.told.needed = "its release would free no motion";
    else if (!(found->gap < kPersists * f.span))
      f.told.needed = fmt::format("its release would open joints by {:.2g} m", found->gap);
  }
}

// Rows that depend exactly go, of the whole mechanism, and the rest is held, but of loops that are released.
void hold(System& system, const std::deque<LoopChoice>& loops, std::vector<NearDependency>& told) {
  const auto first = std::ranges::find_if(told, &NearDependency::held);
  if (first == told.end()) return;
  std::vector<NamedRow> all;
  std::vector<std::string> links;
  std::string kept;
  double smallest = 1;  // of the pivots of those that stay
  for (const LoopChoice& loop : loops) {
    const LoopChoice::Choice one = loop.above(loop.released ? kNearlyDependent : kDependent);
    smallest = std::min(smallest, one.smallest);
    if (loop.released) continue;  // left out already
    all.insert(all.end(), one.gone.begin(), one.gone.end());
    if (!one.gone.empty()) loop.add_links(links);
    if (kept.empty()) kept = one.kept;
  }
  if (!kept.empty()) {
    for (NearDependency& d : told)
      if (d.held()) d.decided = false, d.undecided = "among exactly redundant constraints, " + kept;
    return;
  }
  leave_out(system, all);
  system.hold_down_to(smallest);
  first->left_out = names_of(all);  // the first reports them all
  for (const std::string& link : links) add_name(link, first->links);
}

}  // namespace

std::vector<NearDependency> decide_nearly_redundant(System& system, Dynamics& dynamics, const State& given,
                                                    NearlyRedundant asked) {
  const State state = dynamics.in_slots(given);
  take_back(system);
  std::vector<NearDependency> told;
  if (!has_loops(system, state.modes)) return told;
  std::deque<LoopChoice> loops;
  {
    const AtEnd back([&] { take_back(system); });
    release_drives(system);  // they hold what is free, so nothing would be nearly dependent with them
    const RowTable& table = dynamics.gather_rows(state).rows();
    for (const std::vector<int>& entries : loops_of(system, table))
      if (const LoopRows rows(system, table, entries); rows.n() <= kDenseRows) loops.emplace_back(system, table, rows);
  }
  std::vector<NearSet> all = nearly_dependent(loops, dynamics.inputs(state), system.length());
  if (all.empty()) return told;
  const bool decides =
      asked != NearlyRedundant::reported && (asked != NearlyRedundant::automatic || are_few_rows(system, state.modes));
  try_out(system, dynamics, state, all);
  const std::string advice = odd_axis(dynamics, state);
  std::vector<NamedRow> gone;
  for (NearSet& f : all) {
    const bool persists = f.told.undecided.empty() && !f.told.in_passing, frees = persists && f.told.needed.empty();
    if (asked == NearlyRedundant::free && persists) f.told.undecided = f.told.needed;
    f.told.decided = decides && persists && f.told.undecided.empty();
    f.told.free = f.told.decided && frees && asked != NearlyRedundant::held;
    if (f.told.free) {
      gone.insert(gone.end(), f.gone.begin(), f.gone.end());
      f.told.left_out = names_of(f.gone), f.of->released = true;
    }
    f.told.advice = advice;
    told.push_back(f.told);
  }
  leave_out(system, gone);
  hold(system, loops, told);
  system.setup();
  return told;
}

}  // namespace lockstep
