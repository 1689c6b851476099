#include "framework/description/scene/schema.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "framework/mechanism/params/units.h"
#include "framework/description/scene/split.h"
#include "framework/description/scene/tables.h"
#include "framework/description/scene/write.h"

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
  switch (key.form) {
    case Form::number:
      return number_schema(key.unit);
    case Form::integer:
      return any_of({{{"type", "integer"}}, reference("formula")});
    case Form::boolean:
      return {{"type", "boolean"}};
    case Form::text:
      return {{"type", "string"}};
    case Form::choice:
      return {{"enum", key.choices}};
    case Form::vector3:
      return any_of({exactly(number_schema(key.unit), 3),
                     key.unit == Unit::length ? Json{{"type", "string"}} : reference("formula")});  // or a point's name
    case Form::axis:
      return reference("axis");
    case Form::orientation:
      return reference("orientation");
    case Form::numbers:
      return list_of(number_schema(key.unit));
    case Form::points:
      return list_of(list_of(number_schema(key.unit)));
    case Form::law:
      return reference("law");
    case Form::translation_law:
      return reference("translation_law");
    case Form::rotation_law:
      return reference("rotation_law");
    case Form::laws:
      return list_of(reference("law"));
    case Form::any:
      break;
  }
  return Json::object();
}

// What a key of Form::any holds.
Json part_schema(const Key& key, const Part& part) {
  const Json text = {{"type", "string"}}, vector = exactly(number_schema(Unit::any), 3);
  switch (part.holds) {
    case Holds::object:
      return reference(part.table);
    case Holds::objects:
      return list_of(reference(part.table));
    case Holds::object_or_list:
      return any_of({reference(part.table), list_of(reference(part.table))});
    case Holds::choice_or_object:
      return any_of({{{"enum", key.choices}}, reference(part.table)});
    case Holds::texts:
      return list_of(text);
    case Holds::texts_or_objects:
      return list_of(any_of({text, reference(part.table)}));
    case Holds::text_lists:
      return list_of(list_of(text));
    case Holds::channels:
      return list_of(any_of({text, {{"type", "object"}, {"additionalProperties", text}}}));
    case Holds::typed:
      return reference(part.table);
    case Holds::vector_or_object:
      return any_of({exactly(number_schema(Unit::any), 3), reference("formula"),
                     exactly(exactly(number_schema(Unit::any), 3), 3), reference(part.table)});
    case Holds::vector_or_word:
      return any_of({exactly(number_schema(Unit::any), 3), reference("formula"), {{"enum", key.choices}}});
    case Holds::quantities:
      return {{"type", "object"}, {"additionalProperties", any_of({number_schema(Unit::any), vector})}};
    case Holds::named_points:
      return {{"type", "object"}, {"additionalProperties", any_of({vector, reference("formula")})}};
    case Holds::settings:
      return {{"type", "object"},
              {"additionalProperties", any_of({number_schema(Unit::any), text, {{"type", "boolean"}}})}};
  }
  return Json::object();
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

template <class Shelf>
Json shelf_schema(const Shelf& shelf, const SceneTable& common, std::vector<Json> forms = {}) {
  for (const auto& [name, entry] : shelf.entries()) forms.push_back(typed_schema(entry.info, common));
  return {{"anyOf", Json(forms)}};
}

// A law: an object with its type, or a value for the law "constant".
template <class Shelf>
Json law_schema(const Shelf& shelf) {
  std::vector<Json> forms;
  if (const auto* constant = shelf.find("constant"); constant != nullptr && !constant->info.keys.empty())
    forms.push_back(form_schema(constant->info.keys.front()));
  return shelf_schema(shelf, {}, std::move(forms));
}

Json name_or_typed(const Json& schema, const std::vector<std::string>& names) {
  Json forms = Json::array({Json{{"enum", names}}});
  for (const Json& form : schema.at("anyOf")) forms.push_back(form);
  return {{"anyOf", std::move(forms)}};
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

Json axis_schema() {
  return {{"description", "a direction, not zero"},
          {"anyOf",
           {Json{{"enum", {"x", "y", "z", "-x", "-y", "-z", "+x", "+y", "+z"}}}, exactly(number_schema(Unit::any), 3),
            reference("formula")}}};
}

Json definitions(const Registry& registry) {
  Json defs = Json::object();
  for (const SceneTable& table : scene_tables()) {
    if (table.info.name == "scene") continue;
    if (table.shelf == "links")
      defs["link"] = shelf_schema(registry.links, table);
    else if (table.shelf == "forces")
      defs["force"] = shelf_schema(registry.forces, table);
    else
      defs[table.info.name] = object_schema(table.info, table.parts);
  }
  defs["formula"] = {
      {"description", "a formula of parameters and points, as in \"=2*crank\""}, {"type", "string"}, {"pattern", "^="}};
  defs["axis"] = axis_schema();
  defs["orientation"] = orientation_schema();
  defs["law"] = law_schema(registry.laws);
  defs["translation_law"] = law_schema(registry.translation_laws);
  defs["rotation_law"] = law_schema(registry.rotation_laws);
  defs["integrators"] = name_or_typed(shelf_schema(registry.integrators, {}), registry.integrators.names());
  defs["solvers"] = name_or_typed(shelf_schema(registry.solvers, {}), registry.solvers.names());
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
