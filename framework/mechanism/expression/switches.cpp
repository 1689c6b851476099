// SPDX-License-Identifier: BSD-3-Clause
// Where the comparisons of a formula switch. Intervals rule out the spans of time in which nothing is decided anew; the
// rest is halved until single instants remain.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/interval.h"

namespace lockstep::expression {
namespace {

constexpr std::size_t kMostSwitches = 1'000'000;  // more are not looked for

// What a search for switches has found; `some`: a term is not separated from zero over an interval, which may contain more.
enum class Found { all, some, too_many };

/// Intervals as values of terms, on a span of the time: whether all that one of the terms decides is decided there.
class Span {
 public:
  Span(const std::vector<Term>& terms, int target, int time)
      : terms_(terms), target_(target), time_(time), stands_for_(terms.size()) {}

  /// Also where the formula does not read the term.
  bool decided(Interval t) {
    t_ = t, decided_ = true;
    std::iota(stands_for_.begin(), stands_for_.end(), 0);
    TermEvaluation<Interval, Span>(terms_, *this).of(static_cast<int>(terms_.size()) - 1);
    return decided_;
  }

  Interval variable(int k) const { return k == time_ ? t_ : Interval::everything(); }
  // Of single numbers as the formula computes it, so that what is constant stays a single number.
  static Interval computed(const Term& t, const Interval& x, const Interval& y) {
    const auto bounded = [](const Interval& a) { return std::isfinite(a.lo) && std::isfinite(a.hi); };
    if (t.operation == Operation::multiply && ((is_zero(x) && bounded(y)) || (is_zero(y) && bounded(x)))) return 0.0;
    if (!is_point(x) || !is_point(y)) return expression::computed(t, x, y);
    const double v = expression::computed(t, Time(x.lo), Time(y.lo)).v;
    return std::isfinite(v) ? Interval(v) : Interval::everything();
  }
  // The sign of all of a, which term `by` decides on.
  std::optional<int> sign(const Interval& a, int by) {
    if (a.lo > 0 || a.hi < 0 || is_zero(a)) return a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
    if (by == target_) decided_ = false;
    return {};
  }
  std::optional<int> compared(int i, const Interval& x, int j, const Interval& y, int by) {
    return same(i, j) ? 0 : sign(computed({Operation::subtract}, x, y), by);
  }
  Interval floor(const Interval& a, int by) { return whole(a, by, std::floor); }
  Interval round(const Interval& a, int by) { return whole(a, by, std::round); }
  Interval mod(const Interval& x, const Interval& y, int by) {
    const Interval n = floor(computed({Operation::divide}, x, y), by);
    return computed({Operation::subtract}, x, computed({Operation::multiply}, y, n));
  }
  // Term i is term `other` on this span.
  void stands(int i, int other) { stands_for_[i] = stands_for_[other]; }
  static Interval either(const Interval& x, const Interval& y) { return hull(x, y); }
  static Interval least(const Interval& x, const Interval& y) { return {std::min(x.lo, y.lo), std::min(x.hi, y.hi)}; }

 private:
  static bool is_point(const Interval& a) { return a.lo == a.hi && std::isfinite(a.lo); }
  static bool is_zero(const Interval& a) { return a.lo == 0 && a.hi == 0; }

  // Whether two terms are the same operations on this span, so that they are equal to the last bit.
  bool same(int i, int j) const {
    i = stands_for_[i], j = stands_for_[j];
    if (i == j) return true;
    const Term &a = terms_[i], &b = terms_[j];
    if (a.operation != b.operation || a.function != b.function || a.value != b.value || a.variable != b.variable ||
        a.n_parts != b.n_parts || a.table != b.table)
      return false;
    for (int k = 0; k < a.n_parts; ++k)
      if (!same(a.parts[k], b.parts[k])) return false;
    return true;
  }

  Interval whole(const Interval& a, int by, double (*f)(double)) {
    if (is_point(a)) return f(a.lo);
    const Interval wide = interval_detail::widened(a.lo, a.hi);
    const double lo = f(wide.lo), hi = f(wide.hi);
    if (!(lo == hi) && by == target_) decided_ = false;
    return {lo, hi};
  }

  const std::vector<Term>& terms_;
  int target_, time_;
  Interval t_;
  std::vector<int> stands_for_;  // of each term the one that it equals on this span
  bool decided_ = true;
};

/// Finds where the decisions of one term change.
class SwitchSearch {
 public:
  SwitchSearch(const std::vector<Term>& terms, int target, int time)
      : terms_(terms),
        target_(target),
        time_(time),
        variables_(static_cast<std::size_t>(time) + 1),
        span_(terms, target, time) {}

  // Appends the instants in (t0, t1), in any order, from which on what the term itself decides in the formula, which is
  // the last of the terms, is another than just before; the term reads no variable but the time.
  // All spans are halved before any is halved again, so that what stays undecided does not hide the rest.
  Found find(double t0, double t1, std::vector<double>& out) {
    constexpr std::size_t kMostInVain = 16'384;  // undecided spans of one size whose ends agree
    const double least = 1e-13 * std::max(std::abs(t0), std::abs(t1));
    std::vector<Part> level = {{t0, t1, decisions(t0), decisions(t1)}}, next;
    while (!level.empty()) {
      std::size_t vain = 0, certain = 0;
      next.clear();
      for (const Part& p : level) {
        if (span_.decided({p.a, p.b})) continue;
        next.push_back(p);
        ++(p.at_a == p.at_b ? vain : certain);
      }
      level.clear();
      const bool in_vain = vain > kMostInVain + 4 * certain || (certain > kMostInVain / 4 && noisy(next));
      for (const Part& p : next) {
        const double middle = p.a + 0.5 * (p.b - p.a);
        if (in_vain || !(p.b - p.a > least && p.a < middle && middle < p.b)) {
          const double at = changed(p);
          if (t0 < at && at < t1 && !(in_vain && is_noise(at))) out.push_back(at);
          continue;
        }
        const std::uint64_t at_middle = decisions(middle);
        level.push_back({p.a, middle, p.at_a, at_middle}), level.push_back({middle, p.b, at_middle, p.at_b});
      }
      if (in_vain) return Found::some;
      if (certain > kMostSwitches) return Found::too_many;
    }
    return Found::all;
  }

 private:
  struct Part {
    double a, b;
    std::uint64_t at_a, at_b;  // the decisions there
  };
  std::uint64_t decisions(double t) {
    variables_[time_] = Time(t, 1.0, 0.0);
    Decisions signature(target_);
    value_of_term(terms_, static_cast<std::size_t>(target_), std::span<const Time>(variables_), signature);
    return signature.hash;
  }
  // The first number in (a, b] where the decisions are no more those at a; NaN if there is none at b.
  double changed(const Part& p) {
    if (p.at_a == p.at_b) return std::numeric_limits<double>::quiet_NaN();
    double a = p.a, b = p.b;
    for (double middle = a + 0.5 * (b - a); a < middle && middle < b; middle = a + 0.5 * (b - a))
      (decisions(middle) == p.at_a ? a : b) = middle;
    return b;
  }

  // Whether the decisions change by round-off at this instant: again and again from one number to the next.
  bool is_noise(double at) {
    double before = std::nextafter(at, -1e300), after = at;
    const std::uint64_t was = decisions(before), is = decisions(after);
    for (int k = 0; k < 16; ++k) {
      before = std::nextafter(before, -1e300), after = std::nextafter(after, 1e300);
      if (decisions(before) != was || decisions(after) != is) return true;
    }
    return false;
  }
  // Whether most of some changes are of round-off.
  bool noisy(const std::vector<Part>& parts) {
    constexpr std::size_t kLooks = 64;
    int noise = 0, looks = 0;
    for (std::size_t i = 0; i < parts.size(); i += 1 + parts.size() / kLooks) {
      const double at = changed(parts[i]);
      if (!std::isnan(at)) ++looks, noise += is_noise(at) ? 1 : 0;
    }
    return 2 * noise > looks;
  }

  const std::vector<Term>& terms_;
  int target_, time_;
  std::vector<Time> variables_;
  Span span_;
};

/// Appends the instants in (t0, t1) from which on a table is beyond a breakpoint of its law, if its argument is linear in the
/// time there.
void pass_breakpoints(const std::vector<Term>& terms, const Term& table, int time, double t0, double t1,
                      std::vector<double>& out) {
  std::vector<Time> variables(static_cast<std::size_t>(time) + 1);
  const auto argument = [&](double t) {
    variables[time] = Time(t, 1.0, 0.0);
    return value_of_term(terms, static_cast<std::size_t>(table.parts[0]), std::span<const Time>(variables));
  };
  const double a = std::lerp(t0, t1, 0.25), b = std::lerp(t0, t1, 0.75);
  const Time x = argument(a), end = argument(b);
  const double bent = std::abs(end.v - x.v - x.d * (b - a)) + std::abs(end.d - x.d) * (b - a);
  if (x.d == 0 || !(bent <= kRoundOff * (std::abs(x.v) + std::abs(end.v)))) return;
  std::vector<double> at;
  const double first = x.v + x.d * (t0 - a), last = x.v + x.d * (t1 - a);
  table.table->breakpoints(std::min(first, last), std::max(first, last), at);
  // Laws count an argument slightly before a breakpoint as the breakpoint: one that falls is past it later.
  const double later = x.d < 0 ? 8 * kRoundOff * (std::abs(first) + std::abs(last)) : 0;
  for (const double point : at)
    if (const double t = a + (point - later - x.v) / x.d; t0 < t && t < t1) out.push_back(t);
}

}  // namespace

void FormulaFunction::breakpoints(int time, double t0, double t1, std::vector<double>& out) const {
  const bool has_tables = std::ranges::any_of(terms_, [](const Term& t) { return t.table != nullptr; });
  if (!(has_switches_ || has_tables) || !(t0 < t1) || !std::isfinite(t0) || !std::isfinite(t1)) return;
  // Of each term: whether it reads the time, and whether it reads another variable.
  std::vector<char> timed(terms_.size()), other(terms_.size());
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Term& t = terms_[i];
    if (t.operation == Operation::name) (t.variable == time ? timed : other)[i] = 1;
    for (int k = 0; k < t.n_parts; ++k) {
      const auto part = static_cast<std::size_t>(t.parts[k]);
      timed[i] |= timed[part], other[i] |= other[part];
    }
  }
  const std::size_t first = out.size();
  bool all = true;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (!terms_[i].decides || !timed[i] || other[i]) continue;
    const Found found = SwitchSearch(terms_, static_cast<int>(i), time).find(t0, t1, out);
    if (found == Found::too_many || out.size() - first > kMostSwitches)
      throw ModelError("formula \"" + text_ + "\" switches more than " + std::to_string(kMostSwitches) +
                       " times between t = " + text::brief(t0) + " and " + text::brief(t1) +
                       " s; reduce its switching, or simulate a shorter time");
    all = all && found == Found::all;
  }
  if (!all && warned_ && !warned_->exchange(true))
    report_finding({&finding::switches_unresolved, "formula \"" + text_ + "\"",
                    "not all switching times of formula \"" + text_ + "\" were found between t = " + text::brief(t0) +
                        " and " + text::brief(t1) + " s: its comparisons are equal over an interval",
                    "write it with fewer comparisons, min and max"});
  const auto sort_new = [&] {
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, out.end());
    out.erase(std::unique(begin, out.end()), out.end());
  };
  sort_new();
  std::vector<double> ends{t0};  // of spans in which all is decided
  ends.insert(ends.end(), out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  ends.push_back(t1);
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (terms_[i].table != nullptr && timed[i] && !other[i])
      for (std::size_t k = 1; k < ends.size(); ++k)
        succeeds([&] { pass_breakpoints(terms_, terms_[i], time, ends[k - 1], ends[k], out); });
  sort_new();
}

}  // namespace lockstep::expression
