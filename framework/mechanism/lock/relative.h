// The relative coordinates of a pair with their rates, and how a gradient of them becomes a row: the products that a
// function of them needs, without its jacobians (theory, (7.1), (7.2), (9.2), (9.3)).
#pragma once

#include "framework/mechanism/lock/look.h"
#include "framework/mechanism/lock/marker_frame.h"

namespace lockstep {

/// A row in the making: columns on v1 (world; those on v2 are minus these), w1, w2 (slot axes), and what the row's Ct
/// and Qhat take from the pair.
struct PulledRow {
  Vec3 v = Vec3::Zero(), w1 = Vec3::Zero(), w2 = Vec3::Zero();
  double Ct = 0, Qhat = 0;
};

constexpr bool reads(Reads which, Reads half) { return (unsigned(which) & unsigned(half)) != 0; }

/// Both markers stand still on their bodies: half of the kernel is zero.
///
///   s = A2^T (x1 + A1 uP - x2)            rho = A_S^T (s - uS)           (3.8)
///   sd = A2^T (v1 + A1 (w1 x uP) - v2) - w2 x s                          (3.10)
///   r = q_S' q_2' q_1 q_P                 rd = (1/2) (r w_P - w_S r),  w_P = A_P^T w1, w_S = A_S^T w2   (4.11)
///
/// and the same once more for what is left of sdd, rdd without accelerations: -Qhat.
template <Reads kReads>
class StillPair {
 public:
  StillPair(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in)
      : P_(P), S_(S), O1_(in.slot(P.slot)), O2_(in.slot(S.slot)) {
    if constexpr (reads(kReads, Reads::translation)) {
      const Vec3 wu = cross(O1_.w, P.u0);
      s_ = O2_.A.transpose() * (O1_.x + O1_.A * P.u0 - O2_.x);
      const Vec3 sd = O2_.A.transpose() * (O1_.v + O1_.A * wu - O2_.v) - cross(O2_.w, s_);
      const Vec3 sdd = O2_.A.transpose() * (O1_.A * cross(O1_.w, wu)) - cross(O2_.w, Vec3(cross(O2_.w, s_) + 2.0 * sd));
      y_.template head<3>() = S.A0.transpose() * (s_ - S.u0);
      yd_.template head<3>() = S.A0.transpose() * sd;
      bend_.template head<3>() = sdd;  // still in O2 axes, where pull() wants it
    } else {
      s_.setZero();  // unread; g++ 12 warns of copies of what is unset
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      r_ = conjugate(O2_.e * S.q0) * (O1_.e * P.q0);
      const Vec3 wP = P.A0.transpose() * O1_.w, wS = S.A0.transpose() * O2_.w, less = wP - wS, sum = wP + wS;
      const Quat rd = turning(r_, less, sum), rdd = turning(rd, less, sum);
      y_.template tail<4>() = r_.coefficients();
      yd_.template tail<4>() = rd.coefficients();
      bend_.template tail<4>() = rdd.coefficients();
    }
  }

  /// What is not read stays unset.
  const Vec7T<double>& y() const { return y_; }
  const Vec7T<double>& yd() const { return yd_; }

  /// g: gradient on the coordinates that are read, 3, 4 or 7.
  template <class G>
  PulledRow pull(const G& g) const {
    PulledRow row;
    if constexpr (reads(kReads, Reads::translation)) {
      const Vec3 n = S_.A0 * g.template head<3>();
      row.v = O2_.A * n;
      row.w1 = cross(P_.u0, Vec3(O1_.A.transpose() * row.v));
      row.w2 = cross(n, s_);
      row.Qhat -= n.dot(bend_.template head<3>());
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const Vec3 gv = g.template tail<3>(), rv = r_.vec();
      const Vec3 even = r_.w * gv - g[g.size() - 4] * rv, odd = cross(rv, gv);  // vec(r' g) and vec(g r')
      row.w1 += 0.5 * (P_.A0 * (even - odd));
      row.w2 -= 0.5 * (S_.A0 * (even + odd));
      row.Qhat -= g.template tail<4>().dot(bend_.template tail<4>());
    }
    return row;
  }

 private:
  /// (1/2) (r w_P - w_S r), by the difference and the sum of the two.
  static Quat turning(const Quat& r, const Vec3& less, const Vec3& sum) {
    const Vec3 rv = r.vec();
    return Quat::from(-0.5 * rv.dot(less), Vec3(0.5 * (r.w * less + cross(rv, sum))));
  }
  const MarkerFrame &P_, &S_;
  const Motion &O1_, &O2_;
  Vec3 s_;
  Quat r_;
  Vec7T<double> y_, yd_, bend_;
};

/// Markers with laws of their own: by the kernel.
template <Reads kReads>
class MovingPair {
 public:
  MovingPair(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in)
      : L_(look(in.slot(P.slot), in.slot(S.slot), P.at(in.t), S.at(in.t), 1u, kReads)) {}

  const Vec7T<double>& y() const { return L_.y; }
  const Vec7T<double>& yd() const { return L_.yd; }

  template <class G>
  PulledRow pull(const G& g) const {
    constexpr int kFirst = reads(kReads, Reads::translation) ? 0 : 3, kN = G::RowsAtCompileTime;
    PulledRow row;
    if constexpr (reads(kReads, Reads::translation))
      row.v = L_.Jv1.template topRows<3>().transpose() * g.template head<3>();
    row.w1 = L_.Jw1.template middleRows<kN>(kFirst).transpose() * g;
    row.w2 = L_.Jw2.template middleRows<kN>(kFirst).transpose() * g;
    row.Ct = g.dot(L_.Ct.template segment<kN>(kFirst));
    row.Qhat = g.dot(L_.Qhat.template segment<kN>(kFirst));
    return row;
  }

 private:
  LockPoint L_;
};

}  // namespace lockstep
