// SPDX-License-Identifier: BSD-3-Clause
// Which reactions of a mechanism with redundant rows are unique.
#pragma once

#include <string>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

class Dynamics;
struct State;

/// Reactions that are not unique in one pose. Where rows are redundant, many sets of multipliers give the same motion:
/// those that differ by a vector n with Jh^T n = 0. A reaction is unique if no such vector changes it. What is not unique
/// is shared out by the solver, alike in every run; a real mechanism shares it out by its elasticity and its tolerances.
struct UniquenessReport {
  int undetermined = 0;               ///< how many independent vectors n there are: the redundant rows
  std::vector<std::string> rows;      ///< rows whose multipliers are not unique: "A.z", in the order of the rows
  std::vector<std::string> channels;  ///< channels that are not: "A.force_on_p_world_z", "A.lambda_z"; links in order

  bool all_unique() const { return undetermined == 0; }  ///< whether every reaction is unique
  /// Whether the channel of this name is unique; true of channels that are no reactions.
  LOCKSTEP_API bool unique(const std::string& channel) const;
};

/// Finds them, in the scaling and with the limits of mobility(), for forces, torques and multipliers of links and their
/// drives. Where rows were left out (System::leave_out) they count: what they and those that stay would share is not
/// unique, exactly or but for a singular value below 1e-3. It allocates: for descriptions, not for runs. Throws NonFiniteError.
LOCKSTEP_API UniquenessReport uniqueness(Dynamics&, const State&);

}  // namespace lockstep
