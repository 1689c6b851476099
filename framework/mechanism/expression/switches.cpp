// Intervals rule out the spans of time in which nothing is decided anew; the rest is halved until single instants remain.
#include "framework/mechanism/expression/switches.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// A formula on a span of the time: whether all that switches in it is decided there.
class Span {
 public:
  Span(const std::vector<Term>& terms, int time, Interval t) : terms_(terms), time_(time), t_(t) {}

  bool decided(int root) { return of(root), decided_; }

 private:
  enum class Truth { no, yes, unknown };

  // The sign of all of a, 0 where it is not known.
  int sign(const Interval& a) {
    const int s = a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
    if (s == 0) decided_ = false;
    return s;
  }
  Truth truth(bool known, bool yes) { return !known ? Truth::unknown : yes ? Truth::yes : Truth::no; }

  Truth holds(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::less:
      case Term::Kind::less_equal: {
        const int s = sign(of(t.a) - of(t.b));
        return truth(s != 0, s < 0);
      }
      case Term::Kind::equal:
        return truth(sign(of(t.a) - of(t.b)) != 0, false);
      case Term::Kind::negation: {
        const Truth a = holds(t.a);
        return a == Truth::unknown ? a : truth(true, a == Truth::no);
      }
      case Term::Kind::conjunction: {
        const Truth a = holds(t.a);
        return a == Truth::no ? a : a == Truth::yes ? holds(t.b) : (holds(t.b), a);
      }
      case Term::Kind::disjunction: {
        const Truth a = holds(t.a);
        return a == Truth::yes ? a : a == Truth::no ? holds(t.b) : (holds(t.b), a);
      }
      case Term::Kind::constant:
        return truth(true, t.value != 0);
      default:
        return truth(sign(of(i)) != 0, true);
    }
  }

  Interval steps(const Interval& a) {  // floor
    const double lo = std::floor(a.lo), hi = std::floor(a.hi);
    if (!(lo == hi)) decided_ = false;
    return {lo, hi};
  }

  Interval of(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::constant:
        return t.value;
      case Term::Kind::variable:
        return t.a == time_ ? t_ : Interval::everything();
      case Term::Kind::add:
        return of(t.a) + of(t.b);
      case Term::Kind::subtract:
        return of(t.a) - of(t.b);
      case Term::Kind::multiply:
        return of(t.a) * of(t.b);
      case Term::Kind::divide:
        return of(t.a) / of(t.b);
      case Term::Kind::negate:
        return -of(t.a);
      case Term::Kind::power:
        return pow(of(t.a), t.value);
      case Term::Kind::raise:
        return exp(of(t.b) * log(of(t.a)));
      case Term::Kind::choose: {
        const Truth c = holds(t.a);
        if (c != Truth::unknown) return of(c == Truth::yes ? t.b : t.c);
        return hull(of(t.b), of(t.c));
      }
      case Term::Kind::call:
        return call(t);
      default: {
        const Truth c = holds(i);
        return c == Truth::unknown ? Interval(0, 1) : Interval(c == Truth::yes ? 1 : 0);
      }
    }
  }

  Interval call(const Term& t) {
    const Interval x = of(t.a);
    switch (t.function) {
      case Function::sin:
        return sin(x);
      case Function::cos:
        return cos(x);
      case Function::tan:
        return tan(x);
      case Function::asin:
        return asin(x);
      case Function::acos:
        return acos(x);
      case Function::atan:
        return atan(x);
      case Function::atan2:
        return atan2(x, of(t.b));
      case Function::sinh:
        return sinh(x);
      case Function::cosh:
        return cosh(x);
      case Function::tanh:
        return tanh(x);
      case Function::sqrt:
        return sqrt(x);
      case Function::exp:
        return exp(x);
      case Function::log:
        return log(x);
      case Function::abs:
        return sign(x), abs(x);
      case Function::sign: {
        const int s = sign(x);
        return s == 0 ? Interval(-1, 1) : Interval(s);
      }
      case Function::floor:
        return steps(x);
      case Function::ceil:
        return -steps(-x);
      case Function::round:
        return steps(x + Interval(0.5));
      case Function::mod: {
        const Interval y = of(t.b);
        return x - y * steps(x / y);
      }
      case Function::min:
      case Function::max: {
        const Interval y = of(t.b);
        const int s = sign(x - y);
        const bool first = (s < 0) == (t.function == Function::min);
        return s == 0 ? hull(x, y) : first ? x : y;
      }
      case Function::hypot: {
        const Interval y = of(t.b);
        return sqrt(square(x) + square(y));
      }
      default:
        return Interval::everything();
    }
  }

  const std::vector<Term>& terms_;
  int time_;
  Interval t_;
  bool decided_ = true;
};

/// Finds where the decisions of one term change.
class SwitchSearch {
 public:
  SwitchSearch(const std::vector<Term>& terms, int time, int root)
      : terms_(terms), time_(time), root_(root), variables_(static_cast<std::size_t>(time) + 1) {}

  void find(double t0, double t1, std::vector<double>& out) {
    constexpr int kMostInVain = 20'000;  // spans; beyond them, only the ends of a span are looked at
    const double least = 1e-13 * std::max(std::abs(t0), std::abs(t1));
    std::vector<std::pair<double, double>> left = {{t0, t1}};
    int in_vain = 0;
    while (!left.empty()) {
      const auto [a, b] = left.back();
      left.pop_back();
      if (Span(terms_, time_, {a, b}).decided(root_)) continue;
      const double middle = a + 0.5 * (b - a);
      if (b - a > least && a < middle && middle < b && ++in_vain < kMostInVain) {
        left.emplace_back(middle, b), left.emplace_back(a, middle);
        continue;
      }
      const double at = changed(a, b);
      if (t0 < at && at < t1) out.push_back(at), in_vain = 0;
    }
  }

 private:
  std::uint64_t decisions(double t) {
    variables_[static_cast<std::size_t>(time_)] = Time(t, 1.0, 0.0);
    Decisions signature;
    TermEvaluation<Time, Decisions>(terms_, variables_, signature).value(root_);
    return signature.hash;
  }
  // The first number in (a, b] where the decisions are no more those at a; NaN if there is none at b.
  double changed(double a, double b) {
    const std::uint64_t before = decisions(a);
    if (decisions(b) == before) return std::numeric_limits<double>::quiet_NaN();
    for (double middle = a + 0.5 * (b - a); a < middle && middle < b; middle = a + 0.5 * (b - a))
      (decisions(middle) == before ? a : b) = middle;
    return b;
  }

  const std::vector<Term>& terms_;
  int time_, root_;
  std::vector<Time> variables_;
};

}  // namespace

void find_switches(const std::vector<Term>& terms, int root, int time, double t0, double t1, std::vector<double>& out) {
  SwitchSearch(terms, time, root).find(t0, t1, out);
}

}  // namespace lockstep::expression
