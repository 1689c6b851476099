// The rows of links at the start, against a plane: which lie in it and which are normal to it. Locks by a mask turn with
// their markers, and other links say that they keep what they are (Lock::stays_in_plane), so that one position is enough.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/export.h>
#include <lockstep/lock.h>
#include <lockstep/rows.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

class System;

/// The largest parts of a row on any slot. Moments are divided by the length of the mechanism.
struct RowAtStart {
  double in = 0,                         ///< along the plane, or about its normal
      along = 0,                         ///< along the normal
      about = 0,                         ///< about axes in the plane
      push = 0,                          ///< along any direction
      demand = 0;                        ///< C, Ct and Qhat of bodies at rest
  std::array<Vec3, kMaxSlots> normal{};  ///< by slot of the link: along the normal, about both axes in the plane

  bool lies_in() const { return in > kNegligible * std::max(along, about); }
  bool has_arm() const { return about > kNegligible * in; }  ///< of a row in the plane: a lever arm along the normal
  /// Of a row in the plane: whether its direction is not in it.
  bool is_tilted() const { return along > kNegligible * in || (has_arm() && push <= kNegligible * in); }
};

/// Evaluates links of a system at its start, in any coordinates, with all bodies at rest.
class LOCKSTEP_API RowsAtStart {
 public:
  RowsAtStart(const System&, Plane, State start);
  RowsAtStart(const RowsAtStart&) = delete;
  RowsAtStart& operator=(const RowsAtStart&) = delete;
  const Inputs& inputs() const { return in_; }  ///< the start
  /// The rows of a link, in their order; valid until the next call.
  std::span<const RowAtStart> of(const Lock&);

 private:
  const System& system_;
  Plane plane_;
  State start_;
  std::vector<Motion> motions_;
  Inputs in_;
  RowTable table_;
  std::vector<RowAtStart> rows_;
};

}  // namespace lockstep
