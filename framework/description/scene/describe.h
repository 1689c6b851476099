// SPDX-License-Identifier: BSD-3-Clause
// Descriptions of the types of a registry and the objects of a scene: names, help, keys; and what is printed of them.
#pragma once

#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include "framework/description/scene/tables.h"

namespace lockstep {

/// One entry of a shelf, or one object of a scene file.
struct Description {
  std::string shelf;          ///< "links", "laws", ..., "scene"
  TypeInfo info;              ///< name, help and keys
  std::string origin;         ///< "built in", or the plugin's name
  std::vector<Part> parts{};  ///< what its keys of Form::any hold
};

/// Names of the shelves: "links", "laws", "translation_laws", "rotation_laws", "forces", "integrators", "solvers".
LOCKSTEP_API std::vector<std::string> shelf_names();

/// Everything on one shelf (for "laws" all three kinds of law), without the keys that all share. Throws SceneError for
/// another name.
LOCKSTEP_API std::vector<Description> shelf_contents(const Registry&, const std::string& shelf);

/// The objects of scene files ("body", "run"), then all types, each with its own keys.
LOCKSTEP_API std::vector<Description> all_descriptions(const Registry&);

/// Those of this name, types first, with the keys that they share with all of their kind. Empty if there is none.
LOCKSTEP_API std::vector<Description> find_descriptions(const Registry&, const std::string& name);

/// Text for a terminal: help, keys with form, unit, default and help.
LOCKSTEP_API std::string describe(const Description&);

/// "length in m", "\"x\" or \"y\"", "object: see `lockstep describe drive`", ...
LOCKSTEP_API std::string form_words(const Key&, const std::vector<Part>& parts = {});

/// A valid set of a type's own keys, as a JSON object; "{}" if defaults are enough, or if none is known. `kind`: "link",
/// "law", "translation law", "rotation law", "force".
LOCKSTEP_API std::string example_keys(const std::string& kind, const std::string& type);

/// The number of marker pairs in the example of a type of joint.
LOCKSTEP_API int example_pairs(const std::string& type);

/// A whole object of the type, in JSON: a joint between bodies "arm" and "ground", or a coupling of the joints "A", "B",
/// ...; a force on these bodies, or in the joint "A"; a law, integrator or solver. "" for an object of scenes, and for a
/// plugin's type with required keys.
LOCKSTEP_API std::string example_of(const Description&);

/// The meaning of a word that is no object and no type, and its owners: a key, a form of values, a unit, "channel"; "" for
/// another word.
LOCKSTEP_API std::string describe_word(const Registry&, const std::string& word);

/// All names that find_descriptions() knows, then all words that describe_word() knows.
LOCKSTEP_API std::vector<std::string> known_words(const Registry&);

/// The reference of scenes as a page in Markdown: every object, type, key, form and unit, with the types of plugins that
/// the registry has.
LOCKSTEP_API std::string scene_reference(const Registry&);

/// JSON Schema of scene files, for editors: draft 2020-12, ending with a newline. The build writes that of the built-in
/// registry to its top folder as scene.schema.json, which is installed.
LOCKSTEP_API std::string scene_schema(const Registry&);

}  // namespace lockstep
