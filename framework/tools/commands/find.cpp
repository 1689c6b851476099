// SPDX-License-Identifier: BSD-3-Clause
// The command find: the value of a number of a scene at which a formula of its run reaches a value.
#include <spdlog/fmt/fmt.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include <lockstep/error.h>
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"

namespace lockstep {
namespace {

Result find(const Arguments& args) {
  using Limits = std::numeric_limits<double>;
  const Interrupt interrupt;
  RunFunction runs(read_ranges(args), interrupt);
  if (runs.n() != 1) throw UsageError("--vary: find varies one number; `lockstep optimize` varies several");
  const std::string& goal = args["--reach"];
  const Sides sides = sides_of("--reach", goal);
  if (sides.sign != "==") throw UsageError("--reach: \"" + goal + "\" is not an equation; write \"max(T) = 3 N m\"");
  runs.add("--reach", goal, sides.left);
  runs.add("--reach", goal + " (difference)", sides.left + " - (" + sides.right + ")");
  runs.check_files();

  std::map<double, SweepRun> done;
  const auto difference = [&](double x) {
    if (!done.contains(x)) done.emplace(x, runs.succeeded({x}));
    return done.at(x).columns[1].last;
  };
  const auto value = [&](double x) { return with_unit(done.at(x).columns[0].last, runs.unit(0)); };
  const double a = runs.low(0), b = runs.high(0), fa = difference(a), fb = difference(b);
  // By how much runs are off. At an end of the range it is enough to come so close.
  const double noise = 10 * runs.varied().loaded.scene.run.tolerance.relative * std::max(std::abs(fa), std::abs(fb));
  double low = a, high = b;
  if (fa * fb > 0 && std::min(std::abs(fa), std::abs(fb)) > noise)
    throw Error(
        fmt::format("{} is {} with {} and {} with {}, both {} the value to reach; give another range, or look for "
                    "one with `lockstep sweep`",
                    sides.left, value(a), runs.text({a}), value(b), runs.text({b}), fa > 0 ? "above" : "below"));
  if (fa * fb < 0) {
    // The root, by the bracketing method of Alefeld, Potra and Shi (TOMS 748), to half of the digits of the range.
    const double close = std::ldexp(b - a, -Limits::digits / 2);
    std::uintmax_t most = Limits::digits;
    std::tie(low, high) = boost::math::tools::toms748_solve(
        difference, a, b, fa, fb, [&](double left, double right) { return right - left <= close; }, most);
    // A jump stays as large when it is bracketed more closely.
    const auto apart = [&] { return std::abs(difference(high) - difference(low)); };
    const double jump = apart();
    for (int n = 4; n > 0 && apart() > noise; --n) {
      const double middle = std::midpoint(low, high);
      (difference(middle) * difference(low) > 0 ? low : high) = middle;
    }
    if (apart() > noise && 2 * apart() > jump)
      throw Error(fmt::format("{} jumps over the value to reach near {}; see `lockstep sweep` there", sides.left,
                              runs.text({low})));
  }
  const double x = std::abs(difference(low)) < std::abs(difference(high)) ? low : high;
  Result result(runs.varied().loaded, kOutcomeFields, runs.outcome(sides.left, {x}, done.at(x)));
  const Point given{runs.given(0).value_or(a)};
  runs.conclude(result, {given, {x}}, {args["--report"].empty() ? SweepRun() : runs.at(given), done.at(x)}, 1);
  return result;
}

}  // namespace

Command find_command() {
  return {
      "find",
      join({settings_options(),
            {Option{"--vary", "NAME=a:b", "the number that varies, and its range"}.needed().repeated(),
             Option{"--reach", "EQUATION", "formula of columns and channels, and its value at the end of the run"}
                 .needed(),
             kWrite, kBeforeAfter, kJson}}),
      find,
      R"(The value of NAME in its range at which the formula has the value, by bracketing: at one end of the range it
must be above, at the other below. NAME is that of `lockstep sweep`. The formula reads recorded columns and channels, and
counts at the end of the run: max(T) is the largest value of the whole run, T the last one. Exit code 1: no such value.

Example:
  lockstep find samples/scenes/slider_crank.json --vary crank=100mm:200mm --reach "max(drive_torque) = 3 N m")",
      {&kOutcomeFields.schema()}};
}

}  // namespace lockstep
