// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/function.h"

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep::expression {

// From the nodes of an expression to terms on numbers; what is constant is computed here.
class FormulaCompiler {
 public:
  FormulaCompiler(const Expression& e, const std::vector<std::string>& variables,
                  const std::vector<Constant>& constants, std::vector<Term>& out)
      : e_(e), variables_(variables), constants_(constants), out_(out) {}

  int compile(int i) {
    const Node& n = e_.node(i);
    if (n.operation == Operation::number) return constant(n.value);
    if (n.operation == Operation::name) return named(n);
    if (n.operation == Operation::component) return component(n);
    if (n.operation == Operation::vector) e_.refuse(n, "a number is expected; vectors are for geometry only");
    if (n.operation == Operation::call) return call(n);
    std::vector<int> parts;
    for (const int k : n.children) parts.push_back(compile(k));
    if (n.operation == Operation::power) return power(parts);
    if (n.operation == Operation::unequal) return put(Operation::negation, {put(Operation::equal, parts)});
    if (n.operation != Operation::greater && n.operation != Operation::greater_equal) return put(n.operation, parts);
    return put(n.operation == Operation::greater ? Operation::less : Operation::less_equal, {parts[1], parts[0]});
  }

 private:
  int constant(double x) {
    Term t;
    t.value = x;
    return put(t);
  }

  int power(const std::vector<int>& parts) {
    if (!is_constant(parts[1])) return put(Operation::power, parts);
    Term t{Operation::power, {}, out_.back().value};
    out_.pop_back();
    t.parts = {parts[0]}, t.n_parts = 1;
    return put(t);
  }

  int call(const Node& n) {
    const Signature& f = signature_of(n.function);
    if (f.takes == Takes::vectors) e_.refuse(n, std::string(f.name) + " takes vectors; a number is expected");
    int first = compile(n.children[0]);
    if (n.children.size() == 1) return put(Operation::call, {first}, n.function);
    for (std::size_t k = 1; k < n.children.size(); ++k)
      first = put(Operation::call, {first, compile(n.children[k])}, n.function);
    return first;
  }

  const Constant* find(const std::string& name) const {
    for (const Constant& c : constants_)
      if (c.name == name) return &c;
    return nullptr;
  }

  bool is_known(const std::string& name) const {
    return name == "pi" || find(name) != nullptr || std::ranges::find(variables_, name) != variables_.end();
  }

  int named(const Node& n) {
    for (std::size_t k = 0; k < variables_.size(); ++k)
      if (variables_[k] == n.name) {
        if (find(n.name) != nullptr)
          e_.refuse(n, "\"" + n.name + "\" is both a variable of this formula and a parameter or point; rename the " +
                           "parameter or point");
        Term t;
        t.operation = Operation::name, t.variable = static_cast<int>(k);
        return put(t);
      }
    if (n.name == "pi") return constant(kPi);
    const Constant* c = find(n.name);
    if (c == nullptr) refuse_unknown(n);
    if (c->is_vector) e_.refuse(n, "\"" + n.name + "\" is a point; use a component, as in " + n.name + ".x");
    return constant(c->value[0]);
  }

  int component(const Node& n) {
    const Node& of = e_.node(n.children[0]);
    const Constant* c = of.operation == Operation::name ? find(of.name) : nullptr;
    if (of.operation == Operation::name && !is_known(of.name)) refuse_unknown(of);
    if (c == nullptr || !c->is_vector)
      e_.refuse(n, "a number has no components, only a point has, as in A.x; remove the component");
    return constant(c->value[n.index]);
  }

  [[noreturn]] void refuse_unknown(const Node& n) const {
    std::vector<std::string> known = variables_;
    for (const Constant& c : constants_) known.push_back(c.name);
    known.emplace_back("pi");
    e_.refuse(n, "unknown name \"" + n.name + "\"" + text::suggestion(n.name, known));
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
  // Appends a term, or, in place of one of constants only, its value: those constants are the last terms.
  int put(const Term& t) {
    out_.push_back(t);
    const auto last = out_.size() - 1;
    const std::span<const int> parts(t.parts.data(), t.n_parts);
    if (parts.empty() || !std::ranges::all_of(parts, [&](int i) { return is_constant(i); }))
      return static_cast<int>(last);
    const double x = value_of_term<double>(out_, last, {});
    out_.resize(std::ranges::min(parts));
    return constant(x);
  }

  const Expression& e_;
  const std::vector<std::string>& variables_;
  const std::vector<Constant>& constants_;
  std::vector<Term>& out_;
};

FormulaFunction::FormulaFunction(const std::string& text, const std::vector<std::string>& variables,
                                 const std::vector<Constant>& constants)
    : text_(text) {
  const Expression e(text, variables);
  FormulaCompiler(e, variables, constants, terms_).compile(e.root());
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
          "object of numbers: named numbers for its formulas; parameters of the scene, in SI, are known too"};
}

std::vector<Constant> read_constants(const Params& p, const std::string& key) {
  return p.has(key) ? read_constants(p.value(key), part_of(p.owner(), key)) : std::vector<Constant>{};
}

std::vector<Constant> read_constants(const Value& object, const std::string& owner) {
  std::vector<Constant> all;
  if (object.object() == nullptr)
    lockstep::refuse(object.where, owner, "expected an object of named numbers, got " + shown(object));
  for (const Value::Member& m : *object.object()) {
    const std::string place = part_of(owner, m.key);
    if (const std::string fault = name_fault(m.key); !fault.empty())
      lockstep::refuse(m.where, place, "\"" + m.key + "\" is not a valid name: " + fault);
    Constant c;
    c.name = m.key, c.is_vector = m.value.list() != nullptr;
    if (c.is_vector) {
      const Vec3 v = read_vector3(m.value, Unit::any, place);
      std::copy(v.begin(), v.end(), c.value);
      for (const Value& each : *m.value.list())
        if (each.text() != nullptr) c.dimension = dimension_of_text(*each.text());
    } else {
      c.value[0] = read_number(m.value, Unit::any, place);
      if (m.value.text() != nullptr) c.dimension = dimension_of_text(*m.value.text());
    }
    all.push_back(std::move(c));
  }
  return all;
}

}  // namespace lockstep::expression
