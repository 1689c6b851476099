// SPDX-License-Identifier: BSD-3-Clause
// JointTree: joint coordinates. Slots are nodes; one link carries each slot from its parent, and its free coordinates
// are unknowns. What a joint in the tree holds has no rows, except a single rotation and functions.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/state.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/planar_joints.h"

namespace lockstep {

/// How far turns against near.
enum class TreeTurn : unsigned char {
  none,   ///< not at all
  hinge,  ///< about one axis of both: an angle, rad, unwrapped
  ball    ///< freely: a unit quaternion
};

/// The markers near and far of a node.
struct MovingMarkers {
  MarkerFrame near, far;
};

/// The axes of a joint that slides or turns freely.
struct TreeAxes {
  std::array<Vec3, 3> slide{Vec3::Zero(), Vec3::Zero(),
                            Vec3::Zero()};  ///< directions of the translations, in the frame that carries S
  Mat3 ball = Mat3::Identity();  ///< of a ball: axes of P in the frame that carries it, with the sign of the turn
};

/// A node of the tree: a slot, and the joint that carries it. Along `near` (the marker on the parent) and `far` (the
/// marker on the slot), P and S in one order or the other: with r = q_S' q_2' q_1 q_P the turn of P seen from S and
/// rho the translations of P along the axes of S,
///
///     near is S:  e = e_p near r far',   x_far = x_near + A_S rho
///     near is P:  e = e_p near r' far',  x_far = x_near - A_S rho
///
/// Laws of the lock are part of both: r is q_D before the free rotation, rho is p next to the free translations.
///
/// What an evaluation reads of a hinge without laws comes first, three cache lines of the five.
struct alignas(64) TreeNode {
  int slot = 0;                    ///< whose motion this node is
  int parent = -1;                 ///< number of its parent's node; -1: the ground
  int first_q = 0,                 ///< where its coordinates begin: translations, then the angle or the quaternion
      first_v = 0;                 ///< where its velocities begin: translations, then the rate or w, in the axes of P
  unsigned char n_slides = 0;      ///< translations
  TreeTurn turn = TreeTurn::none;  ///< how far turns against near
  bool reversed = false;           ///< near is P
  unsigned left = 0;               ///< numbers of the lock's rows that it does not hold, a bit for each: they stay rows
  /// Laws of the lock, and where its states begin in State::s; null: none. The lock itself names errors only.
  std::shared_ptr<const ImposedMotion> imposed{};
  /// The markers, where laws move one of them on its body; else null.
  std::shared_ptr<const MovingMarkers> moving{};

  Vec3 near_u = Vec3::Zero(),  ///< origin of near in the parent, m
      far_u = Vec3::Zero();    ///< origin of far in the slot, m
  Quat K0, K1;                 ///< e = e_p (c K0 + s K1), c and s of half the angle; without an angle K0 alone
  Vec3 axis = Vec3::Zero();    ///< axis of a hinge, in the parent's axes, with the sign of the turn

  int link = -1;           ///< number of the link; -1: none, the slot is free
  Mask rows = Mask::none;  ///< that the joint holds
  int first_s = 0, n_s = 0;
  const Lock* lock = nullptr;
  std::shared_ptr<const TreeAxes> axes{};  ///< of translations and of a ball; null: there are none
  Vec3 hinge = Vec3::Zero();               ///< axis of a hinge, in the axes of P and of D
  Quat near_q, far_q;                      ///< axes of near and far

  const Vec3& slide(int k) const { return axes->slide[k]; }
  std::span<const double> own_states(const VecX& s) const {  ///< those of its laws
    if (n_s == 0) return {};
    return {s.data() + first_s, static_cast<std::size_t>(n_s)};
  }
  bool has_laws() const { return imposed || moving; }
  int n_v() const { return n_slides + (turn == TreeTurn::none ? 0 : turn == TreeTurn::hinge ? 1 : 3); }
  int n_q() const { return n_slides + (turn == TreeTurn::none ? 0 : turn == TreeTurn::hinge ? 1 : 4); }
};

/// Joint coordinates of a mechanism: of the links that carry each slot from another. Immutable.
class LOCKSTEP_API JointTree final : public Coordinates {
 public:
  /// The tree of a system that is set up, with these links in force; null if it has none, `why_not` then gives
  /// the reason.
  static std::shared_ptr<const JointTree> of(const System&, const std::vector<bool>& modes, std::string& why_not);

  std::string_view name() const override { return "joint"; }
  int n_q() const override { return n_q_; }
  int n_v() const override { return n_v_; }
  int n_slots() const override { return static_cast<int>(nodes_.size()); }
  std::span<const int> followed() const override { return followed_; }
  bool has_rows() const override { return has_rows_; }
  void motions(const State&, std::span<Motion> out) const override;
  Motion motion(const State&, int slot) const override;
  void kinematic_rate(const State&, VecX& qd) const override;
  void advance(State&, double h, const VecX& v) const override;
  void normalize(State&) const override;
  bool take_off_turns(State&) const override;
  void variations(const State&, std::span<const Motion> at, const StateRate& d, VecX& dx, VecX& dv) const override;

  /// Reads off the coordinates of a state in the slots' own; what violates the joints is lost. Angles lie within half
  /// a turn of those of `near`, or without one, within a turn of zero, as the quaternions' signs have it.
  void read_off(const State& slots, const State* near, State& out) const;

  const std::vector<TreeNode>& nodes() const { return nodes_; }  ///< parents before their children
  /// Number of the node of a slot; -1 for the ground.
  int node_of(int slot) const { return slot < 0 ? -1 : node_of_[slot]; }
  const std::vector<int>& closures() const { return closures_; }  ///< numbers of the active links outside of the tree
  /// Whether rows outside of the joints may depend on others: those of closures and functions, not a single rotation.
  bool may_be_redundant() const { return may_be_redundant_; }
  /// The same joints in a plane, where they keep all slots in one; else null.
  const PlanarJoints* planar() const { return planar_.get(); }

 private:
  void carry_all(const State&, std::span<Motion> out) const;
  const Lock& link_with_rows(const System&) const;
  template <class G>
  void grow(const System&, const G& graph);
  std::string refusal_of_memories(const System&) const;
  void add_node(const System&, int slot, int parent, int link);
  void match_sign(const System& system, TreeNode& node) const;
  // Numbers of the motions of a node, and of the node `node` (-1: the ground), where the ground's is the first.
  static std::size_t motion_of(const TreeNode& node) { return node.slot + 1; }
  std::size_t motion_of(int node) const { return node < 0 ? 0 : motion_of(nodes_[node]); }

  std::vector<TreeNode> nodes_;
  std::vector<int> node_of_;  // of each slot
  std::vector<int> closures_;
  std::shared_ptr<const PlanarJoints> planar_;
  int n_q_ = 0, n_v_ = 0;
  std::vector<int> followed_;  // slots
  bool has_rows_ = false, may_be_redundant_ = false;
};

/// Takes whole turns off an angle of more than 1000, which is known to 1e-12 rad only: twice a whole number of them, which
/// leaves the sign of quaternions. Returns whether there were so many.
LOCKSTEP_API bool shed_turns(double& angle);

}  // namespace lockstep
