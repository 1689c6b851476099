#include "framework/tools/program/ways.h"

#include <algorithm>

#include "framework/description/scene/json.h"
#include "framework/description/scene/write.h"
#include "framework/foundation/support/text.h"

namespace lockstep {
namespace {

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> parts{""};
  for (const char c : text)
    if (c == between)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

// Numbers, true, false and texts in quotes are JSON; everything else is a text as it stands.
Value read_word(const std::string& word) {
  try {
    return read_json(word, "");
  } catch (const SceneError&) {
    return Value(word);
  }
}

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

Typed read_way(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types) {
  const std::vector<std::string> parts = parts_of(text, ':');
  std::vector<std::string> names, keys;
  const TypeInfo* type = nullptr;
  for (const TypeInfo& t : types) {
    names.push_back(t.name);
    if (t.name == parts.front()) type = &t;
  }
  if (type == nullptr)
    throw UsageError(option + ": unknown name \"" + parts.front() + "\"" + suggestion(parts.front(), names));
  for (const Key& key : type->keys) keys.push_back(key.name);
  Value::Object members;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equal = parts[i].find('=');
    const std::string key = parts[i].substr(0, equal);
    if (equal == std::string::npos || std::find(keys.begin(), keys.end(), key) == keys.end())
      throw UsageError(option + ": \"" + parts[i] + "\" in \"" + text + "\" sets no key of " + type->name +
                       (keys.empty() ? ", which has none" : suggestion(key, keys)) + "; write " + type->name +
                       ":key=value, see `lockstep describe " + type->name + "`");
    members.push_back({key, read_word(parts[i].substr(equal + 1)), {}});
  }
  return {type->name, Value(std::move(members)), {}};
}

std::string spelled(const Typed& way) {
  std::string text = way.type;
  if (way.keys.object() != nullptr)
    for (const Value::Member& m : *way.keys.object()) text += ":" + m.key + "=" + one_word(m.value);
  return text;
}

Value as_value(const Typed& way) {
  if (way.keys.object() == nullptr || way.keys.object()->empty()) return Value(way.type);
  Value::Object members{{"type", Value(way.type), {}}};
  for (const Value::Member& m : *way.keys.object()) members.push_back(m);
  return Value(std::move(members));
}

std::vector<Typed> all_ways(const Typed& own, const std::vector<TypeInfo>& types) {
  std::vector<Typed> all{own};
  const auto add = [&](Typed way) {
    const auto same = [&](const Typed& other) { return spelled(other) == spelled(way); };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(std::move(way));
  };
  for (const TypeInfo& type : types) {
    add({type.name, Value(Value::Object{}), {}});
    for (const Key& key : type.keys)
      for (const Value& value : other_values(key)) add({type.name, Value(Value::Object{{key.name, value, {}}}), {}});
  }
  return all;
}

Typed with_known_keys(const TypeInfo& type, const Value& keys) {
  Value::Object members;
  if (keys.object() != nullptr)
    for (const Value::Member& m : *keys.object())
      if (std::any_of(type.keys.begin(), type.keys.end(), [&](const Key& k) { return k.name == m.key; }))
        members.push_back(m);
  return {type.name, Value(std::move(members)), {}};
}

}  // namespace lockstep
