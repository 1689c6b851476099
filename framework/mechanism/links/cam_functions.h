// SPDX-License-Identifier: BSD-3-Clause
// Functions of followers on a disc cam, and its profile.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include <lockstep/author/phi.h>

namespace lockstep {

/// The profile of a disc cam: the closed curve c(u) = r(u) (cos u, sin u) in the xy plane of S, of a law r given from 0
/// to 2 pi.
class LOCKSTEP_API CamProfile {
 public:
  using Vec2 = Eigen::Vector2d;  ///< x and y
  /// A point of the profile with its derivatives.
  struct Point {
    Vec2 c,            ///< the point, m
        c1,            ///< dc/du, m
        c2;            ///< d2c/du2, m
    double curvature;  ///< above zero where the cam is convex, 1/m
    Vec2 t,            ///< unit tangent, towards growing u
        n;             ///< unit normal, outward
  };
  CamProfile() = default;
  /// `radius`: r(u), m, over u in rad.
  explicit CamProfile(LawPtr<MotionLaw> radius) : radius_(std::move(radius)) {}
  /// The point at u, rad; u may be outside of 0 to 2 pi.
  Point at(double u) const;
  const LawPtr<MotionLaw>& radius() const { return radius_; }  ///< the law r
  /// The u, near the given one, where the normal passes through p (m); NaN: there is none.
  double foot(const Vec2& p, double u) const;
  /// The u, near the given one, where the normal has the angle alpha in the plane, rad; NaN: there is none.
  double facing(double alpha, double u) const;
  /// Throws ModelError, naming `link`: a radius that is not above zero, a curve that does not close, a hollow that is
  /// tighter than the radius `roller`, m (infinite: a flat face, which takes no hollow at all).
  void check(const std::string& link, double roller) const;

 private:
  LawPtr<MotionLaw> radius_;
};

/// phi = d - roller, m, with the distance d of P from the profile; gradient n, second derivative k/(1 + k d) t t^T,
/// k being the curvature.
struct LOCKSTEP_API RollerOnCam final : PhiHooks {
  CamProfile profile;  ///< of the cam
  double roller;       ///< radius of the roller, m; 0: a knife edge
  RollerOnCam(CamProfile of, double radius) : profile(std::move(of)), roller(radius) {}  ///< of these
  static constexpr PhiSpec spec{.reads = Reads::translation,
                                .stays_in_plane = true,
                                .kind = RowKind::translation,
                                .memory = 1,
                                .names = {"contact"}};

  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const CamProfile::Vec2 p(y.x.v, y.y.v);
    const CamProfile::Point at = profile.at(foot(p, y.memory[0]));
    const double d = at.n.dot(p - at.c), k = at.curvature / (1 + at.curvature * d);
    return function_of(y.x, y.y, d - roller, at.n[0], at.n[1], k * at.t[0] * at.t[0], k * at.t[0] * at.t[1],
                       k * at.t[1] * at.t[1]);
  }
  /// The u whose normal passes through p, near the polar angle of p plus `ahead`, rad; NaN: there is none.
  double foot(const CamProfile::Vec2& p, double ahead) const { return profile.foot(p, std::atan2(p[1], p[0]) + ahead); }
  void initialise(const std::string& link, PhiCoords) override { profile.check(link, roller); }
  void reset(std::span<double> z, PhiCoords y) const override;        ///< from the point of the profile nearest to P
  void accept_step(std::span<double> z, PhiCoords y) const override;  ///< from the foot near the last one
};

/// phi = n . rho - h(alpha), m: the face passes through P, its normal n is y of P, alpha is the angle of n in S, and h
/// the support function of the cam, h' = c . n', h'' = 1/curvature - h.
struct LOCKSTEP_API FaceOnCam final : PhiHooks {
  CamProfile profile;                                            ///< of the cam, convex
  explicit FaceOnCam(CamProfile of) : profile(std::move(of)) {}  ///< of this profile
  static constexpr PhiSpec spec{
      .stays_in_plane = true, .kind = RowKind::translation, .memory = 1, .names = {"contact"}};

  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T alpha = angle_of_normal(y), nx = cos(alpha), ny = sin(alpha);
    const CamProfile::Point at = profile.at(profile.facing(alpha.v, alpha.v + y.memory[0]));
    const double h = at.c.dot(CamProfile::Vec2(nx.v, ny.v)), h1 = at.c.dot(CamProfile::Vec2(-ny.v, nx.v));
    return nx * y.x + ny * y.y - jet_detail::chain(alpha, h, h1, 1 / at.curvature - h);
  }
  /// alpha, rad: the polar angle of y of P in S axes, (2 (e1 e2 - e0 e3), e0^2 - e1^2 + e2^2 - e3^2).
  template <class T>
  static T angle_of_normal(const LockCoords<T>& y) {
    using std::atan2;
    return atan2(y.e0 * y.e0 - y.e1 * y.e1 + y.e2 * y.e2 - y.e3 * y.e3, 2.0 * (y.e1 * y.e2 - y.e0 * y.e3));
  }
  void initialise(const std::string& link, PhiCoords) override {
    profile.check(link, std::numeric_limits<double>::infinity());
  }
  void reset(std::span<double> z, PhiCoords y) const override;  ///< from the point of the profile foremost along n
  void accept_step(std::span<double> z, PhiCoords y) const override;  ///< from the contact near the last one
};

}  // namespace lockstep
