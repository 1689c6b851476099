#include "framework/tools/program/ways.h"

#include <algorithm>

#include "framework/description/scene/write.h"
#include <lockstep/error.h>

namespace lockstep {
namespace {

std::string one_word(const Value& v) {
  if (v.text() != nullptr) return *v.text();
  std::string text = write_json(v);
  std::erase_if(text, [](char c) { return c == '\n' || c == ' '; });
  return text;
}

std::vector<Value> other_values(const Key& key) {
  std::vector<Value> values;
  const std::string* fallback = key.default_value() != nullptr ? key.default_value()->text() : nullptr;
  if (key.form == Form::choice)
    for (const std::string& choice : key.choices)
      if (fallback == nullptr || *fallback != choice) values.emplace_back(choice);
  return values;
}

}  // namespace

MethodSpec read_way(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types) {
  try {
    return read_method_spec(text, types);
  } catch (const ModelError& error) {
    throw UsageError(option + ": " + error.what());
  }
}

std::string spelled(const MethodSpec& way) {
  std::string text = way.type;
  if (way.keys.object() != nullptr)
    for (const Value::Member& m : *way.keys.object()) text += ":" + m.key + "=" + one_word(m.value);
  return text;
}

Value as_value(const MethodSpec& way) {
  if (way.keys.object() == nullptr || way.keys.object()->empty()) return Value(way.type);
  Value::Object members{{"type", Value(way.type), {}}};
  for (const Value::Member& m : *way.keys.object()) members.push_back(m);
  return Value(std::move(members));
}

std::vector<MethodSpec> all_ways(const MethodSpec& own, const std::vector<TypeInfo>& types) {
  std::vector<MethodSpec> all{own};
  const auto add = [&](MethodSpec way) {
    const auto same = [&](const MethodSpec& other) { return spelled(other) == spelled(way); };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(std::move(way));
  };
  for (const TypeInfo& type : types) {
    add({type.name, Value(Value::Object{}), {}});
    for (const Key& key : type.keys)
      for (const Value& value : other_values(key)) add({type.name, Value(Value::Object{{key.name, value, {}}}), {}});
  }
  return all;
}

MethodSpec with_known_keys(const TypeInfo& type, const Value& keys) {
  Value::Object members;
  if (keys.object() != nullptr)
    for (const Value::Member& m : *keys.object())
      if (std::any_of(type.keys.begin(), type.keys.end(), [&](const Key& k) { return k.name == m.key; }))
        members.push_back(m);
  return {type.name, Value(std::move(members)), {}};
}

}  // namespace lockstep
