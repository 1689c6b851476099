// The certificate of a run: it is made again by other means, and the columns are compared.
#pragma once

#include <lockstep/recorder.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// Repeats the run with a tighter tolerance (or shorter steps) and with a second method, prints how many digits of each
/// column agree. `run`: as it was made; `table`: what it recorded. Repeats that fail or outlast --budget are said.
void print_certificate(const Loaded&, const Words&, const RunSettings& run, const Table& table);

}  // namespace lockstep
