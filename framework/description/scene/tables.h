// SPDX-License-Identifier: BSD-3-Clause
// The objects of a scene file, one table of keys each, for parser, schema and `describe` alike.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/params.h>

namespace lockstep {

/// The contents of a key of Form::any, in the words of `describe`: "list of objects", "object of quantities", ...;
/// "choice" means the key's choices.
struct Part {
  std::string key, holds, table{};  ///< the table of its objects, or the shelf of their types

  bool names_type() const { return holds == "name or object"; }  ///< of a shelf, or {"type": name, and its keys}
};

/// One kind of object: its name, help and keys, and what its keys of Form::any hold. Where `shelf` is given, an object
/// also takes the keys of the type that its key "type" names there.
struct SceneTable {
  TypeInfo info;
  std::vector<Part> parts{};
  std::string shelf{};

  /// Of one of scene_tables(), which stay as long as the program.
  std::shared_ptr<const Keys> keys() const { return {std::shared_ptr<const void>(), &info.keys}; }
};

/// All of them, the scene itself first.
LOCKSTEP_API const std::vector<SceneTable>& scene_tables();

/// By name: "scene", "body", "link", "run", ... The name must exist.
LOCKSTEP_API const SceneTable& scene_table(const std::string& name);

}  // namespace lockstep
