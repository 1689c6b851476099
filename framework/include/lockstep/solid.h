// Solids and looks: what bodies look like.
#pragma once

#include <string>

#include <lockstep/math.h>

namespace lockstep {

/// A solid that a body is made of, for pictures; its mass is in the body's MassProperties.
struct Solid {
  /// Its form, about the origin of its own frame.
  enum class Kind {
    box,       ///< edges along x, y and z
    cylinder,  ///< axis along z; a rod is one, too
    sphere     ///< about the origin
  };
  std::string body;          ///< name of the body
  Kind kind = Kind::box;     ///< its form
  Vec3 size = Vec3::Zero();  ///< extent along x, y and z of its frame, m: of a cylinder two diameters and the length
  Pose at{};                 ///< its frame in the body's frame
};

/// Colour and opacity of a body in pictures.
struct Look {
  std::string body,    ///< name of the body
      color{};         ///< "#rrggbb"; "": the next of a palette
  double opacity = 1;  ///< 0: glass, 1: solid
};

}  // namespace lockstep
