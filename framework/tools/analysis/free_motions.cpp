#include "framework/tools/analysis/free_motions.h"

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/analysis/unknowns.h"

namespace lockstep {

std::vector<int> unknowns_of(const System& system) { return Unknowns(system).places(); }

MatX free_motions(const Evaluation& e) {
  const Unknowns at(e.system());
  return RowSpace(at.lengths().cwiseInverse().asDiagonal() * at.rows(e.rows(), entries_of(e.rows()))).free();
}

VecX motion_of(const System& system, const std::vector<int>& unknowns, const VecX& u) {
  VecX out = VecX::Zero(6 * system.n_slots());
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    out[unknowns[i]] = u[static_cast<Eigen::Index>(i)] / (unknowns[i] % 6 < 3 ? 1.0 : system.length());
  return out;
}

//   f . motion_of(u) = forces_in(f) . u
VecX forces_in(const System& system, const std::vector<int>& unknowns, const VecX& f) {
  VecX out(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = f[unknowns[i]] / (unknowns[i] % 6 < 3 ? 1.0 : system.length());
  return out;
}

}  // namespace lockstep
