// SPDX-License-Identifier: BSD-3-Clause
// TreeRecursion: accelerations of a tree, with the rows that close its loops, by articulated inertias.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include <lockstep/state.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// The largest accelerations of the slots, as they are found one by one.
struct Largest {
  double a2 = 0, al2 = 0;  ///< their squares

  LOCKSTEP_INLINE void add(double own_a2, double own_al2) { a2 = std::max(a2, own_a2), al2 = std::max(al2, own_al2); }
  double a() const { return std::sqrt(a2); }       ///< m/s^2
  double alpha() const { return std::sqrt(al2); }  ///< angular, rad/s^2
};

/// Three passes over the nodes of a tree, and their scratch (Featherstone 2008, chapter 7).
class LOCKSTEP_API TreeRecursion {
 public:
  /// That of a plane where the tree and its closures lie in one, else that of space.
  static std::unique_ptr<TreeRecursion> of(std::shared_ptr<const JointTree>, const System&, ClosureFronts closures);
  virtual ~TreeRecursion();

  /// First pass, outward: motions of all slots (the ground is motions[0], at rest), joint axes and velocity products.
  virtual void outward(const State&, std::vector<Motion>& motions) = 0;
  /// Reads the rows of closures, gathered at these motions. Before accelerate(), where there are some.
  virtual void read(std::span<const Motion> motions, const RowTable&) = 0;
  /// The other two passes: accelerations of the coordinates under f, 6 per slot: N (world) and N m (slot axes), -w x J w
  /// included; and first multipliers of the closures.
  virtual void accelerate(std::span<const Motion> motions, const VecX& f, VecX& vd) = 0;
  /// The accelerations of a tree without coordinates: its laws'. No force matters.
  virtual void follow() = 0;
  /// Whether the accelerations as found last meet the rows of the closures; `corrected`: by correct().
  virtual bool met(bool corrected) = 0;
  /// Corrects the accelerations by what met() has measured; vd: as found last.
  virtual void correct(VecX& vd) = 0;
  /// The change of the velocities by which these residuals vanish, one per row: J (change) = -r, of least kinetic
  /// energy.
  virtual void correct(const VecX& r, VecX& dv) = 0;
  /// Takes accelerations of the slots, 6 per slot as in accelerations(), for those found last, and reads off the
  /// coordinates' own; what the joints do not let happen is lost.
  virtual void read_off(std::span<const Motion> motions, const VecX& a, VecX& vd) = 0;
  /// Accelerations as found last, 6 per slot: m/s^2 (world), rad/s^2 (slot axes).
  virtual void accelerations(std::span<const Motion> motions, VecX& a) const = 0;

  virtual ClosureRows& closures() = 0;
  /// Largest accelerations of a slot, as found last.
  virtual Largest largest() const = 0;
};

// Each is compiled for several instruction sets, in a file of its own.
std::unique_ptr<TreeRecursion> recursion_in_plane(std::shared_ptr<const JointTree>, const System&, ClosureFronts);
std::unique_ptr<TreeRecursion> recursion_in_space(std::shared_ptr<const JointTree>, const System&, ClosureFronts);

}  // namespace lockstep
