// The positions of an assembled start by themselves.
#pragma once

#include <lockstep/assembly.h>

namespace lockstep {

/// Moves the positions of a state onto the constraints as assemble() does, without a word. Throws as assemble() does.
LOCKSTEP_API void assemble_positions(Dynamics&, State&, const AssemblyOptions&);

}  // namespace lockstep
