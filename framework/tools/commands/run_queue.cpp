// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/run_queue.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

namespace lockstep {

std::optional<RunGroup> RunQueue::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || !alone_.empty() || next_ < n_runs_ || groups_out_ == 0; });
  if (stopped_) return {};
  if (!alone_.empty()) {
    const long k = alone_.front();
    alone_.pop_front();
    return RunGroup{k, 1};
  }
  if (next_ == n_runs_) return {};
  const long left = std::min(lanes_, n_runs_ - next_);
  const RunGroup group{next_, left < fewest_ ? 1 : left};
  next_ += group.n;
  if (group.n > 1) ++groups_out_;
  return group;
}

void RunQueue::split(RunGroup group, const std::string& why) {
  const std::lock_guard lock(mutex_);
  why_split_.emplace(group.first, why);
  for (long k = group.first; k < group.first + group.n; ++k) alone_.push_back(k);
  --groups_out_;
  changed_.notify_all();
}

void RunQueue::finish(std::vector<FinishedRun> group) {
  const std::lock_guard lock(mutex_);
  if (group.size() > 1) --groups_out_;
  for (FinishedRun& run : group)
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
  const auto ready = [&] { return !waiting_.empty() && (stopped_ || waiting_.begin()->first == taken_); };
  changed_.wait_for(lock, time, [&] { return ready() || stopped_; });
  if (!ready()) return {};
  ++taken_;
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

std::string RunQueue::why_split() const {
  const std::lock_guard lock(mutex_);
  return why_split_.empty() ? "" : why_split_.begin()->second;
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
