// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/forces_at_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr int kRounds = 300;

struct GripOf {
  const Force* force;
  Grip grip;
};

std::vector<GripOf> grips_at(const Evaluation& e, const VecX& lambda) {
  const Reactions at(e.rows(), {lambda.data(), static_cast<std::size_t>(lambda.size())});
  std::vector<GripOf> all;
  for (const Force* force : e.reacting()) {
    if (!force->acts(e.inputs())) continue;
    for (Grip& grip : named(*force, e.inputs().t, [&] { return force->reacting()->grips(e.inputs(), at); }))
      all.push_back({force, std::move(grip)});
  }
  return all;
}

/// Forces t along the directions of all grips with B t = b, where each grip g has a limit and a weight p: the smallest
/// sum of p (t/limit)^2. Where each weight is multiplied by the share of its grip, round by round, the largest share
/// falls to the least that there is (Lawson).
class Balance {
 public:
  Balance(const RestMatrices& A, const VecX& r, std::vector<GripOf> grips)
      : grips_(std::move(grips)), parts_(grips_.size(), 1.0) {
    const auto in_motions = [&](const VecX& f) { return VecX(A.N.transpose() * A.at.forces_in(f)); };
    for (std::size_t g = 0; g < grips_.size(); ++g) {
      for (const VecX& one : grips_[g].grip.along) along_.push_back(&one), of_.push_back(g);
      grips_[g].grip.most = 1;  // an unbalanced load presses nothing together: a falling clamp has no friction
    }
    B_.resize(A.N.cols(), static_cast<Eigen::Index>(along_.size()));
    for (std::size_t k = 0; k < along_.size(); ++k) {
      auto column = B_.col(static_cast<Eigen::Index>(k));
      column = in_motions(*along_[k]);
      if (column.norm() <= kNegligible * A.at.forces_in(*along_[k]).norm()) column.setZero();  // as at a dead centre
    }
    b_ = -in_motions(r);
  }

  const std::vector<GripOf>& grips() const { return grips_; }
  /// Finds t. False: none balances the forces.
  bool solve() {
    VecX scale(B_.cols());
    for (Eigen::Index k = 0; k < scale.size(); ++k) scale[k] = grip_of(k).most / std::sqrt(parts_[of_[k]]);
    t_ = scale.asDiagonal() * MatX(B_ * scale.asDiagonal()).completeOrthogonalDecomposition().solve(b_);
    return (B_ * t_ - b_).norm() <= kNegligible * b_.norm();
  }
  /// 6 per slot.
  VecX load() const {
    VecX f = VecX::Zero(along_.front()->size());
    for (std::size_t k = 0; k < along_.size(); ++k) f += t_[static_cast<Eigen::Index>(k)] * *along_[k];
    return f;
  }
  /// The size of the load of a grip.
  double carries(std::size_t g) const {
    double square = 0;
    for (std::size_t k = 0; k < of_.size(); ++k)
      if (of_[k] == g) square += t_[static_cast<Eigen::Index>(k)] * t_[static_cast<Eigen::Index>(k)];
    return std::sqrt(square);
  }
  /// The share of its limit, at the limits that the reactions give.
  double share(std::size_t g) const {
    const double most = grips_[g].grip.most, now = carries(g);
    return now == 0 ? 0 : most > 0 ? now / most : std::numeric_limits<double>::infinity();
  }
  void take_limits(const std::vector<GripOf>& now) {
    for (std::size_t g = 0; g < grips_.size() && g < now.size(); ++g) grips_[g].grip.most = now[g].grip.most;
  }
  void weigh() {
    double most = 0;
    for (std::size_t g = 0; g < parts_.size(); ++g)
      if (std::isfinite(share(g))) parts_[g] *= share(g), most = std::max(most, parts_[g]);
    for (double& part : parts_) part = std::max(most > 0 ? part / most : 1.0, kRoundOff);
  }
  /// What no friction with a limit above zero acts on.
  MatX ungripped(const MatX& N) const {
    MatX acting = B_;
    for (Eigen::Index k = 0; k < B_.cols(); ++k)
      if (!(grip_of(k).most > 0)) acting.col(k).setZero();
    return N * RowSpace(SparseMat(acting.sparseView())).free();
  }

 private:
  const Grip& grip_of(Eigen::Index k) const { return grips_[of_[k]].grip; }

  std::vector<GripOf> grips_;
  std::vector<double> parts_;
  std::vector<const VecX*> along_;
  std::vector<std::size_t> of_;  // the grip of each direction
  MatX B_;
  VecX b_, t_;
};

std::vector<GripReport> report_of(const Balance& balance) {
  std::vector<GripReport> all;
  for (std::size_t g = 0; g < balance.grips().size(); ++g) {
    const GripOf& of = balance.grips()[g];
    all.push_back({of.force->name(), of.grip.what, of.grip.unit, balance.carries(g), of.grip.most});
  }
  return all;
}

}  // namespace

bool has_friction(const ForcesAtRest& now) {
  return !std::ranges::all_of(grips_at(*now.e, now.lambda), [](const GripOf& g) { return g.grip.along.empty(); });
}

FrictionLoad friction_load(Dynamics& dynamics, const ForcesAtRest& now, const RestMatrices& A) {
  FrictionLoad out;
  const Evaluation& e = *now.e;
  if (A.N.cols() == 0) return out;
  Balance balance(A, now.r, grips_at(e, now.lambda));
  Factor& factor = dynamics.factor(e);
  const VecX none = VecX::Zero(e.rows().n_rows);
  VecX a, added;
  double least = std::numeric_limits<double>::infinity(), before = least;
  for (int k = 0; k < kRounds; ++k) {
    if (!balance.solve()) return out;
    factor.solve(e, balance.load(), none, a, added);
    const VecX lambda = now.lambda + added;
    balance.take_limits(grips_at(e, lambda));
    double worst = 0;
    for (std::size_t g = 0; g < balance.grips().size(); ++g) worst = std::max(worst, balance.share(g));
    out.balances = true;
    if (worst < least || k == 0) least = worst, out.grips = report_of(balance), out.lambda = lambda;
    if (worst <= 1) {
      out.holds = true, out.ungripped = balance.ungripped(A.N);
      return out;
    }
    if (k == 0) continue;
    if (std::isfinite(worst) && std::abs(worst - before) <= kNegligible * worst) return out;
    before = worst;
    balance.weigh();
  }
  return out;
}

}  // namespace lockstep
