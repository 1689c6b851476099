// SPDX-License-Identifier: BSD-3-Clause
// What the scenes' schema needs of JSON Schema (draft 2020-12), for tests.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

namespace lockstep::testing {

/// Holds values against the schemas inside one document.
class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json root) : root_(std::move(root)) {}
  bool takes(const nlohmann::json& value) const { return takes(value, root_); }

 private:
  using Json = nlohmann::json;

  static bool is_of(const Json& v, const Json& types) {
    if (types.is_array())
      return std::any_of(types.begin(), types.end(), [&](const Json& each) { return is_of(v, each); });
    const std::string type = types;
    if (type == "integer") return v.is_number_integer() || (v.is_number() && v.get<double>() == int(v.get<double>()));
    if (type == "number") return v.is_number();
    return type == v.type_name();
  }

  bool takes(const Json& v, const Json& schema) const {
    if (schema.is_boolean()) return schema.get<bool>();
    for (const auto& [word, rule] : schema.items()) {
      if (word == "$ref" && !takes(v, root_.at(Json::json_pointer(rule.get<std::string>().substr(1))))) return false;
      if (word == "type" && !is_of(v, rule)) return false;
      if (word == "pattern" && v.is_string() &&
          !std::regex_search(v.get<std::string>(), std::regex(rule.get<std::string>())))
        return false;
      if (word == "const" && v != rule) return false;
      if (word == "enum" && std::find(rule.begin(), rule.end(), v) == rule.end()) return false;
      if (word == "anyOf" && std::none_of(rule.begin(), rule.end(), [&](const Json& other) { return takes(v, other); }))
        return false;
      if (v.is_array() && !takes_list(v, word, rule)) return false;
      if (v.is_object() && !takes_object(v, word, rule, schema)) return false;
    }
    return true;
  }
  bool takes_list(const Json& v, const std::string& word, const Json& rule) const {
    if (word == "minItems") return v.size() >= rule;
    if (word == "maxItems") return v.size() <= rule;
    return word != "items" || std::all_of(v.begin(), v.end(), [&](const Json& item) { return takes(item, rule); });
  }
  bool takes_object(const Json& v, const std::string& word, const Json& rule, const Json& schema) const {
    if (word == "minProperties") return v.size() >= rule;
    if (word == "maxProperties") return v.size() <= rule;
    if (word == "required")
      return std::all_of(rule.begin(), rule.end(), [&](const Json& key) { return v.contains(key.get<std::string>()); });
    const Json known = schema.value("properties", Json::object());
    for (const auto& [key, member] : v.items()) {
      if (word == "properties" && rule.contains(key) && !takes(member, rule.at(key))) return false;
      if (word == "additionalProperties" && !known.contains(key) && !takes(member, rule)) return false;
    }
    return true;
  }

  Json root_;
};

}  // namespace lockstep::testing
