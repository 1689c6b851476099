// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/csv_reader.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

// How the cells of a file are written: by its first line. Where semicolons or tabs separate them, a comma is a decimal
// one.
char separator_of(std::string_view line) {
  std::string bare;  // without quoted parts
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

CsvColumn column_of(const std::string& cell) {
  const auto open = cell.find('[');
  if (open == std::string::npos || cell.back() != ']') return {cell, {}};
  const std::string unit(text::trimmed(std::string_view(cell).substr(open + 1, cell.size() - open - 2)));
  return {std::string(text::trimmed(std::string_view(cell).substr(0, open))), unit};
}

}  // namespace

CsvReader::CsvReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw FileError(path + ": cannot be opened; check the path, relative ones start at the scene's folder");
  if (!next_line(first_)) throw FileError(path + ": has no rows of numbers");
  read_header();
}

bool CsvReader::next_line(std::vector<std::string>& cells) {
  while (std::getline(file_, line_)) {
    if (++number_ == 1 && !take_byte_order_mark(line_)) refuse("the file is UTF-16; save it as UTF-8");
    const std::string_view shown = text::trimmed(line_);
    if (shown.empty() || shown.front() == '#') continue;
    if (separator_ == 0) separator_ = separator_of(shown);
    if (const auto fault = split_csv(line_, separator_, cells, &begins_)) refuse_at(fault->byte, fault->problem);
    return true;
  }
  if (file_.bad()) throw FileError(path_ + ": cannot be read to its end; check the file");
  return false;
}

// Of the first line: the header, or without one as many columns without names. A line of both is an error: a word would
// hide that the first row has a slip in it.
void CsvReader::read_header() {
  double ignored = 0;
  const auto n_numbers = std::ranges::count_if(first_, [&](const auto& c) { return number(c, ignored); });
  if (n_numbers == 0) {
    for (const std::string& cell : first_) columns_.push_back(column_of(cell));
    first_.clear();
    return;
  }
  if (const auto word = std::ranges::find_if(first_, [&](const auto& c) { return !number(c, ignored); });
      word != first_.end())
    refuse("the first line has " + std::to_string(n_numbers) + " numbers and '" + *word +
           "', which is not a number; give numbers only, or name every column");
  columns_.resize(first_.size());
}

// Every row has as many cells as the first line: this detects a decimal comma that separates. It is reported where the
// first cell too many begins, or where the row ends that has too few.
bool CsvReader::next(std::vector<std::string>& cells) {
  if (!first_.empty()) {
    cells = std::move(first_);
    first_.clear();
    return true;
  }
  if (!next_line(cells)) return false;
  if (cells.size() == columns_.size()) return true;
  const bool surplus = cells.size() > columns_.size(), commas = separator_ == ',' && surplus;
  refuse_at(surplus ? begins_[columns_.size()] : line_.find_last_not_of(" \t\r") + 1,
            "has " + std::to_string(cells.size()) + (cells.size() == 1 ? " cell" : " cells") + ", the first line has " +
                std::to_string(columns_.size()) +
                (commas ? "; if its commas are decimal signs, write points, or separate cells by semicolons" : ""));
}

void CsvReader::refuse_both_signs(const std::vector<std::string>& cells, std::size_t column) {
  const std::string& cell = cells[column];
  const bool point = cell.find('.') != std::string::npos, comma = cell.find(',') != std::string::npos;
  double ignored = 0;
  if (separator_ == ',' || point == comma || !number(cell, ignored)) return;
  const char sign = point ? '.' : ',';
  if (sign_ == 0) sign_ = sign, sign_line_ = number_;
  if (sign == sign_) return;
  const std::string& name = columns_[column].name;
  refuse("column " + (name.empty() ? std::to_string(column + 1) : "'" + name + "'") + " has " + cell +
         ", with a decimal " + (point ? "point" : "comma") + ", but line " + std::to_string(sign_line_) +
         " has a decimal " + (point ? "comma" : "point") + "; use one decimal sign in all columns that are read");
}

bool CsvReader::number(std::string cell, double& value) const {
  if (separator_ != ',' && cell.find('.') == std::string::npos) std::ranges::replace(cell, ',', '.');
  const auto read = number_in<double>(std::string_view(cell).substr(cell.starts_with('+') ? 1 : 0));
  value = read.value_or(value);
  return read.has_value();
}

void CsvReader::refuse(const std::string& why) const {
  throw FileError(path_ + ":" + std::to_string(number_) + ": " + why);
}

void CsvReader::refuse_at(std::size_t byte, const std::string& why) const {
  throw FileError(path_ + ":" + std::to_string(number_) + ":" + std::to_string(csv_column(line_, byte)) + ": " + why);
}

std::size_t CsvReader::find(const std::string& wanted) const {
  const auto named = [&](const CsvColumn& c) { return c.name == wanted; };
  if (const auto found = std::ranges::find_if(columns_, named); found != columns_.end()) {
    if (std::ranges::count_if(columns_, named) > 1)
      refuse("two columns are named '" + wanted + "'; give the number of the column, from 1");
    return static_cast<std::size_t>(found - columns_.begin());
  }
  if (const auto k = number_in<std::size_t>(wanted); k && *k >= 1 && *k <= columns_.size()) return *k - 1;
  if (!wanted.empty() && wanted.find_first_not_of("0123456789") == std::string::npos)
    refuse("no column " + wanted + ": there " +
           (columns_.size() == 1 ? "is 1 column" : "are " + std::to_string(columns_.size()) + " columns") +
           ", counted from 1");
  std::vector<std::string> names;
  for (const CsvColumn& c : columns_) names.push_back(c.name);
  const bool header = std::ranges::any_of(names, [](const std::string& name) { return !name.empty(); });
  const std::string advice = !header             ? "; the file has no header, name columns by number"
                             : names.size() == 1 ? "; cells are separated by commas, semicolons or tabs"
                                                 : text::suggestion(wanted, names);
  refuse("no column '" + wanted + "' among " + std::to_string(columns_.size()) + advice);
}

std::string path_of_file(const Value& name) {
  std::filesystem::path path = *name.text();
  if (path.is_relative() && name.where.file) path = std::filesystem::path(*name.where.file).parent_path() / path;
  return path.string();
}

}  // namespace lockstep
