// Where the results of a run go, and its picture.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// The CSV file: `record` when given, else <scene>.csv in LOCKSTEP_OUTPUT or the current folder; its folder is made.
/// Throws FileError.
std::string csv_path(const std::string& record, const std::string& scene);

/// Throws FileError when the file cannot be written: asked before the run, so that no result is lost after it.
void check_writable(const std::string& file);

/// What became of a picture.
struct Drawing {
  std::vector<std::string> files{};  ///< none: see `reason`
  std::string reason{};              ///< why there is no picture, in words
  bool failed = false;               ///< it should be there and is not
  std::size_t n_drawn = 0;           ///< columns that it shows
};

/// Draws columns over time as SVG and PNG beside the CSV: the panels of `draw`, or the first columns, one panel a unit.
/// Never throws for a picture: what was computed does not depend on it.
Drawing draw_columns(const std::string& csv, const std::string& title, const Table&,
                     const std::vector<std::vector<std::string>>& draw = {});

}  // namespace lockstep
