// SPDX-License-Identifier: BSD-3-Clause
// Conjugate gradients, for what the proximal iteration leaves where S is small in a direction without being zero.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include <lockstep/body.h>

namespace lockstep {

/// Solves S lambda = b, S = J M^-1 J^T, with S + E factored. A correction by (S + E)^-1 leaves E/(S + E) of an error:
/// little, unless S is small in a direction without being zero, as where a heavy body hangs on light ones, or along a lift
/// of many cells. There are few such directions, and conjugate gradients preconditioned by S + E take about one iteration for each:
///
///   z = (S + E)^-1 r,   p = z + (r . z)/(r . z)_before p,   lambda += (r . z)/(p . S p) p
///
/// Redundant directions, where S is zero, stay as they are. Off the constraints redundant rows contradict one another a
/// little, and meeting them would take huge multipliers. So the directions that are solved for are those of which the first
/// solution has at least a half, S >= E, and those which differences of mass explain. Of factors that answer -(S + E)^-1 r both signs are turned, which leaves the steps as they are.
class ConjugateGradients {
 public:
  static constexpr int kMost = 40;  ///< iterations, and one more a row

  void size(int n_rows) {
    for (VecX* v : {&r_, &z_, &p_, &q_, &way_, &best_way_, &back_}) v->setZero(n_rows);
  }
  /// Sets what is solved for: `eps`: E relative to S; `spread`: mass of the lightest body over that of the heaviest.
  void set(double eps, double spread) { left_ = eps / (kShare * spread), longest_ = 1 + std::max(left_, 1.0); }
  /// Whether bodies differ so much in mass that corrections alone do not suffice.
  bool needed() const { return left_ > kSlow; }
  /// From the present solution: residual(r) writes its residual, solve(r, z) z, step(p, length) moves the solution by
  /// length p and measures it, worst() is its largest residual in units of what is met. Ends where that is 1 or less;
  /// otherwise false, and the solution is the best that was found.
  template <class Residual, class Solve, class Step, class Worst>
  bool iterate(int& corrections, Residual&& residual, Solve&& solve, Step&& step, Worst&& worst) {
    double best = worst(), now = best, before = 0;
    way_.setZero(), best_way_.setZero();
    refused_ = false;
    const Eigen::Index most = kMost + r_.size();
    for (Eigen::Index i = 0, idle = 0; i < most && idle < kIdle && best > 1; ++i, ++corrections) {
      residual(r_);
      solve(r_, z_);
      const double rz = r_.dot(z_);
      if (!std::isfinite(rz)) break;
      if (i == 0 || idle > 0) p_.setZero();  // round-off spoils directions: begin again where one brought nothing
      p_ = z_ + (i == 0 ? 0.0 : rz / before) * p_;
      before = rz;
      step(p_, 1.0);
      residual(q_);
      q_ = r_ - q_;  // S p
      const double length = rz / p_.dot(q_);
      refused_ = !(length > 0) || !(length < longest_);
      if (refused_) {
        step(p_, -1.0);
        break;
      }
      step(p_, length - 1.0);
      way_ += length * p_;
      now = worst();
      idle = now < best ? 0 : idle + 1;
      if (idle == 0) best = now, best_way_ = way_;
      if (!(now < kLost * best)) break;
    }
    if (way_ != best_way_) back_ = best_way_ - way_, step(back_, 1.0);
    return best <= 1;
  }
  /// Whether the last call came to a direction that is not solved for: rows that depend on others, and that
  /// may contradict them.
  bool refused() const { return refused_; }

 private:
  static constexpr double kShare = 1e-3;  // of `spread`: S is not less of its usual size, away from singular positions
  static constexpr Eigen::Index kIdle = 4;  // iterations that bring nothing
  static constexpr double kLost = 1e3;      // of the best residual: what has grown more can't be taken back exactly
  static constexpr double kSlow = 1e-3;     // a correction that leaves less of an error is fast enough
  double left_ = 0;                         // E/S in such a direction
  double longest_ = 2;                      // (S + E)/S
  bool refused_ = false;
  VecX r_, z_, p_, q_, way_, best_way_, back_;
};

}  // namespace lockstep
