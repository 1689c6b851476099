// An object whose key "type" names an entry of a shelf: what every one of its kind has, and what is its type's own.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "framework/mechanism/params/read.h"
#include "framework/description/scene/tables.h"
#include "framework/foundation/support/text.h"

namespace lockstep {

struct Split {
  std::string type;
  Params common;
  Value own;
};

/// Keys that every one of its kind has, then those of the type; where both have a key of one name, the type's.
inline Keys keys_together(const Keys& common, const Keys& own) {
  const auto taken = [&](const Key& key) {
    return std::any_of(own.begin(), own.end(), [&](const Key& other) { return other.name == key.name; });
  };
  Keys keys;
  std::copy_if(common.begin(), common.end(), std::back_inserter(keys), [&](const Key& key) { return !taken(key); });
  keys.insert(keys.end(), own.begin(), own.end());
  return keys;
}

/// Checks the object against both tables and takes it apart. Throws SceneError; an unknown type with the closest one.
template <class Shelf>
Split split(const Value& object, const SceneTable& table, const Shelf& shelf, const std::string& owner,
            const LawSource& laws) {
  const Value* type = object.find("type");
  const auto* entry = type != nullptr && type->text() != nullptr ? shelf.find(*type->text()) : nullptr;
  if (type != nullptr && type->text() != nullptr && entry == nullptr)
    refuse(type->where, owner, "unknown type \"" + *type->text() + "\"" + suggestion(*type->text(), shelf.names()));
  const Keys own_keys = entry != nullptr ? entry->info.keys : Keys{};
  const TypeInfo both{table.info.name, table.info.help, keys_together(table.info.keys, own_keys)};
  const Params checked(object, both, owner, &laws);  // refuses a missing type, unknown keys and wrong forms

  Value own(Value::Object{}), common(Value::Object{});
  own.where = common.where = object.where;
  for (const Value::Member& member : *object.object()) {
    const bool its =
        std::any_of(own_keys.begin(), own_keys.end(), [&](const Key& key) { return key.name == member.key; });
    (its ? own : common).object()->push_back(member);
  }
  return {checked.text("type"), Params(std::move(common), table.info, owner, &laws), std::move(own)};
}

}  // namespace lockstep
