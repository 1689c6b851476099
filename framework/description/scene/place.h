// ScenePlace: a value of a scene found by its path, such as "links.A.drive.law.slope".
#pragma once

#include <string>

#include <lockstep/params.h>
#include <lockstep/registry.h>

namespace lockstep {

/// One plain value of a scene: a number, a word, true or false; or nothing yet.
struct ScenePlace {
  Value* value = nullptr;  ///< holds null where the scene leaves it to its default
  std::string path;        ///< things of a list by their name where they have one
  std::string near;        ///< the closest path to a number of the scene, where the scene does not hold this one
  Key key;                 ///< what the tables know of it; of a list's item, the list's key; an empty name: nothing
};

/// Steps of a path are the keys of objects; things of a list go by their name or their number, from 0 on. A key that
/// the tables know and the scene leaves out is put in, empty. Throws ModelError with the nearest right path: no such
/// thing, or one that is no plain value.
LOCKSTEP_API ScenePlace find_place(Value& root, const std::string& path, const Registry&);

}  // namespace lockstep
