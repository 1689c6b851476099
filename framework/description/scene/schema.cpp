// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/describe.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "framework/description/registry/shelves.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/split.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

Json reference(const std::string& name) { return {{"$ref", "#/$defs/" + name}}; }
Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
Json any_of(std::initializer_list<Json> forms) { return {{"anyOf", Json(forms)}}; }

// A number, a text with a unit where the number has a dimension, or a formula.
Json number_schema(Unit unit) {
  const Json number = {{"type", "number"}};
  if (unit == Unit::none) return any_of({number, reference("formula")});
  return any_of({number, {{"type", "string"}, {"examples", {example_of(unit)}}}});
}

Json exactly(const Json& item, int n) { return {{"type", "array"}, {"items", item}, {"minItems", n}, {"maxItems", n}}; }

Json form_schema(const Key& key) {
  const Form f = key.form;
  if (f == Form::number) return number_schema(key.unit);
  if (f == Form::integer) return any_of({{{"type", "integer"}}, reference("formula")});
  if (f == Form::boolean) return {{"type", "boolean"}};
  if (f == Form::text) return {{"type", "string"}};
  if (f == Form::choice) return {{"enum", key.choices}};
  if (f == Form::vector3)  // or a point's name
    return any_of({exactly(number_schema(key.unit), 3),
                   key.unit == Unit::length ? Json{{"type", "string"}} : reference("formula")});
  if (f == Form::axis || f == Form::orientation || f == Form::law) return reference(name_of(f));
  if (f == Form::numbers) return list_of(number_schema(key.unit));
  if (f == Form::points) return list_of(list_of(number_schema(key.unit)));
  if (f == Form::translation_law) return reference("translation_law");
  if (f == Form::rotation_law) return reference("rotation_law");
  return f == Form::laws ? list_of(reference("law")) : Json::object();
}

// What a key of Form::any holds.
Json part_schema(const Key& key, const Part& part) {
  const Json text = {{"type", "string"}}, number = number_schema(Unit::any), vector = exactly(number, 3);
  const Json choice = {{"enum", key.choices}}, object = reference(part.table), formula = reference("formula");
  const auto members = [](const Json& each) { return Json{{"type", "object"}, {"additionalProperties", each}}; };
  const std::string& h = part.holds;
  if (h == "object" || part.names_type()) return object;
  if (h == "list of objects") return list_of(object);
  if (h == "object or list of objects") return any_of({object, list_of(object)});
  if (h == "choice, or object") return any_of({choice, object});
  if (h == "list of texts") return list_of(text);
  if (h == "list of names or objects") return list_of(any_of({text, object}));
  if (h == "list of lists of texts") return list_of(list_of(text));
  if (h.starts_with("list of channel names") || h == "list of conditions")
    return list_of(any_of({text, members(text)}));
  if (h == "[x, y, z], 3 rows of 3, or object") return any_of({vector, formula, exactly(vector, 3), object});
  if (h == "[x, y, z] or choice") return any_of({vector, formula, choice});
  if (h == "object of quantities") return members(any_of({number, vector}));
  if (h == "object of laws") return members(reference("law"));
  if (h == "object of points") return members(any_of({vector, formula}));
  return members(any_of({number, text, {{"type", "boolean"}}}));  // object of values by path
}

Json key_schema(const Key& key, const std::vector<Part>& parts) {
  const auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.key == key.name; });
  Json schema = part != parts.end() ? part_schema(key, *part) : form_schema(key);
  std::string help = key.help;
  if (!si_unit(key.unit).empty()) help += (help.empty() ? "" : "; ") + si_unit(key.unit);
  if (!help.empty()) schema["description"] = help;
  if (const Value* v = key.default_value()) schema["default"] = Json::parse(write_json(*v));
  return schema;
}

Json object_schema(const TypeInfo& info, const std::vector<Part>& parts) {
  Json properties = Json::object(), required = Json::array();
  for (const Key& key : info.keys) {
    properties[key.name] = key_schema(key, parts);
    if (key.required()) required.push_back(key.name);
  }
  Json schema = {{"type", "object"}, {"description", info.help}, {"properties", std::move(properties)}};
  if (!required.empty()) schema["required"] = std::move(required);
  schema["additionalProperties"] = false;
  return schema;
}

// The object of one type of a shelf: common keys, then the type's own, "type" fixed.
Json typed_schema(const TypeInfo& type, const SceneTable& common) {
  TypeInfo both{type.name, type.help, keys_together(common.info.keys, type.keys)};
  if (common.info.keys.empty()) both.keys.insert(both.keys.begin(), Key{"type", Form::text, Unit::none, kRequired, ""});
  Json schema = object_schema(both, common.parts);
  schema["properties"]["type"] = {{"const", type.name}};
  return schema;
}

Json shelf_schema(const Registry& registry, const std::string& shelf, const SceneTable& common,
                  std::vector<Json> forms = {}) {
  for (const Description& d : shelf_contents(registry, shelf))
    if (d.shelf == shelf) forms.push_back(typed_schema(d.info, common));
  return {{"anyOf", Json(forms)}};
}

// A law: an object with its type, or a value for the law "constant".
Json law_schema(const Registry& registry, const std::string& shelf) {
  const TypeInfo* constant = find_type(registry, shelf, "constant");
  if (constant == nullptr || constant->keys.empty()) return shelf_schema(registry, shelf, {});
  return shelf_schema(registry, shelf, {}, {form_schema(constant->keys.front())});
}

// A method: its name, or an object with its type.
Json method_schema(const Registry& registry, const std::string& shelf) {
  Json names = Json::array();
  for (const Description& d : shelf_contents(registry, shelf)) names.push_back(d.info.name);
  return shelf_schema(registry, shelf, {}, {Json{{"enum", names}}});
}

Json orientation_schema() {
  const Json angle = number_schema(Unit::angle), matrix = exactly(exactly(number_schema(Unit::none), 3), 3);
  const auto object = [](Json properties, int n) {
    return Json{{"type", "object"},
                {"properties", std::move(properties)},
                {"minProperties", n},
                {"maxProperties", n},
                {"additionalProperties", false}};
  };
  const Json axis = reference("axis");
  return {{"description", "axes of a frame in its parent"},
          {"anyOf",
           {exactly(number_schema(Unit::none), 4), object({{"axis", axis}, {"angle", angle}}, 2),
            object({{"angles", exactly(angle, 3)}, {"sequence", {{"type", "string"}}}}, 2),
            object({{"matrix", matrix}}, 1), object({{"x", axis}, {"y", axis}, {"z", axis}}, 2)}}};
}

Json definitions(const Registry& registry) {
  Json defs = Json::object();
  for (const SceneTable& table : scene_tables()) {
    if (table.info.name == "scene") continue;
    defs[table.info.name] =
        table.shelf.empty() ? object_schema(table.info, table.parts) : shelf_schema(registry, table.shelf, table);
  }
  defs["formula"] = {
      {"description", "a formula of parameters and points, as in \"=2*crank\""}, {"type", "string"}, {"pattern", "^="}};
  const Json names = {{"enum", {"x", "y", "z", "-x", "-y", "-z", "+x", "+y", "+z"}}};
  defs["axis"] = {{"description", "a direction, not zero"},
                  {"anyOf", {names, exactly(number_schema(Unit::any), 3), reference("formula")}}};
  defs["orientation"] = orientation_schema();
  for (const std::string law : {"law", "translation_law", "rotation_law"}) defs[law] = law_schema(registry, law + "s");
  for (const char* methods : {"integrators", "solvers"}) defs[methods] = method_schema(registry, methods);
  return defs;
}

}  // namespace

std::string scene_schema(const Registry& registry) {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "lockstep scene"}};
  const SceneTable& scene = scene_table("scene");
  const Json root = object_schema(scene.info, scene.parts);
  for (const auto& [key, value] : root.items()) schema[key] = value;
  schema["properties"]["lockstep"]["const"] = 1;
  schema["$defs"] = definitions(registry);
  return schema.dump(1, ' ') + "\n";
}

}  // namespace lockstep
