// Stability of a position of rest: what holds the free motions.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <Eigen/Eigenvalues>

#include "framework/tools/analysis/limits.h"
#include "framework/tools/analysis/motion_words.h"
#include "framework/tools/analysis/rest_motions.h"

namespace lockstep {
namespace {

// Of the norm of K: round-off of the eigenvalues of an unsymmetric matrix.
constexpr double kSolver = 50 * std::numeric_limits<double>::epsilon();

/// 6 per slot, of size 1 m; the largest turn, or where there is hardly one the largest move, is positive. u: in the
/// unknowns.
VecX unit_motion(const RestMatrices& A, const System& system, const VecX& u) {
  const auto largest = [&](bool turns) {
    double most = 0;
    for (Eigen::Index i = 0; i < u.size(); ++i)
      if ((A.at.places()[static_cast<std::size_t>(i)] % 6 >= 3) == turns && std::abs(u[i]) > kLarger * std::abs(most))
        most = u[i];
    return most;
  };
  const double turn = largest(true), move = largest(false);
  const bool positive = (std::abs(turn) >= kNotable * std::abs(move) ? turn : move) >= 0;
  const VecX out = A.at.motion_of(u);
  return (positive ? 1 : -1) / motion_size(system, out) * out;
}

void sort_motion(Stability& s, const System& system, const Inputs& in, double stiffness, double bound, bool grows,
                 VecX motion) {
  if (!grows && stiffness > bound) {
    s.softest = s.softest > 0 ? std::min(s.softest, stiffness) : stiffness;
    return;
  }
  FreeMotion found{stiffness, bound, std::move(motion), ""};
  found.words = motion_words(system, in, found.motion);
  (grows ? s.unstable : s.neutral).push_back(std::move(found));
}

/// x'' = -mu x grows for every mu that is not real and positive.
void judge_without_potential(Stability& out, const Evaluation& e, const RestMatrices& A, const RestMotions& motions) {
  const MatX K = motions.U.transpose() * A.K * motions.U;
  const Eigen::EigenSolver<MatX> eigen(K);
  const double solver = kSolver * K.norm();
  for (Eigen::Index i = 0; i < K.cols(); ++i) {
    const std::complex<double> mu = eigen.eigenvalues()[i];
    const Eigen::VectorXcd u = motions.U.cast<std::complex<double>>() * eigen.eigenvectors().col(i);
    const VecX re = u.real(), im = u.imag(), sizes = u.cwiseAbs();
    const double mass = re.dot(A.M * re) + im.dot(A.M * im), terms = sizes.dot(A.size_K * sizes) / mass;
    const double bound = rest_round_off(A, sizes) / mass + solver;
    const bool flutters = std::abs(mu.imag()) > std::sqrt(terms * (kSlight * kSlight * terms + solver));
    sort_motion(out, e.system(), e.inputs(), mu.real(), bound, mu.real() < -bound || flutters,
                unit_motion(A, e.system(), re));
  }
}

}  // namespace

std::string to_string(Stability::Kind kind) {
  constexpr const char* kWords[] = {"stable", "neutral", "unstable", "not judged", "gripped"};
  return kWords[static_cast<int>(kind)];
}

Stability judge_rest(const Evaluation& e, const VecX& lambda) {
  const System& system = e.system();
  Stability out;
  if (system.n_velocities() > kDenseUnknowns) {
    out.kind = Stability::Kind::not_judged;
    return out;
  }
  return judge_motions(e, RestMatrices(e, lambda));
}

Stability judge_motions(const Evaluation& e, const RestMatrices& A) {
  const System& system = e.system();
  Stability out;
  out.freedoms = static_cast<int>(A.N.cols());
  if (out.freedoms == 0) return out;
  const RestMotions motions = rest_motions(A);
  out.has_potential = has_potential(A, motions);
  if (!out.has_potential) judge_without_potential(out, e, A, motions);
  for (Eigen::Index i = 0; out.has_potential && i < motions.stiffness.size(); ++i) {
    const double mu = motions.stiffness[i], bound = motions.bound[i];
    sort_motion(out, system, e.inputs(), mu, bound, mu < -bound, unit_motion(A, system, motions.U.col(i)));
  }
  std::ranges::sort(out.unstable, {}, &FreeMotion::stiffness);
  out.kind = !out.unstable.empty()  ? Stability::Kind::unstable
             : !out.neutral.empty() ? Stability::Kind::neutral
                                    : Stability::Kind::stable;
  return out;
}

}  // namespace lockstep
