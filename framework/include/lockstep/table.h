// SPDX-License-Identifier: BSD-3-Clause
// Tables: columns of numbers, and requests for columns.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

// Table: columns of numbers with name and unit, as a recorder fills, a CSV file contains and a chart draws them.

/// One column of a table.
struct Column {
  std::string name,            ///< "Bx"
      unit;                    ///< "N"; "" without dimension
  std::vector<double> values;  ///< one per row
};

/// Columns of numbers with name and unit.
class LOCKSTEP_API Table {
 public:
  /// Adds a column at the right. Throws ModelError for a name that is empty or taken, and if there are rows already.
  void add_column(const std::string& name, const std::string& unit = {});
  /// Reserves memory for n rows in all; beyond them columns grow geometrically.
  void reserve(std::size_t n);
  /// Adds a row: one number per column.
  void add_row(std::span<const double> row);
  void clear_rows();  ///< removes all rows; the columns stay

  std::size_t n_rows() const { return columns_.empty() ? 0 : columns_.front().values.size(); }  ///< number of rows
  std::size_t n_columns() const { return columns_.size(); }                                     ///< number of columns
  const std::vector<Column>& columns() const { return columns_; }                               ///< from left to right
  bool has(const std::string& name) const;  ///< whether there is a column of this name
  std::vector<std::string> names() const;   ///< of the columns, from left to right

  /// The column of this name. Throws ModelError with the closest name.
  const Column& column(const std::string& name) const;
  /// The values of the column of this name. Throws ModelError with the closest name.
  const std::vector<double>& operator[](const std::string& name) const { return column(name).values; }
  /// The value in the first row. Throws ModelError for an unknown column or a table without rows.
  double first(const std::string& name) const;
  /// The value in the last row. Throws ModelError for an unknown column or a table without rows.
  double last(const std::string& name) const;
  double change(const std::string& name) const { return last(name) - first(name); }  ///< last() minus first()

 private:
  std::vector<Column> columns_;
};

/// Last and extreme values of a column, in its unit.
struct ColumnRange {
  double last = 0,       ///< in the last row
      least = 0,         ///< smallest; NaN if a NaN was found
      most = 0,          ///< largest; NaN if a NaN was found
      t_least = 0,       ///< when it was smallest first, s
      t_most = 0;        ///< when it was largest first, s
  bool resolved = true;  ///< false: between the instants at which it was computed it may be smaller or larger
};

/// Title of a column: "Bx [N]", or its name alone when the unit is "".
LOCKSTEP_API std::string column_title(const Column&);

/// Writes a table as CSV: the header `t [s],Bx [N]`, then one line per row, every number in the shortest form that
/// reads back as the same double. A title with a comma, a quote or a line end is put in quotes. `units`: in the header.
LOCKSTEP_API void write_csv(std::ostream&, const Table&, bool units = true);
/// Writes a table to a CSV file. Throws FileError with the file's name.
LOCKSTEP_API void write_csv(const std::string& file, const Table&, bool units = true);
/// Reads a CSV file; its first line is the header, with or without units. Throws FileError with file and line: a cell
/// that is not a number, a row of another length, an invalid header.
LOCKSTEP_API Table read_csv(const std::string& file);
/// The same from a stream. `file`: its name in messages.
LOCKSTEP_API Table read_csv(std::istream&, const std::string& file);

/// A column to record: a channel, under its own name or another ("Bx": "B.force_on_p_world_x").
struct Request {
  std::string name,  ///< of the column
      channel;       ///< name of the channel
  /// A channel under its own name.
  Request(const char* own) : name(own), channel(own) {}  // NOLINT: a bare name is a request
  /// A channel under its own name.
  Request(std::string own) : name(own), channel(std::move(own)) {}  // NOLINT
  /// The channel `of`, under the name `given`.
  Request(std::string given, std::string of) : name(std::move(given)), channel(std::move(of)) {}
};

}  // namespace lockstep
