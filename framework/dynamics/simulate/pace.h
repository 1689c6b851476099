// Pace: whether a run has an end in sight, by counts of its steps. Internal to the step loop and to batch runs.
#pragma once

#include <string>

#include <lockstep/export.h>

namespace lockstep {

/// What a run's pace is judged by.
struct PacedRun {
  const std::string& method;  ///< name, for messages
  bool adaptive;              ///< it chooses its steps
  double end;                 ///< s; infinity: none is known
  double advised;             ///< length of the next step, s
  long max_steps;             ///< 0: no limit
};

struct LOCKSTEP_API Pace {
  static constexpr long kPaced = 10000;  ///< steps over which the pace is measured

  void start(double t) { *this = {t}; }
  /// Measures anew from t, after n steps: the run is to come to another end.
  void measure_from(double t, long n) { from = t, from_n = n, slow_from = -1; }
  /// Before the next step of a run that has made n of them and stands at t; asked again before the same step, as when that
  /// step failed, it answers the same. Returns a warning, once, where the rest will take very many steps; ""
  /// otherwise. Throws StepError where it has no end in sight, or max_steps are made.
  std::string watch(const PacedRun&, double t, long n);

  double from = 0;     ///< when the present steps for the pace began, s
  long from_n = 0,     ///< how many steps the run had made then,
      slow_from = -1;  ///< and before it advised too short steps in a row; -1: not known
  bool warned = false;
};

}  // namespace lockstep
