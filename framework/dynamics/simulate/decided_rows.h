// Rows that were left out, or hold although they nearly depend on others: decided for the links in force at the start.
#pragma once

#include <lockstep/step_loop.h>

namespace lockstep {

/// Throws ModelError for an event that switches a link on a loop with rows that were left out (System::leave_out), or on
/// any loop where nearly dependent rows hold (System::hold_down_to). `modes`: links in force before it.
LOCKSTEP_API void refuse_switch_of_decided(const System&, const std::vector<bool>& modes, const Event&);

}  // namespace lockstep
