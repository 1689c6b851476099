// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/frames.h"

#include <algorithm>
#include <limits>

#include <lockstep/author/relative.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/system.h>
#include "framework/dynamics/simulate/uncounted.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep::report {
namespace {

constexpr std::size_t kMostMarks = 2000;
constexpr double kFarMove = 0.05, kFarTurn = 0.2;  // of the system's length; rad

Pose pose_of(const Body& body, const Inputs& in) {
  const Motion& O = in.slot(body.slot);
  return Pose{O.x, O.e} * body.in_slot;
}

// The load of a force on a body is that on its rigid group, with the moment about the marker.
LinkWrench wrench_of(const System& system, const Force& force, const Marker& at, const Evaluated& v) {
  const Reactions reactions(v);
  const VecX f = wrench_of(system, v.in, force, &reactions);
  const int slot = at.body->slot;
  const Motion& O = v.in.slot(slot);
  const Vec3 F = f.segment<3>(6 * slot), M = O.A * f.segment<3>(6 * slot + 3);
  const Vec3 arm = in_world(MarkerFrame(at), v.in).x - O.x;
  return {F, M - cross(arm, F)};
}

// Of these markers the first on a body that moves, or null.
const Marker* moving_one(const std::vector<const Marker*>& markers) {
  for (const Marker* m : markers)
    if (m->body->slot != kGround) return m;
  return nullptr;
}

}  // namespace

void Frames::start(const Sample& sample) {
  const System& system = sample.system();
  *this = Frames(most_bytes_, fewest_);
  system_ = &system;
  for (const Body& body : system.bodies())
    if (!body.fixed) bodies_.push_back(&body);
  for (const Marker& marker : system.markers())
    if (marker.translation_law || marker.rotation_law) markers_.push_back(&marker);
  for (const auto& link : system.links()) {
    const auto pairs = link->pairs();
    if (pairs.empty() || system.merged(*link)) continue;
    if (const Marker* at = moving_one({pairs.front().first, pairs.front().second}))
      loads_.push_back({link.get(), nullptr, at});
  }
  for (const auto& force : system.forces())
    if (const Marker* at = moving_one(force->markers())) loads_.push_back({nullptr, force.get(), at});
  width_ = 13 * bodies_.size() + 7 * markers_.size() + 6 * loads_.size();
  most_ = std::max(fewest_, most_bytes_ / (sizeof(double) + sizeof(float) * width_)) / 2 * 2;  // even: the end is kept
  paths_.resize(system.links().size());
}

void Frames::output(const Sample& sample) {
  if (!times_.empty() && (times_.back() == sample.state.t || ++skipped_ < stride_)) return;
  add(sample);
}

void Frames::step(const Sample& sample) {
  if (times_.empty() || times_.back() + gap_ >= sample.state.t || !has_moved_far(sample.inputs())) return;
  add(sample);
}

void Frames::jumped(const Sample& sample) {
  if (marks_.size() < kMostMarks) marks_.push_back({sample.state.t, std::string(sample.cause)});
  add(sample);
  after_jump_.back() = true;
}

void Frames::finish(const Sample& sample) {
  if (system_ != nullptr && (times_.empty() || times_.back() < sample.state.t)) add(sample);
}

void Frames::add(const Sample& sample) {
  const Inputs& in = sample.inputs();
  if (times_.empty()) modes_at_start_ = modes_ = sample.state.modes;
  follow_modes(sample.state);
  follow_paths(in);
  // Without a frame that was not finished, because memory ran out.
  rows_.resize(times_.size() * width_), after_jump_.resize(times_.size());
  for (const Body* body : bodies_) {
    const Motion& O = in.slot(body->slot);
    const Pose at = pose_of(*body, in);
    const Vec3 w = O.A * O.w;
    put(at.x), put(at.q.coefficients()), put(O.v + cross(w, Vec3(at.x - O.x))), put(w);
  }
  for (const Marker* marker : markers_) {
    const MarkerInWorld at = in_world(MarkerFrame(*marker), in);
    put(at.x), put(quaternion_of(at.A).coefficients());
  }
  put_loads(sample);
  after_jump_.push_back(false);
  times_.push_back(sample.state.t);  // last: from here on it counts
  skipped_ = 0;
  if (times_.size() > most_) thin();
}

// Where there is no solution, the motion is shown all the same. What is solved for here is not the run's, which must not
// depend on who looks at it.
void Frames::put_loads(const Sample& of_run) {
  if (loads_.empty()) return;
  const auto looking = uncounted(of_run.dynamics());
  const Sample sample(of_run.dynamics(), of_run.state, of_run.report);
  const std::size_t first = rows_.size();
  try {
    const Solution& v = sample.values();
    for (const Load& load : loads_) {
      const LinkWrench wrench = load.link ? sample.wrench(*load.link, *load.at, Reactions::kJoint)
                                          : wrench_of(*system_, *load.force, *load.at, v);
      put(wrench.force), put(wrench.moment);
    }
  } catch (const Error&) {
    rows_.resize(first);
    rows_.insert(rows_.end(), 6 * loads_.size(), std::numeric_limits<float>::quiet_NaN());
  }
}

// The used part of a joint's path: its first quantity is the parameter of the curve.
void Frames::follow_paths(const Inputs& in) {
  for (const auto& link : system_->links()) {
    if (link->observable() == nullptr || (link->type() != "point_on_curve" && link->type() != "path_follower"))
      continue;
    const double s = link->observable()->quantity(0, in);
    auto& path = paths_[link->number()];
    path = path ? std::pair{std::min(path->first, s), std::max(path->second, s)} : std::pair{s, s};
  }
}

void Frames::follow_modes(const State& state) {
  if (modes_ == state.modes || switches_.size() > kMostMarks) return;
  for (std::size_t k = 0; k < std::min(modes_.size(), state.modes.size()); ++k)
    if (modes_[k] != state.modes[k]) switches_.push_back({state.t, static_cast<int>(k), state.modes[k]});
  modes_ = state.modes;
}

bool Frames::has_moved_far(const Inputs& in) const {
  const float* last = rows_.data() + (times_.size() - 1) * width_;
  for (const Body* body : bodies_) {
    const Pose at = pose_of(*body, in);
    const Vec3 x(last[0], last[1], last[2]);
    const Quat q{last[3], last[4], last[5], last[6]};
    if ((at.x - x).norm() > kFarMove * static_cast<double>(stride_) * system_->length()) return true;
    if (rotation_vector(normalized(conjugate(q) * at.q)).norm() > kFarTurn) return true;
    last += 13;
  }
  return false;
}

// Every other frame, and every other output from here on.
void Frames::thin() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < times_.size(); k += 2, ++kept) {
    times_[kept] = times_[k];
    after_jump_[kept] = after_jump_[k];
    std::copy_n(rows_.begin() + static_cast<std::ptrdiff_t>(k * width_), width_,
                rows_.begin() + static_cast<std::ptrdiff_t>(kept * width_));
  }
  times_.resize(kept);
  after_jump_.resize(kept);
  rows_.resize(kept * width_);
  stride_ *= 2;
  gap_ = (times_.back() - times_.front()) / static_cast<double>(kept);
}

}  // namespace lockstep::report
