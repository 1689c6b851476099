// SPDX-License-Identifier: BSD-3-Clause
// The command find: the value of a number of a scene at which a formula of its run reaches a value.
#include <spdlog/fmt/fmt.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <map>

#include <lockstep/error.h>
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"

namespace lockstep {
namespace {

struct Found {
  Point at;
  std::string text, reached, status;
  Json values;
  double value = 0, target = 0;
  std::string unit;
  Point bracket;
  long runs = 0;
};

const Fields<Found>& find_fields() {
  static const Fields<Found> kFields{{"found", "", "found", &Found::text}, {"reached", "", "reached", &Found::reached},
                                     {"values", "", "", &Found::values},   {"value", "", "", &Found::value},
                                     {"target", "", "", &Found::target},   {"unit", "", "", &Found::unit},
                                     {"bracket", "", "", &Found::bracket}, {"status", "", "status", &Found::status},
                                     {"runs", "", "runs", &Found::runs}};
  return kFields;
}

/// The value of a formula less the one that it is to reach, by the value of one number.
class Search {
 public:
  Search(const Arguments& args, const Interrupt& interrupt)
      : runs_(read_ranges(args), interrupt), goal_(args["--reach"]) {
    const Sides sides = sides_of("--reach", goal_);
    if (sides.sign != "==") throw UsageError("--reach: \"" + goal_ + "\" is not an equation; write \"max(T) = 3 N m\"");
    if (runs_.n() != 1) throw UsageError("--vary: find varies one number; `lockstep optimize` varies several");
    runs_.add("--reach", goal_ + " (difference)", "(" + sides.left + ") - (" + sides.right + ")");
    runs_.add("--reach", goal_, sides.left);
    left_ = sides.left.substr(0, sides.left.find_last_not_of(' ') + 1);
  }

  double value(double x) {
    if (done_.contains(x)) return difference(x);
    SweepRun run = runs_.at({x});
    if (run.failed) throw Error(fmt::format("the run with {} failed: {}", runs_.text({x}), run.status));
    done_.emplace(x, std::move(run));
    return difference(x);
  }

  // The root, by the bracketing method of Alefeld, Potra and Shi (TOMS 748), to half of the digits of the range.
  Found solve() {
    using Limits = std::numeric_limits<double>;
    const double a = runs_.low(0), b = runs_.high(0), fa = value(a), fb = value(b);
    if (fa * fb > 0)
      throw Error(fmt::format(
          "{} is {} with {} and {} with {}: both are {} the value to reach; give another range, or "
          "look for one with `lockstep sweep`",
          left_, value_text(a), runs_.text({a}), value_text(b), runs_.text({b}), fa > 0 ? "above" : "below"));
    const double close = std::ldexp(b - a, -Limits::digits / 2);
    std::uintmax_t most = Limits::digits;
    const auto [low, high] =
        boost::math::tools::toms748_solve([this](double x) { return value(x); }, a, b, fa, fb,
                                          [&](double left, double right) { return right - left <= close; }, most);
    const double off = std::max(std::abs(difference(low)), std::abs(difference(high)));
    if (off > std::sqrt(runs_.varied().loaded.scene.run.tolerance.relative) * std::max(std::abs(fa), std::abs(fb)))
      throw Error(fmt::format("{} jumps over the value to reach, from {} to {}, near {}; see `lockstep sweep` there",
                              left_, value_text(low), value_text(high), runs_.text({low})));
    return found(std::abs(difference(low)) < std::abs(difference(high)) ? low : high, {low, high});
  }

  const RunFunction& runs() const { return runs_; }
  const SweepRun& run_at(double x) const { return done_.at(x); }

 private:
  double difference(double x) const { return done_.at(x).columns[0].last; }
  std::string value_text(double x) const { return with_unit(done_.at(x).columns[1].last, runs_.unit(1)); }
  Found found(double x, const Point& bracket) const {
    const double value = done_.at(x).columns[1].last, target = value - difference(x);
    const std::string reached = fmt::format("{} = {}", left_, value_text(x));
    const std::string outcome = done_.at(x).outcome();
    return {{x},    runs_.text({x}), reached, outcome == "ok" ? "" : outcome, runs_.values({x}), value,
            target, runs_.unit(1),   bracket, static_cast<long>(done_.size())};
  }

  RunFunction runs_;
  std::string goal_, left_;
  std::map<double, SweepRun> done_;
};

Result find(const Arguments& args) {
  const Interrupt interrupt;
  Search search(args, interrupt);
  search.runs().check_file();
  const Found found = search.solve();
  Result result(search.runs().varied().loaded, find_fields(), found);
  search.runs().conclude(result, found.at, search.run_at(found.at[0]));
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
             kWrite, kJson}}),
      find,
      R"(The value of NAME in its range at which the formula has the value, by bracketing: at one end of the range it
must be above, at the other below. NAME is that of `lockstep sweep`. The formula reads recorded columns and channels, and
counts at the end of the run: max(T) is the largest value of the whole run, T the last one. Exit code 1: no such value.

Example:
  lockstep find slider_crank.json --vary crank="80 mm:120 mm" --reach "max(T) = 3 N m")",
      {&find_fields().schema()}};
}

}  // namespace lockstep
