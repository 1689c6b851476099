// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/law_units.h"

#include <lockstep/author/registry.h>
#include "framework/description/registry/shelves.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

void check_text(const Value& v, Unit unit, int per_second, const std::string& context) {
  if (v.text() == nullptr) return;
  const Measured read = read_quantity(*v.text(), unit, per_second);
  if (!read.problem.empty()) refuse(v.where, context, read.problem);
}

// How many times more per second a key is than the value of its law.
int shift_of(const Key& key) {
  return key.of_law == LawQuantity::rate ? 1 : key.of_law == LawQuantity::acceleration ? 2 : 0;
}

// The numbers of a key of a law.
void check_numbers(const Value& v, const Key& key, const LawDimension& law, const std::string& context) {
  int per_second = law.per_second + shift_of(key);
  const bool a_rate = key.of_law != LawQuantity::value;
  if (key.of_law == LawQuantity::other || (a_rate && !law.of_time)) return;
  if (v.list() == nullptr) return check_text(v, law.unit, per_second, context);
  for (std::size_t i = 0; i < v.list()->size(); ++i) {
    const Value& one = (*v.list())[i];
    const std::string at = item(context, i);
    check_text(one, law.unit, per_second, at);
    if (key.of_law == LawQuantity::coefficients) ++per_second;
    if (one.list() == nullptr) continue;  // a point: the time, then values
    for (std::size_t j = 0; j < one.list()->size(); ++j)
      if (j > 0 || law.of_time)
        check_text((*one.list())[j], j == 0 ? Unit::time : law.unit, j == 0 ? 0 : per_second, item(at, j));
  }
}

// The formula of a law, with its constants.
void check_formula(const Value& formula, const Value* constants, const LawDimension& law, const std::string& context,
                   const std::string& owner) {
  if (formula.text() == nullptr || law.unit == Unit::any) return;
  Dimension value = dimension_of(law.unit);
  value.s -= law.per_second;
  expression::Scope scope;
  scope.add("t", 0, law.of_time ? std::optional(dimension_of(Unit::time)) : std::nullopt);
  if (constants != nullptr) scope.add(expression::read_constants(*constants, part_of(owner, "parameters")));
  try {
    scope.check(expression::Expression(*formula.text(), std::vector<std::string>{"t"}), value);
  } catch (const ModelError& error) {
    refuse(formula.where, context, error.what());
  }
}

// A column of the file that a law reads: keys "t_column", the argument, and others, the values. A unit in the header is
// converted to SI, so it must be of the dimension that the law has here.
void check_column(const Value& law, const Key& key, const LawDimension& dimension, const std::string& owner) {
  const bool argument = key.name == "t_column";
  if (argument && !dimension.of_time) return;
  const int shift = shift_of(key);
  if (!argument && shift > 0 && !dimension.of_time) return;
  const Value* given = law.find(key.name);
  const Value* column = given != nullptr ? given : key.default_value();
  if (column == nullptr || column->text() == nullptr) return;
  const std::string file = path_of_file(*law.find("file"));
  const CsvReader reader(file);
  const CsvColumn& found = reader.columns()[reader.find(*column->text())];
  if (found.unit.empty() || found.unit == "-") return;
  const Measured read = read_quantity("1 " + found.unit, argument ? Unit::time : dimension.unit,
                                      argument ? 0 : dimension.per_second + shift);
  if (read.problem.empty()) return;
  const Value& place = given != nullptr ? *given : *law.find("file");
  refuse(place.where, part_of(owner, key.name),
         "column '" + found.name + "' of " + file + " is in [" + found.unit + "]: " + read.problem);
}

}  // namespace

void check_unit(const Params& p, const std::string& key, Unit unit, int per_second) {
  if (p.has(key)) check_text(p.value(key), unit, per_second, part_of(p.owner(), key));
}

void check_law_units(const Value& law, Form form, LawDimension dimension, const Registry& registry,
                     const std::string& owner) {
  if (law.list() != nullptr && form == Form::laws) {
    for (std::size_t i = 0; i < law.list()->size(); ++i)
      check_law_units((*law.list())[i], Form::law, dimension, registry, item(owner, i));
    return;
  }
  check_text(law, dimension.unit, dimension.per_second, owner);
  const Value* type = law.object() != nullptr ? law.find("type") : nullptr;
  const TypeInfo* info = type != nullptr ? find_type(registry, shelf_of(form), *type->text()) : nullptr;
  if (info == nullptr) return;
  const bool reads = law.find("file") != nullptr && law.find("file")->text() != nullptr;
  for (const Key& key : info->keys) {
    if (reads && key.name.ends_with("_column")) check_column(law, key, dimension, owner);
    const Value* v = law.find(key.name);
    if (v == nullptr) continue;
    const std::string place = part_of(owner, key.name);
    if (*type->text() == "formula" && key.form == Form::text && key.of_law == LawQuantity::value)
      check_formula(*v, law.find("parameters"), dimension, place, owner);
    if (!holds_law(key.form) && key.unit == Unit::any) check_numbers(*v, key, dimension, place);
    const bool own = key.unit != Unit::none && key.unit != Unit::any;  // checked when it was made
    if (holds_law(key.form) && !own && key.of_law == LawQuantity::value)
      check_law_units(*v, key.form, dimension, registry, place);
  }
}

}  // namespace lockstep
