// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/stopping_form.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

SparseMat tangent_of(const TangentSum& sum, bool of_velocity, const Unknowns& at) {
  Triplets entries;
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    at.add(sum.pairs()[p].row, sum.pairs()[p].column, of_velocity ? sum.D(p) : sum.K(p), entries);
  return at.square(entries);
}

std::optional<MatX> stopping_form(const Evaluation& e, const Unknowns& at, const MatX& N, const VecX& w) {
  const double length = e.system().length();
  TangentSum sum;
  sum.lay_out(e.system().n_slots());
  double size = 0;  // of what cancels, too: redundant rows of one axis have no stiffness at all
  for (const RowEntry& entry : e.rows().entries) {
    std::array<double, kMaxRows> own{};
    double largest = 0;
    for (int k = 0; k < entry.m; ++k) {
      const double x = w[entry.first_row + k];
      own[entry.own[k]] = x;
      largest = std::max(largest, std::abs(x) / length / (entry.kind[k] == RowKind::translation ? 1.0 : length));
    }
    if (largest == 0) continue;
    size = std::max(size, largest);
    const Lock& link = *e.system().links()[entry.link];
    named(link, e.inputs().t, [&] { add_tangent(link, e.inputs(), own, sum); });
  }
  const VecX turned = at.lengths().cwiseInverse();
  const SparseMat K = scaled(turned, tangent_of(sum, false, at), turned);
  for (Eigen::Index i = 0; i < K.cols(); ++i)
    for (SparseMat::InnerIterator it(K, i); it; ++it) size = std::max(size, std::abs(it.value()));
  const MatX G = N.transpose() * (K * N);
  if (!(G.size() > 0 && G.cwiseAbs().maxCoeff() > kSlight * size)) return {};
  return 0.5 * (G + G.transpose());
}

}  // namespace lockstep
