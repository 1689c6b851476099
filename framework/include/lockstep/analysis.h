// SPDX-License-Identifier: BSD-3-Clause
// Mobility, reactions that are unique, and grids of runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/system.h>

namespace lockstep {

class Dynamics;

// Grid: all combinations of several lists of values, numbered, and distributed over programs that run in parallel.

/// A share of a grid: every count-th run, beginning with run `index`.
struct Shard {
  long index = 1,  ///< number of the share, from 1
      count = 1;   ///< number of all shares
};

/// Reads a share: "2/8". Throws ModelError for anything else, and for an index beyond the count.
LOCKSTEP_API Shard read_shard(const std::string& text);

/// All combinations of several lists of values, one per run, in order. It stores the lengths of the lists only.
class LOCKSTEP_API Grid {
 public:
  static constexpr long kMostRuns = 1'000'000'000;  ///< runs at most

  /// `sizes`: the length of each list; no list makes one run. Throws ModelError for an empty list and for more than
  /// kMostRuns combinations.
  explicit Grid(std::vector<std::size_t> sizes);

  long n_runs() const { return n_runs_; }  ///< number of all runs
  /// Position in each list, from 0, of the value of a run. Runs are numbered from 1; the last list changes fastest.
  std::vector<std::size_t> at(long run) const;
  /// Number of runs of a share; all shares together have each run once.
  long n_runs(Shard) const;
  /// Number of the k-th run of a share, k from 0.
  static long run(Shard shard, long k) { return shard.index + k * shard.count; }

 private:
  std::vector<std::size_t> sizes_;
  long n_runs_ = 1;
};

// Mobility: rank, degrees of freedom and redundant constraints of a mechanism in one pose, by name.

/// Constraints that depend on one another in a pose, and on no others.
struct Dependency {
  std::vector<std::string> rows;  ///< names of the constraints: "A.z"
  int too_many = 0;               ///< number of redundant ones
  int nearly = 0;                 ///< number of nearly redundant ones: their pivots are between 1e-11 and 1e-3
  double pivot = 0;               ///< the largest of these pivots, for constraints of unit norm
};

/// Degrees of freedom of a mechanism in one pose, and the redundancy of its constraints.
struct MobilityReport {
  int bodies = 0;                            ///< moving bodies; merged ones count as one
  int unknowns = 0;                          ///< velocities: 6 per body, 3 per particle; in a plane 3 and 2
  int rows = 0;                              ///< constraints of the active joints, with drives and those left out
  int rank = 0;                              ///< of the constraints that are not left out, in this pose
  int freedoms = 0;                          ///< degrees of freedom: unknowns - rank
  int redundant = 0;                         ///< redundant constraints: rows - rank
  std::vector<Dependency> dependencies;      ///< groups of dependent constraints; the order of joints has no effect
  std::vector<std::string> redundant_links;  ///< names of joints with constraints in such a group
  int driven = 0;                            ///< further degrees of freedom, which drives prescribe
  std::vector<std::string> drives;           ///< their names: "A.rz"
  std::vector<std::string> locked;           ///< those of them on loops that joints leave no degree of freedom
};

/// Counts degrees of freedom by the rank of the constraints, loop by loop. Constraints have unit norm, with rotations
/// as lengths (System::length), and pivots below 1e-11 are zero. For more than 300 constraints on common loops, singular
/// values below 1e-6 are zero, and their dependent constraints are one group. It allocates. Throws NonFiniteError.
LOCKSTEP_API MobilityReport mobility(Dynamics&, const State&);

/// Constraints on common loops that nearly depend on one another, and the decision about them.
struct NearDependency {
  std::vector<std::string> rows;  ///< names of the constraints: "A.z"
  int nearly = 0;                 ///< number of nearly redundant ones
  double singular_value = 0;      ///< the largest of their singular values, for constraints of unit norm
  /// Whether they nearly depend only near a singular configuration: then nothing is decided, and they hold.
  bool in_passing = false;
  bool decided = false;  ///< whether the requested decision, free or held, was possible
  bool free = false;     ///< whether these are left out
  std::string needed;    ///< why they cannot be left out: "its release would open joints by 0.1 m"; "" if they can
  /// Why it was not: "one of them is driven"; "" if it was. Solvers may then treat them differently.
  std::string undecided;
  double violation = 0;  ///< of constraints that would be left out, m, after a rotation of 0.3 rad
  /// Constraints that are left out. For free: all on these loops that depend on others, exactly or nearly. For held:
  /// all of the mechanism that depend on others exactly, in the first of the results only.
  std::vector<std::string> left_out;
  /// Joints on these loops. The decision is valid as long as none of them is released, and no other replaces it.
  std::vector<std::string> links;
  std::string advice;  ///< which hinge to correct, if one is out of place

  bool held() const { return decided && !free; }  ///< whether these are kept
};

/// Finds constraints that nearly depend on others at an assembled start: those of pivots, as in mobility(), between
/// 1e-11 and 1e-3. Then decides about them: reported, the default here, changes nothing; automatic, the default of
/// scenes, leaves out what free does, and keeps those without which joints open or nothing more can move. Constraints
/// that a law drives, of one-sided joints and of couplings are never left out, and groups with them are not decided.
/// Of others, those of a large share are kept first, then those of the earlier joint. They are left out only if they
/// nearly depend everywhere: without them, a motion by 0.3 rad must violate them by less than a thousandth of
/// System::length(). Leaves out constraints of `system` (System::leave_out), which must be that of the dynamics, in
/// place of those left out before. If any were, assemble the start again from these positions. Groups of more than 300
/// constraints on common loops are not examined. Throws what an evaluation throws.
LOCKSTEP_API std::vector<NearDependency> decide_nearly_redundant(System& system, Dynamics&, const State&,
                                                                 NearlyRedundant = NearlyRedundant::reported);

// Uniqueness: which reactions of a mechanism with redundant constraints are unique.

/// Reactions that are not unique in one pose. With redundant constraints, many sets of multipliers give the same
/// motion: those that differ by a vector n with Jh^T n = 0. A reaction is unique if no such vector changes it. The
/// solver chooses the others, alike in every run; in a real mechanism, elasticity and tolerances determine them.
struct UniquenessReport {
  int undetermined = 0;               ///< number of independent vectors n: the redundant constraints
  std::vector<std::string> rows;      ///< constraints whose multipliers are not unique: "A.z", in order
  std::vector<std::string> channels;  ///< channels that are not unique: "A.force_on_p_world_z", "A.lambda_z"
  std::vector<std::string> readers;   ///< forces that such a vector changes: "force 'A.friction' (joint A)"

  bool all_unique() const { return undetermined == 0; }  ///< whether every reaction is unique
  /// Whether the channel of this name is unique; true for channels that are no reactions.
  LOCKSTEP_API bool unique(const std::string& channel) const;
};

/// Finds them, in the scaling and with the limits of mobility(), for forces, torques and multipliers of joints and
/// their drives. Constraints that were left out (System::leave_out) count: loads that they would share with others,
/// exactly or with a relative singular value below 1e-3, are not unique. It allocates. Throws NonFiniteError.
LOCKSTEP_API UniquenessReport uniqueness(Dynamics&, const State&);

}  // namespace lockstep
