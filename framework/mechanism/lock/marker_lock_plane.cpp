// SPDX-License-Identifier: BSD-3-Clause
// MarkerLock in a planar mechanism: the equations of kernel.h with all vectors in the plane or along its normal.
#include <algorithm>
#include <cmath>

#include <lockstep/author/lock.h>
#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/clones.h"

namespace lockstep {
namespace {

using vec::Vector, vec::Zero;

// The axis of the frame that lies along the plane's normal, -1 if none does.
int axis_along(const Mat3& A, int n) {
  for (int a = 0; a < 3; ++a)
    if (std::abs(std::abs(A(n, a)) - 1.0) < 1e-12) return a;
  return -1;
}

[[noreturn, gnu::noinline, gnu::cold]] void leaves_plane(const MarkerLock& lock, double t) {
  throw ModelError("joint '" + lock.name() + "': its law leaves the plane at t = " + text::number(t) +
                   " s, and the scene is planar; set \"planar\" to \"off\"");
}

}  // namespace

bool MarkerLock::setup_plane(Plane plane) {
  flat_ = nullptr;
  if ((laws_ & (with::uP | with::qP | with::uS | with::qS)) != 0 || row_count() != n_rows_) return false;
  const int a = axis_along(S_.A, plane.n);
  if (a < 0) return false;
  Flat f;
  f.plane = plane;
  f.turn_axis = a;
  f.turn = includes(rows_, row_bit(3 + a));
  f.sign = S_.A(plane.n, a) > 0 ? 1 : -1;
  if (f.turn && (axis_along(P_.A, plane.n) != a || f.sign * P_.A(plane.n, a) < 0)) return false;
  for (int k = 0; k < 3; ++k)
    if (k != a && includes(rows_, row_bit(k))) f.axes[f.n_translations++] = k;
  f.pair = f.n_translations == 2;
  if (f.n_translations == 0 && !f.turn && (laws_ & (with::p | with::qD)))
    throw ModelError("joint '" + name() + "' has laws but no constraint in the plane; set \"planar\" to \"off\"");
  f.uP[0] = P_.u[plane.i()], f.uP[1] = P_.u[plane.j()];
  f.uS[0] = S_.u[plane.i()], f.uS[1] = S_.u[plane.j()];
  for (int k = 0; k < f.n_translations; ++k)
    f.S[k][0] = S_.A(plane.i(), f.axes[k]), f.S[k][1] = S_.A(plane.j(), f.axes[k]);
  const Quat q = conjugate(S_.q) * P_.q;
  f.q[0] = q.w, f.q[1] = q.vec()[a];
  flat_ = std::make_unique<const Flat>(f);
  return true;
}

bool ImposedMotion::stays_in_plane(const Vec3& normal) const {
  return (!move || move->stays_in_plane(normal)) && (!turn || turn->turns_about(normal)) &&
         std::ranges::all_of(drives, [&](const Drive& drive) { return axis_stays_in_plane(drive.axis, normal); });
}

bool MarkerLock::laws_stay_in_plane(Plane plane) const {
  if (lawful_ && (!lawful_->P.stays_in_plane(plane) || !lawful_->S.stays_in_plane(plane))) return false;
  return imposed().stays_in_plane(S_.A.row(plane.n));
}

// Throws if a law leaves the plane at this time.
void MarkerLock::refuse_leaving_plane(const Inputs& in) const {
  if (imposed().hold) return;  // where its bodies stand in the plane
  const int a = flat_->turn_axis;
  if ((laws_ & with::p) && includes(rows_, row_bit(a)))
    if (const Vec3 p = imposed_translation(in).p; std::abs(p[a]) > kParallel * p.norm()) leaves_plane(*this, in.t);
  if (!(laws_ & with::qD)) return;
  Vec3 other = imposed_rotation(in).q.vec();
  other[a] = 0;
  if (other.norm() > kParallel) leaves_plane(*this, in.t);
}

// In world axes; vectors by their components along i, j and the normal.
LOCKSTEP_INLINE void MarkerLock::flat_translations(const Inputs& in, const RowBlock& block) const {
  const Flat& f = *flat_;
  const int i = f.plane.i(), j = f.plane.j(), n = f.plane.n;
  const Motion &O1 = in.slot(slot1_), &O2 = in.slot(slot2_);
  const auto in_plane = [](double x, double y) __attribute__((always_inline)) { return Vector{x, y, Zero{}}; };
  const auto turned = [&](const Motion& O, const double* u) __attribute__((always_inline)) {
    return in_plane(O.A(i, i) * u[0] - O.A(j, i) * u[1], O.A(j, i) * u[0] + O.A(i, i) * u[1]);
  };
  const auto body = [&](const Motion& O) __attribute__((always_inline)) {
    return kernel::Body{in_plane(O.x[i], O.x[j]), vec::Identity{}, vec::NoTurn{}, in_plane(O.v[i], O.v[j]),
                        Vector{Zero{}, Zero{}, O.w[n]}};
  };
  const auto B1 = body(O1), B2 = body(O2);
  const kernel::Marker P{turned(O1, f.uP), vec::Identity{}, vec::NoTurn{}};
  const auto s0 = turned(O2, f.S[0]), s1 = turned(O2, f.S[1]);
  const kernel::Marker S{turned(O2, f.uS), vec::Matrix{in_plane(s0.x, s1.x), in_plane(s0.y, s1.y), vec::Unit<2>{}},
                         vec::NoTurn{}};
  ImposedTranslation law;
  if (laws_ & with::p) law = imposed_translation(in);
  const int a = f.axes[0], b = f.axes[1];
  const kernel::Shift D{in_plane(law.p[a], law.p[b]), in_plane(law.pd[a], law.pd[b]), in_plane(law.pdd[a], law.pdd[b])};

  const auto at = kernel::position(B1, B2, P, S);
  const auto C = at.rho - D.p;
  const auto Ct = kernel::translation_Ct(B1, B2, P, S, D, at);
  const auto Qhat = kernel::translation_Qhat(B1, B2, P, S, D, at, kernel::velocity(B1, B2, P, at));
  block.C(0) = C.x, block.Ct(0) = Ct.x, block.Qhat(0) = Qhat.x;
  if (f.pair) {  // rows along i and j of the world
    block.C(1) = C.y, block.Ct(1) = Ct.y, block.Qhat(1) = Qhat.y;
    const auto row_i = kernel::translation_row(B1.A, P.u, at.s, vec::Unit<0>{}, vec::Unit<0>{});
    const auto row_j = kernel::translation_row(B1.A, P.u, at.s, vec::Unit<1>{}, vec::Unit<1>{});
    block.set_R((Eigen::Matrix2d() << s0.x, s1.x, s0.y, s1.y).finished());
    block.set_A(side1_, Eigen::Vector2d(row_i.w1.z, row_j.w1.z));
    block.set_A(side2_, Eigen::Vector2d(row_i.w2.z, row_j.w2.z));
    return;
  }
  const auto row = kernel::translation_row(B1.A, P.u, at.s, s0, s0);
  Vec3 v = Vec3::Zero(), w1 = Vec3::Zero(), w2 = Vec3::Zero();
  v[i] = row.v.x, v[j] = row.v.y, w1[n] = row.w1.z, w2[n] = row.w2.z;
  block.set(side1_, 0, v, w1);
  block.set(side2_, 0, Vec3(-v), w2);
}

// About the common turn axis of S and P, which points at the viewer of the plane.
template <class Law>
LOCKSTEP_INLINE void MarkerLock::flat_turn(const Inputs& in, const Law& D, const RowBlock& block) const {
  const Flat& f = *flat_;
  const int row = f.n_translations, n = f.plane.n;
  const auto along = [](double z) __attribute__((always_inline)) { return Vector{Zero{}, Zero{}, z}; };
  const auto body = [&](const Motion& O) __attribute__((always_inline)) {
    return kernel::Body{vec::None{}, vec::Identity{}, vec::Quaternion{O.e.w, along(f.sign * O.e.vec()[n])}, vec::None{},
                        along(f.sign * O.w[n])};
  };
  const auto B1 = body(in.slot(slot1_)), B2 = body(in.slot(slot2_));
  const kernel::Marker P{vec::None{}, vec::Identity{}, vec::Quaternion{f.q[0], along(f.q[1])}};
  const kernel::Marker S{vec::None{}, vec::Identity{}, vec::NoTurn{}};
  const auto e = kernel::rotation_error(B1, B2, P, S, D);
  const auto w = kernel::angular_velocities(B1, B2, P, S, D);
  block.C(row) = e.v.z;
  block.Ct(row) = vec::number<double>(kernel::rotation_Ct(e, P, S, D).v.z);
  block.Qhat(row) = kernel::rotation_Qhat(e, kernel::rotation_rate(e, w), w).v.z;
  const auto r = kernel::rotation_row(0.5 * e, P.A, S.A, vec::Quaternion{Zero{}, vec::Unit<2>{}});
  Vec3 w1 = Vec3::Zero(), w2 = Vec3::Zero();
  w1[n] = f.sign * r.w1.z, w2[n] = f.sign * r.w2.z;
  block.set(side1_, row, Vec3(Vec3::Zero()), w1);
  block.set(side2_, row, Vec3(Vec3::Zero()), w2);
}

LOCKSTEP_FLAT_CLONES void MarkerLock::gather_flat(Group links, const Inputs& in, RowSpan out) const {
  for (std::size_t l = 0; l < links.size(); ++l) {
    const auto& lock = static_cast<const MarkerLock&>(*links[l]);
    const RowBlock block = out.lane(l);
    const Flat& f = *lock.flat_;
    if (lock.laws_ & (with::p | with::qD)) lock.refuse_leaving_plane(in);
    if (f.n_translations > 0) lock.flat_translations(in, block);
    if (!f.turn) continue;
    if (!(lock.laws_ & with::qD)) {
      lock.flat_turn(in, kernel::NoTurn{}, block);
      continue;
    }
    const ImposedRotation D = lock.imposed_rotation(in);
    const auto along = [&](const Vec3& a) { return Vector{Zero{}, Zero{}, a[f.turn_axis]}; };
    lock.flat_turn(in, kernel::Turn{vec::Quaternion{D.q.w, along(D.q.vec())}, vec::Identity{}, along(D.w), along(D.a)},
                   block);
  }
}

void MarkerLock::gather_plane(Group links, const Inputs& in, RowSpan out) const { gather_flat(links, in, out); }

}  // namespace lockstep
