// What a Dynamics keeps for joint coordinates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/dynamics/tree/articulated.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/planar_bodies.h"
#include "framework/dynamics/tree/tree_reactions.h"

namespace lockstep {

// Joint coordinates: the tree of the links that were in force last, and the recursion on it.
struct Dynamics::Tree {
  long revision = -1;  // of the system, and the links, that the tree was made for
  std::vector<bool> modes;
  std::shared_ptr<const JointTree> coordinates;  // null: there is no tree
  std::string why_not;
  bool in_plane = false;  // the recursion is that of the plane
  ArticulatedBodies bodies;
  PlanarBodies planar_bodies;
  std::vector<Motion> motions;
  VecX f, a, none;
  RowTable rows;        // of the links whose multipliers somebody reads, and of those with laws
  bool solves = false;  // integrated states read accelerations or multipliers
  TreeReactions reactions;
};

}  // namespace lockstep
