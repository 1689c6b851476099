// SPDX-License-Identifier: BSD-3-Clause
// The linear systems behind a spline. Unknown at a point, m numbers: x = s (slope) for a cubic, x = (s, M) (slope and
// second derivative) for a quintic; equations: the next derivatives are continuous. Block elimination without exchanges is
// stable, since these are the stationarity conditions of the integrals of ydd^2 and yddd^2 (positive definite up to the
// sign of a row).
#include <Eigen/LU>

#include "motionlaws/spline_curve.h"

namespace lockstep {
namespace {

template <int m>
using Block = Eigen::Matrix<double, m, m>;
template <int m>
using Values = Eigen::Matrix<double, m, Eigen::Dynamic>;

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

// Row i of the system: lower * x_(i-1) + diagonal * x_i + upper * x_(i+1) = rhs (one row per component of x, one column
// per component of y).
template <int m>
struct Row {
  Block<m> lower = Block<m>::Zero(), diagonal = Block<m>::Zero(), upper = Block<m>::Zero();
  Values<m> rhs;
};

template <int m>
class PointEquations {
 public:
  explicit PointEquations(const Columns& points) : t_(points.t), y_(points.y) {}

  Row<m> row(std::size_t i, bool with_left, bool with_right) const {
    Row<m> r;
    r.rhs.setZero(m, y_.cols());
    if (with_left) {
      const EndShare<m> e = end_of<m>(length(i - 1), -1.0);
      r.lower = e.far, r.diagonal += e.near, r.rhs += e.rhs * rise(i - 1);
    }
    if (with_right) {
      const EndShare<m> e = end_of<m>(length(i), 1.0);
      r.upper = e.far, r.diagonal += e.near, r.rhs += e.rhs * rise(i);
    }
    return r;
  }

 private:
  double length(std::size_t i) const { return t_[i + 1] - t_[i]; }
  Eigen::RowVectorXd rise(std::size_t i) const {
    return y_.row(static_cast<Eigen::Index>(i) + 1) - y_.row(static_cast<Eigen::Index>(i));
  }
  const std::vector<double>& t_;
  const MatX& y_;
};

// Elimination downwards, then substitution upwards; right-hand sides may have any number of columns.
template <int m>
MatX solve(std::vector<Row<m>> rows) {
  const std::size_t n = rows.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      rows[i].diagonal -= rows[i].lower * rows[i - 1].upper;
      rows[i].rhs -= rows[i].lower * rows[i - 1].rhs;
    }
    const Block<m> inverse = rows[i].diagonal.inverse();
    rows[i].upper = inverse * rows[i].upper;
    rows[i].rhs = inverse * rows[i].rhs;
  }
  MatX x(static_cast<Eigen::Index>(n) * m, rows[0].rhs.cols());
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) rows[i].rhs -= rows[i].upper * rows[i + 1].rhs;
    x.middleRows<m>(static_cast<Eigen::Index>(i) * m) = rows[i].rhs;
  }
  return x;
}

// An end with given rates: x = given.
template <int m>
Row<m> given_row(const Values<m>& rates) {
  return {Block<m>::Zero(), Block<m>::Identity(), Block<m>::Zero(), rates};
}

// x_n = turn x_0: x_0 is the border. Rows 1 .. n-1 give x = z - Z x_0, then the row at point 0 gives x_0.
template <int m>
MatX solve_periodic(const PointEquations<m>& system, std::size_t n, Eigen::Index n_components, double turn) {
  std::vector<Row<m>> rows;
  for (std::size_t i = 1; i < n; ++i) {
    Row<m> r = system.row(i, true, true);
    Values<m> wide = Values<m>::Zero(m, n_components + m);
    wide.leftCols(n_components) = r.rhs;
    if (i == 1) wide.template rightCols<m>() += r.lower;
    if (i + 1 == n) wide.template rightCols<m>() += turn * r.upper;
    r.rhs = std::move(wide);
    rows.push_back(std::move(r));
  }
  rows.front().lower.setZero();
  rows.back().upper.setZero();
  const MatX x = solve<m>(std::move(rows));
  const auto z = x.leftCols(n_components);
  const auto Z = x.rightCols<m>();

  // Point 0 from the right, point n from the left; the latter times turn.
  const Row<m> right = system.row(0, false, true), left = system.row(n, true, false);
  const Block<m> K = right.diagonal + left.diagonal - right.upper * Z.template topRows<m>() -
                     turn * left.lower * Z.template bottomRows<m>();
  const Values<m> x0 = K.inverse() * (right.rhs + turn * left.rhs - right.upper * z.template topRows<m>() -
                                      turn * left.lower * z.template bottomRows<m>());
  MatX all(static_cast<Eigen::Index>(n + 1) * m, n_components);
  all << x0, z - Z.lazyProduct(x0), turn * x0;
  return all;
}

template <int m>
MatX nodes(const Columns& points, SplineEnds ends, const MatX& rates, double turn) {
  const PointEquations<m> system(points);
  const std::size_t n = points.t.size() - 1;
  if (ends == SplineEnds::periodic) return solve_periodic<m>(system, n, points.y.cols(), turn);
  std::vector<Row<m>> rows;
  for (std::size_t i = 0; i <= n; ++i) rows.push_back(system.row(i, i > 0, i < n));
  if (ends == SplineEnds::clamped)
    rows.front() = given_row<m>(rates.topRows<m>()), rows.back() = given_row<m>(rates.middleRows<m>(2));
  return solve<m>(std::move(rows));
}

}  // namespace

MatX spline_nodes(const Columns& points, int degree, SplineEnds ends, const MatX& rates, double turn) {
  return degree == 3 ? nodes<1>(points, ends, rates, turn) : nodes<2>(points, ends, rates, turn);
}

}  // namespace lockstep
