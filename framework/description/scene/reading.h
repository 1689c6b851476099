// SPDX-License-Identifier: BSD-3-Clause
// How a scene is read: the files that it may include, its parameters and formulas, its parts (other scenes, their poses,
// repeated parts), its run.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>
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

/// Loads the plugins that the scene requires and the registry lacks, and sets parameters and other plain values, each by
/// "NAME=VALUE". Throws what load_plugin() and set_in_scene() throw.
LOCKSTEP_API Scene with_values(Scene, Registry&, const std::vector<std::string>& set);

/// Throws SceneError for an unknown version of the format, before anything else is read.
void check_format(const Value& root);

/// Reads a scene except for its lists, once its formulas have values: title, description, plugins and run settings.
/// Throws SceneError: unknown keys, values that are not of their form.
void read_root(Scene&);

/// Puts the values of parameters, points and formulas into their places: "=2*crank" becomes "0.2 m", "at": "A" the
/// numbers of point A. Notes them in the scene; without any, the scene stays as it is. Formulas of time and coordinates
/// stay texts and are given the parameters. Throws SceneError with place, key, formula and column.
/// "repeat" and "include" are expanded; the files of the reading are those that include this scene, itself last.
void resolve_formulas(Scene&, SceneReading&);

/// The error with the formula behind each of its lines that is at the place of one.
SceneError told_with_formulas(const Scene&, const SceneError&);

/// Calls f(); a SceneError at the place of a formula gets the formula behind its sentence.
template <class F>
decltype(auto) with_formulas(const Scene& scene, F&& f) {
  if (scene.formulas.empty()) return std::forward<F>(f)();
  try {
    return std::forward<F>(f)();
  } catch (const SceneError& error) {
    throw told_with_formulas(scene, error);
  }
}

/// "joints" is another name of the list "links" of a scene: here it gets that one.
void rename_joints(Value& root);
/// The same in a path such as joints.A.unilateral.restitution.
LOCKSTEP_API void rename_joints(std::string& path);

/// The settings of a scene, with defaults for what it leaves out (or null). Throws SceneError.
LOCKSTEP_API RunSettings read_run(const Value&);
/// The channel of a column, or a formula with channels, or their formulas, in place of the names of columns: of the first n
/// that the scene records. A parameter or point of the same name is read by column n itself, or if the column records that
/// parameter; any other formula must have the name in quotes, for the column. Throws ModelError.
LOCKSTEP_API std::string without_columns(std::string column, const Scene&, std::size_t n = SIZE_MAX);
/// Lets each formula of "record" read the columns above it by their names, and the conditions "require" all; checks these.
void read_columns(Scene&);
/// The conditions "require" of a scene, not checked.
std::vector<ChannelRequest> read_require(const Params& scene);
/// By its name in scenes: project, baumgarte or none.
LOCKSTEP_API Stabilization::Kind stabilization_from(const std::string& word);

/// A picture of one column against another.
struct PictureRequest {
  std::string x, y;  ///< names of columns; "t": the time
};

/// Keys of "run" that are about its files alone.
struct RunOutputs {
  bool units = true;  ///< the header of the CSV names them
  std::vector<PictureRequest> pictures{};
};

/// Those of a scene.
LOCKSTEP_API RunOutputs outputs_of(const Scene&);

/// Replaces "include" of a scene by the contents of the named scenes: their points, bodies, markers, joints, forces and
/// events come before the scene's own, with a prefix before their names, moved by the given pose. Each is checked as a
/// scene by itself; their run settings, gravity, "planar" and "merge" are left out. The formulas of the
/// included scenes are added to `formulas`, as in Scene. Throws SceneError, FileError, and what the rule throws.
void expand_includes(Value& root, SceneReading&, std::vector<std::pair<SourceLocation, std::string>>& formulas);

/// Warns of each key that the included scenes give, that changes how things move, and that the whole does not give.
void tell_left_out(const Value& root, const SceneReading&);

/// Moves all that an included scene places in the world: x -> A x + d for points, A u for directions and velocities,
/// q -> q_A q for orientations; values in the axes of bodies, markers and joints move with these. Not moved are channels
/// of events, and the values that they cross, which stay in world axes; nor vectors among the keys of plugins' forces,
/// whose axes are not known. `scene`: its data, formulas and names of points replaced by numbers. Throws SceneError for
/// values that are not of their form, and for laws of components in world axes if the pose rotates.
void move_scene(Value& scene, const Pose& by);

/// Replaces "repeat" of the scene by its repetitions, at the ends of "points", "bodies", "markers", "links" and "forces".
/// In each, the index is a number in formulas, and "{i}", "{i+1}" in texts become integers. Throws SceneError.
void expand_repeats(Value& root);

}  // namespace lockstep
