#include <lockstep/splines.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// How the cells of a file are written: by its first line. Where semicolons or tabs separate them, a comma is a decimal
// one.
char separator_of(std::string_view line) {
  std::string bare;  // without what stands in quotes
  bool quoted = false;
  for (const char c : line)
    if (c == '"')
      quoted = !quoted;
    else if (!quoted)
      bare += c;
  if (bare.find(';') != std::string::npos) return ';';
  const bool aligned = bare.find(",\t") != std::string::npos || bare.find("\t,") != std::string::npos;
  return bare.find('\t') != std::string::npos && !aligned ? '\t' : ',';
}

bool parse(std::string_view digits, double& value) {
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc{} && end == digits.data() + digits.size();
}

// A column as the header has it: "x [mm]"; without a header its name is empty.
struct CsvColumn {
  std::string name, unit;  // unit: empty where numbers are SI
};

CsvColumn column_of(const std::string& cell) {
  const auto open = cell.find('[');
  if (open == std::string::npos || cell.back() != ']') return {cell, {}};
  const std::string unit(text::trimmed(std::string_view(cell).substr(open + 1, cell.size() - open - 2)));
  return {std::string(text::trimmed(std::string_view(cell).substr(0, open))), unit};
}

// The lines of a file that hold something, cell by cell.
class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    if (!file_) throw FileError(path + ": cannot be opened; check the path, relative ones start at the scene's folder");
  }
  bool next(std::vector<std::string>& cells) {
    for (std::string line; std::getline(file_, line);) {
      if (++number_ == 1 && !take_byte_order_mark(line)) refuse("the file is UTF-16; save it as UTF-8");
      const std::string_view shown = text::trimmed(line);
      if (shown.empty() || shown.front() == '#') continue;
      if (separator_ == 0) separator_ = separator_of(shown);
      split_csv(line, separator_, cells);
      return true;
    }
    if (file_.bad()) throw FileError(path_ + ": cannot be read to its end; check the file");
    return false;
  }
  // A cell as a number, its decimal comma a point where commas separate nothing.
  bool number(std::string cell, double& value) const {
    if (separator_ != ',' && cell.find('.') == std::string::npos) std::ranges::replace(cell, ',', '.');
    return parse(cell, value);
  }
  char separator() const { return separator_; }
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(path_ + ":" + std::to_string(number_) + ": " + why);
  }

 private:
  std::string path_;
  std::ifstream file_;
  int number_ = 0;
  char separator_ = 0;
};

// The first line: the header, or without one as many columns without names. A line of both is refused: a word would
// hide that the first row has a slip in it.
std::vector<CsvColumn> columns_of(const Lines& lines, const std::vector<std::string>& cells, bool& header) {
  double ignored = 0;
  const auto n_numbers = std::ranges::count_if(cells, [&](const auto& c) { return lines.number(c, ignored); });
  header = n_numbers == 0;
  if (header) {
    std::vector<CsvColumn> columns;
    for (const std::string& cell : cells) columns.push_back(column_of(cell));
    return columns;
  }
  if (const auto word = std::ranges::find_if(cells, [&](const auto& c) { return !lines.number(c, ignored); });
      word != cells.end())
    lines.refuse("the first line holds " + std::to_string(n_numbers) + " numbers, and '" + *word +
                 "', which is none; it must be a row of numbers, or name every column");
  return std::vector<CsvColumn>(cells.size());
}

std::size_t find_column(const Lines& lines, const std::string& wanted, const std::vector<CsvColumn>& columns) {
  const auto named = [&](const CsvColumn& c) { return c.name == wanted; };
  if (const auto found = std::ranges::find_if(columns, named); found != columns.end()) {
    if (std::ranges::count_if(columns, named) > 1)
      lines.refuse("two columns are named '" + wanted + "'; name the column by its number, from 1");
    return static_cast<std::size_t>(found - columns.begin());
  }
  std::size_t k = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), k);
  if (error == std::errc{} && end == wanted.data() + wanted.size() && k >= 1 && k <= columns.size()) return k - 1;
  std::vector<std::string> names;
  for (const CsvColumn& c : columns) names.push_back(c.name);
  const bool header = std::ranges::any_of(names, [](const std::string& name) { return !name.empty(); });
  const std::string advice = !header             ? "; the file has no header, name columns by number"
                             : names.size() == 1 ? "; cells are separated by commas, semicolons or tabs"
                                                 : text::suggestion(wanted, names);
  lines.refuse("no column '" + wanted + "' among " + std::to_string(columns.size()) + advice);
}

// A column that was asked for.
struct Wanted {
  std::size_t k;
  std::string unit;  // "mm"; empty: SI
};

Wanted wanted_of(const Lines& lines, const std::string& name, const std::vector<CsvColumn>& columns) {
  const std::size_t k = find_column(lines, name, columns);
  const std::string& unit = columns[k].unit;
  if (unit.empty() || unit == "-") return {k, {}};
  const Measured one = in_si(1, unit);
  if (!one.problem.empty()) lines.refuse("column '" + columns[k].name + "': " + one.problem);
  return {k, one.value == 1 ? "" : unit};
}

double number_of(const Lines& lines, const std::vector<std::string>& cells, const Wanted& w) {
  double value = 0;
  const std::string& cell = cells[w.k];
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

// Every row has as many cells as the first line: a decimal comma that separates is found out by this.
void check_count(const Lines& lines, const std::vector<std::string>& cells, std::size_t n_columns) {
  if (cells.size() == n_columns) return;
  const bool commas = lines.separator() == ',' && cells.size() > n_columns;
  lines.refuse("has " + std::to_string(cells.size()) + " cells, the first line has " + std::to_string(n_columns) +
               (commas ? "; if a comma is a decimal one, write a point, or separate cells by semicolons" : ""));
}

Columns table_of(const std::vector<std::vector<double>>& rows, std::size_t n_y) {
  Columns table;
  table.y.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(n_y));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.t.push_back(rows[i][0]);
    for (std::size_t j = 0; j < n_y; ++j)
      table.y(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j + 1];
  }
  return table;
}

}  // namespace

Columns read_columns(const std::string& path, const std::string& t_column, const std::vector<std::string>& y_columns) {
  Lines lines(path);
  std::vector<std::string> cells;
  if (!lines.next(cells)) throw FileError(path + ": has no rows of numbers");
  bool header = false;
  const std::vector<CsvColumn> columns = columns_of(lines, cells, header);
  std::vector<Wanted> wanted{wanted_of(lines, t_column, columns)};
  for (const std::string& name : y_columns) wanted.push_back(wanted_of(lines, name, columns));

  std::vector<std::vector<double>> rows;
  for (bool more = header ? lines.next(cells) : true; more; more = lines.next(cells)) {
    check_count(lines, cells, columns.size());
    std::vector<double> row;
    for (const Wanted& w : wanted) row.push_back(number_of(lines, cells, w));
    if (!rows.empty() && row[0] <= rows.back()[0])
      lines.refuse("time " + text::number(row[0]) + " does not come after " + text::number(rows.back()[0]) +
                   "; sort the rows by time");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw FileError(path + ": has no rows of numbers");
  return table_of(rows, y_columns.size());
}

}  // namespace lockstep
