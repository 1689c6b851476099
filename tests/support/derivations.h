// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Rows and right side of the lock derived in four ways from one configuration, and a lock that is made of them. For
/// tests and benchmarks: what the compact formulas of the theory save, and what the other ways cost.

#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/lock.h>
#include <lockstep/author/relative.h>
#include <lockstep/system.h>
#include "tests/support/constraint.h"
#include "tests/support/counted.h"
#include "tests/support/paper_lock.h"

namespace lockstep::derivations {

/// compact: the library's kernel. products: the paper's expressions, sixty quaternion products, literally. jets: the
/// bare constraint on numbers that carry exact derivatives. differences: the bare constraint, evaluated at neighbouring
/// states.
enum class Way { compact, products, jets, differences };
inline constexpr Way kWays[] = {Way::compact, Way::products, Way::jets, Way::differences};
inline const char* name(Way way) {
  constexpr const char* kNames[] = {"compact analytic expressions", "products of the original paper",
                                    "automatic differentiation (jets)", "finite differences"};
  return kNames[static_cast<int>(way)];
}

/// Steps of the differences, relative to lengths and rates of order 1: central first ones, second ones of second order.
struct Steps {
  double first = 6e-6;   ///< eps^(1/3)
  double second = 1e-4;  ///< eps^(1/4)
};

/// Six rows x y z e1 e2 e3; columns v1 (world), w1 (slot axes), v2, w2.
struct Rows {
  Eigen::Matrix<double, 6, 1> C, Ct, Qhat;
  oracle::Matrix6x12 J;
};

/// All that the four ways see: the kernel's own inputs.
struct Place {
  Motion O1, O2;
  MarkerMotion P, S;
  ImposedTranslationT<double> p;
  ImposedRotationT<double> D;
};

inline Rows compact(const Place& in) {
  TranslationRowsT<double> t;
  RotationRowsT<double> r;
  translation<with::all_laws>(in.O1, in.O2, in.P, in.S, in.p, Mask::all, t);
  rotation<with::all_laws>(in.O1, in.O2, in.P, in.S, in.D, Mask::all, r);
  Rows out;
  out.C << t.C, r.C;
  out.Ct << t.Ct, r.Ct;
  out.Qhat << t.Qhat, r.Qhat;
  out.J << t.Jv, t.Jw1, -t.Jv, t.Jw2, Mat3::Zero(), r.Jw1, Mat3::Zero(), r.Jw2;
  return out;
}

inline Place place(const oracle::Configuration& c) {
  const auto body = [](const Vec3& x, const Vec3& v, const Vec4& q, const Vec3& w) {
    Motion O;
    O.x = x, O.v = v, O.e = Quat::from(q), O.A = oracle::paper::rotation(q), O.w = w;
    return O;
  };
  const auto marker = [](const Vec3& u, const Vec3& ud, const Vec3& udd, const Vec4& q, const Vec4& qd,
                         const Vec4& qdd) {
    MarkerMotion m;  // (1.6) and its rate
    m.u = u, m.ud = ud, m.udd = udd, m.q = Quat::from(q), m.A = oracle::paper::rotation(q);
    m.w = oracle::paper::G(q) * qd, m.a = oracle::paper::G(q) * qdd;
    return m;
  };
  Place in;
  in.O1 = body(c.x1, c.v1, c.q1, c.w1), in.O2 = body(c.x2, c.v2, c.q2, c.w2);
  in.P = marker(c.uP, c.uPd, c.uPdd, c.qP, c.qPd, c.qPdd), in.S = marker(c.uS, c.uSd, c.uSdd, c.qS, c.qSd, c.qSdd);
  in.p = {c.pD, c.pDd, c.pDdd};
  in.D.q = Quat::from(c.qD), in.D.A = oracle::paper::rotation(c.qD);
  in.D.w = oracle::paper::G(c.qD) * c.qDd, in.D.a = oracle::paper::G(c.qD) * c.qDdd;
  return in;
}

/// The same place in the oracle's words: laws as quaternions with two derivatives, (1.8), (1.9).
inline oracle::Configuration configuration(const Place& in) {
  oracle::Configuration c{};
  c.x1 = in.O1.x, c.v1 = in.O1.v, c.q1 = in.O1.e.coefficients(), c.w1 = in.O1.w;
  c.x2 = in.O2.x, c.v2 = in.O2.v, c.q2 = in.O2.e.coefficients(), c.w2 = in.O2.w;
  c.a1 = c.a2 = c.al1 = c.al2 = Vec3::Zero();
  oracle::set_rates(c.q1, c.w1, c.al1, c.qd1, c.qdd1);
  oracle::set_rates(c.q2, c.w2, c.al2, c.qd2, c.qdd2);
  c.uP = in.P.u, c.uPd = in.P.ud, c.uPdd = in.P.udd, c.qP = in.P.q.coefficients();
  c.uS = in.S.u, c.uSd = in.S.ud, c.uSdd = in.S.udd, c.qS = in.S.q.coefficients();
  c.pD = in.p.p, c.pDd = in.p.pd, c.pDdd = in.p.pdd, c.qD = in.D.q.coefficients();
  oracle::set_rates(c.qP, in.P.w, in.P.a, c.qPd, c.qPdd);
  oracle::set_rates(c.qS, in.S.w, in.S.a, c.qSd, c.qSdd);
  oracle::set_rates(c.qD, in.D.w, in.D.a, c.qDd, c.qDdd);
  return c;
}

/// (1.6), (1.8), (1.9): qd = (1/4) G' w, qdd = (1/4) G' al - (1/4)|w|^2 q turn the paper's fourteen columns into
/// twelve.
inline Rows products(const oracle::Configuration& c) {
  const oracle::PaperLock paper = oracle::paper_lock(c);
  Rows out;
  oracle::Matrix6x14 Cq;
  Cq << paper.Cq.topRows<3>(), paper.Cq.bottomRows<3>();
  const auto rows = [](const auto& seven) {
    Eigen::Matrix<double, 6, 1> six;
    six << seven.template head<3>(), seven.template tail<3>();
    return six;
  };
  out.C = rows(paper.C), out.Ct = rows(paper.Ct), out.Qhat = rows(paper.Qc);
  for (int body = 0; body < 2; ++body) {
    const Vec4& q = body == 0 ? c.q1 : c.q2;
    const Vec3& w = body == 0 ? c.w1 : c.w2;
    const auto on_q = Cq.block<6, 4>(0, 7 * body + 3);
    out.J.block<6, 3>(0, 6 * body) = Cq.block<6, 3>(0, 7 * body);
    out.J.block<6, 3>(0, 6 * body + 3) = 0.25 * on_q * oracle::paper::G(q).transpose();
    out.Qhat += 0.25 * w.squaredNorm() * (on_q * q);
  }
  return out;
}

/// The constraint on jets of twelve variables: g is a row, h is -Qhat, d - J v is Ct. T: double, or a number that
/// counts.
template <class T>
oracle::Seven<Jet<12, T>> on_jets(const oracle::Configuration& c) {
  using J12 = Jet<12, T>;
  const auto number = [](double x, double d, double dd) { return J12(T(x), T(d), T(dd)); };
  const auto vector = [&](const Vec3& x, const Vec3& d, const Vec3& dd) {
    return oracle::Vec3<J12>{number(x[0], d[0], dd[0]), number(x[1], d[1], dd[1]), number(x[2], d[2], dd[2])};
  };
  const auto quaternion = [&](const Vec4& q, const Vec4& d, const Vec4& dd) {
    return oracle::Quat<J12>{number(q[0], d[0], dd[0]), number(q[1], d[1], dd[1]), number(q[2], d[2], dd[2]),
                             number(q[3], d[3], dd[3])};
  };
  const auto shifted = [&](const Vec3& x, const Vec3& v, int first) {
    oracle::Vec3<J12> r = vector(x, v, Vec3::Zero());
    r.x.g[first] = r.y.g[first + 1] = r.z.g[first + 2] = T(1);
    return r;
  };
  const auto turned = [&](const Vec4& q, const Vec3& w, int first) {  // q moves by (1/2) q th, th = 0
    Vec4 qd, qdd;
    oracle::set_rates(q, w, Vec3::Zero(), qd, qdd);
    oracle::Quat<J12> r = quaternion(q, qd, qdd);
    const Eigen::Matrix<double, 3, 4> G = 0.25 * oracle::paper::G(q);
    for (int k = 0; k < 3; ++k)
      r.w.g[first + k] = T(G(k, 0)), r.x.g[first + k] = T(G(k, 1)), r.y.g[first + k] = T(G(k, 2)),
                    r.z.g[first + k] = T(G(k, 3));
    return r;
  };
  const oracle::Bodies<J12> bodies{shifted(c.x1, c.v1, 0), turned(c.q1, c.w1, 3), shifted(c.x2, c.v2, 6),
                                   turned(c.q2, c.w2, 9)};
  const oracle::Laws<J12> laws{vector(c.uP, c.uPd, c.uPdd), quaternion(c.qP, c.qPd, c.qPdd),
                               vector(c.uS, c.uSd, c.uSdd), quaternion(c.qS, c.qSd, c.qSdd),
                               vector(c.pD, c.pDd, c.pDdd), quaternion(c.qD, c.qDd, c.qDdd)};
  return oracle::constraint(bodies, laws);
}

/// One evaluation gives everything.
inline Rows jets(const oracle::Configuration& c) {
  const oracle::Seven<Jet<12>> seven = on_jets<double>(c);
  oracle::Vector12 v;
  v << c.v1, c.w1, c.v2, c.w2;
  Rows out;
  for (int k = 0; k < 6; ++k) {
    const Jet<12>& row = seven[k < 3 ? k : k + 1];
    out.C[k] = row.v, out.J.row(k) = row.g, out.Qhat[k] = -row.h, out.Ct[k] = row.d - row.g.dot(v);
  }
  return out;
}

/// The constraint at the place moved by `turn` and `shift` of each body, its laws at the time `t` from now (their
/// series).
inline Eigen::Matrix<double, 6, 1> bare(const oracle::Configuration& c, const oracle::Vector12& d, double t) {
  const auto vec = [](const Vec3& x) { return oracle::Vec3<double>{x[0], x[1], x[2]}; };
  const auto quat = [](const Vec4& q) { return oracle::Quat<double>{q[0], q[1], q[2], q[3]}; };
  const auto turned = [&](const Vec4& q, const Vec3& th) {
    return quat((Quat::from(q) * exponential(th)).coefficients());
  };
  const double h = 0.5 * t * t;
  const oracle::Bodies<double> b{vec(c.x1 + d.segment<3>(0)), turned(c.q1, d.segment<3>(3)),
                                 vec(c.x2 + d.segment<3>(6)), turned(c.q2, d.segment<3>(9))};
  const oracle::Laws<double> l{vec(c.uP + t * c.uPd + h * c.uPdd), quat(c.qP + t * c.qPd + h * c.qPdd),
                               vec(c.uS + t * c.uSd + h * c.uSdd), quat(c.qS + t * c.qSd + h * c.qSdd),
                               vec(c.pD + t * c.pDd + h * c.pDdd), quat(c.qD + t * c.qDd + h * c.qDdd)};
  const oracle::Seven<double> s = oracle::constraint(b, l);
  Eigen::Matrix<double, 6, 1> six;
  six << s[0], s[1], s[2], s[4], s[5], s[6];
  return six;
}

/// Central differences: 24 evaluations for the rows, 2 for Ct, 3 for the right side.
inline Rows differences(const oracle::Configuration& c, const Steps& steps) {
  Rows out;
  const oracle::Vector12 still = oracle::Vector12::Zero();
  out.C = bare(c, still, 0);
  for (int k = 0; k < 12; ++k) {
    const oracle::Vector12 d = steps.first * oracle::Vector12::Unit(k);
    out.J.col(k) = (bare(c, d, 0) - bare(c, -d, 0)) / (2 * steps.first);
  }
  out.Ct = (bare(c, still, steps.first) - bare(c, still, -steps.first)) / (2 * steps.first);
  oracle::Vector12 v;
  v << c.v1, c.w1, c.v2, c.w2;
  const double h = steps.second;
  out.Qhat = -(bare(c, h * v, h) - 2 * out.C + bare(c, -h * v, -h)) / (h * h);
  return out;
}

inline Rows rows(Way way, const Place& in, const Steps& steps = {}) {
  switch (way) {
    case Way::compact:
      return compact(in);
    case Way::products:
      return products(configuration(in));
    case Way::jets:
      return jets(configuration(in));
    default:
      return differences(configuration(in), steps);
  }
}

/// Multiplications and additions for C, Ct, six rows and Qhat with all laws, 0: not counted (Eigen's own matrices). The
/// paper's expressions: theory, (5.2).
inline long operations(Way way, const oracle::Configuration& c) {
  using oracle::Counted;
  const auto vec = [](const Vec3& x) { return Vec3T<Counted>(x.cast<Counted>()); };
  if (way == Way::products) return 4080;
  if (way == Way::jets) return oracle::operations_of([&] { on_jets<Counted>(c); }).total();
  if (way == Way::differences)  // 28 evaluations of the bare constraint; the moved poses not counted
    return 28 * oracle::operations_of([&] {
                  const auto v = [](const Vec3& x) { return oracle::Vec3<Counted>{x[0], x[1], x[2]}; };
                  const auto q = [](const Vec4& x) { return oracle::Quat<Counted>{x[0], x[1], x[2], x[3]}; };
                  const oracle::Bodies<Counted> b{v(c.x1), q(c.q1), v(c.x2), q(c.q2)};
                  const oracle::Laws<Counted> l{v(c.uP), q(c.qP), v(c.uS), q(c.qS), v(c.pD), q(c.qD)};
                  oracle::constraint(b, l);
                }).total();
  const auto quat = [](const Quat& x) { return QuatT<Counted>{x.w, x.x, x.y, x.z}; };
  const auto body = [&](const Motion& m) {
    MotionT<Counted> r;
    r.x = vec(m.x), r.v = vec(m.v), r.w = vec(m.w), r.e = quat(m.e), r.A = m.A.cast<Counted>();
    return r;
  };
  const auto marker = [&](const MarkerMotion& m) {
    MarkerMotionT<Counted> r;
    r.u = vec(m.u), r.ud = vec(m.ud), r.udd = vec(m.udd), r.q = quat(m.q), r.A = m.A.cast<Counted>(), r.w = vec(m.w),
    r.a = vec(m.a);
    return r;
  };
  const Place in = place(c);
  const MotionT<Counted> O1 = body(in.O1), O2 = body(in.O2);
  const MarkerMotionT<Counted> P = marker(in.P), S = marker(in.S);
  const ImposedTranslationT<Counted> p{vec(in.p.p), vec(in.p.pd), vec(in.p.pdd)};
  const ImposedRotationT<Counted> D{quat(in.D.q), in.D.A.cast<Counted>(), vec(in.D.w), vec(in.D.a)};
  TranslationRowsT<Counted> t;
  RotationRowsT<Counted> r;
  return oracle::operations_of([&] {
           translation<with::all_laws>(O1, O2, P, S, p, Mask::all, t);
           rotation<with::all_laws>(O1, O2, P, S, D, Mask::all, r);
         })
      .total();
}

/// A joint of two markers that are still on their bodies, its rows derived in one of the ways.
class DerivedLock final : public Lock {
 public:
  DerivedLock(std::string name, Marker& p, Marker& s, Mask mask, Way way, Steps steps = {})
      : Lock(std::move(name)), p_(&p), s_(&s), mask_(mask), way_(way), steps_(steps) {}
  std::string_view type() const override { return "derived"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  RowPlan plan_rows() override {
    P_ = MarkerFrame(*p_), S_ = MarkerFrame(*s_);
    RowPlan plan;
    plan.slots.add(P_.slot), plan.slots.add(S_.slot);
    side1_ = plan.slots.position(P_.slot), side2_ = plan.slots.position(S_.slot);
    for (int k = 0; k < count_rows(mask_); ++k) {
      const int row = lock_row(k);
      plan.add({row < 3 ? RowKind::translation : RowKind::rotation, std::string(lockstep::row_name(row))});
    }
    const int grounded = (side1_ < 0 ? 1 : 0) | (side2_ < 0 ? 2 : 0);
    plan.pattern = {static_cast<unsigned>(way_), mask_, mask_, static_cast<unsigned char>(grounded)};
    return plan;
  }

  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i) static_cast<const DerivedLock&>(*links[i]).fill(in, out.lane(i));
  }

 private:
  int lock_row(int k) const {
    for (int row = 0, n = 0; row < 6; ++row)
      if (includes(mask_, row_bit(row)) && n++ == k) return row;
    return 0;
  }
  void fill(const Inputs& in, const RowBlock& block) const {
    const Place place{in.slot(P_.slot), in.slot(S_.slot), P_.at(in.t), S_.at(in.t), {}, {}};
    const Rows r = rows(way_, place, steps_);
    for (int k = 0; k < row_count(); ++k) {
      const int j = lock_row(k);
      block.C(k) = r.C[j], block.Ct(k) = r.Ct[j], block.Qhat(k) = r.Qhat[j];
      block.set(side1_, k, r.J.block<1, 3>(j, 0), r.J.block<1, 3>(j, 3));
      block.set(side2_, k, r.J.block<1, 3>(j, 6), r.J.block<1, 3>(j, 9));
    }
  }

  Marker* p_;
  Marker* s_;
  Mask mask_;
  Way way_;
  Steps steps_;
  MarkerFrame P_, S_;
  int side1_ = -1, side2_ = -1;
};

}  // namespace lockstep::derivations
