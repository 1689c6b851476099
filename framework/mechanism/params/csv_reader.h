// SPDX-License-Identifier: BSD-3-Clause
// The header of a CSV file, and its rows as texts.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include <lockstep/author/params.h>

namespace lockstep {

/// A column as the header has it: "x [mm]". Without a header its name is empty, without "[unit]" its unit: SI.
struct CsvColumn {
  std::string name, unit;
};

/// Reads a file line by line; blank lines and those that begin with # are skipped. Throws FileError, with file and line,
/// as described at read_columns() of splines.h.
class LOCKSTEP_API CsvReader {
 public:
  /// Opens the file and reads its first line, which names the columns or is the first row.
  explicit CsvReader(const std::string& path);
  const std::vector<CsvColumn>& columns() const { return columns_; }
  /// Which column that is, by name or by number from 1.
  std::size_t find(const std::string& name) const;
  /// The cells of the next row; false where there is none. Every row has as many as there are columns.
  bool next(std::vector<std::string>& cells);
  /// A cell as a number, its decimal comma a point where commas separate nothing; false if it is none.
  bool number(std::string cell, double& value) const;
  /// Throws FileError where a cell of this column has a decimal point, and one that was given here before a decimal comma,
  /// or the other way round: one of the two may separate thousands. For the columns that are read; others may hold both.
  void refuse_both_signs(const std::vector<std::string>& cells, std::size_t column);
  /// What separates the cells.
  char separator() const { return separator_; }
  /// Throws FileError with file and line.
  [[noreturn]] void refuse(const std::string& why) const;
  /// Throws FileError with file, line and the column of a byte of the line that was read last.
  [[noreturn]] void refuse_at(std::size_t byte, const std::string& why) const;

 private:
  bool next_line(std::vector<std::string>& cells);
  void read_header();
  std::string path_;
  std::ifstream file_;
  std::string line_;                 // the one that was read last
  std::vector<std::size_t> begins_;  // of its cells, in bytes
  int number_ = 0;
  char separator_ = 0;
  char sign_ = 0;      // the decimal sign of the first number that has one, of those that are read
  int sign_line_ = 0;  // its line
  std::vector<CsvColumn> columns_;
  std::vector<std::string> first_;  // the first row, where there is no header
};

/// The path of a file that a description names: a relative one starts at the folder of the description.
LOCKSTEP_API std::string path_of_file(const Value& name);

}  // namespace lockstep
