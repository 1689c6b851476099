// SPDX-License-Identifier: BSD-3-Clause
// The checkpoint of a run of a scene: what `lockstep run --checkpoint` writes and `lockstep resume` reads.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <lockstep/step_loop.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/growing_file.h"

namespace lockstep {

/// A run with its command line and inputs.
struct RunCheckpoint {
  std::vector<std::string> words;        ///< of its command line
  std::string folder, csv;               ///< in which it was begun; its table
  std::uint64_t scene = 0, plugins = 0;  ///< hashes of their files
  double seconds = 0;                    ///< wall-clock time so far
  Snapshot run;                          ///< what the loop saved

  /// Throws FileError, and UsageError for the checkpoint of a simulation in C++.
  static RunCheckpoint read(const std::string& file);
  void write(const std::string& file) const;
  /// Throws FileError if the scene or a plugin has changed.
  void check(const std::string& file, const Arguments&, const Loaded&) const;
};

/// Writes the checkpoint of a run at intervals. Without --checkpoint it does nothing.
class Checkpoints {
 public:
  /// Throws UsageError: the file is a result or an input, the scene or the rows cannot be found again.
  Checkpoints(const Arguments&, const Loaded&, GrowingFile& rows);
  explicit operator bool() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  /// Before the run: throws UsageError for a method that does not save all of its history.
  void refuse_unsaved(const Integrator&) const;
  /// Between two steps: writes it if it is due, or `now`. `seconds`: wall-clock time so far. Throws FileError,
  /// ModelError.
  void write_if_due(StepLoop&, bool now, double seconds);
  void remove();  ///< The run is done.

 private:
  using Clock = std::chrono::steady_clock;
  std::string file_;
  double every_ = 60;  // s
  Clock::time_point last_ = Clock::now();
  RunCheckpoint checkpoint_;
  GrowingFile& rows_;
};

}  // namespace lockstep
