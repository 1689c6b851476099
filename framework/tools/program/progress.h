// SPDX-License-Identifier: BSD-3-Clause
// The progress of a run: a bar on a terminal, plain lines otherwise; and Ctrl-C.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace lockstep {

/// While it exists, Ctrl-C (or SIGTERM, or the end of the terminal) is recorded instead of ending the program; a second
/// one ends it.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  bool asked() const;
};

/// The unit of progress.
enum class Counts { seconds, runs, budget };

/// Prints to standard error: on a terminal up to ten times a second, cut to its width; otherwise a line every ten
/// seconds. For one thread at a time.
class Progress {
 public:
  Progress(double until, bool quiet, Counts counts = Counts::seconds);
  /// The run has reached time t, s; or t runs are done.
  void at(double t);
  /// Clears the bar.
  void finish();
  double seconds() const;  ///< since its construction, wall-clock

 private:
  using Clock = std::chrono::steady_clock;
  double until_;
  Counts counts_;
  bool quiet_, terminal_, drawn_ = false;
  Clock::time_point begin_, last_;
};

/// "[#####.....]  50 %  t = 1.2 s of 2.4 s  0.8 s/s  3 s to go", "...  12 of 24 runs  4 runs/s  3 s to go", or
/// "...  30 s of 60 s" of a budget. `width`: columns; the bar is as long as they leave room, and left out with 0.
std::string progress_line(double t, double until, double seconds, std::size_t width, Counts counts = Counts::seconds);

}  // namespace lockstep
