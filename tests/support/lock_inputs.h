// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The library's inputs made from a Configuration of the oracles, and laws that stand at one value with given rates.

#include <memory>
#include <string>

#include <lockstep/author/passes.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/joints.h>
#include "tests/support/configuration.h"
#include "tests/support/paper_lock.h"

namespace lockstep::inputs {

inline Quat quat(const Vec4& c) { return Quat::from(c); }

/// Law values at one instant; the time asked for plays no part.
class Number final : public MotionLaw {
 public:
  explicit Number(LawValue value) : value_(value) {}
  LawValue at(double) const override { return value_; }

 private:
  LawValue value_;
};
class Translation final : public TranslationLaw {
 public:
  explicit Translation(TranslationValue value) : value_(value) {}
  TranslationValue at(double) const override { return value_; }

 private:
  TranslationValue value_;
};
class Rotation final : public RotationLaw {
 public:
  explicit Rotation(RotationValue value) : value_(value) {}
  RotationValue at(double) const override { return value_; }

 private:
  RotationValue value_;
};

/// (1.6) w = G(q) qd and its rate G(q) qdd, by the oracle's G.
inline RotationValue rotation_value(const Vec4& q, const Vec4& qd, const Vec4& qdd) {
  const auto G = oracle::paper::G(q);
  return {quat(q), G * qd, G * qdd};
}

inline Motion motion(const Vec3& x, const Vec4& q, const Vec3& v, const Vec3& w) {
  Motion O;
  O.x = x, O.A = oracle::paper::rotation(q), O.e = quat(q), O.v = v, O.w = w;
  return O;
}
inline MarkerMotion marker(const Vec3& u, const Vec3& ud, const Vec3& udd, const Vec4& q, const Vec4& qd,
                           const Vec4& qdd) {
  const RotationValue r = rotation_value(q, qd, qdd);
  MarkerMotion m;
  m.u = u, m.ud = ud, m.udd = udd, m.A = oracle::paper::rotation(q), m.q = r.q, m.w = r.w, m.a = r.a;
  return m;
}

/// All that the kernel sees of a configuration.
struct KernelInputs {
  Motion O1, O2;
  MarkerMotion P, S;
  ImposedTranslationT<double> p;
  ImposedRotationT<double> D;

  explicit KernelInputs(const oracle::Configuration& c)
      : O1(motion(c.x1, c.q1, c.v1, c.w1)),
        O2(motion(c.x2, c.q2, c.v2, c.w2)),
        P(marker(c.uP, c.uPd, c.uPdd, c.qP, c.qPd, c.qPdd)),
        S(marker(c.uS, c.uSd, c.uSdd, c.qS, c.qSd, c.qSdd)),
        p{c.pD, c.pDd, c.pDdd} {
    const RotationValue r = rotation_value(c.qD, c.qDd, c.qDdd);
    D.q = r.q, D.A = oracle::paper::rotation(c.qD), D.w = r.w, D.a = r.a;
  }
};

/// A marker that stands at u, q with the rates given; those not wanted as laws are its constant pose. Where there is a
/// law, the marker's home lies elsewhere, so that the law's own frame is tested too.
inline Marker& add_marker(System& system, const std::string& name, Body& body, const Vec3& u, const Vec3& ud,
                          const Vec3& udd, const Vec4& q, const Vec4& qd, const Vec4& qdd, bool slides, bool spins) {
  const Quat home = spins ? axis_angle(Vec3(0.3, -0.8, 0.5), 1.1) : quat(q);
  const Vec3 start = slides ? Vec3(0.2, -0.4, 0.7) : u;
  Marker& m = system.add_marker(name, body, {start, home});
  const Mat3 A = rotation(home);
  if (slides)
    m.translation_law = std::make_shared<Translation>(
        TranslationValue{A.transpose() * (u - start), A.transpose() * ud, A.transpose() * udd});
  if (spins) {
    RotationValue r = rotation_value(q, qd, qdd);
    r.q = conjugate(home) * r.q;
    m.rotation_law = std::make_shared<Rotation>(r);
  }
  return m;
}

/// A system of two bodies in the motion of the configuration, with the lock between them. Which of them is ground is
/// said by `grounded`: 0 none, 1 or 2 (that body must be at rest in the configuration).
struct TwoBodies {
  System system;
  Body* body1;
  Body* body2;
  Marker* P;
  Marker* S;

  TwoBodies(const oracle::Configuration& c, unsigned laws, int grounded = 0) {
    body1 = &add_body("one", c.x1, c.q1, c.v1, c.w1, grounded == 1);
    body2 = &add_body("two", c.x2, c.q2, c.v2, c.w2, grounded == 2);
    P = &add_marker(system, "P", *body1, c.uP, c.uPd, c.uPdd, c.qP, c.qPd, c.qPdd, laws & oracle::kUP,
                    laws & oracle::kQP);
    S = &add_marker(system, "S", *body2, c.uS, c.uSd, c.uSdd, c.qS, c.qSd, c.qSdd, laws & oracle::kUS,
                    laws & oracle::kQS);
  }
  Body& add_body(const std::string& name, const Vec3& x, const Vec4& q, const Vec3& v, const Vec3& w, bool fixed) {
    const Pose home{x, quat(q)};
    if (fixed) return system.add_fixed(name, home);
    Body& b = system.add_body(name, {2.0, Vec3::Zero(), Vec3(0.5, 0.6, 0.7).asDiagonal()}, home);
    b.start = {v, w};
    return b;
  }
  /// The lock of the mask with p and q_D as laws where they are wanted and the mask has rows for them.
  GenericLock& lock(const oracle::Configuration& c, Mask mask, unsigned laws) {
    GenericLock& link = system.add<GenericLock>("lock", *P, *S, mask);
    if ((laws & oracle::kP) && overlaps(mask, Mask::xyz))
      link.move(std::make_shared<Translation>(TranslationValue{c.pD, c.pDd, c.pDdd}));
    if ((laws & oracle::kQD) && overlaps(mask, Mask::e123))
      link.turn(std::make_shared<Rotation>(rotation_value(c.qD, c.qDd, c.qDdd)));
    return link;
  }
};

/// Rows of all links in force at a state: C, Ct, Qhat, and the jacobian on 6 columns a slot.
struct Rows {
  VecX C, Ct, Qhat;
  MatX J;
};
inline Rows gathered(System& system, const State& state) {
  system.setup();
  RowTable table;
  std::vector<Motion> motions;
  passes::lay_out(system, state.modes, table);
  passes::motions(system, state, motions);
  Inputs in;
  in.t = state.t, in.motions = motions;
  in.s = {state.s.data(), static_cast<std::size_t>(state.s.size())};
  in.z = {state.z.data(), static_cast<std::size_t>(state.z.size())};
  passes::gather_rows(system, in, table);
  Rows r{VecX(table.n_rows), VecX(table.n_rows), VecX(table.n_rows), MatX::Zero(table.n_rows, 6 * system.n_slots())};
  for (const RowEntry& e : table.entries) {
    const RowBlock block = table.block(e);
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      r.C[row] = block.C(k), r.Ct[row] = block.Ct(k), r.Qhat[row] = block.Qhat(k);
      for (int i = 0; i < e.slots.n; ++i)
        for (std::size_t j = 0; j < 6; ++j) r.J(row, 6 * e.slots[i] + static_cast<int>(j)) = block.J(i, k)[j];
    }
  }
  return r;
}

/// The largest |a - b| / max(1, |b|); infinite if sizes differ or a number is not finite.
inline double difference(const MatX& a, const MatX& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols() || !a.allFinite() || !b.allFinite()) return HUGE_VAL;
  return a.size() == 0 ? 0.0 : ((a - b).array().abs() / b.array().abs().max(1.0)).maxCoeff();
}

}  // namespace lockstep::inputs
