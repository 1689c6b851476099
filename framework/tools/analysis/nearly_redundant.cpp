// What rows hold that nearly depend on others.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/analysis/dependency.h"
#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {
namespace {

constexpr int kMostRows = 300;      // on common loops
constexpr double kStep = 0.05;      // rad
constexpr int kSteps = 6;           // along what the rows held
constexpr double kPersists = 1e-3;  // of the length: rows that are violated by less nearly depend everywhere
constexpr double kMoves = 1e-11;    // of a response: a row with less holds nothing that others do not hold

/// A row of the table, by its link and its number there.
struct OwnRow {
  const Lock* link = nullptr;
  int own = 0;
  double length = 1;  ///< of the row in lengths
  VecX J;             ///< 6 per slot
};

/// Rows on common loops: those that stay are independent, and others go.
struct Choice {
  std::vector<OwnRow> gone;
  std::vector<std::string> links;  ///< on loops with such rows
  double smallest = 1;             ///< pivot of those that stay
  std::string kept;                ///< what keeps a row of `gone` from being left out; "" for nothing
};

/// Rows on common loops of which some nearly depend on others, and what to do with them. All that depend go, exactly or
/// nearly: those that do exactly here do so nearly when it has moved.
struct NearSet {
  NearDependency told;
  Choice free;
};

VecX column_of(const LoopRows& rows, int row) {
  VecX out = VecX::Zero(rows.n_columns());
  for (const auto& t : rows.Jt())
    if (t.col() == row) out[t.row()] = t.value();
  return out;
}

// What keeps a row from being left out; "" for nothing.
std::string keeper_of(const Lock& link, int own) {
  constexpr unsigned kOfMarkers = with::uP | with::qP | with::uS | with::qS;
  const std::string law = "a law is among them";
  if (link.unilateral() != nullptr) return "a one-sided link is among them";
  if (link.jointed() == nullptr) return "a link is among them that is no joint";
  if (link.row(own).drive >= 0 || (link.pattern().laws & kOfMarkers) != 0) return law;
  const ImposedMotion& imposed = link.jointed()->imposed();
  const bool along = link.row_kind(own) == RowKind::translation;
  return (along ? imposed.move != nullptr : imposed.turn != nullptr) ? law : "";
}

void add_name(const std::string& name, std::vector<std::string>& names) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

VecX jacobian_of(const System& system, const RowTable& table, const RowEntry& e, int k) {
  VecX out = VecX::Zero(6 * system.n_slots());
  for (int i = 0; i < e.slots.n; ++i) {
    const std::array<double, 6> r = table.block(e).J(i, k);
    out.segment<6>(6 * e.slots[i]) = Eigen::Map<const Vec6>(r.data());
  }
  return out;
}

/// Gram and Schmidt: the next row that stays is the first, in the order of the links, of which others leave at least half
/// of the most; rows with laws, and others that are kept, go first as long as they are a tenth of the most. Ends where no
/// row is left above `limit`.
class Selection {
 public:
  Selection(const System& system, const RowTable& table, const LoopRows& rows)
      : system_(system), table_(table), rows_(rows), which_(static_cast<std::size_t>(rows.n())) {
    std::iota(which_.begin(), which_.end(), 0);
    std::ranges::sort(which_, {}, [&](int row) { return place(row); });
    for (const int row : which_) left_.push_back(column_of(rows_, row)), keeper_.push_back(keeper(row));
  }

  Choice above(double limit) {
    Choice out;
    std::vector<bool> stays(which_.size(), false);
    for (int next = best(limit, stays); next >= 0; next = best(limit, stays)) {
      const auto n = static_cast<std::size_t>(next);
      stays[n] = true;
      out.smallest = std::min(out.smallest, left_[n].norm());
      const VecX direction = left_[n].normalized();
      for (VecX& v : left_) v -= direction.dot(v) * direction;
      for (VecX& v : left_) v -= direction.dot(v) * direction;  // once more: what rounding left
    }
    for (std::size_t k = 0; k < which_.size(); ++k) {
      if (stays[k]) continue;
      out.gone.push_back(own_row(which_[k]));
      if (out.kept.empty()) out.kept = keeper_[k];
    }
    if (!out.gone.empty())
      for (const int row : which_) add_name(link(row).name(), out.links);
    return out;
  }

 private:
  const RowEntry& entry(int row) const { return entry_of_row(table_, rows_.number(row)); }
  std::pair<int, int> place(int row) const { return {entry(row).link, rows_.number(row)}; }
  const Lock& link(int row) const { return *system_.links()[static_cast<std::size_t>(entry(row).link)]; }

  std::string keeper(int row) const {
    const RowEntry& e = entry(row);
    return keeper_of(link(row), e.own[static_cast<std::size_t>(rows_.number(row) - e.first_row)]);
  }
  OwnRow own_row(int row) const {
    const RowEntry& e = entry(row);
    const int k = rows_.number(row) - e.first_row;
    return {&link(row), e.own[static_cast<std::size_t>(k)], rows_.length(row), jacobian_of(system_, table_, e, k)};
  }

  int best(double limit, const std::vector<bool>& stays) const {
    double most = 0, most_kept = 0;
    for (std::size_t k = 0; k < which_.size(); ++k) {
      if (stays[k]) continue;
      most = std::max(most, left_[k].norm());
      if (!keeper_[k].empty()) most_kept = std::max(most_kept, left_[k].norm());
    }
    if (!(most > limit)) return -1;
    const bool kept = most_kept > std::max(limit, 0.1 * most);
    for (std::size_t k = 0; k < which_.size(); ++k)
      if (!stays[k] && (!keeper_[k].empty() || !kept) && left_[k].norm() >= 0.5 * (kept ? most_kept : most))
        return static_cast<int>(k);
    return -1;
  }

  const System& system_;
  const RowTable& table_;
  const LoopRows& rows_;
  std::vector<int> which_;
  std::vector<VecX> left_;           // of each row, what those that stay do not hold
  std::vector<std::string> keeper_;  // of each row, what keeps it
};

void leave_out(System& system, const std::vector<OwnRow>& rows) {
  system.setup();
  for (const OwnRow& row : rows) system.leave_out(*row.link, system.left_out(*row.link) | 1U << row.own);
}

void take_back(System& system) {
  system.setup();
  for (const auto& link : system.links())
    if (system.left_out(*link) != 0) system.leave_out(*link, 0);
  if (system.held_down_to() > 0) system.hold_down_to(0);
  system.setup();
}

/// Rows that are left out as long as it lives.
class LeftOutForNow {
 public:
  LeftOutForNow(System& system, const std::vector<OwnRow>& rows) : system_(system) {
    leave_out(system, rows);
    system.setup();
  }
  LeftOutForNow(const LeftOutForNow&) = delete;
  LeftOutForNow& operator=(const LeftOutForNow&) = delete;
  ~LeftOutForNow() { take_back(system_); }  // it was set up before with all rows: that does not throw

 private:
  System& system_;
};

/// C of a row, in lengths.
double violation_of(const OwnRow& row, const Inputs& in, RowTable& room) {
  const RowShape shape = row.link->shape();
  const Lock* const link = row.link;
  link->gather(Group(&link, 1), in, room.spatial_span(shape));
  return std::abs(room.spatial(shape).C(row.own)) / row.length;
}

VecX momentum_of(const System& system, const VecX& v) {
  VecX out = v;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Slot& s = system.slot(k);
    out.segment<3>(6 * k) = s.mass * v.segment<3>(6 * k);
    out.segment<3>(6 * k + 3) = s.J * v.segment<3>(6 * k + 3);
  }
  return out;
}

/// Motions that rows which hold no more allow, followed for some way.
class Trial {
 public:
  Trial(System& system, Dynamics& dynamics, const State& state) : system_(system), dynamics_(dynamics), start_(state) {}

  /// The largest violation of `rows`, m, where what this row held moves on.
  double along(const OwnRow& row, const std::vector<OwnRow>& rows) {
    State at = start_;
    RowTable room;
    double most = 0;
    VecX way = allowed(at, row.J);
    if (size_of(way) <= kMoves * size_of(response_)) return 0;
    for (int k = 0; k < kSteps; ++k) {
      try {
        dynamics_.advance(at, kStep, way / size_of(way));
        dynamics_.project(at);
        const Inputs& in = dynamics_.gather(at).inputs();
        for (const OwnRow& r : rows) most = std::max(most, violation_of(r, in, room));
        way = allowed(at, momentum_of(system_, way));
      } catch (const Error&) {
        return k > 1 ? most : HUGE_VAL;  // it comes to an end of its way
      }
      if (!(size_of(way) > 0)) return most;
    }
    return most;
  }

 private:
  /// What a force moves, as the rows allow.
  VecX allowed(const State& state, const VecX& force) {
    const Evaluation& e = dynamics_.gather(state);
    Factor& factor = dynamics_.factor(e);
    VecX a, lambda;
    factor.solve(e, force, VecX::Zero(e.rows().n_rows), a, lambda);
    response_ = a;
    response_.setZero();
    for (int k = 0; k < system_.n_slots(); ++k) {
      const Slot& s = system_.slot(k);
      response_.segment<3>(6 * k) = force.segment<3>(6 * k) / s.mass;
      if (s.freedoms == Freedoms::spatial)
        response_.segment<3>(6 * k + 3) = s.J.ldlt().solve(force.segment<3>(6 * k + 3));
    }
    return a;
  }
  double size_of(const VecX& v) const {
    double most = 0;
    for (Eigen::Index i = 0; i < v.size(); i += 6)
      most = std::max({most, v.segment<3>(i).norm() / system_.length(), v.segment<3>(i + 3).norm()});
    return most;
  }

  System& system_;
  Dynamics& dynamics_;
  const State& start_;
  VecX response_;
};

/// Calls visit(rows, dependencies) for the rows on common loops.
template <class Visit>
void for_each_loop(const System& system, const RowTable& table, Visit&& visit) {
  for (const std::vector<int>& entries : loops_of(system, table)) {
    const LoopRows rows(system, table, entries);
    if (rows.n() <= kMostRows) visit(rows, find_dependencies(rows.n_columns(), rows.n(), rows.Jt()));
  }
}

std::vector<NearSet> nearly_dependent(const System& system, const RowTable& table) {
  std::vector<NearSet> all;
  for_each_loop(system, table, [&](const LoopRows& rows, const Dependencies& found) {
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
    one.free = Selection(system, table, rows).above(kNearlyDependent);
    one.told.links = one.free.links;
    if (one.told.undecided.empty()) one.told.undecided = one.free.kept;
    all.push_back(std::move(one));
  });
  return all;
}

/// Rows that depend on others exactly, and the smallest pivot of those that stay.
Choice exactly_dependent(const System& system, const RowTable& table) {
  Choice all;
  for_each_loop(system, table, [&](const LoopRows& rows, const Dependencies&) {
    Choice one = Selection(system, table, rows).above(kDependent);
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
  Trial trial(system, dynamics, state);
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
                                                    NearlyRedundant choice) {
  State state = given;
  dynamics.to_slots(state);
  take_back(system);
  std::vector<NearDependency> told;
  if (!has_loops(system, state.modes)) return told;
  const RowTable table = dynamics.gather(state).rows();
  std::vector<NearSet> all = nearly_dependent(system, table);
  if (all.empty()) return told;
  try_out(system, dynamics, state, all);
  for (NearSet& f : all) {
    f.told.decided = choice != NearlyRedundant::told && f.told.undecided.empty() && !f.told.in_passing;
    if (f.told.decided && choice == NearlyRedundant::free) {
      leave_out(system, f.free.gone);
      f.told.left_out = names_of(f.free.gone);
    }
    told.push_back(f.told);
  }
  if (choice == NearlyRedundant::held) hold(system, table, told);
  system.setup();
  return told;
}

}  // namespace lockstep
