// SPDX-License-Identifier: BSD-3-Clause
// A scene as a tree of values: ways into it, and changes that keep the places in the file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <lockstep/author/params.h>

namespace lockstep {

/// The member of an object; nullptr if there is none.
inline Value* member(Value& object, std::string_view key) {
  return const_cast<Value*>(std::as_const(object).find(key));
}
/// The text under a key of an object; nullptr if there is none.
inline const std::string* text_under(const Value& object, std::string_view key) {
  const Value* v = object.find(key);
  return v != nullptr ? v->text() : nullptr;
}
/// The same; "" where there is none.
inline std::string text_of(const Value& object, std::string_view key) {
  const std::string* text = text_under(object, key);
  return text != nullptr ? *text : std::string();
}
/// The items of the list under a key; none if there is no list.
LOCKSTEP_API std::span<Value> items(Value& object, std::string_view key);
inline std::span<const Value> items(const Value& object, std::string_view key) {
  return items(const_cast<Value&>(object), key);
}
/// The items of a list; of anything else itself.
template <class V>
std::span<V> one_or_all(V& v) {
  return v.list() != nullptr ? std::span<V>(*v.list()) : std::span<V>(&v, 1);
}
/// The members of the object under a key; none if there is no object.
std::span<Value::Member> members(Value& object, std::string_view key);

/// The value at a place, with the items of a list.
LOCKSTEP_API Value placed_at(const SourceLocation&, Value);
/// Gives a value another content at its place.
inline void replace(Value& v, Value by) { v = placed_at(SourceLocation(v.where), std::move(by)); }
/// The value of a key; if there is none, a fresh one at the place of the object.
LOCKSTEP_API Value& made_under(Value& object, const std::string& key, Value fresh);
/// Gives a key another value, at the place of the old one or of the object.
inline void put(Value& object, const std::string& key, Value v) { replace(made_under(object, key, {}), std::move(v)); }
/// Puts points, members of an object, or other things, items of a list, behind those under a key of the scene. Throws
/// SceneError if they are of another form.
void append(Value& scene, const std::string& key, Value more, const std::string& context);

/// Calls visit(child, key) for the items of a list, whose key is "", and for the members of an object.
template <class V, class F>
void for_each_child(V& v, F&& visit) {
  if (auto* items = v.list())
    for (auto& each : *items) visit(each, std::string());
  if (auto* members = v.object())
    for (auto& m : *members) visit(m.value, m.key);
}

/// Lists of things of a scene, and what messages call one of each.
constexpr std::pair<const char*, const char*> kThings[] = {
    {"bodies", "body"}, {"markers", "marker"}, {"links", "link"}, {"forces", "force"}, {"events", "event"}};

/// Calls visit(object, owner) for what places markers: a link or force itself, and the pairs of a coupling.
template <class F>
void for_each_placing(Value& object, const std::string& owner, F&& visit) {
  visit(object, owner);
  std::size_t i = 0;
  for (Value& pair : items(object, "pairs")) visit(pair, part_of(owner, "pairs") + "[" + std::to_string(i++) + "]");
}

}  // namespace lockstep
