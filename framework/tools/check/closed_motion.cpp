// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/closed_motion.h"

#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>

#include <lockstep/author/force.h>
#include <lockstep/joints.h>

namespace lockstep {

double ClosedMotion::error(const State& s) const {
  const Pose is = s.slot_pose(0), should_be = pose(s.t);
  return (is.x - should_be.x).norm() + rotation_vector(conjugate(should_be.q) * normalized(is.q)).norm();
}

ClosedMotion free_top() {
  const Vec3 J(0.4, 0.4, 0.7), x0(0.1, 0.2, 0.3), v0(1, -2, 3), w0(1.1, 0.4, 2.5), g(0.3, 0, -9.81);
  const Quat q0 = exponential(Vec3(0.3, -0.5, 0.2));
  ClosedMotion m{"free top", 2.0, std::make_unique<System>(System::Options{g}), {}};
  m.system->add_body("top", {2, Vec3::Zero(), J.asDiagonal()}, {x0, q0}).start = {v0, w0};
  m.system->setup();
  const Vec3 L = rotation(q0) * J.cwiseProduct(w0);
  m.pose = [=](double t) {
    const Quat q = exponential(Vec3(t / J[0] * L)) * q0 * exponential(Vec3(0, 0, t * (1 - J[2] / J[0]) * w0[2]));
    return Pose{x0 + t * v0 + 0.5 * t * t * g, q};
  };
  return m;
}

namespace {

/// Counts accepted steps: a memory that methods have to leave alone.
class StepCounter final : public Force, public Remembering {
 public:
  explicit StepCounter(const Marker& at) : Force("counter"), at_(at) {}
  std::string_view type() const override { return "counter"; }
  std::vector<const Marker*> markers() const override { return {&at_}; }
  void setup() override {}
  void apply(const Inputs&, WrenchSum&) const override {}
  const Remembering* remembering() const override { return this; }
  int n_memory() const override { return 1; }
  void start_memory(std::span<double> z) const override { z[0] = 0; }
  void accept_step(const Inputs&, std::span<double> z) const override { ++z[0]; }

 private:
  const Marker& at_;
};

}  // namespace

ClosedMotion hinged_pendulum() {
  constexpr double kAngle = 1.2, kLength = 0.8, kG = 9.81, kMass = 1.5;
  ClosedMotion m{"pendulum", 1.5, std::make_unique<System>(System::Options{{0, 0, -kG}}), {}};
  const auto end = [](double a) { return Vec3(kLength * std::sin(a), 0, -kLength * std::cos(a)); };
  Body& body = m.system->add_body("rod", shapes::rod(kMass, Vec3::Zero(), end(kAngle)));
  auto& hinge = m.system->add<Revolute>("hinge", body, m.system->ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
  m.system->add(std::make_unique<StepCounter>(*hinge.pairs().front().first));
  m.system->setup();
  const double J = body.mass.J(1, 1) + kMass * kLength * kLength / 4;  // about the hinge
  const double rate = std::sqrt(kMass * kG * 0.5 * kLength / J), k = std::sin(0.5 * kAngle);
  const Quat q0 = body.home.q;
  m.pose = [=](double t) {
    const double a = 2 * std::asin(k * boost::math::jacobi_cd(k, rate * t));
    return Pose{0.5 * end(a), axis_angle(Vec3(0, -1, 0), a - kAngle) * q0};
  };
  return m;
}

}  // namespace lockstep
