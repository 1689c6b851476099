// Stability of a position of rest: what holds the free motions.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/motion_words.h"
#include "framework/tools/analysis/rest_matrices.h"

namespace lockstep {
namespace {

constexpr int kMostUnknowns = 1200;
constexpr double kZeroStiffness = 1e-10;  // of the norm of K
constexpr double kNoPotential = 1e-6;     // of the norm of K: an unsymmetric part that rounding does not make

/// 6 per slot, of size 1 m; the largest turn, or where there is hardly one the largest move, is positive. y: in the basis
/// of the free motions.
VecX unit_motion(const RestMatrices& A, const System& system, const VecX& y) {
  constexpr double kHardly = 0.1;
  const VecX u = A.N * y;
  const auto largest = [&](bool turns) {
    double most = 0;
    for (std::size_t i = 0; i < A.at.size(); ++i)
      if (const double x = u[static_cast<Eigen::Index>(i)];
          (A.at[i] % 6 >= 3) == turns && std::abs(x) > (1 + 1e-9) * std::abs(most))
        most = x;
    return most;
  };
  const double turn = largest(true), move = largest(false);
  const bool positive = (std::abs(turn) >= kHardly * std::abs(move) ? turn : move) >= 0;
  const VecX out = motion_of(system, A.at, u);
  return (positive ? 1 : -1) / motion_size(system, out) * out;
}

void sort_motion(Stability& s, const System& system, const Inputs& in, double stiffness, bool grows, VecX motion) {
  if (!grows && stiffness > s.bound) {
    s.softest = s.softest > 0 ? std::min(s.softest, stiffness) : stiffness;
    return;
  }
  FreeMotion found{stiffness, std::move(motion), ""};
  found.words = motion_words(system, in, found.motion);
  (grows ? s.unstable : s.neutral).push_back(std::move(found));
}

}  // namespace

std::string to_string(Stability::Kind kind) {
  constexpr const char* kWords[] = {"stable", "neutral", "unstable", "not judged"};
  return kWords[static_cast<int>(kind)];
}

Stability judge_rest(const Evaluation& e, const VecX& lambda) {
  const System& system = e.system();
  Stability out;
  if (system.n_velocities() > kMostUnknowns) {
    out.kind = Stability::Kind::not_judged;
    return out;
  }
  const RestMatrices A(e, lambda);
  out.freedoms = static_cast<int>(A.N.cols());
  if (out.freedoms == 0) return out;
  const MatX M = A.N.transpose() * A.M * A.N, K = A.N.transpose() * A.K * A.N;
  // The norm of M^-1/2 K M^-1/2 in all unknowns, of which rounding leaves its share in the null space.
  const MatX L = A.M.llt().matrixL();
  const MatX half = L.triangularView<Eigen::Lower>().solve(A.K);
  const MatX whole = L.triangularView<Eigen::Lower>().solve(half.transpose());
  out.bound = kZeroStiffness * whole.norm();
  const double unsymmetric = (K - K.transpose()).norm();
  out.has_potential = unsymmetric <= kNoPotential * A.K.norm();
  const Inputs& in = e.inputs();
  if (out.has_potential) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(0.5 * (K + K.transpose()), M);
    for (Eigen::Index i = 0; i < eigen.eigenvalues().size(); ++i) {
      const double mu = eigen.eigenvalues()[i];
      sort_motion(out, system, in, mu, mu < -out.bound, unit_motion(A, system, eigen.eigenvectors().col(i)));
    }
  } else {  // x'' = -mu x grows for every mu that is not real and positive
    const Eigen::EigenSolver<MatX> eigen(M.ldlt().solve(K));
    for (Eigen::Index i = 0; i < eigen.eigenvalues().size(); ++i) {
      const std::complex<double> mu = eigen.eigenvalues()[i];
      const bool flutters = std::abs(mu.imag()) > std::sqrt(out.bound * whole.norm());
      sort_motion(out, system, in, mu.real(), mu.real() < -out.bound || flutters,
                  unit_motion(A, system, eigen.eigenvectors().col(i).real()));
    }
  }
  std::ranges::sort(out.unstable, {}, &FreeMotion::stiffness);
  out.kind = !out.unstable.empty()  ? Stability::Kind::unstable
             : !out.neutral.empty() ? Stability::Kind::neutral
                                    : Stability::Kind::stable;
  return out;
}

}  // namespace lockstep
