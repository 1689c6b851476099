// SPDX-License-Identifier: BSD-3-Clause
// How every system is measured, lockstep as its peers: one method over a ladder of steps or tolerances, made coarser
// until it fails and finer until it stops gaining; errors in one run, user CPU time in others; a line of CSV each.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/benchmark/peers/mechanisms.h"
#include "tests/benchmark/peers/truth.h"

namespace lockstep::peers {

/// User CPU time of this process, s.
double user_seconds();

/// Thrown by Run::check_time().
struct TooSlow {};

/// One simulation: the driver reports to it. In a sampled run states are looked at and time does not count, in the
/// others only time counts.
class Run {
 public:
  Run(const Mechanism& m, bool to_sample, double allowed)
      : mechanism(m), sampled(to_sample), allowed_(allowed), born_(user_seconds()) {}

  const Mechanism& mechanism;
  const bool sampled;

  /// Around what is timed: from a built model at its start to the end of the run.
  void start_clock() { clock_ = user_seconds(); }
  void stop_clock() { spent += user_seconds() - clock_; }
  /// The state at t; to be called at every report time, or at every step where steps are longer than that.
  void sample(double t, const Motions&);
  /// To be called now and then: throws TooSlow beyond the budget.
  void check_time() const;

  // -- what came of it
  double spent = 0;  ///< user CPU, s
  long steps = 0;
  std::string note;           ///< for the column "status"
  History history;            ///< at the report times reached so far
  bool interpolated = false;  ///< some of it by cubics between two steps
  bool broken = false;        ///< a state that is no number
  double t_last = 0;
  double energy_drift = 0;  ///< largest, of the largest kinetic energy
  double violation = 0;     ///< largest gap of a joint, m; a driver may add its own

 private:
  void watch(const Motions&);
  Positions between(double t, double t_now, const Motions& now) const;

  double allowed_, born_, clock_ = 0;
  Motions last_;
  double start_energy_ = 0, largest_kinetic_ = 0, largest_change_ = 0;
};

using Simulate = std::function<void(Run&)>;

/// Settings of a method: 0 the start, below it coarser, above it finer; 0.0 where there is none.
using Ladder = std::function<double(int)>;
/// Powers of two from the spacing of the reports, at most `largest`.
Ladder step_ladder(const Mechanism&, double largest = 1e9);
/// Powers of ten from 1e-3, from 0.99 (some want less than 1) to 1e-13.
Ladder tolerance_ladder();
long n_steps(const Mechanism&, double h);
/// Whether to sample after step i of n equal steps.
bool due(long i, long n);

/// A program that measures one system. Words on its command line: --mechanism NAME (repeatable), --method PART,
/// --budget S (CPU of one simulation), --seconds S (by the clock, for everything), --truth FOLDER, --lock FILE.
class Bench {
 public:
  Bench(std::string system, int argc, char** argv);

  bool wants(const Mechanism&) const;
  bool wants(const Mechanism&, const std::string& method) const;
  /// `growth`: cost goes with setting^-growth, which tells whether the next run would still be within the budget.
  void sweep(const Mechanism&, const std::string& method, const Ladder&, const std::function<Simulate(double)>&,
             double growth = 1);
  /// The value after a word on the command line that is the driver's own, "" when absent.
  std::string word(const std::string& key) const;
  std::vector<std::string> all_words(const std::string& key) const;

 private:
  struct Result;
  Result measure(const Mechanism&, const Simulate&);
  Result measure_apart(const Mechanism&, const std::string& method, double setting, const Simulate&);
  void time(const Mechanism&, const Simulate&, Result&);
  bool out_of_time() const;

  std::string system_;
  std::vector<std::pair<std::string, std::string>> words_;
  double budget_ = 2, deadline_ = 0;
  Truths truths_;
};

}  // namespace lockstep::peers
