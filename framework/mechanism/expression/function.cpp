// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/function.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep::expression {
namespace {

// Notes the numbers whose signs separate what is smooth.
struct Edges {
  const std::vector<Term>& terms;
  std::vector<double>& out;

  void decided(int /*what*/, int by, double number) const {
    const Function f = terms[by].function;
    const bool whole = f == Function("floor") || f == Function("ceil") || f == Function("mod");
    out.push_back(whole ? std::sin(kPi * number) : f == Function("round") ? std::cos(kPi * number) : number);
  }
  void computed(const Term& t, double x, double y) const {
    const Operation o = t.operation;
    const Function f = t.function;
    if (o == Operation::divide && terms[t.parts[1]].operation != Operation::number) out.push_back(y);
    if (o == Operation::power && !(t.value == std::round(t.value) && t.value > 0)) out.push_back(x);
    if (o != Operation::call) return;
    if (f == Function("log") || f == Function("sqrt")) out.push_back(x);
    if (f == Function("asin") || f == Function("acos")) out.push_back(1 - std::abs(x));
    if (f == Function("tan")) out.push_back(std::cos(x));
    if (f == Function("atan2")) out.push_back(y < 0 ? x : 1);
    if (f == Function("hypot"))
      out.push_back(x + y / std::numbers::phi);  // zero where both are, if they pass zero on a line
  }
};

// The SI unit of the arguments (axis 0) or values (1) of a table, by its points or the header of its file; "": none.
std::string unit_of_axis(const Value& table, std::size_t axis, const std::string& place) {
  const Value *points = table.find("points"), *file = table.find("file");
  const std::string key = axis == 0 ? "t" : "y";
  if (file != nullptr && file->text() != nullptr) try {
      const CsvReader reader(path_of_file(*file));
      const Value* const column = table.find(key + "_column");
      const bool named = column != nullptr && column->text() != nullptr;
      const auto d = dimension_of(reader.columns()[reader.find(named ? *column->text() : key)].unit);
      return d ? si_unit(*d) : "";
    } catch (const FileError&) {  // the law reports it
    }
  std::string unit;
  for (std::size_t i = 0; points != nullptr && points->list() != nullptr && i < points->list()->size(); ++i) {
    const Value::List* const point = (*points->list())[i].list();
    const std::string* const text = point != nullptr && point->size() > axis ? (*point)[axis].text() : nullptr;
    if (text == nullptr || !read_quantity(*text, Unit::any).problem.empty()) continue;
    const Dimension d = dimension_of_text(*text);
    if (!unit.empty() && unit != si_unit(d))
      lockstep::refuse((*point)[axis].where, item(item(part_of(place, "points"), i), axis),
                       "\"" + *text + "\" is " + article_name_of(d) + ", but the points before are in " + unit +
                           " there; give all the same dimension");
    unit = si_unit(d);
  }
  return unit;
}

}  // namespace

void FormulaFunction::edges(std::span<const double> variables, std::vector<double>& out) const {
  value_of_term(terms_, terms_.size() - 1, variables, Edges{terms_, out});
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
    } else {
      const std::string argument = unit_of_axis(m.value, 0, place);
      c.unit = unit_of_axis(m.value, 1, place);
      if (!argument.empty()) c.unit += std::string(kOf) + argument;
    }
  }
  return all;
}

}  // namespace lockstep::expression
