// SPDX-License-Identifier: BSD-3-Clause
// What is left to do of a sweep that was interrupted.
#pragma once

#include <functional>
#include <string>

#include "framework/tools/program/commands.h"
#include "framework/tools/program/growing_file.h"

namespace lockstep {

/// NAME.sweep next to the rows of a sweep: the command and the files that they come from, as long as runs are missing.
class SweepMark {
 public:
  SweepMark(const Arguments&, const Loaded&, const GrowingFile& rows);
  /// The sweep begins, or continues. Throws FileError.
  void write() const;
  /// Throws FileError if there is no sweep, or one of another command or of other files.
  void check() const;
  void remove() const;  ///< All runs are made.

 private:
  std::string file_;  // "": the rows cannot be read again
  std::string command_;
  std::uint64_t scene_ = 0, plugins_ = 0;
};

/// Rows that are there already; of them those of runs that failed and that were wrong (SweepRun::outcome).
struct KeptRows {
  long n = 0, failed = 0, wrong = 0;
};

/// Keeps the first rows of a file that grew: the header, and as many rows as begin with row_begin(0), row_begin(1), ...
/// The rest is cut off. Throws FileError if the header is another.
KeptRows keep_rows(GrowingFile& rows, const std::string& header, const std::function<std::string(long)>& row_begin);

}  // namespace lockstep
