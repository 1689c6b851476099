// The linear systems behind a spline. Unknown at a point: x = s (slope) for a cubic, x = (s, M) (slope and second
// derivative) for a quintic; equations: the next derivatives are continuous. Block elimination without exchanges is
// stable, since these are the stationarity conditions of the integrals of ydd^2 and yddd^2 (positive definite up to the
// sign of a row).
#include <Eigen/LU>

#include <lockstep/splines.h>

namespace lockstep {
namespace {

using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2>;

// The share of an interval of length h at one of its ends: near * x_near + far * x_far = rhs * (y_right - y_left).
struct End {
  Block near, far;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> rhs;
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
End end_of(double h, int degree, double sign) {
  End e;
  if (degree == 3) {
    e.near.resize(1, 1), e.far.resize(1, 1), e.rhs.resize(1);
    e.near << 4 / h;
    e.far << 2 / h;
    e.rhs << 6 / (h * h);
    return e;
  }
  const double h2 = h * h, h3 = h2 * h, h4 = h2 * h2;
  e.near.resize(2, 2), e.far.resize(2, 2), e.rhs.resize(2);
  e.near << 192 / h3, sign * 36 / h2, sign * 36 / h2, 9 / h;
  e.far << 168 / h3, -sign * 24 / h2, sign * 24 / h2, -3 / h;
  e.rhs << 360 / h4, sign * 60 / h3;
  return e;
}

// Row i of the system: lower * x_(i-1) + diagonal * x_i + upper * x_(i+1) = rhs (one row per component of x, one column
// per component of y).
struct Row {
  Block lower, diagonal, upper;
  MatX rhs;
};

class PointEquations {
 public:
  PointEquations(const std::vector<double>& t, const MatX& y, int degree)
      : t_(t), y_(y), degree_(degree), m_(degree == 3 ? 1 : 2) {}

  Row row(std::size_t i, bool with_left, bool with_right) const {
    Row r{Block::Zero(m_, m_), Block::Zero(m_, m_), Block::Zero(m_, m_), MatX::Zero(m_, y_.cols())};
    if (with_left) {
      const End e = end_of(length(i - 1), degree_, -1.0);
      r.lower = e.far, r.diagonal += e.near, r.rhs += e.rhs * rise(i - 1);
    }
    if (with_right) {
      const End e = end_of(length(i), degree_, 1.0);
      r.upper = e.far, r.diagonal += e.near, r.rhs += e.rhs * rise(i);
    }
    return r;
  }
  int block() const { return m_; }

 private:
  double length(std::size_t i) const { return t_[i + 1] - t_[i]; }
  Eigen::RowVectorXd rise(std::size_t i) const {
    return y_.row(static_cast<Eigen::Index>(i) + 1) - y_.row(static_cast<Eigen::Index>(i));
  }
  const std::vector<double>& t_;
  const MatX& y_;
  int degree_, m_;
};

// Elimination downwards, then substitution upwards; right sides may have any number of columns.
MatX solve(std::vector<Row> rows, int m) {
  const std::size_t n = rows.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      rows[i].diagonal -= rows[i].lower * rows[i - 1].upper;
      rows[i].rhs -= rows[i].lower * rows[i - 1].rhs;
    }
    const Block inverse = rows[i].diagonal.inverse();
    rows[i].upper = inverse * rows[i].upper;
    rows[i].rhs = inverse * rows[i].rhs;
  }
  MatX x(static_cast<Eigen::Index>(n) * m, rows[0].rhs.cols());
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) rows[i].rhs -= rows[i].upper * rows[i + 1].rhs;
    x.middleRows(static_cast<Eigen::Index>(i) * m, m) = rows[i].rhs;
  }
  return x;
}

// An end with given rates: x = given.
Row given_row(int m, const VecX& rate, const VecX& acceleration, Eigen::Index n_components) {
  Row r{Block::Zero(m, m), Block::Identity(m, m), Block::Zero(m, m), MatX::Zero(m, n_components)};
  if (rate.size() > 0) r.rhs.row(0) = rate.transpose();
  if (m == 2 && acceleration.size() > 0) r.rhs.row(1) = acceleration.transpose();
  return r;
}

// x_n = turn x_0: x_0 is the border. Rows 1 .. n-1 give x = z - Z x_0, then the row at point 0 gives x_0.
MatX solve_periodic(const PointEquations& system, std::size_t n, Eigen::Index n_components, double turn) {
  const int m = system.block();
  std::vector<Row> rows;
  for (std::size_t i = 1; i < n; ++i) {
    Row r = system.row(i, true, true);
    MatX wide = MatX::Zero(m, n_components + m);
    wide.leftCols(n_components) = r.rhs;
    if (i == 1) wide.rightCols(m) += r.lower;
    if (i + 1 == n) wide.rightCols(m) += turn * r.upper;
    r.rhs = wide;
    rows.push_back(std::move(r));
  }
  rows.front().lower.setZero();
  rows.back().upper.setZero();
  const MatX x = solve(std::move(rows), m);
  const auto z = x.leftCols(n_components);
  const auto Z = x.rightCols(m);

  // Point 0 from the right, point n from the left; the latter times turn.
  const Row right = system.row(0, false, true), left = system.row(n, true, false);
  const MatX K = right.diagonal + left.diagonal - right.upper * Z.topRows(m) - turn * left.lower * Z.bottomRows(m);
  const MatX x0 =
      K.inverse() * (right.rhs + turn * left.rhs - right.upper * z.topRows(m) - turn * left.lower * z.bottomRows(m));
  MatX all(static_cast<Eigen::Index>(n + 1) * m, n_components);
  all << x0, z - Z * x0, turn * x0;
  return all;
}

}  // namespace

MatX spline_nodes(const std::vector<double>& t, const MatX& y, int degree, SplineEnds ends, const SplineEndRates& rates,
                  double turn) {
  const PointEquations system(t, y, degree);
  const std::size_t n = t.size() - 1;
  if (ends == SplineEnds::periodic) return solve_periodic(system, n, y.cols(), turn);
  const bool clamped = ends == SplineEnds::clamped;
  std::vector<Row> rows;
  for (std::size_t i = 0; i <= n; ++i) rows.push_back(system.row(i, i > 0, i < n));
  if (clamped) {
    rows.front() = given_row(system.block(), rates.start_rate, rates.start_acceleration, y.cols());
    rows.back() = given_row(system.block(), rates.end_rate, rates.end_acceleration, y.cols());
  }
  return solve(std::move(rows), system.block());
}

}  // namespace lockstep
