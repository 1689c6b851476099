// SPDX-License-Identifier: BSD-3-Clause
// From the nodes of an expression to terms on numbers, with their dimensions: the one evaluator of formulas.
#include <algorithm>
#include <cmath>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/meet.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/mechanism/expression/term_list.h"

namespace lockstep::expression {
namespace {

Exponents scaled(const Exponents& e, double p) { return {p * e.m, p * e.kg, p * e.s, p * e.rad}; }
Exponents product(const Exponents& a, const Exponents& b, double sign) {
  return {a.m + sign * b.m, a.kg + sign * b.kg, a.s + sign * b.s, a.rad + sign * b.rad};
}
Exponents without_radian(Exponents e) {
  e.rad = 0;
  return e;
}

// What is read of a formula: the value of constants, with its dimension; terms of numbers in SI; the dimension of what
// varies, whatever its values.
enum class Read { value, terms, dimension };

// An amount by the terms that give its numbers. What is constant is computed here. A vector is three terms.
struct Part : Amount {
  std::array<int, 3> term{};
  int operator[](std::size_t k) const { return term[is_vector ? k : 0]; }
};

class FormulaReader {
 public:
  FormulaReader(Read what, const Expression& e, const Meanings& names, const Known& known = {},
                const OfMotion& of_motion = {}, std::string hint = {}, bool strict = false)
      : what_(what),
        e_(e),
        names_(names),
        known_(known),
        of_motion_(of_motion),
        hint_(std::move(hint)),
        strict_(strict) {}

  Part of(int i) {
    const Node& n = e_.node(i);
    Part q = made(n);
    if (!of_values()) return q;
    for (std::size_t k = 0; k < 3; ++k) q.v[k] = q.is_vector || k == 0 ? terms_[q[k]].value : 0;
    if (!q.v.allFinite()) refuse(n, "its value is not finite" + operands(n));
    return q;
  }

  /// The terms of the number of this node.
  std::vector<Term> compiled(int node) {
    const Part root = of(node);
    if (root.is_vector) {
      const Node* const point = vector_in(node);
      refuse(e_.node(node), "a number is expected; this is a vector" +
                                (point == nullptr ? "" : "; use a component, as in " + point->name + ".x"));
    }
    return terms_.needed_by(root[0]);
  }

 private:
  [[noreturn]] void refuse(const Node& n, const std::string& problem) const { e_.refuse(n, problem + hint_); }
  bool of_values() const { return what_ == Read::value; }
  bool is_number(const Amount& q) const {
    if (what_ == Read::terms) return true;
    if (of_values()) return q.dimension == Exponents{};
    return q.any || !(q.with_unit || q.named) || without_radian(q.dimension) == Exponents{};
  }
  std::string called(const Amount& q) const {
    return what_ != Read::terms ? article_name_of(q) : q.is_vector ? "a vector" : "a number";
  }
  Part child(const Node& n, std::size_t k) { return of(n.children[k]); }

  std::string operands(const Node& n) {
    std::string words;
    for (const int k : n.children) words += (words.empty() ? "; it is of " : " and ") + words_of(of(k));
    return words;
  }
  // The first name of a vector in a node.
  const Node* vector_in(int i) const {
    const Node& n = e_.node(i);
    if (n.operation == Operation::name && n.name != "pi" && names_(n)->amount.is_vector) return &n;
    for (const int k : n.children)
      if (const Node* const found = vector_in(k)) return found;
    return nullptr;
  }

  Part made(const Node& n) {
    const Operation o = n.operation;
    if (o == Operation::number) return number(n);
    if (o == Operation::name) return named(n);
    if (o == Operation::add || o == Operation::subtract) return sum(n);
    if (o == Operation::multiply || o == Operation::divide) return product_of(n);
    if (o == Operation::power) return power(n);
    if (o == Operation::choose) return chosen(n);
    if (o == Operation::vector) return vector(n);
    if (o == Operation::call) return call(n);
    if (o == Operation::negation || o == Operation::conjunction || o == Operation::disjunction) return condition(n);
    if (is_condition(o)) return compared(n);
    Part q = child(n, 0);
    if (o == Operation::negate) return each(q, o, {q});
    if (!q.is_vector) refuse(n, "only a point or a vector has components; this is " + called(q));
    q.term = {q[static_cast<std::size_t>(n.index)]}, q.is_vector = false;
    return q;
  }

  Part number(const Node& n) {
    Part q = pure(terms_.constant(n.value));
    q.dimension = exponents_of(n.dimension), q.measured = n.measured, q.is_zero = n.value == 0 && !n.measured;
    q.with_unit = n.measured && n.dimension != Dimension{};
    return q;
  }

  Part named(const Node& n) {
    if (n.name == "pi") return pure(terms_.constant(kPi));
    const Meaning* const m = names_(n);
    if (m == nullptr) {
      std::vector<std::string> known = known_ ? known_() : std::vector<std::string>{};
      known.emplace_back("pi");
      refuse(n, "unknown name \"" + n.name + "\"" + text::suggestion(n.name, known));
    }
    if (m->is_table) refuse(n, "a table has a value at an argument only; write table(" + n.name + ", x)");
    Part q{m->amount};
    for (int k = 0; k < (q.is_vector ? 3 : 1); ++k)
      q.term[k] = m->variable < 0 ? terms_.constant(m->amount.v[k]) : terms_.variable(m->variable + k);
    return q;
  }

  // Gives both the dimension of the one that has it; rejects two that differ. A literal 0 fits any. `a` is then what is
  // made of both.
  void unite(const Node& n, Amount& a, Amount& b, const char* how) const {
    if (what_ == Read::dimension) settle(a, b);
    if (a.is_zero) a.dimension = b.dimension, a.measured = b.measured;
    if (b.is_zero) b.dimension = a.dimension, b.measured = a.measured;
    const Exponents other = settled(b.dimension);
    Exponents to = settled(a.dimension);
    const bool differ = of_values() ? to != other : without_radian(to) != without_radian(other),
               unlike = differ && what_ != Read::terms;
    if (unlike || a.is_vector != b.is_vector)
      refuse(n, called(a) + " and " + called(b) + " are " + how +
                    (unlike && a.measured != b.measured ? "; give the number a unit, as in \"0.1 m\"" : ""));
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
    a.with_unit = b.with_unit = a.with_unit || b.with_unit, a.named = b.named = a.named || b.named;
  }
  // Whether a product has a plain number as a factor of what varies.
  bool is_free(const Part& a, const Part& b) const {
    const bool a_varies = varies(a), b_varies = varies(b);
    return (!a.measured && !a_varies && b_varies && !(strict_ && b.with_unit)) ||
           (!b.measured && !b_varies && a_varies && !(strict_ && a.with_unit));
  }

  // Of values the side that counts; else both, of one dimension.
  Part chosen(const Node& n) {
    const Part condition = truth(n, 0);
    if (of_values()) return child(n, condition.v[0] != 0 ? 1 : 2);
    Part a = child(n, 1), b = child(n, 2);
    unite(n, a, b, "the two sides of one choice");
    return each(a, n.operation, {condition, a, b});
  }

  Part sum(const Node& n) {
    Part a = child(n, 0), b = child(n, 1);
    unite(n, a, b, n.operation == Operation::add ? "added" : "subtracted");
    return each(a, n.operation, {a, b});
  }

  Part product_of(const Node& n) {
    const Part a = child(n, 0), b = child(n, 1);
    const bool divides = n.operation == Operation::divide;
    if (divides && b.is_vector) refuse(n, "a division by a vector; write a / norm(b)");
    if (a.is_vector && b.is_vector) refuse(n, "a product of two vectors; write dot(a, b) or cross(a, b)");
    if (divides && b.v[0] == 0 && of_values()) refuse(n, "a division by zero");
    Part q = each(a, n.operation, {a, b});
    q.dimension = product(a.dimension, b.dimension, divides ? -1 : 1);
    q.measured = a.measured || b.measured, q.is_zero = false;
    q.any = a.any || b.any || is_free(a, b), q.with_unit = a.with_unit || b.with_unit;
    q.named = a.named || b.named;
    return q;
  }

  // Of dimensions alone, of a quantity by a constant exponent.
  Part power(const Node& n) {
    Part a = child(n, 0);
    const Part p = child(n, 1);
    if (a.is_vector) refuse(n, "a power of a vector; write dot(a, a)");
    if (p.is_vector || !is_number(p)) refuse(n, "the exponent is " + called(p) + "; a pure number is expected");
    const double exponent = varies(p) ? NAN : terms_[p[0]].value;
    if (of_values() && a.v[0] < 0 && exponent != std::round(exponent))
      refuse(n, text::brief(a.v[0]) + " to a power that is not whole");
    if (of_values() && a.v[0] == 0 && exponent < 0) refuse(n, "a division by zero: a negative power of 0");
    const bool fixed = std::isfinite(exponent);
    if (!fixed && !is_number(a))
      refuse(n, called(a) + " to a power that varies; a pure number is expected before the \"^\"");
    Term t{Operation::power, {}, varies(p) ? 0 : exponent};
    t.parts = {a[0], p[0]}, t.n_parts = varies(p) ? 2 : 1;
    a.term = {terms_.put(t)};
    a.dimension = fixed ? scaled(a.dimension, exponent) : Exponents{};
    a.measured = a.measured || p.measured, a.is_zero = false;
    return a;
  }

  Part truth(const Node& n, std::size_t k) {
    const Part q = child(n, k);
    if (q.is_vector || !is_number(q))
      refuse(e_.node(n.children[k]), "a condition is expected, as in \"a > b\"; this is " + called(q));
    return q;
  }

  // Of values the second condition is looked at where it counts.
  Part condition(const Node& n) {
    const Part first = truth(n, 0);
    if (n.operation == Operation::negation) return pure(terms_.put(n.operation, {first[0]}));
    const bool holds = first.v[0] != 0;
    if (of_values() && holds != (n.operation == Operation::conjunction)) return pure(terms_.constant(holds ? 1 : 0));
    return pure(terms_.put(n.operation, {first[0], truth(n, 1)[0]}));
  }

  Part compared(const Node& n) {
    Part a = child(n, 0), b = child(n, 1);
    unite(n, a, b, "compared");
    if (a.is_vector) refuse(n, "two vectors are compared; compare norm(a)");
    const Operation o = n.operation;
    if (o == Operation::unequal)
      return pure(terms_.put(Operation::negation, {terms_.put(Operation::equal, {a[0], b[0]})}));
    if (o == Operation::greater) return pure(terms_.put(Operation::less, {b[0], a[0]}));
    if (o == Operation::greater_equal) return pure(terms_.put(Operation::less_equal, {b[0], a[0]}));
    return pure(terms_.put(o, {a[0], b[0]}));
  }

  Part vector(const Node& n) {
    Part parts[3] = {child(n, 0), child(n, 1), child(n, 2)};
    Part like = parts[0];
    for (const Part& p : parts) {
      if (p.is_vector) refuse(n, "a component of a vector is a vector; write numbers");
      if (like.is_zero && !p.is_zero) like = p;
    }
    Part q;
    q.is_vector = true, q.dimension = settled(like.dimension);
    for (std::size_t k = 0; k < 3; ++k) {
      Part with = like;
      unite(n, with, parts[k], "components of one vector");
      q.term[k] = parts[k][0], q.measured = q.measured || parts[k].measured;
    }
    q.is_zero = like.is_zero;
    return q;
  }

  // -- functions
  [[noreturn]] void refuse_argument(const Node& n, const Amount& q, const char* expected) const {
    refuse(n, std::string(n.function.signature().name) + " of " + called(q) + "; " + expected + " is expected");
  }
  // Of dimensions alone; a plain number is in SI.
  void expect(const Node& n, const Amount& x, const Exponents& wanted, const std::string& what) const {
    if (what_ != Read::dimension || !x.measured || x.any || x.is_zero) return;
    if (without_radian(settled(x.dimension)) == without_radian(wanted)) return;
    const Amount of{.dimension = wanted};
    refuse(n, what + " is " + called(x) + "; " + called(of) + " is expected");
  }
  void check_range(const Node& n, const std::vector<Part>& a) const {
    const double x = a[0].v[0];
    const Function f = n.function;
    const char* range = nullptr;
    if ((f == Function("asin") || f == Function("acos")) && !(std::abs(x) <= 1)) range = "from -1 to 1";
    if (f == Function("sqrt") && !(x >= 0)) range = "0 or more";
    if (f == Function("log") && !(x > 0)) range = "more than 0";
    if (range != nullptr) {
      std::string words = f == Function("sqrt") || f == Function("log") ? words_of(a[0]) : text::number(x),
                  with = ", with ";
      for (const std::string& name : names_in(e_))
        if (const Meaning* const m = names_({.name = name}))
          words += with + name + " = " + words_of(m->amount), with = ", ";
      words += std::string("; it must be ") + range;
      if (f == Function("acos") || f == Function("sqrt"))
        words += "; of a triangle, check that its sides can form one, and their units";
      refuse(n, std::string(f.signature().name) + " of " + words);
    }
    if (f == Function("mod") && a[1].v[0] == 0) refuse(n, "mod by zero");
  }

  Part call(const Node& n) {
    const Signature& f = n.function.signature();
    if (n.function == Function("table")) return of_table(n);
    if (is_of_motion(n) && what_ == Read::terms) {
      const int place = of_motion_ ? of_motion_(n) : -1;
      if (place < 0)
        refuse(n, std::string(f.name) +
                      "(...) is of the motion; only a column can have it, and inside max, min, mean, "
                      "rms, integral and at only rate(x)");
      return pure(terms_.variable(place));
    }
    std::vector<Part> a;
    for (const int k : n.children) a.push_back(of(k));
    if (f.takes == Takes::places) return met(n, a);
    for (const Part& x : a)
      if (x.is_vector != (f.takes == Takes::vectors)) refuse_argument(n, x, x.is_vector ? "a number" : "a vector");
    const bool pure_only = f.takes == Takes::pure || f.takes == Takes::angle;
    if (pure_only && !is_number(a[0]) && !(f.takes == Takes::angle && a[0].dimension == Exponents{0, 0, 0, 1}))
      refuse_argument(n, a[0], f.takes == Takes::angle ? "an angle or a pure number" : "a pure number");
    Part q;
    for (const Part& x : a) {
      q.measured = q.measured || x.measured, q.with_unit = q.with_unit || x.with_unit, q.named = q.named || x.named;
    }
    for (std::size_t k = 1; k < a.size() && f.takes == Takes::alike; ++k)
      unite(n, a[0], a[k], "arguments of one function");
    if (of_values()) check_range(n, a);
    if (n.function == Function("at") || n.function == Function("last"))
      expect(n, a[1], {0, 0, 1, 0}, "the second argument of " + std::string(f.name));
    q.any = a[0].any && (f.takes == Takes::alike || f.gives == Gives::alike || f.gives == Gives::root);
    if (f.gives == Gives::alike) q.dimension = a[0].dimension;
    if (f.gives == Gives::root) q.dimension = scaled(a[0].dimension, 0.5);
    if (f.gives == Gives::times_time) q.dimension = product(a[0].dimension, {0, 0, 1, 0}, 1);
    if (f.gives == Gives::by_time) q.dimension = product(a[0].dimension, {0, 0, 1, 0}, -1);
    if (f.gives == Gives::product) q.dimension = product(a[0].dimension, a[1].dimension, 1);
    if (f.gives == Gives::angle) q.dimension = {0, 0, 0, 1}, q.measured = true;
    if (f.gives == Gives::sign) q.measured = false;
    if (f.takes == Takes::vectors) return of_vectors(n.function, a, q);
    q.term = {a[0][0]};
    if (is_of_motion(n)) return q;
    if (a.size() == 1) q.term = {terms_.put(Operation::call, {q[0]}, n.function)};
    for (std::size_t k = 1; k < a.size(); ++k) q.term = {terms_.put(Operation::call, {q[0], a[k][0]}, n.function)};
    return q;
  }

  // The function of a table at a number. Without a unit in its points its value is of any dimension.
  Part of_table(const Node& n) {
    if (of_values()) refuse(n, "a table is of the motion; formulas of parameters and points cannot read it");
    const Node& name = e_.node(n.children[0]);
    const Meaning* m = nullptr;
    if (name.operation == Operation::name && name.name != "pi") try {
        m = names_(name);
      } catch (const ModelError&) {  // whatever else is wrong with it, it is no table
      }
    if (m == nullptr || !m->is_table)
      refuse(name, "the name of a table is expected" + (name.name.empty() ? "" : ", \"" + name.name + "\" is none") +
                       "; define it under \"tables\" of the scene");
    const Part x = child(n, 1);
    if (x.is_vector) refuse_argument(n, x, "a number");
    if (m->argument) expect(n, x, *m->argument, "the argument of table \"" + name.name + "\"");
    Term t{Operation::call, Function("table")};
    t.parts = {x[0]}, t.n_parts = 1, t.table = m->table;
    Part q = pure(m->table ? terms_.put(t) : terms_.variable(0));
    q.measured = true, q.any = !m->amount.measured;
    if (!q.any) q.dimension = m->amount.dimension, q.with_unit = m->amount.with_unit;
    return q;
  }

  // meet(A, r, B, s, side) or meet(A, r, B, s, side, axis) of circles, meet(A, B, C, D) of lines.
  Part met(const Node& n, const std::vector<Part>& a) {
    const bool circles = a.size() > 4;
    Part q = a[0];
    Vec3 v[6];
    for (std::size_t k = 0; k < a.size(); ++k) {
      const bool vector = k == 5 || (k != 4 && (!circles || k % 2 == 0));
      if (a[k].is_vector != vector || (k == 4 && !is_number(a[k])))
        refuse(n, "argument " + std::to_string(k + 1) + " of meet is " + called(a[k]) +
                      "; write meet(A, r, B, s, left) of circles about A and B, meet(A, B, C, D) of lines");
      if (varies(a[k]))
        refuse(n, "meet(...) is of points of the scene; define its result under \"points\", and use that name here");
      for (std::size_t i = 0; i < 3; ++i) v[k][static_cast<int>(i)] = terms_[a[k][i]].value;
      Amount other = a[k];
      q.is_vector = vector;
      if (!other.measured) continue;  // in SI
      if (k < 4 && q.measured) unite(n, q, other, "arguments of one function");
      if (k < 4) q.dimension = other.dimension, q.measured = true;
    }
    const Meeting m =
        circles ? meeting_of_circles(v[0], v[1][0], v[2], v[3][0], v[4][0], a.size() == 6 ? v[5] : Vec3(Vec3::UnitZ()))
                : meeting_of_lines(v[0], v[1], v[2], v[3]);
    if (!m.problem.empty()) refuse(n, m.problem);
    q.term = {terms_.constant(m.at[0]), terms_.constant(m.at[1]), terms_.constant(m.at[2])}, q.is_vector = true,
    q.is_zero = false;
    return q;
  }

  Part of_vectors(Function f, const std::vector<Part>& v, Part q) {
    const auto product = [&](std::size_t i, std::size_t k) {
      return terms_.put(Operation::multiply, {v[0][i], v[1][k]});
    };
    const auto hypot = [&](int x, int y) { return terms_.put(Operation::call, {x, y}, Function("hypot")); };
    if (f == Function("norm")) q.term = {hypot(hypot(v[0][0], v[0][1]), v[0][2])};
    if (f == Function("dot"))
      q.term = {
          terms_.put(Operation::add, {terms_.put(Operation::add, {product(0, 0), product(1, 1)}), product(2, 2)})};
    q.is_vector = f == Function("cross");
    for (std::size_t k = 0; k < 3 && q.is_vector; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      q.term[k] = terms_.put(Operation::subtract, {product(i, j), product(j, i)});
    }
    return q;
  }

  bool varies(const Part& q) const {
    return !terms_.is_constant(q[0]) || (q.is_vector && !(terms_.is_constant(q[1]) && terms_.is_constant(q[2])));
  }
  static Part pure(int number) {
    Part q;
    q.term = {number};
    return q;
  }

  // The operation on each component; numbers are those of all.
  Part each(Part like, Operation o, const std::vector<Part>& of) {
    like.is_vector = std::ranges::any_of(of, &Part::is_vector);
    for (std::size_t k = 0; k < (like.is_vector ? 3 : 1); ++k) {
      std::vector<int> parts;
      for (const Part& each : of) parts.push_back(each[k]);
      like.term[k] = terms_.put(o, parts);
    }
    return like;
  }

  Read what_;
  const Expression& e_;
  const Meanings& names_;
  const Known& known_;
  const OfMotion& of_motion_;
  std::string hint_;
  bool strict_;
  TermList terms_;
};

}  // namespace

Amount evaluate(const Expression& e, const Names& names, const Known& known) {
  Meaning found;
  const Meanings meanings = [&](const Node& n) -> const Meaning* {
    const Amount* const q = names(n.name);
    return q == nullptr ? nullptr : &(found = {*q});
  };
  Amount q = static_cast<const Amount&>(FormulaReader(Read::value, e, meanings, known).of(e.root()));
  q.dimension = settled(q.dimension);
  if (!whole(q.dimension)) e.refuse(0, "its result has a dimension without a unit (a fractional or a high power)");
  return q;
}

std::optional<Amount> Scope::dimension_of(const Expression& e, int node, const std::string& hint, bool strict) {
  for (const std::string& name : names_in(e))
    if (const Meaning* const known = find(name); known != nullptr && !known->is_known) return std::nullopt;
  const Meanings meanings = [this](const Node& n) { return find(n.name); };
  Amount q = static_cast<const Amount&>(FormulaReader(Read::dimension, e, meanings, {}, {}, hint, strict).of(node));
  q.dimension = settled(q.dimension);
  return q;
}

FormulaFunction::FormulaFunction(const Expression& e, int node, const Meanings& meanings, const OfMotion& of_motion)
    : text_(e.text()) {
  terms_ = FormulaReader(Read::terms, e, meanings, {}, of_motion).compiled(node);
  has_switches_ = std::ranges::any_of(terms_, &Term::decides);
  if (has_switches_) warned_ = std::make_shared<std::atomic<bool>>(false);
  if (is_constant() && !std::isfinite(terms_.back().value)) e.refuse(0, "its value is not finite");
}

}  // namespace lockstep::expression
