// SPDX-License-Identifier: BSD-3-Clause
// Friction at rest: whether it holds the state from which a search begins.
#include <spdlog/fmt/fmt.h>

#include "framework/foundation/support/finding_kinds.h"
#include "framework/tools/analysis/equilibrium_search.h"
#include "framework/tools/analysis/friction_at_rest.h"
#include "framework/tools/analysis/rest_matrices.h"

namespace lockstep {
namespace {

std::string words_of(const GripReport& grip) {
  return fmt::format("'{}' ({}) needs {:.6g} {} (limit {:.6g})", grip.force, grip.what, grip.carries, grip.unit,
                     grip.most);
}

}  // namespace

bool EquilibriumSearch::rests_by_friction() {
  if (!options_.friction || system_.n_velocities() > kDenseUnknowns) return false;
  now_.look(state_);
  if (now_.e->reacting().empty()) return false;
  RestMatrices A(*now_.e, now_.lambda);
  if (now_.unbalanced <= options_.tolerance && judge_motions(*now_.e, A).kind == Stability::Kind::stable)
    return false;  // without friction too
  FrictionLoad load = friction_load(dynamics_, now_, A);
  if (load.balances) report_.grips = std::move(load.grips);
  if (!load.holds) return false;
  now_.lambda = load.lambda;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (pulls(i)) {
      report_.notes.push_back({&finding::analysis_note, "joint '" + contacts_[i].link->name() + "'",
                               "friction could hold the start, but the one-sided joint '" + contacts_[i].link->name() +
                                   "' would have to pull"});
      return false;
    }
  RestMatrices held(*now_.e, load.lambda);
  held.N = load.ungripped;
  Stability found = judge_motions(*now_.e, held);
  if (found.kind == Stability::Kind::unstable) {
    report_.notes.push_back(
        {&finding::analysis_note, "",
         "friction could hold the start, but a motion without friction is unstable: " + found.unstable.front().words});
    return false;
  }
  if (found.kind == Stability::Kind::stable) found.kind = Stability::Kind::gripped;
  found.freedoms = static_cast<int>(A.N.cols());
  report_.stability = std::move(found);
  report_.by_friction = true;
  now_.unbalanced = 0;  // except for round-off
  return true;
}

std::string EquilibriumSearch::beyond_friction() const {
  std::string words;
  for (const GripReport& grip : report_.grips)
    if (grip.carries > grip.most) words += (words.empty() ? "" : "; ") + words_of(grip);
  return words.empty() ? words : "friction does not hold the start: " + words;
}

}  // namespace lockstep
