// SPDX-License-Identifier: BSD-3-Clause
// The rows of joints at the start, against a plane: those in it and those normal to it. Locks by a mask rotate with
// their markers, and other joints declare that they do not change (Lock::stays_in_plane), so one position is enough.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/body.h>
#include <lockstep/detail/rows.h>
#include <lockstep/system.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

/// The largest parts of a row or force on any slot. Moments are divided by the length of the mechanism.
struct PartsInPlane {
  double in = 0,  ///< along the plane, or about its normal
      along = 0,  ///< along the normal
      about = 0,  ///< about axes in the plane
      push = 0;   ///< along any direction

  void add(const Vec3& f, const Vec3& m, Plane plane) {
    in = std::max({in, std::abs(f[plane.i()]), std::abs(f[plane.j()]), std::abs(m[plane.n])});
    along = std::max(along, std::abs(f[plane.n]));
    about = std::max({about, std::abs(m[plane.i()]), std::abs(m[plane.j()])});
    push = std::max(push, f.norm());
  }
  bool lies_in() const { return in > kNegligible * std::max(along, about); }
  bool leaves() const { return along > kNegligible * in; }
  bool has_arm() const { return about > kNegligible * in; }  ///< of what lies in it: a lever arm along the normal
  /// Of what lies in the plane: whether its direction does not.
  bool is_tilted() const { return leaves() || (has_arm() && push <= kNegligible * in); }
};

struct RowAtStart : PartsInPlane {
  double demand = 0;                     ///< C, Ct and Qhat of bodies at rest
  std::array<Vec3, kMaxSlots> normal{};  ///< by slot of the link: along the normal, about both axes in the plane
};

/// Evaluates joints of a system at its start, in any coordinates, with all bodies at rest.
class LOCKSTEP_API RowsAtStart {
 public:
  RowsAtStart(const System&, Plane, State start);
  RowsAtStart(const RowsAtStart&) = delete;
  const Inputs& inputs() const { return in_; }
  std::span<const RowAtStart> of(const Lock&);  ///< in their order; valid until the next call

 private:
  const System& system_;
  Plane plane_;
  State start_;
  std::vector<Motion> motions_;
  Inputs in_;
  RowTable table_;
  std::vector<RowAtStart> rows_;
};

/// Of System::setup() in a plane: which rows lie in it. Returns the error for what leaves it.
std::optional<ModelError> setup_plane(const System&, System::Found&);

}  // namespace lockstep
