// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/closure_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/dynamics/solvers/scales.h"
#include "framework/mechanism/rows/loads.h"

namespace lockstep {

namespace {

constexpr double kUnchanged = 0.9;  // of a residual, and its inverse: a correction that leaves this could not help

}  // namespace

void ClosureRows::begin(ClosureFronts fronts, double length, double mass_ratio) {
  fronts_ = std::move(fronts);
  differ_in_mass_ = std::numeric_limits<double>::epsilon() * mass_ratio > kRowTolerance;
  length_ = length, worst_ = 0, worst_row_ = -1, redundant_ = Kkt::kUnknown;
  Lambda_.assign(fronts_.n_Lambda, 0.0);
  V_.assign(fronts_.n_V, 0.0);
  l_.assign(fronts_.rows.size(), 0.0);
  const auto n = static_cast<Eigen::Index>(fronts_.sources.size());
  for (VecX* v : {&c_, &diagonal_, &scale_, &d_, &lambda_, &r_, &size_, &dlambda_}) v->setZero(n);
  watch_.begin(static_cast<int>(n));
}

void ClosureRows::measure_scales(const RowTable& table) {
  scale_ = diagonal_;
  for (const RowEntry& e : table.entries) average_scales(scale_.data() + e.first_row, e.m, KindBits(e.kind, e.m));
}

void ClosureRows::subtract(const VecX& x) {
  c_ -= x;
  for (std::size_t row = 0; row < fronts_.sources.size(); ++row)
    l_[fronts_.place_of(row)] += x[static_cast<Eigen::Index>(row)];
}

void find_residuals(const RowTable& table, std::span<const Motion> motions, VecX& C, VecX& Cd) {
  C.resize(table.n_rows), Cd.resize(table.n_rows);
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int k = 0; k < e.m; ++k) C[e.first_row + k] = block.C(k), Cd[e.first_row + k] = block.Ct(k);
  }
  for_each_jacobian(table, [&](int row, int slot, const auto& J) {
    const Motion& O = motions[slot + 1];
    Cd[row] += J.template head<3>().dot(O.v) + J.template tail<3>().dot(O.w);
  });
}

double ClosureRows::norm(const VecX& c) const {
  double worst = 0;
  for (Eigen::Index row = 0; row < c.size(); ++row) {
    const double x = length_per_unit(fronts_.sources[row].kind, length_) * std::abs(c[row]);
    worst = x > worst || std::isnan(x) ? x : worst;
  }
  return worst;
}

bool ClosureRows::is_met(bool corrected) {
  std::array<double, 3> largest{};
  for (Eigen::Index row = 0; row < r_.size(); ++row) {
    // What lambda alone would cause, and what other rows balance: its rounding is left where nothing moves. Between heavy
    // bodies light ones have more of it than of motion, until they are corrected.
    if (corrected || !differ_in_mass_)
      size_[row] = std::max(size_[row], kScaleFloor * scale_[row] * std::abs(lambda_[row]));
    double& most = largest[static_cast<std::size_t>(fronts_.sources[row].kind)];
    most = std::max(most, size_[row]);
  }
  worst_ = 0, worst_row_ = -1, regular_met_ = true;
  for (Eigen::Index row = 0; row < r_.size(); ++row) {
    const double least = residual_floor(largest[static_cast<std::size_t>(fronts_.sources[row].kind)]);
    const double x = r_[row] == 0 ? 0.0 : std::abs(r_[row]) / std::max(size_[row], least);
    if (!(x <= kRowTolerance) && !(d_[row] <= kRedundantPivot * kClosureProximal * scale_[row])) regular_met_ = false;
    if (worst_row_ >= 0 && (x <= worst_ || std::isnan(worst_))) continue;
    worst_ = x, worst_row_ = static_cast<int>(row);
  }
  return worst_ <= kRowTolerance;
}

bool ClosureRows::is_left_by_redundant_rows(double before) const {
  const bool stays = worst_ > kUnchanged * before && kUnchanged * worst_ < before;
  return stays && worst_ <= kContradiction && regular_met_ && n_small_ <= redundant_;
}

void ClosureRows::complete(SolveReport& report) {
  const auto each = [&](auto&& row) {
    for (Eigen::Index j = 0; j < d_.size(); ++j) row(d_[j], diagonal_[j]);
  };
  watch_.see(redundant_, each);
  report.residual = worst_, report.worst_row = worst_row_;
  watch_.report(report);
}

}  // namespace lockstep
