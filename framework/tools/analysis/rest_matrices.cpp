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
  M = MatX::Zero(n, n), K = MatX::Zero(n, n), size_K = MatX::Zero(n, n);
  const auto add = [&](MatX& to, int row_slot, int column_slot, const auto& entry) {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const int r = 6 * row_slot + i, c = 6 * column_slot + j;
        const int ur = unknown[static_cast<std::size_t>(r)], uc = unknown[static_cast<std::size_t>(c)];
        if (ur >= 0 && uc >= 0) to(ur, uc) += entry(i, j);
      }
  };
  const auto scaled = [&](const Mat6& block) {
    Mat6 out = block;
    for (int i = 0; i < 6; ++i) out.row(i) *= scale(i), out.col(i) *= scale(i);
    return out;
  };
  NewtonMatrix newton;
  newton.gather(e, lambda);
  const TangentSum& tangents = newton.tangents();
  for (std::size_t p = 0; p < tangents.pairs().size(); ++p) {
    const Mat6 block = scaled(tangents.K(p));
    const double largest = block.cwiseAbs().maxCoeff();
    add(K, tangents.pairs()[p].row, tangents.pairs()[p].column, block);
    add(size_K, tangents.pairs()[p].row, tangents.pairs()[p].column, [&](int, int) { return largest; });
  }
  for (int k = 0; k < system.n_slots(); ++k) {
    Mat6 mass = Mat6::Zero();
    mass.topLeftCorner<3, 3>() = system.slot(k).mass * Mat3::Identity();
    mass.bottomRightCorner<3, 3>() = system.slot(k).J;
    add(M, k, k, scaled(mass));
  }

  N = free_motions(e, at);
}

}  // namespace lockstep
