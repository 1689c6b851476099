// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/tree_recursion.h"

#include <utility>

namespace lockstep {

TreeRecursion::~TreeRecursion() = default;

std::unique_ptr<TreeRecursion> TreeRecursion::of(std::shared_ptr<const JointTree> tree, const System& system,
                                                 ClosureFronts closures) {
  const bool in_plane = tree->planar() && (closures.sources.empty() || closures.in_plane);
  return (in_plane ? recursion_in_plane : recursion_in_space)(std::move(tree), system, std::move(closures));
}

}  // namespace lockstep
