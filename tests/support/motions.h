// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Motions with a closed form, to hold integrators against.

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <memory>

#include <lockstep/author/integrator.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/worst.h"

/// A free body of revolution (axis z), thrown: the centre flies a parabola, the body turns about its angular momentum
/// at a steady rate and about its own axis at another.
struct ThrownTop {
  static constexpr double kJ1 = 0.4, kJ3 = 0.7;
  lockstep::Vec3 v0{1, -2, 3}, g{0.3, 0, -9.81};
  lockstep::Twist start{v0, {1.1, 0.4, 2.5}};
  lockstep::Quat q0 = lockstep::exponential(lockstep::Vec3(0.3, -0.5, 0.2));
  lockstep::System system{lockstep::System::Options{g}};

  ThrownTop() {
    lockstep::MassProperties m;
    m.mass = 2;
    m.J = lockstep::Vec3(kJ1, kJ1, kJ3).asDiagonal();
    system.add_body("top", m, {{0.1, 0.2, 0.3}, q0}).start = start;
    system.setup();
  }
  /// L is constant, w = L/J1 + (1 - J3/J1) w3 e3: q = exp(t L/J1) q0 exp(t (1 - J3/J1) w3 e3).
  lockstep::Pose pose(double t) const {
    using namespace lockstep;
    const Vec3 L = rotation(q0) * Vec3(kJ1 * start.w[0], kJ1 * start.w[1], kJ3 * start.w[2]);
    const Quat q = exponential(Vec3(t / kJ1 * L)) * q0 * exponential(Vec3(0, 0, t * (1 - kJ3 / kJ1) * start.w[2]));
    return {Vec3(0.1, 0.2, 0.3) + t * v0 + 0.5 * t * t * g, q};
  }
  /// Distance plus angle, m and rad.
  double error(const lockstep::State& s) const {
    const lockstep::Pose p = s.slot_pose(0), exact = pose(s.t);
    return (p.x - exact.x).norm() + lockstep::rotation_vector(lockstep::conjugate(exact.q) * p.q).norm();
  }
};

/// A rod on a hinge through the ground's origin (axis y), released at rest at `angle` from the vertical.
struct RodPendulum {
  static constexpr double kLength = 0.8, kG = 9.81;
  double angle;
  lockstep::System system{lockstep::System::Options{{0, 0, -kG}}};

  explicit RodPendulum(double angle_ = 1.2) : angle(angle_) {
    using namespace lockstep;
    const Vec3 end(kLength * std::sin(angle), 0, -kLength * std::cos(angle));
    Body& rod = system.add_body("rod", shapes::rod(1.5, Vec3::Zero(), end));
    system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
    system.setup();
    w2_ = 1.5 * kG * 0.5 * kLength / inertia();
  }
  /// About the hinge: a cylinder of radius length/50 (shapes' default), at half its length from it.
  double inertia() const {
    const double r = kLength / 50;
    return 1.5 * (kLength * kLength / 3 + r * r / 4);
  }
  /// sin(theta/2) = k cd(w t, k), k = sin(angle/2).
  double theta(double t) const {
    const double k = std::sin(0.5 * angle), u = std::sqrt(w2_) * t;
    return 2 * std::asin(k * boost::math::jacobi_cd(k, u));
  }
  double error(const lockstep::State& s) const {
    const lockstep::Vec3 x = s.slot_pose(0).x;
    const double a = theta(s.t);
    return (x - 0.5 * kLength * lockstep::Vec3(std::sin(a), 0, -std::cos(a))).norm();
  }

 private:
  double w2_ = 0;
};

/// A four-bar of hinges in space (redundant rows) with a stiff spring and damper across it, let go.
struct SprungLoop {
  lockstep::System system{lockstep::System::Options{{0, -9.81, 0}}};

  SprungLoop() {
    using namespace lockstep;
    const Vec3 B(0.1, 0.03, 0), C(0.3, 0.25, 0), D(0.28, 0, 0), z = Vec3::UnitZ();
    Body& crank = system.add_body("crank", shapes::rod(0.5, Vec3::Zero(), B));
    Body& coupler = system.add_body("coupler", shapes::rod(1.2, B, C));
    Body& rocker = system.add_body("rocker", shapes::rod(0.9, C, D));
    system.add<Revolute>("A", crank, system.ground(), pose_at(Vec3::Zero(), z));
    system.add<Revolute>("B", coupler, crank, pose_at(B, z));
    system.add<Revolute>("C", rocker, coupler, pose_at(C, z));
    system.add<Revolute>("D", rocker, system.ground(), pose_at(D, z));
    Marker &p = system.add_marker("p", coupler), &s = system.add_marker("s", system.ground(), {{0, 0.3, 0}, {}});
    system.add<SpringDamper>("spring", p, s, {.stiffness = 1e5, .damping = 1e3, .free_length = 0.15});
    system.setup();
  }
};

inline lockstep::Dynamics dynamics_of(lockstep::System& system, lockstep::DynamicsOptions options = {}) {
  return lockstep::Dynamics(system, std::make_unique<lockstep::DenseSolver>(), options);
}

/// n equal steps to time T; the state there.
inline lockstep::State stepped(lockstep::Dynamics& dynamics, lockstep::Integrator& method, double T, int n) {
  lockstep::State s = dynamics.system().start();
  method.begin(dynamics, s);
  for (int i = 0; i < n; ++i) method.step(dynamics, s, T / n);
  s.t = T;
  return s;
}

/// Largest error after any of n equal steps to time T.
template <class Motion>
double largest_error(Motion& motion, lockstep::Integrator& method, double T, int n) {
  lockstep::Dynamics dynamics(motion.system, std::make_unique<lockstep::DenseSolver>());
  lockstep::State s = motion.system.start();
  method.begin(dynamics, s);
  double worst = 0;
  for (int i = 0; i < n; ++i) {
    method.step(dynamics, s, T / n);
    lockstep::keep_worst(worst, motion.error(s));
  }
  return worst;
}

/// log2 of the largest errors of n and 2 n steps.
template <class Motion>
double measured_order(Motion& motion, lockstep::Integrator& method, double T, int n) {
  return std::log2(largest_error(motion, method, T, n) / largest_error(motion, method, T, 2 * n));
}

/// The same for the dense output inside one step of h and of h/2, begun exactly.
template <class Motion>
double measured_dense_order(Motion& motion, lockstep::Integrator& method, double h) {
  lockstep::Dynamics dynamics(motion.system, std::make_unique<lockstep::DenseSolver>());
  double error[2];
  for (int i = 0; i < 2; ++i, h *= 0.5) {
    lockstep::State s = dynamics.system().start(), inside = s;
    method.begin(dynamics, s);
    method.step(dynamics, s, h);
    if (!method.dense(0.4 * h, inside)) return 0;
    error[i] = motion.error(inside);
  }
  return std::log2(error[0] / error[1]);
}

/// A particle of 1 kg in a gravity of 10 m/s^2 along -z.
struct Stone {
  lockstep::System system{lockstep::System::Options{{0, 0, -10}}};
  Stone() { system.add_particle("stone", 1, {0, 0, 0}); }
  lockstep::State thrown(double speed) const {
    lockstep::State s = system.start();
    s.v[2] = speed;
    return s;
  }
};
