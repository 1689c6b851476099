// SPDX-License-Identifier: BSD-3-Clause
// PlanarJoints: the joints of a tree that moves in a plane under any load: hinges about its normal and translations
// in it, from the ground outward.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/detail/export.h>
#include <lockstep/state.h>

namespace lockstep {

struct TreeNode;

/// A vector in the plane, by its components along i and j.
template <class T>
struct FlatOf {
  T i{}, j{};
};
using Flat = FlatOf<double>;
template <class T>
LOCKSTEP_INLINE FlatOf<T> operator+(const FlatOf<T>& a, const FlatOf<T>& b) {
  return {a.i + b.i, a.j + b.j};
}
template <class T>
LOCKSTEP_INLINE FlatOf<T> operator-(const FlatOf<T>& a, const FlatOf<T>& b) {
  return {a.i - b.i, a.j - b.j};
}
template <class X, class T>
LOCKSTEP_INLINE FlatOf<T> operator*(const X& x, const FlatOf<T>& a) {
  return {x * a.i, x * a.j};
}
template <class T>
LOCKSTEP_INLINE FlatOf<T>& operator+=(FlatOf<T>& a, const FlatOf<T>& b) {
  return a = a + b;
}
template <class T>
LOCKSTEP_INLINE FlatOf<T>& operator-=(FlatOf<T>& a, const FlatOf<T>& b) {
  return a = a - b;
}
template <class T>
LOCKSTEP_INLINE T dot(const FlatOf<T>& a, const FlatOf<T>& b) {
  return a.i * b.i + a.j * b.j;
}
/// n x a
template <class T>
LOCKSTEP_INLINE FlatOf<T> across(const FlatOf<T>& a) {
  return {-a.j, a.i};
}
/// a turned about the normal by the angle with this cosine and sine
LOCKSTEP_INLINE Flat turned(double c, double s, const Flat& a) { return {c * a.i - s * a.j, s * a.i + c * a.j}; }

/// A node of the tree, in the plane. Vectors that belong to a slot are given in its frame, which turns about the normal
/// by the slot's angle and whose axes are the world's at the angle zero.
struct PlanarNode {
  int slot = 0, parent = -1, first_q = 0, first_v = 0;  ///< as those of the TreeNode
  int n_slides = 0;                                     ///< translations, at most 2
  bool turns = false,                                   ///< about the normal
      reversed = false;                                 ///< as that of the TreeNode
  int posture = -1,                                     ///< number of its Posture; -1: slot axes are the frame's
      law = -1;                                         ///< number of its PlanarLaw; -1: none
  double sign = 1,                                      ///< of the hinge's angle about the normal
      offset = 0,                                       ///< angle beyond the parent's where the coordinate is zero, rad
      height = 0;                                       ///< of the centre of mass above the parent's, on the normal, m
  Flat near, far;                                       ///< origins of the markers in the parent and in the slot, m
  std::array<Flat, 2> slide{};                          ///< directions of the translations, in the slot that carries S
};

/// The axes of a slot against its frame, where they differ by more than an angle about the normal.
struct Posture {
  Quat e;       ///< slot axes -> frame
  Mat3 A;       ///< A(e)
  Vec3 normal;  ///< in slot axes
};

/// How what laws impose (Imposed, in the axes of the slot that carries S) lies in the plane.
struct PlanarLaw {
  Vec3 i, j, normal,  ///< axes of the frame of the slot that carries S, in slot axes
      normal_S;       ///< the normal in the axes of S
};

/// The joints of a tree whose slots stay in a plane by its joints alone. Immutable; in the order of the tree's nodes.
class LOCKSTEP_API PlanarJoints {
 public:
  /// Null if a joint leaves this plane; without one, every plane normal to an axis of the world. Laws are asked
  /// (stays_in_plane, turns_about).
  static std::shared_ptr<const PlanarJoints> of(std::span<const TreeNode> tree, Plane plane = {});

  Plane plane() const { return plane_; }
  const std::vector<PlanarNode>& nodes() const { return nodes_; }
  /// Null if slot axes are the frame's.
  const Posture* posture(const PlanarNode& n) const { return n.posture < 0 ? nullptr : &postures_[n.posture]; }
  /// The normal in slot axes.
  Vec3 normal(const PlanarNode& n) const { return n.posture < 0 ? Vec3(Vec3::Unit(plane_.n)) : posture(n)->normal; }
  const PlanarLaw& law(const PlanarNode& n) const { return laws_[n.law]; }
  /// As Coordinates::motions; `tree`: the nodes that these were made of.
  void motions(std::span<const TreeNode> tree, const State&, std::span<Motion> out) const;

 private:
  // A slot where all coordinates are zero.
  struct Standing {
    Quat e;            // axes
    double angle = 0;  // of the frame, rad
    Posture posture;
  };
  Standing standing(const Quat& e) const;
  bool add(std::span<const TreeNode> tree, std::size_t k, std::vector<Standing>& all);
  template <int k>
  void motions_along(std::span<const TreeNode> tree, const State&, std::span<Motion> out) const;

  Plane plane_;
  std::vector<PlanarNode> nodes_;
  std::vector<Posture> postures_;
  std::vector<PlanarLaw> laws_;
};

}  // namespace lockstep
