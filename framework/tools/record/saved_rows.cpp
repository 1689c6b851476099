// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/saved_rows.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>

namespace lockstep {

void save_rows(const Table& table, Snapshot& out) {
  out.put(static_cast<double>(table.n_columns()));
  for (const Column& c : table.columns()) out.put_text(column_title(c));
  out.put(static_cast<double>(table.n_rows()));
  for (std::size_t i = 0; i < table.n_rows(); ++i)
    for (const Column& c : table.columns()) out.put(c.values[i]);
}

void load_rows(Table& table, SnapshotReader& in) {
  const long n = in.get_count();
  if (n != static_cast<long>(table.n_columns()))
    throw ModelError(
        fmt::format("the run was saved with {} columns and records {}; ask for the same", n, table.n_columns()));
  for (const Column& c : table.columns())
    if (const std::string title = in.get_text(), own = column_title(c); title != own)
      throw ModelError(fmt::format(
          "the run was saved with the column \"{}\" where it records \"{}\" now; ask for the same", title, own));
  table.clear_rows();
  std::vector<double> row(table.n_columns());
  for (long left = in.get_count(); left > 0; --left) {
    for (double& x : row) x = in.get();
    table.add_row(row);
  }
}

}  // namespace lockstep
