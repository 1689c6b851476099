// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// A column that was asked for.
struct Wanted {
  std::size_t k;
  std::string unit;  // "mm"; empty: SI
};

// `bare`: gets the name of a column without a unit.
Wanted wanted_of(const CsvReader& lines, const std::string& name, std::vector<std::string>& bare) {
  const std::size_t k = lines.find(name);
  const std::string& unit = lines.columns()[k].unit;
  if (unit.empty()) bare.push_back(name);
  if (unit.empty() || unit == "-") return {k, {}};
  const Measured one = in_si(1, unit);
  if (!one.problem.empty()) lines.refuse("column '" + lines.columns()[k].name + "': " + one.problem);
  return {k, one.value == 1 ? "" : unit};
}

double number_of(CsvReader& lines, const std::vector<std::string>& cells, const Wanted& w) {
  double value = 0;
  const std::string& cell = cells[w.k];
  lines.refuse_both_signs(cells, w.k);
  if (!lines.number(cell, value) || !std::isfinite(value))
    lines.refuse("column " + std::to_string(w.k + 1) + ", '" + cell + "' is not a finite number" +
                 (cell.find(',') != std::string::npos && lines.separator() == ','
                      ? "; the decimal separator is a point, or cells are separated by semicolons"
                      : ""));
  if (w.unit.empty()) return value;
  const Measured si = in_si(value, w.unit);
  if (!si.problem.empty()) lines.refuse("column " + std::to_string(w.k + 1) + ": " + si.problem);
  return si.value;
}

}  // namespace

Columns columns_of(const std::vector<std::vector<double>>& rows, std::size_t n_y) {
  Columns table;
  table.y.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(n_y));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.t.push_back(rows[i][0]);
    for (std::size_t j = 0; j < n_y; ++j)
      table.y(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j + 1];
  }
  return table;
}

Columns read_columns(const std::string& path, const std::string& t_column, const std::vector<std::string>& y_columns) {
  CsvReader lines(path);
  std::vector<std::string> bare;
  std::vector<Wanted> wanted{wanted_of(lines, t_column, bare)};
  for (const std::string& name : y_columns) wanted.push_back(wanted_of(lines, name, bare));
  if (!bare.empty())
    report_finding({&finding::units_assumed, "",
                    path + ": the first line has no unit for " + text::join(bare) + ", so SI is assumed",
                    "write units in brackets, as in \"time [ms],torque [N mm]\""});

  std::vector<std::vector<double>> rows;
  for (std::vector<std::string> cells; lines.next(cells);) {
    std::vector<double> row;
    for (const Wanted& w : wanted) row.push_back(number_of(lines, cells, w));
    if (!rows.empty() && row[0] <= rows.back()[0])
      lines.refuse("time " + text::number(row[0]) + " does not come after " + text::number(rows.back()[0]) +
                   "; sort the rows by time");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw FileError(path + ": has no rows of numbers");
  return columns_of(rows, y_columns.size());
}

}  // namespace lockstep
