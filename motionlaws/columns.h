// Columns of a CSV file, for the laws that go through measured or computed points.
#pragma once

#include <string>
#include <vector>

#include "framework/foundation/math/types.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// The column of times and the asked columns, one row a line of the file.
struct Columns {
  std::vector<double> t;
  MatX y;
};

/// Reads `t_column` and `y_columns` of the file at `path`. A column is named by the header's word before any "[unit]",
/// or by its number from 1. Cells are separated by commas or semicolons; blank lines and lines that start with # are
/// skipped; a file whose first line holds numbers only has no header. Numbers are SI with a point, whatever the locale.
/// Throws FileError naming file and line: no such file, no such column, a cell that is no finite number, times that do
/// not rise.
LOCKSTEP_API Columns read_columns(const std::string& path, const std::string& t_column,
                                  const std::vector<std::string>& y_columns);

}  // namespace lockstep
