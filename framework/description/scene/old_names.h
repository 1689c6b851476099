// Keys of scenes that were renamed: their old names are read for one more release.
#pragma once

#include <string>

#include <lockstep/author/params.h>

namespace lockstep {

/// Gives renamed keys of a scene's root their present names and logs a warning for each, with its place. Throws
/// SceneError where an object has the old and the new name of a key.
void rename_old_keys(Value& root);

/// The same for the third step of a path such as links.A.one_sided.restitution.
void rename_old_keys(std::string& path);

}  // namespace lockstep
