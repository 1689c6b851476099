// SPDX-License-Identifier: BSD-3-Clause
// JSON files to Values.
#pragma once

#include <string>

#include <lockstep/detail/export.h>
#include "framework/description/scene/json.h"

namespace lockstep {

/// The Value of the file; see read_json. Throws FileError when the file cannot be read, SceneError for its
/// content.
LOCKSTEP_API Value read_json_file(const std::string& path);

}  // namespace lockstep
