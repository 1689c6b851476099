// SPDX-License-Identifier: BSD-3-Clause
// Where a sample puts its files: the folder LOCKSTEP_OUTPUT, or the build tree's own.
#pragma once

#include <string>

namespace lockstep::samples {

/// Path of a file in the output folder, which is made when it is not there.
std::string output(const std::string& file);

}  // namespace lockstep::samples
