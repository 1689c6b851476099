// SPDX-License-Identifier: BSD-3-Clause
// Statics: Newton's method on constraints and forces, towards lower potential energy.
#include <lockstep/equilibrium.h>
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/line_search.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/equilibrium_search.h"
#include "framework/tools/analysis/rest_matrices.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {
namespace {

constexpr double kLongest = 0.5;  // rad, and of the extent of the mechanism: a step of Newton's method
constexpr int kMostDense = 400;   // unknowns
constexpr double kStillDownhill = 0.9;
constexpr std::size_t kLeaves = 10;  // unstable positions that are left

}  // namespace

EquilibriumSearch::EquilibriumSearch(Dynamics& dynamics, State& state, const EquilibriumOptions& options,
                                     EquilibriumReport& report)
    : dynamics_(dynamics),
      system_(dynamics.system()),
      state_(state),
      options_(options),
      report_(report),
      now_(dynamics),
      length_(system_.length()) {
  contacts_.lay_out(system_, dynamics.options().stabilization);
  for (int k = 0; k < system_.n_slots(); ++k) heaviest_ = std::max(heaviest_, system_.slot(k).mass);
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Vec3 x = state.q.segment<3>(7 * k);
    low = k == 0 ? x : Vec3(low.cwiseMin(x)), high = k == 0 ? x : Vec3(high.cwiseMax(x));
  }
  extent_ = std::max(length_, (high - low).norm());
}

void EquilibriumSearch::run() {
  state_.v.setZero();
  touch(state_);
  settle(state_);
  start_ = state_;
  if (rests_by_friction()) {
    finish();
    return;
  }
  for (;;) {
    if (!newton(report_.iterations, options_.iterations)) relax();
    if (release()) continue;
    if (releases_ > most_releases())
      throw SolveError(
          fmt::format("statics: the one-sided joints {} close and open again without end; start nearer to the "
                      "equilibrium, or make those in contact two-sided",
                      text::join(contact_names())));
    report_.stability = judge_rest(*now_.e, now_.lambda);
    if (options_.nearest || report_.stability.unstable.empty() || report_.left.size() == kLeaves) break;
    push_off(report_.stability.unstable.front());
  }
  finish();
}

bool EquilibriumSearch::settle(State& state) {
  bool fits = false;
  try {
    fits = dynamics_.project(state, kRoundOff * length_).converged;
  } catch (const SolveError&) {
  } catch (const NonFiniteError&) {
  }
  state.v.setZero();
  const Inputs& in = dynamics_.inputs(state);  // angles continue from the previous pose
  for (const auto& angle : system_.counted_angles()) angle->set(in, angle->expected(in.s), state.s);
  return fits;
}

// More than rounding in a free motion.
double EquilibriumSearch::least_shift() const { return kNegligible * now_.force / (heaviest_ * length_); }

bool EquilibriumSearch::find_step(bool either_way) {
  return !report_.relaxed && system_.n_velocities() <= kMostDense ? find_dense_step(either_way)
                                                                  : find_sparse_step(either_way);
}

bool EquilibriumSearch::find_dense_step(bool either_way) {
  const RestMatrices A(*now_.e, now_.lambda);
  if (A.N.cols() == 0) return false;
  const VecX g = A.at.forces_in(now_.r);
  const ModalBasis motions = A.modal_basis();
  const MatX& K = motions.K;
  VecX share = motions.U.transpose() * g, y;
  if (!motions.has_potential) y = MatX(K + shift_ * MatX::Identity(K.rows(), K.cols())).partialPivLu().solve(share);
  if (motions.has_potential || !y.allFinite() || (!either_way && y.dot(share) < 0)) {
    const double rounding = kRoundOff * now_.force / std::sqrt(heaviest_);
    for (Eigen::Index i = 0; i < share.size(); ++i) {
      const double mu = K(i, i);
      if (std::abs(mu) <= 10 * kRoundOff * motions.terms(i, i))
        share[i] = std::abs(share[i]) <= rounding ? 0.0 : share[i] / std::max(shift_, now_.speed_up / length_);
      else
        share[i] /= either_way ? mu : std::abs(mu) + shift_;
    }
    y = share;
  }
  step_ = A.at.motion_of(motions.U * y);
  if (!step_.allFinite()) return false;
  if (const double size = size_of(step_); size > kLongest) step_ *= kLongest / size;
  slope_ = now_.r.dot(step_);
  return true;
}

bool EquilibriumSearch::find_sparse_step(bool either_way) {
  matrix_.gather(*now_.e, now_.lambda);
  const VecX c = -now_.C;
  const double rate = now_.speed_up / length_;
  for (; shift_ * kRoundOff <= rate; shift_ = std::max(4 * shift_, 0.25 * rate)) {
    try {
      matrix_.factor(std::max(shift_, least_shift()), 0, 1);
      matrix_.solve(now_.r, c, step_, turned_);
      slope_ = now_.r.dot(step_);
      if (size_of(step_) <= kLongest && (slope_ >= 0 || either_way)) return step_.allFinite();
    } catch (const SolveError&) {  // a larger shift has a factor
    }
    if (rate == 0) break;
  }
  return false;
}

bool EquilibriumSearch::accepts(double slope_before, double unbalanced_before, double power_before) const {
  if (now_.unbalanced <= options_.tolerance && now_.unbalanced < unbalanced_before) return true;
  if (options_.nearest) return now_.power() < power_before;
  return now_.r.dot(step_) >= -kStillDownhill * slope_before;
}

double EquilibriumSearch::size_of(const VecX& step) const {
  double size = 0;
  for (int k = 0; k < system_.n_slots(); ++k)
    size = std::max({size, step.segment<3>(6 * k).norm() / extent_, step.segment<3>(6 * k + 3).norm()});
  return size;
}

bool EquilibriumSearch::look() {
  try {
    now_.look(state_);
    return true;
  } catch (const NonFiniteError&) {
    return false;
  }
}

bool EquilibriumSearch::take_step() {
  const double slope = slope_, unbalanced = now_.unbalanced, power = now_.power();
  const bool taken = search_line(state_, [&](double share) {
    advance_state(state_, share, step_);
    if (!settle(state_)) return false;
    if (touch(state_)) return settle(state_) && look();  // the next step includes the joint
    if (!look() || !accepts(slope, unbalanced, power)) return false;
    if (share < 1)
      shift_ = std::max(2 * shift_, least_shift());
    else
      shift_ *= now_.r.dot(step_) < 0.7 * slope ? 0.1 : 0.3;
    return true;
  });
  if (!taken) now_.look(state_);
  return taken;
}

bool EquilibriumSearch::newton(int& made, int most) {
  now_.look(state_);
  for (most += made;;) {
    const bool done = now_.unbalanced <= options_.tolerance;
    if (done && now_.unbalanced == 0) return true;
    if (made >= most && !done) return false;
    if (done) shift_ = 0;
    const double before = now_.unbalanced;
    const State from = state_;
    if (!find_step(done || options_.nearest)) return done;  // at rest rounding has no direction
    ++made;
    if (!take_step()) {
      if (done || size_of(step_) <= kRoundOff) return done;
      shift_ = std::max(16 * shift_, now_.speed_up / length_);
      continue;
    }
    if (done && !(now_.unbalanced < 0.5 * before)) {  // rounding: the better of the two
      if (now_.unbalanced > before) state_ = from, now_.look(state_);
      return true;
    }
    if (motion_size(system_, now_.a) > 0 && gone()) no_equilibrium();
  }
}

bool EquilibriumSearch::moves_under_force(const Marker& marker) const {
  const bool slides = marker.translation_law && !marker.translation_law->at(state_.t).v.isZero(0),
             turns = marker.rotation_law && !marker.rotation_law->at(state_.t).w.isZero(0);
  return (slides || turns) && std::ranges::any_of(system_.forces(), [&](const std::unique_ptr<Force>& force) {
           const std::vector<const Marker*> at = force->markers();
           return force->acts(now_.e->inputs()) && std::ranges::find(at, &marker) != at.end();
         });
}

void EquilibriumSearch::finish() {
  report_.lambda = now_.lambda;
  report_.unbalanced = now_.unbalanced;
  report_.largest_force = now_.force;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    (contacts_.in_force(i, state_) ? report_.pressed : report_.free).push_back(contacts_[i].link->name());
  for (int k = 0; k < system_.n_slots(); ++k)
    if (const double move = (state_.q.segment<3>(7 * k) - start_.q.segment<3>(7 * k)).norm();
        move > report_.largest_move)
      report_.largest_move = move, report_.moved_most = system_.body_of_slot(k).name;
  if (const std::string words = beyond_friction(); !words.empty())
    report_.notes.push_back({&finding::analysis_note, "", words});
  for (const Force* force : now_.e->reacting())
    if (!report_.by_friction)
      report_.notes.push_back(
          {&finding::analysis_note, "force '" + force->name() + "'",
           fmt::format("{} '{}' exerts no friction at rest, as its law is smooth; with real friction, positions near "
                       "this one are at rest too",
                       force->type(), force->name())});
  for (const Marker& marker : system_.markers())
    if (moves_under_force(marker))
      report_.notes.push_back(
          {&finding::analysis_note, "marker '" + marker.name + "'",
           fmt::format("marker '{}' moves by a law: dampers on it act by its velocity at that time", marker.name)});
  if (system_.n_error_controlled_states() > 0)
    report_.notes.push_back(
        {&finding::analysis_note, "", "integrated states (controllers, drives by speed) keep their initial values"});
}

std::string EquilibriumReport::method() const {
  if (by_friction) return "the start, held by friction";
  const std::string newton = fmt::format("Newton's method, {} iteration{}", iterations, iterations == 1 ? "" : "s");
  return relaxed ? fmt::format("dynamic relaxation, {} steps, after {}", relaxation_steps, newton) : newton;
}

namespace {

// Moves a state that lies in the plane except for rounding exactly into it. `from`: in the plane. False: it lies
// outside.
bool put_into(Plane plane, const System& system, const State& from, State& state) {
  for (int k = 0; k < system.n_slots(); ++k) {
    Pose pose = state.slot_pose(k);
    const double height = from.slot_pose(k).x[plane.n];
    const Vec3 turn = 2 * pose.q.vec();
    if (std::abs(pose.x[plane.n] - height) > kNegligible * system.length() || std::abs(turn[plane.i()]) > kNegligible ||
        std::abs(turn[plane.j()]) > kNegligible)
      return false;
    pose.x[plane.n] = height;
    pose.q = normalized(Quat::from(pose.q.w, Vec3(pose.q.vec()[plane.n] * Vec3::Unit(plane.n))));
    state.set_slot_pose(k, pose);
  }
  return true;
}

VecX multipliers_of(const RowTable& rows, const RowTable& in_space, const VecX& lambda) {
  VecX own(rows.n_rows);
  for (const RowEntry& e : rows.entries) {
    const RowEntry& all = in_space.entries[in_space.entry_of_link[e.link]];
    for (int k = 0; k < e.m; ++k)
      own[e.first_row + static_cast<int>(k)] =
          lambda[all.first_row + (std::ranges::find(all.own, e.own[k]) - all.own.begin())];
  }
  return own;
}

}  // namespace

void go_back_to_plane(Dynamics& dynamics, System::InSpace& look, const State& start, const std::vector<AtRest>& found) {
  if (!look.plane()) return;
  std::vector<RowTable> rows;
  for (const AtRest& each : found) {
    if (!put_into(look.plane(), dynamics.system(), start, each.state)) return look.stay();
    rows.push_back(dynamics.gather_rows(each.state).rows());
  }
  look.end();
  for (std::size_t i = 0; i < found.size(); ++i)
    found[i].report.lambda =
        multipliers_of(dynamics.gather_rows(found[i].state).rows(), rows[i], found[i].report.lambda);
}

EquilibriumReport find_equilibrium(Dynamics& dynamics, State& state, const EquilibriumOptions& options) {
  EquilibriumReport report;
  State work = state;
  dynamics.to_slots(work);
  const State start = work;
  System::InSpace look = dynamics.look_in_space();
  EquilibriumSearch(dynamics, work, options, report).run();
  go_back_to_plane(dynamics, look, start, {{work, report}});
  state = std::move(work);
  return report;
}

}  // namespace lockstep
