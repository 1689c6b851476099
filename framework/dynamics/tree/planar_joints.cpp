// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/planar_joints.h"

#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/planar_motion.h"
#include "framework/foundation/math/sin_cos.h"
#include "framework/foundation/support/clones.h"

namespace lockstep {

namespace {

constexpr double kUpright = 1e-15;  // sines of angles: what is less is round-off of products of unit quaternions

Vec3 axis_of(const Mat3& A, int row) { return A.row(row); }

}  // namespace

PlanarJoints::Standing PlanarJoints::standing(const Quat& e) const {
  const Vec3 v = e.vec();
  if (std::abs(v[plane_.i()]) <= kUpright && std::abs(v[plane_.j()]) <= kUpright)  // the angle gives e its sign
    return {e, 2.0 * std::atan2(v[plane_.n], e.w), {Quat{}, Mat3::Identity(), Vec3::Unit(plane_.n)}};
  const Mat3 A = rotation(e);
  return {e, 0.0, {e, A, axis_of(A, plane_.n)}};
}

std::shared_ptr<const PlanarJoints> PlanarJoints::of(std::span<const TreeNode> tree, Plane plane) {
  for (int n = 2; n >= 0; --n) {
    if (plane && n != plane.n) continue;
    const auto joints = std::make_shared<PlanarJoints>();
    joints->plane_ = Plane{n};
    joints->nodes_.reserve(tree.size());
    std::vector<Standing> standing;
    bool all = true;
    for (std::size_t k = 0; k < tree.size() && all; ++k) all = joints->add(tree, k, standing);
    if (!all) continue;
    joints->postures_.shrink_to_fit();
    return joints;
  }
  return nullptr;
}

// A hinge is parallel to the normal, translations are at right angles to it, in any position: the slot that carries them
// turns about the normal alone, as its parents do.
bool PlanarJoints::add(std::span<const TreeNode> tree, std::size_t k, std::vector<Standing>& all) {
  const TreeNode& t = tree[k];
  if (t.turn == TreeTurn::ball || t.n_slides > 2 || t.moving) return false;
  const Standing p = t.parent < 0 ? standing(Quat{}) : all[t.parent];
  const Standing own = all.emplace_back(standing(normalized(p.e * t.K0)));

  PlanarNode& n = nodes_.emplace_back();
  n.slot = t.slot, n.parent = t.parent, n.first_q = t.first_q, n.first_v = t.first_v;
  n.n_slides = t.n_slides, n.reversed = t.reversed, n.turns = t.turn == TreeTurn::hinge;
  n.offset = own.angle - p.angle;
  const Mat3 &P = p.posture.A, &O = own.posture.A, &carrier = t.reversed ? O : P;
  const auto flat = [&](const Vec3& a) { return Flat{a[plane_.i()], a[plane_.j()]}; };
  const Vec3 near = P * t.near_u, far = O * t.far_u, normal = Vec3::Unit(plane_.n);
  n.near = flat(near), n.far = flat(far), n.height = near[plane_.n] - far[plane_.n];
  if (n.turns) {
    const Vec3 axis = P * t.axis;
    if (!are_parallel(axis, normal)) return false;
    n.sign = axis[plane_.n] > 0 ? 1.0 : -1.0;
  }
  for (int l = 0; l < t.n_slides; ++l) {
    const Vec3 slide = carrier * t.slide(l);
    if (!are_perpendicular(slide, normal)) return false;
    n.slide[l] = flat(slide);
  }
  if (t.imposed) {
    const Vec3 normal_S = rotation(t.reversed ? t.far_q : t.near_q).transpose() * axis_of(carrier, plane_.n);
    if (!t.imposed->stays_in_plane(normal_S)) return false;
    n.law = static_cast<int>(laws_.size());
    laws_.push_back({axis_of(carrier, plane_.i()), axis_of(carrier, plane_.j()), axis_of(carrier, plane_.n), normal_S});
  }
  if (own.posture.A != Mat3::Identity()) {
    n.posture = static_cast<int>(postures_.size());
    postures_.push_back(own.posture);
  }
  return true;
}

PlanarImposed planar_laws_at(const TreeNode& node, const PlanarLaw& law, double t, const VecX& s) {
  Imposed now;
  laws_at(node, t, s, now);
  const auto flat = [&](const Vec3& a) { return Flat{law.i.dot(a), law.j.dot(a)}; };
  PlanarImposed out;
  out.p = flat(now.p), out.pd = flat(now.pd), out.pdd = flat(now.pdd), out.height = law.normal.dot(now.p);
  out.angle = (node.reversed ? -2.0 : 2.0) * std::atan2(now.q.vec().dot(law.normal_S), now.q.w);
  out.w = law.normal.dot(now.w), out.alpha = law.normal.dot(now.a);
  return out;
}

template <int k>
LOCKSTEP_INLINE void PlanarJoints::motions_along(std::span<const TreeNode> tree, const State& y,
                                                 std::span<Motion> out) const {
  SinCosAhead half;
  for (std::size_t l = 0; l < nodes_.size(); ++l) {
    half.see(
        l, nodes_.size(), [&](std::size_t i) __attribute__((always_inline)) {
          return half_turn(nodes_[i], y.q.data() + nodes_[i].first_q);
        });
    const PlanarNode& n = nodes_[l];
    PlanarFrame p, own;
    if (n.parent >= 0) {
      const PlanarNode& parent = nodes_[n.parent];
      p = read_frame<k>(out[parent.slot + 1], posture(parent));
    }
    PlanarImposed now;
    if (n.law >= 0) now = planar_laws_at(tree[l], law(n), y.t, y.s);
    carry(n, n.law < 0 ? nullptr : &now, half.cosine(), half.sine(), y.q.data() + n.first_q, y.v.data() + n.first_v, p,
          own);
    write_motion<k>(own, posture(n), out[n.slot + 1]);
  }
}

LOCKSTEP_FLAT_CLONES void PlanarJoints::motions(std::span<const TreeNode> tree, const State& y,
                                                std::span<Motion> out) const {
  if (plane_.n == 0) return motions_along<0>(tree, y, out);
  if (plane_.n == 1) return motions_along<1>(tree, y, out);
  motions_along<2>(tree, y, out);
}

}  // namespace lockstep
