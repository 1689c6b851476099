// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/block_factor.h"

#include <random>

#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/dense.h"

namespace block_factor_test {

using namespace lockstep;

namespace {

using C = std::complex<double>;

/// Chain from the ground to the ground with particles, springs between next-but-one slots, and a link on four slots.
BlockGraph ladder(int n) {
  BlockGraph g;
  g.n_slots = n;
  int at = 0;
  const auto add = [&](int width) { g.width.push_back(width), g.first.push_back(at), at += width; };
  for (int k = 0; k < n; ++k) add(k % 3 == 1 ? 3 : 6);
  for (int k = 0; k <= n; ++k) {
    const int link = static_cast<int>(g.width.size());
    add(1 + k % 5);
    if (k > 0) g.edges.emplace_back(link, k - 1);
    if (k < n) g.edges.emplace_back(k, link);
  }
  for (int k = 0; k + 2 < n; k += 2) g.edges.emplace_back(k + 2, k);
  const int wide = static_cast<int>(g.width.size());
  add(8);
  for (int k = 0; k < 4; ++k) g.edges.emplace_back(wide, k);
  return g;
}

/// Bodies' blocks are definite or nearly, links' own blocks -1e-8.
struct TestMatrix {
  BlockGraph graph;
  Eigen::MatrixXcd A;

  TestMatrix(int n, bool symmetric, bool complex) : graph(ladder(n)) {
    std::mt19937 bits(7);
    std::normal_distribution<double> normal;
    const auto number = [&]() -> C { return {normal(bits), complex ? normal(bits) : 0.0}; };
    const int size = graph.first.back() + graph.width.back();
    A.setZero(size, size);
    const auto block = [&](int i, int j) {
      const auto r = static_cast<std::size_t>(i), c = static_cast<std::size_t>(j);
      return A.block(graph.first[r], graph.first[c], graph.width[r], graph.width[c]);
    };
    for (const auto& [i, j] : graph.edges) {
      const bool link = std::max(i, j) >= graph.n_slots;
      block(i, j) = (link ? 1.0 : 0.2) * Eigen::MatrixXcd::NullaryExpr(block(i, j).rows(), block(i, j).cols(), number);
      block(j, i) = block(i, j).transpose();
      if (!symmetric && !link) block(j, i) *= 0.7;
    }
    for (int k = 0; k < static_cast<int>(graph.width.size()); ++k) {
      const int w = graph.width[k];
      if (k >= graph.n_slots) {
        block(k, k).diagonal().setConstant(-1e-8);
        continue;
      }
      const Eigen::MatrixXcd R = 0.3 * Eigen::MatrixXcd::NullaryExpr(w, w, number);
      block(k, k) = symmetric ? Eigen::MatrixXcd(R * R.transpose()) : R;
      block(k, k).diagonal().array() += 4.0;
    }
  }
};

template <class T>
T number_of(const C& x) {
  if constexpr (std::is_same_v<T, double>)
    return x.real();
  else
    return x;
}

template <class T>
void fill(const TestMatrix& s, const BlockPlan& plan, BlockFactor<T>& factor) {
  factor.lay_out(plan);
  const auto write = [&](int i, int j) {
    const BlockPlan::Place place = plan.find(i, j);
    if (plan.symmetric && place.transposed) return;
    const auto r = static_cast<std::size_t>(i), c = static_cast<std::size_t>(j);
    const int n_r = s.graph.width[r], n_c = s.graph.width[c];
    for (int a = 0; a < n_r; ++a)
      for (int b = 0; b < n_c; ++b)
        factor.at(place.at)[place.transposed ? b * n_r + a : a * n_c + b] =
            number_of<T>(s.A(s.graph.first[r] + a, s.graph.first[c] + b));
  };
  for (int k = 0; k < static_cast<int>(s.graph.width.size()); ++k) write(k, k);
  for (const auto& [i, j] : s.graph.edges) write(i, j), write(j, i);
}

/// |A x - b| against |A| |x|.
template <class T>
double error_of(const TestMatrix& s, const BlockPlan& plan, const BlockFactor<T>& factor) {
  Eigen::Matrix<T, Eigen::Dynamic, 1> b(s.A.rows()), x;
  for (Eigen::Index k = 0; k < b.size(); ++k) b[k] = number_of<T>(C(std::sin(1.0 + double(k)), std::cos(double(k))));
  x = b;
  factor.solve(plan, x.data());
  return (s.A * x.template cast<C>() - b.template cast<C>()).cwiseAbs().maxCoeff() /
         (s.A.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("Block LU solves unsymmetric systems, real and complex", "[unit][kkt]") {
  for (const int n : {4, 5, 12, 40}) {
    CAPTURE(n);
    BlockPlan plan;
    const TestMatrix real(n, false, false), complex(n, false, true);
    plan.lay_out(real.graph, false);
    BlockFactor<double> one;
    fill(real, plan, one);
    REQUIRE(one.factor(plan));
    CHECK(error_of(real, plan, one) <= 1e-12);
    BlockFactor<C> two;
    fill(complex, plan, two);
    REQUIRE(two.factor(plan));
    CHECK(error_of(complex, plan, two) <= 1e-12);
  }
}

TEST_CASE("Block LDL^T solves symmetric systems, and its pivots are those of the matrix", "[unit][kkt]") {
  for (const int n : {4, 12, 40}) {
    CAPTURE(n);
    const TestMatrix s(n, true, false);
    BlockPlan plan;
    plan.lay_out(s.graph, true);
    BlockFactor<double> factor;
    fill(s, plan, factor);
    Eigen::VectorXd pivots(s.A.rows());
    REQUIRE(factor.factor_symmetric(plan, pivots.data()));
    CHECK(error_of(s, plan, factor) <= 1e-12);
    CHECK(pivots.minCoeff() > 0);
    if (n == 4) continue;  // more rows than unknowns: the determinant hangs on the last digits of A
    CHECK(pivots.array().log().sum() == Approx(dense::log_determinant(s.A.real())).epsilon(1e-10));
  }
}

TEST_CASE("Block LDL^T rejects a pivot block that is not positive, block LU a missing pivot", "[unit][kkt]") {
  TestMatrix s(4, true, false);
  const int at = s.graph.first[2];
  s.A.block(at, at, 6, 6).setZero();
  BlockPlan plan, lu_plan;
  plan.lay_out(s.graph, true), lu_plan.lay_out(s.graph, false);
  BlockFactor<double> factor, lu;
  fill(s, plan, factor), fill(s, lu_plan, lu);
  Eigen::VectorXd pivots(s.A.rows());
  CHECK_FALSE(factor.factor_symmetric(plan, pivots.data()));

  BlockGraph alone{{6}, {0}, 1, {}};
  lu_plan.lay_out(alone, false);
  lu.lay_out(lu_plan);
  CHECK_FALSE(lu.factor(lu_plan));
}

TEST_CASE("Factor and solution allocate nothing", "[unit][kkt]") {
  if (!allocations_are_counted()) return;
  const TestMatrix s(12, false, true);
  BlockPlan plan;
  plan.lay_out(s.graph, false);
  BlockFactor<C> factor;
  fill(s, plan, factor);
  Eigen::VectorXcd b = Eigen::VectorXcd::Ones(s.A.rows());
  CHECK(allocations_of([&] {
          factor.factor(plan);
          factor.solve(plan, b.data());
        }) == 0);
}

}  // namespace block_factor_test
