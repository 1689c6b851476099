// check_writes: checks that links and forces write all of their own numbers and nothing else.
#pragma once

namespace lockstep {

class System;

/// Gathers once, at the start, every link that is not built in, into rows between fences of marks: it must write every
/// number of its rows and none outside. The same for the states and the memory of links and forces, and for the slots
/// that a force pushes. Costs nothing later. An exception in here is left to the first evaluation, which names its
/// culprit. Throws UserCodeError that names the thing and says what it did.
void check_writes(const System&);

}  // namespace lockstep
