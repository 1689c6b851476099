#include "framework/tools/analysis/loop_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

// At a slot that two groups share, what the rows of one of them carry is balanced within it, since it does not reach the
// ground otherwise.
std::vector<std::vector<int>> loops_of(const System& system, const RowTable& table) {
  std::vector<std::vector<int>> groups;
  std::vector<std::pair<int, int>> edges;  // each two slots that an entry joins
  std::vector<int> entry_of_edge;
  for (std::size_t k = 0; k < table.entries.size(); ++k) {
    const std::vector<int> ends = ends_of(system, *system.links()[static_cast<std::size_t>(table.entries[k].link)]);
    if (ends.size() < 2) groups.push_back({static_cast<int>(k)});  // its rows touch nothing that moves
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = i + 1; j < ends.size(); ++j)
        edges.emplace_back(ends[i], ends[j]), entry_of_edge.push_back(static_cast<int>(k));
  }
  const std::vector<std::size_t> component = loop_groups(system.n_slots(), edges);
  const std::size_t first = groups.size();
  if (!component.empty()) groups.resize(first + *std::ranges::max_element(component) + 1);
  for (std::size_t n = 0; n < edges.size(); ++n) {
    std::vector<int>& group = groups[first + component[n]];
    if (group.empty() || group.back() != entry_of_edge[n]) group.push_back(entry_of_edge[n]);
  }
  return groups;
}

LoopRows::LoopRows(const System& system, const RowTable& table, const std::vector<int>& entries) {
  for (const int k : entries) add(system, table, table.entries[static_cast<std::size_t>(k)]);
  for (double& length : length_) length = std::sqrt(length);
  for (auto& t : Jt_)
    if (const double length = length_[static_cast<std::size_t>(t.col())]; length > 0)
      t = {t.row(), t.col(), t.value() / length};
}

MatX LoopRows::matrix() const {
  MatX out = MatX::Zero(n_columns(), n());
  for (const auto& t : Jt_) out(t.row(), t.col()) += t.value();
  return out;
}

void LoopRows::add(const System& system, const RowTable& table, const RowEntry& e) {
  const RowView block = table.block(e);
  for (int k = 0; k < e.m; ++k) {
    const int row = n();
    numbers_.push_back(e.first_row + k), length_.push_back(0);
    for (int i = 0; i < e.slots.n; ++i) {
      const int first = 6 * first_.try_emplace(e.slots[i], static_cast<int>(first_.size())).first->second;
      const bool particle = system.slot(e.slots[i]).freedoms == Freedoms::particle;
      const std::array<double, 6> r = block.J(i, k);
      for (std::size_t c = 0; c < (particle ? 3 : 6); ++c) {
        const double x = c < 3 ? r[c] : r[c] / system.length();
        if (x == 0) continue;
        Jt_.emplace_back(first + static_cast<int>(c), row, x);
        length_.back() += x * x;
      }
    }
  }
}

const RowEntry& entry_of_row(const RowTable& table, int row) {
  return *(std::ranges::upper_bound(table.entries, row, {}, &RowEntry::first_row) - 1);
}

std::string name_of_row(const System& system, const RowTable& table, int row) {
  const RowEntry& e = entry_of_row(table, row);
  const Lock& link = *system.links()[static_cast<std::size_t>(e.link)];
  return link.name() + "." + link.row_name(e.own[static_cast<std::size_t>(row - e.first_row)]);
}

}  // namespace lockstep
