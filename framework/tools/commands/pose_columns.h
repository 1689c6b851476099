// SPDX-License-Identifier: BSD-3-Clause
// Poses of bodies and reactions of links as numbers with the names of their channels, for analyses without a run.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>

namespace lockstep {

/// A reaction: of a link, drives left out, or of its drives, on p's body about P.
struct NamedReaction {
  std::string name, body;  ///< "A", "A.drive"; the body of P
  LinkWrench wrench;       ///< world axes
};

/// Of all links in force.
std::vector<NamedReaction> reactions_of(const System&, const Evaluated&);

/// Columns of the poses of all bodies that move and of all links' reactions, named as channels are: "crank.x",
/// "A.force_on_p_world_x".
std::vector<Column> pose_columns(const System&);
/// Their numbers. Of links that are not in force they are zero.
std::vector<double> pose_row(const System&, const State&, const Evaluated&);

/// The same as text in lines, and as JSON.
std::string pose_text(const System&, const State&);
std::string reaction_text(const System&, const Evaluated&);
nlohmann::ordered_json pose_json(const System&, const State&);
nlohmann::ordered_json reaction_json(const System&, const Evaluated&);

}  // namespace lockstep
