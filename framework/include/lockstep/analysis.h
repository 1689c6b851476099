// Mobility, and grids of runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/export.h>

namespace lockstep {

// Grid: all combinations of several lists of values, numbered, and shared out among programs that run side by side.


/// The `index`-th of `count` shares of a grid; both count from 1. It takes every count-th run.
struct Shard {
  long index = 1, count = 1;
};

/// "2/8". Throws ModelError for anything else, and for an index beyond the count.
LOCKSTEP_API Shard read_shard(const std::string& text);

/// Values of several parameters, and their combinations in order.
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


// Mobility: rank, freedoms and redundant rows of a mechanism in one pose, by name.


/// Freedoms of a mechanism, and how many of its rows are redundant.
struct MobilityReport {
  int bodies = 0;                            ///< that move
  int unknowns = 0;                          ///< velocities: 6 a body, 3 a particle
  int rows = 0;                              ///< of the active links, drives included
  int rank = 0;                              ///< of the rows, in this pose
  int freedoms = 0;                          ///< unknowns - rank
  int redundant = 0;                         ///< rows - rank
  std::vector<std::string> redundant_links;  ///< links that share in a dependency of the rows
};

/// Rank by a pivoted QR of the rows, turns counted as lengths, every row made one long; threshold 1e-9. For
/// descriptions, not for runs.
LOCKSTEP_API MobilityReport mobility(Dynamics&, const State&);

}  // namespace lockstep
