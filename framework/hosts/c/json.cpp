// SPDX-License-Identifier: BSD-3-Clause
#include "framework/hosts/c/json.h"

#include <cmath>

#include <lockstep/author/registry.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/write.h"

namespace lockstep::c {
namespace {

void add(Value& to, const char* key, Value value) { to.object()->push_back({key, std::move(value), {}}); }
void add_text(Value& to, const char* key, const std::string& text) {
  if (!text.empty()) add(to, key, text);
}
void add_number(Value& to, const char* key, double x) {
  if (!std::isnan(x)) add(to, key, number_or_null(x));
}

Value value_of(const Key& key, const Description& of) {
  Value v = Value::object(
      {{"name", key.name}, {"form", form_words(key, of.parts)}, {"required", key.required()}, {"help", key.help}});
  if (key.default_value() != nullptr) add(v, "default", *key.default_value());
  return v;
}

Value value_of(const Description& d) {
  Value::List keys;
  for (const Key& key : d.info.keys) keys.push_back(value_of(key, d));
  Value v = Value::object({{"name", d.info.name},
                           {"shelf", d.shelf},
                           {"help", d.info.help},
                           {"origin", d.origin},
                           {"keys", std::move(keys)}});
  if (const std::string example = example_of(d); !example.empty()) add(v, "example", read_json(example, "example"));
  return v;
}

}  // namespace

std::string utf8(const std::string& text) { return *read_json(write_json_line(text), "").text(); }

Value number_or_null(double x) { return std::isfinite(x) ? Value(x) : Value(); }

void write_error(const Error& error, int code, std::string& text, std::string& json) noexcept {
  try {
    text = utf8(error.what());
    const ErrorData& d = error.data();
    json = write_json_line(Value::object(
        {{"code", code},
         {"kind", to_string(error.kind())},
         {"text", text},
         {"thing",
          Value::object(
              {{"kind", d.thing.kind}, {"name", d.thing.name}, {"type", d.thing.type}, {"origin", d.thing.origin}})},
         {"key", d.key},
         {"value", d.value},
         {"problem", d.problem},
         {"advice", d.advice},
         {"file", d.file},
         {"line", d.line},
         {"column", d.column},
         {"t", number_or_null(d.t)}}));
  } catch (...) {  // no memory for them
  }
}

Value value_of(const Finding& f) {
  Value v = Value::object({{"severity", to_string(f.severity())}, {"code", std::string(f.code())}});
  add_text(v, "thing", f.thing), add_text(v, "message", f.message), add_text(v, "advice", f.advice);
  add_number(v, "value", f.value), add_number(v, "limit", f.limit);
  add_text(v, "unit", f.unit), add_number(v, "t", f.t), add_text(v, "place", f.place);
  return v;
}

Value types_of_registry(const Registry& registry) {
  Value all = Value::object({});
  for (const char* shelf : {"links", "laws", "forces", "integrators", "solvers"}) {
    Value::List list;
    for (const Description& d : shelf_contents(registry, shelf)) list.push_back(value_of(d));
    add(all, shelf, std::move(list));
  }
  return all;
}

}  // namespace lockstep::c
