// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/describe_scene.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/place.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/tools/program/commands.h"

namespace lockstep {
namespace {

// Whether a formula reads this name. Text in braces in repeated parts, "{i+n}", is a separate formula for a whole
// number.
bool reads(const std::string& formula, const std::string& name) {
  std::string outside;
  for (std::size_t i = 0; i < formula.size();) {
    const std::size_t open = std::min(formula.find('{', i), formula.size()), close = formula.find('}', open);
    outside += formula.substr(i, open - i);
    if (close == std::string::npos) break;
    if (reads(formula.substr(open + 1, close - open - 1), name)) return true;
    outside += '0';
    i = close + 1;
  }
  try {
    const std::vector<std::string> names = expression::names_in(expression::Expression(outside));
    return std::find(names.begin(), names.end(), name) != names.end();
  } catch (const ModelError&) {
    return false;  // a text that only looks like one
  }
}

// Of all texts of a scene those that read the name: formulas, and, of a point, places that name it.
std::vector<std::string> readers_of(const SceneParameter& of, const Value& root) {
  static const std::vector<std::string> kPlaces = {"at", "at_p", "at_s", "position", "from", "to", "world_at"};
  std::vector<std::string> readers;
  for_each_leaf(root, [&](const std::string& path, const std::string& key, const Value& v) {
    const std::string* text = v.text();
    if (text == nullptr) return;
    const bool place = of.is_point && *text == of.name && std::ranges::find(kPlaces, key) != kPlaces.end();
    const bool template_of_copies = path.starts_with("repeat.") && text->find('{') != std::string::npos;
    if (place || ((text->starts_with('=') || template_of_copies) && reads(*text, of.name)))
      readers.push_back(shown_path(path));
  });
  return readers;
}

// "[1, 2, 3] m" and "[0, \"=side\", 0]", as they are shown.
bool is_list(const std::string& shown) { return shown.starts_with('['); }

}  // namespace

std::string value_words(const Value& v, bool brief) {
  const auto split = [&](const Value& one) {
    const std::string text = plain_text(one), number = text.substr(0, text.find(' '));
    return std::pair(brief ? fmt::format("{:.6g}", std::stod(number)) : number, text.substr(number.size()));
  };
  if (v.list() == nullptr) return brief ? split(v).first + split(v).second : plain_text(v);
  std::string numbers, unit;
  for (const Value& each : *v.list()) {
    const auto [number, its] = split(each);
    numbers += (numbers.empty() ? "" : ", ") + number;
    if (!its.empty()) unit = its;
  }
  return "[" + numbers + "]" + unit;
}

std::string ways_to_change(const ParameterFacts& f) {
  if (!f.is_own && !is_list(f.written)) return "it is defined by a part: change the values of the part";
  const std::string whole = "--set " + f.name + "=\"=[1, 2, 3]\"";
  if (!is_list(f.value)) return "another value: --set " + f.name + "=..., a range: --vary " + f.name + "=...";
  if (!is_list(f.written)) return "another value: " + whole;  // a formula of the whole vector
  return "another value: --set " + f.name + ".x=..., " + (f.is_own ? whole + ", " : "") + "a range: --vary " + f.name +
         ".x=...";
}

ParameterFacts parameter_facts(const Scene& scene, const std::string& name) {
  std::vector<std::string> known;
  for (const SceneParameter& p : scene.parameters) {
    known.push_back(p.name);
    if (p.name != name) continue;
    ParameterFacts facts{p.name, p.is_point ? "point" : "parameter", value_words(p.value), write_json_line(p.written),
                         p.written.where.text()};
    const Value& root = scene.written.is_null() ? scene.root : scene.written;
    const Value* shelf = root.find(p.is_point ? "points" : "parameters");
    facts.is_own = shelf != nullptr && shelf->find(p.name) != nullptr;
    facts.read_by = readers_of(p, root);
    return facts;
  }
  throw UsageError("describe: " + scene.file + " has no parameter or point \"" + name + "\"" +
                   text::suggestion(name, known));
}

}  // namespace lockstep
