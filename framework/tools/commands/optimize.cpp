// SPDX-License-Identifier: BSD-3-Clause
// The command optimize: numbers of a scene for which a formula of its run is least or largest, by NLopt.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include <lockstep/charts.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/terminal.h"
#if LOCKSTEP_NLOPT
#include <nlopt.h>
#endif

namespace lockstep {
namespace {

constexpr int kRuns = 1000;     // default
constexpr double kStep = 1e-4;  // of derivatives, relative to a range

struct Optimized {
  Outcome start, best;
  std::vector<std::string> conditions;
  std::string ended;
  long runs, failed;
};

std::string outcome_words(const Json& o) {
  const std::string text = o["text"], status = o.value("status", "");
  return status.empty() ? text : text + " (" + status + ")";
}
const Fields<Optimized> kOptimizeFields{{"start", "start", &Optimized::start, kOutcomeFields, outcome_words},
                                        {"best", "best", &Optimized::best, kOutcomeFields, outcome_words},
                                        {"conditions", "", "conditions", &Optimized::conditions},
                                        {"ended", "", "ended", &Optimized::ended},
                                        {"runs", "", "runs", &Optimized::runs},
                                        {"failed", "", "failed runs", &Optimized::failed, unless_zero}};

/// The runs of a search, in their order. Their formulas are the objective, and two of each condition: its left side, and
/// the smaller side less the larger one, which must not be positive.
class Optimization {
 public:
  Optimization(const Arguments& args, const Interrupt& interrupt)
      : interrupt_(interrupt),
        runs_(read_ranges(args), interrupt),
        most_(args["--runs"].empty() ? kRuns : whole_number("--runs", args["--runs"], std::numeric_limits<int>::max())),
        progress_(most_, args.has("--quiet") || args.has("--json"), Counts::runs),
        sign_(args["--maximize"].empty() ? 1 : -1),
        objective_(args[sign_ > 0 ? "--minimize" : "--maximize"]) {
    if (objective_.empty()) throw UsageError("--minimize: a formula is missing; give one, as in --minimize \"max(T)\"");
    runs_.add(sign_ > 0 ? "--minimize" : "--maximize", objective_, objective_);
    for (const std::string& all : args.all("--subject-to"))  // a && b are two
      for (std::size_t at = 0, end = 0; end != std::string::npos; at = end + 2)
        end = all.find("&&", at), conditions_.emplace_back(text::trimmed(all.substr(at, end - at)));
    for (const std::string& text : conditions_) {
      const Sides s = sides_of("--subject-to", text);
      signs_.push_back(s.sign[0] == '<' ? 1 : -1);
      if (s.sign == "==") throw UsageError("--subject-to: \"" + text + "\" is an equation; compare by < or >");
      runs_.add("--subject-to", text, s.left);
      runs_.add("--subject-to", text + " (excess)",
                s.sign[0] == '<' ? s.left + " - (" + s.right + ")" : s.right + " - (" + s.left + ")");
    }
  }

  /// Calls NLopt; why it ended. Throws Error if the start fails, FileError in a build without NLopt.
  std::string search(const std::string& method);

  /// The best run of those in which all conditions hold; if they hold in none, the one of the least largest excess.
  std::size_t best() const { return std::ranges::max_element(ranks_) - ranks_.begin(); }
  bool holds(std::size_t k) const { return ranks_[k].first == kHolds; }
  void conclude(Result& result) const { runs_.conclude(result, points_, done_, best()); }

  Optimized result(const std::string& ended) const {
    const auto outcome = [&](std::size_t k) { return runs_.outcome("", points_[k], done_[k]); };
    Optimized o{outcome(0), outcome(best()), {}, ended, n_runs_, n_failed_};
    for (std::size_t k = 0; k < conditions_.size(); ++k)
      o.conditions.push_back(conditions_[k] + ": " +
                             with_unit(done_[best()].columns[1 + 2 * k].last, runs_.unit(1 + 2 * k)));
    if (!holds(best())) o.conditions.emplace_back("they held together in no run");
    return o;
  }

  /// The objective of each run, and the best one so far.
  void draw(const std::string& file) const {
    Series each{"run", {}, {}, SeriesStyle::points}, best{"best", {}, {}};
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < done_.size(); ++k) {
      const double value = done_[k].failed ? NAN : done_[k].columns[0].last;
      if (holds(k)) least = std::min(least, sign_ * value);
      each.x.push_back(static_cast<double>(k + 1)), each.y.push_back(value), best.y.push_back(sign_ * least);
    }
    best.x = each.x;
    const bool log = std::ranges::none_of(each.y, [](double value) { return value <= 0; });
    write_chart(
        file,
        {runs_.varied().loaded.title(), "run", {{column_title({"objective", runs_.unit(0), {}}), {each, best}, log}}});
  }

  const RunFunction& runs() const { return runs_; }
  bool method_failed() const { return method_failed_; }

 private:
  enum Verdict { kFailed, kEnded, kHolds };  // kHolds: with all conditions

  double tolerance() const { return runs_.varied().loaded.scene.run.tolerance.relative; }
  // The size of the excess k of a run: that of the larger side.
  double size(const SweepRun& run, std::size_t k) const {
    const double left = run.columns[k - 1].last, right = left - signs_[k / 2 - 1] * run.columns[k].last;
    const double larger = std::max(std::abs(left), std::abs(right));
    return larger == 0 ? 1 : larger;
  }
  double scale(std::size_t k) const { return k == 0 ? objective_scale_ : size(done_[reference_], k); }
  void scale_last() {
    const std::vector<ColumnRange>& columns = done_.back().columns;
    scaled_.assign(1, sign_ * columns[0].last / scale(0));
    for (std::size_t k = 2; k < columns.size(); k += 2) scaled_.push_back(columns[k].last / scale(k));
  }
  // Conditions hold by the sizes of their sides in the run itself.
  std::pair<Verdict, double> rank(const SweepRun& run) const {
    if (run.failed) return {kFailed, 0};
    bool all = true;
    double excess = -HUGE_VAL;
    for (std::size_t k = 2; k < run.columns.size(); k += 2) {
      all = all && run.columns[k].last <= tolerance() * size(run, k);
      excess = std::max(excess, run.columns[k].last / scale(k));
    }
    return all ? std::pair(kHolds, -sign_ * run.columns[0].last) : std::pair(kEnded, -excess);
  }
  // Whether the last run does not meet a condition that was scaled by much more than its size there; then by that.
  bool rescales() {
    if (done_.back().failed || holds(done_.size() - 1)) return false;
    for (std::size_t k = 2; k < done_.back().columns.size(); k += 2)
      if (2 * size(done_.back(), k) < scale(k)) {
        reference_ = done_.size() - 1, gradients_.clear(), scale_last(), worst_ = scaled_;
        std::ranges::transform(done_, ranks_.begin(), [&](const SweepRun& run) { return rank(run); });
        return true;
      }
    return false;
  }
  // An objective that is nothing at the start is scaled by what it changes over the ranges there.
  void scale_by_slope() {
    if (done_[0].failed) return;
    derive({}, 0);
    double most = 0;
    for (std::size_t k = 0; k < runs_.n(); ++k) most = std::max(most, std::abs(gradients_[k]));
    if (!(std::abs(scaled_[0]) < kNegligible * most)) return;
    for (std::size_t k = 0; k < runs_.n(); ++k) gradients_[k] /= most;
    objective_scale_ *= most, scale_last(), worst_ = scaled_;
  }

  // The objective and the excesses relative to their scales, at numbers from 0 to 1; of a run that failed the worst ones so
  // far. NLopt asks for them one after the other, at one point.
  const std::vector<double>& scaled(const double* u) {
    Point x;
    for (std::size_t k = 0; k < runs_.n(); ++k) x.push_back(std::lerp(runs_.low(k), runs_.high(k), u[k]));
    if (!points_.empty() && (points_.back() == x || !may_run(1))) return scaled_;
    steps_.is_known = false;
    done_.push_back(run(x)), points_.push_back(x);
    if (ranks_.emplace_back(kFailed, 0); done_.back().failed) return scaled_ = worst_;
    const std::vector<ColumnRange>& columns = done_.back().columns;
    if (done_.size() == 1 && columns[0].last != 0) objective_scale_ = std::abs(columns[0].last);
    scale_last();
    ranks_.back() = rank(done_.back());
    worst_.resize(scaled_.size(), -HUGE_VAL);
    for (std::size_t k = 0; k < scaled_.size(); ++k) worst_[k] = std::max(worst_[k], scaled_[k]);
    return scaled_;
  }

  SweepRun run(const Point& x) {
    progress_.at(static_cast<double>(++n_runs_));
    SweepRun done = runs_.at(x, &steps_);
    n_failed_ += done.failed;
    return done;
  }
  bool may_run(std::size_t n) {
    return !(ended_ = ended_ || interrupt_.asked() || n_runs_ + static_cast<long>(n) > most_);
  }

  // Their derivatives at the last point, one row for each, by central differences on the steps of its run. At an end of a
  // range, and where a run fails, the point itself stands for it.
  void derive(std::span<double> gradient, std::size_t first) {
    const std::size_t n = runs_.n();
    if (gradients_.empty() || derived_ != points_.back()) {
      gradients_.assign(scaled_.size() * n, 0), derived_ = points_.back();
      const bool derives = !done_.back().failed && may_run(2 * n);
      has_slopes_ = has_slopes_ || derives, steps_.is_known = true;
      for (std::size_t k = 0; derives && has_slopes_ && k < n; ++k) {
        const double range = runs_.high(k) - runs_.low(k), h = kStep * range;
        double at[] = {std::max(derived_[k] - h, runs_.low(k)), std::min(derived_[k] + h, runs_.high(k))};
        SweepRun sides[] = {done_.back(), done_.back()};
        for (const int i : {0, 1}) {
          Point x = derived_;
          x[k] = at[i];
          if (SweepRun side = x == derived_ ? sides[i] : run(x); !side.failed)
            sides[i] = std::move(side);
          else
            at[i] = derived_[k];
        }
        has_slopes_ = at[0] < at[1];
        for (std::size_t f = 0; has_slopes_ && f < scaled_.size(); ++f)
          gradients_[f * n + k] = (f == 0 ? sign_ : 1) * range / scale(2 * f) *
                                  (sides[1].columns[2 * f].last - sides[0].columns[2 * f].last) / (at[1] - at[0]);
      }
    }
    std::copy_n(gradients_.begin() + static_cast<std::ptrdiff_t>(first * n), gradient.size(), gradient.begin());
  }

  const Interrupt& interrupt_;
  RunFunction runs_;
  int most_;
  Progress progress_;
  double sign_;
  std::string objective_;
  std::vector<std::string> conditions_;
  std::vector<double> signs_;  // excess = sign (left - right)
  std::vector<SweepRun> done_;
  std::vector<Point> points_;
  std::vector<std::pair<Verdict, double>> ranks_;  // the larger, the better
  std::vector<double> scaled_, worst_, gradients_;
  double objective_scale_ = 1;
  std::size_t reference_ = 0;  // the run whose sizes are the scales of conditions
  StepSequence steps_;  // of the last point
  Point derived_;       // of the gradients
  bool has_slopes_ = true, ended_ = false, method_failed_ = false;
  long n_runs_ = 0, n_failed_ = 0;
};

#if LOCKSTEP_NLOPT

std::string Optimization::search(const std::string& method) {
  struct Call {
    Optimization& all;
    nlopt_opt nlopt;
  };
  const auto objective = [](unsigned n, const double* u, double* gradient, void* of) {
    Call& call = *static_cast<Call*>(of);
    const double value = call.all.scaled(u)[0];
    if (gradient != nullptr) call.all.derive({gradient, n}, 0);
    if (call.all.ended_) nlopt_force_stop(call.nlopt);
    return value;
  };
  const auto excesses = [](unsigned m, double* c, unsigned n, const double* u, double* gradient, void* of) {
    Call& call = *static_cast<Call*>(of);
    std::copy_n(call.all.scaled(u).begin() + 1, m, c);
    if (gradient != nullptr) call.all.derive({gradient, std::size_t{m} * n}, 1);
  };
  std::vector<double> start, slack(conditions_.size(), tolerance());
  for (std::size_t k = 0; k < runs_.n(); ++k) {
    const double low = runs_.low(k), high = runs_.high(k), given = runs_.given(k).value_or(0.5 * (low + high));
    start.push_back((std::clamp(given, low, high) - low) / (high - low));
    if (given < low || given > high)
      tell("note: " + runs_.varied().variables[k].path +
           " of the scene is outside of its range; the end is the start\n");
  }
  if (scaled(start.data()); done_[0].failed)
    throw Error(fmt::format("the first run, with {}, failed: {}; give values at which it succeeds by --set",
                            runs_.text(points_[0]), done_[0].status));
  const nlopt_algorithm by = method == "direct"       ? NLOPT_GN_ORIG_DIRECT_L
                             : method == "cobyla"     ? NLOPT_LN_COBYLA
                             : method == "neldermead" ? NLOPT_LN_NELDERMEAD
                                                      : NLOPT_LD_SLSQP;
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> nlopt(nlopt_create(by, static_cast<unsigned>(start.size())),
                                                                nlopt_destroy);
  Call call{*this, nlopt.get()};
  nlopt_set_lower_bounds1(nlopt.get(), 0);
  nlopt_set_upper_bounds1(nlopt.get(), 1);
  nlopt_set_xtol_abs1(nlopt.get(), tolerance());
  nlopt_set_min_objective(nlopt.get(), objective, &call);
  if (!slack.empty() && nlopt_add_inequality_mconstraint(nlopt.get(), static_cast<unsigned>(slack.size()), excesses,
                                                         &call, slack.data()) != NLOPT_SUCCESS)
    throw UsageError("--method: " + method + " takes no conditions; use slsqp, cobyla or direct");
  if (by == NLOPT_LD_SLSQP) scale_by_slope();
  nlopt_result why{};
  for (std::size_t from = 0; true; from = best()) {
    std::vector<double> u = start;
    double least = 0;
    why = nlopt_optimize(nlopt.get(), u.data(), &least);
    if (!conditions_.empty()) scaled(u.data());
    if (!ended_ && rescales()) {
      start = u;
      continue;
    }
    const auto [holds, better] = ranks_[best()];
    const double slight = tolerance() * (holds == kHolds ? objective_scale_ : 1);
    if (ended_ || holds > ranks_[from].first || better > ranks_[from].second + slight) break;
    // If all derivatives vanish it may be a maximum. Then one number at an end of its range is better.
    const std::size_t before = best();
    for (std::size_t k = 0; k < start.size(); ++k)
      for (const double end : {0.0, 1.0}) u = start, u[k] = end, scaled(u.data());
    if (best() == before) break;
    for (std::size_t k = 0; k < start.size(); ++k)
      start[k] = (points_[best()][k] - runs_.low(k)) / (runs_.high(k) - runs_.low(k));
  }
  progress_.finish();
  if (why == NLOPT_FORCED_STOP) return interrupt_.asked() ? "interrupted" : "the number of runs was reached (--runs)";
  if (!has_slopes_) return "runs next to the last point fail; try --method neldermead or cobyla";
  method_failed_ = why < 0 && why != NLOPT_ROUNDOFF_LIMITED;
  return method_failed_ ? "the method failed" : "converged";
}

#else

std::string Optimization::search(const std::string&) {
  throw FileError("NLopt was not there when lockstep was built; install libnlopt-dev, configure and build again");
}

#endif

Result optimize(const Arguments& args) {
  const Interrupt interrupt;
  Optimization all(args, interrupt);
  all.runs().check_files();
  const Optimized found = all.result(all.search(args["--method"]));
  Result result(all.runs().varied().loaded, kOptimizeFields, found);
  all.conclude(result);
  if (const std::string& picture = args["--picture"]; !picture.empty()) {
    all.draw(picture);
    result.files.push_back(picture);
  }
  if (interrupt.asked())
    result.code = kExitInterrupted;
  else if (!all.holds(all.best()) || all.method_failed())
    result.code = kExitFailure;
  return result;
}

}  // namespace

Command optimize_command() {
  return {
      "optimize",
      join({settings_options(),
            {Option{"--vary", "NAME=a:b", "a number that varies, and its range; may be repeated"}.needed().repeated(),
             {"--minimize", "FORMULA", "formula of columns and channels at the end of the run"},
             Option{"--maximize", "FORMULA", "the same, to be largest"}.without("--minimize"),
             Option{"--subject-to", "CONDITION", "condition at the end of the run, max(T) < 3 N m; may be repeated"}
                 .repeated(),
             Option{"--method", "NAME",
                    "default slsqp, by derivatives; cobyla and neldermead need none, direct looks in the whole range"}
                 .among("slsqp,cobyla,neldermead,direct"),
             {"--runs", "N", "runs at most; default 1000"},
             kWrite,
             {"--picture", "FILE.svg", "draw the objective of each run, as SVG and PNG"},
             kBeforeAfter,
             {"--quiet", "", "print errors only"},
             kJson.without("--quiet")}}),
      optimize,
      R"--(NAME and FORMULA are those of `lockstep find`. The search begins with the values of the scene, and finds a minimum
near them. There may be a lower one: begin elsewhere by --set, or look with --method direct first. Derivatives are those of
`lockstep sensitivity`, by two runs for each number. Use neldermead, or with conditions cobyla, for a formula with jumps or
kinks. A run that fails counts as the worst one so far. Exit code 1: the conditions held in no run;
the best run is then the one whose largest excess, relative to its start, is least.

Example:
  lockstep optimize samples/scenes/slider_crank.json --vary crank=100mm:200mm --minimize "max(drive_torque)")--",
      {&kOptimizeFields.schema()}};
}

}  // namespace lockstep
