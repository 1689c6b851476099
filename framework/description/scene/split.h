// Splits an object whose key "type" names an entry of a shelf into the keys of its kind and those of its type.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <lockstep/registry.h>
#include <lockstep/text.h>
#include "framework/description/scene/tables.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {

struct Split {
  std::string type;
  Params common, own;
};

inline bool contains_key(const Keys& keys, const std::string& name) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
}

inline Keys without(const Keys& keys, const Keys& others) {
  Keys rest;
  std::copy_if(keys.begin(), keys.end(), std::back_inserter(rest),
               [&](const Key& key) { return !contains_key(others, key.name); });
  return rest;
}

/// The keys of the kind, then those of the type; where both have a key of one name, the type's.
inline Keys keys_together(const Keys& common, const Keys& own) {
  Keys keys;
  std::copy_if(common.begin(), common.end(), std::back_inserter(keys),
               [&](const Key& key) { return !contains_key(own, key.name); });
  keys.insert(keys.end(), own.begin(), own.end());
  return keys;
}

/// The object without what may be keys of its type, which is not known; what may be a slip of "type" stays.
inline Value without_own(Value object, const Keys& common) {
  const std::string type[] = {"type"};
  if (object.object() != nullptr)
    std::erase_if(*object.object(), [&](const Value::Member& m) {
      return !contains_key(common, m.key) && text::closest_name(m.key, type).empty();
    });
  return object;
}

/// Checks the object against both tables, makes its laws and splits it. Throws SceneError; for an unknown type, with
/// the closest one, and with what is wrong if that is meant.
template <class Shelf>
Split split(const Value& object, const SceneTable& table, const Shelf& shelf, const std::string& owner,
            const Registry& laws) {
  const Value* type = object.find("type");
  const auto* entry = type != nullptr && type->text() != nullptr ? shelf.find(*type->text()) : nullptr;
  if (type != nullptr && type->text() != nullptr && entry == nullptr) {
    Refusals wrong;
    wrong.attempt([&] {
      refuse(type->where, owner,
             "unknown type \"" + *type->text() + "\"" + text::suggestion(*type->text(), shelf.names()) +
                 " (a plugin that brings it is named under \"requires\")");
    });
    if (const std::string near = text::closest_name(*type->text(), shelf.names()); !near.empty()) {
      Value meant = object;
      for (Value::Member& m : *meant.object())
        if (m.key == "type") m.value = near;
      wrong.attempt([&] { split(meant, table, shelf, owner, laws); });
    }
    wrong.raise();
  }
  const Keys own_keys = entry != nullptr ? entry->info.keys : Keys{};
  // messages list the type's own keys first
  const TypeInfo both{table.info.name, table.info.help, keys_together(own_keys, without(table.info.keys, own_keys))};
  // refuses a missing type, unknown keys and wrong forms
  const Params all = checked_params(Params::unchecked(entry != nullptr ? object : without_own(object, table.info.keys)),
                                    both, owner, &laws);
  return {all.text("type"), all.only(without(table.info.keys, own_keys)), all.only(own_keys)};
}

}  // namespace lockstep
