// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/loop_rows.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <lockstep/author/passes.h>

namespace lockstep {

const RowTable& all_rows(const Evaluation& e, const State& state, RowTable& room) {
  const System& system = e.system();
  if (std::ranges::none_of(system.links(), [&](const auto& link) { return system.left_out(*link) != 0; }))
    return e.rows();
  passes::lay_out(system, state.modes, room, true), passes::gather_rows(system, e.inputs(), room);
  return room;
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
    : at(system, slots_on(table, entries)), Jt(rows_of_loop(system, table, entries)) {
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
