// SPDX-License-Identifier: BSD-3-Clause
// Joints with rows written by hand in vectors, world axes: what PhiLock and PhiCoupling are held against, digit by digit
// and instruction by instruction. Markers stand still on their bodies.
#pragma once

#include <string>

#include <lockstep/author/lock.h>

namespace lockstep::hand {

/// Two markers in the world.
struct Ends {
  Vec3 rP, rS, xP, xS, wP, wS, vP, vS;  ///< arms, origins, angular velocities and velocities, world
  Ends(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
    const Motion &O1 = in.slot(P.slot), &O2 = in.slot(S.slot);
    rP = O1.A * P.u0, rS = O2.A * S.u0, xP = O1.x + rP, xS = O2.x + rS;
    wP = O1.A * O1.w, wS = O2.A * O2.w, vP = O1.v + cross(wP, rP), vS = O2.v + cross(wS, rS);
  }
};

/// One row more than the mask has, written by `Self::row(in, link, block, k)`.
template <class Self>
class HandLock : public MarkerLock {
 public:
  using MarkerLock::MarkerLock;
  std::string_view type() const override { return "by hand"; }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    if (overlaps(rows(), Mask::all)) MarkerLock::gather(links, in, out);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Self& link = static_cast<const Self&>(*links[i]);
      link.row(in, out.lane(i), link.row_count() - 1);
    }
  }

 protected:
  RowPlan plan_rows() override {
    RowPlan plan = MarkerLock::plan_rows();
    Self::kTurnsOnly ? plan.add_turning({RowKind::function, "by hand"}) : plan.add({RowKind::function, "by hand"});
    P = MarkerFrame(p()), S = MarkerFrame(s());
    one = plan.slots.position(P.slot), two = plan.slots.position(S.slot);
    return plan;
  }
  static constexpr bool kTurnsOnly = false;
  MarkerFrame P, S;
  int one = -1, two = -1;
};

/// |xP - xS| - length.
class Distance final : public HandLock<Distance> {
 public:
  double length = 0;
  using HandLock::HandLock;
  void row(const Inputs& in, const RowBlock& block, int k) const {
    const Ends e(P, S, in);
    const Vec3 d = e.xP - e.xS, dd = e.vP - e.vS;
    const double l = d.norm(), ld = d.dot(dd) / l;
    const Vec3 n = d / l;
    block.C(k) = l - length;
    block.Ct(k) = 0;
    block.Qhat(k) = -(n.dot(cross(e.wP, Vec3(cross(e.wP, e.rP))) - cross(e.wS, Vec3(cross(e.wS, e.rS)))) +
                      (dd.squaredNorm() - ld * ld) / l);
    block.set(one, k, n, Vec3(in.slot(P.slot).A.transpose() * cross(e.rP, n)));
    block.set(two, k, Vec3(-n), Vec3(-(in.slot(S.slot).A.transpose() * cross(e.rS, n))));
  }
};

/// x_S . y_P.
class Universal final : public HandLock<Universal> {
 public:
  using HandLock::HandLock;
  static constexpr bool kTurnsOnly = true;
  void row(const Inputs& in, const RowBlock& block, int k) const {
    const Motion &O1 = in.slot(P.slot), &O2 = in.slot(S.slot);
    const Vec3 a = O2.A * S.A0.col(0), b = O1.A * P.A0.col(1), w1 = O1.A * O1.w, w2 = O2.A * O2.w;
    const Vec3 ad = cross(w2, a), bd = cross(w1, b), ba = cross(b, a);
    block.C(k) = a.dot(b);
    block.Ct(k) = 0;
    block.Qhat(k) = -(cross(w2, ad).dot(b) + 2 * ad.dot(bd) + a.dot(cross(w1, bd)));
    block.set(one, k, Vec3(Vec3::Zero()), Vec3(O1.A.transpose() * ba));
    block.set(two, k, Vec3(Vec3::Zero()), Vec3(-(O2.A.transpose() * ba)));
  }
};

/// Turn of P about z of S: its gradient g on w_P - w_S (world) and the part of its second derivative without
/// accelerations.
struct Turn {
  double angle, bend;
  Vec3 g;
  Turn(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
    const Motion &O1 = in.slot(P.slot), &O2 = in.slot(S.slot);
    const Quat e = conjugate(O2.e * S.q0) * (O1.e * P.q0);
    angle = 2 * std::atan2(e.z, e.w);
    angle -= kTwoPi * std::round(angle / kTwoPi);
    const Vec3 zP = O1.A * P.A0.col(2), zS = O2.A * S.A0.col(2), w1 = O1.A * O1.w, w2 = O2.A * O2.w;
    const Vec3 zPd = cross(w1, zP), zSd = cross(w2, zS);
    const double c = 1 + zP.dot(zS), cd = zPd.dot(zS) + zP.dot(zSd);
    g = (zP + zS) / c;
    const Vec3 gd = (zPd + zSd) / c - cd / c * g;
    bend = gd.dot(w1 - w2);
  }
};

/// z - lead theta / 2 pi.
class Screw final : public HandLock<Screw> {
 public:
  double lead = 0;
  using HandLock::HandLock;
  void row(const Inputs& in, const RowBlock& block, int k) const {
    const Ends e(P, S, in);
    const Turn turn(P, S, in);
    const Motion &O1 = in.slot(P.slot), &O2 = in.slot(S.slot);
    const Vec3 n = O2.A * S.A0.col(2), d = e.xP - e.xS, dd = e.vP - e.vS, nd = cross(e.wS, n);
    const double c = lead / kTwoPi;
    block.C(k) = n.dot(d) - c * turn.angle;
    block.Ct(k) = 0;
    block.Qhat(k) = -(n.dot(cross(e.wP, Vec3(cross(e.wP, e.rP))) - cross(e.wS, Vec3(cross(e.wS, e.rS)))) +
                      2 * nd.dot(dd) + cross(e.wS, nd).dot(d)) +
                    c * turn.bend;
    block.set(one, k, n, Vec3(O1.A.transpose() * (cross(e.rP, n) - c * turn.g)));
    block.set(two, k, Vec3(-n), Vec3(O2.A.transpose() * (c * turn.g - cross(Vec3(e.rS + d), n))));
  }
};

/// theta1 + ratio theta2, each about its own z.
class Gear final : public Lock {
 public:
  double ratio = 1;
  Gear(std::string name, Marker& p1, Marker& s1, Marker& p2, Marker& s2)
      : Lock(std::move(name)), pairs_{{&p1, &s1}, {&p2, &s2}} {}
  std::string_view type() const override { return "by hand"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return pairs_; }
  RowPlan plan_rows() override {
    RowPlan plan;
    plan.add({RowKind::function, "by hand"});
    for (std::size_t k = 0; k < 2; ++k) {
      P_[k] = MarkerFrame(*pairs_[k].first), S_[k] = MarkerFrame(*pairs_[k].second);
      plan.slots.add(P_[k].slot), plan.slots.add(S_[k].slot);
    }
    return plan;
  }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i) static_cast<const Gear&>(*links[i]).row(in, out.lane(i));
  }

 private:
  void row(const Inputs& in, const RowBlock& block) const {
    const Turn one(P_[0], S_[0], in), two(P_[1], S_[1], in);
    block.C(0) = one.angle + ratio * two.angle;
    block.Ct(0) = 0;
    block.Qhat(0) = -(one.bend + ratio * two.bend);
    for (int i = 0; i < slots().n; ++i) {
      Vec3 g = Vec3::Zero();
      for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 its = k == 0 ? one.g : Vec3(ratio * two.g);
        if (P_[k].slot == slots()[i]) g += its;
        if (S_[k].slot == slots()[i]) g -= its;
      }
      block.set(i, 0, Vec3(Vec3::Zero()), Vec3(in.slot(slots()[i]).A.transpose() * g));
    }
  }
  std::vector<std::pair<const Marker*, const Marker*>> pairs_;
  std::array<MarkerFrame, 2> P_, S_;
};

}  // namespace lockstep::hand
