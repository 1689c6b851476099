// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/forces_at_rest.h"

#include <algorithm>

#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {

void ForcesAtRest::look(const State& state) {
  e = &dynamics_.gather(state);
  const System& system = dynamics_.system();
  none_.setZero(e->rows().n_rows);
  Factor& factor = dynamics_.factor(*e);
  SolveReport solved = factor.solve(*e, e->force(), none_, a, lambda);
  if (!e->reacting().empty()) reacting_.solve(*e, factor, none_, a, lambda, solved);
  factor.check(*e, a, lambda, solved);
  r.setZero(a.size());
  for (int k = 0; k < system.n_slots(); ++k) {
    r.segment<3>(6 * k) = system.slot(k).mass * a.segment<3>(6 * k);
    r.segment<3>(6 * k + 3) = system.slot(k).J * a.segment<3>(6 * k + 3);
  }
  force = system.n_slots() > 0 ? largest_loads(*e, lambda).maxCoeff() : 0;
  unbalanced = force > 0 ? largest(r) / force : 0;
  speed_up = motion_size(system, a);
  e->residuals(C, Cd_);
}

namespace {

double size_of_load(const Vec6& f, double length) { return std::max(f.head<3>().norm(), f.tail<3>().norm() / length); }

}  // namespace

double ForcesAtRest::largest(const VecX& f) const {
  double most = 0;
  for (Eigen::Index k = 0; k < f.size(); k += 6) most = std::max(most, size_of_load(f.segment<6>(k), length_));
  return most;
}

VecX largest_loads(const Evaluation& e, const VecX& lambda) {
  const System& system = e.system();
  VecX loads(system.n_slots());
  const auto add = [&](int slot, const Vec6& f) {
    loads[slot] = std::max(loads[slot], size_of_load(f, system.length()));
  };
  for (int k = 0; k < system.n_slots(); ++k) {
    loads[k] = system.slot(k).mass * system.gravity().norm();
    add(k, e.force().segment<6>(6 * k));
  }
  for (const auto& force : system.forces()) {
    const VecX one = wrench_of(system, e.inputs(), *force);
    for (const int slot : force->slots()) add(slot, one.segment<6>(6 * slot));
  }
  for (const RowEntry& entry : e.rows().entries)
    for (int i = 0; i < entry.slots.n; ++i)
      add(entry.slots[i], load_of(e.rows(), entry, i, lambda, [](int) { return true; }));
  return loads;
}

}  // namespace lockstep
