#include "framework/dynamics/simulate/nearest_start.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/relative.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/coordinate_row.h"
#include "framework/dynamics/simulate/start_turns.h"

namespace lockstep {

namespace {

constexpr int kMostUnknowns = 1500;  // a dense decomposition of them takes a second

// An angle as the nearest to zero.
double wrapped(double angle) { return std::remainder(angle, kTwoPi); }

class NearestStart {
 public:
  NearestStart(Dynamics& dynamics, State& state, const AssemblyOptions& options, bool follows)
      : dynamics_(dynamics),
        system_(dynamics.system()),
        state_(state),
        given_(state),
        options_(options),
        follows_(follows),
        n_(6 * system_.n_slots()),
        length_(system_.length()) {
    if (n_ > kMostUnknowns)
      throw ModelError(
          fmt::format("weights and coordinates of starts are solved for densely: {} unknowns are more than {}; "
                      "leave them out and give poses that fit",
                      n_, kMostUnknowns));
    weights_ = VecX::Ones(system_.n_slots());
    for (const PoseWeight& w : options.poses) {
      if (!(w.weight >= 0))
        throw ModelError(fmt::format("start of body '{}': the weight {} is not 0 or more", w.body, w.weight));
      const int slot = system_.body(w.body).slot;
      if (slot != kGround) weights_[slot] = w.weight;
    }
    for (const CoordinateTarget& t : options.coordinates) {
      if (!(t.weight >= 0))
        throw ModelError(fmt::format("start by {}: the weight {} is not 0 or more", name_of(t), t.weight));
      if (!std::isfinite(t.value))
        throw ModelError(fmt::format("start by {}: the value {} is not finite", name_of(t), t.value));
    }
    most_short_ = static_cast<int>(std::clamp(2e10 / (1.0 * n_ * n_ * n_), 4'000.0, 50'000.0));
    for (const CoordinateTarget& t : options.coordinates) angles_.push_back(t.value);
    freedom_ = VecX::Ones(n_);
    const Plane plane = system_.plane();
    for (int k = 0; k < system_.n_slots(); ++k) {
      const bool particle = system_.slot(k).freedoms == Freedoms::particle;
      for (int c = 0; c < 6; ++c) {
        const bool in_plane = !plane || (c < 3 ? c != plane.n : c - 3 == plane.n);
        if ((particle && c >= 3) || !in_plane) freedom_[6 * k + c] = 0;
      }
    }
  }

  int run() {
    int rounds = restore(true);
    double cost = linearise();
    int cut = 0;
    for (int round = 0; round - cut < options_.iterations; ++round, ++rounds) {
      // along the free motions, to where the linear cost is least
      const Eigen::CompleteOrthogonalDecomposition<MatX> rows(E_);
      const Eigen::Index rank = rows.rank(), free = n_ - rank;
      if (free == 0 || cost == 0) break;
      const MatX Z = MatX(rows.matrixZ().adjoint().rightCols(free));
      const MatX N = rows.colsPermutation() * Z;
      const VecX y = Eigen::CompleteOrthogonalDecomposition<MatX>(S_ * N).solve(-r_);
      const VecX d = N * y;
      if (d.lpNorm<Eigen::Infinity>() < kStill * length_) break;
      const State from = state_;
      const double whole = follows_ ? short_share(system_.n_slots(), d, length_) : 1.0;
      double next = HUGE_VAL, share = whole;
      for (; share > kLeastShare * whole; share *= 0.5) {
        state_ = from;
        move(share, d);
        try {
          if (follows_) follow_turns(dynamics_, state_);
          restore(false);
        } catch (const AssemblyError&) {
          continue;
        }
        next = linearise();
        if (next < cost) break;
      }
      if (!(next < cost)) {
        state_ = from;
        break;
      }
      if (whole < 1 && next < (1 - 0.1 * whole) * cost && cut < most_short_) ++cut;
      const bool settled = cost - next < kSettled * cost;
      cost = next;
      if (settled) break;
    }
    return rounds;
  }

 private:
  static constexpr double kStill = 1e-11, kLeastShare = 1e-3, kSettled = 1e-14;

  // What is to hold exactly, c = 0, with its rows E, and what is asked for, r = 0, with S; unknowns as lengths. The cost.
  double linearise() {
    const Evaluation& e = dynamics_.gather_rows(state_);
    VecX C, Cd;
    e.residuals(C, Cd);
    std::vector<VecX> exact, soft;
    std::vector<double> c, r;
    MatX J = MatX::Zero(C.size(), n_);
    for (const RowEntry& entry : e.rows().entries)
      for (int i = 0; i < entry.slots.n; ++i)
        for (int k = 0; k < entry.m; ++k) {
          const auto row = e.rows().block(entry).J(i, k);
          for (int j = 0; j < 6; ++j)
            J(entry.first_row + k, 6 * entry.slots[i] + j) += row[static_cast<std::size_t>(j)];
        }
    links_ = e.norm(C);
    for (int k = 0; k < system_.n_slots(); ++k) {
      const Pose now = state_.slot_pose(k), asked = given_.slot_pose(k);
      const Vec3 turn = rotation_vector(conjugate(normalized(asked.q)) * normalized(now.q));
      for (int j = 0; j < 6; ++j) {
        if (freedom_[6 * k + j] == 0 || weights_[k] == 0) continue;
        const double off = j < 3 ? now.x[j] - asked.x[j] : turn[j - 3];
        if (std::isinf(weights_[k])) {
          exact.push_back(VecX::Unit(n_, 6 * k + j)), c.push_back(off);
        } else {
          const double w = std::sqrt(weights_[k]) * (j < 3 ? 1.0 : length_);
          soft.push_back(w * VecX::Unit(n_, 6 * k + j)), r.push_back(w * off);
        }
      }
    }
    farthest_ = links_, worst_.clear();
    for (std::size_t k = 0; k < options_.coordinates.size(); ++k) {
      const CoordinateTarget& target = options_.coordinates[k];
      const CoordinateRow at = coordinate_row(dynamics_, state_, target.link, target.axis);
      const bool turns = is_rotation(target.axis);
      if (turns && follows_) angles_[k] += wrapped(at.value - angles_[k]);
      const double off = !turns     ? at.value - target.value
                         : follows_ ? angles_[k] - target.value
                                    : wrapped(at.value - target.value);
      const double unit = turns ? length_ : 1.0;
      if (std::isinf(target.weight)) {
        exact.push_back(at.row), c.push_back(off);
        if (std::abs(off) * unit > farthest_) farthest_ = std::abs(off) * unit, worst_ = name_of(target);
      } else {
        const double w = std::sqrt(target.weight) * unit;
        soft.push_back(w * at.row), r.push_back(w * off);
      }
    }
    E_.resize(C.size() + static_cast<Eigen::Index>(exact.size()), n_);
    c_.resize(E_.rows());
    E_.topRows(C.size()) = J, c_.head(C.size()) = C;
    for (std::size_t k = 0; k < exact.size(); ++k) {
      E_.row(C.size() + static_cast<Eigen::Index>(k)) = exact[k].transpose();
      c_[C.size() + static_cast<Eigen::Index>(k)] = c[k];
    }
    S_.resize(static_cast<Eigen::Index>(soft.size()), n_), r_.resize(S_.rows());
    for (std::size_t k = 0; k < soft.size(); ++k) {
      S_.row(static_cast<Eigen::Index>(k)) = soft[k].transpose();
      r_[static_cast<Eigen::Index>(k)] = r[k];
    }
    // turns as lengths; rows of length 1
    VecX scale = freedom_;
    for (int i = 0; i < n_; ++i)
      if (i % 6 >= 3) scale[i] /= length_;
    E_ = E_ * scale.asDiagonal(), S_ = S_ * scale.asDiagonal();
    for (Eigen::Index k = 0; k < E_.rows(); ++k)
      if (const double size = E_.row(k).norm(); size > 0) E_.row(k) /= size, c_[k] /= size;
    return r_.squaredNorm();
  }

  double off() const { return std::max(farthest_, c_.size() > 0 ? c_.lpNorm<Eigen::Infinity>() : 0.0); }

  // Newton's method onto the links and what is exact, by the least move: of light bodies first. `from_afar`: the state may
  // be anywhere.
  int restore(bool from_afar) {
    linearise();
    const double goal = std::max(options_.tolerance, 1e-13 * length_);
    int round = 0;
    for (const int cut_before = cut_; off() > goal; ++round) {
      if (round - (cut_ - cut_before) >= options_.iterations) stop(round);
      VecX easy(n_);  // root of how easily each unknown moves
      for (int i = 0; i < n_; ++i) {
        const double w = weights_[i / 6];
        easy[i] = std::isinf(w) ? 1.0 : 1 / std::sqrt(std::max(w, kFree));
      }
      const MatX rows = E_ * easy.asDiagonal();
      const VecX d = easy.asDiagonal() * Eigen::CompleteOrthogonalDecomposition<MatX>(rows).solve(-c_);
      const State from = state_;
      const double now = off();
      const double whole = follows_ ? short_share(system_.n_slots(), d, length_) : 1.0;
      for (double share = whole;; share *= 0.5) {
        state_ = from;
        move(share, d);
        linearise();
        if (off() < now || share < kLeastShare * whole) break;
      }
      if (whole < 1 && off() < (1 - 0.1 * whole) * now && cut_ < most_short_) ++cut_;
      if (!(off() < now)) {
        if (now < 1e3 * goal) {
          state_ = from;
          linearise();
          break;
        }
        if (!from_afar || ++stalls_ > 5) stop(round);
      }
      if (follows_) follow_turns(dynamics_, state_), linearise();
    }
    return round;
  }

  void move(double share, const VecX& d) {
    for (int k = 0; k < system_.n_slots(); ++k) {
      Pose pose = state_.slot_pose(k);
      pose.x += share * d.segment<3>(6 * k);
      pose.q = normalized(pose.q * exponential(Vec3(share / length_ * d.segment<3>(6 * k + 3))));
      state_.set_slot_pose(k, pose);
    }
  }

  [[noreturn]] void stop(int rounds) const {
    std::vector<std::string> asked;
    for (const CoordinateTarget& t : options_.coordinates)
      if (std::isinf(t.weight)) asked.push_back(name_of(t));
    for (const PoseWeight& w : options_.poses)
      if (std::isinf(w.weight)) asked.push_back("body " + w.body);
    if (asked.empty())
      throw AssemblyError(fmt::format(
          "assembly stopped after {} rounds at {:.3g} m off the links: the links cannot be met together from "
          "this start; give poses nearer to ones that fit, or look for links that contradict each other",
          rounds, links_));
    throw AssemblyError(
        fmt::format("assembly stopped after {} rounds at {:.3g} m off the links, and {:.3g} m off what is asked for "
                    "exactly{}: {} cannot "
                    "hold together with the links; ask for fewer of them, or make them approximate",
                    rounds, links_, off(), worst_.empty() ? "" : " (most of all " + worst_ + ")", text::join(asked)));
  }

  static std::string name_of(const CoordinateTarget& t) { return t.link + "." + std::string(to_string(t.axis)); }

  static constexpr double kFree = 1e-4;  // a free body moves a hundred times as easily as one of weight 1

  Dynamics& dynamics_;
  const System& system_;
  State& state_;
  const State given_;
  const AssemblyOptions& options_;
  const bool follows_;
  int n_;
  int most_short_ = 0, cut_ = 0;  // short steps beside the rounds: how many may be and are made on the way
  double length_;
  std::vector<double>
      angles_;  // of the coordinates asked for, of those that are turns: as far as they were followed, rad
  VecX weights_, freedom_;
  MatX E_, S_;
  VecX c_, r_;
  double links_ = 0, farthest_ = 0;
  std::string worst_;
  int stalls_ = 0;
};

}  // namespace

int nearest_start(Dynamics& dynamics, State& state, const AssemblyOptions& options, bool follows) {
  return NearestStart(dynamics, state, options, follows).run();
}

}  // namespace lockstep
