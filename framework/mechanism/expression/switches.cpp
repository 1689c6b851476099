// Intervals rule out the spans of time in which nothing is decided anew; the rest is halved until single instants remain.
#include "framework/mechanism/expression/switches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "framework/mechanism/expression/evaluate.h"

namespace lockstep::expression {

bool switches(const Term& t) {
  if (t.kind == Term::Kind::less || t.kind == Term::Kind::less_equal || t.kind == Term::Kind::equal) return true;
  if (t.kind == Term::Kind::choose || t.kind == Term::Kind::conjunction || t.kind == Term::Kind::disjunction ||
      t.kind == Term::Kind::negation)
    return true;  // of a number, they tell it from zero
  if (t.kind != Term::Kind::call) return false;
  switch (t.function) {
    case Function::abs:
    case Function::sign:
    case Function::floor:
    case Function::ceil:
    case Function::round:
    case Function::mod:
    case Function::min:
    case Function::max:
      return true;
    default:
      return false;
  }
}

int parts_of(const Term& t, int (&parts)[3]) {
  using Kind = Term::Kind;
  parts[0] = t.a, parts[1] = t.b, parts[2] = t.c;
  switch (t.kind) {
    case Kind::constant:
    case Kind::variable:
      return 0;
    case Kind::negate:
    case Kind::negation:
    case Kind::power:
      return 1;
    case Kind::choose:
      return 3;
    case Kind::call: {
      const Function f = t.function;
      const bool two = f == Function::atan2 || f == Function::mod || f == Function::min || f == Function::max ||
                       f == Function::hypot;
      return two ? 2 : 1;
    }
    default:
      return 2;
  }
}

namespace {

/// A formula on a span of the time: whether all that one of its terms decides is decided there.
class Span {
 public:
  Span(const std::vector<Term>& terms, int target, int time)
      : terms_(terms), target_(target), time_(time), stands_for_(terms.size()) {}

  /// Also where the formula does not read the term.
  bool decided(Interval t) {
    t_ = t, decided_ = true;
    std::iota(stands_for_.begin(), stands_for_.end(), 0);
    of(static_cast<int>(terms_.size()) - 1);
    return decided_;
  }

 private:
  enum class Truth { no, yes, unknown };
  struct Sign {
    bool known;
    int s;
  };

  static bool is_point(const Interval& a) { return a.lo == a.hi && std::isfinite(a.lo); }
  static bool is_zero(const Interval& a) { return a.lo == 0 && a.hi == 0; }
  // f of intervals; of single numbers as the formula computes it, so that what is constant stays a single number.
  template <class F>
  static Interval apply(const Interval& a, F&& f) {
    if (!is_point(a)) return f(a);
    const double x = f(Time(a.lo)).v;
    return std::isfinite(x) ? Interval(x) : Interval::everything();
  }
  template <class F>
  static Interval apply(const Interval& a, const Interval& b, F&& f) {
    if (!is_point(a) || !is_point(b)) return f(a, b);
    const double x = f(Time(a.lo), Time(b.lo)).v;
    return std::isfinite(x) ? Interval(x) : Interval::everything();
  }
  static Interval product(const Interval& a, const Interval& b) {
    const auto bounded = [](const Interval& x) { return std::isfinite(x.lo) && std::isfinite(x.hi); };
    if ((is_zero(a) && bounded(b)) || (is_zero(b) && bounded(a))) return 0.0;
    return apply(a, b, [](const auto& x, const auto& y) { return x * y; });
  }
  static Interval difference(const Interval& a, const Interval& b) {
    return apply(a, b, [](const auto& x, const auto& y) { return x - y; });
  }
  static Interval quotient(const Interval& a, const Interval& b) {
    return apply(a, b, [](const auto& x, const auto& y) { return x / y; });
  }

  // Whether two terms are the same operations on this span, so that they are equal to the last bit.
  bool same(int i, int j) const {
    i = stands_for_[static_cast<std::size_t>(i)], j = stands_for_[static_cast<std::size_t>(j)];
    if (i == j) return true;
    const Term &a = terms_[static_cast<std::size_t>(i)], &b = terms_[static_cast<std::size_t>(j)];
    if (a.kind != b.kind || a.function != b.function || a.value != b.value) return false;
    if (a.kind == Term::Kind::variable) return a.a == b.a;
    int of_a[3], of_b[3];
    const int n = parts_of(a, of_a);
    parts_of(b, of_b);
    for (int k = 0; k < n; ++k)
      if (!same(of_a[k], of_b[k])) return false;
    return true;
  }
  // Term i is term `other` on this span.
  void stands(int i, int other) {
    stands_for_[static_cast<std::size_t>(i)] = stands_for_[static_cast<std::size_t>(other)];
  }

  // The sign of all of a, which term `by` decides on.
  Sign sign(const Interval& a, int by) {
    const int s = a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
    const bool known = s != 0 || is_zero(a);
    if (!known && by == target_) decided_ = false;
    return {known, s};
  }
  Sign compared(int i, int by, const Interval& a, int j, const Interval& b) {
    return same(i, j) ? Sign{true, 0} : sign(difference(a, b), by);
  }
  Sign compared(int i, int j, int by) {
    const Interval a = of(i), b = of(j);
    return compared(i, by, a, j, b);
  }
  static Truth truth(bool known, bool yes) { return !known ? Truth::unknown : yes ? Truth::yes : Truth::no; }

  // Term i as a condition of term `of_term`.
  Truth holds(int i, int of_term) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::less: {
        const Sign c = compared(t.a, t.b, i);
        return truth(c.known, c.s < 0);
      }
      case Term::Kind::less_equal: {
        const Sign c = compared(t.a, t.b, i);
        return truth(c.known, c.s <= 0);
      }
      case Term::Kind::equal: {
        const Sign c = compared(t.a, t.b, i);
        return truth(c.known, c.s == 0);
      }
      case Term::Kind::negation: {
        const Truth a = holds(t.a, i);
        return a == Truth::unknown ? a : truth(true, a == Truth::no);
      }
      case Term::Kind::conjunction: {
        const Truth a = holds(t.a, i);
        if (a != Truth::unknown) return a == Truth::no ? a : holds(t.b, i);
        return holds(t.b, i) == Truth::no ? Truth::no : a;
      }
      case Term::Kind::disjunction: {
        const Truth a = holds(t.a, i);
        if (a != Truth::unknown) return a == Truth::yes ? a : holds(t.b, i);
        return holds(t.b, i) == Truth::yes ? Truth::yes : a;
      }
      default: {
        const Sign c = sign(of(i), of_term);
        return truth(c.known, c.s != 0);
      }
    }
  }

  Interval steps(const Interval& a, int by) {  // floor
    if (is_point(a)) return std::floor(a.lo);
    const Interval wide = interval_detail::widened(a.lo, a.hi);
    const double lo = std::floor(wide.lo), hi = std::floor(wide.hi);
    if (!(lo == hi) && by == target_) decided_ = false;
    return {lo, hi};
  }
  Interval rounded(const Interval& a, int by) {
    if (is_point(a)) return std::round(a.lo);
    const Interval wide = interval_detail::widened(a.lo, a.hi);
    const double lo = std::round(wide.lo), hi = std::round(wide.hi);
    if (!(lo == hi) && by == target_) decided_ = false;
    return {lo, hi};
  }

  Interval of(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::constant:
        return t.value;
      case Term::Kind::variable:
        return t.a == time_ ? t_ : Interval::everything();
      case Term::Kind::add: {
        const Interval a = of(t.a), b = of(t.b);
        return apply(a, b, [](const auto& x, const auto& y) { return x + y; });
      }
      case Term::Kind::subtract: {
        const Interval a = of(t.a), b = of(t.b);
        return difference(a, b);
      }
      case Term::Kind::multiply: {
        const Interval a = of(t.a), b = of(t.b);
        return product(a, b);
      }
      case Term::Kind::divide: {
        const Interval a = of(t.a), b = of(t.b);
        return quotient(a, b);
      }
      case Term::Kind::negate:
        return -of(t.a);
      case Term::Kind::power: {
        const Interval a = of(t.a);
        if (!is_point(a)) return pow(a, t.value);
        return apply(a, [&](const auto& x) { return power(x, t.value); });
      }
      case Term::Kind::raise: {
        const Interval a = of(t.a), b = of(t.b);
        return apply(a, b, [](const auto& x, const auto& y) { return exp(y * log(x)); });
      }
      case Term::Kind::choose: {
        const Truth c = holds(t.a, i);
        if (c == Truth::unknown) {
          const Interval b = of(t.b);
          return hull(b, of(t.c));
        }
        const int chosen = c == Truth::yes ? t.b : t.c;
        const Interval x = of(chosen);
        return stands(i, chosen), x;
      }
      case Term::Kind::call:
        return call(i);
      default: {
        const Truth c = holds(i, i);
        return c == Truth::unknown ? Interval(0, 1) : Interval(c == Truth::yes ? 1 : 0);
      }
    }
  }
  static Interval power(const Interval& a, double p) { return pow(a, p); }
  static Time power(const Time& a, double p) { return power_of(a, p); }

  Interval call(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    const Interval x = of(t.a);
    switch (t.function) {
      case Function::sin:
        return apply(x, [](const auto& a) { return sin(a); });
      case Function::cos:
        return apply(x, [](const auto& a) { return cos(a); });
      case Function::tan:
        return apply(x, [](const auto& a) { return tan(a); });
      case Function::asin:
        return apply(x, [](const auto& a) { return asin(a); });
      case Function::acos:
        return apply(x, [](const auto& a) { return acos(a); });
      case Function::atan:
        return apply(x, [](const auto& a) { return atan(a); });
      case Function::atan2: {
        const Interval y = of(t.b);
        return apply(x, y, [](const auto& a, const auto& b) { return atan2(a, b); });
      }
      case Function::sinh:
        return apply(x, [](const auto& a) { return sinh(a); });
      case Function::cosh:
        return apply(x, [](const auto& a) { return cosh(a); });
      case Function::tanh:
        return apply(x, [](const auto& a) { return tanh(a); });
      case Function::sqrt:
        return apply(x, [](const auto& a) { return sqrt(a); });
      case Function::exp:
        return apply(x, [](const auto& a) { return exp(a); });
      case Function::log:
        return apply(x, [](const auto& a) { return log(a); });
      case Function::abs: {
        const Sign c = sign(x, i);
        if (c.known && c.s >= 0) stands(i, t.a);
        return abs(x);
      }
      case Function::sign: {
        const Sign c = sign(x, i);
        return c.known ? Interval(c.s) : Interval(-1, 1);
      }
      case Function::floor:
        return steps(x, i);
      case Function::ceil:
        return -steps(-x, i);
      case Function::round:
        return rounded(x, i);
      case Function::mod: {
        const Interval y = of(t.b);
        return difference(x, product(y, steps(quotient(x, y), i)));
      }
      case Function::min:
      case Function::max: {
        const Interval y = of(t.b);
        const Sign c = compared(t.a, i, x, t.b, y);
        if (!c.known) return t.function == Function::min ? least(x, y) : -least(-x, -y);
        const bool first = c.s == 0 || (c.s < 0) == (t.function == Function::min);
        return stands(i, first ? t.a : t.b), first ? x : y;
      }
      case Function::hypot: {
        const Interval y = of(t.b);
        if (is_point(x) && is_point(y))
          return apply(x, y, [](const auto& a, const auto& b) { return sqrt(a * a + b * b); });
        return sqrt(square(x) + square(y));
      }
      default:
        return Interval::everything();
    }
  }
  static Interval least(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)}; }

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
    variables_[static_cast<std::size_t>(time_)] = Time(t, 1.0, 0.0);
    Decisions signature{target_};
    TermEvaluation<Time, Decisions>(terms_, variables_, signature).value(target_);
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

}  // namespace

Found find_switches(const std::vector<Term>& terms, int term, int time, double t0, double t1,
                    std::vector<double>& out) {
  return SwitchSearch(terms, term, time).find(t0, t1, out);
}

}  // namespace lockstep::expression
