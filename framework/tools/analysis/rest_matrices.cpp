#include "framework/tools/analysis/rest_matrices.h"

#include <algorithm>
#include <array>

#include <lockstep/newton.h>
#include "framework/tools/analysis/free_motions.h"

namespace lockstep {
namespace {

/// The largest single load on each slot, N: its weight, the sum of the applied forces, the reaction of a link; moments by
/// the length. Over the length it is as stiff as an arm of that length makes it.
VecX largest_loads(const Evaluation& e, const VecX& lambda) {
  const System& system = e.system();
  const auto size_of = [&](const Vec6& f) {
    return std::max(f.head<3>().norm(), f.tail<3>().norm() / system.length());
  };
  VecX loads(system.n_slots());
  for (int k = 0; k < system.n_slots(); ++k)
    loads[k] = std::max(system.slot(k).mass * system.gravity().norm(), size_of(e.force().segment<6>(6 * k)));
  for (const RowEntry& entry : e.rows().entries)
    for (int i = 0; i < entry.slots.n; ++i) {
      Vec6 on = Vec6::Zero();
      for (int k = 0; k < entry.m; ++k) {
        const std::array<double, 6> J = e.rows().block(entry).J(i, k);
        on += lambda[entry.first_row + k] * Eigen::Map<const Vec6>(J.data());
      }
      double& most = loads[entry.slots[i]];
      most = std::max(most, size_of(on));
    }
  return loads;
}

}  // namespace

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

  const VecX loads = largest_loads(e, lambda);
  for (Eigen::Index i = 0; i < n; ++i) size_K(i, i) += loads[at[static_cast<std::size_t>(i)] / 6] / system.length();
  N = free_motions(e, at);
}

}  // namespace lockstep
