// SPDX-License-Identifier: BSD-3-Clause
// A fully driven mechanism from pose to pose.
#include <lockstep/kinematics.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include <lockstep/author/lock.h>
#include <lockstep/author/stepping.h>
#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/wild_starts.h"

namespace lockstep {
namespace {

constexpr double kBranch = 0.05;  // lengths: a pose farther from the predicted one may lie on another branch

// By Gauss and Legendre, with five nodes.
double integral(const MotionLaw& speed, double t0, double t1) {
  return boost::math::quadrature::gauss<double, 5>::integrate([&](double t) { return speed.at(t).y; }, t0, t1);
}

}  // namespace

DrivenMotion::DrivenMotion(Dynamics& dynamics, State start)
    : dynamics_(dynamics), state_(dynamics.in_slots(std::move(start))) {
  if (const DriveReport driven = driven_by(dynamics_, state_); !driven.fully_driven())
    throw ModelError(
        (driven.freedoms > 0 ? "the motion is not fully prescribed: " : "the motion is prescribed twice: ") +
        driven.text());
  for (const auto& link : dynamics_.system().links()) {
    if (link->jointed() == nullptr) continue;
    for (const Drive& drive : link->jointed()->imposed().drives)
      if (drive.speed) speed_drives_.push_back({drive.law.get(), link->first_state() + drive.state});
  }
  check_states();
  trial_ = guess_ = state_;
  a_.setZero(state_.v.size()), jerk_.setZero(state_.v.size()), way_.setZero(state_.v.size());
}

void DrivenMotion::check_states() const {
  const System& system = dynamics_.system();
  std::vector<std::string> names;
  for (const auto& each : system.auxiliaries()) names.push_back("'" + each->name() + "'");
  for (const auto& link : system.links())
    if (link->n_own_states() > 0 && link->jointed() == nullptr) names.push_back("'" + link->name() + "'");
  if (names.empty()) return;
  throw ModelError("the motion is not fully prescribed: " + text::join(names) +
                   " is integrated over time (a controller, a work); use a run, or leave it out");
}

void DrivenMotion::move_speed_drives(double t0, double t1) {
  if (speed_drives_.empty()) return;
  std::vector<double> ends = passes::breakpoints(dynamics_.system(), std::min(t0, t1), std::max(t0, t1));
  if (t1 < t0) std::ranges::reverse(ends);
  ends.push_back(t1);
  for (const SpeedDrive& drive : speed_drives_) {
    double from = t0;
    for (const double to : ends) trial_.s[drive.state] += integral(*drive.law, from, to), from = to;
  }
}

/// Gives the trial's angles the values of its pose. False, and why, if a constrained one is far from its prediction.
bool DrivenMotion::settle_angles() {
  const Inputs& in = dynamics_.inputs(trial_);
  for (const auto& angle : dynamics_.system().counted_angles()) {
    const double led = angle->expected(in.s);
    angle->set(in, led, trial_.s);
    if (!angle->coupled() || std::abs(angle->expected(in.s) - led) < CountedAngle::kInDoubt) continue;
    why_ = "the " + angle->name() + " is more than 90 deg from its predicted value";
    return false;
  }
  return true;
}

/// One step. False, and why, if no pose near the predicted one satisfies the constraints.
bool DrivenMotion::step(double t) {
  const double h = t - state_.t;
  const auto fails = [this](std::string why) { return why_ = std::move(why), false; };
  trial_ = state_;
  way_ = state_.v + 0.5 * h * a_ + h * h / 6 * jerk_;
  advance_state(trial_, h, way_);
  trial_.v += h * a_ + 0.5 * h * h * jerk_;
  trial_.t = t;
  move_speed_drives(state_.t, t);
  normalize_state(trial_);
  lead_angles(dynamics_, state_, trial_);
  guess_.q = trial_.q;
  const ProjectReport moved = dynamics_.project(trial_);
  if (!moved.converged) return fails("no position near the previous one satisfies the constraints");
  if (!(moved.after_v <= kSlight * std::max(1.0, trial_.v.lpNorm<Eigen::Infinity>())))
    return fails(fmt::format(
        "the drives prescribe a velocity that the joints do not allow, by {:.2g} m/s (dead centre)", moved.after_v));
  if (h != 0 && apart(dynamics_.system(), guess_, trial_) > kBranch * dynamics_.system().length())
    return fails("the next position is not reached continuously");
  if (!settle_angles()) return false;
  std::swap(state_, trial_);
  if (dynamics_.system().n_memory() > 0) dynamics_.accept(state_);
  solution_ = &dynamics_.solution_at(state_);
  if (h != 0 && steps_ > 0) jerk_ = (solution_->a - a_) / h;
  a_ = solution_->a;
  ++steps_;
  return true;
}

// A law that jumps in position leads to no pose after it, as in a run.
void DrivenMotion::refuse_jumps(double t0, double t1) {
  for (const double jump : passes::breakpoints(dynamics_.system(), t0, std::nextafter(t1, HUGE_VAL))) {
    trial_ = state_, trial_.t = std::nextafter(jump, t0);
    const PositionJump before(dynamics_, trial_);
    trial_.t = jump;
    if (const auto refusal = before.refusal(dynamics_, trial_, StepLoopOptions().start_limit)) throw *refusal;
  }
}

const Solution& DrivenMotion::to(double t) {
  if (steps_ == 0 && !step(state_.t)) refuse(state_.t);
  if (t > state_.t) refuse_jumps(state_.t, t);
  const double whole = t - state_.t;
  double h = whole;
  while (state_.t != t) {
    const double left = t - state_.t;
    const bool last = std::abs(h) >= std::abs(left) * (1 - kRoundOff);
    if (step(last ? t : state_.t + h)) {
      h *= 2;
      continue;
    }
    h = 0.5 * (last ? left : h);
    if (std::abs(h) < kSlight * std::abs(whole)) refuse(state_.t + h);
  }
  if (solution_ == nullptr || whole == 0) solution_ = &dynamics_.solution_at(state_);
  return *solution_;
}

void DrivenMotion::refuse(double t) const {
  const Evaluation& e = dynamics_.gather(trial_);
  VecX C, Cd;
  e.residuals(C, Cd);
  Eigen::Index worst = 0;
  if (C.size() > 0) (e.norm(C) > kSlight * e.system().length() ? C : Cd).cwiseAbs().maxCoeff(&worst);
  throw AssemblyError(fmt::format(
      "kinematics stopped at t = {:.9g} s: {}, worst: {}; a law may jump in position, or exceed the range of the "
      "mechanism",
      t, why_, C.size() > 0 ? passes::row_name(e.system(), e.rows(), static_cast<int>(worst)) : "none"));
}

}  // namespace lockstep
