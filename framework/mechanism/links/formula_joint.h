// SPDX-License-Identifier: BSD-3-Clause
// The joint 'function': a joint by formulas of the relative coordinates, written in a scene.
#pragma once

#include <memory>

#include <lockstep/author/params.h>
#include <lockstep/author/phi_links.h>

namespace lockstep {

/// Its keys, and its maker: the formulas decide which coordinates the joint reads.
struct FormulaJoint {
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

}  // namespace lockstep
