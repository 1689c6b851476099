// SPDX-License-Identifier: BSD-3-Clause
// Threads that share work, and RunQueue: the runs of a sweep, handed out to them and taken back in order.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include <lockstep/sweep.h>

namespace lockstep {

struct FinishedRun {
  long k = 0;  ///< its number
  SweepRun run;
  bool kept = false;  ///< its history was written
};

/// Every function may be called by any thread.
class RunQueue {
 public:
  /// Runs 0 .. n_runs - 1; those before `begin` were made before.
  explicit RunQueue(long n_runs, long begin = 0) : n_runs_(n_runs), next_(begin), taken_(begin) {}

  // For threads that compute.

  /// The next run to compute; none: nothing is left, or stopped.
  std::optional<long> next();
  void finish(FinishedRun);
  /// For an `error`, rethrow() throws it.
  void stop(const std::exception_ptr& error = nullptr);
  bool stopped() const { return stopped_; }

  // For the thread that takes results.

  /// The run after the one that was taken last, waited for no longer than `time`; none: not yet, or stopped.
  std::optional<FinishedRun> take(std::chrono::milliseconds time);
  /// The next that is finished, also behind runs that are not. Once no thread computes any more.
  std::optional<FinishedRun> take_rest();
  bool all_taken() const;
  long n_finished() const;
  void rethrow() const;

 private:
  const long n_runs_;
  long next_, taken_;
  std::map<long, FinishedRun> waiting_;
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
