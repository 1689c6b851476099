// SPDX-License-Identifier: BSD-3-Clause
// The mechanisms as scenes of lockstep. Those of few bodies are kept as tests/benchmark/scenes/bench_*.json; the long
// ones are written when they are needed.
#pragma once

#include <string>

#include "tests/benchmark/peers/mechanisms.h"

namespace lockstep::peers {

/// "bench_chain_10" for "chain-10".
std::string scene_name(const Mechanism&);
/// Whether scene_text() makes it; the others are only kept as files.
bool is_generated(const Mechanism&);
/// JSON, bodies in the order of mechanisms.h.
std::string scene_text(const Mechanism&);

}  // namespace lockstep::peers
