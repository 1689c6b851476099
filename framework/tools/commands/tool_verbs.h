// SPDX-License-Identifier: BSD-3-Clause
// The verbs of the programs beside `lockstep`: one function each over the public interface.
#pragma once

#include "framework/tools/program/options.h"

namespace lockstep {

int mobility_command(const Arguments&);
int assemble_command(const Arguments&);
int statics_command(const Arguments&);
int kinematics_command(const Arguments&);
int inverse_command(const Arguments&);
int explain_command(const Arguments&);
int modes_command(const Arguments&);
int linearize_command(const Arguments&);
int matrices_command(const Arguments&);
int chart_command(const Arguments&);
int advise_command(const Arguments&);
int atlas_command(const Arguments&);
int sweep_command(const Arguments&);
int import_command(const Arguments&);
int branches_command(const Arguments&);       ///< assemble --branches
int certified_run_command(const Arguments&);  ///< run --certify

}  // namespace lockstep
