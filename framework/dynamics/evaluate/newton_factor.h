// SPDX-License-Identifier: BSD-3-Clause
// NewtonFactor: one factor of an implicit method's matrix, real or complex, and its solutions. Internal to
// NewtonMatrix.
#pragma once

#include <array>
#include <vector>

#include <lockstep/author/solver.h>
#include <lockstep/body.h>
#include <lockstep/detail/rows.h>
#include "framework/dynamics/solvers/block_factor.h"
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

template <class T>
class NewtonFactor {
 public:
  using Vec = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  void lay_out(const NewtonNumbers&);
  /// Throws SolveError when the matrix is singular.
  void factor(const NewtonNumbers&, T a, T b, T c);
  SolveReport solve(const NewtonNumbers&, const Vec& f, const Vec& r, Vec& x, Vec& l);
  long n_dense() const { return n_dense_; }

 private:
  using Mat6T = Eigen::Matrix<T, 6, 6>;
  using Mat = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  struct Residual {
    double largest = 0;
    int worst_row = -1;
  };

  void fill(const NewtonNumbers&);
  void factor_dense(const NewtonNumbers&);
  void add_correction(const NewtonNumbers&);
  Residual measure(const NewtonNumbers&);

  // The matrix that was factored: a M + b D + c K by pairs, J, and the proximal term. The unknowns come first among the
  // six rows and columns.
  std::vector<Mat6T> A_;
  std::vector<double> J_;
  VecX E_;

  BlockFactor<T> blocks_;
  PivotedLu dense_;
  bool is_dense_ = false;
  long n_dense_ = 0;
  Vec b_, x_, d_;
  VecX size_, size_x_;  // of the terms of each equation; of each unknown
};

}  // namespace lockstep
