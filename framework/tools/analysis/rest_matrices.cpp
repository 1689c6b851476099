#include "framework/tools/analysis/rest_matrices.h"

#include <algorithm>
#include <array>

#include <lockstep/newton.h>
#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/mechanism_matrices.h"

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
  const Unknowns unknowns(system);
  at = unknowns.places();
  const VecX turned = unknowns.lengths().cwiseInverse();
  const auto in_lengths = [&](const SparseMat& A) { return MatX(turned.asDiagonal() * A * turned.asDiagonal()); };
  NewtonMatrix newton;
  newton.gather(e, lambda);
  M = in_lengths(mass_of(system, unknowns)), K = in_lengths(tangent_of(newton.tangents(), false, unknowns));
  Vec6 turned_block = Vec6::Ones();
  turned_block.tail<3>() /= system.length();
  Triplets sizes;
  for (std::size_t p = 0; p < newton.tangents().pairs().size(); ++p) {
    const Mat6 block = turned_block.asDiagonal() * newton.tangents().K(p) * turned_block.asDiagonal();
    const auto [row, column] = newton.tangents().pairs()[p];
    unknowns.add(row, column, Mat6::Constant(block.cwiseAbs().maxCoeff()), sizes);
  }
  SparseMat size(unknowns.n(), unknowns.n());
  size.setFromTriplets(sizes.begin(), sizes.end());
  size_K = size;
  const VecX loads = largest_loads(e, lambda);
  for (Eigen::Index i = 0; i < size_K.rows(); ++i)
    size_K(i, i) += loads[at[static_cast<std::size_t>(i)] / 6] / system.length();
  N = free_motions(e);
}

}  // namespace lockstep
