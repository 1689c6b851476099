#include "framework/tools/analysis/row_choice.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace lockstep {
namespace {

VecX jacobian_of(const System& system, const RowTable& table, const RowEntry& e, int k) {
  VecX out = VecX::Zero(6 * system.n_slots());
  for (int i = 0; i < e.slots.n; ++i) {
    const std::array<double, 6> r = table.block(e).J(i, k);
    out.segment<6>(6 * e.slots[i]) = Eigen::Map<const Vec6>(r.data());
  }
  return out;
}

/// Gram and Schmidt.
class Selection {
 public:
  Selection(const System& system, const RowTable& table, const LoopRows& rows)
      : system_(system), table_(table), rows_(rows), which_(static_cast<std::size_t>(rows.n())) {
    std::iota(which_.begin(), which_.end(), 0);
    std::ranges::sort(which_, {}, [&](int row) { return place(row); });
    const MatX Jt = rows_.matrix();
    for (const int row : which_) left_.push_back(Jt.col(row)), keeper_.push_back(keeper(row));
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

}  // namespace

Choice choose_rows(const System& system, const RowTable& table, const LoopRows& rows, double limit) {
  return Selection(system, table, rows).above(limit);
}

std::string keeper_of(const Lock& link, int own) {
  constexpr unsigned kOfMarkers = with::uP | with::qP | with::uS | with::qS;
  const std::string law = "a law is among them";
  if (link.unilateral() != nullptr) return "a one-sided link is among them";
  if (link.jointed() == nullptr) return "a link is among them that is no joint";
  if (link.row(own).drive >= 0 || (link.pattern().laws & kOfMarkers) != 0) return law;
  const ImposedMotion& imposed = link.jointed()->imposed();
  const bool along = link.row_kind(own) == RowKind::translation;
  return imposed.hold || (along ? imposed.move != nullptr : imposed.turn != nullptr) ? law : "";
}

void add_name(const std::string& name, std::vector<std::string>& names) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

}  // namespace lockstep
