// Conjugate gradients, for what the proximal iteration leaves where bodies differ much in mass.
#pragma once

#include <Eigen/Core>

#include <lockstep/body.h>

namespace lockstep {

/// Solves S lambda = b, S = J M^-1 J^T, with S + E factored. A correction by (S + E)^-1 leaves E/(S + E) of an error:
/// little, unless S is small in a direction without being zero, as where a heavy body hangs on light ones. There are
/// few such directions, and conjugate gradients preconditioned by S + E take about one iteration for each:
///
///   z = (S + E)^-1 r,   p = z + (r . z)/(r . z)_before p,   lambda += (r . z)/(p . S p) p
///
/// Redundant directions, where S is zero, stay as they are. Off the constraints redundant rows are only nearly so, and to
/// meet them would be wrong: S is small there without a reason. So the directions that are solved for are those which
/// the masses explain.
class ConjugateGradients {
 public:
  static constexpr int kMost = 40;  ///< iterations

  void size(int n_rows) {
    for (VecX* v : {&r_, &z_, &p_, &q_, &way_}) v->setZero(n_rows);
  }
  /// Sets what is solved for: `eps`: E relative to S; `spread`: mass of the lightest body over that of the heaviest.
  void set(double eps, double spread) { longest_ = 1 + eps / (kShare * spread); }
  /// Whether corrections alone do not suffice.
  bool needed() const { return longest_ > 1 + kSlow; }
  /// From the present solution: residual(r) writes its residual, solve(r, z) z, step(p, length) moves the solution by
  /// length p and measures it, worst() is its largest residual in units of what is met. Ends where that is 1 or less;
  /// otherwise false, and the solution is not worse than before.
  template <class Residual, class Solve, class Step, class Worst>
  bool iterate(int& corrections, Residual&& residual, Solve&& solve, Step&& step, Worst&& worst) {
    const double at_first = worst();
    double before = 0, now = at_first;
    way_.setZero();
    for (int i = 0; i < kMost && now > 1; ++i, ++corrections) {
      residual(r_);
      solve(r_, z_);
      const double rz = r_.dot(z_);
      p_ = i > 0 ? z_ + rz / before * p_ : z_;
      before = rz;
      step(p_, 1.0);
      residual(q_);
      q_ = r_ - q_;  // S p
      const double length = rz / p_.dot(q_);
      if (!(length > 0) || !(length < longest_)) {
        step(p_, -1.0);
        break;
      }
      step(p_, length - 1.0);
      way_ += length * p_;
      now = worst();
    }
    if (now <= 1) return true;
    if (!(now <= at_first)) step(way_, -1.0);
    return false;
  }

 private:
  static constexpr double kShare = 1e-3;  // of `spread`: S is not less of its usual size, away from singular positions
  static constexpr double kSlow = 1e-3;   // a correction that leaves less of an error is fast enough
  double longest_ = 1;                    // (S + E)/S
  VecX r_, z_, p_, q_, way_;
};

}  // namespace lockstep
