// SPDX-License-Identifier: BSD-3-Clause
// Tables as CSV files, independent of the locale.
#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <istream>
#include <limits>
#include <ostream>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/recorder.h>
#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/tools/record/csv_lines.h"

namespace lockstep {
namespace {

// "Bx [N]" -> Bx, N; "n []" -> n, of no unit
void add_titled_column(Table& table, std::string_view text) {
  const auto open = text.rfind(" [");
  if (open == std::string_view::npos || text.back() != ']') return table.add_column(std::string(text));
  const std::string_view name = text::trimmed(text.substr(0, open)),
                         unit = text.substr(open + 2, text.size() - open - 3);
  if (unit.empty()) return add_titled_column(table, name);  // as it is written again
  table.add_column(std::string(name), std::string(unit));
}

double read_number(std::string_view cell, const std::string& file, int line, const std::string& column) {
  std::string_view digits = cell;
  if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end.ec == std::errc::result_out_of_range)
    throw FileError(fmt::format("{}:{}: column \"{}\": {} does not fit into a double (at most {}); scale the column",
                                file, line, column, cell, std::numeric_limits<double>::max()));
  if (end.ec != std::errc() || end.ptr != digits.data() + digits.size())
    throw FileError(fmt::format("{}:{}: column \"{}\": \"{}\" is not a number; write it like 1.5e-3, with a point",
                                file, line, column, cell));
  return value;
}

void split_line(const std::string& text, std::vector<std::string>& cells, const std::string& file, int line) {
  if (const auto fault = split_csv(text, ',', cells))
    throw FileError(fmt::format("{}:{}:{}: {}", file, line, csv_column(text, fault->byte), fault->problem));
}

}  // namespace

void append_csv_header(std::string& text, const Table& table, bool units) {
  const std::size_t begin = text.size();
  for (const Column& c : table.columns())
    text.append(text.size() == begin ? "" : ",").append(csv_cell(units ? column_title(c) : c.name));
  text += '\n';
}

void append_csv_row(std::string& text, const Table& table, std::size_t i) {
  const std::size_t begin = text.size();
  for (const Column& c : table.columns()) {
    if (text.size() > begin) text += ',';
    char number[32];
    const double x = c.values[i];
    text.append(number,
                std::to_chars(number, number + sizeof number, std::isnan(x) ? std::abs(x) : x).ptr);  // no "-nan"
  }
  text += '\n';
}

void write_csv(std::ostream& out, const Table& table, bool units) {
  std::string line;
  append_csv_header(line, table, units);
  out.write(line.data(), static_cast<std::streamsize>(line.size()));
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    line.clear();
    append_csv_row(line, table, i);
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
  }
}

void write_csv(const std::string& file, const Table& table, bool units) {
  errno = 0;
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  if (out) write_csv(out, table, units);
  out.close();
  if (!out)
    throw FileError(
        fmt::format("cannot write \"{}\": {}; check the folder and the space left, or give another file name", file,
                    errno != 0 ? std::strerror(errno) : "writing failed"));
}

Table read_csv(std::istream& in, const std::string& file) {
  std::string text;
  std::vector<std::string> cells;
  if (!std::getline(in, text))
    throw FileError(fmt::format("{}:1: the file is empty; its first line must name the columns", file));
  if (!take_byte_order_mark(text)) throw FileError(file + ":1: the file is UTF-16; save it as UTF-8");
  Table table;
  split_line(text, cells, file, 1);
  try {
    for (const std::string& cell : cells) add_titled_column(table, cell);
  } catch (const ModelError& e) {
    throw FileError(fmt::format("{}:1: {}", file, e.what()));
  }
  std::vector<double> row(table.n_columns());
  for (int line = 2; std::getline(in, text); ++line) {
    if (text::trimmed(text).empty()) continue;
    split_line(text, cells, file, line);
    if (cells.size() != row.size())
      throw FileError(fmt::format("{}:{}: {} cells, but the header has {} columns; give one number per column", file,
                                  line, cells.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = read_number(cells[i], file, line, table.columns()[i].name);
    table.add_row(row);
  }
  if (in.bad()) throw FileError(fmt::format("cannot read \"{}\" completely; check the file", file));
  return table;
}

Table read_csv(const std::string& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw FileError(fmt::format("cannot read \"{}\": {}; check the name and the folder", file,
                                errno != 0 ? std::strerror(errno) : "opening failed"));
  return read_csv(in, file);
}

}  // namespace lockstep
