// SPDX-License-Identifier: BSD-3-Clause
// A file that the library is to read.
#pragma once

#include <string>

#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

/// Writes the bytes into a file of this process, which keeps its name, and returns its path. `ending`: ".csv".
std::string scratch_file(Bytes, const std::string& ending);

}  // namespace lockstep::fuzz
