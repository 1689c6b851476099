// SPDX-License-Identifier: BSD-3-Clause
// The linear systems behind a spline. Unknown at a point, m numbers: x = s (slope) for a cubic, x = (s, M) (slope and
// second derivative) for a quintic; equations: the next derivatives are continuous. The matrix is symmetric and positive
// definite, since these are the stationarity conditions of the integrals of ydd^2 and yddd^2.
#include <Eigen/SparseCholesky>

#include <algorithm>

#include "framework/foundation/math/sparse.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {
namespace {

template <int m>
using Block = Eigen::Matrix<double, m, m>;

// The share of an interval of length h at one of its ends: near * x_near + far * x_far = rhs * (y_right - y_left).
template <int m>
struct EndShare {
  Block<m> near, far;
  Eigen::Matrix<double, m, 1> rhs;
};

// Cubic: the second derivative, from Hermite's form:
//   h^2 ydd(left)  =  6 dy - 4 s0 h - 2 s1 h
//   h^2 ydd(right) = -6 dy + 2 s0 h + 4 s1 h
// Quintic: the third and fourth derivatives,
//   h^3 y3(left)  =   60 dy -  36 s0 h -  24 s1 h -  9 M0 h^2 +  3 M1 h^2
//   h^3 y3(right) =   60 dy -  24 s0 h -  36 s1 h -  3 M0 h^2 +  9 M1 h^2
//   h^4 y4(left)  = -360 dy + 192 s0 h + 168 s1 h + 36 M0 h^2 - 24 M1 h^2
//   h^4 y4(right) =  360 dy - 168 s0 h - 192 s1 h - 24 M0 h^2 + 36 M1 h^2
// Signs are such that the two sides of a point add up. `sign` is +1 at the left end, -1 at the right one: ydd and y4
// keep their sign under reflection of time, s and y3 change it.
template <int m>
EndShare<m> end_of(double h, double sign) {
  EndShare<m> e;
  if constexpr (m == 1) {
    e.near << 4 / h;
    e.far << 2 / h;
    e.rhs << 6 / (h * h);
  } else {
    const double h2 = h * h, h3 = h2 * h, h4 = h2 * h2;
    e.near << 192 / h3, sign * 36 / h2, sign * 36 / h2, 9 / h;
    e.far << 168 / h3, -sign * 24 / h2, sign * 24 / h2, -3 / h;
    e.rhs << 360 / h4, sign * 60 / h3;
  }
  return e;
}

template <int m>
MatX nodes(const Columns& points, SplineEnds ends, const MatX& rates, double turn) {
  const Eigen::Index n = points.y.rows() - 1;  // the last point
  const bool periodic = ends == SplineEnds::periodic;
  const auto is_given = [&](Eigen::Index i) { return ends == SplineEnds::clamped && (i == 0 || i == n); };
  // x_n = turn x_0 of periodic ends: the last point is the first one, with this factor.
  const auto place = [&](Eigen::Index i) { return periodic && i == n ? 0 : m * i; };
  const auto factor = [&](Eigen::Index i) { return periodic && i == n ? turn : 1.0; };
  std::vector<Eigen::Triplet<double>> entries;
  MatX x(MatX::Zero(m * (n + 1), points.y.cols()));  // first the right-hand side
  const auto add = [&](Eigen::Index row, Eigen::Index column, const Block<m>& share) {
    if (is_given(column)) {
      x.middleRows<m>(place(row)) -= share * x.middleRows<m>(place(column));
      return;
    }
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        entries.emplace_back(place(row) + i, place(column) + j, factor(row) * factor(column) * share(i, j));
  };
  for (const Eigen::Index i : {Eigen::Index{0}, n})
    if (is_given(i)) x.middleRows<m>(m * i) = rates.middleRows<m>(i == 0 ? 0 : 2);
  for (Eigen::Index i = 0; i <= n; ++i)
    for (const Eigen::Index other : {i - 1, i + 1}) {
      if (is_given(i) || other < 0 || other > n) continue;
      const Eigen::Index left = std::min(i, other);
      const EndShare<m> e = end_of<m>(points.t[left + 1] - points.t[left], i == left ? 1.0 : -1.0);
      add(i, i, e.near), add(i, other, e.far);
      x.middleRows<m>(place(i)) += factor(i) * e.rhs * (points.y.row(left + 1) - points.y.row(left));
    }
  for (const Eigen::Index i : {Eigen::Index{0}, n})
    for (int k = 0; k < m && is_given(i); ++k) entries.emplace_back(m * i + k, m * i + k, 1.0);
  const Eigen::Index size = periodic ? m * n : m * (n + 1);
  SparseMat A(size, size);
  A.setFromTriplets(entries.begin(), entries.end());
  x.topRows(size) = Eigen::SimplicialLDLT<SparseMat>(A).solve(x.topRows(size)).eval();
  if (periodic) x.bottomRows<m>() = turn * x.topRows<m>();
  return x;
}

}  // namespace

MatX spline_nodes(const Columns& points, int degree, SplineEnds ends, const MatX& rates, double turn) {
  return degree == 3 ? nodes<1>(points, ends, rates, turn) : nodes<2>(points, ends, rates, turn);
}

}  // namespace lockstep
