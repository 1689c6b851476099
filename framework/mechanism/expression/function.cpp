// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/function.h"

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep::expression {

// From the nodes of an expression to terms on numbers; what is constant is computed here. A vector is three terms.
class FormulaCompiler {
 public:
  FormulaCompiler(const Expression& e, const Meanings& meanings, const OfMotion& of_motion, std::vector<Term>& out)
      : e_(e), meanings_(meanings), of_motion_(of_motion), out_(out) {}

  /// The number of this node; only the terms that it needs remain, and it is the last of them.
  void compile(int node) {
    const int root = number(node);
    std::vector<int> place(out_.size(), -1);
    mark(root, place);
    std::vector<Term> kept;
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (place[i] < 0) continue;
      place[i] = static_cast<int>(kept.size());
      Term& t = kept.emplace_back(out_[i]);
      for (int k = 0; k < t.n_parts; ++k) t.parts[k] = place[t.parts[k]];
    }
    out_ = std::move(kept);
  }

 private:
  struct Terms {
    std::array<int, 3> of{};
    bool is_vector = false;
    int operator[](std::size_t k) const { return of[is_vector ? k : 0]; }
  };

  void mark(int i, std::vector<int>& place) const {
    if (place[i] == 0) return;
    place[i] = 0;
    for (int k = 0; k < term(i).n_parts; ++k) mark(term(i).parts[k], place);
  }

  int number(int i) {
    const Terms t = terms(i);
    if (!t.is_vector) return t.of[0];
    const Node* const point = vector_in(i);
    e_.refuse(e_.node(i), "a number is expected; this is a vector" +
                              (point == nullptr ? "" : "; use a component, as in " + point->name + ".x"));
  }
  // The first name of a vector in a node.
  const Node* vector_in(int i) {
    const Node& n = e_.node(i);
    if (n.operation == Operation::name && n.name != "pi" && meanings_(n).is_vector) return &n;
    for (const int k : n.children)
      if (const Node* const found = vector_in(k)) return found;
    return nullptr;
  }

  Terms terms(int i) {
    const Node& n = e_.node(i);
    const Operation o = n.operation;
    if (o == Operation::number) return {{constant(n.value)}};
    if (o == Operation::name) return named(n);
    if (o == Operation::component) return component(n);
    if (o == Operation::vector) return {{number(n.children[0]), number(n.children[1]), number(n.children[2])}, true};
    if (o == Operation::call) return call(n);
    if (o == Operation::add || o == Operation::subtract || o == Operation::multiply || o == Operation::divide)
      return sum_or_product(n);
    if (o == Operation::negate) return each({terms(n.children[0])}, o);
    if (o == Operation::choose) {
      const Terms condition{{number(n.children[0])}}, yes = terms(n.children[1]), no = terms(n.children[2]);
      if (yes.is_vector != no.is_vector) e_.refuse(n, "one side of the choice is a vector, the other is a number");
      return each({condition, yes, no}, o);
    }
    std::vector<int> parts;
    for (const int k : n.children) parts.push_back(number(k));
    if (o == Operation::power) return {{power(parts)}};
    if (o == Operation::unequal) return {{put(Operation::negation, {put(Operation::equal, parts)})}};
    if (o == Operation::greater) return {{put(Operation::less, {parts[1], parts[0]})}};
    if (o == Operation::greater_equal) return {{put(Operation::less_equal, {parts[1], parts[0]})}};
    return {{put(o, parts)}};
  }

  // The operation on each component; numbers are those of all.
  Terms each(const std::vector<Terms>& of, Operation o) {
    Terms result;
    result.is_vector = std::ranges::any_of(of, &Terms::is_vector);
    for (std::size_t k = 0; k < (result.is_vector ? 3 : 1); ++k) {
      std::vector<int> parts;
      for (const Terms& t : of) parts.push_back(t[k]);
      result.of[k] = put(o, parts);
    }
    return result;
  }

  Terms sum_or_product(const Node& n) {
    const Terms a = terms(n.children[0]), b = terms(n.children[1]);
    const Operation o = n.operation;
    const bool sum = o == Operation::add || o == Operation::subtract;
    if (sum && a.is_vector != b.is_vector) e_.refuse(n, "the sum of a number and a vector");
    if (o == Operation::divide && b.is_vector) e_.refuse(n, "a division by a vector; write a / norm(b)");
    if (!sum && a.is_vector && b.is_vector) e_.refuse(n, "a product of two vectors; write dot(a, b) or cross(a, b)");
    return each({a, b}, o);
  }

  int constant(double x) {
    Term t;
    t.value = x;
    return put(t);
  }

  int power(const std::vector<int>& parts) {
    if (!is_constant(parts[1])) return put(Operation::power, parts);
    Term t{Operation::power, {}, term(parts[1]).value};
    t.parts = {parts[0]}, t.n_parts = 1;
    return put(t);
  }

  Terms call(const Node& n) {
    const Signature& f = signature_of(n.function);
    if (is_of_motion(n)) {
      if (!of_motion_)
        e_.refuse(n, std::string(f.name) + "(...) is of the motion; it can be the outer function of a column only");
      return {{variable(of_motion_(n))}};
    }
    if (n.function == Function::table) return {{table(n)}};
    if (f.takes == Takes::vectors) return {of_vectors(n)};
    if (f.takes == Takes::places)
      e_.refuse(n, "meet(...) is of points of the scene; define its result under \"points\", and use that name here");
    int first = number(n.children[0]);
    if (n.children.size() == 1) return {{put(Operation::call, {first}, n.function)}};
    for (std::size_t k = 1; k < n.children.size(); ++k)
      first = put(Operation::call, {first, number(n.children[k])}, n.function);
    return {{first}};
  }

  // The function of a table at a number.
  int table(const Node& n) {
    const Node& name = e_.node(n.children[0]);
    const Meaning m = name.operation == Operation::name && name.name != "pi" ? meanings_(name) : Meaning{};
    if (!m.table) e_.refuse(name, "the name of a table is expected, which the scene defines under \"tables\"");
    Term t{Operation::call, Function::table};
    t.parts = {number(n.children[1])}, t.n_parts = 1, t.table = m.table;
    return put(t);
  }

  Terms of_vectors(const Node& n) {
    std::vector<Terms> v;
    for (const int k : n.children) {
      v.push_back(terms(k));
      if (!v.back().is_vector)
        e_.refuse(n, std::string(signature_of(n.function).name) + " takes vectors; this is a number");
    }
    const auto product = [&](std::size_t i, std::size_t k) { return put(Operation::multiply, {v[0][i], v[1][k]}); };
    const auto hypot = [&](int x, int y) { return put(Operation::call, {x, y}, Function::hypot); };
    if (n.function == Function::norm) return {{hypot(hypot(v[0][0], v[0][1]), v[0][2])}};
    if (n.function == Function::dot)
      return {{put(Operation::add, {put(Operation::add, {product(0, 0), product(1, 1)}), product(2, 2)})}};
    Terms cross{{}, true};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      cross.of[k] = put(Operation::subtract, {product(i, j), product(j, i)});
    }
    return cross;
  }

  int variable(int k) {
    Term t;
    t.operation = Operation::name, t.variable = k;
    return put(t);
  }

  Terms named(const Node& n) {
    if (n.name == "pi") return {{constant(kPi)}};
    const Meaning m = meanings_(n);
    if (m.table) e_.refuse(n, "a table has a value at an argument only; write table(" + n.name + ", x)");
    Terms result{{}, m.is_vector};
    for (std::size_t k = 0; k < (m.is_vector ? 3 : 1); ++k)
      result.of[k] = m.variable < 0 ? constant(m.value[k]) : variable(m.variable + static_cast<int>(k));
    return result;
  }

  Terms component(const Node& n) {
    const Terms of = terms(n.children[0]);
    if (!of.is_vector) e_.refuse(n, "a number has no components, only a point has, as in A.x; remove the component");
    return {{of[static_cast<std::size_t>(n.index)]}};
  }

  const Term& term(int i) const { return out_[i]; }
  bool is_constant(int i) const { return term(i).operation == Operation::number; }

  int put(Operation o, const std::vector<int>& parts, Function f = {}) {
    Term t{o, f};
    std::copy(parts.begin(), parts.end(), t.parts.begin());
    t.n_parts = static_cast<int>(parts.size());
    t.decides = is_condition(o) || o == Operation::choose || (o == Operation::call && signature_of(f).decides);
    return put(t);
  }
  // Appends a term, or, in place of one of constants only, its value.
  int put(const Term& t) {
    out_.push_back(t);
    const auto last = out_.size() - 1;
    const std::span<const int> parts(t.parts.data(), t.n_parts);
    if (parts.empty() || !std::ranges::all_of(parts, [&](int i) { return is_constant(i); }))
      return static_cast<int>(last);
    Term value;
    value.value = value_of_term<double>(out_, last, {});
    out_.back() = value;
    return static_cast<int>(last);
  }

  const Expression& e_;
  const Meanings& meanings_;
  const OfMotion& of_motion_;
  std::vector<Term>& out_;
};

FormulaFunction::FormulaFunction(const Expression& e, int node, const Meanings& meanings, const OfMotion& of_motion)
    : text_(e.text()) {
  FormulaCompiler(e, meanings, of_motion, terms_).compile(node);
  has_switches_ = std::ranges::any_of(terms_, &Term::decides);
  if (has_switches_) warned_ = std::make_shared<std::atomic<bool>>(false);
  if (is_constant() && !std::isfinite(terms_.back().value)) e.refuse(0, "its value is not finite");
}

bool FormulaFunction::is_constant() const { return terms_.size() == 1 && terms_[0].operation == Operation::number; }

bool FormulaFunction::reads(int variable) const {
  return std::ranges::any_of(terms_,
                             [&](const Term& t) { return t.operation == Operation::name && t.variable == variable; });
}

template double FormulaFunction::operator()(std::span<const double>) const;
template Time FormulaFunction::operator()(std::span<const Time>) const;
template Jet<4> FormulaFunction::operator()(std::span<const Jet<4>>) const;
template Jet<8> FormulaFunction::operator()(std::span<const Jet<8>>) const;

Key constants_key() {
  return {"parameters", Form::any, Unit::none, kOptional,
          "object of numbers: named numbers for its formulas, and tables, which are laws; those of the scene are known "
          "too"};
}

std::vector<NamedNumbers> read_constants(const Params& p, const std::string& key) {
  if (!p.has(key)) return {};
  std::vector<NamedNumbers> all = read_constants(p.value(key), part_of(p.owner(), key));
  for (NamedNumbers& c : all)
    if (c.values.empty()) c.table = p.law(key + "." + c.name);
  return all;
}

std::vector<NamedNumbers> read_constants(const Value& object, const std::string& owner) {
  std::vector<NamedNumbers> all;
  if (object.object() == nullptr)
    lockstep::refuse(object.where, owner, "expected an object of named numbers, got " + shown(object));
  for (const Value::Member& m : *object.object()) {
    const std::string place = part_of(owner, m.key);
    if (const std::string fault = name_fault(m.key); !fault.empty())
      lockstep::refuse(m.where, place, "\"" + m.key + "\" is not a valid name: " + fault);
    NamedNumbers& c = all.emplace_back(NamedNumbers{.name = m.key});
    const auto note_unit = [&](const Value& v) {
      if (v.text() != nullptr) c.unit = si_unit(dimension_of_text(*v.text()));
    };
    if (m.value.list() != nullptr) {
      const Vec3 v = read_vector3(m.value, Unit::any, place);
      c.values.assign(v.begin(), v.end());
      for (const Value& each : *m.value.list()) note_unit(each);
    } else if (m.value.object() == nullptr) {
      c.values = {read_number(m.value, Unit::any, place)};
      note_unit(m.value);
    } else if (const Value* const points = m.value.find("points"); points != nullptr && points->list() != nullptr) {
      for (const Value& point : *points->list())
        if (point.list() != nullptr && point.list()->size() > 1) note_unit((*point.list())[1]);
    }
  }
  return all;
}

}  // namespace lockstep::expression
