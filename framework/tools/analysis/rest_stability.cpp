// SPDX-License-Identifier: BSD-3-Clause
// Stability of a position of rest: what holds the free motions.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>

#include <lockstep/detail/newton.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/mechanism_matrices.h"
#include "framework/tools/analysis/rest_matrices.h"
#include "framework/tools/analysis/spectrum.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {

// An eigenvector of a level errs by round-off of the stiffest motion over the distance to it, which adds the square of
// that to u^T K u.
ModalBasis::ModalBasis(const SparseMat& M, const SparseMat& of, const SparseMat& size_K, const MatX& N)
    : U(N.rows(), N.cols()) {
  Eigen::Index found = 0;
  for (MatX level = N; level.cols() > 0;) {
    const MatX K_level = level.transpose() * (of * level), M_level = level.transpose() * (M * level);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(0.5 * (K_level + K_level.transpose()), M_level);
    const VecX& mu = eigen.eigenvalues();
    const MatX motions = level * eigen.eigenvectors();
    const double soft = kSlight * mu.cwiseAbs().maxCoeff();
    bool zero = true;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      zero = zero && std::abs(mu[i]) <= kRoundOff * terms_of(size_K, motions.col(i));
    std::vector<Eigen::Index> again;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      if (!zero && std::abs(mu[i]) < soft)
        again.push_back(i);
      else
        U.col(found++) = motions.col(i);
    level = motions(Eigen::all, again).eval();
  }
  K = U.transpose() * (of * U), terms = U.cwiseAbs().transpose() * (size_K * U.cwiseAbs());
  has_potential = ((K - K.transpose()).cwiseAbs().array() <= kSlight * (terms + terms.transpose()).array()).all();
}

RestMatrices::RestMatrices(const Evaluation& e, const VecX& lambda) : at(e.system()), N(free_motions(e)) {
  const VecX turned = at.lengths().cwiseInverse();
  const auto in_lengths = [&](const SparseMat& A) { return scaled(turned, A, turned); };
  NewtonMatrix newton;
  newton.gather(e, lambda);
  M = in_lengths(mass_of(e.system(), at)), K = in_lengths(tangent_of(newton.tangents(), false, at));
  Vec6 turned_block = Vec6::Ones();
  turned_block.tail<3>() /= e.system().length();
  Triplets sizes;
  for (std::size_t p = 0; p < newton.tangents().pairs().size(); ++p) {
    const Mat6 block = turned_block.asDiagonal() * newton.tangents().K(p) * turned_block.asDiagonal();
    const auto [row, column] = newton.tangents().pairs()[p];
    at.add(row, column, Mat6::Constant(block.cwiseAbs().maxCoeff()), sizes);
  }
  const VecX loads = largest_loads(e, lambda);
  for (int i = 0; i < at.n(); ++i) sizes.emplace_back(i, i, loads[at.places()[i] / 6] / e.system().length());
  size_K = at.square(sizes);
}

namespace {

// Of the norm of K: round-off of the eigenvalues of an unsymmetric matrix.
constexpr double kSolver = 50 * std::numeric_limits<double>::epsilon();

/// 6 per slot, of size 1 m; the largest turn, or where there is hardly one the largest move, is positive. u: in the
/// unknowns.
VecX unit_motion(const RestMatrices& A, const System& system, const VecX& u) {
  const auto largest = [&](bool turns) {
    double most = 0;
    for (Eigen::Index i = 0; i < u.size(); ++i)
      if ((A.at.places()[i] % 6 >= 3) == turns && std::abs(u[i]) > kLarger * std::abs(most)) most = u[i];
    return most;
  };
  const double turn = largest(true), move = largest(false);
  const bool positive = (std::abs(turn) >= kNotable * std::abs(move) ? turn : move) >= 0;
  const VecX out = A.at.motion_of(u);
  return (positive ? 1 : -1) / motion_size(system, out) * out;
}

}  // namespace

std::string to_string(Stability::Kind kind) {
  constexpr const char* kWords[] = {"stable", "neutral", "unstable", "not judged", "sticking"};
  return kWords[static_cast<int>(kind)];
}

Stability judge_rest(const Evaluation& e, const VecX& lambda) {
  if (e.system().n_velocities() > kDenseUnknowns) return {.kind = Stability::Kind::not_judged};
  return judge_motions(e, RestMatrices(e, lambda));
}

// x'' = -mu x grows for every mu that is not real and positive.
Stability judge_motions(const Evaluation& e, const RestMatrices& A) {
  const System& system = e.system();
  Stability out;
  out.freedoms = static_cast<int>(A.N.cols());
  if (out.freedoms == 0) return out;
  const ModalBasis own = A.modal_basis();
  out.has_potential = own.has_potential;
  Eigen::VectorXcd mu = own.K.diagonal().cast<std::complex<double>>();
  Eigen::MatrixXcd motions = own.U.cast<std::complex<double>>();
  double solver = 0;
  if (!out.has_potential) {
    const Eigenvectors of = eigenvectors(own.K);
    mu = of.values, motions *= of.vectors, solver = kSolver * own.K.norm();
  }
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const VecX re = motions.col(i).real(), im = motions.col(i).imag();
    const double mass = re.dot(A.M * re) + im.dot(A.M * im),
                 terms = terms_of(A.size_K, motions.col(i).cwiseAbs()) / mass;
    const double stiffness = mu[i].real(), bound = kRoundOff * terms + solver;
    const bool grows =
        stiffness < -bound || std::abs(mu[i].imag()) > std::sqrt(terms * (kSlight * kSlight * terms + solver));
    if (!grows && stiffness > bound) {
      out.softest = out.softest > 0 ? std::min(out.softest, stiffness) : stiffness;
      continue;
    }
    FreeMotion found{stiffness, bound, unit_motion(A, system, re), ""};
    found.words = motion_words(system, e.inputs(), found.motion);
    (grows ? out.unstable : out.neutral).push_back(std::move(found));
  }
  std::ranges::sort(out.unstable, {}, &FreeMotion::stiffness);
  if (!out.unstable.empty()) out.softest = out.unstable.front().stiffness;
  std::ranges::stable_sort(out.neutral, {}, &FreeMotion::stiffness);
  out.kind = !out.unstable.empty()  ? Stability::Kind::unstable
             : !out.neutral.empty() ? Stability::Kind::neutral
                                    : Stability::Kind::stable;
  return out;
}

}  // namespace lockstep
