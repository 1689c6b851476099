// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <cmath>

#include <lockstep/error.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/definitions.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

constexpr int kMostCopies = 100'000;

bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c < 0; }

// As it is written in a formula: "-1^2" is -(1^2).
std::string in_formula(long k) { return k < 0 ? "(" + std::to_string(k) + ")" : std::to_string(k); }

// The formula with the index as a number. A name behind a number is a unit.
std::string with_index(const std::string& formula, const std::string& index, const std::string& number) {
  std::string out;
  for (std::size_t i = 0; i < formula.size();) {
    std::size_t end = i;
    while (end < formula.size() && in_name(formula[end])) ++end;
    if (end == i) {
      out += formula[i++];
      continue;
    }
    const std::size_t before = out.find_last_not_of(" \t");
    const bool behind =
        before != std::string::npos && (out[before] == '.' || (out[before] >= '0' && out[before] <= '9'));
    out += !behind && formula.compare(i, end - i, index) == 0 ? number : formula.substr(i, end - i);
    i = end;
  }
  return out;
}

/// One copy of a repeated part.
class Copy {
 public:
  Copy(Definitions& definitions, std::string index, int k)
      : definitions_(definitions), index_(std::move(index)), number_(in_formula(k)) {}

  void fill(Value& v, const std::string& context) const {
    if (const std::string* text = v.text()) {
      const std::string now = filled(*text, is_formula(v), v.where, context);
      replace(v, is_formula(v) ? with_index(now, index_, number_) : now);
    } else if (Value::List* items = v.list()) {
      for (Value& each : *items) fill(each, context);
    } else if (Value::Object* members = v.object()) {
      for (Value::Member& m : *members) m.key = filled(m.key, false, m.where, context), fill(m.value, context);
    }
  }

 private:
  // The text with "{i+1}" replaced.
  std::string filled(const std::string& text, bool formula_around, const SourceLocation& where,
                     const std::string& context) const {
    std::string out;
    for (std::size_t i = 0;;) {
      const std::size_t open = text.find('{', i), close = text.find('}', open);
      out += text.substr(i, open == std::string::npos ? open : open - i);
      if (open == std::string::npos) return out;
      if (close == std::string::npos) refuse(where, context, "\"" + text + "\": a \"{\" without \"}\"; close it");
      const std::string formula = "=" + with_index(text.substr(open + 1, close - open - 1), index_, number_);
      const expression::Amount q = definitions_.evaluate(placed_at(where, formula), context);
      if (q.is_vector || q.measured || q.v[0] != std::round(q.v[0]) || std::abs(q.v[0]) > 1e9)
        refuse(where, context, "\"" + text + "\": the value in braces is " + words_of(q) + "; an integer is expected");
      const long k = static_cast<long>(q.v[0]);
      out += formula_around ? in_formula(k) : std::to_string(k);
      i = close + 1;
    }
  }

  Definitions& definitions_;
  std::string index_, number_;
};

void expand(Value& root, const Value& object, const std::string& owner, Definitions& definitions) {
  Value settled = object;
  if (settled.object() != nullptr)
    for (Value::Member& m : *settled.object())
      if (m.key == "times" || m.key == "from") m.value = definitions.resolved(m.value, part_of(owner, m.key));
  const Params p = params_of(settled, "repeat", owner, nullptr);
  const std::string index = p.text("index");
  if (const std::string fault = expression::name_fault(index); !fault.empty())
    p.refuse("index", "\"" + index + "\" is not a name: " + fault);
  if (dimension_of(index))
    p.refuse("index", "\"" + index + "\" is a unit, as in \"1 " + index + "\"; choose another name, such as \"i\"");
  if (definitions.find(index) != nullptr)
    p.refuse("index", "\"" + index + "\" is a parameter or point already; choose another name");
  const int times = p.integer("times"), from = p.integer("from");
  if (times < 0 || times > kMostCopies)
    p.refuse("times", "it is " + std::to_string(times) + "; give a number from 0 to " + std::to_string(kMostCopies));
  for (int k = 0; k < times; ++k)
    for (const auto& [key, part, where] : *object.object()) {
      if (key == "times" || key == "from" || key == "index") continue;
      const std::string context = part_of(owner, key);
      Value more = part;
      Copy(definitions, index, from + k).fill(more, context);
      append(root, key, std::move(more), context);
    }
}

}  // namespace

void expand_repeats(Value& root) {
  const Value source = root;
  Definitions definitions(source);
  root = root.without({"repeat"});
  const Value& repeats = *source.find("repeat");
  if (repeats.list() == nullptr)
    refuse(repeats.where, "scene.repeat", "expected a list of objects, got " + shown(repeats));
  for (std::size_t i = 0; i < repeats.list()->size(); ++i)
    expand(root, (*repeats.list())[i], item("repeat", i), definitions);
}

}  // namespace lockstep
