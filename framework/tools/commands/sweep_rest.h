// SPDX-License-Identifier: BSD-3-Clause
// What is left to do of a sweep that was interrupted.
#pragma once

#include <functional>
#include <string>

#include "framework/tools/program/commands.h"
#include "framework/tools/program/growing_file.h"

namespace lockstep {

/// A sweep beside its rows: NAME.sweep tells from which command and which files they come, as long as runs are missing.
class SweepMark {
 public:
  SweepMark(const Arguments&, const Loaded&, const GrowingFile& rows);
  /// The sweep begins, or goes on. Throws FileError.
  void write() const;
  /// Throws FileError where no sweep was begun, or by another command, or with other files.
  void check() const;
  void remove() const;  ///< All runs are made.

 private:
  std::string file_;  // "": the rows go where they cannot be found again
  std::string command_;
  std::uint64_t scene_ = 0, plugins_ = 0;
};

/// Rows that are there already; of them those of runs that failed and that were wrong (SweepRun::outcome).
struct KeptRows {
  long n = 0, failed = 0, wrong = 0;
};

/// Keeps the first rows of a file that grew: the header, and as many rows as begin with row_begin(0), row_begin(1), ...
/// The rest is cut off. Throws FileError where the header is another.
KeptRows keep_rows(GrowingFile& rows, const std::string& header, const std::function<std::string(long)>& row_begin);

}  // namespace lockstep
