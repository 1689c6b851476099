// A joint of the tree by its numbers, for the texts that serve all numbers (dynamics/tree/joint_motion.h,
// moving_frame.h). Private to the room.
#pragma once

#include "framework/dynamics/tree/joint_motion.h"
#include "framework/dynamics/tree/moving_frame.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes {

/// The joint of a node; its numbers are loaded where they are asked for. kHinge: it is_hinge().
template <bool kHinge, class A>
struct LaneJoint {
  using V3 = VectorIn<A>;
  using M3 = MatrixIn<A>;
  using Q4 = QuaternionIn<A>;
  const LaneNode& n;
  const A joint, more, law;

  LOCKSTEP_LANE LaneJoint(const LaneNode& node, const TreeNumbers<A>& z)
      : n(node), joint(z.joint + n.joint), more(z.more + n.more), law(z.law + n.law) {}
  LOCKSTEP_LANE int n_slides() const { return kHinge ? 0 : n.n_slides; }
  LOCKSTEP_LANE TreeTurn turn() const { return kHinge ? TreeTurn::hinge : n.turn; }
  LOCKSTEP_LANE bool reversed() const { return n.reversed; }
  LOCKSTEP_LANE bool has_laws() const { return !kHinge && n.has_law; }
  LOCKSTEP_LANE V3 near_u() const { return load3(joint, joint::near); }
  LOCKSTEP_LANE V3 far_u() const { return load3(joint, joint::far); }
  LOCKSTEP_LANE V3 axis() const { return has_laws() ? load3(law, imposed::axis) : load3(joint, joint::axis); }
  LOCKSTEP_LANE Q4 K0() const { return load4(joint, joint::K0); }
  LOCKSTEP_LANE Q4 K1() const { return load4(joint, joint::K1); }
  LOCKSTEP_LANE Q4 near_q() const { return load4(more, more::near_q); }
  LOCKSTEP_LANE Q4 far_q() const { return load4(more, more::far_q); }
  LOCKSTEP_LANE V3 hinge() const { return load3(more, more::hinge); }
  LOCKSTEP_LANE V3 slide(int i) const { return load3(more, more::slide + 3 * static_cast<std::size_t>(i)); }
  LOCKSTEP_LANE int free_axis(int i) const { return n.slides[static_cast<std::size_t>(i)]; }
  LOCKSTEP_LANE V3 ball(int i) const { return column_of(load9(more, more::ball), i); }
  LOCKSTEP_LANE V3 p() const { return load3(law, imposed::p); }
  LOCKSTEP_LANE V3 pd() const { return load3(law, imposed::pd); }
  LOCKSTEP_LANE V3 pdd() const { return load3(law, imposed::pdd); }
  LOCKSTEP_LANE V3 w() const { return load3(law, imposed::w); }
  LOCKSTEP_LANE V3 a() const { return load3(law, imposed::a); }
  LOCKSTEP_LANE Q4 q() const { return load4(law, imposed::q); }
  LOCKSTEP_LANE Q4 unit(const Q4& r) const { return (1.0 / bodies::square_root(norm2(r))) * r; }
};

/// From the parent to the slot, of a joint whose markers move on their bodies by laws. dy: changes of the coordinates.
template <bool kVaries, class A>
LOCKSTEP_LANE auto take_along(const LaneNode& n, const TreePlan& plan, const TreeNumbers<A>& z, std::size_t k,
                              const A& dy, MovingFrame<VectorIn<A>, MatrixIn<A>, QuaternionIn<A>, kVaries>& f) {
  const LaneJoint<false, A> j(n, z);
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
