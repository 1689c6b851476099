// SPDX-License-Identifier: BSD-3-Clause
// Values to JSON text.
#pragma once

#include <string>

#include <lockstep/author/params.h>

namespace lockstep {

/// Pretty JSON, ending with a newline; short lists of plain values are on one line. Numbers have the shortest form that
/// reads back as the same double, whatever the locale. Throws SceneError for NaN or infinity, which JSON cannot hold.
LOCKSTEP_API std::string write_json(const Value&);

/// The same in one line, without a newline at its end.
LOCKSTEP_API std::string write_json_line(const Value&);

}  // namespace lockstep
