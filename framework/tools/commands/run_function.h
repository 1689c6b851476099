// SPDX-License-Identifier: BSD-3-Clause
// RunFunction: formulas at the end of a run, as functions of numbers of its scene.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/sweep.h>
#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/sweep/same_steps.h"

namespace lockstep {

/// A point: the values of --vary, SI units.
using Point = std::vector<double>;

/// Both sides of a comparison, "a < b", or of an equation, "a = b".
struct Sides {
  std::string left, sign, right;
};
/// Throws UsageError, which begins with the name of the option.
Sides sides_of(const std::string& option, const std::string& comparison);

/// The result of a run at a point.
struct Outcome {
  std::string text;    ///< "max(T) = 3 N m with crank = 103.2 mm"
  Json values;         ///< of the point, by path
  double value;        ///< of a formula
  std::string unit{},  ///< of the value
      status{};        ///< SweepRun::outcome(); "" of one that succeeded
};
inline const Fields<Outcome> kOutcomeFields{{"text", "", "found", &Outcome::text},
                                            {"values", "", "", &Outcome::values},
                                            {"value", "", "", &Outcome::value},
                                            {"unit", "", "", &Outcome::unit},
                                            {"status", "", "status", &Outcome::status}};

/// The run of a scene at a point. It records formulas in place of the columns of the scene.
class RunFunction {
 public:
  /// The numbers that vary, and their ranges: of read_ranges(), read_numbers().
  RunFunction(VariedScene, const Interrupt&);
  /// Adds a formula of columns and channels. `option` and its text are named in messages. Throws UsageError.
  void add(const std::string& option, const std::string& text, const std::string& formula);

  const VariedScene& varied() const { return varied_; }
  std::size_t n() const { return varied_.variables.size(); }
  double low(std::size_t k) const { return *varied_.variables[k].values.front().number(); }
  double high(std::size_t k) const { return *varied_.variables[k].values.back().number(); }
  /// The value that the scene gives; nothing if it gives none.
  std::optional<double> given(std::size_t k) const;
  const std::string& unit(std::size_t formula) const { return like_.columns()[formula + 1].unit; }

  Scene scene(const Point&) const;
  /// Its columns are the formulas; their last values are the results. A run without a finite result has failed, as one that
  /// was interrupted. `steps`: for derivatives, those that the run writes or repeats.
  SweepRun at(const Point&, StepSequence* steps = nullptr) const;
  SweepRun succeeded(const Point&, StepSequence* steps = nullptr) const;  ///< the same; throws Error for a failed one
  std::string text(const Point&) const;    ///< "crank = 103.2 mm, rod = 200 mm"
  /// The value of the first formula; its text begins with `name`, if there is one.
  Outcome outcome(const std::string& name, const Point&, const SweepRun&) const;

  /// Throws UsageError and FileError for the files of --write and --report.
  void check_files() const;
  /// Writes the scene of the best point, and the page of all runs with the motions of the first and the best one; the
  /// findings and the exit code of the result are those of the best run.
  void conclude(Result&, const std::vector<Point>&, const std::vector<SweepRun>&, std::size_t best) const;

 private:
  std::vector<Variable> shown(const Point&) const;  // with one value each, in the unit of --vary

  std::function<bool(const State&)> goes_on() const {
    return [this](const State&) { return !interrupt_.asked(); };
  }

  VariedScene varied_;
  const Interrupt& interrupt_;
  Mechanism built_;  // of the scene as it is, for units
  std::vector<ChannelRequest> formulas_;
  Table like_;
};

inline constexpr Option kWrite{"--write", "FILE.json",
                               "write the scene with these values, next to the files that it reads"};
inline constexpr Option kBeforeAfter{"--report", "FILE.html", "one HTML file that shows the run before and after"};

/// The text of a result with its unit: "3 N m".
std::string with_unit(double value, const std::string& unit);

}  // namespace lockstep
