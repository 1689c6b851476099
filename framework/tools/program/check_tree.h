// SPDX-License-Identifier: BSD-3-Clause
// The tree of joint coordinates, for `lockstep check`.
#pragma once

#include <string>
#include <vector>

#include <lockstep/system.h>
#include "framework/tools/program/result.h"

namespace lockstep {

/// A node of the tree: what moves, the link that carries it, and its coordinates.
struct Branch {
  std::string body, link, parent;        ///< link: empty where no link carries the body
  std::vector<std::string> coordinates;  ///< "x", "rz": of P seen from S; of a free body in the world
  std::vector<std::string> rows;         ///< "e1": of the link, which its joint does not hold
};

/// The tree of a mechanism that runs in joint coordinates, and what closes loops beside it. Empty if there is no tree.
struct TreeReport {
  std::vector<Branch> branches;       ///< parents before their children
  std::vector<std::string> closures;  ///< names of the links in force that close loops
  std::vector<std::string> left;      ///< "J.e1": rows that joints do not hold
  int n_coordinates = 0;              ///< of all branches, turns of balls by three
  bool has_rows() const { return !closures.empty() || !left.empty(); }
};
TreeReport tree_of(const System&, const std::vector<bool>& modes);

/// As a result has them.
const Fields<Branch>& branch_fields();

}  // namespace lockstep
