// SPDX-License-Identifier: BSD-3-Clause
// The tree of joint coordinates, for `lockstep check`.
#pragma once

#include <string>
#include <vector>

#include <lockstep/system.h>
#include "framework/tools/program/result.h"

namespace lockstep {

/// A node of the tree: the body that moves, the joint that carries it, and its coordinates.
struct Branch {
  std::string body, link, parent;        ///< link: empty if no joint carries the body
  std::vector<std::string> coordinates;  ///< "x", "rz": of P seen from S; of a free body in the world
  std::vector<std::string> rows;         ///< "e1": constraints that the joint's coordinates do not satisfy
};

/// The tree of a mechanism that runs in joint coordinates, and the joints that close loops. Empty if there is no tree.
struct TreeReport {
  std::vector<Branch> branches;       ///< parents before their children
  std::vector<std::string> closures;  ///< names of the active joints that close loops
  std::vector<std::string> left;      ///< "J.e1": constraints that joint coordinates do not satisfy
  int n_coordinates = 0;              ///< of all branches; three for the rotation of a spherical joint
  bool has_rows() const { return !closures.empty() || !left.empty(); }
};
TreeReport tree_of(const System&, const std::vector<bool>& modes);

/// As a result has them.
const Fields<Branch>& branch_fields();

}  // namespace lockstep
