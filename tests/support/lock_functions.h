// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// What stands on the seven rows: standard functions phi(y, t) of relative coordinates with all their derivatives, and
/// reactions, from the exact derivatives of the constraint alone. Nothing of (7.2), (7.4) or (8.6) is used.

#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "tests/support/configuration.h"
#include "tests/support/constraint.h"
#include "tests/support/dual.h"

namespace lockstep::oracle {

// --- phi(y, f): y = (x, y, z, e0, e1, e2, e3) of (7.1), f = the value of the law f(t); the names of lock-checks.json
// --

struct Screw {
  double pitch;  ///< m per turn
  template <class T>
  T operator()(const Seven<T>& y, const T& f) const {
    using std::atan2;
    return y[2] - T(pitch / (2.0 * std::numbers::pi)) * (T(2.0) * atan2(y[6], y[3])) - f;
  }
};

struct Rack {
  double radius;  ///< m
  template <class T>
  T operator()(const Seven<T>& y, const T& f) const {
    using std::atan2;
    return y[0] + T(radius) * (T(2.0) * atan2(y[6], y[3])) - f;
  }
};

/// x axis of S times y axis of P.
struct Universal {
  template <class T>
  T operator()(const Seven<T>& y, const T&) const {
    return rotation(Quat<T>{y[3], y[4], y[5], y[6]}).row1.y;
  }
};

/// (rho.rho - f^2) / 2
struct Distance2 {
  template <class T>
  T operator()(const Seven<T>& y, const T& f) const {
    return T(0.5) * (y[0] * y[0] + y[1] * y[1] + y[2] * y[2] - f * f);
  }
};

/// |rho| - f
struct Distance1 {
  template <class T>
  T operator()(const Seven<T>& y, const T& f) const {
    using std::sqrt;
    return sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) - f;
  }
};

/// One row phi = 0: C = phi, its rates and its row in v1, w1 (body), v2, w2 (body).
struct FunctionTerms {
  double C, Ct, Cd, Qhat;
  Vector12 Jh;
};

/// Any phi with `Dual2 operator()(const Seven<Dual2>& y, const Dual2& f) const`; law = (f, fd, fdd). The imposed laws p
/// and q_D of the configuration are left aside, as (7.1) says.
template <class Phi>
FunctionTerms function_terms(const Phi& phi, const Configuration& configuration, const Eigen::Vector3d& law) {
  const Configuration c = without_imposed_laws(configuration);
  const Dual2 running(law[0], law[1], law[2]), frozen_value(law[0]);
  const Dual2 in_time = phi(along_time(c), running);
  FunctionTerms r;
  r.C = in_time.v;
  r.Ct = in_time.d;
  r.Cd = phi(along_motion(c), running).d;
  r.Qhat = -phi(along_free_motion(c), running).dd;
  for (int k = 0; k < 12; ++k) r.Jh[k] = phi(along_velocity(c, k), frozen_value).d;
  return r;
}

// --- reactions ------------------------------------------------------------------------------------------------------

/// World axes unless the name says otherwise; N and N m if lam fits.
struct Reaction {
  Eigen::Vector3d force_on_1;   ///< acting at P
  Eigen::Vector3d torque_on_1;  ///< the couple that goes with it
  Eigen::Vector3d torque_on_1_P_axes;
  Eigen::Vector3d torque_on_1_D_axes;
  Eigen::Vector3d torque_on_2_at_S;  ///< couple on body 2 once the opposite force acts at S
};

/// Axes of a body or marker -> its parent's, columns by turning the unit vectors.
inline Eigen::Matrix3d axes(const Eigen::Vector4d& q) {
  Eigen::Matrix3d A;
  for (int i = 0; i < 3; ++i) A.col(i) = quaternion_turned(q, Eigen::Vector3d::Unit(i));
  return A;
}

/// By virtual work: the constraint's generalised force is -Jh^T lam (2.1), a force at the bodies' origins and a moment
/// in body axes; moved to P and S. Zeros in lam for rows that are not active.
inline Reaction reaction(const Configuration& c, const Vector6& lam) {
  const Vector12 Q = -six(exact_Jh(c)).transpose() * lam;
  const Eigen::Matrix3d A1 = axes(c.q1), A2 = axes(c.q2);
  const Eigen::Vector3d to_P = A1 * c.uP, to_S = A2 * c.uS;
  auto cross = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) -> Eigen::Vector3d {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  Reaction r;
  r.force_on_1 = Q.segment<3>(0);
  r.torque_on_1 = A1 * Q.segment<3>(3) - cross(to_P, Q.segment<3>(0));
  r.torque_on_1_P_axes = axes(c.qP).transpose() * (A1.transpose() * r.torque_on_1);
  r.torque_on_1_D_axes = axes(c.qD).transpose() * (axes(c.qS).transpose() * (A2.transpose() * r.torque_on_1));
  r.torque_on_2_at_S = A2 * Q.segment<3>(9) - cross(to_S, Q.segment<3>(6));
  return r;
}

/// Power put in by the laws, from Jh v = -Ct (the velocities meet the constraint).
inline double power_of_laws(const Configuration& c, const Vector6& lam) { return lam.dot(six(exact_Ct(c))); }

}  // namespace lockstep::oracle
