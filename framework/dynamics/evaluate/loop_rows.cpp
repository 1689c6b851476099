// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/evaluate/loop_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include <lockstep/author/passes.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/scales.h"
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

double gyration(const Slot& slot) { return std::sqrt(slot.J.trace() / (2 * slot.mass)); }

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
        const auto [first, L] =
            slots.try_emplace(e.slots[i], 6 * static_cast<int>(slots.size()), std::max(length, gyration(slot)))
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

LoopSizes::LoopSizes(const System& system, const std::vector<bool>& modes)
    : loops_(1), loop_of_(system.links().size()), lengths_(system.n_slots(), 0.0) {  // loops_[0]: of links without rows
  RowTable table;
  passes::lay_out(system, modes, table);
  for (const std::vector<int>& entries : loops_of(system, table)) {
    Loop loop{length_of_loop(system, table, entries), {}};
    for (const int at : entries) {
      const RowEntry& e = table.entries[at];
      for (int i = 0; i < e.slots.n; ++i) loop.slots.push_back(e.slots[i]);
      if (std::size_t& own = loop_of_[e.link]; loops_[own].length < loop.length) own = loops_.size();
    }
    std::ranges::sort(loop.slots);
    loop.slots.erase(std::unique(loop.slots.begin(), loop.slots.end()), loop.slots.end());
    for (const int slot : loop.slots)
      lengths_[slot] = std::max({lengths_[slot], loop.length, gyration(system.slot(slot))});
    loops_.push_back(std::move(loop));
  }
  for (double& length : lengths_)
    if (length == 0) length = system.length();
}

template <class Rounding>
bool LoopSizes::within(const RowTable& table, const VecX& c, Rounding&& rounding) const {
  const Loop* loop = nullptr;  // of the entry before, and most often of the next
  double most = 0;
  return std::ranges::all_of(table.entries, [&](const RowEntry& e) {
    if (const Loop& own = loops_[loop_of_[e.link]]; loop != &own) loop = &own, most = rounding(own);
    for (int k = 0; k < e.m; ++k)
      if (!(length_per_unit(e.kind[k], loop->length) * std::abs(c[e.first_row + k]) <= most)) return false;
    return true;
  });
}

bool LoopSizes::are_met(const RowTable& table, const VecX& C, std::span<const Motion> motions) const {
  return within(table, C, [&](const Loop& loop) {
    double x_max = 0;
    for (const int slot : loop.slots) x_max = std::max(x_max, motions[slot + 1].x.lpNorm<Eigen::Infinity>());
    return position_rounding(loop.length, x_max);
  });
}

bool LoopSizes::are_rates_met(const RowTable& table, const VecX& Cd, std::span<const Motion> motions) const {
  return within(table, Cd, [&](const Loop& loop) {
    double v_max = 0;
    for (const int slot : loop.slots) {
      const Motion& O = motions[slot + 1];
      v_max = std::max({v_max, O.v.lpNorm<Eigen::Infinity>(), loop.length * O.w.lpNorm<Eigen::Infinity>()});
    }
    return velocity_rounding(v_max);
  });
}

}  // namespace lockstep
