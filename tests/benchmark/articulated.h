// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file The yardstick: a chain of rods on hinges by the articulated-body method (Featherstone 2008, chapter 7), in
/// world axes, one pass out, one in, one out. Trees only; written for this one mechanism, as a specialist would.

#include <Eigen/Geometry>
#include <vector>

#include <lockstep/math.h>

namespace lockstep::benchmark {

class ArticulatedChain {
 public:
  struct Link {
    Vec3 axis;  ///< of its hinge, in the parent's axes at angle 0 (z or y)
    double m = 1, length = 1;
    Vec3 J;                ///< about the centre, principal axes, x along the rod
    double q = 0, qd = 0;  ///< angle and rate
    double qdd = 0;        ///< found
  };
  std::vector<Link> links;
  Vec3 gravity = Vec3::Zero();

  void evaluate() {
    body_.resize(links.size());
    out();
    in();
    accelerate();
  }

 private:
  // Inertia of the body and all behind it about its hinge: force = M a + H al + pf, moment = H^T a + I al + pt.
  struct Body {
    Mat3 M, H, I;
    Vec3 pf, pt, n, r, cl, ca, Uf, Ut;
    double D = 0, u = 0;
  };
  static Mat3 skew(const Vec3& v) {
    Mat3 S;
    S << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
    return S;
  }
  void out() {
    Mat3 R = Mat3::Identity();
    Vec3 w = Vec3::Zero();
    for (std::size_t k = 0; k < links.size(); ++k) {
      const Link& l = links[k];
      Body& b = body_[k];
      b.n = R * l.axis;
      const Vec3 before = w;
      w += b.n * l.qd;
      const double c = std::cos(l.q), s = std::sin(l.q);
      const Vec3 x = R.col(0), other = R.col(l.axis[2] != 0 ? 1 : 2);
      if (l.axis[2] != 0)
        R.col(0) = c * x + s * other, R.col(1) = c * other - s * x;
      else
        R.col(0) = c * x - s * other, R.col(2) = c * other + s * x;
      b.r = l.length * R.col(0);
      const Vec3 h = 0.5 * b.r;
      b.ca = before.cross(b.n) * l.qd;
      b.cl = w.cross(w.cross(b.r));
      const Mat3 J = R * l.J.asDiagonal() * R.transpose(), S = skew(h);
      b.M = l.m * Mat3::Identity(), b.H = -l.m * S, b.I = J - l.m * S * S;
      b.pf = l.m * (w.cross(w.cross(h)) - gravity);
      b.pt = h.cross(b.pf) + w.cross(J * w);
    }
  }
  void in() {
    for (std::size_t k = links.size(); k-- > 0;) {
      Body& b = body_[k];
      b.Uf = b.H * b.n, b.Ut = b.I * b.n, b.D = 1 / b.n.dot(b.Ut), b.u = -b.n.dot(b.pt);
      if (k == 0) break;
      Body& p = body_[k - 1];
      const Vec3 df = b.Uf * b.D, dt = b.Ut * b.D;
      const Mat3 Ma = b.M - b.Uf * df.transpose(), Ha = b.H - b.Uf * dt.transpose(), Ia = b.I - b.Ut * dt.transpose();
      const Vec3 pf = b.pf + Ma * p.cl + Ha * b.ca + df * b.u;
      const Vec3 pt = b.pt + Ha.transpose() * p.cl + Ia * b.ca + dt * b.u;
      const Mat3 S = skew(p.r), MS = Ma * S;
      p.M += Ma, p.H += Ha - MS, p.I += Ia + S * Ha - Ha.transpose() * S - S * MS;
      p.pf += pf, p.pt += pt + p.r.cross(pf);
    }
  }
  void accelerate() {
    Vec3 a = Vec3::Zero(), al = Vec3::Zero();
    for (std::size_t k = 0; k < links.size(); ++k) {
      Body& b = body_[k];
      if (k > 0) a += al.cross(body_[k - 1].r) + body_[k - 1].cl;
      const Vec3 before = al + b.ca;
      links[k].qdd = b.D * (b.u - b.Uf.dot(a) - b.Ut.dot(before));
      al = before + b.n * links[k].qdd;
    }
  }
  std::vector<Body> body_;
};

}  // namespace lockstep::benchmark
