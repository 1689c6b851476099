// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/scope.h"

#include <algorithm>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep::expression {
namespace {

// Component k of a vector.
Meaning component(Meaning of, std::size_t k) {
  if (of.variable >= 0) of.variable += static_cast<int>(k);
  of.amount.is_vector = false, of.amount.v[0] = of.amount.v[static_cast<int>(k)];
  return of;
}

// Whether a value of dimension `is` may be given if `wanted` is expected: the radian counts as 1.
bool fits(Exponents is, Exponents wanted) {
  is.rad = wanted.rad = 0;
  return is == wanted;
}

}  // namespace

void Scope::add(const std::string& name, const Meaning& as) {
  const auto known = std::ranges::find(entries_, name, &Entry::first);
  if (known != entries_.end())
    known->second.clash = true;
  else
    entries_.emplace_back(name, as);
}

void Scope::add(const std::vector<NamedNumbers>& constants) {
  for (const NamedNumbers& c : constants) {
    Meaning m{.table = c.table, .is_table = c.values.empty()};
    m.amount.is_vector = c.values.size() == 3;
    std::ranges::copy(c.values, m.amount.v.data());
    const std::size_t of = c.unit.find(kOf);
    const std::string unit = c.unit.substr(0, of);
    if (of != std::string::npos) m.argument = exponents_of(*lockstep::dimension_of(c.unit.substr(of + kOf.size())));
    if (!unit.empty()) {
      const std::optional<Dimension> d = lockstep::dimension_of(unit);
      m.is_known = d.has_value(), m.amount.dimension = exponents_of(d.value_or(Dimension{}));
      m.amount.measured = m.amount.with_unit = true;
    }
    add(c.name, m);
  }
}

const Meaning* Scope::find(const std::string& name) {
  const auto known = std::ranges::find(entries_, name, &Entry::first);
  if (known != entries_.end()) return &known->second;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot + 2 != name.size()) return nullptr;
  const std::size_t k = std::string_view("xyz").find(name[dot + 1]);
  const Meaning* const whole = find(name.substr(0, dot));
  if (k == std::string::npos || whole == nullptr || !whole->amount.is_vector) return nullptr;
  add(name, component(*whole, k));
  return &entries_.back().second;
}

// Three numbers whose names begin with this one, or with it before "@".
void Scope::find_vector(const std::string& name) {
  if (find(name) != nullptr) return;
  const std::size_t at = std::min(name.find('@'), name.size());
  for (const std::string between : {"_", ".", ""}) try {
      const auto part = [&](char axis) { return others_(name.substr(0, at) + between + axis + name.substr(at)); };
      Meaning whole = part('x');
      part('y'), part('z');
      whole.amount.is_vector = true;
      return add(name, whole);
    } catch (const ModelError&) {  // not these
    }
}

std::vector<std::string> Scope::names() const {
  std::vector<std::string> known;
  for (const auto& [name, meaning] : entries_) known.push_back(name);
  known.emplace_back("pi");
  return known;
}

const Meaning& Scope::of(const Expression& e, const Node& n) {
  const Meaning* name = find(n.name);
  std::string problem;
  if (name == nullptr && others_) {
    const std::string called = without_quotes(n.name);
    try {
      add(n.name, others_(called));
    } catch (const ModelError& error) {
      problem = error.what();
      find_vector(called);
      find_vector(called.substr(0, called.rfind('.')));
      if (const Meaning* const of_vector = find(called); of_vector != nullptr && called != n.name)
        add(n.name, *of_vector);
    }
    name = find(n.name);
  } else if (name == nullptr) {
    const bool of_law =
        !entries_.empty() && entries_.front().first == "t" && e.text().substr(n.at + n.name.size()).starts_with('.');
    problem = "unknown name \"" + n.name + "\"" + text::suggestion(n.name, names()) + (of_law ? kLawOfTime : "");
  }
  if (name == nullptr) e.refuse(n, problem);
  if (name->clash)
    e.refuse(n, "\"" + n.name + "\" is both a variable of this formula and a parameter or point; rename the " +
                    "parameter or point");
  return *name;
}

FormulaFunction Scope::compiled(const Expression& e, int node, const OfMotion& of_motion) {
  return {e, node, [&](const Node& n) { return &of(e, n); }, of_motion};
}

void Scope::check(const Expression& e, const std::optional<Dimension>& value) {
  const auto has_unit = [this](const Node& n) {
    if (n.operation == Operation::number) return n.measured && n.dimension != Dimension{};
    const Meaning* const name = n.operation == Operation::name ? find(n.name) : nullptr;
    return name != nullptr && (name->amount.with_unit || name->argument);
  };
  const bool has_units = std::ranges::any_of(e.nodes(), has_unit);
  if (!has_units && std::ranges::none_of(entries_, [](const Entry& x) { return x.second.amount.named; })) return;
  std::string hint = has_units ? "; this formula has a unit, so all its quantities have units" : "", before = ": ";
  for (const std::string& name : has_units ? names_in(e) : std::vector<std::string>())
    if (const Meaning* const read = find(name); read != nullptr && read->variable >= 0 && read->is_known)
      hint += before + name + " is " + article_name_of(read->amount), before = ", ";
  const std::optional<Amount> q = dimension_of(e, e.root(), hint, false);
  if (!q || !value || !q->measured || q->any || !q->with_unit || fits(q->dimension, exponents_of(*value))) return;
  e.refuse(e.node(e.root()),
           "its value is " + article_name_of(*q) + "; " + lockstep::article_name_of(*value) + " is expected" + hint);
}

FormulaFunction::FormulaFunction(const std::string& text, const std::vector<std::string>& variables,
                                 const std::vector<NamedNumbers>& constants) {
  Scope scope;
  for (std::size_t k = 0; k < variables.size(); ++k) scope.add(variables[k], static_cast<int>(k), std::nullopt);
  scope.add(constants);
  const Expression e(text, variables);
  *this = scope.compiled(e, e.root());
}

}  // namespace lockstep::expression
