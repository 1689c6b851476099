// SPDX-License-Identifier: BSD-3-Clause
// A joint of the tree by its numbers, for the texts that serve all numbers (dynamics/tree/joint_motion.h,
// moving_frame.h). Private to the room.
#pragma once

#include "framework/dynamics/tree/joint_motion.h"
#include "framework/dynamics/tree/moving_frame.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes {

/// The joint of a node; its numbers are loaded where they are asked for. kHinge: it is_hinge().
template <bool kHinge, class G>
struct LaneJoint {
  using A = typename G::Array;
  using L = typename G::L;
  using W = typename G::W;
  using M3 = typename G::M3;
  using Q4 = typename G::Q4;
  static constexpr bool kBalls = !G::kFlat;
  const LaneNode& n;
  const A joint, more, law;

  LOCKSTEP_LANE LaneJoint(const LaneNode& node, const TreeNumbers<G>& z)
      : n(node), joint(z.joint + n.joint), more(z.more + n.more), law(z.law + n.law) {}
  LOCKSTEP_LANE int n_slides() const { return kHinge ? 0 : n.n_slides; }
  LOCKSTEP_LANE TreeTurn turn() const { return kHinge ? TreeTurn::hinge : n.turn; }
  LOCKSTEP_LANE bool reversed() const { return n.reversed; }
  LOCKSTEP_LANE bool has_laws() const { return !kHinge && n.has_law; }
  LOCKSTEP_LANE L near_u() const { return G::linear(joint, joint::near); }
  LOCKSTEP_LANE L far_u() const { return G::linear(joint, joint::far); }
  LOCKSTEP_LANE W axis() const { return has_laws() ? G::axial(law, imposed::axis) : G::axial(joint, joint::axis); }
  LOCKSTEP_LANE Q4 K0() const { return G::quaternion(joint, joint::K0); }
  LOCKSTEP_LANE Q4 K1() const { return G::quaternion(joint, joint::K1); }
  LOCKSTEP_LANE Q4 near_q() const { return G::quaternion(more, more::near_q); }
  LOCKSTEP_LANE Q4 far_q() const { return G::quaternion(more, more::far_q); }
  LOCKSTEP_LANE W hinge() const { return G::axial(more, more::hinge); }
  LOCKSTEP_LANE L slide(int i) const { return G::linear(more, more::slide + 3 * static_cast<std::size_t>(i)); }
  LOCKSTEP_LANE int free_axis(int i) const { return n.slides[i]; }
  LOCKSTEP_LANE W ball(int i) const {
    if constexpr (kBalls)
      return column_of(load9(more, more::ball), i);
    else
      return W{};
  }
  LOCKSTEP_LANE L p() const { return G::linear(law, imposed::p); }
  LOCKSTEP_LANE L pd() const { return G::linear(law, imposed::pd); }
  LOCKSTEP_LANE L pdd() const { return G::linear(law, imposed::pdd); }
  LOCKSTEP_LANE W w() const { return G::axial(law, imposed::w); }
  LOCKSTEP_LANE W a() const { return G::axial(law, imposed::a); }
  LOCKSTEP_LANE Q4 q() const { return G::quaternion(law, imposed::q); }
  LOCKSTEP_LANE Q4 unit(const Q4& r) const { return (1.0 / bodies::square_root(norm2(r))) * r; }
};

/// From the parent to the slot, of a joint whose markers move on their bodies by laws. dy: changes of the coordinates.
template <bool kVaries, class G, class A = typename G::Array>
LOCKSTEP_LANE auto take_along(const LaneNode& n, const TreePlan& plan, const TreeNumbers<G>& z, std::size_t k,
                              const A& dy, MovingFrame<VectorIn<A>, MatrixIn<A>, QuaternionIn<A>, kVaries>& f) {
  const LaneJoint<false, G> j(n, z);
  const auto carrying = [&](std::size_t at) __attribute__((always_inline))->Carrying<VectorIn<A>, QuaternionIn<A>> {
    const A p = j.law + at;
    return {load3(p, marked::u), load3(p, marked::ud), load3(p, marked::udd),
            load4(p, marked::q), load3(p, marked::w),  load3(p, marked::a)};
  };
  const auto lock = carrying(marked::lock);
  const auto own = own_motion<kVaries>(j, lock, z.y + n.q, z.y + (plan.n_q + n.v), dy + n.q, dy + (plan.n_q + n.v),
                                       z.cosine[k], z.sine[k]);
  return lockstep::take_along(j, carrying(marked::near), carrying(marked::far), lock, own, f);
}

}  // namespace lockstep::lanes
