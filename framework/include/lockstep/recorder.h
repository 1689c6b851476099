// SPDX-License-Identifier: BSD-3-Clause
// Channels, tables and the recorder.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/finding.h>
#include <lockstep/step_loop.h>
#include <lockstep/table.h>

namespace lockstep {

// Channels: quantities that can be recorded, by name. "crank.angle_z", "B.force_on_p_world_x", "energy.total".

/// A quantity that can be recorded, by name.
struct Channel {
  std::string name,                            ///< "crank.angle_z"
      unit;                                    ///< "rad"; "" without dimension
  std::function<double(const Sample&)> value;  ///< its value at a state of a run
  /// What it remembers of the run up to that state, such as the number of rejected steps; null: nothing. The recorder
  /// calls its start(), inside(), step(), jumped(), save(), load() and saves_all().
  std::shared_ptr<Observer> memory{};
  bool of_motion = false;  ///< whether its value depends on the states inside the steps before
};

/// Name, unit and one line of help of a channel.
struct ChannelHelp {
  std::string name,  ///< "crank.angle_z"
      unit,          ///< "rad"; "" without dimension
      help;          ///< description
};

/// Makes the channel of this name, or of a formula of channels: "=norm(B.force_on_p_world)". Names without the last part,
/// as "B.force_on_p_world", are vectors of three channels; numbers of System::define() are known, and the time t. Functions
/// of the motion up to a row: min(x), max(x), mean(x), rms(x), integral(x), at(x, time); mean(last(x, T)) is of the last
/// T seconds. rate(x) is the derivative by time. The system is set up if it was not (a joint's rows have names only then). Channels
/// of works and angles add states to the system, shared by all that ask for them, so make channels before the run
/// (before the StepLoop takes the start). From then on the system must not be moved in memory. Throws ModelError
/// with the closest name and with all quantities of the object.
LOCKSTEP_API Channel make_channel(System&, const std::string& name);

/// All channels of a system except those of pairs ("M.x@N"); those of constraints only if it is set up.
LOCKSTEP_API std::vector<ChannelHelp> channel_help(const System&);

class Extremes;

// Recorder: an observer that fills a table. Names become functions once; an output is one row of numbers.

/// An observer that fills a table: one row per output time.
class LOCKSTEP_API Recorder : public Observer {
 public:
  /// Make it before the run, and before the StepLoop takes the start: some channels add integrated states to the
  /// system. The first column is the time, "t [s]". Throws ModelError for an unknown channel or a name that is taken.
  explicit Recorder(System& system, std::vector<Request> requests = {});
  ~Recorder() override;

  /// Adds a column with values of the caller. Throws ModelError for a name that is empty or taken, for an empty
  /// function, and if there are rows already.
  void add(const std::string& name, const std::string& unit, std::function<double(const Sample&)> value);
  /// Adds a column with the values of a channel, under its name. Throws as the other.
  void add(Channel channel);
  /// Adds a column with a channel of the system, under the name that is requested. Throws as make_channel() too.
  void add(System& system, const Request& request);
  /// Keeps a channel up to date that is used elsewhere, as in an event's condition; adds no column.
  void follow(const Channel& channel);
  /// Reserves memory for n rows in all; beyond them the table grows geometrically.
  void reserve(std::size_t n) { table_.reserve(n); }
  const Table& table() const { return table_; }  ///< recorded so far
  /// From the next start on it looks for the extremes of all columns, also between rows and within steps.
  void find_extremes();
  /// Of the columns after the time, so far; none without find_extremes(), or before the start.
  std::span<const ColumnRange> ranges() const;
  /// Time of the last row, s, also if the table does not keep it; infinity: there is none.
  double last_instant() const { return last_; }
  /// Passes each new row to `tell`: one number per column, the time first, valid during the call. The table then keeps
  /// no rows, unless `keep`. An exception ends the call of the run as a UserCodeError, and the row is made and passed
  /// again when the run continues. An empty function: rows go to the table again.
  void on_row(std::function<void(std::span<const double>)> tell, bool keep = false) {
    tell_ = std::move(tell), keeps_ = keep || !tell_;
  }

  /// Begins a new table: removes the rows of an earlier run.
  void start(const Sample&) override;
  void inside(const InsideStep&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;
  bool keeps_rows() const override { return true; }
  bool saves_all() const override;
  /// Removes the rows recorded so far, for a caller that has taken them; columns stay.
  void drop_rows() { table_.clear_rows(); }
  /// Exchanges the table with one of the same columns, for a caller that keeps rows without a copy. Throws ModelError for
  /// other columns.
  void exchange(Table&);

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  void read(const Sample&, std::span<double> values);
  void begin_part(const Sample&);

  Table table_;
  std::vector<Channel> channels_;  // of the columns after the first
  std::vector<Channel> followed_;  // channels with a memory: of columns and of others
  std::vector<double> row_;
  std::unique_ptr<Extremes> extremes_;  // null: not looked for
  std::vector<double> at_end_;          // values at the end of the last step,
  double read_ = kNone;                 // its time; kNone: they are not those
  bool is_continuous_ = false;          // from the last state that was seen
  std::function<void(std::span<const double>)> tell_;
  bool keeps_ = true;
  double last_ = kNone;
};

// EnergyAudit: an observer that checks whether a run conserved energy and satisfied its constraints.

/// Result of an audit.
struct Audit {
  /// Verdict on the energy.
  enum class Energy {
    conserved,      ///< within the limit
    not_conserved,  ///< beyond it
    not_judged      ///< beyond it, but there are forces without potential, dissipation or supply
  };
  Energy energy = Energy::conserved;  ///< the verdict
  bool drifted = false;               ///< whether a constraint violation was beyond the limit
  /// Largest |total - drives - supplied + dissipated|, less its value at the start and the changes at events, J.
  double imbalance = 0;
  /// Largest range of the kinetic energy, the potential energy, and the works below, each with zero, J;
  /// 0 if it is round-off.
  double scale = 0;
  double violation = 0;  ///< largest |C| after a step, m
  AuditLimits limits;    ///< the limits used
  /// Energy that appeared, or vanished (negative), at events, impacts or jumps of laws, by cause.
  struct Instant {
    std::string cause;  ///< "event 'grab'"
    long count = 0;     ///< how often
    double first = 0,   ///< first time, s
        last = 0,       ///< last time, s
        energy = 0;     ///< total, J
  };
  std::vector<Instant> instants;             ///< in the order of their first time
  std::vector<std::string> unbooked_forces;  ///< forces that do work without potential, dissipation or supply
  double start = 0,                          ///< total energy at the start, J
      end = 0,                               ///< at the last output, J
      drives = 0,                            ///< work of drives and moving laws up to there, J
      supplied = 0,                          ///< work of laws and motors of forces, J
      dissipated = 0;                        ///< energy dissipated by dampers, friction and impacts, J

  double imbalance_share() const { return scale > 0 ? imbalance / scale : 0; }  ///< the imbalance, relative
  /// "conserved", "not conserved", "not judged".
  LOCKSTEP_API const char* verdict() const;
  /// Whether the result of a run is wrong (exit code 9), for any method: it drifted, or did not conserve energy.
  bool is_wrong() const { return drifted || energy == Energy::not_conserved; }
};

/// An observer that audits a run. Its channels integrate the work of drives and dampers with the motion.
class LOCKSTEP_API EnergyAudit final : public Observer {
 public:
  /// Make it before the run, as a Recorder.
  explicit EnergyAudit(System& system, AuditLimits limits = {});
  ~EnergyAudit() override;

  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;
  Audit result() const;  ///< of the run so far

 private:
  struct Books;
  std::unique_ptr<Books> books_;
};

/// Verdict on a completed run.
struct RunVerdict {
  Audit audit;                      ///< energy and drift
  std::vector<Finding> findings{};  ///< about the result, and notes
  bool right = true;                ///< neither NOT CONSERVED nor DRIFTED: exit code 9 of the program
};

}  // namespace lockstep
