// A joint of the tree in lanes, for the texts that serve all numbers (dynamics/tree/joint_motion.h, moving_frame.h). Private
// to the room.
#pragma once

#include "framework/dynamics/tree/joint_motion.h"
#include "framework/dynamics/tree/joint_passes.h"
#include "framework/dynamics/tree/moving_frame.h"
#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes::LOCKSTEP_SET {

using Coordinate = bodies::Coordinate<Space>;
/// From the parent's point to that of a node, and its acceleration beyond the parent's if the coordinates' are zero.
struct Travel {
  V3 r;
  Space::Twist c;
};
static_assert(sizeof(Coordinate) == dof::size * sizeof(V) && sizeof(Travel) == travel::size * sizeof(V) &&
              sizeof(Space::Inertia) == articulated::size * sizeof(V));
LOCKSTEP_LANE Coordinate* coordinates(const TreeNumbers& z, std::size_t v) {
  return reinterpret_cast<Coordinate*>(z.dof) + v;
}
LOCKSTEP_LANE Travel& travel_of(const TreeNumbers& z, std::size_t k) { return reinterpret_cast<Travel*>(z.travel)[k]; }

/// The joint of a node; its numbers are loaded where they are asked for. kHinge: it is_hinge().
template <bool kHinge>
struct LaneJoint {
  using V3 = LOCKSTEP_SET::V3;
  using M3 = LOCKSTEP_SET::M3;
  using Q4 = LOCKSTEP_SET::Q4;
  const LaneNode& n;
  const double *joint, *more, *law;

  LOCKSTEP_LANE LaneJoint(const LaneNode& node, const TreeNumbers& z)
      : n(node), joint(pack(z.joint, n.joint)), more(pack(z.more, n.more)), law(pack(z.law, n.law)) {}
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
  LOCKSTEP_LANE Q4 unit(const Q4& r) const { return (1.0 / square_root(norm2(r))) * r; }
};

/// Packs that are read.
LOCKSTEP_LANE LaneArray reads(const double* p, std::size_t at) { return {const_cast<double*>(pack(p, at))}; }

/// From the parent to the slot, of a joint whose markers move on their bodies by laws. dy: changes of the coordinates.
template <bool kVaries>
LOCKSTEP_LANE JointAxes<V3> take_along(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k,
                                       const double* dy, MovingFrame<V3, M3, Q4, kVaries>& f) {
  const LaneJoint<false> j(n, z);
  const auto carrying = [&](std::size_t at) __attribute__((always_inline))->Carrying<V3, Q4> {
    const double* p = pack(j.law, at);
    return {load3(p, marked::u), load3(p, marked::ud), load3(p, marked::udd),
            load4(p, marked::q), load3(p, marked::w),  load3(p, marked::a)};
  };
  const Carrying<V3, Q4> lock = carrying(marked::lock);
  const auto own = own_motion<kVaries>(j, lock, reads(z.y, n.q), reads(z.y, plan.n_q + n.v), reads(dy, n.q),
                                       reads(dy, plan.n_q + n.v), load(z.cosine, k), load(z.sine, k));
  return lockstep::take_along(j, carrying(marked::near), carrying(marked::far), lock, own, f);
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
