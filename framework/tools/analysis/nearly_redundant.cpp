// What rows hold that nearly depend on others: found, tried, and decided where that is asked for.
#include <algorithm>
#include <utility>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/analysis/dependency.h"
#include "framework/tools/analysis/left_out_rows.h"
#include "framework/tools/analysis/row_choice.h"

namespace lockstep {
namespace {

constexpr int kMostOnLoops = 300;   // rows on common loops
constexpr double kPersists = 1e-3;  // of the length: rows that are violated by less nearly depend everywhere

/// Rows on common loops of which some nearly depend on others, and what to do with them. All that depend go, exactly or
/// nearly: those that do exactly here do so nearly when it has moved.
struct NearSet {
  NearDependency told;
  Choice free;
};

/// Calls visit(rows) for each group of rows on common loops that is not too large.
template <class Visit>
void for_each_loop(const System& system, const RowTable& table, Visit&& visit) {
  for (const std::vector<int>& entries : loops_of(system, table)) {
    const LoopRows rows(system, table, entries);
    if (rows.n() <= kMostOnLoops) visit(rows);
  }
}

std::vector<NearSet> nearly_dependent(const System& system, const RowTable& table) {
  std::vector<NearSet> all;
  for_each_loop(system, table, [&](const LoopRows& rows) {
    const Dependencies found = find_dependencies(rows);
    NearSet one;
    for (const DependentRows& set : found.sets) {
      if (set.nearly == 0) continue;
      for (const int row : set.rows) {
        const RowEntry& e = entry_of_row(table, rows.number(row));
        const Lock& link = *system.links()[static_cast<std::size_t>(e.link)];
        one.told.rows.push_back(name_of_row(system, table, rows.number(row)));
        if (one.told.undecided.empty())
          one.told.undecided = keeper_of(link, e.own[static_cast<std::size_t>(rows.number(row) - e.first_row)]);
      }
      one.told.nearly += set.nearly, one.told.singular_value = std::max(one.told.singular_value, set.pivot);
    }
    if (one.told.nearly == 0) return;
    one.free = choose_rows(system, table, rows, kNearlyDependent);
    one.told.links = one.free.links;
    if (one.told.undecided.empty()) one.told.undecided = one.free.kept;
    all.push_back(std::move(one));
  });
  return all;
}

/// Rows that depend on others exactly, and the smallest pivot of those that stay.
Choice exactly_dependent(const System& system, const RowTable& table) {
  Choice all;
  for_each_loop(system, table, [&](const LoopRows& rows) {
    Choice one = choose_rows(system, table, rows, kDependent);
    all.smallest = std::min(all.smallest, one.smallest);
    all.gone.insert(all.gone.end(), one.gone.begin(), one.gone.end());
    all.links.insert(all.links.end(), one.links.begin(), one.links.end());
    if (all.kept.empty()) all.kept = one.kept;
  });
  return all;
}

std::vector<std::string> names_of(const std::vector<OwnRow>& rows) {
  std::vector<std::string> names;
  for (const OwnRow& row : rows) names.push_back(row.link->name() + "." + row.link->row_name(row.own));
  return names;
}

/// Which of them nearly depend in this position only: without them, what they held leads away from them.
void try_out(System& system, Dynamics& dynamics, const State& state, std::vector<NearSet>& all) {
  std::vector<OwnRow> gone;
  for (const NearSet& f : all)
    if (f.told.undecided.empty()) gone.insert(gone.end(), f.free.gone.begin(), f.free.gone.end());
  if (gone.empty()) return;
  const LeftOutForNow for_now(system, gone);
  LeftOutTrial trial(system, dynamics, state);
  for (NearSet& f : all) {
    if (!f.told.undecided.empty()) continue;
    for (const OwnRow& row : f.free.gone) f.told.violation = std::max(f.told.violation, trial.along(row, gone));
    f.told.in_passing = !(f.told.violation < kPersists * system.length());
  }
}

// Rows that depend exactly go, of the whole mechanism, and the rest is held.
void hold(System& system, const RowTable& table, std::vector<NearDependency>& told) {
  const auto first = std::ranges::find(told, true, &NearDependency::decided);
  if (first == told.end()) return;
  const Choice exact = exactly_dependent(system, table);
  if (!exact.kept.empty()) {
    for (NearDependency& d : told)
      if (d.decided) d.decided = false, d.undecided = "of rows that depend on others exactly, " + exact.kept;
    return;
  }
  leave_out(system, exact.gone);
  system.hold_down_to(exact.smallest);
  first->left_out = names_of(exact.gone);  // the first tells them all
  for (const std::string& link : exact.links) add_name(link, first->links);
}

}  // namespace

std::vector<NearDependency> decide_nearly_redundant(System& system, Dynamics& dynamics, const State& given,
                                                    NearlyRedundant asked) {
  State state = given;
  dynamics.to_slots(state);
  take_back(system);
  std::vector<NearDependency> told;
  if (!has_loops(system, state.modes)) return told;
  const RowTable table = dynamics.gather_rows(state).rows();
  std::vector<NearSet> all = nearly_dependent(system, table);
  if (all.empty()) return told;
  const NearlyRedundant choice = asked != NearlyRedundant::automatic ? asked
                                 : are_few_rows(system, state.modes) ? NearlyRedundant::held
                                                                     : NearlyRedundant::told;
  try_out(system, dynamics, state, all);
  std::vector<OwnRow> gone;
  for (NearSet& f : all) {
    f.told.decided = choice != NearlyRedundant::told && f.told.undecided.empty() && !f.told.in_passing;
    if (f.told.decided && choice == NearlyRedundant::free) {
      gone.insert(gone.end(), f.free.gone.begin(), f.free.gone.end());
      f.told.left_out = names_of(f.free.gone);
    }
    told.push_back(f.told);
  }
  leave_out(system, gone);
  if (choice == NearlyRedundant::held) hold(system, table, told);
  system.setup();
  return told;
}

}  // namespace lockstep
