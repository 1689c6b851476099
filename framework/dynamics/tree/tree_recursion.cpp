#include "framework/dynamics/tree/tree_recursion.h"

#include <utility>

#include "framework/dynamics/tree/articulated.h"
#include "framework/dynamics/tree/planar_bodies.h"
#include "framework/dynamics/tree/recursion_of.h"

namespace lockstep {

extern template class RecursionOf<ArticulatedBodies>;
extern template class RecursionOf<PlanarBodies>;

TreeRecursion::~TreeRecursion() = default;

std::unique_ptr<TreeRecursion> TreeRecursion::of(const JointTree& tree, const System& system, ClosureFronts closures) {
  if (tree.planar() && (closures.sources.empty() || closures.in_plane))
    return std::make_unique<RecursionOf<PlanarBodies>>(tree, system, std::move(closures));
  return std::make_unique<RecursionOf<ArticulatedBodies>>(tree, system, std::move(closures));
}

}  // namespace lockstep
