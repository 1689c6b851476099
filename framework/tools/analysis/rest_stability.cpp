// Stability of a position of rest: what holds the free motions.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include <lockstep/newton.h>
#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/motion_words.h"

namespace lockstep {
namespace {

constexpr int kMostUnknowns = 1200;
constexpr double kZeroStiffness = 1e-10;  // of the norm of K
constexpr double kNoPotential = 1e-6;     // of the norm of K: an unsymmetric part that rounding does not make

/// M, K and the basis of the free motions, in the unknowns of the mechanism with rotations as lengths.
struct RestMatrices {
  std::vector<int> at;  // of each unknown: its number among 6 per slot
  MatX M, K, N;

  RestMatrices(const Evaluation& e, const VecX& lambda) {
    const System& system = e.system();
    at = unknowns_of(system);
    std::vector<int> unknown(static_cast<std::size_t>(6 * system.n_slots()), -1);
    for (std::size_t i = 0; i < at.size(); ++i) unknown[static_cast<std::size_t>(at[i])] = static_cast<int>(i);
    const auto n = static_cast<Eigen::Index>(at.size());
    // u = place / length for turns: K_u = S K S with S = 1/length there.
    const auto scale = [&](int place) { return place % 6 < 3 ? 1.0 : 1.0 / system.length(); };
    M = MatX::Zero(n, n), K = MatX::Zero(n, n);
    const auto add = [&](MatX& to, int row_slot, int column_slot, const Mat6& block) {
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
          const int r = 6 * row_slot + i, c = 6 * column_slot + j;
          const int ur = unknown[static_cast<std::size_t>(r)], uc = unknown[static_cast<std::size_t>(c)];
          if (ur >= 0 && uc >= 0) to(ur, uc) += scale(r) * scale(c) * block(i, j);
        }
    };
    NewtonMatrix newton;
    newton.gather(e, lambda);
    const TangentSum& tangents = newton.tangents();
    for (std::size_t p = 0; p < tangents.pairs().size(); ++p)
      add(K, tangents.pairs()[p].row, tangents.pairs()[p].column, tangents.K(p));
    for (int k = 0; k < system.n_slots(); ++k) {
      Mat6 mass = Mat6::Zero();
      mass.topLeftCorner<3, 3>() = system.slot(k).mass * Mat3::Identity();
      mass.bottomRightCorner<3, 3>() = system.slot(k).J;
      add(M, k, k, mass);
    }

    N = free_motions(e, at);
  }

  /// 6 per slot, of size 1 m; its largest component is positive.
  VecX motion(const System& system, const VecX& y) const {
    const VecX u = N * y;
    const VecX out = motion_of(system, at, u);
    Eigen::Index largest = 0;
    u.cwiseAbs().maxCoeff(&largest);
    return out / ((u[largest] < 0 ? -1 : 1) * motion_size(system, out));
  }
};

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
      sort_motion(out, system, in, mu, mu < -out.bound, A.motion(system, eigen.eigenvectors().col(i)));
    }
  } else {  // x'' = -mu x grows for every mu that is not real and positive
    const Eigen::EigenSolver<MatX> eigen(M.ldlt().solve(K));
    for (Eigen::Index i = 0; i < eigen.eigenvalues().size(); ++i) {
      const std::complex<double> mu = eigen.eigenvalues()[i];
      const bool flutters = std::abs(mu.imag()) > std::sqrt(out.bound * whole.norm());
      sort_motion(out, system, in, mu.real(), mu.real() < -out.bound || flutters,
                  A.motion(system, eigen.eigenvectors().col(i).real()));
    }
  }
  std::ranges::sort(out.unstable, {}, &FreeMotion::stiffness);
  out.kind = !out.unstable.empty()  ? Stability::Kind::unstable
             : !out.neutral.empty() ? Stability::Kind::neutral
                                    : Stability::Kind::stable;
  return out;
}

}  // namespace lockstep
