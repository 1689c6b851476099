// SPDX-License-Identifier: BSD-3-Clause
// ScenePlace: a value of a scene found by its path, such as "links.A.drive.law.slope".
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/author/registry.h>

namespace lockstep {

/// A value of a scene: a number, a word, true or false, a vector, an axis; or nothing yet.
struct ScenePlace {
  Value* value = nullptr;  ///< holds null if the scene leaves it to its default
  std::string path;        ///< with items of lists by name if they have one
  std::string near;        ///< the closest path to a number of the scene, if the scene does not hold this one
  bool whole = false;      ///< whether it is a vector or an axis, which have several values
  Key key;  ///< its key in the tables; for a list's item, the list's key; without a name if there is none
};

/// The steps of a path are keys of objects, names or numbers (from 0) of list items, and x, y, z of vectors. A key that
/// the tables know and the scene leaves out is inserted, empty. Before plugins are loaded an object whose "type" the
/// registry does not know may have any key, which is inserted at the end of the path. Throws ModelError with the nearest
/// valid path if there is no such value, or if it is neither a plain one nor a vector or an axis.
LOCKSTEP_API ScenePlace find_place(Value& root, const std::string& path, const Registry&, bool before_plugins = false);

/// As users write it: "joints.A" for "links.A".
LOCKSTEP_API std::string shown_path(const std::string& path);

/// Calls visit(path, key, value) for all plain values of a scene, with paths as in ScenePlace, and their innermost keys.
using LeafVisit = std::function<void(const std::string& path, const std::string& key, const Value&)>;
LOCKSTEP_API void for_each_leaf(const Value&, const LeafVisit&, const std::string& path = "",
                                const std::string& key = "");

/// A number of a scene, or a text with a unit.
struct NumberAt {
  std::string path;    ///< as in ScenePlace
  const Value* value;  ///< in the scene
};

/// The numbers of a scene; at most some 20 000.
LOCKSTEP_API std::vector<NumberAt> numbers_in(const Value& root);

}  // namespace lockstep
