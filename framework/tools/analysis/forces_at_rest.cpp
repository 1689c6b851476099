#include "framework/tools/analysis/forces_at_rest.h"

#include <algorithm>
#include <array>

#include <lockstep/error.h>
#include "framework/mechanism/system/diagnose.h"

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
  force = largest_force();
  const double left = largest(r);
  unbalanced = force > 0 ? left / force : 0;
  speed_up = 0;
  for (int k = 0; k < system.n_slots(); ++k)
    speed_up = std::max({speed_up, a.segment<3>(6 * k).norm(), length_ * a.segment<3>(6 * k + 3).norm()});
  e->residuals(C, Cd_);
}

double ForcesAtRest::largest(const VecX& f) const {
  double most = 0;
  for (Eigen::Index k = 0; k < f.size(); k += 6) most = std::max(most, size_of(f.segment<6>(k)));
  return most;
}

double ForcesAtRest::largest_force() {
  const System& system = dynamics_.system();
  const Inputs& in = e->inputs();
  double most = largest(e->force());
  for (int k = 0; k < system.n_slots(); ++k) most = std::max(most, system.slot(k).mass * system.gravity().norm());
  one_.setZero(a.size());
  WrenchSum sum(in.motions, one_);
  for (const auto& each : system.forces()) {
    if (!each->acts(in)) continue;
    named(*each, in.t, [&] { each->apply(in, sum); });
    for (const int slot : each->slots()) {
      most = std::max(most, size_of(one_.segment<6>(6 * slot)));
      one_.segment<6>(6 * slot).setZero();
    }
  }
  for (const RowEntry& entry : e->rows().entries)
    for (int i = 0; i < entry.slots.n; ++i) {
      Vec6 on = Vec6::Zero();
      for (int k = 0; k < entry.m; ++k) {
        const std::array<double, 6> J = e->rows().block(entry).J(i, k);
        on += lambda[entry.first_row + k] * Eigen::Map<const Vec6>(J.data());
      }
      most = std::max(most, size_of(on));
    }
  return most;
}

}  // namespace lockstep
