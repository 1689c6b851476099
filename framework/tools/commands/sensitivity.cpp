// SPDX-License-Identifier: BSD-3-Clause
// The command sensitivity: derivatives of formulas of a run, and of natural frequencies, by numbers of its scene.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/modes.h>
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/method_specs.h"

namespace lockstep {
namespace {

constexpr const char* kTightTolerance = "1e-12";  // of the runs: their errors are multiplied by 1/step

/// The derivative of a result by a number.
struct Slope {
  std::string of, to;
  double value = 0, derivative = NAN;
  std::string unit;
  double error = HUGE_VAL, relative = NAN;
};
struct Slopes {
  std::vector<Slope> all;
  long runs = 0;
};

const Fields<Slopes>& slope_fields() {
  static const Fields<Slope> kSlope{{"of", "", "of", &Slope::of},
                                    {"to", "", "to", &Slope::to},
                                    {"value", "", "value", &Slope::value},
                                    {"derivative", "", "derivative", &Slope::derivative},
                                    {"error", "", "estimated error", &Slope::error},
                                    {"unit", "", "unit", &Slope::unit},
                                    {"relative", "", "% per %", &Slope::relative}};
  static const Fields<Slopes> kFields{{"sensitivities", "sensitivities", &Slopes::all, kSlope},
                                      {"runs", "", "runs", &Slopes::runs}};
  return kFields;
}

std::string unit_of_slope(const std::string& of, const std::string& to) {
  if (to.empty()) return of;
  return (of.empty() ? "1" : of) + "/" + (to.find_first_of(" /") == std::string::npos ? to : "(" + to + ")");
}

/// Results at a point: formulas at the end of a run, and natural frequencies.
class Sensitivity {
 public:
  Sensitivity(const Arguments& args, const Interrupt& interrupt)
      : runs_(read_numbers(args), interrupt), at_rest_(args) {
    at_rest_.set("--equilibrium", std::vector<std::string>());
    for (const std::string& formula : args.all("--of"))
      runs_.add("--of", formula, formula), names_.push_back(formula), units_.push_back(runs_.unit(names_.size() - 1));
    n_formulas_ = names_.size();
    const int n_modes = args["--modes"].empty() ? 0 : whole_number("--modes", args["--modes"], kMostModes);
    for (int k = 1; k <= n_modes; ++k) names_.push_back(fmt::format("frequency {}", k)), units_.emplace_back("Hz");
    if (names_.empty()) throw UsageError("--of: a formula is missing; give one, as in --of \"max(T)\", or give --modes");
  }

  Slopes find() {
    Point x;
    for (std::size_t k = 0; k < runs_.n(); ++k) {
      x.push_back(runs_.given(k).value_or(0));
      if (x[k] == 0)
        throw UsageError("--to: \"" + path(k) + "\" is 0, and the steps of differences are parts of it; give another value by --set");
    }
    Slopes slopes;
    const std::vector<double> values = at(x);
    for (std::size_t k = 0; k < x.size(); ++k) {
      std::vector<Slope> of = differences(x, k);
      for (std::size_t f = 0; f < names_.size(); ++f) {
        of[f].of = names_[f], of[f].to = path(k), of[f].value = values[f];
        of[f].unit = unit_of_slope(units_[f], runs_.varied().variables[k].unit);
        of[f].relative = of[f].derivative * x[k] / values[f];
        slopes.all.push_back(of[f]);
      }
    }
    slopes.runs = n_runs_;
    return slopes;
  }

  const Loaded& loaded() const { return runs_.varied().loaded; }

 private:
  static constexpr int kMostModes = 1000;

  // Central differences d(h) with h halved, extrapolated to h = 0 (Richardson), of which the entry that differs least from
  // its neighbours is taken (Ridders 1982): d[j] = (4^j d[j-1](h) - d[j-1](2h))/(4^j - 1).
  std::vector<Slope> differences(const Point& x, std::size_t k) {
    constexpr double kFirst = 1.0 / 32;  // step, relative to the number
    constexpr int kLevels = 6;
    std::vector<Slope> best(names_.size());
    std::vector<std::vector<double>> before(names_.size());
    double h = kFirst * std::abs(x[k]);
    for (int level = 0; level < kLevels; ++level, h /= 2) {
      Point above = x, below = x;
      above[k] += h, below[k] -= h;
      const std::vector<double> plus = at(above), minus = at(below);
      for (std::size_t f = 0; f < names_.size(); ++f) {
        std::vector<double> d{(plus[f] - minus[f]) / (above[k] - below[k])};
        double power = 4;
        for (const double coarse : before[f]) {
          d.push_back((power * d.back() - coarse) / (power - 1));
          power *= 4;
          const double error = std::max(std::abs(d.back() - d[d.size() - 2]), std::abs(d.back() - coarse));
          if (error < best[f].error) best[f].error = error, best[f].derivative = d.back();
        }
        before[f] = std::move(d);
      }
    }
    return best;
  }

  std::vector<double> at(const Point& x) {
    std::vector<double> values;
    ++n_runs_;
    if (n_formulas_ > 0) {
      const SweepRun run = runs_.at(x);
      if (run.failed) throw Error(fmt::format("the run with {} failed: {}", runs_.text(x), run.status));
      for (const ColumnRange& c : run.columns) values.push_back(c.last);
    }
    if (values.size() < names_.size()) add_frequencies(x, values);
    return values;
  }

  // Of the oscillations at the equilibrium, the lowest first.
  void add_frequencies(const Point& x, std::vector<double>& values) const {
    const FindingScope unheard;
    const MechanismAt rest = motion_state(
        std::make_unique<Mechanism>(build_mechanism(runs_.scene(x), loaded().registry)), loaded().registry, at_rest_);
    for (const Mode& m : find_modes(*rest.dynamics, rest.state).modes)
      if (m.kind == Mode::Kind::oscillation && values.size() < names_.size()) values.push_back(m.frequency());
    if (values.size() < names_.size())
      throw UsageError(fmt::format("--modes: with {} there are only {} oscillations; ask for fewer", runs_.text(x),
                                   values.size() - n_formulas_));
  }

  std::string path(std::size_t k) const { return runs_.varied().variables[k].path; }

  RunFunction runs_;
  Arguments at_rest_;
  std::vector<std::string> names_, units_;
  std::size_t n_formulas_ = 0;
  long n_runs_ = 0;
};

Result sensitivity(const Arguments& given) {
  Arguments args = given;
  if (args["--tolerance"].empty()) args.set("--tolerance", kTightTolerance);
  const Interrupt interrupt;
  Sensitivity all(args, interrupt);
  const Slopes found = all.find();
  return Result(all.loaded(), slope_fields(), found);
}

}  // namespace

Command sensitivity_command() {
  return {"sensitivity",
          join({settings_options(),
                {Option{"--of", "FORMULA", "formula of columns and channels at the end of the run; may be repeated"}.repeated(),
                 {"--modes", "N", "also the N lowest natural frequencies at the equilibrium, as of `lockstep modes`"},
                 Option{"--to", "NAME", "number of the scene; may be repeated"}.needed().repeated(), kJson}}),
          sensitivity,
          R"--(Derivatives are by differences, not exact: central differences of runs with steps of 1/32 of the number and less are
extrapolated to zero. The estimated error is the least change between two extrapolations. The tolerance of the runs is
1e-12 unless --tolerance is given. Extremes have no derivative where one peak takes over from another.

Example:
  lockstep sensitivity slider_crank.json --of "max(T)" --to crank --to rod)--",
          {&slope_fields().schema()}};
}

}  // namespace lockstep
