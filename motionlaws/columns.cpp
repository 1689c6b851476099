#include <lockstep/splines.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr std::string_view kAround = " \t\r\"";  // a cell

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t from = 0;;) {
    const std::size_t to = line.find_first_of(",;", from);
    cells.push_back(text::trimmed(line.substr(from, to - from), kAround));
    if (to == std::string_view::npos) return cells;
    from = to + 1;
  }
}

bool parse(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

bool all_numbers(const std::vector<std::string_view>& cells) {
  double ignored = 0;
  for (const auto cell : cells)
    if (!parse(cell, ignored)) return false;
  return true;
}

// The name of a column: x for "x [m]".
std::string name_of(std::string_view cell) {
  return std::string(text::trimmed(cell.substr(0, cell.find('[')), kAround));
}

std::size_t column_of(const std::string& wanted, const std::vector<std::string>& names, std::size_t n_columns,
                      const std::string& place) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == wanted) return i;
  std::size_t k = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), k);
  if (error == std::errc{} && end == wanted.data() + wanted.size() && k >= 1 && k <= n_columns) return k - 1;
  throw FileError(
      place + ": no column '" + wanted + "' among " + std::to_string(n_columns) +
      (names.empty() ? "; the file has no header, name columns by number" : text::suggestion(wanted, names)));
}

}  // namespace

Columns read_columns(const std::string& path, const std::string& t_column, const std::vector<std::string>& y_columns) {
  std::ifstream file(path);
  if (!file) throw FileError(path + ": cannot be opened; check the path, relative ones start at the scene's folder");
  std::vector<std::size_t> columns;  // of t, then of y
  std::vector<std::vector<double>> rows;
  std::string line;
  for (int n = 1; std::getline(file, line); ++n) {
    if (const std::string_view shown = text::trimmed(line, kAround); shown.empty() || shown.front() == '#') continue;
    const std::string place = path + ":" + std::to_string(n);
    const auto cells = cells_of(line);
    if (columns.empty()) {
      std::vector<std::string> names;
      const bool header = !all_numbers(cells);
      if (header)
        for (const auto cell : cells) names.push_back(name_of(cell));
      columns.push_back(column_of(t_column, names, cells.size(), place));
      for (const auto& wanted : y_columns) columns.push_back(column_of(wanted, names, cells.size(), place));
      if (header) continue;
    }
    std::vector<double> row;
    for (const std::size_t k : columns) {
      double value = 0;
      if (k >= cells.size())
        throw FileError(place + ": has " + std::to_string(cells.size()) + " cells; column " + std::to_string(k + 1) +
                        " is missing");
      if (!parse(cells[k], value))
        throw FileError(place + ": column " + std::to_string(k + 1) + ", '" + std::string(cells[k]) +
                        "' is not a finite number");
      row.push_back(value);
    }
    if (!rows.empty() && row[0] <= rows.back()[0])
      throw FileError(place + ": time " + text::number(row[0]) + " does not come after " +
                      text::number(rows.back()[0]) + "; sort the rows by time");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw FileError(path + ": has no rows of numbers");
  Columns table;
  table.y.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(y_columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.t.push_back(rows[i][0]);
    for (std::size_t j = 1; j < rows[i].size(); ++j)
      table.y(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j) - 1) = rows[i][j];
  }
  return table;
}

}  // namespace lockstep
