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
#include "framework/tools/analysis/loop_rows.h"
#include "framework/tools/analysis/motion_words.h"

namespace lockstep {

namespace {

constexpr int kMostBranchRows = 300;
constexpr std::size_t kMostBranchUnknowns = 3000;
constexpr int kMostMotions = 3;      // with more of them branches are no lines
constexpr double kIn = 1e-5;         // singular value of rows of length 1: in the position
constexpr double kFlat = 1e-6;       // of the curvature of the rows: none
constexpr double kStillRows = 1e-9;  // m/s: laws move the rows no faster
constexpr double kSameLine = 1e-3;

/// What lies on loops. Rows elsewhere depend on no others, and move along with any motion of the loops.
struct LoopPart {
  std::vector<int> entries;   // of the table
  int n_rows = 0;             // of these entries
  std::vector<bool> slots;    // of the system: whether they are in it
  std::vector<int> unknowns;  // of these slots
};

LoopPart loop_part(const System& system, const RowTable& table) {
  LoopPart part;
  part.slots.assign(static_cast<std::size_t>(system.n_slots()), false);
  for (const std::vector<int>& group : loops_of(system, table)) {
    const RowEntry& first = table.entries[static_cast<std::size_t>(group.front())];
    const bool joint = system.links()[static_cast<std::size_t>(first.link)]->jointed() != nullptr;
    if (group.size() > 1 || !joint) part.entries.insert(part.entries.end(), group.begin(), group.end());
  }
  for (const int k : part.entries) {
    const RowEntry& entry = table.entries[static_cast<std::size_t>(k)];
    part.n_rows += entry.m;
    for (int i = 0; i < entry.slots.n; ++i) part.slots[static_cast<std::size_t>(entry.slots[i])] = true;
  }
  part.unknowns = unknowns_of(system);
  std::erase_if(part.unknowns, [&](int u) { return !part.slots[static_cast<std::size_t>(u / 6)]; });
  return part;
}

// Rows of length 1 in unknowns that are all lengths, transposed.
MatX scaled_rows(const Evaluation& e, const LoopPart& part, VecX& lengths) {
  const System& system = e.system();
  std::vector<int> number(static_cast<std::size_t>(6 * system.n_slots()), -1);
  for (std::size_t i = 0; i < part.unknowns.size(); ++i)
    number[static_cast<std::size_t>(part.unknowns[i])] = static_cast<int>(i);
  MatX Jt = MatX::Zero(static_cast<Eigen::Index>(part.unknowns.size()), part.n_rows);
  int row = 0;
  for (const int at : part.entries) {
    const RowEntry& entry = e.rows().entries[static_cast<std::size_t>(at)];
    for (int k = 0; k < entry.m; ++k, ++row)
      for (int i = 0; i < entry.slots.n; ++i) {
        const std::array<double, 6> r = e.rows().block(entry).J(i, k);
        for (int c = 0; c < 6; ++c)
          if (const int u = number[static_cast<std::size_t>(6 * entry.slots[i] + c)]; u >= 0)
            Jt(u, row) += r[static_cast<std::size_t>(c)] / (c < 3 ? 1.0 : system.length());
      }
  }
  lengths = Jt.colwise().norm();
  lengths = lengths.unaryExpr([](double x) { return x > 0 ? x : 1.0; });
  return Jt * lengths.cwiseInverse().asDiagonal();
}

// Whether laws move the rows.
bool is_driven(const Evaluation& e, const LoopPart& part) {
  VecX Ct = VecX::Zero(e.rows().n_rows), of_part = Ct;
  e.velocity_residual(VecX::Zero(6 * e.system().n_slots()), Ct);
  for (const int at : part.entries) {
    const RowEntry& entry = e.rows().entries[static_cast<std::size_t>(at)];
    of_part.segment(entry.first_row, entry.m) = Ct.segment(entry.first_row, entry.m);
  }
  return !(e.norm(of_part) <= kStillRows);
}

// What the rows ask for at velocities N c, w . (Qhat(N c) + Qhat(-N c) - 2 Qhat(0))/2, one number for each w.
class Curvature {
 public:
  Curvature(Dynamics& dynamics, const State& state, const LoopPart& part, const MatX& N, const MatX& W)
      : dynamics_(dynamics), moving_(state), part_(part), N_(N), W_(W), at_rest_(asked(VecX::Zero(N.cols()))) {}

  /// The largest |w . Qhat| along three motions at random: 0 for all w only where no form bends, whatever their number.
  double sampled() {
    std::minstd_rand random(1);
    std::normal_distribution<double> normal;
    double most = 0;
    for (int k = 0; k < 3; ++k) {
      const VecX c = VecX::NullaryExpr(N_.cols(), [&] { return normal(random); });
      most = std::max(most, quadratic(c).lpNorm<Eigen::Infinity>());
    }
    return most;
  }

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
    moving_.v = motion_of(dynamics_.system(), part_.unknowns, N_ * c);
    const Evaluation& e = dynamics_.gather_rows(moving_);
    VecX Qhat(part_.n_rows);
    Eigen::Index row = 0;
    for (const int at : part_.entries) {
      const RowEntry& entry = e.rows().entries[static_cast<std::size_t>(at)];
      for (int k = 0; k < entry.m; ++k) Qhat[row++] = e.rows().block(entry).Qhat(k);
    }
    return Qhat;
  }
  VecX quadratic(const VecX& c) {
    const VecX sum = 0.5 * (asked(c) + asked(-c)) - at_rest_;
    largest_ = std::max(largest_, (W_.cwiseAbs().transpose() * sum.cwiseAbs()).lpNorm<Eigen::Infinity>());
    return W_.transpose() * sum;
  }

  Dynamics& dynamics_;
  State moving_;
  const LoopPart& part_;
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

/// Motions that are free, and combinations of rows that are zero.
struct NullSpaces {
  MatX N, W;
  double nearness = 1;  // the smallest singular value that is not zero
};

NullSpaces null_spaces(const MatX& Jt, const VecX& lengths) {
  NullSpaces found;
  const Eigen::BDCSVD<MatX> svd(Jt, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < svd.singularValues().size() && svd.singularValues()[rank] > kIn) ++rank;
  if (rank > 0) found.nearness = svd.singularValues()[rank - 1];
  found.N = svd.matrixU().rightCols(Jt.rows() - rank);
  found.W = lengths.cwiseInverse().asDiagonal() * svd.matrixV().rightCols(Jt.cols() - rank);
  return found;
}

// Where some motions are stopped, and along which lines they are not.
void find_lines(Dynamics& dynamics, const State& state, const LoopPart& part, const NullSpaces& at, BranchPoint& out) {
  const System& system = dynamics.system();
  Curvature curvature(dynamics, state, part, at.N, at.W);
  const auto flat = [&] { return kFlat * std::max(curvature.largest(), at.W.cwiseAbs().maxCoeff() / system.length()); };
  if (at.N.cols() > kMostMotions) {
    const double most = curvature.sampled();
    out.singular = most > flat();
    return;
  }
  std::vector<MatX> forms = curvature.forms();
  std::erase_if(forms, [&](const MatX& G) { return G.cwiseAbs().maxCoeff() <= flat(); });
  out.singular = !forms.empty();
  if (!out.singular) return;
  const std::vector<VecX> lines = common_zeros(forms, at.N.cols(), flat());
  out.all = lines.size() <= (at.N.cols() == 2 ? 2u : 4u);  // more are a surface of them
  if (!out.all) return;
  for (const VecX& c : lines) {
    VecX motion = motion_of(system, part.unknowns, at.N * c);
    motion /= motion_size(system, motion);
    out.tangents.push_back(std::move(motion));
  }
}

BranchPoint looked_at(Dynamics& dynamics, const State& given) {
  BranchPoint out;
  State state = given;
  dynamics.to_slots(state);
  if (!has_loops(dynamics.system(), state.modes)) return out;
  LoopPart part;
  VecX lengths;
  MatX Jt;
  {
    const Evaluation& e = dynamics.gather_rows(state);
    part = loop_part(dynamics.system(), e.rows());
    const bool fits = part.n_rows > 0 && part.n_rows <= kMostBranchRows && part.unknowns.size() <= kMostBranchUnknowns;
    if (!fits || is_driven(e, part)) return out;
    Jt = scaled_rows(e, part, lengths);
  }
  out.known = true;
  out.slots = part.slots;
  const NullSpaces at = null_spaces(Jt, lengths);
  out.nearness = at.nearness;
  out.motions = static_cast<int>(at.N.cols());
  if (at.N.cols() > 0 && at.W.cols() > 0) find_lines(dynamics, state, part, at, out);
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

bool BranchPoint::moves(const VecX& v) const {
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (v[i] != 0 && slots[static_cast<std::size_t>(i / 6)]) return true;
  return false;
}

double BranchPoint::off_branches(const System& system, const VecX& v) const {
  const auto as_lengths = [&](VecX x) {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!slots[static_cast<std::size_t>(i / 6)]) x[i] = 0;
      if (i % 6 >= 3) x[i] *= system.length();
    }
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
