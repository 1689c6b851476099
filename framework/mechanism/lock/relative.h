// The relative coordinates of a pair with their rates, and how a gradient of them becomes a row: the products that a
// function of them needs, without the jacobians of the coordinates (theory, (7.1), (7.2), (9.2), (9.3)).
#pragma once

#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/lock/relative_kinematics.h"

namespace lockstep {

/// What a pair adds to a row: columns on v1 (world; those on v2 are minus these), w1, w2 (slot axes), Ct and Qhat.
struct PulledRow {
  Vec3 v = Vec3::Zero(), w1 = Vec3::Zero(), w2 = Vec3::Zero();
  double Ct = 0, Qhat = 0;
};

constexpr bool reads(Reads which, Reads half) { return (unsigned(which) & unsigned(half)) != 0; }

/// kMoving: the markers have laws of their own; without them half of the equations is zero.
template <Reads kReads, bool kMoving>
class RelativePair {
 public:
  RelativePair(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in)
      : O1_(kernel::body(in.slot(P.slot))),
        O2_(kernel::body(in.slot(S.slot))),
        P_(marker(P, in.t)),
        S_(marker(S, in.t)) {
    if constexpr (reads(kReads, Reads::translation)) {
      const auto at = kernel::position(O1_, O2_, P_, S_);
      const auto moving = kernel::velocity(O1_, O2_, P_, at);
      s_ = at.s;
      put<0>(y_, at.rho), put<0>(yd_, kernel::position_rate(S_, at, moving));
      if constexpr (kMoving) put<0>(Ct_, kernel::translation_Ct(O1_, O2_, P_, S_, kernel::NoShift{}, at));
      put<0>(Qhat_, kernel::translation_Qhat(O1_, O2_, P_, S_, kernel::NoShift{}, at, moving));
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const kernel::NoTurn none{};
      const auto r = kernel::rotation_error(O1_, O2_, P_, S_, none);
      const auto w = kernel::angular_velocities(O1_, O2_, P_, S_, none);
      const auto rd = kernel::rotation_rate(r, w);
      h_ = 0.5 * r;
      put(y_, r), put(yd_, rd), put(Qhat_, kernel::rotation_Qhat(r, rd, w));
      if constexpr (kMoving) put(Ct_, kernel::rotation_Ct(r, P_, S_, none));
    }
  }

  /// What is not read stays unset.
  const Vec7T<double>& y() const { return y_; }
  const Vec7T<double>& yd() const { return yd_; }

  /// g: gradient on the coordinates that are read, 3, 4 or 7.
  template <class G>
  PulledRow pull(const G& g) const {
    constexpr int kFirst = reads(kReads, Reads::translation) ? 0 : 3, kN = G::RowsAtCompileTime;
    PulledRow row;
    if constexpr (reads(kReads, Reads::translation)) {
      const auto n2 = S_.A * vec::Vector<double>{g[0], g[1], g[2]};
      const auto r = kernel::translation_row(O1_.A, P_.u, s_, O2_.A * n2, n2);
      row.v = vec::as<Vec3>(r.v), row.w1 = vec::as<Vec3>(r.w1), row.w2 = vec::as<Vec3>(r.w2);
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const auto r = kernel::rotation_row(
          h_, P_.A, S_.A, vec::Quaternion{g[kN - 4], vec::Vector<double>{g[kN - 3], g[kN - 2], g[kN - 1]}});
      row.w1 += vec::as<Vec3>(r.w1), row.w2 += vec::as<Vec3>(r.w2);
    }
    if constexpr (kMoving) row.Ct = g.dot(Ct_.template segment<kN>(kFirst));
    row.Qhat = g.dot(Qhat_.template segment<kN>(kFirst));
    return row;
  }

 private:
  static auto marker(const MarkerFrame& m, double t) {
    if constexpr (kMoving)
      return kernel::marker<true, true>(m.at(t));
    else
      return kernel::Marker{vec::vector(m.u0), vec::matrix(m.A0), vec::quaternion(m.q0)};
  }
  template <int kFirst, class V>
  static void put(Vec7T<double>& y, const V& v) {
    y[kFirst] = v.x, y[kFirst + 1] = v.y, y[kFirst + 2] = v.z;
  }
  template <class W, class V>
  static void put(Vec7T<double>& y, const vec::Quaternion<W, V>& q) {
    y[3] = q.w, put<4>(y, q.v);
  }
  using Body = decltype(kernel::body(Motion{}));
  using Marker = decltype(marker(MarkerFrame{}, 0.0));

  Body O1_, O2_;
  Marker P_, S_;
  vec::Vector<double> s_{};
  vec::Quaternion<double, vec::Vector<double>> h_{};
  Vec7T<double> y_, yd_, Ct_, Qhat_;
};

template <Reads kReads>
using StillPair = RelativePair<kReads, false>;
template <Reads kReads>
using MovingPair = RelativePair<kReads, true>;

}  // namespace lockstep
