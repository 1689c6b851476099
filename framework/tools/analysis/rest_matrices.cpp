#include "framework/tools/analysis/rest_matrices.h"

#include <lockstep/newton.h>
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/mechanism_matrices.h"

namespace lockstep {
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
