// The certificate of a run: the run is repeated by other means, and the columns are compared.
#pragma once

#include <lockstep/recorder.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// Repeats the run with a tighter tolerance (or shorter steps) and with a second method, and prints how many digits of
/// each column agree. `run`: its settings; `table`: what it recorded. Reports repeats that fail or exceed --budget.
void print_certificate(const Loaded&, const Arguments&, const RunSettings& run, const Table& table);

}  // namespace lockstep
