// Grid: all combinations of several lists of values, numbered, and shared out among programs that run side by side.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// The `index`-th of `count` shares of a grid; both count from 1. It takes every count-th run.
struct Shard {
  long index = 1, count = 1;
};

/// "2/8". Throws ModelError for anything else, and for an index beyond the count.
LOCKSTEP_API Shard read_shard(const std::string& text);

class LOCKSTEP_API Grid {
 public:
  static constexpr long kMostRuns = 1'000'000'000;

  /// How many values each list has; no list at all is one run. Throws ModelError: an empty list, too many combinations.
  explicit Grid(std::vector<std::size_t> sizes);

  long n_runs() const { return n_runs_; }
  /// Which value of each list the run takes; runs are numbered from 1, the last list changes fastest.
  std::vector<std::size_t> at(long run) const;
  /// How many runs the shard has; all shards together have each run once.
  long n_runs(Shard) const;
  /// The number of the k-th run of a shard, from 0 on.
  static long run(Shard shard, long k) { return shard.index + k * shard.count; }

 private:
  std::vector<std::size_t> sizes_;
  long n_runs_ = 1;
};

}  // namespace lockstep
