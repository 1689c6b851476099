// SPDX-License-Identifier: BSD-3-Clause
// Threads that share work, and RunQueue: the runs of a sweep, handed out to them and taken back in order.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <lockstep/sweep.h>

namespace lockstep {

/// Runs first .. first + n - 1, numbered from 0.
struct RunGroup {
  long first = 0, n = 1;
};

struct FinishedRun {
  long k = 0;  ///< its number
  SweepRun run;
  bool in_lanes = false;  ///< computed in a vectorised batch
  bool kept = false;      ///< its history was written
};

/// Every function may be called by any thread.
class RunQueue {
 public:
  /// Runs 0 .. n_runs - 1 in groups of `lanes`; a last group smaller than `fewest` is handed out one by one.
  /// The runs before `begin` were made before.
  RunQueue(long n_runs, long lanes, long fewest, long begin = 0)
      : n_runs_(n_runs), lanes_(lanes), fewest_(fewest), next_(begin), taken_(begin) {}

  // For threads that compute: each takes a group, and finishes all its runs or splits it.

  /// The next runs to compute. Waits while a group in work may still be split; none: nothing is left, or stopped.
  std::optional<RunGroup> next();
  /// Hands the runs of a group out again, one by one, for the reason `why`.
  void split(RunGroup, const std::string& why);
  void finish(std::vector<FinishedRun> group);
  /// For an `error`, rethrow() throws it.
  void stop(const std::exception_ptr& error = nullptr);
  bool stopped() const { return stopped_; }

  // For the thread that takes results.

  /// The run after the one that was taken last, waited for no longer than `time`; once stopped, the next that is finished.
  std::optional<FinishedRun> take(std::chrono::milliseconds time);
  bool all_taken() const;
  long n_finished() const;
  void rethrow() const;
  /// Why the first of the split groups was split; "" if none was.
  std::string why_split() const;

 private:
  const long n_runs_, lanes_, fewest_;
  long next_, taken_, groups_out_ = 0;
  std::deque<long> alone_;  // handed back, to go out one by one
  std::map<long, FinishedRun> waiting_;
  std::map<long, std::string> why_split_;  // by the first run
  std::atomic<bool> stopped_ = false;  // set under the mutex, read by every step
  std::exception_ptr error_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
};

/// Starts threads that call work(k), k = 0 to n - 1; fewer where the system has no more of them. Throws std::bad_alloc
/// where it has none.
template <class Work>
void start_threads(std::vector<std::jthread>& threads, std::size_t n, const Work& work) {
  try {
    for (std::size_t k = 0; k < n; ++k) threads.emplace_back([work, k] { work(k); });
  } catch (const std::system_error&) {
    if (threads.empty()) throw std::bad_alloc();
  }
}

/// The processors that this process may use: its affinity, and inside a container the share that it was given. At least
/// one.
int available_processors();

}  // namespace lockstep
