// Channels, tables and the recorder.
#pragma once

#include <cstddef>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/step_loop.h>

namespace lockstep {

// Channels: what can be recorded, by name. "crank.angle_z", "B.force_on_p_world_x", "energy.total".


/// A quantity that can be recorded, by name.
struct Channel {
  std::string name, unit;
  std::function<double(const Sample&)> value;
  /// Called at the start of a run and at every accepted step, when present: counts turns, rejected tries.
  std::function<void(const Sample&)> track{};
  std::function<void(const Sample&)> jumped{};  ///< the same instant once more, with other velocities
  /// Called before that at the start of a run, when present: forgets what an earlier run left behind.
  std::function<void()> restart{};
};

/// One name of a system with its unit and a line of help.
struct ChannelHelp {
  std::string name, unit, help;
};

/// The channel of that name. Sets the system up when it is not (a link's rows have names only then). Work-like channels
/// add a quadrature to the system, one for all who ask, so make channels before the run (before StepLoop takes the
/// start). The system must stay where it is in memory from then on. Throws ModelError with the closest name and all
/// names that the object has.
LOCKSTEP_API Channel make_channel(System&, const std::string& name);

/// Every channel of the system, those of pairs ("M.x@N") left out; rows of links only when it is set up.
LOCKSTEP_API std::vector<ChannelHelp> channel_help(const System&);


// Table: columns of numbers with name and unit; what a recorder fills, a CSV file holds and a chart draws.


/// One column of a table.
struct Column {
  std::string name, unit;  ///< "Bx", "N"; a number without dimension has the unit ""
  std::vector<double> values;
};

/// Columns of numbers with name and unit.
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


// Recorder: an observer that fills a table. Names become functions once; an output is one row of numbers.


/// A column of the record: a channel, under its own name or one of the user's ("Bx": "B.force_on_p_world_x").
struct Request {
  std::string name, channel;
  Request(const char* own) : name(own), channel(own) {}             // NOLINT: a bare name is a request
  Request(std::string own) : name(own), channel(std::move(own)) {}  // NOLINT
  Request(std::string given, std::string of) : name(std::move(given)), channel(std::move(of)) {}
};

/// An observer that fills a table.
class LOCKSTEP_API Recorder : public Observer {
 public:
  /// Before the run, and before StepLoop takes the start: some channels integrate with the motion. The first column
  /// is the time, "t [s]". Throws ModelError: an unknown channel, a name that is taken.
  explicit Recorder(System& system, std::vector<Request> requests = {});
  ~Recorder() override;

  /// A column of the user's own.
  void add(const std::string& name, const std::string& unit, std::function<double(const Sample&)> value);
  void add(Channel channel);
  /// Counts turns for a channel that is used elsewhere (an event's condition), without a column.
  void follow(Channel channel);
  /// Memory for n rows in all; beyond it the table grows geometrically.
  void reserve(std::size_t n) { table_.reserve(n); }
  const Table& table() const { return table_; }

  /// A run from a new start begins a new table.
  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;

 private:
  Table table_;
  std::vector<Channel> channels_;  // of the columns after the first
  std::vector<Channel> followed_;
  std::vector<double> row_;
};

}  // namespace lockstep
