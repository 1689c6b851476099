// SPDX-License-Identifier: BSD-3-Clause
// Splits an object whose key "type" names an entry of a shelf into the keys of its kind and those of its type.
#pragma once

#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/text.h>
#include "framework/description/registry/law_units.h"
#include "framework/description/scene/tables.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {

struct Split {
  std::string type;
  Params own, common;
};

/// The keys of the kind, then those of the type; of two keys with one name, the type's.
inline Keys keys_together(const Keys& common, const Keys& own) {
  Keys keys;
  for (const Key& key : common)
    if (key_in({&own}, key.name) == nullptr) keys.push_back(key);
  keys.insert(keys.end(), own.begin(), own.end());
  return keys;
}

/// The object without possible keys of its type, which is not known; a misspelt "type" stays.
inline Value without_own(Value object, const Keys& common) {
  const std::string type[] = {"type"};
  if (object.object() != nullptr)
    std::erase_if(*object.object(), [&](const Value::Member& m) {
      return key_in({&common}, m.key) == nullptr && text::closest_name(m.key, type).empty();
    });
  return object;
}

/// Checks the object against both tables, makes its laws and splits it. Throws SceneError; for an unknown type, with
/// the closest one, and with the errors if that is meant.
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
                 " (if a plugin defines it, name the plugin under \"requires\")");
    });
    if (const std::string near = text::closest_name(*type->text(), shelf.names()); !near.empty()) {
      Value meant = object;
      for (Value::Member& m : *meant.object())
        if (m.key == "type") m.value = near;
      wrong.attempt([&] { split(meant, table, shelf, owner, laws); });
    }
    wrong.raise();
  }
  if (entry == nullptr)  // reports a missing type
    check_members(without_own(object, table.info.keys), table.info.name, {&table.info.keys}, owner);
  const auto own_keys = std::make_shared<const Keys>(entry->info.keys);
  // messages list the type's own keys first
  check_members(object, table.info.name, {own_keys.get(), &table.info.keys}, owner);
  const auto part = [&](bool own, std::shared_ptr<const Keys> keys) {
    Value members(Value::Object{});
    members.where = object.where;
    for (const Value::Member& m : *object.object())
      if ((key_in({own_keys.get()}, m.key) != nullptr) == own) members.object()->push_back(m);
    return with_laws(Params::part(std::make_shared<const Value>(std::move(members)), std::move(keys), owner), &laws);
  };
  return {*type->text(), part(true, own_keys), part(false, table.keys())};
}

}  // namespace lockstep
