// SPDX-License-Identifier: BSD-3-Clause
// The lock's rows as the paper writes them.
#include "tests/support/paper_lock.h"

#include <array>
#include <cstddef>

namespace lockstep::oracle {

namespace paper {

using V3 = Eigen::Vector3d;
using V4 = Eigen::Vector4d;
using M3 = Eigen::Matrix3d;
using M4 = Eigen::Matrix4d;
using M34 = Eigen::Matrix<double, 3, 4>;

// a~, a~ b = a x b
M3 skew(const V3& a) {
  M3 m;
  m << 0.0, -a[2], a[1],  //
      a[2], 0.0, -a[0],   //
      -a[1], a[0], 0.0;
  return m;
}

// (1.2)
V4 conj(const V4& q) { return {q[0], -q[1], -q[2], -q[3]}; }

// (1.3) [p 56] a b = [a]+ b
M4 plus(const V4& a) {
  M4 m;
  m << a[0], -a[1], -a[2], -a[3],  //
      a[1], a[0], -a[3], a[2],     //
      a[2], a[3], a[0], -a[1],     //
      a[3], -a[2], a[1], a[0];
  return m;
}

// (1.3) [p 58] a b = [b]- a
M4 minus(const V4& b) {
  M4 m;
  m << b[0], -b[1], -b[2], -b[3],  //
      b[1], b[0], b[3], -b[2],     //
      b[2], -b[3], b[0], b[1],     //
      b[3], b[2], -b[1], b[0];
  return m;
}

// (1.1) [p 55] one quaternion product
V4 product(const V4& a, const V4& b) { return plus(a) * b; }

// (1.5) [p 13-14] the lower right block of [q]+ [q']-
M3 rotation(const V4& q) { return (plus(q) * minus(conj(q))).bottomRightCorner<3, 3>(); }

// (1.6) [p 37] w = G(q) qd, body axes
M34 G(const V4& q) {
  M34 m;
  m << -q[1], q[0], q[3], -q[2],  //
      -q[2], -q[3], q[0], q[1],   //
      -q[3], q[2], -q[1], q[0];
  return 2.0 * m;
}

// What the translational formulas have in common, with (1.10) Ad = A w~, Add = A w~ w~ (no angular acceleration).
struct Frames {
  M3 A1, A2, AS, A1d, A2d, ASd, A1dd0, A2dd0, ASdd;
  V3 h, hd;

  explicit Frames(const Configuration& c) : A1(rotation(c.q1)), A2(rotation(c.q2)), AS(rotation(c.qS)) {
    const M3 w1 = skew(G(c.q1) * c.qd1), w2 = skew(G(c.q2) * c.qd2);
    const M3 sigma = skew(G(c.qS) * c.qSd), sigmad = skew(G(c.qS) * c.qSdd);
    A1d = A1 * w1, A2d = A2 * w2, ASd = AS * sigma;
    A1dd0 = A1 * w1 * w1, A2dd0 = A2 * w2 * w2, ASdd = AS * (sigmad + sigma * sigma);
    h = (c.x1 + A1 * c.uP) - (c.x2 + A2 * c.uS);                               // (3.1)
    hd = (c.v1 + A1d * c.uP + A1 * c.uPd) - (c.v2 + A2d * c.uS + A2 * c.uSd);  // (3.2)
  }
};

// (3.3) [p 28-29]
V3 translation_C(const Configuration& c, const Frames& f) { return f.AS.transpose() * f.A2.transpose() * f.h - c.pD; }

// (3.5) [p 32]
V3 translation_Ct(const Configuration& c, const Frames& f) {
  return f.ASd.transpose() * f.A2.transpose() * f.h + f.AS.transpose() * (f.A2.transpose() * f.A1 * c.uPd - c.uSd) -
         c.pDd;
}

// (3.4) [p 30-31]
V3 translation_Cd(const Configuration& c, const Frames& f) {
  return f.AS.transpose() * f.A2.transpose() * f.hd + f.AS.transpose() * f.A2d.transpose() * f.h +
         f.ASd.transpose() * f.A2.transpose() * f.h - c.pDd;
}

// (3.6) [p 42a-d]
Eigen::Matrix<double, 3, 14> translation_Cq(const Configuration& c, const Frames& f) {
  Eigen::Matrix<double, 3, 14> Cq;
  const M3 R = f.AS.transpose() * f.A2.transpose();
  Cq.block<3, 3>(0, 0) = R;
  Cq.block<3, 4>(0, 3) = -R * f.A1 * skew(c.uP) * G(c.q1);
  Cq.block<3, 3>(0, 7) = -R;
  Cq.block<3, 4>(0, 10) =
      f.AS.transpose() * skew(c.uS) * G(c.q2) + f.AS.transpose() * skew(f.A2.transpose() * f.h) * G(c.q2);
  return Cq;
}

// (3.7) [p 43 with its sign turned round]
V3 translation_Qc(const Configuration& c, const Frames& f) {
  const V3 accP = f.A1dd0 * c.uP + 2.0 * f.A1d * c.uPd + f.A1 * c.uPdd;
  const V3 accS = f.A2dd0 * c.uS + 2.0 * f.A2d * c.uSd + f.A2 * c.uSdd;
  return -(f.AS.transpose() * f.A2dd0.transpose() * f.h           // A_S^T (A2 w2~ w2~)^T h
           + f.AS.transpose() * f.A2.transpose() * (accP - accS)  //
           + f.ASdd.transpose() * f.A2.transpose() * f.h          //
           + 2.0 * f.ASd.transpose() * f.A2.transpose() * f.hd    //
           + 2.0 * f.AS.transpose() * f.A2d.transpose() * f.hd    //
           + 2.0 * f.ASd.transpose() * f.A2d.transpose() * f.h - c.pDdd);
}

// The five factors f1..f5 = q_D', q_S', q_2', q_1, q_P of e and their derivatives (section 4.1).
struct Factors {
  std::array<V4, 5> f, fd, fdd;

  explicit Factors(const Configuration& c)
      : f{conj(c.qD), conj(c.qS), conj(c.q2), c.q1, c.qP},
        fd{conj(c.qDd), conj(c.qSd), conj(c.qd2), c.qd1, c.qPd},
        fdd{conj(c.qDdd), conj(c.qSdd), conj(c.qdd2), c.qdd1, c.qPdd} {}
};

// One addendum: four products.
V4 addendum(const std::array<V4, 5>& a) { return product(product(product(product(a[0], a[1]), a[2]), a[3]), a[4]); }

// f1 .. fid .. f5
V4 once(const Factors& x, std::size_t i) {
  std::array<V4, 5> a = x.f;
  a[i] = x.fd[i];
  return addendum(a);
}

// f1 .. fidd .. f5
V4 twice(const Factors& x, std::size_t i) {
  std::array<V4, 5> a = x.f;
  a[i] = x.fdd[i];
  return addendum(a);
}

// The ten mixed addenda f1 .. fid .. fjd .. f5, i < j, forty products.
V4 mixed(const Factors& x) {
  V4 sum = V4::Zero();
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = i + 1; j < 5; ++j) {
      std::array<V4, 5> a = x.f;
      a[i] = x.fd[i], a[j] = x.fd[j];
      sum += addendum(a);
    }
  }
  return sum;
}

// (4.2) [p 46-49]
V4 rotation_C(const Factors& x) { return addendum(x.f) - V4::UnitX(); }

// (4.4) [p 51] the addenda of q_D, q_S and q_P
V4 rotation_Ct(const Factors& x) { return once(x, 0) + once(x, 1) + once(x, 4); }

// (4.3) [p 50]
V4 rotation_Cd(const Factors& x) { return once(x, 0) + once(x, 1) + once(x, 2) + once(x, 3) + once(x, 4); }

// (4.8) [p 65-69], with X of (1.4) at the right end
Eigen::Matrix<double, 4, 14> rotation_Cq(const Factors& x) {
  const M4 X = V4(1.0, -1.0, -1.0, -1.0).asDiagonal();
  Eigen::Matrix<double, 4, 14> Cq = Eigen::Matrix<double, 4, 14>::Zero();
  Cq.block<4, 4>(0, 3) = plus(x.f[0]) * plus(x.f[1]) * plus(x.f[2]) * minus(x.f[4]);
  Cq.block<4, 4>(0, 10) = plus(x.f[0]) * plus(x.f[1]) * minus(product(x.f[3], x.f[4])) * X;
  return Cq;
}

// (4.6) [p 53, 70] thirteen addenda: q_Ddd', q_Sdd', q_Pdd, and twice the ten mixed ones
V4 rotation_Qc(const Factors& x) { return -(twice(x, 0) + twice(x, 1) + twice(x, 4) + 2.0 * mixed(x)); }

// (4.5) [p 52] all fifteen addenda, sixty products; the two that Qc lacks are (4.7) [p 54]
V4 rotation_Cdd(const Factors& x) {
  return twice(x, 0) + twice(x, 1) + twice(x, 2) + twice(x, 3) + twice(x, 4) + 2.0 * mixed(x);
}

}  // namespace paper

PaperLock paper_lock(const Configuration& c) {
  const paper::Frames f(c);
  const paper::Factors x(c);
  PaperLock r;
  r.C << paper::translation_C(c, f), paper::rotation_C(x);
  r.Ct << paper::translation_Ct(c, f), paper::rotation_Ct(x);
  r.Cq << paper::translation_Cq(c, f), paper::rotation_Cq(x);
  r.Qc << paper::translation_Qc(c, f), paper::rotation_Qc(x);
  return r;
}

Eigen::Matrix<double, 7, 1> paper_Cd(const Configuration& c) {
  Eigen::Matrix<double, 7, 1> r;
  r << paper::translation_Cd(c, paper::Frames(c)), paper::rotation_Cd(paper::Factors(c));
  return r;
}

Eigen::Vector4d paper_rotational_Cdd(const Configuration& c) { return paper::rotation_Cdd(paper::Factors(c)); }

}  // namespace lockstep::oracle
