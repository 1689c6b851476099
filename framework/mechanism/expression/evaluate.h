// The evaluation of a compiled formula on any number type.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
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

/// Notes no decision. `term`: the one that decides.
struct NoWitness {
  void decided(int /*what*/, int /*term*/) {}
};
/// Makes one number of the decisions of one term of an evaluation.
struct Decisions {
  int term;
  std::uint64_t hash = 1469598103934665603u;
  void decided(int what, int by) {
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
  if (p == std::round(p) && std::abs(p) <= 64) return whole_power(a, int(p));
  return pow(a, p);
}

template <class T, class Witness>
class TermEvaluation {
 public:
  TermEvaluation(const std::vector<Term>& terms, std::span<const T> variables, Witness& witness)
      : terms_(terms), variables_(variables), witness_(witness) {}

  /// The value of term i; NaN where a comparison is of what is NaN.
  T value(int i) {
    const T result = of(i);
    return lost_ ? T(std::numeric_limits<double>::quiet_NaN()) : result;
  }

 private:
  T of(int i) {
    using std::exp, std::log;
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::constant:
        return T(t.value);
      case Term::Kind::variable:
        return variables_[static_cast<std::size_t>(t.a)];
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
        return power_of(of(t.a), t.value);
      case Term::Kind::raise:
        return exp(of(t.b) * log(of(t.a)));
      case Term::Kind::choose:
        return holds(t.a, i) ? of(t.b) : of(t.c);
      case Term::Kind::call:
        return call(i);
      default:
        return T(holds(i, i) ? 1.0 : 0.0);
    }
  }

  int decide(const T& a, int by) {
    lost_ = lost_ || std::isnan(lockstep::value_of(a));
    const int s = side(a);
    return witness_.decided(s, by), s;
  }

  // Term i as a condition of term `of_term`, which tells a number from zero.
  bool holds(int i, int of_term) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::less:
        return decide(of(t.a) - of(t.b), i) < 0;
      case Term::Kind::less_equal:
        return decide(of(t.a) - of(t.b), i) <= 0;
      case Term::Kind::equal:
        return decide(of(t.a) - of(t.b), i) == 0;
      case Term::Kind::negation:
        return !holds(t.a, i);
      case Term::Kind::conjunction:
        return holds(t.a, i) && holds(t.b, i);
      case Term::Kind::disjunction:
        return holds(t.a, i) || holds(t.b, i);
      default:
        return decide(of(i), of_term) != 0;
    }
  }

  // The whole number at or below a; of a jet on a whole number that falls, the one below.
  double below(const T& a, int by) {
    const double at = lockstep::value_of(a), v = std::floor(at);
    const double n = at == v && side(a - T(v)) < 0 ? v - 1 : v;
    return whole(n, by);
  }
  double whole(double n, int by) {
    // far whole numbers may share a mark: neighbours differ
    return witness_.decided(std::abs(n) < 1e9 ? int(n) : 0, by), n;
  }

  T call(int i) {
    using std::acos, std::asin, std::atan, std::atan2, std::cos, std::cosh, std::exp, std::log, std::sin, std::sinh,
        std::sqrt, std::tan, std::tanh;
    const Term& t = terms_[static_cast<std::size_t>(i)];
    const T x = of(t.a);
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
        return decide(x, i) < 0 ? T(-x) : x;
      case Function::sign:
        return T(double(decide(x, i)));
      case Function::floor:
        return T(below(x, i));
      case Function::ceil:
        return T(-below(-x, i));
      case Function::round:
        return T(whole(nearest(x), i));
      case Function::mod: {
        const T y = of(t.b);
        return x - y * below(x / y, i);
      }
      case Function::min: {
        const T y = of(t.b);
        return decide(x - y, i) <= 0 ? x : y;
      }
      case Function::max: {
        const T y = of(t.b);
        return decide(x - y, i) >= 0 ? x : y;
      }
      case Function::hypot: {
        const T y = of(t.b);
        return sqrt(x * x + y * y);
      }
      default:
        return x;
    }
  }

  const std::vector<Term>& terms_;
  std::span<const T> variables_;
  Witness& witness_;
  bool lost_ = false;
};

template <class T>
T FormulaFunction::operator()(std::span<const T> variables) const {
  NoWitness witness;
  return TermEvaluation<T, NoWitness>(terms_, variables, witness).value(static_cast<int>(terms_.size()) - 1);
}

}  // namespace lockstep::expression
