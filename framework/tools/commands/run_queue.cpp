// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/run_queue.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

namespace lockstep {

std::optional<long> RunQueue::next() {
  const std::lock_guard lock(mutex_);
  if (stopped_ || next_ == n_runs_) return {};
  return next_++;
}

void RunQueue::finish(FinishedRun run) {
  const std::lock_guard lock(mutex_);
  if (!run.run.broken_off) waiting_.emplace(run.k, std::move(run));
  changed_.notify_all();
}

void RunQueue::stop(const std::exception_ptr& error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = error;
  stopped_ = true;
  changed_.notify_all();
}

std::optional<FinishedRun> RunQueue::take(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  const auto ready = [&] { return !waiting_.empty() && waiting_.begin()->first == taken_; };
  changed_.wait_for(lock, time, [&] { return ready() || stopped_; });
  if (!ready()) return {};
  ++taken_;
  return std::move(waiting_.extract(waiting_.begin()).mapped());
}

std::optional<FinishedRun> RunQueue::take_rest() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return {};
  return std::move(waiting_.extract(waiting_.begin()).mapped());
}

bool RunQueue::all_taken() const {
  const std::lock_guard lock(mutex_);
  return taken_ == n_runs_;
}

long RunQueue::n_finished() const {
  const std::lock_guard lock(mutex_);
  return taken_ + static_cast<long>(waiting_.size());
}

void RunQueue::rethrow() const {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
}

int available_processors() {
  int n = static_cast<int>(std::thread::hardware_concurrency());
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) n = CPU_COUNT(&set);
  // Control groups, version 2: time per period, both in microseconds; "max": no limit.
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  double quota = 0, period = 0;
  if (file >> quota >> period && quota > 0 && period > 0) n = std::min(n, static_cast<int>(std::ceil(quota / period)));
  return std::max(n, 1);
}

}  // namespace lockstep
