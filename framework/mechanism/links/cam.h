// Links 'cam_roller' and 'cam_flat': a disc cam about z of S, its profile a law r(psi), and what rides on it.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// The closed curve c(u) = r(u) (cos u, sin u) of a law r, one turn of which, 0 to 2 pi, is the profile.
class LOCKSTEP_API CamProfile {
 public:
  using Vec2 = Eigen::Vector2d;
  struct Point {
    Vec2 c, c1, c2;    ///< c and its derivatives by u
    double curvature;  ///< above zero where the cam is convex, 1/m
    Vec2 t, n;         ///< tangent (growing u), outward normal
  };
  CamProfile() = default;
  explicit CamProfile(LawPtr<MotionLaw> radius) : radius_(std::move(radius)) {}
  Point at(double u) const;
  const LawPtr<MotionLaw>& radius() const { return radius_; }
  /// The u near `u` where the normal passes through p; or where the normal has the angle alpha. NaN: there is none.
  double foot(const Vec2& p, double u) const;
  double facing(double alpha, double u) const;
  /// Throws ModelError, naming `link`: a radius that is not above zero, a curve that does not close, or a hollow that
  /// is tighter than `roller` (infinite: a flat face, which takes no hollow at all).
  void check(const std::string& link, double roller) const;

 private:
  LawPtr<MotionLaw> radius_;
};

/// phi = distance of P from the profile - roller radius, m; gradient n, second derivative k/(1 + k d) t t^T.
struct LOCKSTEP_API RollerOnCam {
  CamProfile profile;
  double roller;  ///< its radius, m; 0: a knife edge
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr int kMemory = 1;  // foot's u - angle of P
  static constexpr std::array<const char*, 1> kNames = {"contact"};

  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const CamProfile::Vec2 p(y.x.v, y.y.v);
    const CamProfile::Point at = profile.at(foot(p, y.memory[0]));
    const double d = at.n.dot(p - at.c), k = at.curvature / (1 + at.curvature * d);
    return function_of(y.x, y.y, d - roller, at.n[0], at.n[1], k * at.t[0] * at.t[0], k * at.t[0] * at.t[1],
                       k * at.t[1] * at.t[1]);
  }
  double foot(const CamProfile::Vec2& p, double ahead) const { return profile.foot(p, std::atan2(p[1], p[0]) + ahead); }
  void initialise(const std::string& link, const LockCoords<Time>&) const { profile.check(link, roller); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const;
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;
};

/// phi = n . rho - h(alpha), m: the face goes through P, its normal n is y of P, alpha the normal's angle in S, h the
/// cam's support function: h' = c . n', h'' = 1/curvature - h.
struct LOCKSTEP_API FaceOnCam {
  CamProfile profile;
  static constexpr Reads kReads = Reads::both;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr int kMemory = 1;  // u of the contact - alpha
  static constexpr std::array<const char*, 1> kNames = {"contact"};

  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T alpha = angle_of_normal(y), nx = cos(alpha), ny = sin(alpha);
    const CamProfile::Point at = profile.at(profile.facing(alpha.v, alpha.v + y.memory[0]));
    const double h = at.c.dot(CamProfile::Vec2(nx.v, ny.v)), h1 = at.c.dot(CamProfile::Vec2(-ny.v, nx.v));
    return nx * y.x + ny * y.y - jet_detail::chain(alpha, h, h1, 1 / at.curvature - h);
  }
  /// y of P in S axes, (2 (e1 e2 - e0 e3), e0^2 - e1^2 + e2^2 - e3^2).
  template <class T>
  static T angle_of_normal(const LockCoords<T>& y) {
    using std::atan2;
    return atan2(y.e0 * y.e0 - y.e1 * y.e1 + y.e2 * y.e2 - y.e3 * y.e3, 2.0 * (y.e1 * y.e2 - y.e0 * y.e3));
  }
  void initialise(const std::string& link, const LockCoords<Time>&) const {
    profile.check(link, std::numeric_limits<double>::infinity());
  }
  void reset(std::span<double> z, const LockCoords<Time>& y) const;
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;
};

/// The centre P of a roller rides on the cam. Free: everything but the distance of P from the profile, in the plane of
/// the cam. It holds both ways: a groove; set_unilateral() makes it a cam that the roller may leave.
class LOCKSTEP_API CamRoller final : public PhiLock<RollerOnCam> {
 public:
  /// `radius`: r(psi), m, one turn of it; `roller` m, zero for a knife edge. Throws ModelError.
  CamRoller(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius, double roller);
  std::string_view type() const override { return "cam_roller"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// A flat face through P, normal to y of P, which points away from the cam, rides on it; the axes z of both are
/// parallel. Free: everything but the distance of the face from the cam.
class LOCKSTEP_API CamFlat final : public PhiLock<FaceOnCam> {
 public:
  /// `radius`: r(psi), m, one turn of a convex profile. Throws ModelError.
  CamFlat(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius);
  std::string_view type() const override { return "cam_flat"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
