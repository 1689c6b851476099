// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/start_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

double nearest_branch(double angle, double about) { return angle + kTwoPi * std::round((about - angle) / kTwoPi); }

const Lock& paired_link(const System& system, const std::string& name, Axis axis) {
  const Lock& link = system.link(name);
  if (link.pairs().empty())
    throw ModelError("joint '" + name + "' has no pair of markers, so it has no coordinate " +
                     std::string(to_string(axis)) + "; use a joint between two bodies");
  return link;
}

CoordinateRow coordinate_row(Dynamics& dynamics, const State& state, const Lock& link, Axis which) {
  const auto [p, s] = link.pairs().front();
  const MarkerFrame P(*p), S(*s);
  const RelativePair<Reads::both, true> pair(P, S, dynamics.inputs(state));
  const int k = axis_index(which) % 3;
  CoordinateRow out;
  out.value = pair.y()[k];
  using Gradient = Vec7T<double>;
  Gradient of_rate = Gradient::Unit(k), of_value = of_rate;
  if (is_rotation(which)) {
    const double e0 = pair.y()[3], ek = pair.y()[4 + k], size = e0 * e0 + ek * ek;
    const Vec3 e = pair.y().tail<3>(), axis = Vec3::Unit(k);
    of_rate << Vec3::Zero(), -2 * ek, 2 * (e0 * axis + cross(axis, e));  // w = 2 (e0 e' - e0' e + e x e'), axes of S
    out.value = std::remainder(2 * std::atan2(ek, e0), kTwoPi);
    of_value = size > 0 ? Gradient((e0 * Gradient::Unit(4 + k) - ek * Gradient::Unit(3)) * 2 / size) : of_rate;
  }
  const auto row_of = [&](const Gradient& gradient) {
    const PulledRow pulled = pair.pull(gradient);
    VecX row = VecX::Zero(6 * dynamics.system().n_slots());
    const auto put = [&](int slot, const Vec3& v, const Vec3& w) {
      if (slot != kGround) row.segment<3>(6 * slot) += v, row.segment<3>(6 * slot + 3) += w;
    };
    put(P.slot, pulled.v, pulled.w1), put(S.slot, -pulled.v, pulled.w2);
    return row;
  };
  out.rate = of_rate.dot(pair.yd());
  out.of_rate = row_of(of_rate), out.of_value = row_of(of_value);
  return out;
}

// ------------------------------------------------------------------------------------------------------------ targets

std::string StartTarget::name() const { return link->name() + "." + std::string(to_string(axis)); }

std::string StartTarget::who() const { return drive >= 0 ? "drive " + name() : "start by " + name(); }

double StartTarget::value(Dynamics& dynamics, const State& state, double about) const {
  const double value = coordinate_row(dynamics, state, *link, axis).value;
  return turns() ? nearest_branch(value, about) : value;
}

std::vector<StartTarget> targets_of(const System& system, const State& state, const AssemblyOptions& options) {
  std::vector<StartTarget> all;
  for (const auto& link : system.links()) {
    const Jointed* joint = link->jointed();
    if (joint == nullptr || !state.modes[link->number()]) continue;
    int number = -1;
    for (const Drive& drive : joint->imposed().drives) {
      ++number;
      if (drive.speed || (is_rotation(drive.axis) && joint->imposed().turn)) continue;
      const double asked = named(*link, state.t, [&] { return drive.law->at(state.t).y; });
      if (std::isfinite(asked))
        all.push_back({.link = link.get(), .axis = drive.axis, .asked = asked, .drive = number});
    }
  }
  for (const CoordinateTarget& t : options.coordinates) {
    const StartTarget target{&paired_link(system, t.link, t.axis), t.axis, t.value, t.weight};
    if (!(t.weight >= 0)) throw ModelError(fmt::format("{}: the weight {} must be 0 or more", target.who(), t.weight));
    if (!std::isfinite(t.value))
      throw ModelError(fmt::format("{}: the value {} must be finite", target.who(), t.value));
    if (t.weight > 0) all.push_back(target);
  }
  return all;
}

// ---------------------------------------------------------------------------------------------------------- all links

double LinkRows::look(const State& state) {
  now_ = &dynamics_.gather_rows(state);
  now_->residuals(C_, Cd_);
  return now_->norm(C_);
}

VecX LinkRows::step() {
  VecX d, lambda;
  dynamics_.factor(*now_).solve(*now_, VecX::Zero(6 * dynamics_.system().n_slots()), VecX(-C_), d, lambda);
  return d;
}

// -------------------------------------------------------------------------------------- links, poses and coordinates

TargetRows::TargetRows(Dynamics& dynamics, const State& given, const AssemblyOptions& options,
                       std::vector<StartTarget>& targets)
    : dynamics_(dynamics),
      system_(dynamics.system()),
      given_(given),
      options_(options),
      targets_(targets),
      n_(6 * system_.n_slots()),
      length_(system_.length()) {
  if (n_ > kMostUnknowns)
    throw ModelError(
        fmt::format("weights and coordinates of a start allow at most {1} unknowns, this mechanism has {0}; remove "
                    "them and give poses that fit",
                    n_, kMostUnknowns));
  weights_ = VecX::Ones(system_.n_slots());
  for (const PoseWeight& w : options.poses) {
    if (!(w.weight >= 0))
      throw ModelError(fmt::format("start of body '{}': the weight {} must be 0 or more", w.body, w.weight));
    const int slot = system_.body(w.body).slot;
    if (slot != kGround) weights_[slot] = w.weight;
  }
  scale_ = VecX::Ones(n_);
  const Plane plane = system_.plane();
  for (int i = 0; i < n_; ++i) {
    const int c = i % 6;
    const bool turns = c >= 3, in_plane = !plane || (turns ? c - 3 == plane.n : c != plane.n);
    const bool is_free = in_plane && !(turns && system_.slot(i / 6).freedoms == Freedoms::particle);
    scale_[i] = !is_free ? 0.0 : turns ? 1 / length_ : 1.0;
  }
}

bool TargetRows::is_led(const Lock& link, int drive) const {
  return drive >= 0 &&
         std::ranges::any_of(targets_, [&](const StartTarget& t) { return t.link == &link && t.drive == drive; });
}

void TargetRows::take_links(const Evaluation& e) {
  VecX C = Residuals(e).C;
  const Eigen::Index most = n_ + static_cast<Eigen::Index>(targets_.size());
  E_.setZero(C.size() + most, n_), c_.setZero(C.size() + most), exact_ = C.size();
  S_.setZero(most, n_), r_.setZero(most), soft_ = 0;
  for (const RowEntry& entry : e.rows().entries) {
    const Lock& link = *system_.links()[entry.link];
    for (int k = 0; k < entry.m; ++k) {
      const int row = entry.first_row + k;
      if (is_led(link, link.row(entry.own[k]).drive)) {
        C[row] = 0;
        continue;
      }
      for (int i = 0; i < entry.slots.n; ++i) {
        const auto J = e.rows().block(entry).J(i, k);
        for (int j = 0; j < 6; ++j) E_(row, 6 * entry.slots[i] + j) += J[j];
      }
    }
  }
  c_.head(C.size()) = C;
  links_ = off_ = e.norm(C);
  worst_.clear();
}

void TargetRows::add(const VecX& row, double off, double weight) {
  if (std::isinf(weight)) {
    E_.row(exact_) = row.transpose(), c_[exact_++] = off;
  } else {
    S_.row(soft_) = std::sqrt(weight) * row.transpose(), r_[soft_++] = std::sqrt(weight) * off;
  }
}

void TargetRows::take_poses(const State& state) {
  for (int k = 0; k < system_.n_slots(); ++k) {
    if (weights_[k] == 0) continue;
    const Pose now = state.slot_pose(k), asked = given_.slot_pose(k);
    const Vec3 turn = rotation_vector(conjugate(normalized(asked.q)) * normalized(now.q));
    for (int j = 0; j < 6; ++j)
      if (const double unit = j < 3 ? 1.0 : length_; scale_[6 * k + j] != 0)
        add(unit * VecX::Unit(n_, 6 * k + j), unit * (j < 3 ? now.x[j] - asked.x[j] : turn[j - 3]), weights_[k]);
  }
}

void TargetRows::take_targets(const State& state) {
  if (held_ == Held::none) return;
  for (const StartTarget& target : targets_) {
    const CoordinateRow at = coordinate_row(dynamics_, state, *target.link, target.axis);
    const double unit = target.turns() ? length_ : 1.0;
    const double value = target.turns() ? nearest_branch(at.value, target.now) : at.value;
    const double off = unit * (value - target.led);
    const bool exact = target.exact() || held_ == Held::all;
    add(unit * at.of_value, off, exact ? std::numeric_limits<double>::infinity() : target.weight);
    if (exact && std::abs(off) > off_) off_ = std::abs(off), worst_ = target.name();
  }
}

double TargetRows::look(const State& state) {
  take_links(dynamics_.gather_rows(state));
  take_poses(state);
  take_targets(state);
  E_.conservativeResize(exact_, n_), c_.conservativeResize(exact_);
  S_.conservativeResize(soft_, n_), r_.conservativeResize(soft_);
  E_ = E_ * scale_.asDiagonal(), S_ = S_ * scale_.asDiagonal();
  for (Eigen::Index k = 0; k < E_.rows(); ++k)
    if (const double size = E_.row(k).norm(); size > 0) E_.row(k) /= size, c_[k] /= size;
  return std::max(off_, c_.lpNorm<Eigen::Infinity>());
}

VecX TargetRows::step() {
  constexpr double kFree = 1e-4;  // weight of a free body: it moves a hundred times as easily as one of weight 1
  VecX easy(n_);                  // root of how easily each unknown moves
  for (int i = 0; i < n_; ++i)
    easy[i] = std::isinf(weights_[i / 6]) ? 1.0 : 1 / std::sqrt(std::max(weights_[i / 6], kFree));
  return to_slots(easy.asDiagonal() * least_norm(E_ * easy.asDiagonal(), -c_));
}

VecX TargetRows::downhill() const {
  const MatX N = null_space(E_);
  if (N.cols() == 0) return {};
  return to_slots(N * least_norm(S_ * N, -r_));
}

std::string TargetRows::missed(int rounds) const {
  std::vector<std::string> asked;
  for (const CoordinateTarget& t : options_.coordinates)
    if (std::isinf(t.weight)) asked.push_back(t.link + "." + std::string(to_string(t.axis)));
  for (const PoseWeight& w : options_.poses)
    if (std::isinf(w.weight)) asked.push_back("body " + w.body);
  if (asked.empty())
    return fmt::format(
        "assembly stopped after {} iterations: constraint errors of up to {:.3g} m remain; give poses closer to an "
        "assembled configuration, or find joints that contradict each other",
        rounds, links_);
  return fmt::format(
      "assembly stopped after {} iterations: constraint errors of up to {:.3g} m remain, the exact values are missed "
      "by "
      "{:.3g} m{}: {} contradict the joints; request fewer of them, or make them approximate",
      rounds, links_, off_, worst_.empty() ? "" : " (worst: " + worst_ + ")", text::join(asked));
}

}  // namespace lockstep
