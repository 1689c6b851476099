#include "framework/model/value.h"

#include <algorithm>

namespace lockstep {

std::string Where::text() const {
  if (line == 0) return file ? *file : std::string();
  return (file ? *file : std::string("text")) + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Value Value::list(std::initializer_list<double> numbers) {
  List items;
  items.reserve(numbers.size());
  for (const double x : numbers) items.emplace_back(x);
  return Value(std::move(items));
}

Value Value::object(std::initializer_list<std::pair<const char*, Value>> members) {
  Object object;
  object.reserve(members.size());
  for (const auto& [key, value] : members) object.push_back({key, value, {}});
  return Value(std::move(object));
}

const Value* Value::find(std::string_view key) const {
  if (const Object* members = object())
    for (const Member& member : *members)
      if (member.key == key) return &member.value;
  return nullptr;
}

Value Value::without(std::initializer_list<std::string_view> keys) const {
  const Object* members = object();
  if (members == nullptr) return *this;
  Object kept;
  for (const Member& member : *members)
    if (std::find(keys.begin(), keys.end(), member.key) == keys.end()) kept.push_back(member);
  Value v(std::move(kept));
  v.where = where;
  return v;
}

std::string Value::kind() const {
  if (is_null()) return "null";
  if (const bool* b = boolean()) return *b ? "true" : "false";
  if (number() != nullptr) return "a number";
  if (text() != nullptr) return "a text";
  if (const List* items = list())
    return items->empty() ? "an empty list" : "a list of " + std::to_string(items->size());
  return "an object";
}

}  // namespace lockstep
