// Progress of a run: a bar on a terminal, plain lines otherwise; and whether somebody pressed Ctrl-C.
#pragma once

#include <chrono>
#include <string>

namespace lockstep {

/// From its making on, Ctrl-C (or SIGTERM) no longer ends the program but is noted; a second one does end it.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  bool asked() const;
};

/// What a Progress counts.
enum class Counts { seconds, runs };

/// Written to standard error, at most ten times a second on a terminal and cut to its width, else a line every ten
/// seconds.
class Progress {
 public:
  Progress(double until, bool quiet, Counts counts = Counts::seconds);
  /// The run has come to time t, s; or t of all runs are done.
  void at(double t);
  /// Clears the bar.
  void finish();
  double seconds() const;  ///< since its making, by the clock

 private:
  using Clock = std::chrono::steady_clock;
  double until_;
  Counts counts_;
  bool quiet_, terminal_, drawn_ = false;
  Clock::time_point begin_, last_;
};

/// "[#####.....]  50 %  t = 1.2 s of 2.4 s  0.8 s/s  3 s to go", or "...  12 of 24 runs  4 runs/s  3 s to go"
std::string progress_line(double t, double until, double seconds, bool bar, Counts counts = Counts::seconds);

}  // namespace lockstep
