// SPDX-License-Identifier: BSD-3-Clause
// The rows of a table in a checkpoint.
#pragma once

#include <lockstep/recorder.h>

namespace lockstep {

/// Writes names and rows.
LOCKSTEP_API void save_rows(const Table&, Snapshot&);
/// Reads what save_rows() wrote, in place of the table's rows. Throws ModelError where the columns are others.
LOCKSTEP_API void load_rows(Table&, SnapshotReader&);

}  // namespace lockstep
