#include "framework/dynamics/tree/tree_recursion.h"

#include "framework/dynamics/tree/articulated.h"
#include "framework/dynamics/tree/planar_bodies.h"

namespace lockstep {

TreeRecursion::~TreeRecursion() = default;

// Rows of a mechanism that is not declared to be planar are those of space.
std::unique_ptr<TreeRecursion> TreeRecursion::of(const JointTree& tree, const System& system,
                                                 const RowTable& closures) {
  if (tree.planar() && (closures.n_rows == 0 || system.plane()))
    return std::make_unique<PlanarBodies>(tree, system, closures);
  return std::make_unique<ArticulatedBodies>(tree, system, closures);
}

}  // namespace lockstep
