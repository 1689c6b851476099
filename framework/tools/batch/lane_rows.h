// Rows of one link in lanes: jacobians and right sides, as in mechanism/lock/kernel.h (letters and numbers are those of the
// theory), the full translational triple in world axes. Private to the room.
#pragma once

#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/lane_numbers.h"

namespace lockstep::lanes::LOCKSTEP_SET {

/// What the rows are asked for: the right side Qhat, or what projection moves to zero: C and Ct.
enum class For { acceleration, projection };

/// Motion of one slot, as the body pass left it.
struct Slot {
  const double* p;
  LOCKSTEP_LANE V3 x() const { return load3(p, body::x); }
  LOCKSTEP_LANE M3 A() const { return load9(p, body::A); }
  LOCKSTEP_LANE Q4 e() const { return load4(p, body::e); }
  LOCKSTEP_LANE V3 v() const { return load3(p, body::v); }
  LOCKSTEP_LANE V3 w() const { return load3(p, body::w); }
  LOCKSTEP_LANE V3 W() const { return load3(p, body::W); }
};
LOCKSTEP_LANE Slot slot(const Numbers& z, int k) {
  return {z.body + kLanes * body::size * static_cast<std::size_t>(k)};
}
/// Columns first .. first + 2 of row k of a block with m rows.
LOCKSTEP_LANE void put_row(double* J, int m, int first, int k, const V3& r) {
  store(J, static_cast<std::size_t>(first * m + k), r.x);
  store(J, static_cast<std::size_t>((first + 1) * m + k), r.y);
  store(J, static_cast<std::size_t>((first + 2) * m + k), r.z);
}
LOCKSTEP_LANE V3 row_of(const M3& A, int k) { return k == 0 ? A.r0 : k == 1 ? A.r1 : A.r2; }

template <bool kTriple, For kFor>
LOCKSTEP_LANE void translation(const Plan& plan, const Link& node, const Numbers& z) {
  const Slot O1 = slot(z, node.P), O2 = slot(z, node.S);
  const double *f = z.frames + kLanes * node.frames, *l = z.law + kLanes * node.law;
  double* J1 = node.side_P < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_P)].J;
  double* J2 = node.side_S < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_S)].J;
  const M3 A1 = O1.A(), A2 = O2.A();
  const V3 uP = load3(f, frames::uP);
  // (3.8) in world axes: s = x1 + A1 uP - x2
  const V3 r = A1 * uP, sW = O1.x() + r - O2.x(), s = turned_back(A2, sW);

  V3 c;  // world: Qhat, or C
  if constexpr (kFor == For::acceleration) {
    // (3.10), (3.12): sd = v1 + w1 x r - v2 - w2 x s,  Qhat = w2 x (2 sd + w2 x s) - w1 x (w1 x r)
    const V3 W1 = O1.W(), W2 = O2.W(), w1r = cross(W1, r), w2s = cross(W2, sW);
    const V3 sd = O1.v() + w1r - O2.v() - w2s;
    c = cross(W2, sd + sd + w2s) - cross(W1, w1r);
  } else {
    c = sW - A2 * load3(f, frames::uS);
  }
  if constexpr (kTriple) {  // (3.9) turned into world axes: 1 | -A1 uP~ | -1 | A2 s~
    if (node.moved) {
      const M3 AS = load9(f, frames::AS);
      if constexpr (kFor == For::acceleration) {
        c = c + A2 * (AS * load3(l, law::pdd));
      } else {
        c = c - A2 * (AS * load3(l, law::p));
        store3(z.Ct, node.x, -(A2 * (AS * load3(l, law::pd))));
      }
    }
    store3(kFor == For::acceleration ? z.c : z.C, node.x, c);
    for (int k = 0; k < 3; ++k) {
      if (J1) put_row(J1, node.m, 0, k, cross(uP, row_of(A1, k)));
      if (J2) put_row(J2, node.m, 0, k, cross(row_of(A2, k), s));
    }
  } else {  // (3.9)
    const M3 AS = load9(f, frames::AS);
    for (int k = 0; k < node.m && node.row[static_cast<std::size_t>(k)] < 3; ++k) {
      const int j = node.row[static_cast<std::size_t>(k)];
      const V3 n = column(AS, j), Rt = A2 * n;
      if (J1) put_row(J1, node.m, 0, k, Rt), put_row(J1, node.m, 3, k, cross(uP, turned_back(A1, Rt)));
      if (J2) put_row(J2, node.m, 0, k, -Rt), put_row(J2, node.m, 3, k, cross(n, s));
      const std::size_t at = node.x + static_cast<std::size_t>(k), d = static_cast<std::size_t>(j);
      V ck = dot(Rt, c);
      if constexpr (kFor == For::acceleration) {
        if (node.moved) ck += load(l, law::pdd + d);
        store(z.c, at, ck);
      } else {
        if (node.moved) ck -= load(l, law::p + d), store(z.Ct, at, -load(l, law::pd + d));
        store(z.C, at, ck);
      }
    }
  }
}

/// Row k of (h0 1 + hv~), (4.12).
LOCKSTEP_LANE V3 half_row(int k, const V& h0, const V3& hv) {
  if (k == 0) return {h0, -hv.z, hv.y};
  if (k == 1) return {hv.z, h0, -hv.x};
  return {-hv.y, hv.x, h0};
}

template <bool kTriple, Turn kTurn, For kFor>
LOCKSTEP_LANE void rotation(const Plan& plan, const Link& node, const Numbers& z) {
  constexpr bool kParallel = kTurn == Turn::parallel, kLaw = kTurn == Turn::law;
  constexpr int kFirst = kTriple ? 0 : 3;  // column of the angular part
  const Slot O1 = slot(z, node.P), O2 = slot(z, node.S);
  const double *f = z.frames + kLanes * node.frames, *l = z.law + kLanes * node.law;
  double* J1 = node.side_P < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_P)].J;
  double* J2 = node.side_S < 0 ? nullptr : z.J + kLanes * plan.sides[static_cast<std::size_t>(node.side_S)].J;

  // (4.1), (4.2)
  Q4 e = conjugate(O2.e()) * O1.e();
  M3 AP, AS, AD;
  if constexpr (!kParallel) {
    AP = load9(f, frames::AP), AS = load9(f, frames::AS);
    Q4 qS = load4(f, frames::qS);
    if constexpr (kLaw) AD = load9(l, law::A), qS = qS * load4(l, law::q);
    e = conjugate(qS) * (e * load4(f, frames::qP));
  }
  const V h0 = 0.5 * e.w;
  const V3 hv = 0.5 * e.v;
  V3 c;
  if constexpr (kFor == For::acceleration) {  // (4.10), (4.14)
    V3 WP = O1.w(), WD = O2.w(), WDd;
    if constexpr (!kParallel) WP = turned_back(AP, WP), WD = turned_back(AS, WD);
    if constexpr (kLaw) {
      const V3 delta = load3(l, law::w);
      WD = turned_back(AD, WD);
      WDd = load3(l, law::a) - cross(delta, WD);
      WD = WD + delta;
    }
    const V k = 0.25 * (dot(WP, WP) + dot(WD, WD));
    const V3 t = e.w * WP + cross(e.v, WP);
    V3 mid = cross(WD, t) - dot(e.v, WP) * WD;
    if constexpr (kLaw) mid = mid + e.w * WDd - cross(e.v, WDd);
    c = k * e.v + 0.5 * mid;
  } else {
    c = e.v;
  }
  V3 Ct;
  if constexpr (kLaw && kFor == For::projection) {  // (4.13)
    const V3 delta = load3(l, law::w);
    Ct = -(h0 * delta - cross(hv, delta));
  }
  for (int k = kTriple ? 3 : 0; k < node.m; ++k) {
    const int j = node.row[static_cast<std::size_t>(k)] - 3;
    if (!kTriple && j < 0) continue;
    V3 n1 = half_row(j, h0, hv), n2 = half_row(j, -h0, hv);  // (4.12)
    if constexpr (!kParallel) n1 = AP * n1;
    if constexpr (kLaw) n2 = AD * n2;
    if constexpr (!kParallel) n2 = AS * n2;
    if (J1) put_row(J1, node.m, kFirst, k, n1);
    if (J2) put_row(J2, node.m, kFirst, k, n2);
    const std::size_t at = node.x + static_cast<std::size_t>(k);
    store(kFor == For::acceleration ? z.c : z.C, at, component(c, j));
    if constexpr (kLaw && kFor == For::projection) store(z.Ct, at, component(Ct, j));
  }
}

template <bool kTriple, For kFor>
LOCKSTEP_LANE void rows(const Plan& plan, const Link& node, const Numbers& z) {
  if (kTriple || node.row[0] < 3) translation<kTriple, kFor>(plan, node, z);
  if (kTriple && node.m == 3) return;
  switch (node.turn) {
    case Turn::parallel:
      return rotation<kTriple, Turn::parallel, kFor>(plan, node, z);
    case Turn::plain:
      return rotation<kTriple, Turn::plain, kFor>(plan, node, z);
    case Turn::law:
      return rotation<kTriple, Turn::law, kFor>(plan, node, z);
    default:
      return;
  }
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
