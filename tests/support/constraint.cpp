// SPDX-License-Identifier: BSD-3-Clause
// The lock constraint along curves: its derivatives by numbers that carry two of them.
#include "tests/support/constraint.h"

namespace lockstep::oracle {

namespace {

Vec3<Dual2> dual(const Eigen::Vector3d& v, const Eigen::Vector3d& d, const Eigen::Vector3d& dd) {
  return {{v[0], d[0], dd[0]}, {v[1], d[1], dd[1]}, {v[2], d[2], dd[2]}};
}

Quat<Dual2> dual(const Eigen::Vector4d& v, const Eigen::Vector4d& d, const Eigen::Vector4d& dd) {
  return {{v[0], d[0], dd[0]}, {v[1], d[1], dd[1]}, {v[2], d[2], dd[2]}, {v[3], d[3], dd[3]}};
}

Vec3<Dual2> frozen(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
Quat<Dual2> frozen(const Eigen::Vector4d& v) { return {v[0], v[1], v[2], v[3]}; }

// A quaternion with body-axes angular velocity w and acceleration al:
// (1.8) qd = (1/2) q w,  (1.9) qdd = (1/2) q al - (1/4)|w|^2 q
Quat<Dual2> turning(const Eigen::Vector4d& q, const Eigen::Vector3d& w, const Eigen::Vector3d& al) {
  const Quat<double> a{q[0], q[1], q[2], q[3]};
  const Vec3<double> rate{w[0], w[1], w[2]};
  const Quat<double> d = 0.5 * (a * pure(rate));
  const Quat<double> dd = 0.5 * (a * pure(Vec3<double>{al[0], al[1], al[2]})) - (0.25 * dot(rate, rate)) * a;
  return {{a.w, d.w, dd.w}, {a.x, d.x, dd.x}, {a.y, d.y, dd.y}, {a.z, d.z, dd.z}};
}

Bodies<Dual2> frozen_bodies(const Configuration& c) { return {frozen(c.x1), frozen(c.q1), frozen(c.x2), frozen(c.q2)}; }

Laws<Dual2> frozen_laws(const Configuration& c) {
  return {frozen(c.uP), frozen(c.qP), frozen(c.uS), frozen(c.qS), frozen(c.pD), frozen(c.qD)};
}

Laws<Dual2> running_laws(const Configuration& c) {
  return {dual(c.uP, c.uPd, c.uPdd), dual(c.qP, c.qPd, c.qPdd), dual(c.uS, c.uSd, c.uSdd),
          dual(c.qS, c.qSd, c.qSdd), dual(c.pD, c.pDd, c.pDdd), dual(c.qD, c.qDd, c.qDdd)};
}

Vector7 values(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[i].v;
  return r;
}

Vector7 first_derivatives(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[i].d;
  return r;
}

Vector7 second_derivatives(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[i].dd;
  return r;
}

}  // namespace

Seven<Dual2> along_time(const Configuration& c) { return constraint(frozen_bodies(c), running_laws(c)); }

Seven<Dual2> along_motion(const Configuration& c) {
  const Bodies<Dual2> b{dual(c.x1, c.v1, c.a1), turning(c.q1, c.w1, c.al1), dual(c.x2, c.v2, c.a2),
                        turning(c.q2, c.w2, c.al2)};
  return constraint(b, running_laws(c));
}

Seven<Dual2> along_free_motion(const Configuration& c) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Bodies<Dual2> b{dual(c.x1, c.v1, zero), turning(c.q1, c.w1, zero), dual(c.x2, c.v2, zero),
                        turning(c.q2, c.w2, zero)};
  return constraint(b, running_laws(c));
}

Seven<Dual2> along_straight_motion(const Configuration& c) {
  const Eigen::Vector3d zero3 = Eigen::Vector3d::Zero();
  const Eigen::Vector4d zero4 = Eigen::Vector4d::Zero();
  const Bodies<Dual2> b{dual(c.x1, c.v1, zero3), dual(c.q1, c.qd1, zero4), dual(c.x2, c.v2, zero3),
                        dual(c.q2, c.qd2, zero4)};
  return constraint(b, running_laws(c));
}

Seven<Dual2> along_velocity(const Configuration& c, int k) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Vector12 unit = Vector12::Unit(k);
  const Bodies<Dual2> b{dual(c.x1, unit.segment<3>(0), zero), turning(c.q1, unit.segment<3>(3), zero),
                        dual(c.x2, unit.segment<3>(6), zero), turning(c.q2, unit.segment<3>(9), zero)};
  return constraint(b, frozen_laws(c));
}

Seven<Dual2> along_coordinate(const Configuration& c, int k) {
  const Eigen::Vector3d zero3 = Eigen::Vector3d::Zero();
  const Eigen::Vector4d zero4 = Eigen::Vector4d::Zero();
  const Eigen::Matrix<double, 14, 1> unit = Eigen::Matrix<double, 14, 1>::Unit(k);
  const Bodies<Dual2> b{dual(c.x1, unit.segment<3>(0), zero3), dual(c.q1, unit.segment<4>(3), zero4),
                        dual(c.x2, unit.segment<3>(7), zero3), dual(c.q2, unit.segment<4>(10), zero4)};
  return constraint(b, frozen_laws(c));
}

Eigen::Vector3d relative_position(const Configuration& c) {
  return values(along_time(without_imposed_laws(c))).head<3>();
}

Eigen::Vector4d error_quaternion(const Configuration& c) { return values(along_time(c)).tail<4>(); }

Vector7 exact_C(const Configuration& c) { return values(along_time(c)) - Vector7::Unit(3); }
Vector7 exact_Ct(const Configuration& c) { return first_derivatives(along_time(c)); }
Vector7 exact_Cd(const Configuration& c) { return first_derivatives(along_motion(c)); }
Vector7 exact_Cdd(const Configuration& c) { return second_derivatives(along_motion(c)); }
Vector7 exact_Qhat(const Configuration& c) { return -second_derivatives(along_free_motion(c)); }
Vector7 exact_Qc(const Configuration& c) { return -second_derivatives(along_straight_motion(c)); }

Matrix7x12 exact_Jh(const Configuration& c) {
  Matrix7x12 Jh;
  for (int k = 0; k < 12; ++k) Jh.col(k) = first_derivatives(along_velocity(c, k));
  return Jh;
}

Matrix7x14 exact_Cq(const Configuration& c) {
  Matrix7x14 Cq;
  for (int k = 0; k < 14; ++k) Cq.col(k) = first_derivatives(along_coordinate(c, k));
  return Cq;
}

}  // namespace lockstep::oracle
