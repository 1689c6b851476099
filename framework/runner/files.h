// Where the results of a run go, and its picture.
#pragma once

#include <string>
#include <vector>

#include "framework/record/table.h"

namespace lockstep {

/// The CSV file: `record` when given, else <scene>.csv in LOCKSTEP_OUTPUT or the current folder; its folder is made.
/// Throws FileError.
std::string csv_path(const std::string& record, const std::string& scene);

/// Throws FileError when the file cannot be written: asked before the run, so that no result is lost after it.
void check_writable(const std::string& file);

/// Draws columns over time as SVG and PNG beside the CSV: the panels of `draw`, or the first columns, one panel a unit.
/// Returns the files, none when there is nothing to draw or no gnuplot.
std::vector<std::string> draw_columns(const std::string& csv, const std::string& title, const Table&,
                                      const std::vector<std::vector<std::string>>& draw = {});

}  // namespace lockstep
