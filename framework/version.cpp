// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/version.h>

namespace lockstep {

const char* library_version() { return kVersion; }

}  // namespace lockstep
