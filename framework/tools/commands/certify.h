// SPDX-License-Identifier: BSD-3-Clause
// The certificate of a run: the run is repeated by other means, and the columns are compared.
#pragma once

#include "framework/tools/program/certified.h"

namespace lockstep {

/// Repeats the run with a tighter tolerance (or shorter steps) and with a second method; says in lines how many digits of
/// each column agree. `run`: its settings; `table`: what it recorded. Repeats that fail or exceed --budget are named.
CertifiedRun certificate_of(const Loaded&, const Arguments&, const RunSettings& run, const Table& table);

}  // namespace lockstep
