// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/scope.h"

#include <algorithm>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/quotes.h"

namespace lockstep::expression {
namespace {

Amount amount_of(const Scope::Name& name) {
  const Meaning& m = name.meaning;
  Amount q;
  q.is_vector = m.is_vector;
  if (m.variable < 0)
    std::copy(m.value.begin(), m.value.end(), q.v.data());
  else
    q.v.setOnes();
  q.dimension = exponents_of(name.dimension.value_or(Dimension{}));
  q.with_unit = name.with_unit, q.measured = m.variable >= 0 || name.with_unit;
  return q;
}

// Component k of a vector.
Scope::Name component(Scope::Name of, std::size_t k) {
  of.meaning.is_vector = false;
  if (of.meaning.variable >= 0) of.meaning.variable += static_cast<int>(k);
  of.meaning.value = {of.meaning.value[k]};
  return of;
}

// Whether a value of dimension `is` may be given if `wanted` is expected: the radian counts as 1.
bool fits(Exponents is, Exponents wanted) {
  is.rad = wanted.rad = 0;
  return is == wanted;
}

}  // namespace

void Scope::add(const std::string& name, const Name& as) {
  const auto known = std::ranges::find(entries_, name, &Entry::called);
  if (known != entries_.end())
    known->name.clash = true;
  else
    entries_.push_back({name, as, amount_of(as)});
}

void Scope::add(const std::string& name, int variable, const std::optional<Dimension>& dimension) {
  add(name, {.meaning = {.variable = variable}, .dimension = dimension});
}

void Scope::add(const std::vector<NamedNumbers>& constants) {
  for (const NamedNumbers& c : constants) {
    Name name;
    name.meaning.is_vector = c.values.size() == 3, name.meaning.table = c.table;
    std::ranges::copy(c.values, name.meaning.value.begin());
    if (!c.unit.empty()) name.dimension = lockstep::dimension_of(c.unit), name.with_unit = true;
    add(c.name, name);
  }
}

const Scope::Entry* Scope::entry(const std::string& name) {
  const auto known = std::ranges::find(entries_, name, &Entry::called);
  if (known != entries_.end()) return &*known;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot + 2 != name.size()) return nullptr;
  const std::size_t k = std::string_view("xyz").find(name[dot + 1]);
  const Entry* const whole = entry(name.substr(0, dot));
  if (k == std::string::npos || whole == nullptr || !whole->name.meaning.is_vector) return nullptr;
  add(name, component(whole->name, k));
  return &entries_.back();
}

// Three numbers whose names begin with this one.
void Scope::find_vector(const std::string& name) {
  if (entry(name) != nullptr || name.find('@') != std::string::npos) return;
  for (const char* between : {"_", ".", ""}) try {
      Name whole = others_(name + between + "x");
      others_(name + between + "y"), others_(name + between + "z");
      whole.meaning.is_vector = true;
      return add(name, whole);
    } catch (const ModelError&) {  // not these
    }
}

std::vector<std::string> Scope::names() const {
  std::vector<std::string> known;
  for (const Entry& each : entries_) known.push_back(each.called);
  known.emplace_back("pi");
  return known;
}

const Scope::Name& Scope::of(const Expression& e, const Node& n) {
  const Name* name = find(n.name);
  std::string problem;
  if (name == nullptr && others_) {
    const std::string called = without_quotes(n.name);
    try {
      add(n.name, others_(called));
    } catch (const ModelError& error) {
      problem = error.what();
      find_vector(called);
      find_vector(called.substr(0, called.rfind('.')));
      if (const Name* const of_vector = find(called); of_vector != nullptr && called != n.name) add(n.name, *of_vector);
    }
    name = find(n.name);
  } else if (name == nullptr) {
    problem = "unknown name \"" + n.name + "\"" + text::suggestion(n.name, names());
  }
  if (name == nullptr) e.refuse(n, problem);
  if (name->clash)
    e.refuse(n, "\"" + n.name + "\" is both a variable of this formula and a parameter or point; rename the " +
                    "parameter or point");
  return *name;
}

FormulaFunction Scope::compiled(const Expression& e, int node, const OfMotion& of_motion) {
  return {e, node, [&](const Node& n) { return of(e, n).meaning; }, of_motion};
}

std::optional<Amount> Scope::dimension_of(const Expression& e, int node, const std::string& hint, bool strict) {
  for (const std::string& name : names_in(e))
    if (const Name* const known = find(name); known != nullptr && !known->dimension) return std::nullopt;
  const auto varies = [this](const std::string& name) {
    const Name* const known = find(name);
    return known != nullptr && known->meaning.variable >= 0;
  };
  return expression::dimension_of(
      e, node, [this](const std::string& name) { return amount(name); }, varies, hint, strict);
}

void Scope::check(const Expression& e, const std::optional<Dimension>& value) {
  const auto has_unit = [this](const Node& n) {
    if (n.operation == Operation::number) return n.measured && n.dimension != Dimension{};
    const Name* const name = n.operation == Operation::name ? find(n.name) : nullptr;
    return name != nullptr && name->with_unit;
  };
  if (std::ranges::none_of(e.nodes(), has_unit)) return;
  std::string hint = "; this formula has a unit, so all its quantities have units", before = ": ";
  for (const std::string& name : names_in(e))
    if (const Name* const read = find(name); read != nullptr && read->meaning.variable >= 0 && read->dimension)
      hint += before + name + " is " + article_name_of(*read->dimension), before = ", ";
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
