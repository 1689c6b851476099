#include "framework/tools/analysis/free_motions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

#include "framework/tools/analysis/dependency.h"

namespace lockstep {

//   Jt P = Q (R1 R2; 0 0),   N = Q (0; 1),   Jt P (-R1^-1 R2; 1) = 0
FreeSpace free_space(MatX Jt) {
  FreeSpace out;
  const Eigen::Index n = Jt.rows(), rows = Jt.cols();
  if (rows == 0) {
    out.N = MatX::Identity(n, n), out.circuits = MatX(0, 0);
    return out;
  }
  const VecX sizes = VecX(Jt.colwise().norm()).unaryExpr([](double x) { return x > 0 ? x : 1.0; });
  Jt = (Jt * sizes.cwiseInverse().asDiagonal()).eval();
  const Eigen::ColPivHouseholderQR<MatX> qr(Jt);
  for (Eigen::Index i = 0; i < std::min(n, rows); ++i) {
    const double pivot = std::abs(qr.matrixR()(i, i));
    if (pivot <= kDependent) break;
    ++out.rank;
    if (pivot <= kNearlyDependent) ++out.nearly;
  }
  MatX Q = MatX::Identity(n, n);
  Q = qr.householderQ() * Q;
  out.N = Q.rightCols(n - out.rank);
  out.circuits.resize(rows, rows - out.rank);
  if (out.circuits.cols() == 0) return out;
  MatX circuits(rows, rows - out.rank);
  circuits.topRows(out.rank) = -qr.matrixR()
                                    .topLeftCorner(out.rank, out.rank)
                                    .triangularView<Eigen::Upper>()
                                    .solve(MatX(qr.matrixR().topRightCorner(out.rank, rows - out.rank)));
  circuits.bottomRows(rows - out.rank).setIdentity();
  out.circuits = sizes.cwiseInverse().asDiagonal() * MatX(qr.colsPermutation() * circuits);
  return out;
}

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
  return free_space(std::move(Jt)).N;
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
