#include "framework/tools/analysis/branch_point.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/motion_words.h"

namespace lockstep {

namespace {

constexpr int kMostRows = 300;
constexpr int kMostMotions = 3;  // with more of them branches are no lines
constexpr double kIn = 1e-5;     // singular value of rows of length 1: in the position
constexpr double kFlat = 1e-6;   // of the curvature of the rows: none
constexpr double kStill = 1e-9;  // m/s: laws move the rows no faster
constexpr double kSameLine = 1e-3;

// Rows of length 1 in unknowns that are all lengths, transposed.
MatX scaled_rows(const Evaluation& e, const std::vector<int>& unknowns, VecX& lengths) {
  const System& system = e.system();
  std::vector<int> number(static_cast<std::size_t>(6 * system.n_slots()), -1);
  for (std::size_t i = 0; i < unknowns.size(); ++i) number[static_cast<std::size_t>(unknowns[i])] = static_cast<int>(i);
  MatX Jt = MatX::Zero(static_cast<Eigen::Index>(unknowns.size()), e.rows().n_rows);
  for (const RowEntry& entry : e.rows().entries)
    for (int i = 0; i < entry.slots.n; ++i)
      for (int k = 0; k < entry.m; ++k) {
        const std::array<double, 6> r = e.rows().block(entry).J(i, k);
        for (int c = 0; c < 6; ++c)
          if (const int u = number[static_cast<std::size_t>(6 * entry.slots[i] + c)]; u >= 0)
            Jt(u, entry.first_row + k) += r[static_cast<std::size_t>(c)] / (c < 3 ? 1.0 : system.length());
      }
  lengths = Jt.colwise().norm();
  lengths = lengths.unaryExpr([](double x) { return x > 0 ? x : 1.0; });
  return Jt * lengths.cwiseInverse().asDiagonal();
}

// What the rows ask for at velocities N c, w . (Qhat(N c) + Qhat(-N c) - 2 Qhat(0))/2, one number for each w.
class Curvature {
 public:
  Curvature(Dynamics& dynamics, const State& state, const std::vector<int>& unknowns, const MatX& N, const MatX& W)
      : dynamics_(dynamics), moving_(state), unknowns_(unknowns), N_(N), W_(W), at_rest_(asked(VecX::Zero(N.cols()))) {}

  /// Symmetric matrices G with w . Qhat = c . G c, one for each w.
  std::vector<MatX> forms() {
    const Eigen::Index p = N_.cols();
    std::vector<MatX> all(static_cast<std::size_t>(W_.cols()), MatX::Zero(p, p));
    for (Eigen::Index i = 0; i < p; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) {
        const VecX with = quadratic(VecX::Unit(p, i) + VecX::Unit(p, j)),
                   against = quadratic(VecX::Unit(p, i) - VecX::Unit(p, j));
        for (std::size_t k = 0; k < all.size(); ++k)
          all[k](i, j) = all[k](j, i) =
              0.25 * (with[static_cast<Eigen::Index>(k)] - against[static_cast<Eigen::Index>(k)]);
      }
    return all;
  }
  double largest() const { return largest_; }  ///< that a row asked for

 private:
  VecX asked(const VecX& c) {
    moving_.v = motion_of(dynamics_.system(), unknowns_, N_ * c);
    const Evaluation& e = dynamics_.gather(moving_);
    VecX Qhat(e.rows().n_rows);
    for (const RowEntry& entry : e.rows().entries)
      for (int k = 0; k < entry.m; ++k) Qhat[entry.first_row + k] = e.rows().block(entry).Qhat(k);
    return Qhat;
  }
  VecX quadratic(const VecX& c) {
    const VecX sum = 0.5 * (asked(c) + asked(-c)) - at_rest_;
    largest_ = std::max(largest_, (W_.cwiseAbs().transpose() * sum.cwiseAbs()).lpNorm<Eigen::Infinity>());
    return W_.transpose() * sum;
  }

  Dynamics& dynamics_;
  State moving_;
  const std::vector<int>& unknowns_;
  const MatX &N_, &W_;
  VecX at_rest_;
  double largest_ = 0;
};

// Unit vectors c with c . G c = 0 for all G, up to their sign: Newton's method from many directions.
std::vector<VecX> common_zeros(const std::vector<MatX>& forms, Eigen::Index p, double zero) {
  constexpr int kStarts = 200, kRounds = 60;
  std::minstd_rand random(1);
  std::normal_distribution<double> normal;
  std::vector<VecX> found;
  MatX slopes(static_cast<Eigen::Index>(forms.size()) + 1, p);
  VecX values(slopes.rows());
  for (int start = 0; start < kStarts; ++start) {
    VecX c = VecX::NullaryExpr(p, [&] { return normal(random); }).normalized();
    double size = HUGE_VAL;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < forms.size(); ++k) {
        const VecX Gc = forms[k] * c;
        slopes.row(static_cast<Eigen::Index>(k)) = 2 * Gc.transpose(), values[static_cast<Eigen::Index>(k)] = c.dot(Gc);
      }
      slopes.bottomRows(1) = c.transpose(), values[values.size() - 1] = 0;
      size = values.lpNorm<Eigen::Infinity>();
      if (size <= 1e-3 * zero) break;
      c -= Eigen::CompleteOrthogonalDecomposition<MatX>(slopes).solve(values);
      c.normalize();
    }
    if (!(size <= zero)) continue;
    const bool known =
        std::ranges::any_of(found, [&](const VecX& other) { return 1 - std::abs(c.dot(other)) < kSameLine; });
    if (!known) found.push_back(c);
  }
  return found;
}

BranchPoint looked_at(Dynamics& dynamics, const State& given) {
  BranchPoint out;
  State state = given;
  dynamics.to_slots(state);
  const System& system = dynamics.system();
  if (!has_loops(system, state.modes)) return out;
  const std::vector<int> unknowns = unknowns_of(system);
  VecX lengths;
  MatX Jt;
  {
    const Evaluation& e = dynamics.gather(state);
    if (e.rows().n_rows > kMostRows || e.rows().n_rows == 0) return out;
    VecX Ct = VecX::Zero(e.rows().n_rows);
    e.velocity_residual(VecX::Zero(state.v.size()), Ct);
    if (e.norm(Ct) > kStill) return out;
    Jt = scaled_rows(e, unknowns, lengths);
  }
  out.known = true;
  const Eigen::BDCSVD<MatX> svd(Jt, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < svd.singularValues().size() && svd.singularValues()[rank] > kIn) ++rank;
  if (rank > 0) out.nearness = svd.singularValues()[rank - 1];
  const MatX N = svd.matrixU().rightCols(Jt.rows() - rank);
  const MatX W = lengths.cwiseInverse().asDiagonal() * svd.matrixV().rightCols(Jt.cols() - rank);
  out.motions = static_cast<int>(N.cols());
  if (N.cols() == 0 || W.cols() == 0) return out;

  Curvature curvature(dynamics, state, unknowns, N, W);
  std::vector<MatX> forms = curvature.forms();
  const double flat = kFlat * std::max(curvature.largest(), W.cwiseAbs().maxCoeff() / system.length());
  std::erase_if(forms, [&](const MatX& G) { return G.cwiseAbs().maxCoeff() <= flat; });
  out.singular = !forms.empty();
  if (!out.singular || N.cols() > kMostMotions) return out;
  const std::vector<VecX> lines = common_zeros(forms, N.cols(), flat);
  out.all = lines.size() <= (N.cols() == 2 ? 2u : 4u);  // more are a surface of them
  if (!out.all) return out;
  for (const VecX& c : lines) {
    VecX motion = motion_of(system, unknowns, N * c);
    motion /= motion_size(system, motion);
    out.tangents.push_back(std::move(motion));
  }
  return out;
}

}  // namespace

BranchPoint branch_point(Dynamics& dynamics, const State& state) {
  try {
    return looked_at(dynamics, state);
  } catch (const Error&) {  // what cannot be evaluated at other velocities is not known
    return {};
  }
}

std::string BranchPoint::text(Dynamics& dynamics, const State& given) const {
  if (!singular) return {};
  State state = given;
  dynamics.to_slots(state);
  const std::string count = fmt::format("{} motion{} to first order", motions, motions == 1 ? "" : "s");
  if (!all) return count + ", and more branches than lines can tell";
  if (tangents.empty()) return count + ", none of which goes on: the mechanism is locked there, but for what gives way";
  std::string words =
      count + (tangents.size() == 1 ? ", one branch: " : fmt::format(", {} branches: ", tangents.size()));
  const Inputs& in = dynamics.inputs(state);
  for (std::size_t k = 0; k < tangents.size(); ++k)
    words += (k > 0 ? "; or " : "") + motion_words(dynamics.system(), in, tangents[k]);
  return words;
}

double BranchPoint::off_branches(const System& system, const VecX& v) const {
  const auto as_lengths = [&](VecX x) {
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (i % 6 >= 3) x[i] *= system.length();
    return x;
  };
  const VecX moving = as_lengths(v);
  double least = moving.norm() > 0 ? 1 : 0;
  for (const VecX& tangent : tangents) {
    const VecX along = as_lengths(tangent).normalized();
    least = std::min(least, (moving - along.dot(moving) * along).norm() / moving.norm());
  }
  return least;
}

}  // namespace lockstep
