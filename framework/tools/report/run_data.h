// SPDX-License-Identifier: BSD-3-Clause
// The data of the page of a run, except for its texts.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <lockstep/recorder.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// {"rows":, "stride":, "columns": [...]}: of a table of more than `most_cells` numbers every k-th row, but at least
/// `fewest` of them.
nlohmann::ordered_json table_json(const Table&, std::size_t most_cells, std::size_t fewest, Numbers&);
/// {"frames": {"n":, "stride":, "width":, "times":, "rows":, "jumps":}, "marks":, "switches":}; of the times every
/// "stride"th is kept.
nlohmann::ordered_json frames_json(const Frames&, Numbers&);

}  // namespace lockstep::report
