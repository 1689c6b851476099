// SPDX-License-Identifier: BSD-3-Clause
// The unknown velocities of slots as columns of matrices.
#pragma once

#include <unordered_map>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/foundation/math/sparse.h"

namespace lockstep {

/// Mechanisms of more unknowns are not taken as dense matrices, whose factors take some seconds there.
inline constexpr int kDenseUnknowns = 1200;

using Triplets = std::vector<Eigen::Triplet<double>>;

/// 0 to n - 1: all entries of a table, all slots.
LOCKSTEP_API std::vector<int> up_to(std::size_t n);

/// The unknown velocities of some slots: six of a body, three of a particle; in a plane three and two.
class LOCKSTEP_API Unknowns {
 public:
  explicit Unknowns(const System&);                        ///< of all slots
  Unknowns(const System&, const std::vector<int>& slots);  ///< of these

  int n() const { return static_cast<int>(places_.size()); }
  /// Column of a velocity of a slot; -1 if it is none of the unknowns: a particle's turns, what leaves a plane.
  int column(int slot, int velocity) const {
    const auto found = column_.find(6 * slot + velocity);
    return found == column_.end() ? -1 : found->second;
  }
  /// Of each unknown: its number among six per slot.
  const std::vector<int>& places() const { return places_; }
  /// The unknowns among six numbers a slot.
  VecX of_slots(const VecX& six) const;
  /// Six numbers a slot, zero if there is no unknown.
  VecX to_slots(const VecX& unknowns) const;
  /// What each unknown is multiplied by to be a length: 1, and System::length() for turns.
  const VecX& lengths() const { return lengths_; }
  /// A motion u with rotations as lengths, 6 per slot: m (world) and rad (slot axes).
  VecX motion_of(const VecX& u) const { return to_slots(u.cwiseQuotient(lengths_)); }
  /// Forces, N, that have the power of f in each motion u; f: 6 per slot, N (world) and N m (slot axes).
  VecX forces_in(const VecX& f) const { return of_slots(f).cwiseQuotient(lengths_); }

  /// Adds the block of two slots.
  void add(int row_slot, int column_slot, const Mat6& block, Triplets& to) const;
  /// Adds what moves a slot along its moves and about its turns.
  void add(int slot, const Mat3& moves, const Mat3& turns, Triplets& to) const;
  /// Jacobian, transposed, of entries of a table: a row is a column, entry after entry.
  SparseMat rows(const RowTable&, const std::vector<int>& entries) const;
  /// The same with rotations as lengths; and of all entries.
  SparseMat rows_in_lengths(const RowTable&, const std::vector<int>& entries) const;
  SparseMat rows_in_lengths(const RowTable& t) const { return rows_in_lengths(t, up_to(t.entries.size())); }
  /// A matrix of pairs of unknowns.
  SparseMat square(const Triplets&) const;

 private:
  const System* system_;
  std::vector<int> places_;
  std::unordered_map<int, int> column_;  // by place
  VecX lengths_;
};

/// Basis of the motions that the rows leave free, orthonormal with rotations as lengths: one column each
/// (RowSpace::free).
LOCKSTEP_API MatX free_motions(const Evaluation&);

}  // namespace lockstep
