// SPDX-License-Identifier: BSD-3-Clause
// Rows that were left out, or hold although they nearly depend on others: decided for the links in force at the start.
#pragma once

#include <lockstep/step_loop.h>

namespace lockstep {

/// Whether an event switches the link of this name.
LOCKSTEP_API bool switches(const Event&, const std::string& name);

/// The link that an event switches on a loop with rows that were left out (System::leave_out), or on any loop where
/// nearly dependent rows hold (System::hold_down_to); null if it switches none. `modes`: links in force before it.
LOCKSTEP_API const Lock* switched_of_decided(const System&, const std::vector<bool>& modes, const Event&);

/// Throws ModelError for an event that switches such a link. `who`: the event, in words.
LOCKSTEP_API void refuse_switch_of_decided(const System&, const std::vector<bool>& modes, const Event&,
                                           const std::string& who);

}  // namespace lockstep
