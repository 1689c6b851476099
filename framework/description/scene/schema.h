// JSON Schema of scene files, for editors: generated from the tables of the scene and the types of a registry.
#pragma once

#include <string>

#include <lockstep/author/registry.h>

namespace lockstep {

/// JSON Schema, draft 2020-12, ending with a newline. The build writes that of the built-in registry to its top folder
/// as scene.schema.json, which is installed.
LOCKSTEP_API std::string scene_schema(const Registry&);

}  // namespace lockstep
