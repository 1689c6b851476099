// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/tree.h"

#include <iterator>

#include "framework/mechanism/params/read.h"

namespace lockstep {

std::span<Value> items(Value& object, std::string_view key) {
  Value* v = member(object, key);
  return v != nullptr && v->list() != nullptr ? std::span<Value>(*v->list()) : std::span<Value>();
}

std::span<Value::Member> members(Value& object, std::string_view key) {
  Value* v = member(object, key);
  return v != nullptr && v->object() != nullptr ? std::span<Value::Member>(*v->object()) : std::span<Value::Member>();
}

Value placed_at(const SourceLocation& where, Value v) {
  v.where = where;
  if (Value::List* items = v.list())
    for (Value& each : *items) each.where = where;
  return v;
}

Value& made_under(Value& object, const std::string& key, Value fresh) {
  if (Value* v = member(object, key)) return *v;
  const SourceLocation where = object.where;
  fresh.where = where;
  object.object()->push_back({key, std::move(fresh), where});
  return object.object()->back().value;
}

void append(Value& scene, const std::string& key, Value more, const std::string& context) {
  const SourceLocation where = more.where;
  const bool points = key == "points";
  if (points ? more.object() == nullptr : more.list() == nullptr)
    refuse(where, context,
           std::string("expected ") + (points ? "an object of points by name" : "a list of objects") + ", got " +
               shown(more));
  Value* all = member(scene, key);
  if (all == nullptr)
    scene.object()->push_back({key, std::move(more), where});
  else if (all->list() != nullptr && more.list() != nullptr)
    std::ranges::move(*more.list(), std::back_inserter(*all->list()));
  else if (all->object() != nullptr && more.object() != nullptr)
    std::ranges::move(*more.object(), std::back_inserter(*all->object()));
}

}  // namespace lockstep
