// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Two bodies and the ground with a marker each, moved by hand: the bench on which forces are tested without a System.

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/counted_angle.h>
#include "tests/support/configuration.h"

namespace lockstep::oracle {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A scalar law from a function of time; only its value is asked of forces.
class ValueLaw final : public MotionLaw {
 public:
  explicit ValueLaw(std::function<double(double)> y) : y_(std::move(y)) {}
  LawValue at(double t) const override { return {y_(t), 0, 0}; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (t0 < 0.25 && 0.25 < t1) out.push_back(0.25);
  }

 private:
  std::function<double(double)> y_;
};
inline LawPtr<MotionLaw> value_law(std::function<double(double)> y) { return std::make_shared<ValueLaw>(std::move(y)); }

/// x = amplitude sin(3 t), with its exact derivatives.
class SineSlide final : public TranslationLaw {
 public:
  explicit SineSlide(const lockstep::Vec3& amplitude) : a_(amplitude) {}
  TranslationValue at(double t) const override {
    return {std::sin(3 * t) * a_, 3 * std::cos(3 * t) * a_, -9 * std::sin(3 * t) * a_};
  }

 private:
  lockstep::Vec3 a_;
};

/// A steady turn about an axis.
class SteadySpin final : public RotationLaw {
 public:
  explicit SteadySpin(const lockstep::Vec3& w) : w_(w) {}
  RotationValue at(double t) const override { return {exponential(w_ * t), w_, lockstep::Vec3::Zero()}; }

 private:
  lockstep::Vec3 w_;
};

/// Counted angles without a system, and their states.
struct BenchAngles final : AngleCounter {
  std::vector<std::unique_ptr<CountedAngle>> all;
  VecX states;
  using AngleCounter::count;
  CountedAngle& count(std::unique_ptr<CountedAngle> angle) override {
    const auto n = static_cast<int>(all.size());
    angle->setup(), angle->place(n, n * CountedAngle::kStates);
    states.conservativeResize((n + 1) * CountedAngle::kStates), states.tail(CountedAngle::kStates).setZero();
    return *all.emplace_back(std::move(angle));
  }
};

struct ForceBench {
  Body a, b, ground;
  Marker p, s, g;   ///< on a, b and the ground
  Motion start[2];  ///< of the slots 0 and 1 at t = 0
  std::vector<Motion> motions{3};
  BenchAngles angles;
  double t = 0;

  explicit ForceBench(std::uint64_t seed = 1) {
    Draw draw(seed);
    a.name = "a", b.name = "b", ground.name = "ground";
    ground.fixed = true;
    a.slot = 0, b.slot = 1, ground.slot = kGround;
    const auto pose = [&] { return Pose{draw.vector(0.5), lockstep::Quat::from(draw.quaternion())}; };
    a.in_slot = pose(), b.in_slot = pose();
    a.home = pose(), b.home = pose();
    p = {"p", &a, pose()}, s = {"s", &b, pose()}, g = {"g", &ground, pose()};
    for (Motion& m : start)
      m.x = draw.vector(1.0), m.e = lockstep::Quat::from(draw.quaternion()), m.v = draw.vector(2.0),
      m.w = draw.vector(2.0);
    at(0);
  }

  /// Moves both bodies from their start with constant v and w to the time t.
  void at(double time) {
    t = time;
    for (std::size_t k = 0; k < 2; ++k) {
      Motion& m = motions[k + 1];
      m = start[k];
      m.x += t * m.v;
      m.e = normalized(m.e * exponential(t * m.w));
      m.A = rotation(m.e);
    }
  }
  /// Puts the marker of slot k at a pose in the world (without laws) with the twist of the slot's origin.
  void place(const Marker& m, const Pose& world, const lockstep::Vec3& v = lockstep::Vec3::Zero(),
             const lockstep::Vec3& w_world = lockstep::Vec3::Zero()) {
    const Pose slot = world * inverse(m.body->in_slot * m.local);
    Motion& o = start[m.body->slot];
    o.x = slot.x, o.e = slot.q, o.A = rotation(slot.q), o.w = o.A.transpose() * w_world;
    o.v = v + lockstep::cross(w_world, lockstep::Vec3(slot.x - world.x));
    at(t);
  }
  Inputs in() const { return {t, motions, {angles.states.data(), static_cast<std::size_t>(angles.states.size())}, {}}; }

  VecX wrench(const Force& force) const {
    VecX f = VecX::Zero(12);
    WrenchSum sum(motions, f);
    force.apply(in(), sum);
    return f;
  }
  lockstep::Vec3 force_on(const Force& force, int slot) const { return wrench(force).segment<3>(6 * slot); }
  /// Moment about the slot's origin, world axes.
  lockstep::Vec3 moment_on(const Force& force, int slot) const {
    return in().slot(slot).A * wrench(force).segment<3>(6 * slot + 3);
  }
  /// Moment about the world's origin, of both bodies together or of one.
  lockstep::Vec3 moment_about_origin(const Force& force, int slot) const {
    return moment_on(force, slot) + lockstep::cross(in().slot(slot).x, force_on(force, slot));
  }
  /// f.v over the slots.
  double power(const Force& force) const {
    const VecX f = wrench(force);
    double sum = 0;
    for (int k = 0; k < 2; ++k)
      sum += f.segment<3>(6 * k).dot(in().slot(k).v) + f.segment<3>(6 * k + 3).dot(in().slot(k).w);
    return sum;
  }
  /// Time derivative of a quantity along the motion: central difference of order 8.
  double rate_of(const std::function<double()>& quantity) {
    const double h = 1e-2, now = t, weights[4] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
    double sum = 0;
    for (int k = 1; k <= 4; ++k) {
      at(now + k * h);
      const double ahead = quantity();
      at(now - k * h);
      sum += weights[k - 1] * (ahead - quantity());
    }
    at(now);
    return sum / h;
  }
};

/// Index of a quantity by its name; the number of quantities when there is none.
inline int quantity_index(const Force& force, const std::string& name) {
  const std::vector<Quantity> all = force.observable()->quantities();
  int k = 0;
  while (k < static_cast<int>(all.size()) && all[k].name != name) ++k;
  return k;
}

}  // namespace lockstep::oracle
