// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/quantity.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/meet.h"

namespace lockstep::expression {
namespace {

Exponents scaled(const Exponents& e, double p) { return {p * e.m, p * e.kg, p * e.s, p * e.rad}; }
Exponents product(const Exponents& a, const Exponents& b, double sign) {
  return {a.m + sign * b.m, a.kg + sign * b.kg, a.s + sign * b.s, a.rad + sign * b.rad};
}

// An angle times a length is an arc: the radian goes.
Exponents settled(Exponents e) {
  if (e.m != 0 && e.rad > 0) e.rad = 0;
  return e;
}

std::optional<Dimension> whole(const Exponents& e) {
  const auto fits = [](double p) { return p == std::round(p) && std::abs(p) <= 6; };
  if (!fits(e.m) || !fits(e.kg) || !fits(e.s) || !fits(e.rad)) return std::nullopt;
  return Dimension{int(e.m), int(e.kg), int(e.s), int(e.rad)};
}

bool is_pure(const Amount& q) { return q.dimension == Exponents{}; }

Exponents without_radian(Exponents e) {
  e.rad = 0;
  return e;
}

// Of values with their dimensions; with `varies` of dimensions alone.
class Evaluation {
 public:
  Evaluation(const Expression& e, const Names& names, const Known& known, const Varies* varies = nullptr,
             std::string hint = {}, bool strict = false)
      : e_(e), names_(names), known_(known), varies_(varies), hint_(std::move(hint)), strict_(strict) {}

  Amount of(int i) const {
    const Node& n = e_.node(i);
    const Amount q = made(n);
    if (!of_values()) return q;
    if (!q.v.allFinite()) refuse(n, "its value is not finite" + operands(n));
    return q;
  }

 private:
  [[noreturn]] void refuse(const Node& n, const std::string& problem) const { e_.refuse(n, problem + hint_); }
  bool of_values() const { return varies_ == nullptr; }
  bool is_number(const Amount& q) const {
    return of_values() ? is_pure(q) : q.any || !q.with_unit || without_radian(q.dimension) == Exponents{};
  }
  bool varies(int i) const {
    const Node& n = e_.node(i);
    return (n.operation == Operation::name && (*varies_)(n.name)) ||
           std::any_of(n.children.begin(), n.children.end(), [&](int k) { return varies(k); });
  }
  Amount child(const Node& n, std::size_t k) const { return of(n.children[k]); }

  std::string operands(const Node& n) const {
    std::string words;
    for (const int k : n.children) words += (words.empty() ? "; it is of " : " and ") + words_of(of(k));
    return words;
  }

  Amount made(const Node& n) const {
    const Operation o = n.operation;
    if (o == Operation::number) return number(n);
    if (o == Operation::name) return named(n);
    if (o == Operation::negation) return Amount::number(truth(n, 0) ? 0 : 1);
    if (o == Operation::add || o == Operation::subtract) return sum(n);
    if (o == Operation::multiply || o == Operation::divide) return product_of(n);
    if (o == Operation::power) return power(n);
    if (o == Operation::conjunction || o == Operation::disjunction) return Amount::number(joined(n) ? 1 : 0);
    if (o == Operation::choose) return of_values() ? child(n, truth(n, 0) ? 1 : 2) : either(n);
    if (o == Operation::vector) return vector(n);
    if (o == Operation::call) return call(n);
    if (is_condition(o)) return compared(n);
    Amount q = child(n, 0);
    if (o == Operation::negate) {
      q.v = -q.v;
      return q;
    }
    if (!q.is_vector) refuse(n, "only a point or a vector has components; this is " + article_name_of(q));
    q.v = Vec3(q.v[n.index], 0, 0), q.is_vector = false;
    return q;
  }

  static Amount number(const Node& n) {
    Amount q = Amount::number(n.value);
    q.dimension = exponents_of(n.dimension), q.measured = n.measured, q.is_zero = n.value == 0 && !n.measured;
    q.with_unit = n.measured && n.dimension != Dimension{};
    return q;
  }

  Amount named(const Node& n) const {
    if (n.name == "pi") return Amount::number(kPi);
    if (const Amount* q = names_(n.name)) return *q;
    std::vector<std::string> known = known_ ? known_() : std::vector<std::string>{};
    known.emplace_back("pi");
    refuse(n, "unknown name \"" + n.name + "\"" + text::suggestion(n.name, known));
  }

  // Gives both the dimension of the one that has it; rejects two that differ. A literal 0 fits any. `a` is then what is
  // made of both.
  void unite(const Node& n, Amount& a, Amount& b, const char* how) const {
    if (!of_values()) settle(a, b);
    if (a.is_zero) a.dimension = b.dimension, a.measured = b.measured;
    if (b.is_zero) b.dimension = a.dimension, b.measured = a.measured;
    const Exponents other = settled(b.dimension);
    Exponents to = settled(a.dimension);
    if (of_values() ? to != other : without_radian(to) != without_radian(other))
      refuse(n, article_name_of(a) + " and " + article_name_of(b) + " are " + how +
                    (a.measured != b.measured ? "; give the number a unit, as in \"0.1 m\"" : ""));
    if (a.is_vector != b.is_vector) refuse(n, article_name_of(a) + " and " + article_name_of(b) + " are " + how);
    if (to.rad == 0) to.rad = other.rad;
    a.dimension = b.dimension = to;
    a.measured = a.measured || b.measured, a.is_zero = a.is_zero && b.is_zero;
  }

  // Of dimensions alone: what may be of any takes that of the other; without a unit both are numbers in SI.
  static void settle(Amount& a, Amount& b) {
    if (!a.with_unit && !b.with_unit && !a.is_zero && !b.is_zero && a.dimension != b.dimension) a.any = b.any = true;
    if (a.any) a.dimension = b.dimension, a.measured = b.measured;
    if (b.any) b.dimension = a.dimension, b.measured = a.measured;
    a.any = b.any = (a.any && (b.any || b.is_zero)) || (b.any && a.is_zero);
    a.with_unit = b.with_unit = a.with_unit || b.with_unit;
  }
  // Whether a product has a plain number as a factor of what varies.
  bool is_free(const Node& n, const Amount& a, const Amount& b) const {
    if (of_values()) return false;
    const bool a_varies = varies(n.children[0]), b_varies = varies(n.children[1]);
    return (!a.measured && !a_varies && b_varies && !(strict_ && b.with_unit)) ||
           (!b.measured && !b_varies && a_varies && !(strict_ && a.with_unit));
  }

  // The dimension of both sides of a choice.
  Amount either(const Node& n) const {
    truth(n, 0);
    Amount a = child(n, 1), b = child(n, 2);
    unite(n, a, b, "the two sides of one choice");
    return a;
  }

  Amount sum(const Node& n) const {
    Amount a = child(n, 0), b = child(n, 1);
    const double sign = n.operation == Operation::add ? 1 : -1;
    unite(n, a, b, sign > 0 ? "added" : "subtracted");
    a.v += sign * b.v;
    return a;
  }

  Amount product_of(const Node& n) const {
    const Amount a = child(n, 0), b = child(n, 1);
    const bool divides = n.operation == Operation::divide;
    if (divides && b.is_vector) refuse(n, "a division by a vector; write a / norm(b)");
    if (a.is_vector && b.is_vector) refuse(n, "a product of two vectors; write dot(a, b) or cross(a, b)");
    if (divides && b.v[0] == 0 && of_values()) refuse(n, "a division by zero");
    Amount q = divides || a.is_vector ? a : b;
    if (divides)
      q.v /= b.v[0];
    else
      q.v *= (a.is_vector ? b : a).v[0];
    q.dimension = product(a.dimension, b.dimension, divides ? -1 : 1);
    q.measured = a.measured || b.measured, q.is_zero = false;
    q.any = a.any || b.any || is_free(n, a, b), q.with_unit = a.with_unit || b.with_unit;
    return q;
  }

  // Of dimensions alone, of a quantity by a constant exponent.
  Amount power(const Node& n) const {
    Amount a = child(n, 0);
    const Amount p = child(n, 1);
    const double exponent = p.v[0];
    if (a.is_vector) refuse(n, "a power of a vector; write dot(a, a)");
    if (p.is_vector || !is_number(p))
      refuse(n, "the exponent is " + article_name_of(p) + "; a pure number is expected");
    if (of_values() && a.v[0] < 0 && exponent != std::round(exponent))
      refuse(n, text::brief(a.v[0]) + " to a power that is not whole");
    if (of_values() && a.v[0] == 0 && exponent < 0) refuse(n, "a division by zero: a negative power of 0");
    const bool fixed = of_values() || (!varies(n.children[1]) && std::isfinite(exponent));
    if (!fixed && !is_number(a))
      refuse(n, article_name_of(a) + " to a power that varies; a pure number is expected before the \"^\"");
    a.v[0] = std::pow(a.v[0], exponent), a.dimension = fixed ? scaled(a.dimension, exponent) : Exponents{};
    a.measured = a.measured || p.measured, a.is_zero = false;
    return a;
  }

  bool truth(const Node& n, std::size_t k) const {
    const Amount q = child(n, k);
    if (q.is_vector || !is_number(q))
      refuse(e_.node(n.children[k]), "a condition is expected, as in \"a > b\"; this is " + article_name_of(q));
    return q.v[0] != 0;
  }

  // Whether both conditions of n hold, or one of them; the second is looked at where it counts.
  bool joined(const Node& n) const {
    const bool all = n.operation == Operation::conjunction;
    const bool first = truth(n, 0);
    if (of_values() && first != all) return first;
    const bool second = truth(n, 1);
    return all ? first && second : first || second;
  }

  Amount compared(const Node& n) const {
    Amount a = child(n, 0), b = child(n, 1);
    unite(n, a, b, "compared");
    if (a.is_vector) refuse(n, "two vectors are compared; compare norm(a)");
    const double x = a.v[0], y = b.v[0];
    const Operation o = n.operation;
    const bool holds = o == Operation::less            ? x < y
                       : o == Operation::less_equal    ? x <= y
                       : o == Operation::greater       ? x > y
                       : o == Operation::greater_equal ? x >= y
                       : o == Operation::equal         ? x == y
                                                       : x != y;
    return Amount::number(holds ? 1 : 0);
  }

  Amount vector(const Node& n) const {
    Amount parts[3] = {child(n, 0), child(n, 1), child(n, 2)};
    Amount like = parts[0];
    for (const Amount& p : parts) {
      if (p.is_vector) refuse(n, "a component of a vector is a vector; write numbers");
      if (like.is_zero && !p.is_zero) like = p;
    }
    Amount q;
    q.is_vector = true, q.dimension = settled(like.dimension);
    for (int k = 0; k < 3; ++k) {
      Amount with = like;
      unite(n, with, parts[k], "components of one vector");
      q.v[k] = parts[k].v[0], q.measured = q.measured || parts[k].measured;
    }
    q.is_zero = like.is_zero;
    return q;
  }

  // -- functions
  [[noreturn]] void refuse_argument(const Node& n, const Amount& q, const char* expected) const {
    refuse(n,
           std::string(signature_of(n.function).name) + " of " + article_name_of(q) + "; " + expected + " is expected");
  }
  void check_range(const Node& n, const std::vector<Amount>& a) const {
    const double x = a[0].v[0];
    const Function f = n.function;
    const char* range = nullptr;
    if ((f == Function::asin || f == Function::acos) && !(std::abs(x) <= 1)) range = "from -1 to 1";
    if (f == Function::sqrt && !(x >= 0)) range = "0 or more";
    if (f == Function::log && !(x > 0)) range = "more than 0";
    if (range != nullptr) {
      std::string words = f == Function::sqrt || f == Function::log ? words_of(a[0]) : text::number(x),
                  with = ", with ";
      for (const std::string& name : names_in(e_))
        if (const Amount* const q = names_(name)) words += with + name + " = " + words_of(*q), with = ", ";
      words += std::string("; it must be ") + range;
      if (f == Function::acos || f == Function::sqrt)
        words += "; of a triangle, check that its sides can form one, and their units";
      refuse(n, std::string(signature_of(f).name) + " of " + words);
    }
    if (f == Function::mod && a[1].v[0] == 0) refuse(n, "mod by zero");
  }

  Amount call(const Node& n) const {
    if (n.function == Function::table) return of_table(n);
    std::vector<Amount> a;
    for (const int k : n.children) a.push_back(of(k));
    Amount q = Amount::number(0);
    for (const Amount& x : a) q.measured = q.measured || x.measured, q.with_unit = q.with_unit || x.with_unit;
    const Signature& f = signature_of(n.function);
    if (f.takes == Takes::places) return met(n, a);
    for (const Amount& x : a)
      if (x.is_vector != (f.takes == Takes::vectors)) refuse_argument(n, x, x.is_vector ? "a number" : "a vector");
    const bool pure = f.takes == Takes::pure || f.takes == Takes::angle;
    if (pure && !is_number(a[0]) && !(f.takes == Takes::angle && a[0].dimension == Exponents{0, 0, 0, 1}))
      refuse_argument(n, a[0], f.takes == Takes::angle ? "an angle or a pure number" : "a pure number");
    for (std::size_t k = 1; k < a.size() && f.takes == Takes::alike; ++k)
      unite(n, a[0], a[k], "arguments of one function");
    if (of_values()) check_range(n, a);
    q.any = a[0].any && (f.takes == Takes::alike || f.gives == Gives::alike || f.gives == Gives::root);
    if (f.gives == Gives::alike) q.dimension = a[0].dimension;
    if (f.gives == Gives::root) q.dimension = scaled(a[0].dimension, 0.5);
    if (f.gives == Gives::times_time) q.dimension = product(a[0].dimension, {0, 0, 1, 0}, 1);
    if (f.gives == Gives::by_time) q.dimension = product(a[0].dimension, {0, 0, 1, 0}, -1);
    if (f.gives == Gives::product) q.dimension = product(a[0].dimension, a[1].dimension, 1);
    if (f.gives == Gives::angle) q.dimension = {0, 0, 0, 1}, q.measured = true;
    if (f.gives == Gives::sign) q.measured = false;
    if (f.takes == Takes::vectors) return of_vectors(n.function, a, q);
    q.v[0] = a.size() == 1 ? value(n.function, a[0].v[0], a[0].v[0]) : a[0].v[0];
    for (std::size_t k = 1; k < a.size(); ++k) q.v[0] = value(n.function, q.v[0], a[k].v[0]);
    return q;
  }

  // Without a unit in its points its value is of any dimension.
  Amount of_table(const Node& n) const {
    if (of_values()) refuse(n, "a table is of the motion; formulas of parameters and points cannot read it");
    if (const Amount x = child(n, 1); x.is_vector) refuse_argument(n, x, "a number");
    const Amount* const table = names_(e_.node(n.children[0]).name);
    Amount q = Amount::number(1);
    q.measured = true, q.any = table == nullptr || !table->measured;
    if (!q.any) q.dimension = table->dimension, q.with_unit = table->with_unit;
    return q;
  }

  // meet(A, r, B, s, side) or meet(A, r, B, s, side, axis) of circles, meet(A, B, C, D) of lines.
  Amount met(const Node& n, const std::vector<Amount>& a) const {
    const bool circles = a.size() > 4;
    Amount q = a[0];
    for (std::size_t k = 0; k < a.size(); ++k) {
      const bool vector = k == 5 || (k != 4 && (!circles || k % 2 == 0));
      if (a[k].is_vector != vector || (k == 4 && !is_number(a[k])))
        refuse(n, "argument " + std::to_string(k + 1) + " of meet is " + article_name_of(a[k]) +
                      "; write meet(A, r, B, s, left) of circles about A and B, meet(A, B, C, D) of lines");
      Amount other = a[k];
      q.is_vector = vector;
      if (k < 4) unite(n, q, other, "arguments of one function");
    }
    const Vec3 axis = a.size() == 6 ? a[5].v : Vec3::UnitZ();
    const Meeting m = circles ? meeting_of_circles(a[0].v, a[1].v[0], a[2].v, a[3].v[0], a[4].v[0], axis)
                              : meeting_of_lines(a[0].v, a[1].v, a[2].v, a[3].v);
    if (of_values() && !m.problem.empty()) refuse(n, m.problem);
    q.v = m.at, q.is_vector = true, q.is_zero = false;
    return q;
  }

  // The function of one or two numbers.
  static double value(Function f, double x, double y) {
    if (f == Function::abs) return std::abs(x);
    if (f == Function::hypot) return std::hypot(x, y);
    const double xy[] = {x, y};
    const int n_parts = signature_of(f).most == 1 ? 1 : 2;
    return value_of_term<double>({{Operation::name},
                                  {.operation = Operation::name, .variable = 1},
                                  {Operation::call, f, 0, 0, {0, 1}, n_parts, signature_of(f).decides}},
                                 2, xy);
  }
  static Amount of_vectors(Function f, const std::vector<Amount>& a, Amount q) {
    const Vec3 &x = a.front().v, &y = a.back().v;
    q.is_vector = f == Function::cross;
    if (f == Function::norm) q.v[0] = std::hypot(x[0], x[1], x[2]);
    if (f == Function::dot) q.v[0] = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    if (f == Function::cross) q.v = cross(x, y);
    return q;
  }

  const Expression& e_;
  const Names& names_;
  const Known& known_;
  const Varies* varies_;
  std::string hint_;
  bool strict_;
};

}  // namespace

Amount evaluate(const Expression& e, const Names& names, const Known& known) {
  Amount q = Evaluation(e, names, known).of(e.root());
  q.dimension = settled(q.dimension);
  if (!whole(q.dimension)) e.refuse(0, "its result has a dimension without a unit (a fractional or a high power)");
  return q;
}

Amount dimension_of(const Expression& e, int node, const Names& names, const Varies& varies, const std::string& hint,
                    bool strict) {
  Amount q = Evaluation(e, names, {}, &varies, hint, strict).of(node);
  q.dimension = settled(q.dimension);
  return q;
}

std::string unit_of(const Amount& q) {
  const Dimension d = whole(settled(q.dimension)).value_or(Dimension{});
  return d == Dimension{} ? "" : si_unit(d);
}

Value value_of(const Amount& q) {
  const std::string unit = si_unit(whole(q.dimension).value_or(Dimension{}));
  const auto one = [&](double x) { return q.measured ? Value(text::number(x) + " " + unit) : Value(x); };
  if (!q.is_vector) return one(q.v[0]);
  return Value(Value::List{one(q.v[0]), one(q.v[1]), one(q.v[2])});
}

std::string words_of(const Amount& q) {
  const std::optional<Dimension> d = whole(settled(q.dimension));
  const std::string unit = d && *d != Dimension{} ? " " + si_unit(*d) : "";
  if (!q.is_vector) return text::brief(q.v[0]) + unit;
  return "[" + text::brief(q.v[0]) + ", " + text::brief(q.v[1]) + ", " + text::brief(q.v[2]) + "]" + unit;
}

std::string article_name_of(const Amount& q) {
  const std::optional<Dimension> d = whole(settled(q.dimension));
  const std::string one = d ? lockstep::article_name_of(*d) : "a quantity of fractional dimension";
  return q.is_vector ? "a vector (" + one + ")" : one;
}

}  // namespace lockstep::expression
