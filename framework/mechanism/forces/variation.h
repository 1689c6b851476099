// Variations: numbers and vectors together with their derivatives on the poses and velocities of the two slots that a
// force acts between. A force writes its own formula once more with them, and its tangent is exact (theory, (9.13),
// (9.14)).
//
// The 24 unknowns: dx1 dth1 dx2 dth2 | v1 w1 v2 w2 (three each; turns and angular velocities in slot axes), 1 the slot
// of P, 2 that of S. Laws of time and markers' own motions are numbers.
#pragma once

#include "framework/mechanism/rows/tangent.h"
#include "framework/mechanism/lock/marker_frame.h"

namespace lockstep {

inline constexpr int kVariations = 24;

struct VaryingNumber {
  double v = 0;
  Eigen::Matrix<double, 1, kVariations> d = Eigen::Matrix<double, 1, kVariations>::Zero();
};
/// A vector in the world, or in fixed axes of one slot: whoever uses it knows.
struct VaryingVector {
  Vec3 v = Vec3::Zero();
  Eigen::Matrix<double, 3, kVariations> d = Eigen::Matrix<double, 3, kVariations>::Zero();
};

inline VaryingNumber operator+(const VaryingNumber& a, const VaryingNumber& b) { return {a.v + b.v, a.d + b.d}; }
inline VaryingNumber operator+(const VaryingNumber& a, double b) { return {a.v + b, a.d}; }
inline VaryingNumber operator*(double f, const VaryingNumber& a) { return {f * a.v, f * a.d}; }
inline VaryingNumber operator*(const VaryingNumber& a, const VaryingNumber& b) {
  return {a.v * b.v, a.v * b.d + b.v * a.d};
}
inline VaryingNumber inverse(const VaryingNumber& a) { return {1.0 / a.v, -1.0 / (a.v * a.v) * a.d}; }

inline VaryingVector operator+(const VaryingVector& a, const VaryingVector& b) { return {a.v + b.v, a.d + b.d}; }
inline VaryingVector operator-(const VaryingVector& a, const VaryingVector& b) { return {a.v - b.v, a.d - b.d}; }
inline VaryingVector operator-(const VaryingVector& a) { return {-a.v, -a.d}; }
inline VaryingVector operator*(double f, const VaryingVector& a) { return {f * a.v, f * a.d}; }
inline VaryingVector operator*(const VaryingNumber& f, const VaryingVector& a) {
  return {f.v * a.v, f.v * a.d + a.v * f.d};
}
inline VaryingNumber dot(const VaryingVector& a, const VaryingVector& b) {
  return {a.v.dot(b.v), a.v.transpose() * b.d + b.v.transpose() * a.d};
}
inline VaryingVector cross(const VaryingVector& a, const VaryingVector& b) {
  return {cross(a.v, b.v), skew(a.v) * b.d - skew(b.v) * a.d};
}
/// Component by component, with constant factors.
inline VaryingVector scaled(const Vec3& f, const VaryingVector& a) {
  return {f.cwiseProduct(a.v), f.asDiagonal() * a.d};
}
inline VaryingNumber norm(const VaryingVector& a) {
  const double n = a.v.norm();
  return {n, 1.0 / n * a.v.transpose() * a.d};
}

/// The derivatives on the turn of a slot.
inline auto turns(VaryingVector& r, int side) { return r.d.block<3, 3>(0, 3 + 6 * side); }

/// The two slots at one instant. `side`: 0 the slot of P, 1 that of S.
class Variation {
 public:
  Variation(const Inputs& in, const MarkerFrame& P, const MarkerFrame& S)
      : O_{&in.slot(P.slot), &in.slot(S.slot)}, m_{P.at(in.t), S.at(in.t)}, slot_{P.slot, S.slot} {}

  /// A c (world) for a vector c fixed in the slot: d(A c) = -A c~ dth.
  VaryingVector fixed(int side, const Vec3& c) const {
    VaryingVector r{O(side).A * c};
    turns(r, side) = -O(side).A * skew(c);
    return r;
  }
  /// A column of the marker's axes, world.
  VaryingVector axis(int side, int k) const { return fixed(side, m(side).A.col(k)); }
  /// Origin of the marker, world: x + A u.
  VaryingVector point(int side) const {
    VaryingVector r = fixed(side, m(side).u);
    r.v += O(side).x;
    r.d.block<3, 3>(0, 6 * side).setIdentity();
    return r;
  }
  /// Its velocity, world: v + A (w x u + ud).
  VaryingVector velocity(int side) const {
    VaryingVector r = fixed(side, cross(O(side).w, m(side).u) + m(side).ud);
    r.v += O(side).v;
    r.d.block<3, 3>(0, 12 + 6 * side).setIdentity();
    r.d.block<3, 3>(0, 15 + 6 * side) = -O(side).A * skew(m(side).u);
    return r;
  }
  /// Angular velocity of the marker, world: A (w + A_m w_m).
  VaryingVector turn_rate(int side) const {
    VaryingVector r = fixed(side, O(side).w + m(side).A * m(side).w);
    r.d.block<3, 3>(0, 15 + 6 * side) = O(side).A;
    return r;
  }
  /// (A c)^T b for c fixed in the slot: world -> marker axes, d(A^T b) = A^T db + (A^T b)~ dth.
  VaryingVector in_marker(int side, const VaryingVector& b) const {
    const Mat3 At = (O(side).A * m(side).A).transpose();
    VaryingVector r{At * b.v, At * b.d};
    turns(r, side) += skew(r.v) * m(side).A.transpose();
    return r;
  }
  /// Marker axes -> world.
  VaryingVector in_world(int side, const VaryingVector& b) const {
    const Mat3 A = O(side).A * m(side).A;
    VaryingVector r{A * b.v, A * b.d};
    turns(r, side) -= O(side).A * skew(Vec3(m(side).A * b.v));
    return r;
  }
  /// The small turn of P against S, world axes: no value, only what it changes by.
  VaryingVector relative_turn() const {
    VaryingVector r;
    turns(r, 0) = O(0).A;
    turns(r, 1) = -O(1).A;
    return r;
  }

  /// K and D of the force F (world) on the slot at the point x (world).
  void force(int side, const VaryingVector& F, const VaryingVector& x, TangentSum& out) const {
    if (slot_[side] == kGround) return;
    VaryingVector arm = x;
    arm.v -= O(side).x;
    arm.d.block<3, 3>(0, 6 * side) -= Mat3::Identity();
    add(side, Half::move, F, out);
    torque(side, cross(arm, F), out);
  }
  /// K and D of the free moment M (world axes) on the slot.
  void torque(int side, const VaryingVector& M, TangentSum& out) const {
    if (slot_[side] == kGround) return;
    const Mat3 At = O(side).A.transpose();
    VaryingVector r{At * M.v, At * M.d};
    turns(r, side) += skew(r.v);
    add(side, Half::turn, r, out);
  }

 private:
  const Motion& O(int side) const { return *O_[side]; }
  const MarkerMotion& m(int side) const { return m_[side]; }
  // A load enters the equations of motion with a minus sign.
  void add(int side, Half row, const VaryingVector& r, TangentSum& out) const {
    for (int c = 0; c < 2; ++c)
      for (const Half half : {Half::move, Half::turn}) {
        const int at = 6 * c + static_cast<int>(half);
        out.add_K(slot_[side], row, slot_[c], half, -r.d.block<3, 3>(0, at));
        out.add_D(slot_[side], row, slot_[c], half, -r.d.block<3, 3>(0, 12 + at));
      }
  }

  const Motion* O_[2];
  MarkerMotion m_[2];
  int slot_[2];
};

}  // namespace lockstep
