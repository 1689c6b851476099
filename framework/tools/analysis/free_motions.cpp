#include "framework/tools/analysis/free_motions.h"

#include <utility>

#include "framework/tools/analysis/row_space.h"

namespace lockstep {

std::vector<int> unknowns_of(const System& system) {
  const std::array<int, 6> velocity = unknown_velocities(system.plane());
  std::vector<int> at;
  for (int k = 0; k < system.n_slots(); ++k)
    for (int j = 0; j < BodyMass(system.slot(k), system.plane()).width(); ++j)
      at.push_back(6 * k + velocity[static_cast<std::size_t>(j)]);
  return at;
}

MatX free_motions(const Evaluation& e, const std::vector<int>& unknowns) {
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  std::vector<int> number(static_cast<std::size_t>(6 * e.system().n_slots()), -1);
  for (std::size_t i = 0; i < unknowns.size(); ++i) number[static_cast<std::size_t>(unknowns[i])] = static_cast<int>(i);
  MatX Jt = MatX::Zero(n, e.rows().n_rows);
  for (const RowEntry& entry : e.rows().entries)
    for (int i = 0; i < entry.slots.n; ++i)
      for (int k = 0; k < entry.m; ++k) {
        const std::array<double, 6> r = e.rows().block(entry).J(i, k);
        for (int c = 0; c < 6; ++c)
          if (const int u = number[static_cast<std::size_t>(6 * entry.slots[i] + c)]; u >= 0)
            Jt(u, entry.first_row + k) += r[static_cast<std::size_t>(c)] / (c < 3 ? 1.0 : e.system().length());
      }
  return RowSpace(std::move(Jt)).free();
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
