// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/loop_rows.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <lockstep/author/passes.h>
#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

const RowTable& all_rows(const Evaluation& e, const State& state, RowTable& room) {
  const System& system = e.system();
  if (std::ranges::none_of(system.links(), [&](const auto& link) { return system.left_out(*link) != 0; }))
    return e.rows();
  passes::lay_out(system, state.modes, room, true), passes::gather_rows(system, e.inputs(), room);
  return room;
}

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

namespace {

std::vector<int> slots_on(const RowTable& table, const std::vector<int>& entries) {
  std::vector<int> slots;
  for (const int at : entries) {
    const SlotList& on = table.entries[at].slots;
    slots.insert(slots.end(), on.slot.begin(), on.slot.begin() + on.n);
  }
  return slots;
}

}  // namespace

LoopRows::LoopRows(const System& system, const RowTable& table, const std::vector<int>& entries)
    : at(system, slots_on(table, entries)), Jt(at.rows_in_lengths(table, entries)) {
  for (const int k : entries) {
    const RowEntry& e = table.entries[k];
    numbers.resize(numbers.size() + static_cast<std::size_t>(e.m));
    std::iota(numbers.end() - e.m, numbers.end(), e.first_row);
  }
}

NamedRow::NamedRow(const System& system, const RowTable& table, int row) {
  const RowEntry& e = *(std::ranges::upper_bound(table.entries, row, {}, &RowEntry::first_row) - 1);
  link = system.links()[e.link].get();
  own = e.own[row - e.first_row];
}

std::string NamedRow::name() const { return link->name() + "." + link->row_name(own); }

std::string NamedRow::drive() const {
  const int number = link->row(own).drive;
  return number < 0 ? "" : link->name() + "." + link->driven()->drive(number).name;
}

bool NamedRow::moves() const {
  const int number = link->row(own).drive;
  if (number < 0 || link->jointed() == nullptr) return number >= 0;
  const Drive& drive = link->jointed()->imposed().drives[number];
  return drive.speed || !drive.law->is_constant();
}

void add_name(const std::string& name, std::vector<std::string>& names) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

}  // namespace lockstep
