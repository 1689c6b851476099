// SPDX-License-Identifier: BSD-3-Clause
// A random mechanism, as numbers: what the differential tests turn into scenes.
#pragma once

#include <string>
#include <vector>

#include <lockstep/math.h>

namespace lockstep::differential {

/// A body with principal inertia in its own frame, whose origin is its mass centre. SI.
struct DesignBody {
  double mass = 1;
  Vec3 inertia = Vec3::Ones();
  Pose home;
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();  ///< at the start: world; body axes
};

/// A link between two bodies, -1 is the ground, with both markers at one pose in the world.
struct DesignLink {
  std::string type;
  int p = 0, s = -1;
  Vec3 at = Vec3::Zero();
  Quat axes;
  Vec3 at_s = Vec3::Zero();  ///< of a distance: where S is
  double drive = 0;          ///< amplitude of a sine on rz, rad; 0: none
  double mu = 0;             ///< friction; 0: none
  double stop = 0;           ///< stops at rz = -stop and stop, rad; 0: none
};

/// A force between two bodies.
struct DesignForce {
  enum class Kind { spring, torsion, push, formula };
  Kind kind = Kind::spring;
  int p = 0, s = -1;
  Vec3 at_p = Vec3::Zero(), at_s = Vec3::Zero();  ///< world
  Quat axes;                                      ///< of a torsion spring
  double stiffness = 0, damping = 0, free = 0;
  Vec3 push = Vec3::Zero();  ///< world, N
};

/// A mechanism. `planar`: all of it lies in the world's xy plane.
struct Design {
  bool planar = false;
  Vec3 gravity = Vec3::Zero();
  std::vector<DesignBody> bodies;
  std::vector<DesignLink> links;
  std::vector<DesignForce> forces;

  bool has_drive() const;
  bool has_loss() const;  ///< damping, friction or stops
  bool has_stop() const;
  bool has_friction() const;
};

/// Trees and loops, redundant or driven, with springs, friction and stops, of one to six bodies; the same for the same
/// seed on every machine.
Design random_design(unsigned seed);

/// How a design is written: in a turned and moved world, in another unit of length, in another order.
struct View {
  Pose frame;          ///< of the design's world in the scene's
  double length = 1;   ///< the scene's units of length per metre; masses and times stay
  unsigned order = 0;  ///< 0: as designed; else a seed of bodies', links' and forces' order
};

/// The scene of a design in JSON. `planar`: value of that key, "" for none.
std::string scene_text(const Design&, const View& = {}, const std::string& planar = "off");

/// The design without body k and all that is fixed to it.
Design without_body(const Design&, int k);

}  // namespace lockstep::differential
