// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Two bodies, two markers and all six laws at one instant: the input of the lock's oracles, and a generator of it.

#include <cstdint>
#include <random>

#include <Eigen/Core>

namespace lockstep::oracle {

/// The inputs of lock-checks.json under their names (theory, section 10). SI; quaternions scalar first.
/// Suffix d, dd: first, second time derivative.
struct Configuration {
  using V3 = Eigen::Vector3d;
  using V4 = Eigen::Vector4d;

  V3 x1, v1, a1;     ///< body 1, world axes
  V4 q1, qd1, qdd1;  ///< its quaternion with the derivatives that follow from w1, al1
  V3 w1, al1;        ///< its angular velocity and acceleration, body axes
  V3 x2, v2, a2;     ///< body 2, the same
  V4 q2, qd2, qdd2;
  V3 w2, al2;
  V3 uP, uPd, uPdd;  ///< origin of marker P in body 1
  V4 qP, qPd, qPdd;  ///< its turn
  V3 uS, uSd, uSdd;  ///< origin of marker S in body 2
  V4 qS, qSd, qSdd;  ///< its turn
  V3 pD, pDd, pDdd;  ///< imposed translation, S axes
  V4 qD, qDd, qDdd;  ///< imposed rotation, S -> D
};

/// One bit for each law, in the order of the sets in the theory's section 5.
enum LawBit : unsigned { kUP = 1, kQP = 2, kUS = 4, kQS = 8, kP = 16, kQD = 32, kAllLaws = 63 };

struct ConfigurationOptions {
  unsigned laws = kAllLaws;  ///< the others: marker poses constant, p = 0, q_D = 1, rates zero
  bool aligned = false;      ///< q_P = q_S = 1 (a law that is active keeps its rates)
  bool satisfied = false;    ///< body 1 placed so that rho = p and e = 1; velocities stay as drawn
};

/// (1.1), for the generator.
inline Eigen::Vector4d quaternion_product(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// (1.2)
inline Eigen::Vector4d quaternion_conjugate(const Eigen::Vector4d& q) { return {q[0], -q[1], -q[2], -q[3]}; }

/// (1.5) the vector part of q (0,v) q', parent axes.
inline Eigen::Vector3d quaternion_turned(const Eigen::Vector4d& q, const Eigen::Vector3d& v) {
  const Eigen::Vector4d pure(0.0, v[0], v[1], v[2]);
  return quaternion_product(quaternion_product(q, pure), quaternion_conjugate(q)).tail<3>();
}

/// (1.8), (1.9): qd = (1/2) q w, qdd = (1/2) q al - (1/4)|w|^2 q with w, al in the moved frame's own axes.
inline void set_rates(const Eigen::Vector4d& q, const Eigen::Vector3d& w, const Eigen::Vector3d& al,
                      Eigen::Vector4d& qd, Eigen::Vector4d& qdd) {
  qd = 0.5 * quaternion_product(q, Eigen::Vector4d(0.0, w[0], w[1], w[2]));
  qdd = 0.5 * quaternion_product(q, Eigen::Vector4d(0.0, al[0], al[1], al[2])) - 0.25 * w.squaredNorm() * q;
}

/// Moves body 1 to the error quaternion e and the translational error C (S axes); keeps its w1, al1 and renews qd1,
/// qdd1. From (4.2) q_1 = q_2 q_S q_D e q_P' and from (3.3) x_1 = x_2 + A_2 (u_S + A_S (p + C)) - A_1 u_P.
inline void place_body_1(Configuration& c, const Eigen::Vector4d& e,
                         const Eigen::Vector3d& C = Eigen::Vector3d::Zero()) {
  const Eigen::Vector4d qD_e = quaternion_product(c.qD, e);
  const Eigen::Vector4d q2_qS = quaternion_product(c.q2, c.qS);
  c.q1 = quaternion_product(quaternion_product(q2_qS, qD_e), quaternion_conjugate(c.qP));
  c.x1 = c.x2 + quaternion_turned(c.q2, c.uS + quaternion_turned(c.qS, c.pD + C)) - quaternion_turned(c.q1, c.uP);
  set_rates(c.q1, c.w1, c.al1, c.qd1, c.qdd1);
}

/// The same without p and q_D: rho and e of it are the coordinates y of (7.1).
inline Configuration without_imposed_laws(Configuration c) {
  c.pD.setZero(), c.pDd.setZero(), c.pDdd.setZero();
  c.qD = Eigen::Vector4d::UnitX();
  c.qDd.setZero(), c.qDdd.setZero();
  return c;
}

/// Numbers that are the same on every machine for one seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}

  double number(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1.0p-53; }

  Eigen::Vector3d vector(double size) {
    const double x = number(-size, size), y = number(-size, size), z = number(-size, size);
    return {x, y, z};
  }

  /// Of unit length, uniform over all turns.
  Eigen::Vector4d quaternion() {
    for (;;) {
      const Eigen::Vector3d v = vector(1.0);
      const Eigen::Vector4d q(number(-1.0, 1.0), v[0], v[1], v[2]);
      if (q.norm() > 0.1 && q.norm() <= 1.0) return q.normalized();
    }
  }

 private:
  std::mt19937_64 bits_;
};

/// A random state with lengths of order 1 and rates of order 1 to 3. Every law is drawn, active or not, so that the
/// numbers of one seed are the same for every set of laws (body 1 of `satisfied` depends on p and q_D).
inline Configuration random_configuration(std::uint64_t seed, const ConfigurationOptions& options = {}) {
  using V3 = Eigen::Vector3d;
  using V4 = Eigen::Vector4d;
  Draw draw(seed);
  Configuration c;

  auto body = [&](V3& x, V3& v, V3& a, V4& q, V3& w, V3& al, V4& qd, V4& qdd) {
    x = draw.vector(1.0), v = draw.vector(2.0), a = draw.vector(3.0);
    q = draw.quaternion(), w = draw.vector(2.0), al = draw.vector(3.0);
    set_rates(q, w, al, qd, qdd);
  };
  auto translation = [&](LawBit bit, V3& u, V3& ud, V3& udd) {
    u = draw.vector(1.0), ud = draw.vector(1.0), udd = draw.vector(1.0);
    if (options.laws & bit) return;
    ud.setZero(), udd.setZero();
    if (bit == kP) u.setZero();
  };
  auto turn = [&](LawBit bit, V4& q, V4& qd, V4& qdd) {
    q = draw.quaternion();
    V3 w = draw.vector(1.5), al = draw.vector(2.0);
    const bool active = (options.laws & bit) != 0;
    if (!active) w.setZero(), al.setZero();
    if (bit == kQD ? !active : options.aligned) q = V4::UnitX();
    set_rates(q, w, al, qd, qdd);
  };

  body(c.x1, c.v1, c.a1, c.q1, c.w1, c.al1, c.qd1, c.qdd1);
  body(c.x2, c.v2, c.a2, c.q2, c.w2, c.al2, c.qd2, c.qdd2);
  translation(kUP, c.uP, c.uPd, c.uPdd);
  turn(kQP, c.qP, c.qPd, c.qPdd);
  translation(kUS, c.uS, c.uSd, c.uSdd);
  turn(kQS, c.qS, c.qSd, c.qSdd);
  translation(kP, c.pD, c.pDd, c.pDdd);
  turn(kQD, c.qD, c.qDd, c.qDdd);
  if (options.satisfied) place_body_1(c, V4::UnitX());
  return c;
}

}  // namespace lockstep::oracle
