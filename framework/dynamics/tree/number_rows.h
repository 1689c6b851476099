// SPDX-License-Identifier: BSD-3-Clause
// LinkRows: the rows of one link: the equations of <lockstep/detail/equations.h> on arrays of any numbers, translations in world
// axes.
#pragma once

#include <lockstep/detail/kernel.h>
#include "framework/dynamics/tree/closure_plan.h"

namespace lockstep::numbers {

/// f(Unit<j>) for an axis j known at run time. f is compiled three times: keep it short. It returns one type for all.
template <class F>
LOCKSTEP_INLINE auto along(int j, F&& f) {
  if (j == 0) return f(vec::Unit<0>{});
  if (j == 1) return f(vec::Unit<1>{});
  return f(vec::Unit<2>{});
}

/// Of a link: its bodies' motions (closure_plan.h, body), markers, laws, and its Jacobians (none: the ground); J and Qhat of
/// rows along the axes of S.
template <class Array>
struct LinkRows {
  using V3 = VectorIn<Array>;
  const Link& node;
  const Array O1, O2, markers, laws, J1, J2, c;

  LOCKSTEP_INLINE LinkRows(const Link& n, const RowArrays<Array>& z)
      : node(n),
        O1(z.body + body::size * static_cast<std::size_t>(n.P)),
        O2(z.body + body::size * static_cast<std::size_t>(n.S)),
        markers(z.frames + n.frames),
        laws(z.law + n.law),
        J1(n.J_P < 0 ? Array{} : z.J + n.J_P),
        J2(n.J_S < 0 ? Array{} : z.J + n.J_S),
        c(z.c + n.x) {}

  LOCKSTEP_INLINE void write() const {
    if (node.row[0] < 3) translations();
    const auto aligned = kernel::Marker{vec::None{}, vec::Identity{}, vec::NoTurn{}};
    if (node.turn == Turn::parallel)
      rotations(aligned, aligned, kernel::NoTurn{});
    else if (node.turn == Turn::plain)
      rotations(P(), S(), kernel::NoTurn{});
    else if (node.turn == Turn::law)
      rotations(P(), S(),
                kernel::Turn{load4(laws, law::q), load9(laws, law::A), load3(laws, law::w), load3(laws, law::a)});
  }

 private:
  LOCKSTEP_INLINE auto A1() const { return load9(O1, body::A); }
  LOCKSTEP_INLINE auto A2() const { return load9(O2, body::A); }
  LOCKSTEP_INLINE auto A_S() const { return load9(markers, frames::AS); }
  // In world axes, for translations.
  LOCKSTEP_INLINE static auto in_world(const Array& p) {
    return kernel::Body{load3(p, body::x), vec::Identity{}, vec::NoTurn{}, load3(p, body::v), load3(p, body::W)};
  }
  // In its own axes, for rotations.
  LOCKSTEP_INLINE static auto in_slot(const Array& p) {
    return kernel::Body{vec::None{}, vec::Identity{}, load4(p, body::e), vec::None{}, load3(p, body::w)};
  }
  LOCKSTEP_INLINE auto P() const {
    return kernel::Marker{vec::None{}, load9(markers, frames::AP), load4(markers, frames::qP)};
  }
  LOCKSTEP_INLINE auto S() const { return kernel::Marker{vec::None{}, A_S(), load4(markers, frames::qS)}; }

  // Row k on both bodies, columns from `first` on.
  template <class R1, class R2>
  LOCKSTEP_INLINE void put(int first, int k, const R1& r1, const R2& r2) const {
    if (J1) put(J1, first, k, r1);
    if (J2) put(J2, first, k, r2);
  }
  template <class R>
  LOCKSTEP_INLINE void put(const Array& J, int first, int k, const R& r) const {
    store(J, static_cast<std::size_t>(first * node.m + k), r.x);
    store(J, static_cast<std::size_t>((first + 1) * node.m + k), r.y);
    store(J, static_cast<std::size_t>((first + 2) * node.m + k), r.z);
  }

  LOCKSTEP_INLINE void translations() const {
    if (!node.moved) return translations(kernel::NoShift{});
    const auto R = A2() * A_S();
    translations(kernel::Shift{R * load3(laws, law::p), R * load3(laws, law::pd), R * load3(laws, law::pdd)});
  }
  // World axes, with the imposed shift d.
  template <class D>
  LOCKSTEP_INLINE void translations(const D& d) const {
    const auto A1 = this->A1(), A2 = this->A2();
    const auto uP = load3(markers, frames::uP);
    const auto B1 = in_world(O1), B2 = in_world(O2);
    const auto p = kernel::Marker{A1 * uP, vec::Identity{}, vec::NoTurn{}};
    const auto m = kernel::Marker{A2 * load3(markers, frames::uS), vec::Identity{}, vec::NoTurn{}};
    const auto at = kernel::position(B1, B2, p, m);
    const auto Qhat = kernel::translation_Qhat(B1, B2, p, m, d, at, kernel::velocity(B1, B2, p, at));
    const auto s = transpose_times(A2, at.s);
    const auto A_S = this->A_S();
    for (int k = 0; k < node.m && node.row[k] < 3; ++k) {
      const V3 n2 = along(
          node.row[k], [&](auto axis) __attribute__((always_inline)) { return A_S * axis; });
      const auto r = kernel::translation_row(A1, uP, s, A2 * n2, n2);
      put(0, k, r.v, -r.v), put(3, k, r.w1, r.w2);
      c[k] = dot(r.v, Qhat);
    }
  }

  template <class Near, class Far, class D>
  LOCKSTEP_INLINE void rotations(const Near& p, const Far& m, const D& d) const {
    const auto B1 = in_slot(O1), B2 = in_slot(O2);
    const auto e = kernel::rotation_error(B1, B2, p, m, d);
    const auto w = kernel::angular_velocities(B1, B2, p, m, d);
    const V3 Qhat = kernel::rotation_Qhat(e, kernel::rotation_rate(e, w), w).v;
    const auto h = 0.5 * e;
    const auto A_SD = m.A * d.A;
    for (int k = 0; k < node.m; ++k) {
      const int axis = node.row[k] - 3;
      if (axis < 0) continue;
      const auto of_markers = along(
          axis, [&](auto g) __attribute__((always_inline)) {
            return kernel::rotation_row(h, vec::Quaternion{vec::Zero{}, g});
          });
      const auto r = kernel::in_body_axes(of_markers, p.A, A_SD);
      put(3, k, r.w1, r.w2);
      c[k] = Qhat[axis];
    }
  }
};

}  // namespace lockstep::numbers
