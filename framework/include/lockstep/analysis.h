// SPDX-License-Identifier: BSD-3-Clause
// Mobility, reactions that are unique, and grids of runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/system.h>

namespace lockstep {

class Dynamics;

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
  int nearly = 0;                 ///< how many more nearly are: their pivots lie between 1e-9 and 1e-3
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

/// Rows on common loops that nearly depend on one another, and what was decided.
struct NearDependency {
  std::vector<std::string> rows;  ///< their names: "A.z"
  int nearly = 0;                 ///< how many of them are too many but for a small singular value
  double singular_value = 0;      ///< the largest of these, of rows of length 1
  /// Whether that is so in this position only, beside a singular one: nothing is decided then, and the rows hold.
  bool in_passing = false;
  bool decided = false;  ///< whether what was asked for, free or held, was done
  /// Why neither can be: "a law is among them"; "" if they can. Solvers may differ there then.
  std::string undecided;
  double violation = 0;  ///< of rows that would be left out, m, where what they held has moved on by 0.3 rad
  /// Rows that hold no more: free, all on these loops that depend on others, exactly or nearly; held, all of the mechanism
  /// that depend on others exactly, told once.
  std::vector<std::string> left_out;
  /// Links on these loops: what was decided is right as long as none of them is released, and no other takes its place.
  std::vector<std::string> links;
};

/// Finds rows that nearly depend on others at a start on the constraints, those of pivots, as in mobility(), between 1e-9
/// and 1e-3, and decides what they hold where that is asked for: told, the default here, leaves all as it is; automatic, that of scenes, holds them. Rows that a law
/// acts on, of one-sided links and of links that are no joints are never left out; sets with such rows are not decided. Of
/// others those of a large share stay before small ones, the earlier link before the later. Whether they nearly depend everywhere is tried: without them the mechanism moves by
/// 0.3 rad along what they held, and must violate them by less than a thousandth of System::length(). Leaves out rows of
/// `system` (System::leave_out), which must be that of the dynamics, in place of what was left out before; a start is to
/// be assembled anew where any were, from the positions of this one. Sets of more than 300 rows on common loops are not looked at. Throws what an evaluation
/// throws.
LOCKSTEP_API std::vector<NearDependency> decide_nearly_redundant(System& system, Dynamics&, const State&,
                                                                 NearlyRedundant = NearlyRedundant::told);

// Uniqueness: which reactions of a mechanism with redundant rows are unique.

/// Reactions that are not unique in one pose. Where rows are redundant, many sets of multipliers give the same motion:
/// those that differ by a vector n with Jh^T n = 0. A reaction is unique if no such vector changes it. What is not unique
/// is shared out by the solver, alike in every run; a real mechanism shares it out by its elasticity and its tolerances.
struct UniquenessReport {
  int undetermined = 0;               ///< how many independent vectors n there are: the redundant rows
  std::vector<std::string> rows;      ///< rows whose multipliers are not unique: "A.z", in the order of the rows
  std::vector<std::string> channels;  ///< channels that are not: "A.force_on_p_world_z", "A.lambda_z"; links in order

  bool all_unique() const { return undetermined == 0; }  ///< whether every reaction is unique
  /// Whether the channel of this name is unique; true of channels that are no reactions.
  LOCKSTEP_API bool unique(const std::string& channel) const;
};

/// Finds them, in the scaling and with the limits of mobility(), for forces, torques and multipliers of links and their
/// drives. Where rows were left out (System::leave_out) they count: what they and those that stay would share is not
/// unique, exactly or but for a singular value below 1e-3. It allocates: for descriptions, not for runs. Throws NonFiniteError.
LOCKSTEP_API UniquenessReport uniqueness(Dynamics&, const State&);

}  // namespace lockstep
