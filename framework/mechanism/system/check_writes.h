// SPDX-License-Identifier: BSD-3-Clause
// check_writes: checks that joints and forces write all of their own numbers and nothing else.
#pragma once

namespace lockstep {

class System;

/// Gathers every joint that is not built in once, at the start, into rows between guard values: it must write every
/// number of its rows and none outside. The same for the states and the memory of joints and forces, and for the slots
/// that a force acts on. Costs nothing later. Exceptions of user code are left to the first evaluation, which
/// attributes them. Throws UserCodeError that names the thing and the fault.
void check_writes(const System&);

}  // namespace lockstep
