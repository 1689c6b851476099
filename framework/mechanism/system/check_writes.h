// Whether links and forces write what is theirs and nothing else.
#pragma once

namespace lockstep {

class System;

/// Gathers once, at the start, every link that is not built in, into rows fenced with marks: every number of its rows
/// has to be written, and nothing beside them; so with the states and the memory of links and forces, and with the
/// slots that a force pushes. Costs nothing later. What throws here is left to the first evaluation, which names it.
/// Throws UserCodeError that names the thing and says what it did.
void check_writes(const System&);

}  // namespace lockstep
