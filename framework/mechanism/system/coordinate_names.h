// SPDX-License-Identifier: BSD-3-Clause
// Coordinates by the names of their channels.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/system.h>
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep {

/// What has coordinates, and so which frames they are of.
enum class CoordinateOwner {
  joint,  ///< P relative to S: "A.rz"
  frame,  ///< a body or marker, relative to the world: "crank.x"
  body,   ///< besides, the centre of mass of a body that moves: "crank.center_x"
  pair    ///< a body or marker M, relative to another, N: "M.x@N"
};

/// A coordinate or rate of an owner, by the name of its channel without the owner's.
struct NamedCoordinate {
  std::string name, help;
  Coordinate::Of of;
};
/// All of an owner. Both names of a joint's rotation, "rz" and "angle_z", are among them.
LOCKSTEP_API std::vector<NamedCoordinate> coordinates_of(CoordinateOwner);

/// The body or marker of this name.
LOCKSTEP_API std::optional<BodyOrMarker> frame_named(const System&, std::string_view name);

/// The coordinate or rate that a channel of this name records: "A.rz_d", "crank.x", "M.distance@N". Second rates are none,
/// as forces cannot read them. Throws ModelError if there is none.
LOCKSTEP_API std::shared_ptr<Coordinate> coordinate_named(const System&, const std::string& name);

}  // namespace lockstep
