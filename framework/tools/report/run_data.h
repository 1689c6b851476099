// SPDX-License-Identifier: BSD-3-Clause
// The data of the page of a run, except for its texts.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>

#include <lockstep/recorder.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// {"rows":, "stride":, "columns": [{"name":, "unit":, "values":}]}. Of a table of more than `most_bytes`, "values" have
/// every "stride"-th row, and "curve" the extremes of groups of rows (RowEnvelope). With `ranges`, "range" has the extremes.
nlohmann::ordered_json table_json(const Table&, std::span<const ColumnRange> ranges, std::size_t most_bytes, Numbers&);
/// {"frames": {"n":, "stride":, "width":, "times":, "rows":, "jumps":}, "marks":, "switches":}; of the times every
/// "stride"th is kept.
nlohmann::ordered_json frames_json(const Frames&, Numbers&);

/// "1 row in 3, 1 frame in 4": what is kept, if not all of it.
std::string kept_part(std::initializer_list<std::pair<const char*, std::size_t>> one_in);

}  // namespace lockstep::report
