// SPDX-License-Identifier: BSD-3-Clause
// The command sensitivity: derivatives of formulas of a run, and of natural frequencies, by numbers of its scene.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/modes.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/method_specs.h"

namespace lockstep {
namespace {

constexpr int kMostModes = 1000;
constexpr const char* kTightTolerance = "1e-10";  // of the runs
constexpr double kFirstStep = 1.0 / 128;          // relative to the number
constexpr int kHalvings = 3;

/// The derivative of a result by a number.
struct Slope {
  std::string of, to;
  double value, derivative;
  std::string unit;
  double error, relative;
};

// Not rounded beside others of this unit: their sizes have nothing to do with one another.
std::string as_it_is(const Json& x) { return number_text(x); }
const Fields<Slope> kSlopeFields{{"of", "", "of", &Slope::of},
                                 {"to", "", "to", &Slope::to},
                                 {"value", "", "value", &Slope::value, as_it_is},
                                 {"derivative", "", "derivative", &Slope::derivative, as_it_is},
                                 {"error", "", "estimated error", &Slope::error, as_it_is},
                                 {"unit", "", "unit", &Slope::unit},
                                 {"relative", "", "% per %", &Slope::relative, as_it_is}};
const Fields<std::vector<Slope>> kSlopesFields{{"sensitivities", "sensitivities", std::identity(), kSlopeFields}};

std::string unit_of_slope(const std::string& of, const std::string& to) {
  if (to.empty()) return of;
  return (of.empty() ? "1" : of) + "/" + (to.find_first_of(" /") == std::string::npos ? to : "(" + to + ")");
}

/// A derivative and its estimated error.
struct Derivative {
  double value = NAN, error = HUGE_VAL;
};

// Central differences d(h), with h halved, extrapolated to h = 0 (Richardson): d[j] = d[j-1] + (d[j-1] - d[j-1](2h))/(4^j - 1).
// That one is taken which differs least from both that it is made of (Ridders 1982). At a kink they are all the mean of two
// slopes, whose difference |f(h) - 2 f(0) + f(-h)|/h does not fall with h; half of it is the error then.
template <class F>
std::vector<Derivative> derivatives(const F& f, const Point& x, const std::vector<double>& at_x, std::size_t k,
                                    double h, int n) {
  std::vector<Derivative> best;
  std::vector<std::vector<double>> before;
  std::vector<double> bend(at_x.size(), HUGE_VAL);
  for (; n > 0; --n, h /= 2) {
    Point above = x, below = x;
    above[k] += h, below[k] -= h;
    const std::vector<double> plus = f(above), minus = f(below);
    best.resize(plus.size()), before.resize(plus.size());
    for (std::size_t i = 0; i < plus.size(); ++i) {
      std::vector<double> d{(plus[i] - minus[i]) / (above[k] - below[k])};
      if (before[i].empty()) best[i].value = d[0];
      for (std::size_t j = 1; j <= before[i].size(); ++j) {
        const double fine = d.back(), coarse = before[i][j - 1];
        d.push_back(fine + (fine - coarse) / (std::ldexp(1, 2 * static_cast<int>(j)) - 1));
        const double error = std::max(std::abs(d.back() - fine), std::abs(d.back() - coarse));
        if (error < best[i].error) best[i] = {d.back(), error};
      }
      const double bent = std::abs(plus[i] - 2 * at_x[i] + minus[i]) / (2 * h);
      if (n == 1 && 4 * bent > 3 * bend[i] && bent * h > kRoundOff * std::abs(at_x[i]))
        best[i].error = std::max(best[i].error, bent);
      bend[i] = bent;
      before[i] = std::move(d);
    }
  }
  return best;
}

/// Results at a point: formulas at the end of a run, and natural frequencies.
class Sensitivity {
 public:
  Sensitivity(const Arguments& args, const Interrupt& interrupt)
      : runs_(read_numbers(args), interrupt), at_rest_(args) {
    at_rest_.set("--equilibrium", "");
    for (const std::string& formula : args.all("--of"))
      runs_.add("--of", formula, formula), names_.push_back(formula), units_.push_back(runs_.unit(names_.size() - 1));
    n_formulas_ = names_.size();
    const int n_modes = args["--modes"].empty() ? 0 : whole_number("--modes", args["--modes"], kMostModes);
    for (int k = 1; k <= n_modes; ++k) names_.push_back(fmt::format("frequency {}", k)), units_.emplace_back("Hz");
    if (names_.empty())
      throw UsageError("--of: a formula is missing; give one, as in --of \"max(T)\", or give --modes");
  }

  std::vector<Slope> find() {
    Point x;
    for (std::size_t k = 0; k < runs_.n(); ++k)
      if (x.push_back(runs_.given(k).value_or(0)); x[k] == 0)
        throw UsageError("--to: \"" + path(k) + "\" is 0, and steps are parts of it; give another value by --set");
    StepSequence steps;
    const std::vector<double> values = at(x, steps, run_);
    steps.is_known = true;
    SweepRun run;
    const auto results = [&](const Point& point) { return at(point, steps, run); };
    std::vector<Slope> all;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const std::vector<Derivative> slopes = derivatives(results, x, values, k, kFirstStep * std::abs(x[k]), kHalvings);
      for (std::size_t f = 0; f < slopes.size(); ++f) {
        const double change = slopes[f].value * x[k];
        all.push_back({names_[f], path(k), values[f], slopes[f].value,
                       unit_of_slope(units_[f], runs_.varied().variables[k].unit), slopes[f].error,
                       std::abs(values[f]) > kRoundOff * std::abs(change) ? change / values[f] : NAN});
      }
    }
    return all;
  }

  const Loaded& loaded() const { return runs_.varied().loaded; }
  const SweepRun& run() const { return run_; }  ///< of the scene

 private:
  std::vector<double> at(const Point& x, StepSequence& steps, SweepRun& run) const {
    std::vector<double> values;
    if (n_formulas_ > 0) run = runs_.succeeded(x, &steps);
    for (const ColumnRange& c : run.columns) values.push_back(c.last);
    if (values.size() == names_.size()) return values;
    const FindingScope unheard;
    const MechanismAt rest = motion_state(
        std::make_unique<Mechanism>(build_mechanism(runs_.scene(x), loaded().registry)), loaded().registry, at_rest_);
    for (const Mode& m : find_modes(*rest.dynamics, rest.state).modes)
      if (m.kind == Mode::Kind::oscillation && values.size() < names_.size()) values.push_back(m.frequency());
    if (values.size() < names_.size())
      throw UsageError(fmt::format("--modes: {} frequencies are asked for, and the equilibrium has {} with {}",
                                   names_.size() - n_formulas_, values.size() - n_formulas_, runs_.text(x)));
    return values;
  }

  std::string path(std::size_t k) const { return runs_.varied().variables[k].path; }

  RunFunction runs_;
  Arguments at_rest_;
  std::vector<std::string> names_, units_;  // of formulas, then of frequencies
  std::size_t n_formulas_ = 0;
  SweepRun run_;
};

Result sensitivity(const Arguments& given) {
  Arguments args = given;
  if (args["--tolerance"].empty()) args.set("--tolerance", kTightTolerance);
  const Interrupt interrupt;
  Sensitivity all(args, interrupt);
  const std::vector<Slope> slopes = all.find();
  CommandFindings::add(all.run().findings);
  Result result(all.loaded(), kSlopesFields, slopes);
  if (all.run().wrong) result.code = kExitNotConserved;
  return result;
}

}  // namespace

Command sensitivity_command() {
  return {
      "sensitivity",
      join({settings_options(),
            {Option{"--of", "FORMULA", "formula of columns and channels at the end of the run; may be repeated"}
                 .repeated(),
             {"--modes", "N", "also the N lowest natural frequencies at the equilibrium, as of `lockstep modes`"},
             Option{"--to", "NAME", "number of the scene; may be repeated"}.needed().repeated(),
             kJson}}),
      sensitivity,
      R"--(The method of integration is differentiated (internal numerical differentiation): runs with changed numbers make the
steps of the run of the scene, so that results are smooth. Their central differences, with changes of 1/128 and less, are
extrapolated to zero. The estimated error is the least change between two extrapolations, or half of the change of the
slope if the formula has a kink there. Extremes have no derivative if one peak takes over from another. Runs have the tolerance
1e-10 unless --tolerance is given.

Example:
  lockstep sensitivity samples/scenes/slider_crank.json --of "max(drive_torque)" --to crank --to rod)--",
      {&kSlopesFields.schema()}};
}

}  // namespace lockstep
