// SPDX-License-Identifier: BSD-3-Clause
// The evaluation of a compiled formula on any number type.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include <lockstep/author/jet.h>
#include "framework/mechanism/expression/function.h"

namespace lockstep::expression {

/// -1, 0 or 1 for a < 0, a = 0, a > 0. Of a jet that is zero: what it is just afterwards.
inline int side(double a) { return int(a > 0) - int(a < 0); }
template <int N, class T, class D>
int side(const Jet<N, T, D>& a) {
  if (const int s = side(a.v)) return s;
  if constexpr (std::is_same_v<D, double>) {
    if (const int s = side(a.d)) return s;
    return side(a.h);
  }
  return 0;
}

/// Notes no decision. `term`: the one that decides, by a number.
struct NoWitness {
  void decided(int /*what*/, int /*term*/, const auto& /*number*/) {}
  void computed(const Term& /*term*/, const auto& /*x*/, const auto& /*y*/) {}
};
/// Makes one number of the decisions of one term of an evaluation.
struct Decisions : NoWitness {
  int term;
  std::uint64_t hash = 1469598103934665603u;
  explicit Decisions(int of) : term(of) {}
  void decided(int what, int by, const auto& /*number*/) {
    if (by == term) hash = (hash ^ static_cast<std::uint64_t>(what + 7)) * 1099511628211u;
  }
};

/// The whole number nearest to a, of two the one away from zero. Of a jet that moves between two: what it is just
/// afterwards.
template <class T>
double nearest(const T& a) {
  const double v = lockstep::value_of(a);
  const int s = std::abs(v - std::trunc(v)) == 0.5 ? side(a - T(v)) : 0;
  return s > 0 ? std::ceil(v) : s < 0 ? std::floor(v) : std::round(v);
}

/// a^n by products, so that a may be zero.
template <class T>
T whole_power(const T& a, int n) {
  if (n < 0) return T(1.0) / whole_power(a, -n);
  T result = T(1.0), square = a;
  for (bool first = true; n > 0; n /= 2) {
    if (n % 2 == 1) result = first ? square : T(result * square), first = false;
    if (n > 1) square = square * square;
  }
  return result;
}

/// a^p.
template <class T>
T power_of(const T& a, double p) {
  using std::pow;
  if constexpr (!std::is_same_v<T, double>)
    if (p == std::round(p) && std::abs(p) <= 64) return whole_power(a, int(p));
  return pow(a, p);
}

/// The value of a table at x.
template <class T>
T of_table(const MotionLaw& table, const T& x) {
  const LawValue y = table.at(lockstep::value_of(x));
  if constexpr (std::is_same_v<T, double>)
    return y.y;
  else
    return jet_detail::chain(x, y.y, y.yd, y.ydd);
}

template <class T>
T square(const T& a) {
  return a * a;
}

/// A function that decides nothing, on numbers, jets and intervals; `y` is read by what takes two.
template <class T>
T applied(Function f, const T& x, const T& y) {
  using std::acos, std::asin, std::atan, std::atan2, std::cos, std::cosh, std::exp, std::log, std::sin, std::sinh,
      std::sqrt, std::tan, std::tanh;
  if (f == Function("sin")) return sin(x);
  if (f == Function("cos")) return cos(x);
  if (f == Function("tan")) return tan(x);
  if (f == Function("asin")) return asin(x);
  if (f == Function("acos")) return acos(x);
  if (f == Function("atan")) return atan(x);
  if (f == Function("atan2")) return atan2(x, y);
  if (f == Function("sinh")) return sinh(x);
  if (f == Function("cosh")) return cosh(x);
  if (f == Function("tanh")) return tanh(x);
  if (f == Function("sqrt")) return sqrt(x);
  if (f == Function("exp")) return exp(x);
  if (f == Function("log")) return log(x);
  if constexpr (std::is_same_v<T, double>) return std::hypot(x, y);
  return sqrt(square(x) + square(y));  // hypot
}

/// What a term computes that decides nothing. Inlined: of sums and products the calls would cost as much.
template <class T>
[[gnu::always_inline]] inline T computed(const Term& t, const T& x, const T& y) {
  using std::exp, std::log;
  const Operation o = t.operation;
  if (o == Operation::add) return x + y;
  if (o == Operation::subtract) return x - y;
  if (o == Operation::multiply) return x * y;
  if (o == Operation::divide) return x / y;
  if (o == Operation::negate) return -x;
  if (o == Operation::call) return t.table ? of_table(*t.table, x) : applied(t.function, x, y);
  return t.n_parts == 1 ? power_of(x, t.value) : T(exp(y * log(x)));
}

/// Whether a condition holds; open: it holds at some of the values that are looked at.
enum class Truth { no, yes, open };

/// A term on values of type T: numbers, jets or intervals. `Values` says what the variables are, and what is decided of
/// such values. Where it leaves a sign open, both outcomes are taken together.
template <class T, class Values>
class TermEvaluation {
 public:
  TermEvaluation(const std::vector<Term>& terms, Values& values) : terms_(terms), values_(values) {}

  T of(int i) {
    const Term& t = term(i);
    if (t.operation == Operation::number) return T(t.value);
    if (t.operation == Operation::name) return values_.variable(t.variable);
    if (t.decides) return decided(i);
    const T x = of(t.parts[0]);
    if (t.n_parts == 1) return values_.computed(t, x, x);
    const T y = of(t.parts[1]);
    return values_.computed(t, x, y);
  }

 private:
  using Sign = std::optional<int>;
  const Term& term(int i) const { return terms_[i]; }

  T decided(int i) {
    const Operation o = term(i).operation;
    return o == Operation::choose ? chosen(i) : o == Operation::call ? called(i) : condition(i);
  }

  T condition(int i) {
    const Truth c = holds(i, i);
    return c == Truth::open ? values_.either(T(0.0), T(1.0)) : T(c == Truth::yes ? 1.0 : 0.0);
  }

  T chosen(int i) {
    const Term& t = term(i);
    const Truth c = holds(t.parts[0], i);
    if (c == Truth::open) {
      const T first = of(t.parts[1]);
      return values_.either(first, of(t.parts[2]));
    }
    const int part = t.parts[c == Truth::yes ? 1 : 2];
    T x = of(part);
    values_.stands(i, part);
    return x;
  }

  // Term i as a condition of term `by`, which separates a number from zero.
  Truth holds(int i, int by) {
    const Term& t = term(i);
    const auto truth = [](Sign s, auto&& is) { return !s ? Truth::open : is(*s) ? Truth::yes : Truth::no; };
    const auto difference = [&] {
      const T x = of(t.parts[0]), y = of(t.parts[1]);
      return values_.compared(t.parts[0], x, t.parts[1], y, i);
    };
    if (t.operation == Operation::less) return truth(difference(), [](int s) { return s < 0; });
    if (t.operation == Operation::less_equal) return truth(difference(), [](int s) { return s <= 0; });
    if (t.operation == Operation::equal) return truth(difference(), [](int s) { return s == 0; });
    if (!is_condition(t.operation)) return truth(values_.sign(of(i), by), [](int s) { return s != 0; });
    const Truth first = holds(t.parts[0], i);
    if (t.operation == Operation::negation)
      return first == Truth::open ? first : first == Truth::no ? Truth::yes : Truth::no;
    const Truth settles = t.operation == Operation::conjunction ? Truth::no : Truth::yes;
    if (first == settles) return first;
    const Truth second = holds(t.parts[1], i);
    return first != Truth::open || second == settles ? second : first;
  }

  // A function that decides.
  T called(int i) {
    using std::abs;
    const Term& t = term(i);
    const T x = of(t.parts[0]);
    if (t.function == Function("floor")) return T(values_.floor(x, i));
    if (t.function == Function("ceil")) return T(-values_.floor(-x, i));
    if (t.function == Function("round")) return T(values_.round(x, i));
    if (t.n_parts == 1) {
      const Sign s = values_.sign(x, i);
      if (t.function == Function("sign")) return s ? T(double(*s)) : values_.either(T(-1.0), T(1.0));
      if (s && *s >= 0) values_.stands(i, t.parts[0]);
      if constexpr (std::is_same_v<T, double>) return abs(x);
      return !s ? T(abs(x)) : *s < 0 ? T(-x) : x;
    }
    const T y = of(t.parts[1]);
    if (t.function == Function("mod")) return values_.mod(x, y, i);
    const bool least = t.function == Function("min");
    const Sign s = values_.compared(t.parts[0], x, t.parts[1], y, i);
    if (!s) return least ? values_.least(x, y) : T(-values_.least(-x, -y));
    const bool first = *s == 0 || (*s < 0) == least;
    return values_.stands(i, t.parts[first ? 0 : 1]), first ? x : y;
  }

  const std::vector<Term>& terms_;
  Values& values_;
};

/// Numbers or jets as values of terms: all is decided, and reported to the witness.
template <class T, class Witness>
class Numbers {
 public:
  Numbers(std::span<const T> variables, Witness& witness) : variables_(variables), witness_(witness) {}

  const T& variable(int k) const { return variables_[k]; }
  [[gnu::always_inline]] T computed(const Term& t, const T& x, const T& y) {
    witness_.computed(t, x, y);
    return expression::computed(t, x, y);
  }
  std::optional<int> sign(const T& a, int by) {
    lost_ = lost_ || std::isnan(lockstep::value_of(a));
    const int s = side(a);
    return witness_.decided(s, by, a), s;
  }
  std::optional<int> compared(int /*i*/, const T& x, int /*j*/, const T& y, int by) { return sign(x - y, by); }
  // The whole number at or below a; of a jet on a whole number that falls, the one below.
  double floor(const T& a, int by) {
    const double at = lockstep::value_of(a), v = std::floor(at);
    return whole(at == v && side(a - T(v)) < 0 ? v - 1 : v, by, a);
  }
  double round(const T& a, int by) { return whole(nearest(a), by, a); }
  T mod(const T& x, const T& y, int by) { return x - y * floor(x / y, by); }
  void stands(int /*i*/, int /*other*/) {}
  static T either(const T& x, const T& /*y*/) { return x; }
  static T least(const T& x, const T& /*y*/) { return x; }
  /// Whether a comparison was of what is NaN.
  bool lost() const { return lost_; }

 private:
  double whole(double n, int by, const T& of) {
    // far whole numbers may share a mark: neighbours differ
    return witness_.decided(std::abs(n) < 1e9 ? int(n) : 0, by, of), n;
  }

  std::span<const T> variables_;
  Witness& witness_;
  bool lost_ = false;
};

/// The value of term i; NaN where a comparison is of what is NaN.
template <class T, class Witness = NoWitness>
T value_of_term(const std::vector<Term>& terms, std::size_t i, std::span<const T> variables, Witness&& witness = {}) {
  Numbers<T, std::remove_reference_t<Witness>> numbers(variables, witness);
  const T result = TermEvaluation<T, decltype(numbers)>(terms, numbers).of(static_cast<int>(i));
  return numbers.lost() ? T(std::numeric_limits<double>::quiet_NaN()) : result;
}

template <class T>
T FormulaFunction::operator()(std::span<const T> variables) const {
  return value_of_term(terms_, terms_.size() - 1, variables);
}

}  // namespace lockstep::expression
