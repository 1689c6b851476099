// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include <algorithm>
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

// The unit, other than SI, in which the name of a column seems to end, "time_ms" or "time (ms)"; "" if none. Values are no
// times, and "in" is seldom a unit.
std::string unit_in_name(std::string_view name, bool is_time) {
  name = text::trimmed(name, " )");
  const std::string end(name.substr(std::min(name.find_last_of("_ (") + 1, name.size())));
  if (end.size() == name.size() || end == "in") return {};
  const Measured one = in_si(1, end);
  const bool of_time = read_quantity("1 " + end, Unit::time).problem.empty();
  return one.problem.empty() && one.value != 1 && of_time == is_time ? end : "";
}

// `bare`: gets the name of a column without a unit.
Wanted wanted_of(const CsvReader& lines, const std::string& path, const std::string& name, bool is_time,
                 std::vector<std::string>& bare) {
  const std::size_t k = lines.find(name);
  const std::string &unit = lines.columns()[k].unit, &shown = lines.columns()[k].name;
  if (const std::string own = unit.empty() ? unit_in_name(shown, is_time) : ""; !own.empty()) {
    report_finding({&finding::units_ignored, "",
                    path + ": column '" + shown + "' is read in SI, although its name ends in \"" + own + "\"",
                    "write the unit in brackets: \"" +
                        std::string(text::trimmed(shown.substr(0, shown.find_last_of("_ (")), " _")) + " [" + own +
                        "]\""});
    return {k, {}};
  }
  if (unit.empty()) bare.push_back(name);
  if (unit.empty() || unit == "-") return {k, {}};
  const Measured one = in_si(1, unit);
  const auto high = std::ranges::find_if(unit, [](unsigned char c) { return c >= 0x80; });
  if (!one.problem.empty() && high != unit.end() && static_cast<unsigned char>(*high) < 0xC2)  // no character begins so
    lines.refuse("the header is not UTF-8; save the file as UTF-8");
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
  std::vector<Wanted> wanted{wanted_of(lines, path, t_column, true, bare)};
  for (const std::string& name : y_columns) wanted.push_back(wanted_of(lines, path, name, false, bare));
  if (!bare.empty())
    report_finding({&finding::units_assumed, "",
                    path + ": the first line has no unit for " + text::join(bare) + ", so SI is assumed",
                    std::string("write units in brackets, as in \"time [ms]") + lines.separator() + "torque [N mm]\""});

  std::vector<std::vector<double>> rows;
  for (std::vector<std::string> cells; lines.next(cells);) {
    std::vector<double> row;
    for (const Wanted& w : wanted) row.push_back(number_of(lines, cells, w));
    if (!rows.empty() && row[0] <= rows.back()[0])
      lines.refuse("column '" + t_column + "': " + text::number(row[0]) + " does not come after " +
                   text::number(rows.back()[0]) + "; sort the rows by this column");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw FileError(path + ": has no rows of numbers");
  return columns_of(rows, y_columns.size());
}

}  // namespace lockstep
