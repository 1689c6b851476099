#include "framework/tools/program/describe_scene.h"

#include <algorithm>
#include <cctype>

#include <lockstep/text.h>
#include "framework/description/scene/write.h"
#include "framework/tools/program/commands.h"

namespace lockstep {
namespace {

bool in_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || static_cast<signed char>(c) < 0;
}

// Whether a formula reads this name; behind a number stands a unit.
bool reads(const std::string& formula, const std::string& name) {
  for (std::size_t at = formula.find(name); at != std::string::npos; at = formula.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool whole = (at == 0 || (!in_name(formula[at - 1]) && formula[at - 1] != '.')) &&
                       (end == formula.size() || !in_name(formula[end]));
    const std::size_t before = at == 0 ? std::string::npos : formula.find_last_not_of(" \t", at - 1);
    const bool unit = before != std::string::npos && formula[before] >= '0' && formula[before] <= '9';
    if (whole && !unit) return true;
  }
  return false;
}

// Of all texts of a scene those that read the name: formulas, and, of a point, places that name it.
void add_readers(const Value& v, const std::string& path, const std::string& key, const SceneParameter& of,
                 std::vector<std::string>& readers) {
  static const std::vector<std::string> kPlaces = {"at", "at_p", "at_s", "position", "from", "to", "world_at"};
  const std::string before = path.empty() ? "" : path + ".";
  if (const Value::List* items = v.list())
    for (std::size_t i = 0; i < items->size(); ++i) {
      const Value* name = (*items)[i].find("name");
      const bool named = name != nullptr && name->text() != nullptr;
      add_readers((*items)[i], before + (named ? *name->text() : std::to_string(i)), key, of, readers);
    }
  if (const Value::Object* members = v.object())
    for (const Value::Member& m : *members) add_readers(m.value, before + m.key, m.key, of, readers);
  const std::string* text = v.text();
  if (text == nullptr) return;
  const bool place = of.is_point && *text == of.name && std::find(kPlaces.begin(), kPlaces.end(), key) != kPlaces.end();
  if (place || (text->starts_with('=') && reads(*text, of.name))) readers.push_back(path);
}

std::string without_unit(const std::string& quantity) { return quantity.substr(0, quantity.find(' ')); }

}  // namespace

std::string parameter_value(const SceneParameter& p) {
  const Value::List* items = p.value.list();
  if (items == nullptr) return plain_text(p.value);
  std::string text, unit;
  for (const Value& each : *items) {
    const std::string one = plain_text(each);
    text += (text.empty() ? "[" : ", ") + without_unit(one);
    if (each.text() != nullptr && one.find(' ') != std::string::npos) unit = one.substr(one.find(' '));
  }
  return text + "]" + unit;
}

ParameterFacts parameter_facts(const Scene& scene, const std::string& name) {
  std::vector<std::string> known;
  for (const SceneParameter& p : scene.parameters) {
    known.push_back(p.name);
    if (p.name != name) continue;
    ParameterFacts facts{p.name, p.is_point ? "point" : "parameter", parameter_value(p), write_json_line(p.written),
                         p.written.where.text()};
    add_readers(scene.written.is_null() ? scene.root : scene.written, "", "", p, facts.read_by);
    return facts;
  }
  throw UsageError("describe: " + scene.file + " has no parameter or point \"" + name + "\"" +
                   text::suggestion(name, known));
}

}  // namespace lockstep
