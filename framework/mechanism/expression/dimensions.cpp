// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/dimensions.h"

#include <algorithm>
#include <map>

#include "framework/mechanism/expression/quantity.h"

namespace lockstep::expression {
namespace {

Amount amount_of(const MeasuredVariable& v) {
  Amount q = Amount::number(1);
  q.dimension = exponents_of(v.dimension.value_or(Dimension{})), q.measured = true;
  return q;
}

Amount amount_of(const Constant& c) {
  Amount q;
  std::copy(std::begin(c.value), std::end(c.value), q.v.data());
  q.is_vector = c.is_vector, q.dimension = exponents_of(c.dimension), q.measured = c.dimension != Dimension{};
  q.with_unit = q.measured;
  return q;
}

bool has_unit(const Node& n, const std::vector<Constant>& constants) {
  if (n.operation == Operation::number) return n.measured && n.dimension != Dimension{};
  return n.operation == Operation::name && std::ranges::any_of(constants, [&](const Constant& c) {
           return c.name == n.name && c.dimension != Dimension{};
         });
}

// "t is a time, q is a length": of the variables that are read.
std::string words_of_variables(const std::vector<const MeasuredVariable*>& read) {
  std::string words;
  for (const MeasuredVariable* v : read)
    if (v->dimension)
      words += (words.empty() ? ": " : ", ") + v->name + " is " + lockstep::article_name_of(*v->dimension);
  return words;
}

// Whether a value of dimension `is` may be given if `wanted` is expected: the radian counts as 1.
bool fits(Exponents is, Exponents wanted) {
  is.rad = wanted.rad = 0;
  return is == wanted;
}

}  // namespace

void check_dimensions(const std::string& formula, const std::vector<MeasuredVariable>& variables,
                      const std::vector<Constant>& constants, const std::optional<Dimension>& value) {
  std::vector<std::string> names;
  for (const MeasuredVariable& v : variables) names.push_back(v.name);
  const Expression e(formula, names);
  if (std::ranges::none_of(e.nodes(), [&](const Node& n) { return has_unit(n, constants); })) return;

  std::map<std::string, Amount> amounts;
  std::vector<const MeasuredVariable*> read;
  const std::vector<std::string> in_formula = names_in(e);
  for (const Constant& c : constants) amounts[c.name] = amount_of(c);
  for (const MeasuredVariable& v : variables) {
    amounts[v.name] = amount_of(v);
    if (std::ranges::find(in_formula, v.name) == in_formula.end()) continue;
    if (!v.dimension) return;
    read.push_back(&v);
  }
  const auto amount = [&](const std::string& name) -> const Amount* {
    const auto found = amounts.find(name);
    return found != amounts.end() ? &found->second : nullptr;
  };
  const auto is_variable = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  const std::string hint = "; this formula has a unit, so all its quantities have units" + words_of_variables(read);
  const Amount q = dimension_of(e, e.root(), amount, is_variable, hint);
  if (!value || !q.measured || q.any || !q.with_unit || fits(q.dimension, exponents_of(*value))) return;
  e.refuse(e.node(e.root()),
           "its value is " + article_name_of(q) + "; " + lockstep::article_name_of(*value) + " is expected" + hint);
}

}  // namespace lockstep::expression
