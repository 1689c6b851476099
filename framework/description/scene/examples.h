// SPDX-License-Identifier: BSD-3-Clause
// Examples of the types, as they stand in scenes: for `describe`, for the reference, and for tests that make one of each.
#pragma once

#include <string>

#include "framework/description/scene/describe.h"

namespace lockstep {

/// Keys of a type of its own that make a valid one of it, as a JSON object; "{}" where defaults will do, or where none is
/// known. `kind`: "link", "law", "translation law", "rotation law", "force".
LOCKSTEP_API std::string example_keys(const std::string& kind, const std::string& type);

/// How many pairs of markers the example of a type of link takes.
LOCKSTEP_API int example_pairs(const std::string& type);

/// A whole object of the type, in JSON: of a link between bodies "arm" and "ground", or of one that couples the links "A",
/// "B", ...; of a force on these bodies, or in the link "A"; of a law, integrator or solver. "" for an object of scenes, and for a type of a plugin with
/// keys that must be given.
LOCKSTEP_API std::string example_of(const Description&);

}  // namespace lockstep
