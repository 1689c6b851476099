// SPDX-License-Identifier: BSD-3-Clause
// The pictures of a run.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "framework/description/scene/reading.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/detail_rows.h"
#include "framework/tools/record/row_envelope.h"

namespace lockstep {

/// What a run writes in addition to its numbers, by the scene and the command line. `columns`: those that are recorded.
/// Throws UsageError, also if a file would replace one that the scene is read from.
RunOutputs checked_outputs(const Loaded&, const Arguments&, const Table& columns, const std::string& csv);

/// Names of the columns of each panel of a picture.
using Panels = std::vector<std::vector<std::string>>;
/// The columns that draw_run() takes of a table with these.
std::set<std::string> drawn_columns(const Table& columns, const Panels& draw, const std::vector<PictureRequest>&);

/// The rows that pictures need in addition to the table's; null if none is drawn. A run with checkpoints may continue
/// where there is a gnuplot, even if there is none here.
std::unique_ptr<PictureRows> picture_rows(Mechanism&, const std::string& csv, const Recorder& rows, const RunOutputs&,
                                          const Arguments&);

/// Draws columns over the first, the time, as SVG and PNG next to the CSV: the panels of run.draw, or the first columns,
/// one panel per unit; and pictures of one column against another, of rows of one time each. Nothing with --no-picture,
/// or if the CSV is "-". Adds its files, and notes on them. False if drawing was possible and failed, which is no error
/// of the run.
bool draw_run(const Arguments&, const std::string& csv, const std::string& title, const RowEnvelope&,
              const PictureRows* details, const RunSettings&, const RunOutputs&, std::vector<std::string>& files,
              std::vector<std::string>& notes);
/// The same with lines of its notes; with --quiet only why drawing failed.
void draw_told(const Arguments&, const std::string& csv, const std::string& title, const RowEnvelope&,
               const PictureRows* details, const RunSettings&, const RunOutputs&, std::vector<std::string>& files);

}  // namespace lockstep
