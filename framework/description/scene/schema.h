// JSON Schema of scene files, for editors: generated from the tables of the scene and the types of a registry.
#pragma once

#include <string>

#include <lockstep/registry.h>

namespace lockstep {

/// JSON Schema, draft 2020-12, ends with a newline. That of the built-in registry is written beside the program's build tree as scene.schema.json and installed.
LOCKSTEP_API std::string scene_schema(const Registry&);

}  // namespace lockstep
