// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include <algorithm>

namespace lockstep {

std::string SourceLocation::text() const {
  if (line == 0) return file ? *file : std::string();
  return (file ? *file : std::string("text")) + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Value::Value() = default;
Value::Value(bool b) : data_(b) {}
Value::Value(double x) : data_(x) {}
Value::Value(int x) : data_(static_cast<double>(x)) {}
Value::Value(const char* s) : data_(std::string(s)) {}
Value::Value(std::string s) : data_(std::move(s)) {}
Value::Value(List items) : data_(std::move(items)) {}
Value::Value(Object members) : data_(std::move(members)) {}
// Copied first and moved in: if a copy runs out of memory, std::variant of libstdc++ 12 destroys what it has not made.
Value::Value(const Value& other) : where(other.where) {
  if (const List* items = other.list())
    data_ = List(*items);
  else if (const Object* members = other.object())
    data_ = Object(*members);
  else if (const std::string* words = other.text())
    data_ = std::string(*words);
  else if (const double* x = other.number())
    data_ = *x;
  else if (const bool* b = other.boolean())
    data_ = *b;
}
Value::Value(Value&&) noexcept = default;
Value& Value::operator=(const Value& other) {
  if (this != &other) *this = Value(other);
  return *this;
}
Value& Value::operator=(Value&&) noexcept = default;
Value::~Value() = default;

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
