// SPDX-License-Identifier: BSD-3-Clause
// One-sided joints of a search: they close on contact, and open if they would pull.
#include "framework/tools/analysis/equilibrium_search.h"

namespace lockstep {

bool EquilibriumSearch::touch(State& state) {
  bool any = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (contacts_.in_force(i, state) || !contacts_.watched(i, state)) continue;
    if (contacts_.gap(i, dynamics_.inputs(state)).c > contacts_[i].margin) continue;
    if (released_at_ == static_cast<int>(i) && contacts_.gap(i, dynamics_.inputs(state)).c > -contacts_[i].margin)
      continue;
    contacts_.put(i, true, state);
    any = true;
  }
  if (any) released_at_ = -1;
  return any;
}

double EquilibriumSearch::push(std::size_t i) const {
  const int row = contacts_.row(i, now_.e->rows());
  return row < 0 ? 0 : -contacts_[i].sign * now_.lambda[row];
}

bool EquilibriumSearch::release() {
  std::size_t worst = contacts_.size();
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (pulls(i) && (worst == contacts_.size() || push(i) < push(worst))) worst = i;
  if (worst == contacts_.size() || ++releases_ > most_releases()) return false;
  contacts_.put(worst, false, state_);
  released_at_ = static_cast<int>(worst);
  return true;
}

std::vector<std::string> EquilibriumSearch::contact_names() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < contacts_.size(); ++i) names.push_back("'" + contacts_[i].link->name() + "'");
  return names;
}

}  // namespace lockstep
