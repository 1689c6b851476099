// Table: columns of numbers with name and unit; what a recorder fills, a CSV file holds and a chart draws.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "framework/foundation/support/export.h"

namespace lockstep {

struct Column {
  std::string name, unit;  ///< "Bx", "N"; a number without dimension has the unit ""
  std::vector<double> values;
};

class LOCKSTEP_API Table {
 public:
  /// A new column at the right. Throws ModelError: a name that is empty or taken, or rows are there already.
  void add_column(const std::string& name, const std::string& unit = {});
  /// Memory for n rows in all; beyond it columns grow geometrically.
  void reserve(std::size_t n);
  /// One number a column.
  void add_row(std::span<const double> row);
  void clear_rows();

  std::size_t n_rows() const { return columns_.empty() ? 0 : columns_.front().values.size(); }
  std::size_t n_columns() const { return columns_.size(); }
  const std::vector<Column>& columns() const { return columns_; }
  bool has(const std::string& name) const;
  std::vector<std::string> names() const;

  /// Throws ModelError naming the closest column.
  const Column& column(const std::string& name) const;
  const std::vector<double>& operator[](const std::string& name) const { return column(name).values; }
  /// Throw ModelError for an unknown column or a table without rows.
  double first(const std::string& name) const;
  double last(const std::string& name) const;
  double change(const std::string& name) const { return last(name) - first(name); }  ///< last minus first

 private:
  std::vector<Column> columns_;
};

/// "Bx [N]", or the bare name when the unit is "".
LOCKSTEP_API std::string title(const Column&);

/// Header `t [s],Bx [N]`, then one line a row; every number in the shortest form that reads back as the same double. A
/// name with a comma, a quote or a line end stands in quotes.
LOCKSTEP_API void write_csv(std::ostream&, const Table&);
/// Throws FileError naming the file.
LOCKSTEP_API void write_csv(const std::string& file, const Table&);
/// Headers with or without units. Throws FileError naming file and line: a cell that is no number, a row of another
/// length.
LOCKSTEP_API Table read_csv(const std::string& file);
LOCKSTEP_API Table read_csv(std::istream&, const std::string& file);

}  // namespace lockstep
