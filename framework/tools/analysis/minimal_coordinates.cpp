// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/minimal_coordinates.h"

#include <Eigen/QR>
#include <algorithm>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/rank/stopping_form.h"
#include "framework/tools/rank/unknowns.h"

namespace lockstep {

VecX lengths_of(const MechanismMatrices& m) {
  VecX lengths(static_cast<Eigen::Index>(m.unknowns.size()));
  for (std::size_t i = 0; i < m.unknowns.size(); ++i)
    lengths[static_cast<Eigen::Index>(i)] = m.unknowns[i].velocity < 3 ? 1.0 : m.length;
  return lengths;
}

MinimalCoordinates minimal_coordinates(Dynamics& dynamics, const State& state, const MechanismMatrices& m) {
  const Unknowns at(dynamics.system());
  const VecX turned = at.lengths().cwiseInverse();
  const RowSpace rows(scaled(turned, m.J.transpose()));
  const MatX N = rows.free(), stresses = rows.circuits();
  const Evaluation& e = dynamics.gather_rows(state);
  for (const auto& stress : stresses.colwise()) {
    if (!stopping_form(e, at, N, stress)) continue;
    Eigen::Index row = 0;
    stress.cwiseAbs().maxCoeff(&row);
    throw ModelError("constraint " + m.rows[row] +
                     " depends on others in this pose only (singular configuration: change point, rods in line), so no "
                     "linearisation exists; use another state");
  }
  return {turned.asDiagonal() * N, rows.nearly()};
}

std::vector<int> independent_unknowns(const MechanismMatrices& m, const MatX& N) {
  if (N.cols() == 0) return {};
  const MatX scaled = lengths_of(m).asDiagonal() * N;
  const Eigen::ColPivHouseholderQR<MatX> qr(scaled.transpose());
  std::vector<int> chosen(qr.colsPermutation().indices().data(), qr.colsPermutation().indices().data() + N.cols());
  std::ranges::sort(chosen);
  return chosen;
}

Eigen::LLT<MatX> mass_factor(const MatX& M) {
  Eigen::LLT<MatX> llt(M);
  if (llt.info() != Eigen::Success)
    throw SolveError(
        "the mass matrix in minimal coordinates is not positive definite: a body that can move has no mass "
        "or inertia");
  return llt;
}

}  // namespace lockstep
