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

/// The marker's motion now: of one without laws, where it is stored.
template <bool kMoving>
LOCKSTEP_INLINE decltype(auto) marker_motion(const MarkerFrame& m, [[maybe_unused]] double t) {
  if constexpr (kMoving)
    return m.at(t);
  else
    return (m.home);
}

/// kMoving: the markers have laws of their own; without them half of the equations is zero.
template <Reads kReads, bool kMoving>
class RelativePair {
 public:
  RelativePair(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in)
      : O1_(in.slot(P.slot)),
        O2_(in.slot(S.slot)),
        P_(marker_motion<kMoving>(P, in.t)),
        S_(marker_motion<kMoving>(S, in.t)) {
    const auto o1 = kernel::body(O1_), o2 = kernel::body(O2_);
    const auto p = kernel::marker<kMoving, kMoving>(P_), s = kernel::marker<kMoving, kMoving>(S_);
    if constexpr (reads(kReads, Reads::translation)) {
      const kernel::NoShift none{};
      const auto at = kernel::position(o1, o2, p, s);
      const auto moving = kernel::velocity(o1, o2, p, at);
      s_ = at.s;
      put<0>(y_, at.rho), put<0>(yd_, kernel::position_rate(s, at, moving));
      put<0>(Qhat_, kernel::translation_Qhat(o1, o2, p, s, none, at, moving));
      if constexpr (kMoving) put<0>(Ct_, kernel::translation_Ct(o1, o2, p, s, none, at));
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const kernel::NoTurn none{};
      const auto r = kernel::rotation_error(o1, o2, p, s, none);
      const auto w = kernel::angular_velocities(o1, o2, p, s, none);
      const auto rd = kernel::rotation_rate(r, w);
      h_ = 0.5 * r;
      put(y_, r), put(yd_, rd), put(Qhat_, kernel::rotation_Qhat(r, rd, w));
      if constexpr (kMoving) put(Ct_, kernel::rotation_Ct(r, p, s, none));
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
      const auto n2 = vec::matrix(S_.A) * vec::Vector{g[0], g[1], g[2]};
      const auto n = vec::matrix(O2_.A) * n2;
      const auto r = kernel::translation_row(vec::matrix(O1_.A), vec::vector(P_.u), s_, n, n2);
      row.v = vec::as<Vec3>(r.v), row.w1 = vec::as<Vec3>(r.w1), row.w2 = vec::as<Vec3>(r.w2);
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const vec::Quaternion gr{g[kN - 4], vec::Vector{g[kN - 3], g[kN - 2], g[kN - 1]}};
      const auto r = kernel::rotation_row(h_, vec::matrix(P_.A), vec::matrix(S_.A), gr);
      row.w1 += vec::as<Vec3>(r.w1), row.w2 += vec::as<Vec3>(r.w2);
    }
    if constexpr (kMoving) row.Ct = g.dot(Ct_.template segment<kN>(kFirst));
    row.Qhat = g.dot(Qhat_.template segment<kN>(kFirst));
    return row;
  }

 private:
  template <int kFirst, class V>
  static void put(Vec7T<double>& y, const V& v) {
    y[kFirst] = v.x, y[kFirst + 1] = v.y, y[kFirst + 2] = v.z;
  }
  template <class W, class V>
  static void put(Vec7T<double>& y, const vec::Quaternion<W, V>& q) {
    y[3] = q.w, put<4>(y, q.v);
  }

  const Motion &O1_, &O2_;
  std::conditional_t<kMoving, MarkerMotion, const MarkerMotion&> P_, S_;
  vec::Vector<double> s_;
  vec::Quaternion<double, vec::Vector<double>> h_{};
  Vec7T<double> y_, yd_, Qhat_;
  std::conditional_t<kMoving, Vec7T<double>, vec::Zero> Ct_;
};

template <Reads kReads>
using StillPair = RelativePair<kReads, false>;
template <Reads kReads>
using MovingPair = RelativePair<kReads, true>;

}  // namespace lockstep
