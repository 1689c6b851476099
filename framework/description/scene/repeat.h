// Parts of a scene that are repeated.
#pragma once

#include <lockstep/author/params.h>

namespace lockstep {

/// Replaces "repeat" of the scene by its copies, at the ends of "points", "bodies", "markers", "links" and "forces". In
/// each copy the index is a number in formulas, and "{i}", "{i+1}" in texts become whole numbers. Throws SceneError.
void expand_repeats(Value& root);

}  // namespace lockstep
