// Values to JSON text.
#pragma once

#include <string>

#include <lockstep/params.h>
#include <lockstep/export.h>

namespace lockstep {

/// Pretty JSON, ends with a newline; short lists of plain values on one line. Numbers in the shortest form that reads
/// back as the same double, locale never asked. Throws SceneError for NaN or infinity, which JSON cannot hold.
LOCKSTEP_API std::string write_json(const Value&);

}  // namespace lockstep
