// Rows of one link in lanes: the equations of <lockstep/equations.h> on packs, translations in world axes. Private
// to the room.
#pragma once

#include <lockstep/kernel.h>
#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/lane_numbers.h"

namespace lockstep::lanes::LOCKSTEP_SET {

/// What the rows are for: accelerations need the right side Qhat, the projection C and Ct.
enum class For { acceleration, projection };

/// The data of a link: its bodies' motions (lane_plan.h, body), markers, laws, and its jacobians (null: the ground).
struct LinkRows {
  const double *O1, *O2, *markers, *laws;
  double *J1, *J2;
  int m;
  LOCKSTEP_LANE LinkRows(const Plan& plan, const Link& node, const Numbers& z)
      : O1(z.body + kLanes * body::size * static_cast<std::size_t>(node.P)),
        O2(z.body + kLanes * body::size * static_cast<std::size_t>(node.S)),
        markers(z.frames + kLanes * node.frames),
        laws(z.law + kLanes * node.law),
        J1(node.side_P < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_P)].J),
        J2(node.side_S < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_S)].J),
        m(node.m) {}

  LOCKSTEP_LANE auto A1() const { return load9(O1, body::A); }
  LOCKSTEP_LANE auto A2() const { return load9(O2, body::A); }
  LOCKSTEP_LANE auto uP() const { return load3(markers, frames::uP); }
  LOCKSTEP_LANE auto uS() const { return load3(markers, frames::uS); }
  LOCKSTEP_LANE auto A_S() const { return load9(markers, frames::AS); }
  /// In world axes, for translations.
  LOCKSTEP_LANE static auto in_world(const double* p) {
    return kernel::Body{load3(p, body::x), vec::Identity{}, vec::NoTurn{}, load3(p, body::v), load3(p, body::W)};
  }
  /// In its own axes, for rotations.
  LOCKSTEP_LANE static auto in_slot(const double* p) {
    return kernel::Body{vec::None{}, vec::Identity{}, load4(p, body::e), vec::None{}, load3(p, body::w)};
  }
  LOCKSTEP_LANE auto P() const {
    return kernel::Marker{vec::None{}, load9(markers, frames::AP), load4(markers, frames::qP)};
  }
  LOCKSTEP_LANE auto S() const { return kernel::Marker{vec::None{}, A_S(), load4(markers, frames::qS)}; }
  LOCKSTEP_LANE auto turn() const {
    return kernel::Turn{load4(laws, law::q), load9(laws, law::A), load3(laws, law::w), load3(laws, law::a)};
  }
  /// Row k on both bodies, columns from `first` on.
  template <class R1, class R2>
  LOCKSTEP_LANE void put(int first, int k, const R1& r1, const R2& r2) const {
    if (J1) put(J1, first, k, r1);
    if (J2) put(J2, first, k, r2);
  }

 private:
  template <class R>
  LOCKSTEP_LANE void put(double* J, int first, int k, const R& r) const {
    store(J, static_cast<std::size_t>(first * m + k), r.x);
    store(J, static_cast<std::size_t>((first + 1) * m + k), r.y);
    store(J, static_cast<std::size_t>((first + 2) * m + k), r.z);
  }
};

/// f(Unit<j>) for an axis j known at run time. f is compiled three times: keep it short. It returns one type for all.
template <class F>
LOCKSTEP_LANE auto along(int j, F&& f) {
  if (j == 0) return f(vec::Unit<0>{});
  if (j == 1) return f(vec::Unit<1>{});
  return f(vec::Unit<2>{});
}
LOCKSTEP_LANE V component(int j, const V3& a) { return j == 0 ? a.x : j == 1 ? a.y : a.z; }

/// World axes, with the imposed shift d: rows n along the axes of the world (a triple), or of S.
template <bool kTriple, For kFor, class D>
LOCKSTEP_LANE void translation(const Link& node, const LinkRows& in, const Numbers& z, const D& d) {
  const auto A1 = in.A1(), A2 = in.A2();
  const auto uP = in.uP();
  const auto B1 = in.in_world(in.O1), B2 = in.in_world(in.O2);
  const auto p = kernel::Marker{A1 * uP, vec::Identity{}, vec::NoTurn{}};
  const auto m = kernel::Marker{A2 * in.uS(), vec::Identity{}, vec::NoTurn{}};
  const auto at = kernel::position(B1, B2, p, m);
  const auto c = [&]() __attribute__((always_inline)) {
    if constexpr (kFor == For::acceleration)
      return kernel::translation_Qhat(B1, B2, p, m, d, at, kernel::velocity(B1, B2, p, at));
    else
      return at.rho - d.p;
  }
  ();
  const auto Ct = kernel::translation_Ct(B1, B2, p, m, d, at);
  constexpr bool kCt = kFor == For::projection && !std::is_same_v<D, kernel::NoShift>;
  double* const out = kFor == For::acceleration ? z.c : z.C;

  const auto s = transpose_times(A2, at.s);
  if constexpr (kTriple) {
    store3(out, node.x, c);
    if constexpr (kCt) store3(z.Ct, node.x, Ct);
    const auto row = [&]<int k>() __attribute__((always_inline)) {
      const vec::Unit<k> n{};
      const auto r = kernel::translation_row(A1, uP, s, n, transpose_times(A2, n));
      in.put(0, k, r.w1, r.w2);
    };
    row.template operator()<0>(), row.template operator()<1>(), row.template operator()<2>();
  } else {
    const auto A_S = in.A_S();
    for (int k = 0; k < node.m && node.row[static_cast<std::size_t>(k)] < 3; ++k) {
      const V3 n2 = along(
          node.row[static_cast<std::size_t>(k)], [&](auto axis) __attribute__((always_inline)) { return A_S * axis; });
      const auto r = kernel::translation_row(A1, uP, s, A2 * n2, n2);
      in.put(0, k, r.v, -r.v), in.put(3, k, r.w1, r.w2);
      store(out, node.x + static_cast<std::size_t>(k), dot(r.v, c));
      if constexpr (kCt) store(z.Ct, node.x + static_cast<std::size_t>(k), dot(r.v, Ct));
    }
  }
}

/// The imposed shift of a link, in world axes.
template <bool kTriple, For kFor>
LOCKSTEP_LANE void translation(const Link& node, const LinkRows& in, const Numbers& z) {
  if (!node.moved) return translation<kTriple, kFor>(node, in, z, kernel::NoShift{});
  const auto R = in.A2() * in.A_S();
  translation<kTriple, kFor>(
      node, in, z,
      kernel::Shift{R * load3(in.laws, law::p), R * load3(in.laws, law::pd), R * load3(in.laws, law::pdd)});
}

template <bool kTriple, For kFor, class P, class S, class D>
LOCKSTEP_LANE void rotation(const Link& node, const LinkRows& in, const Numbers& z, const P& p, const S& m,
                            const D& d) {
  const auto O1 = in.in_slot(in.O1), O2 = in.in_slot(in.O2);
  const auto e = kernel::rotation_error(O1, O2, p, m, d);
  const auto c = [&]() __attribute__((always_inline)) {
    if constexpr (kFor == For::acceleration) {
      const auto w = kernel::angular_velocities(O1, O2, p, m, d);
      return kernel::rotation_Qhat(e, kernel::rotation_rate(e, w), w).v;
    } else {
      return e.v;
    }
  }
  ();
  const auto Ct = kernel::rotation_Ct(e, p, m, d).v;
  constexpr bool kCt = kFor == For::projection && !std::is_same_v<D, kernel::NoTurn>;
  double* const out = kFor == For::acceleration ? z.c : z.C;

  const auto h = 0.5 * e;
  const auto A_SD = m.A * d.A;
  for (int k = kTriple ? 3 : 0; k < node.m; ++k) {
    const int axis = node.row[static_cast<std::size_t>(k)] - 3;
    if (!kTriple && axis < 0) continue;
    const auto of_markers = along(
        axis, [&](auto g) __attribute__((always_inline)) {
          return kernel::rotation_row(h, vec::Quaternion{vec::Zero{}, g});
        });
    const auto r = kernel::in_body_axes(of_markers, p.A, A_SD);
    in.put(kTriple ? 0 : 3, k, r.w1, r.w2);
    store(out, node.x + static_cast<std::size_t>(k), component(axis, c));
    if constexpr (kCt) store(z.Ct, node.x + static_cast<std::size_t>(k), component(axis, Ct));
  }
}

template <bool kTriple, For kFor>
LOCKSTEP_LANE void rows(const Plan& plan, const Link& node, const Numbers& z) {
  const LinkRows in(plan, node, z);
  if (kTriple || node.row[0] < 3) translation<kTriple, kFor>(node, in, z);
  if (kTriple && node.m == 3) return;
  switch (node.turn) {
    case Turn::parallel: {
      const auto aligned = kernel::Marker{vec::None{}, vec::Identity{}, vec::NoTurn{}};
      return rotation<kTriple, kFor>(node, in, z, aligned, aligned, kernel::NoTurn{});
    }
    case Turn::plain:
      return rotation<kTriple, kFor>(node, in, z, in.P(), in.S(), kernel::NoTurn{});
    case Turn::law:
      return rotation<kTriple, kFor>(node, in, z, in.P(), in.S(), in.turn());
    default:
      return;
  }
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
