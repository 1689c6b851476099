// SPDX-License-Identifier: BSD-3-Clause
// The commands of the programs that `lockstep` calls.
#pragma once

#include "framework/tools/program/options.h"

namespace lockstep {

Command assemble_command();
Command statics_command();
Command kinematics_command();
Command inverse_command();
Command explain_command();
Command modes_command();
Command linearize_command();
Command matrices_command();
Command chart_command();
Command advise_command();
Command atlas_command();
Command certify_command();  ///< `run` with --certify
Command sweep_command();
Command find_command();
Command optimize_command();
Command sensitivity_command();
Command import_command();

inline constexpr Option kAt{"--at", "TIME", "time, s, to which the scene is run; default 0, its assembled start"};

}  // namespace lockstep
