// Mobility, and grids of runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/export.h>

namespace lockstep {

// Grid: all combinations of several lists of values, numbered, and shared among programs that run side by side.

/// A share of a grid: every count-th run, beginning with run `index`.
struct Shard {
  long index = 1,  ///< number of the share, from 1
      count = 1;   ///< number of all shares
};

/// Reads a share: "2/8". Throws ModelError for anything else, and for an index beyond the count.
LOCKSTEP_API Shard read_shard(const std::string& text);

/// All combinations of several lists of values, one per run, in order. It knows the lengths of the lists only.
class LOCKSTEP_API Grid {
 public:
  static constexpr long kMostRuns = 1'000'000'000;  ///< runs at most

  /// `sizes`: the length of each list; no list makes one run. Throws ModelError for an empty list and for more than
  /// kMostRuns combinations.
  explicit Grid(std::vector<std::size_t> sizes);

  long n_runs() const { return n_runs_; }  ///< number of all runs
  /// Position in each list, from 0, of the value that a run takes. Runs are numbered from 1; the last list changes
  /// fastest.
  std::vector<std::size_t> at(long run) const;
  /// Number of runs of a share; all shares together have each run once.
  long n_runs(Shard) const;
  /// Number of the k-th run of a share, k from 0.
  static long run(Shard shard, long k) { return shard.index + k * shard.count; }

 private:
  std::vector<std::size_t> sizes_;
  long n_runs_ = 1;
};


// Mobility: rank, freedoms and redundant rows of a mechanism in one pose, by name.

/// Rows that depend on one another in a pose, and on no others.
struct Dependency {
  std::vector<std::string> rows;  ///< their names: "A.z"
  int too_many = 0;               ///< how many of them are redundant
  int nearly = 0;                 ///< how many more nearly are: their pivots lie between 1e-9 and 1e-5
  double pivot = 0;               ///< the largest of these, of rows of length 1
};

/// Degrees of freedom of a mechanism in one pose, and the redundancy of its rows.
struct MobilityReport {
  int bodies = 0;                            ///< moving bodies; merged ones count as one
  int unknowns = 0;                          ///< velocities: 6 per body, 3 per particle; in a plane 3 and 2
  int rows = 0;                              ///< of the links in force, drives included
  int rank = 0;                              ///< of the rows, in this pose
  int freedoms = 0;                          ///< unknowns - rank
  int redundant = 0;                         ///< rows - rank
  std::vector<Dependency> dependencies;      ///< which rows depend on which; the same in every order of the links
  std::vector<std::string> redundant_links;  ///< names of links whose rows take part in a linear dependency
};

/// Counts degrees of freedom: the rank of the rows, loop by loop, with rotations as lengths (System::length) and every
/// row of length 1; pivots below 1e-9 are zero. Where more than 300 rows lie on common loops, singular values below 1e-6
/// are, and their dependent rows are told as one set. It allocates: for descriptions, not for runs. Throws NonFiniteError.
LOCKSTEP_API MobilityReport mobility(Dynamics&, const State&);

}  // namespace lockstep
