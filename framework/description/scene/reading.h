// SPDX-License-Identifier: BSD-3-Clause
// How a scene is read: which files it may include.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// Called for each scene that another one includes, before it is looked for: throws if it may not be read. `named`: the
/// text that names it; `file`: its path.
using IncludeRule = std::function<void(const Value& named, const std::string& file)>;

/// A key of an included scene that is read and left out: the whole has one of its own, or none.
struct LeftOutKey {
  SourceLocation where;
  std::string key, value;
};

/// One reading of a scene, with all that it includes.
struct SceneReading {
  std::vector<std::string> files;      ///< those that are being read: each includes the next
  IncludeRule rule{};                  ///< none: any file may be included
  std::vector<LeftOutKey> left_out{};  ///< of the scenes that are included
};

/// A scene as scene_from() of scene.h reads it, which includes only what the rule lets it. `again`: it was read before
/// with other values, and the keys that are left out were reported.
LOCKSTEP_API Scene scene_from(Value root, std::string file, const IncludeRule&, bool again = false);

/// Throws SceneError for an unknown version of the format, before anything else is read.
void check_format(const Value& root);

/// Reads a scene except for its lists, once its formulas have values: title, description, plugins and run settings.
/// Throws SceneError: unknown keys, values that are not of their form.
void read_root(Scene&);

/// Gives renamed keys of a scene's root their present names and logs a warning for each, with its place. Throws
/// SceneError if an object has the old and the new name of a key.
void rename_old_keys(Value& root);

/// The same for the third step of a path such as links.A.one_sided.restitution.
LOCKSTEP_API void rename_old_keys(std::string& path);

/// The settings of a scene, with defaults for what it leaves out (or null). Throws SceneError.
LOCKSTEP_API RunSettings read_run(const Value&);
/// By its name in scenes: project, baumgarte or none.
LOCKSTEP_API Stabilization::Kind stabilization_from(const std::string& word);

}  // namespace lockstep
