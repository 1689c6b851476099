// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <lockstep/author/registry.h>
#include <lockstep/text.h>
#include "framework/description/registry/shelves.h"
#include "framework/description/scene/builder.h"
#include "framework/description/scene/definitions.h"
#include "framework/description/scene/place.h"
#include "framework/description/scene/tree.h"
#include "framework/foundation/support/lines.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

bool holds_formula(const Value& v) {
  bool holds = is_formula(v);
  for_each_child(v, [&](const Value& each, const std::string&) { holds = holds || holds_formula(each); });
  return holds;
}

// Scenes are resolved before plugins are loaded.
const Registry& built_in_types() {
  static const Registry kBuiltIn = builtin_registry();
  return kBuiltIn;
}

/// The keys of a type that hold texts, not numbers, and whether it gets the parameters.
struct Texts {
  std::vector<std::string> keys{};
  bool takes_parameters = false;
};

Texts texts_of_type(const std::string& type) {
  Texts texts;
  for (const char* shelf : {"laws", "translation_laws", "rotation_laws", "links", "forces"}) {
    const TypeInfo* info = find_type(built_in_types(), shelf, type);
    if (info == nullptr) continue;
    const bool takes = std::ranges::any_of(info->keys, [](const Key& k) { return k.name == "parameters"; });
    texts.takes_parameters = texts.takes_parameters || takes;
    for (const Key& key : info->keys)
      if (key.form == Form::text || key.form == Form::choice || (takes && key.form == Form::any))
        texts.keys.push_back(key.name);
  }
  return texts;
}

// The words of texts that may be names.
void add_names(const Value& v, std::set<std::string>& names) {
  if (const Value::List* items = v.list())
    for (const Value& each : *items) add_names(each, names);
  if (v.text() == nullptr) return;
  std::string word;
  for (const char c : *v.text() + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || static_cast<unsigned char>(c) >= 0x80)
      word += c;
    else
      names.insert(std::exchange(word, {}));
  }
}

class Resolver {
 public:
  /// `source`: the scene with its formulas.
  Resolver(Scene& scene, const Value& source) : scene_(scene), definitions_(source) {}

  void resolve() {
    Value::Object& root = *scene_.root.object();
    wrong_.attempt([&] { scene_.parameters = definitions_.all(); });
    if (Value* const tables = member(scene_.root, "tables")) walk(*tables, "scene.tables");
    for (Value::Member& m : root) {
      static const std::vector<std::string> kTexts = {"$schema",  "title",   "description",
                                                      "requires", "require", "tables"};
      if (std::find(kTexts.begin(), kTexts.end(), m.key) != kTexts.end()) continue;
      if (m.key == "parameters" || m.key == "points")
        settle(m);
      else
        list(m);
    }
    wrong_.raise();
  }

 private:
  // "parameters" and "points" as they are computed.
  void settle(Value::Member& m) {
    for (Value::Member& each : *m.value.object())
      wrong_.attempt([&] {
        if (const expression::Amount* amount = definitions_.find(each.key))
          note(each.value), each.value = Definitions::placed_value(*amount, each.value.where);
      });
  }

  void list(Value::Member& m) {
    const auto things = std::ranges::find(kThings, m.key, [](const auto& t) { return t.first; });
    if (things == std::end(kThings) || m.value.list() == nullptr)
      return walk(m.value, m.key == "run" ? "run" : part_of("scene", m.key));
    for (std::size_t i = 0; Value & object : *m.value.list()) {
      const std::string owner = owner_of(things->second, object, m.key, i++);
      if (object.object() != nullptr) named_points(things->second, object, owner);
      walk(object, owner);
    }
  }

  // -- names of points
  void named_points(const std::string& kind, Value& object, const std::string& owner) {
    if (kind == "body") {
      point(object, "position", owner);
      if (Value* rod = member(object, "rod"))
        for (const char* end : {"from", "to"}) point(*rod, end, part_of(owner, "rod"));
    } else if (kind == "marker") {
      for (Value::Member& m : *object.object())
        if (m.key == "world_at" || m.key == "at")
          if (point(m.value, part_of(owner, m.key))) m.key = "world_at";
    } else if (kind == "link" || kind == "force") {
      for_each_placing(object, owner, [&](Value& placing, const std::string& its) {
        for (const char* key : {"at", "at_p", "at_s"}) point(placing, key, its);
      });
    }
  }
  void point(Value& object, const char* key, const std::string& owner) {
    if (Value* v = member(object, key)) point(*v, part_of(owner, key));
  }
  // The numbers of the point that is named; false where none is named.
  bool point(Value& v, const std::string& context) {
    if (v.text() == nullptr || is_formula(v)) return false;
    const std::string name = *v.text();
    const bool known = definitions_.is_point(name);
    const std::vector<std::string> points = known ? std::vector<std::string>() : definitions_.names(true);
    if (!known && points.empty()) return false;  // the reader of the key reports it
    wrong_.attempt([&] {
      if (!known) refuse(v.where, context, "unknown point \"" + name + "\"" + text::suggestion(name, points));
      v = Definitions::placed_value(*definitions_.find(name), v.where);
    });
    return true;
  }

  // -- formulas
  void note(const Value& v) {
    if (is_formula(v)) scene_.formulas.emplace_back(v.where, *v.text());
  }

  void walk(Value& v, const std::string& context) {
    if (is_formula(v)) {
      note(v);
      wrong_.attempt([&] { v = Definitions::placed_value(definitions_.evaluate(v, context), v.where); });
    } else if (Value::List* items = v.list()) {
      for (std::size_t i = 0; i < items->size(); ++i)
        if (needs_walk((*items)[i])) walk((*items)[i], item(context, i));
    } else if (v.object() != nullptr) {
      object(v, context);
    }
  }
  // Numbers do not; a context is a text to be made.
  static bool needs_walk(const Value& v) { return v.text() != nullptr || v.list() != nullptr || v.object() != nullptr; }

  void object(Value& v, const std::string& context) {
    const Value* type = v.find("type");
    const Texts texts = type != nullptr && type->text() != nullptr ? texts_of_type(*type->text()) : Texts{};
    const auto is_text = [&](const std::string& key) {
      return key == "name" || key == "type" || key == "record" || key == "draw" || key == "pictures" ||
             key == "channel" || std::find(texts.keys.begin(), texts.keys.end(), key) != texts.keys.end();
    };
    for (Value::Member& m : *v.object())
      if (needs_walk(m.value) && (m.key == "parameters" || !is_text(m.key))) walk(m.value, part_of(context, m.key));
    if (texts.takes_parameters) give_parameters(v);
  }

  // The scene's parameters that its formulas read, except those that the object names itself.
  void give_parameters(Value& v) {
    std::set<std::string> read;
    for (const Value::Member& m : *v.object()) add_names(m.value, read);
    for (const std::string& name : read) {
      const expression::Amount* amount = nullptr;
      wrong_.attempt([&] { amount = definitions_.find(name); });
      const Value* const tables = scene_.root.find("tables");
      const Value* const table = tables != nullptr ? tables->find(name) : nullptr;
      if (amount == nullptr && table == nullptr) continue;
      const Value* own = v.find("parameters");
      if (own != nullptr && (own->object() == nullptr || own->find(name) != nullptr))
        continue;  // an error of its reader
      Value& all = made_under(v, "parameters", Value::Object{});
      all.object()->push_back({name, table != nullptr ? *table : Definitions::placed_value(*amount, v.where), v.where});
    }
  }
  Scene& scene_;
  Definitions definitions_;
  Refusals wrong_;
};

// Takes "set" out of the scene.
Value::Object take_set(Value& root) {
  const Value* set = root.find("set");
  if (set == nullptr) return {};
  if (set->object() == nullptr)
    refuse(set->where, "scene.set", "expected an object of values by path, got " + shown(*set));
  Value::Object given = *set->object();
  root = root.without({"set"});
  return given;
}

// A parameter or point that the scene itself defines: parts read it.
bool leads_to_own_definition(const Value& root, const std::string& path) {
  const std::vector<std::string> steps = split_at('.', path);
  if (steps.size() < 2 || (steps[0] != "parameters" && steps[0] != "points")) return false;
  const Value* own = root.find(steps[0]);
  return own != nullptr && own->find(steps[1]) != nullptr;
}

// "set": new values of present things.
void set_by_path(Value& root, std::span<const Value::Member> given) {
  for (const Value::Member& m : given) {
    if (m.value.list() != nullptr || m.value.object() != nullptr || m.value.is_null())
      refuse(m.where, "scene.set",
             "\"" + m.key + "\" is set to " + shown(m.value) + "; set a single value: a number, a text, true or false");
    placed(m.where, "scene.set", [&] { *find_place(root, m.key, built_in_types(), true).value = m.value; });
  }
}

// The dimension of a formula if a parameter has another value; none if it cannot be computed.
std::optional<expression::Exponents> dimension_with(Value root, const std::string& parameter, const Value& value,
                                                    const Value& formula) {
  for (Value::Member& m : members(root, "parameters"))
    if (m.key == parameter) m.value = value;
  try {
    return Definitions(root).evaluate(formula, "").dimension;
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Of a line that expects a quantity, as in "such as "12 mm"": the plain numbers among the parameters of the formula, and
// the unit that makes its value one.
std::string without_units(const Scene& scene, const std::string& formula, const std::string& line) {
  constexpr std::string_view kExample = "or a text such as \"";
  const std::size_t at = line.find(kExample);
  if (at == std::string::npos) return "";
  const Dimension wanted =
      dimension_of_text(line.substr(at + kExample.size(), line.find('"', at + kExample.size()) - at - kExample.size()));
  std::set<std::string> names;
  add_names(formula, names);
  std::string words;
  for (const SceneParameter& p : scene.parameters) {
    if (p.is_point || p.written.number() == nullptr || !names.contains(p.name)) continue;
    const std::string number = text::number(*p.written.number());
    words += std::string(words.empty() ? ", in which " : " and ") + p.name + " = " + number + " has no unit";
    const auto now = dimension_with(scene.written, p.name, p.written, formula);
    if (!now) continue;
    const std::string unit = si_unit(Dimension{wanted.m - int(now->m), wanted.kg - int(now->kg), wanted.s - int(now->s),
                                               wanted.rad - int(now->rad)});
    const std::string given = number + " " + unit;
    if (dimension_with(scene.written, p.name, given, formula) == expression::exponents_of(wanted))
      words += ": \"" + given + "\"?";
  }
  return words;
}

}  // namespace

SceneError told_with_formulas(const Scene& scene, const SceneError& error) {
  std::string words;
  for (const std::string& line : lines_of(error.what())) {
    words += (words.empty() ? "" : "\n") + line;
    const auto is_there = [&](const auto& formula) {
      return formula.first.line != 0 && line.starts_with(formula.first.text() + ": ");
    };
    const auto found = std::find_if(scene.formulas.begin(), scene.formulas.end(), is_there);
    if (found != scene.formulas.end())
      words += "; the value is from the formula \"" + found->second + "\"" + without_units(scene, found->second, line);
  }
  return SceneError(words, static_cast<const ErrorData&>(error));
}

void resolve_formulas(Scene& scene, SceneReading& reading) {
  Value& root = scene.root;
  const auto has = [&](const char* key) { return root.find(key) != nullptr; };
  if (!has("parameters") && !has("points") && !has("repeat") && !has("include") && !has("set") && !holds_formula(root))
    return;
  scene.written = root;
  if (!has("include") && !has("repeat") && !has("set")) return Resolver(scene, scene.written).resolve();
  Value::Object given = take_set(root);
  const auto of_parts = std::stable_partition(
      given.begin(), given.end(), [&](const Value::Member& m) { return leads_to_own_definition(root, m.key); });
  set_by_path(root, {given.begin(), of_parts});
  if (has("include")) expand_includes(root, reading, scene.formulas);
  if (has("repeat")) expand_repeats(root);
  set_by_path(root, {of_parts, given.end()});
  const Value source = root;
  Resolver(scene, source).resolve();
}

}  // namespace lockstep
