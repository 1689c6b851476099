#include "framework/tools/analysis/rest_matrices.h"

#include <lockstep/newton.h>
#include "framework/tools/analysis/free_motions.h"

namespace lockstep {

RestMatrices::RestMatrices(const Evaluation& e, const VecX& lambda) {
  const System& system = e.system();
  at = unknowns_of(system);
  std::vector<int> unknown(static_cast<std::size_t>(6 * system.n_slots()), -1);
  for (std::size_t i = 0; i < at.size(); ++i) unknown[static_cast<std::size_t>(at[i])] = static_cast<int>(i);
  const auto n = static_cast<Eigen::Index>(at.size());
  // u = place / length for turns: K_u = S K S with S = 1/length there.
  const auto scale = [&](int place) { return place % 6 < 3 ? 1.0 : 1.0 / system.length(); };
  M = MatX::Zero(n, n), K = MatX::Zero(n, n);
  const auto add = [&](MatX& to, int row_slot, int column_slot, const Mat6& block) {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const int r = 6 * row_slot + i, c = 6 * column_slot + j;
        const int ur = unknown[static_cast<std::size_t>(r)], uc = unknown[static_cast<std::size_t>(c)];
        if (ur >= 0 && uc >= 0) to(ur, uc) += scale(r) * scale(c) * block(i, j);
      }
  };
  NewtonMatrix newton;
  newton.gather(e, lambda);
  const TangentSum& tangents = newton.tangents();
  for (std::size_t p = 0; p < tangents.pairs().size(); ++p)
    add(K, tangents.pairs()[p].row, tangents.pairs()[p].column, tangents.K(p));
  for (int k = 0; k < system.n_slots(); ++k) {
    Mat6 mass = Mat6::Zero();
    mass.topLeftCorner<3, 3>() = system.slot(k).mass * Mat3::Identity();
    mass.bottomRightCorner<3, 3>() = system.slot(k).J;
    add(M, k, k, mass);
  }

  N = free_motions(e, at);
}

}  // namespace lockstep
