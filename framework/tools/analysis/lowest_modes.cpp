#include "framework/tools/analysis/lowest_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <lockstep/error.h>
#include <lockstep/newton.h>
#include "framework/tools/analysis/minimal_coordinates.h"
#include "framework/tools/analysis/saddle_factor.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using MatXc = Eigen::MatrixXcd;

constexpr double kModeSettled = 1e-12;  // residual of an eigenvector, relative
constexpr double kValueSettled = 1e-9;  // of an eigenvalue: it stays when the subspace grows by half
constexpr double kBlur = 1e-14;         // and what the largest leaves on it

// A subspace that grows by images of its own vectors under an operator, and by vectors at random, which find the other
// copies of an eigenvalue; orthonormal by an inner product.
class Subspace {
 public:
  using Operator = std::function<VecX(const VecX&)>;

  Subspace(Operator image, Operator metric, Eigen::Index size)
      : image_(std::move(image)), metric_(std::move(metric)), size_(size), V_(size, 0) {}

  void add_random() {
    for (int tries = 0; tries < 3; ++tries)
      if (add(image_(VecX(VecX::NullaryExpr(size_, [&] { return normal_(random_); }))))) return;
  }
  // Takes the next vector's image in; false if there is no further one.
  bool grow() {
    if (taken_ == n()) add_random();
    if (taken_ == n()) return false;
    add(image_(V_.col(taken_)), taken_);
    ++taken_;
    return true;
  }
  Eigen::Index taken() const { return taken_; }
  // The operator on the vectors whose images are in.
  MatX projected() const { return H_.topLeftCorner(taken_, taken_); }
  // |image(x) - theta x| of x = V s, for eigenvectors s of projected().
  double residual(const VecXc& s) const { return (H_.bottomLeftCorner(n() - taken_, taken_) * s).norm(); }
  VecXc vector(const VecXc& s) const { return V_.leftCols(taken_) * s; }

 private:
  Eigen::Index n() const { return V_.cols(); }
  double norm(const VecX& x) const { return std::sqrt(std::max(x.dot(metric_(x)), 0.0)); }

  // Adds the part of x that is new; false if there is none. The components of the image of vector `of` go to H.
  bool add(VecX x, Eigen::Index of = -1) {
    VecX components = VecX::Zero(n());
    const double before = norm(x);
    for (int round = 0; round < 3; ++round) {
      const VecX step = V_.transpose() * metric_(x);
      x -= V_ * step;
      components += step;
    }
    const double left = norm(x);
    const bool is_new = left > kModeSettled * before;
    if (is_new) {
      V_.conservativeResize(Eigen::NoChange, n() + 1);
      V_.rightCols(1) = x / left;
      H_.conservativeResizeLike(MatX::Zero(n(), n()));
    }
    if (of >= 0) H_.col(of).head(components.size()) = components;
    if (of >= 0 && is_new) H_(n() - 1, of) = left;
    return is_new;
  }

  Operator image_, metric_;
  Eigen::Index size_, taken_ = 0;
  MatX V_, H_;  // image(V) = V H of those that are taken
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

struct Found {
  std::vector<Complex> theta;
  MatXc s;
};

Found eigen_of(const MatX& H, bool symmetric) {
  Found out;
  VecXc values;
  MatXc vectors;
  if (symmetric) {
    const Eigen::SelfAdjointEigenSolver<MatX> solver(0.5 * (H + H.transpose()));
    values = solver.eigenvalues().cast<Complex>(), vectors = solver.eigenvectors().cast<Complex>();
  } else {
    const Eigen::EigenSolver<MatX> solver(H);
    values = solver.eigenvalues(), vectors = solver.eigenvectors();
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order,
                           [&](Eigen::Index a, Eigen::Index b) { return std::abs(values[a]) > std::abs(values[b]); });
  out.s = vectors(Eigen::all, order);
  for (const Eigen::Index k : order) out.theta.push_back(values[k]);
  return out;
}

// The problem with one shift: l^2 = -w^2 of K + sigma M where nothing damps, else l of the whole equation at a real shift.
class Shifted {
 public:
  Shifted(const LinearMotion& m, bool symmetric, double sigma, bool redundant)
      : m_(m), symmetric_(symmetric), s_(std::sqrt(sigma)) {
    factor_ = std::make_unique<SaddleFactor>(
        m, symmetric ? SparseMat(m.K + sigma * m.M) : SparseMat(m.K + s_ * m.D + sigma * m.M), redundant);
  }
  Eigen::Index size() const { return symmetric_ ? n() : 2 * n(); }
  VecX image(const VecX& x) const {
    if (symmetric_) return factor_->solve(m_.M * x);
    const VecX p = x.head(n()), q = x.tail(n());
    VecX out(2 * n());
    out.head(n()) = factor_->solve(-(m_.M * VecX(q + s_ * p) + m_.D * p));
    out.tail(n()) = p + s_ * out.head(n());
    return out;
  }
  VecX metric(const VecX& x) const {
    if (symmetric_) return m_.M * x;
    VecX out(2 * n());
    out.head(n()) = s_ * s_ * (m_.M * VecX(x.head(n()))), out.tail(n()) = m_.M * VecX(x.tail(n()));
    return out;
  }
  // The square of l where nothing damps, else l.
  Complex value(Complex theta) const { return symmetric_ ? s_ * s_ - 1.0 / theta : s_ + 1.0 / theta; }

 private:
  Eigen::Index n() const { return m_.M.rows(); }
  const LinearMotion& m_;
  bool symmetric_;
  double s_;
  std::unique_ptr<SaddleFactor> factor_;
};

// The largest |theta|, settled, with every copy: vectors at random are added until they bring no more.
Found settle(Subspace& space, bool symmetric, std::size_t count, Eigen::Index most) {
  Eigen::Index next_look = static_cast<Eigen::Index>(2 * count) + 10, grown = 0;
  std::vector<Complex> before;
  space.add_random(), space.add_random();
  for (;;) {
    bool whole = false;
    while (space.taken() < next_look && !whole) whole = !space.grow();
    const Found found = eigen_of(space.projected(), symmetric);
    std::size_t n = std::min(count, found.theta.size());
    if (!symmetric && n < found.theta.size() && n > 0 && found.theta[n - 1].imag() != 0 &&
        found.theta[n - 1] == std::conj(found.theta[n]))
      ++n;  // both of a pair
    bool settled = true;
    for (std::size_t k = 0; k < n && settled; ++k)
      settled = space.residual(found.s.col(static_cast<Eigen::Index>(k))) <=
                kModeSettled * std::abs(found.theta[k]) + kBlur * std::abs(found.theta[0]);
    if (whole || settled) {
      std::vector<Complex> now(found.theta.begin(), found.theta.begin() + static_cast<std::ptrdiff_t>(n));
      bool same = before.size() == now.size();
      for (std::size_t k = 0; same && k < now.size(); ++k)
        same = std::abs(std::abs(now[k]) - std::abs(before[k])) <= kValueSettled * std::abs(now[k]);
      if (whole || same) return {std::move(now), found.s.leftCols(static_cast<Eigen::Index>(n))};
      before = std::move(now);
      space.add_random();
      grown = std::max<Eigen::Index>(space.taken() / 2, 10);
      next_look = space.taken() + grown;
    } else {
      next_look = space.taken() + 10;
    }
    if (space.taken() > most)
      throw SolveError("the lowest " + std::to_string(count) + " eigenvalues did not settle in " +
                       std::to_string(most) + " steps; ask for fewer, or for a dense solution (dense_limit)");
  }
}

// What round-off may make of a zero w^2 in the direction of x.
double zero_of(const LinearMotion& m, const VecXc& x) {
  const VecX size = x.cwiseAbs();
  return kZeroShare * size.dot(SparseMat(m.K.cwiseAbs()) * size) / size.dot(SparseMat(m.M.cwiseAbs()) * size) +
         unrest_share(m);
}

double largest_rate(const LinearMotion& m) {
  double rate = 0;
  for (Eigen::Index i = 0; i < m.M.rows(); ++i)
    if (const double mass = m.M.coeff(i, i); mass > 0)
      rate = std::max({rate, std::abs(m.K.coeff(i, i)) / mass, std::pow(m.D.coeff(i, i) / mass, 2)});
  return rate;
}

struct Values {
  std::vector<Complex> l2;  // l^2 where nothing damps, else l
  MatXc x;
  double blur = 0;  // what round-off of the shift may make of a zero w^2, 1/s^2, where no stiffness at all acts
};

Values with_shift(const LinearMotion& m, bool symmetric, double sigma, int count, bool redundant) {
  const Shifted shifted(m, symmetric, sigma, redundant);
  Subspace space([&](const VecX& x) { return shifted.image(x); }, [&](const VecX& x) { return shifted.metric(x); },
                 shifted.size());
  const auto wanted = static_cast<std::size_t>(symmetric ? count : 2 * count);
  const Found found = settle(space, symmetric, wanted, static_cast<Eigen::Index>(200 + 20 * wanted));
  Values out;
  out.blur = kZeroShare * sigma;
  out.x = MatXc(m.M.rows(), static_cast<Eigen::Index>(found.theta.size()));
  for (std::size_t k = 0; k < found.theta.size(); ++k) {
    const auto col = static_cast<Eigen::Index>(k);
    out.l2.push_back(shifted.value(found.theta[k]));
    out.x.col(col) = space.vector(found.s.col(col)).head(m.M.rows());
  }
  return out;
}

void put_zeros(const LinearMotion& m, const std::vector<VecXc>& zero, Spectrum& out) {
  if (zero.empty()) return;
  MatX all(m.M.rows(), static_cast<Eigen::Index>(2 * zero.size()));
  for (std::size_t k = 0; k < zero.size(); ++k) {
    all.col(static_cast<Eigen::Index>(2 * k)) = zero[k].real() / zero[k].norm();
    all.col(static_cast<Eigen::Index>(2 * k + 1)) = zero[k].imag() / zero[k].norm();
  }
  const Eigen::ColPivHouseholderQR<MatX> qr(all);  // both of a double zero have one vector
  Eigen::Index rank = 0;
  while (rank < all.cols() && std::abs(qr.matrixR()(rank, rank)) > 1e-3) ++rank;
  out.rigid = MatX(m.M.rows(), rank);
  for (Eigen::Index k = 0; k < rank; ++k) out.rigid.col(k) = all.col(qr.colsPermutation().indices()[k]);
}

Spectrum spectrum_from(const LinearMotion& m, bool symmetric, const Values& values) {
  Spectrum out;
  out.rigid = MatX(m.M.rows(), 0);
  std::vector<VecXc> zero;
  std::vector<Eigen::Index> source;
  const auto put = [&](Complex l, double bound, Eigen::Index k) {
    out.values.push_back(l), out.bounds.push_back(bound), source.push_back(k);
  };
  for (std::size_t i = 0; i < values.l2.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Complex l = values.l2[i];
    const double small = zero_of(m, values.x.col(k)) + values.blur,
                 size = symmetric ? std::sqrt(std::abs(l)) : std::abs(l);
    out.zero_bound = std::max(out.zero_bound, std::sqrt(small));
    if (size * size <= small) {
      out.zeros += symmetric ? 2 : 1;
      zero.push_back(values.x.col(k));
    } else if (!symmetric) {
      if (l.imag() >= 0) put(l, kValueSettled * size + small / (2 * size), k);
    } else if (l.real() < 0) {
      put({0, size}, small / (2 * size), k);
    } else {
      put({-size, 0}, small / (2 * size), k), put({size, 0}, small / (2 * size), k);
    }
  }
  put_zeros(m, zero, out);
  out.vectors = values.x(Eigen::all, source);
  sort(out);
  return out;
}

}  // namespace

Spectrum lowest_spectrum(const LinearMotion& m, int count, bool redundant) {
  const double K = m.K.norm();
  const bool symmetric = m.D.norm() == 0 && SparseMat(m.K - SparseMat(m.K.transpose())).norm() <= kZeroShare * K;
  double sigma = 1e-6 * largest_rate(m);
  if (!(sigma > 0)) sigma = 1;  // nothing acts: every eigenvalue is zero
  for (int round = 0;; ++round) {
    const Values values = with_shift(m, symmetric, sigma, count, redundant);
    // A shift beside the lowest that is not zero: far above it, it blurs the lowest; far below, zeros blur them.
    double lowest = 0;
    bool has_zeros = false;
    for (std::size_t i = 0; i < values.l2.size(); ++i) {
      const double square = symmetric ? std::abs(values.l2[i]) : std::norm(values.l2[i]);
      if (square <= zero_of(m, values.x.col(static_cast<Eigen::Index>(i))) + values.blur)
        has_zeros = true;
      else if (lowest == 0 || square < lowest)
        lowest = square;
    }
    const bool well = lowest == 0 || (sigma <= 10 * lowest && (!has_zeros || sigma >= 1e-2 * lowest));
    if (well || round == 3) {
      return spectrum_from(m, symmetric, values);
    }
    sigma = lowest;
  }
}

}  // namespace lockstep
