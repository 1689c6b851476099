// SPDX-License-Identifier: BSD-3-Clause
// NewtonFactor: one factor of an implicit method's matrix, real or complex, and its solutions. Internal to
// NewtonMatrix.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <lockstep/author/solver.h>
#include <lockstep/body.h>
#include <lockstep/detail/rows.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/block_factor.h"
#include "framework/dynamics/solvers/block_kernels.h"
#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/math/decompositions.h"

namespace lockstep {

/// What the factors are computed from: the layout of the mechanism and the numbers gathered last.
struct NewtonNumbers {
  TangentSum tangents;
  std::vector<BodyMass> mass;     // of each slot
  std::vector<int> width, first;  // of each slot: unknowns and the first of them
  std::vector<RowEntry> entries;  // as laid out
  std::vector<double> J;          // 6 per slot and row, entry by entry
  VecX s;                         // scale of each row, for the proximal term
  double enough = kRowTolerance;  // relative residual that needs no correction
  double length = 1;              // of the mechanism, m
  std::array<int, 6> velocity{};  // which of a slot's six velocities each unknown is; in a plane there are three
  int n = 0, m = 0;
  BlockPlan plan;
  std::vector<BlockPlan::Place> pairs, row_places,
      proximal;  // of tangents' pairs; of entries and their slots; of entries

  /// visit(row, slot, its six numbers) for the rows J, in their order.
  template <class Visit>
  void for_each_row(const std::vector<double>& numbers, Visit&& visit) const {
    const double* r = numbers.data();
    for (const RowEntry& e : entries)
      for (int i = 0; i < e.slots.n; ++i)
        for (int k = 0; k < e.m; ++k, r += 6) visit(e.first_row + k, e.slots[i], r);
  }
};

/// visit(unknown, unit) for the five units: translations, rotations, and multipliers of the three kinds of rows. The
/// equations have the same units.
template <class Visit>
void for_each_unknown(const NewtonNumbers& N, Visit&& visit) {
  for (std::size_t k = 0; k < N.width.size(); ++k)
    for (int j = 0; j < N.width[k]; ++j) visit(N.first[k] + j, N.velocity[j] < 3 ? 0u : 1u);
  for (const RowEntry& e : N.entries)
    for (int k = 0; k < e.m; ++k) visit(N.n + e.first_row + k, 2u + static_cast<unsigned>(e.kind[k]));
}

template <class T>
class NewtonFactor {
 public:
  using Vec = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  void lay_out(const NewtonNumbers& N) {
    A_.assign(N.tangents.pairs().size(), Mat6T::Zero());
    J_.assign(N.J.size(), 0.0);
    E_.setZero(N.m);
    blocks_.lay_out(N.plan);
    for (Vec* v : {&b_, &x_, &d_}) v->setZero(N.n + N.m);
    for (VecX* v : {&size_, &size_x_}) v->setZero(N.n + N.m);
  }

  /// Throws SolveError when the matrix is singular.
  void factor(const NewtonNumbers& N, T a, T b, T c) {
    if (A_.size() != N.tangents.pairs().size() || J_.size() != N.J.size() || E_.size() != N.m) lay_out(N);
    for (std::size_t p = 0; p < A_.size(); ++p) {
      const auto [row, column] = N.tangents.pairs()[p];
      Mat6T A = b * N.tangents.D(p) + c * N.tangents.K(p);
      if (row == column) {
        const auto k = static_cast<std::size_t>(row);
        A.diagonal().template head<3>().array() += a * N.mass[k].m();
        A.template bottomRightCorner<3, 3>() += a * N.mass[k].J();
      }
      for (int i = 0; i < N.width[row]; ++i)
        for (int j = 0; j < N.width[column]; ++j) A_[p](i, j) = A(N.velocity[i], N.velocity[j]);
    }
    double* J = J_.data();
    N.for_each_row(N.J, [&](int, int slot, const double* r) {
      for (int j = 0; j < N.width[slot]; ++j) J[j] = r[N.velocity[j]];
      J += 6;
    });
    // Where the mass dominates, the Schur complement of the rows is s/a; so the proximal term is scaled alike
    // (framework/docs/solvers.md, section 5).
    E_ = N.plan.proximal() / (std::abs(a) > 0 ? std::abs(a) : 1.0) * N.s;

    fill(N);
    is_dense_ = !blocks_.factor(N.plan);
    if (is_dense_) factor_dense(N);
  }

  SolveReport solve(const NewtonNumbers& N, const Vec& f, const Vec& r, Vec& x, Vec& l) {
    SolveReport report;
    const auto for_each_velocity = [&](auto&& visit) {  // visit(unknown, its index among six per slot)
      for (std::size_t k = 0; k < N.width.size(); ++k)
        for (int j = 0; j < N.width[k]; ++j) visit(N.first[k] + j, 6 * static_cast<int>(k) + N.velocity[j]);
    };
    for_each_velocity([&](int i, int at) { b_[i] = f[at]; });
    b_.tail(N.m) = r;
    x_.setZero();
    d_ = b_;
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0;; ++round) {
      add_correction(N);
      const Residual now = measure(N);
      report.residual = now.largest, report.worst_row = now.worst_row, report.corrections = round;
      if (now.largest <= N.enough || round == kMaxCorrections || !(now.largest <= kFalling * before)) break;
      before = now.largest;
    }
    report.contradictory = report.residual > kContradiction;
    x.setZero(6 * static_cast<int>(N.width.size()));
    for_each_velocity([&](int i, int at) { x[at] = x_[i]; });
    l = x_.tail(N.m);
    return report;
  }

 private:
  using Mat6T = Eigen::Matrix<T, 6, 6>;
  using Mat = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  struct Residual {
    double largest = 0;
    int worst_row = -1;
  };

  // The same equations in real numbers: of A + iB those of (A -B; B A).
  static MatX&& real_of(MatX&& A) { return std::move(A); }
  static MatX real_of(Eigen::MatrixXcd&& A) {
    MatX both(2 * A.rows(), 2 * A.cols());
    both << A.real(), -A.imag(), A.imag(), A.real();
    return both;
  }
  static VecX solution(const PivotedLu& lu, const VecX& b) { return lu.solution(b); }
  static Eigen::VectorXcd solution(const PivotedLu& lu, const Eigen::VectorXcd& b) {
    VecX both(2 * b.size());
    both << b.real(), b.imag();
    both = lu.solution(std::move(both));
    Eigen::VectorXcd x(b.size());
    x.real() = both.head(b.size()), x.imag() = both.tail(b.size());
    return x;
  }

  void fill(const NewtonNumbers& N) {
    blocks_.clear();
    for (std::size_t p = 0; p < A_.size(); ++p) {
      const int n_rows = N.width[N.tangents.pairs()[p].row], n_columns = N.width[N.tangents.pairs()[p].column];
      T* out = blocks_.at(N.pairs[p].at);
      for (int i = 0; i < n_rows; ++i)
        for (int j = 0; j < n_columns; ++j)
          out[N.pairs[p].transposed ? j * n_rows + i : i * n_columns + j] = A_[p](i, j);
    }
    // A link's Jacobian J and its transpose J^T, which is stored as J: both have the shape of the block above the
    // diagonal.
    const double* J = J_.data();
    const BlockPlan::Place* place = N.row_places.data();
    for (const RowEntry& e : N.entries)
      for (int i = 0; i < e.slots.n; ++i, J += 6 * e.m, ++place) {
        const int width = N.width[e.slots[i]];
        T *U = blocks_.at(place->at), *L = U + e.m * width;
        for (int k = 0; k < e.m; ++k)
          for (int j = 0; j < width; ++j) {
            const int at = place->transposed ? j * e.m + k : k * width + j;
            U[at] = L[at] = J[6 * k + j];
          }
      }
    place = N.proximal.data();
    for (const RowEntry& e : N.entries) {
      T* D = blocks_.at(place++->at);
      for (int k = 0; k < e.m; ++k) D[k * (e.m + 1)] = -E_[e.first_row + k];
    }
  }

  /// Dense, with pivots anywhere: for poses where a body's own block has none, as in statics, which leaves M out.
  void factor_dense(const NewtonNumbers& N) {
    constexpr int kLargest = 3000;
    if (N.n + N.m > kLargest)
      throw SolveError("the matrix of the implicit step has a singular block of a body, and " +
                       std::to_string(N.n + N.m) + " unknowns are too many for a dense solution; reduce the step");
    Mat A = Mat::Zero(N.n + N.m, N.n + N.m);
    for (std::size_t p = 0; p < A_.size(); ++p) {
      const std::size_t row = N.tangents.pairs()[p].row, column = N.tangents.pairs()[p].column;
      A.block(N.first[row], N.first[column], N.width[row], N.width[column]) =
          A_[p].topLeftCorner(N.width[row], N.width[column]);
    }
    N.for_each_row(J_, [&](int row, int slot, const double* r) {
      const auto k = static_cast<std::size_t>(slot);
      for (int j = 0; j < N.width[k]; ++j) A(N.n + row, N.first[k] + j) = A(N.first[k] + j, N.n + row) = r[j];
    });
    A.diagonal().tail(N.m) = (-E_).template cast<T>();
    if (!dense_.compute(real_of(std::move(A))))
      throw SolveError("the matrix of the implicit step is singular or not finite; reduce the step");
  }

  void add_correction(const NewtonNumbers& N) {
    if (is_dense_)
      d_ = solution(dense_, d_);
    else
      blocks_.solve(N.plan, d_.data());
    x_ += d_;
  }

  /// d = b - A x without the proximal term, and its largest component relative to the terms of its equation. An equation
  /// whose terms happen to be small (directions in which a flat mechanism does not move) is measured by kScaleFloor of what they
  /// would be with the largest unknown. Unknowns are compared as lengths, multipliers as forces.
  Residual measure(const NewtonNumbers& N) {
    using block_detail::size_of, block_detail::times;
    std::array<double, 5> in_metres{1, N.length};  // of a unit; of multipliers: newtons
    for (unsigned kind = 0; kind < 3; ++kind)
      in_metres[2 + kind] = 1 / length_per_unit(static_cast<RowKind>(kind), N.length);
    std::array<double, 2> most{};
    for_each_unknown(
        N, [&](int i, unsigned unit) { most[unit > 1] = std::max(most[unit > 1], in_metres[unit] * size_of(x_[i])); });
    for_each_unknown(N, [&](int i, unsigned unit) {
      size_x_[i] = std::max(size_of(x_[i]), kScaleFloor * most[unit > 1] / in_metres[unit]);
    });
    d_ = b_;
    size_ = b_.cwiseAbs();
    for (std::size_t p = 0; p < A_.size(); ++p) {
      const std::size_t row = N.tangents.pairs()[p].row, column = N.tangents.pairs()[p].column;
      const int i = N.first[row], j = N.first[column];
      for_size(N.width[row], [&]<int kI>(std::integral_constant<int, kI>) {
        T sum[kI] = {};
        double sizes[kI] = {};
        for (int c = 0; c < N.width[column]; ++c) {
          const T* A = A_[p].data() + 6 * c;
          for (int r = 0; r < kI; ++r) sum[r] += times(A[r], x_[j + c]), sizes[r] += size_of(A[r]) * size_x_[j + c];
        }
        for (int r = 0; r < kI; ++r) d_[i + r] -= sum[r], size_[i + r] += sizes[r];
      });
    }
    N.for_each_row(J_, [&](int row, int slot, const double* r) {
      const auto k = static_cast<std::size_t>(slot);
      const int i = N.n + row, j = N.first[k];
      const T l = x_[i];
      const double size_l = size_x_[i];
      T sum(0);
      double sizes = 0;
      for (int c = 0; c < N.width[k]; ++c) {
        const double size = std::abs(r[c]);
        sum += times(r[c], x_[j + c]), sizes += size * size_x_[j + c];
        d_[j + c] -= times(r[c], l), size_[j + c] += size * size_l;
      }
      d_[i] -= sum, size_[i] += sizes;
    });

    Residual worst;
    double worst_row = 0;
    for (int i = 0; i < N.n + N.m; ++i) {
      const double d = size_of(d_[i]), relative = d == 0 ? 0.0 : d / size_[i];
      if (relative > worst.largest || std::isnan(relative)) worst.largest = relative;
      if (i >= N.n && relative > worst_row) worst_row = relative, worst.worst_row = i - N.n;
    }
    return worst;
  }

  // The matrix that was factored: a M + b D + c K by pairs, J, and the proximal term. The unknowns come first among the
  // six rows and columns.
  std::vector<Mat6T> A_;
  std::vector<double> J_;
  VecX E_;

  BlockFactor<T> blocks_;
  PivotedLu dense_;
  bool is_dense_ = false;
  Vec b_, x_, d_;
  VecX size_, size_x_;  // of the terms of each equation; of each unknown
};

}  // namespace lockstep
