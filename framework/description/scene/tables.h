// SPDX-License-Identifier: BSD-3-Clause
// The objects of a scene file, one table of keys each, for parser, schema and `describe` alike.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>

namespace lockstep {

/// What a key of Form::any holds.
enum class Holds {
  object,            ///< one object of `table`
  objects,           ///< a list of them
  object_or_list,    ///< either
  choice_or_object,  ///< one of the key's choices, or an object of `table`
  texts,             ///< a list of texts
  texts_or_objects,  ///< a list of texts and of objects of `table`
  text_lists,        ///< a list of lists of texts
  channels,          ///< a list of channel names and of objects {"own name": "channel name"}
  typed,             ///< a name on the shelf `table`, or {"type": name, and its keys}
  vector_or_object,  ///< [x, y, z], an object of `table`, or three rows of three
  vector_or_word,    ///< [x, y, z], or one of the key's choices
  quantities,        ///< an object of numbers, texts with units, vectors and formulas by name
  named_points,      ///< an object of vectors and formulas by name
  settings           ///< an object of numbers, texts, formulas, true and false by path
};

struct Part {
  std::string key;
  Holds holds;
  std::string table{};
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
