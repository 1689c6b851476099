// SPDX-License-Identifier: BSD-3-Clause
// Rows that are taken out of a table of closures.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <lockstep/detail/rows.h>

namespace lockstep {

/// Leaves the rows of an entry that are not absent; returns whether all are there.
inline bool keep_present(unsigned absent, RowEntry& e) {
  int kept = 0;
  for (int k = 0; k < e.m; ++k)
    if ((absent >> k & 1U) == 0) {
      e.own[kept] = e.own[k];
      e.kind[kept++] = e.kind[k];
    }
  if (kept == e.m) return true;
  e.m = kept, e.layout = RowLayout::dense;
  return false;
}

/// Takes rows out of a table of a mechanism in space, not in a plane by name: `absent`, a bit for each row of an entry. Links that lose some are
/// gathered by themselves.
inline void take_out(std::span<const unsigned> absent, RowTable& table) {
  std::vector<RowEntry> entries;
  std::vector<RowRun> runs;
  table.entry_of_link.assign(table.entry_of_link.size(), -1);
  for (const RowRun& run : table.runs) {
    bool together = false;  // with the entry before
    for (int i = 0; i < run.n; ++i) {
      const auto at = static_cast<std::size_t>(run.first_entry + i);
      RowEntry e = table.entries[at];
      const bool whole = keep_present(absent[at], e);
      if (together && whole)
        ++runs.back().n;
      else if (e.m > 0)
        runs.push_back({static_cast<int>(entries.size()), 1, run.first_link + i, false, run.in_parts || !whole});
      together = whole;
      if (e.m == 0) continue;
      table.entry_of_link[e.link] = static_cast<int>(entries.size());
      entries.push_back(e);
    }
  }
  table.entries = std::move(entries), table.runs = std::move(runs);
  table.lay_out();
}

}  // namespace lockstep
