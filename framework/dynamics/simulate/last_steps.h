// SPDX-License-Identifier: BSD-3-Clause
// LastSteps: the ends of the last steps of a run, by which its length is judged and its end explained. Internal to the step
// loop.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <lockstep/detail/export.h>

namespace lockstep {

/// What a run is and how far it has come.
struct RunSoFar {
  const std::string& method;  ///< name, for messages
  bool adaptive;              ///< it chooses its steps
  double t, end;              ///< s; an infinite end: none is known
  long steps, max_steps;      ///< made, and allowed; 0: no limit
};

class LOCKSTEP_API LastSteps {
 public:
  static constexpr long kKept = 1000;  ///< steps

  /// Forgets all steps: those that follow begin at t, s, and go to another end.
  void begin(double t) { t_begin_ = t, n_ = 0; }
  /// A step ended at t, s.
  void add(double t) { ends_[place(n_++)] = {t, 0}; }
  /// At the end of the last step one-sided joints made or lost contact: a bit for each of the first 64.
  void touch(std::uint64_t links) {
    if (n_ > 0) ends_[place(n_ - 1)].touched |= links;
  }

  long n() const { return n_ < kKept ? n_ : kKept; }  ///< how many are kept
  double mean() const;                                ///< of the lengths of those, s; 0 if there are none
  long touched(std::uint64_t bit) const;  ///< at the ends of how many of those the link of that bit was touched

  /// Throws StepError if the run has made max_steps, or if by the mean of the last kKept steps its rest would take more than
  /// kMostSteps.
  void check(const RunSoFar&) const;

 private:
  struct End {
    double t;
    std::uint64_t touched;
  };
  static std::size_t place(long n) { return n % kKept; }

  double t_begin_ = 0;
  long n_ = 0;  // since begin()
  std::array<End, kKept> ends_{};
};

}  // namespace lockstep
