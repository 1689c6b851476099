// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Random saddle-point systems with chosen topology, and their exact solution by other means than the solvers'.

#include <random>

#include <lockstep/author/solver.h>

namespace lockstep::test {

/// A system with both right sides.
struct KktSystem {
  Kkt kkt;
  VecX f, c;

  MatX M() const;  ///< n x n
  MatX J() const;  ///< m x n
  void write_J(const MatX&);
};

using RowKinds = std::vector<RowKind>;
RowKinds rows_of(int n_translation, int n_rotation, int n_function = 0);

/// Slots, then links, then finish(): random masses, jacobians, f; c = J a for some random a, so that the rows agree
/// however many they are.
class KktBuilder {
 public:
  explicit KktBuilder(unsigned seed) : random_(seed) {}

  int slot(int width = 6);
  /// Returns the position in KktPattern::links.
  std::size_t link(const std::vector<int>& slots, const RowKinds& kinds);
  /// The row e . e = 1 of a slot of width 7.
  void unit_length_row(int slot) { out_.kkt.pattern.links[link({slot}, rows_of(1, 0))].link = -1; }
  /// A second link over the same slots whose rows are combinations of the first one's.
  void doubled(std::size_t original);
  KktSystem finish();

  double number() { return normal_(random_); }
  MatX numbers(int n_rows, int n_columns);

 private:
  void fill_masses();
  KktSystem out_;
  std::vector<std::pair<std::size_t, std::size_t>> twins_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
};

/// The i-th of a list of shapes: chains, loops, stars, particles, wide slots, links on one or four slots, free slots.
inline constexpr int kShapes = 8;
KktSystem random_system(int shape, unsigned seed, bool redundant);

struct KktSolution {
  VecX a, lambda;
  int rank = 0;
};

/// By null space and complete orthogonal decomposition: a with J a = c that minimises (a - M^-1 f)^T M (a - M^-1 f),
/// then lambda with J^T lambda = f - M a of the smallest sum E_j lambda_j^2.
KktSolution solve_exactly(const KktSystem&);

/// |x - y| against |y|, largest components; 0 for empty vectors.
double difference(const VecX& x, const VecX& y);

}  // namespace lockstep::test
