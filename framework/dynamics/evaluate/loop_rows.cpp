// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/evaluate/loop_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

// At a slot that two groups share, what the rows of one of them carry is balanced within it, since it does not reach the
// ground otherwise.
std::vector<std::vector<int>> loops_of(const System& system, const RowTable& table) {
  std::vector<std::vector<int>> groups;
  std::vector<std::pair<int, int>> edges;  // each two slots that an entry joins
  std::vector<int> entry_of_edge;
  for (std::size_t k = 0; k < table.entries.size(); ++k) {
    const std::vector<int> ends = ends_of(system, *system.links()[table.entries[k].link]);
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

std::vector<std::vector<int>> closed_loops(const System& system, const RowTable& table) {
  std::vector<std::vector<int>> loops = loops_of(system, table);
  std::erase_if(loops, [&](const std::vector<int>& group) {
    return group.empty() ||
           (group.size() == 1 && system.links()[table.entries[group.front()].link]->jointed() != nullptr);
  });
  return loops;
}

namespace {

// Half of the farthest between two joints of one body that moves, m; the length of the system if it has one joint each.
double length_of_loop(const System& system, const RowTable& table, const std::vector<int>& entries) {
  std::map<int, Eigen::AlignedBox3d> joints;
  for (const int at : entries)
    for (const auto& [p, s] : system.links()[table.entries[at].link]->pairs())
      for (const Marker* marker : {p, s})
        if (const Body& body = *marker->body; body.slot != kGround)
          joints[body.slot].extend((body.in_slot * marker->local).x);
  double length = 0;
  for (const auto& [slot, box] : joints) length = std::max(length, 0.5 * box.diagonal().norm());
  return length > kNegligible * system.length() ? length : system.length();
}

}  // namespace

SparseMat rows_of_loop(const System& system, const RowTable& table, const std::vector<int>& entries) {
  const double length = length_of_loop(system, table, entries);
  std::map<int, std::pair<int, double>> slots;  // where its unknowns begin, and its length
  std::vector<Eigen::Triplet<double>> numbers;
  int row = 0;
  for (const int at : entries) {
    const RowEntry& e = table.entries[at];
    for (int k = 0; k < e.m; ++k, ++row)
      for (int i = 0; i < e.slots.n; ++i) {
        const Slot& slot = system.slot(e.slots[i]);
        const auto [first, L] = slots
                                    .try_emplace(e.slots[i], 6 * static_cast<int>(slots.size()),
                                                 std::max(length, std::sqrt(slot.J.trace() / (2 * slot.mass))))
                                    .first->second;
        const std::array<double, 6> J = table.block(e).J(i, k);
        for (int j = 0; j < (slot.freedoms == Freedoms::particle ? 3 : 6); ++j)
          numbers.emplace_back(first + j, row, j < 3 ? J[j] : J[j] / L);
      }
  }
  SparseMat Jt(6 * static_cast<Eigen::Index>(slots.size()), row);
  Jt.setFromTriplets(numbers.begin(), numbers.end());
  return Jt;
}

}  // namespace lockstep
