// SPDX-License-Identifier: BSD-3-Clause
// Gears, belts, racks, cams and curves.
#pragma once

#include <memory>
#include <string>

#include <lockstep/author/params.h>
#include <lockstep/author/phi_links.h>

namespace lockstep {

// Links 'cam_roller' and 'cam_flat': a disc cam about z of S, its profile a law r(psi), and a follower on it.

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
struct LOCKSTEP_API RollerOnCam {
  CamProfile profile;                                                ///< of the cam
  double roller;                                                     ///< radius of the roller, m; 0: a knife edge
  static constexpr Reads kReads = Reads::translation;                ///< x and y
  static constexpr bool kStaysInPlane = true;                        ///< planar mechanisms stay in their plane
  static constexpr RowKind kKind = RowKind::translation;             ///< a length
  static constexpr int kMemory = 1;                                  ///< u of the foot less the polar angle of P, rad
  static constexpr std::array<const char*, 1> kNames = {"contact"};  ///< name of the row

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
  /// Checks the profile.
  void initialise(const std::string& link, const LockCoords<Time>&) const { profile.check(link, roller); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the point of the profile nearest to P
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the foot near the last one
};

/// phi = n . rho - h(alpha), m: the face passes through P, its normal n is y of P, alpha is the angle of n in S, and h
/// the support function of the cam, h' = c . n', h'' = 1/curvature - h.
struct LOCKSTEP_API FaceOnCam {
  CamProfile profile;                                                ///< of the cam, convex
  static constexpr Reads kReads = Reads::both;                       ///< x, y and the relative quaternion
  static constexpr bool kStaysInPlane = true;                        ///< planar mechanisms stay in their plane
  static constexpr RowKind kKind = RowKind::translation;             ///< a length
  static constexpr int kMemory = 1;                                  ///< u of the contact less alpha, rad
  static constexpr std::array<const char*, 1> kNames = {"contact"};  ///< name of the row

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
  /// Checks the profile.
  void initialise(const std::string& link, const LockCoords<Time>&) const {
    profile.check(link, std::numeric_limits<double>::infinity());
  }
  void reset(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the point of the profile foremost along n
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the contact near the last one
};

extern template class LOCKSTEP_API PhiLock<RollerOnCam>;

/// A roller with the centre P on a disc cam about z of S. Free: everything but the distance of P from the profile,
/// measured in the xy plane of S. It holds both ways, as in a groove; after set_unilateral() the roller may leave the
/// cam.
class LOCKSTEP_API CamRoller final : public PhiLock<RollerOnCam> {
 public:
  /// `radius`: r(psi), m, used from 0 to 2 pi; `roller`: its radius, m, zero for a knife edge. Throws ModelError: no
  /// law, a roller that is negative or infinite; and at setup as CamProfile::check.
  CamRoller(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius, double roller);
  std::string_view type() const override { return "cam_roller"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

extern template class LOCKSTEP_API PhiLock<FaceOnCam>;

/// A flat face on a convex disc cam about z of S. The face passes through P, normal to y of P, which points away from
/// the cam. Free: everything but the distance of the face from the cam; other joints keep z of P parallel to z of S.
class LOCKSTEP_API CamFlat final : public PhiLock<FaceOnCam> {
 public:
  /// `radius`: r(psi), m, used from 0 to 2 pi. Throws ModelError: no law; and at setup as CamProfile::check.
  CamFlat(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius);
  std::string_view type() const override { return "cam_flat"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Links 'point_on_curve' and 'path_follower': P stays on a space curve c(s), fixed to S.

/// A curve c(s) in S axes, seen during a step from a fixed frame: the tangent t and two normals n1, n2 at the last
/// accepted s. The s of a position rho is that where t . c(s) = t . rho. Its first and second derivatives follow from
/// c, c_s and c_ss alone:
///
///   s_rho = t / (t . c_s)          s_rho,rho = - (t . c_ss) / (t . c_s)^3  t t^T
///   phi_i = n_i . (rho - c(s))
///
/// (7.6) takes s as an additional massless unknown; this needs none, and is exact on and off the path. The normals are
/// carried along the curve from step to step; the force and the moment on a body do not depend on them.
class LOCKSTEP_API CurvePoint {
 public:
  CurvePoint() = default;
  /// `path`: c(s), S axes, m; `near`: an s near which P begins.
  CurvePoint(LawPtr<TranslationLaw> path, double near) : path_(std::move(path)), near_(near) {}
  const LawPtr<TranslationLaw>& path() const { return path_; }  ///< the curve

  /// Three unit vectors, normal to each other, in S axes.
  struct Frame {
    Vec3 t,  ///< tangent
        n1,  ///< first normal
        n2;  ///< second normal
  };
  /// The frame of the present step, from the memory.
  Frame frame(const double* memory) const;
  /// The s where t . c(s) = t . rho, by Newton's method from `s`; NaN: it finds none.
  double in_plane(const Vec3& t, const Vec3& rho, double s) const;
  /// The s of the point of the curve nearest to rho, searched from `s`; NaN: it finds none.
  double nearest(const Vec3& rho, double s) const;

  /// s of the position y, with its derivatives; puts the curve there into `at`.
  template <class T>
  T parameter(const LockCoords<T>& y, const Frame& f, TranslationValue& at) const {
    const T tau = f.t[0] * y.x + f.t[1] * y.y + f.t[2] * y.z;
    const double s = in_plane(f.t, Vec3(y.x.v, y.y.v, y.z.v), expected(y));
    at = path_->at(s);
    const double c1 = f.t.dot(at.v);
    return jet_detail::chain(tau, s, 1 / c1, -f.t.dot(at.a) / (c1 * c1 * c1));
  }
  /// phi_i of the normal n, m, with its derivatives.
  template <class T>
  T offset(const LockCoords<T>& y, const Vec3& n, const T& s, const TranslationValue& at) const {
    return n[0] * y.x + n[1] * y.y + n[2] * y.z - jet_detail::chain(s, n.dot(at.x), n.dot(at.v), n.dot(at.a));
  }

  // -- memory
  static constexpr int kMemory = 6;  ///< s, its rate, the instant; n1
  /// Throws ModelError, naming `link`: a search from `near` finds no point of the curve nearest to P.
  void initialise(const std::string& link, const LockCoords<Time>& y) const;
  void reset(std::span<double> z, const LockCoords<Time>& y) const;        ///< from the nearest point at the start
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the nearest point now

 private:
  Vec3 normal(double s, const Vec3& like) const;
  template <class T>
  static double expected(const LockCoords<T>& y) {
    return y.memory[0] + y.memory[1] * (y.t.v - y.memory[2]);
  }
  LawPtr<TranslationLaw> path_;
  double near_ = 0;
};

/// phi_1, phi_2: distances of P from the curve along its two normals, m.
struct OnCurve {
  CurvePoint curve;                                                             ///< the curve
  static constexpr int kRows = 2;                                               ///< one along each normal
  static constexpr Reads kReads = Reads::translation;                           ///< x y z
  static constexpr RowKind kKind = RowKind::translation;                        ///< lengths
  static constexpr int kMemory = CurvePoint::kMemory;                           ///< that of the curve
  static constexpr std::array<const char*, 2> kNames = {"normal1", "normal2"};  ///< names of the rows

  /// phi_1, phi_2.
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at)};
  }
  /// That of the curve.
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  /// That of the curve.
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  /// That of the curve.
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

/// phi_1, phi_2 as in OnCurve, then vec(e) with e = q(s)' r: the axes of P turn with the path.
struct OnPath {
  CurvePoint curve;                                    ///< the curve
  LawPtr<RotationLaw> turn;                            ///< q(s), axes of P -> axes of S
  static constexpr int kRows = 5;                      ///< one along each normal, and three turns
  static constexpr Reads kReads = Reads::both;         ///< all seven coordinates
  static constexpr RowKind kKind = RowKind::function;  ///< lengths and turns
  static constexpr int kMemory = CurvePoint::kMemory;  ///< that of the curve
  /// Names of the rows.
  static constexpr std::array<const char*, 5> kNames = {"normal1", "normal2", "turn1", "turn2", "turn3"};

  /// phi_1, phi_2, m; vec(e).
  template <class T>
  std::array<T, 5> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    // q' = (1/2) q w,  q'' = (1/2) q (a - |w|^2/2)   (1.9)
    const RotationValue q = turn->at(s.v);
    const Vec4 q0 = q.q.coefficients(), q1 = rate(q.q, q.w).coefficients(),
               q2 = rate(q.q, q.a).coefficients() - 0.25 * q.w.squaredNorm() * q0;
    const auto c = [&](int k) { return jet_detail::chain(s, q0[k], q1[k], q2[k]); };
    const T a = c(0), bx = c(1), by = c(2), bz = c(3);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at),
            a * y.e1 - bx * y.e0 - by * y.e3 + bz * y.e2,  // vec( (a, -b) (e0, e1 e2 e3) )
            a * y.e2 - by * y.e0 - bz * y.e1 + bx * y.e3, a * y.e3 - bz * y.e0 - bx * y.e2 + by * y.e1};
  }
  /// That of the curve.
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  /// That of the curve.
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  /// That of the curve.
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

extern template class LOCKSTEP_API PhiLock<OnCurve>;

/// The origin of P stays on a space curve fixed to S. Free: moving along the curve, all turns. A closed curve is a law
/// that repeats.
class LOCKSTEP_API PointOnCurve final : public PhiLock<OnCurve>, public Observable {
 public:
  /// `path`: c(s) in S axes, m, over any parameter s with dc/ds not zero; `near`: an s near which P begins. Throws
  /// ModelError: no path; and at setup as CurvePoint::initialise.
  PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near = 0);
  std::string_view type() const override { return "point_on_curve"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< "s", in its own unit, and "rate", ds/dt
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

extern template class LOCKSTEP_API PhiLock<OnPath>;

/// P follows a path fixed to S: its origin stays on a curve c(s), its axes are those of S turned by q(s). Free: moving
/// along the curve.
class LOCKSTEP_API PathFollower final : public PhiLock<OnPath>, public Observable {
 public:
  /// The path, the turn along it, and where P begins.
  struct Options {
    LawPtr<TranslationLaw> path;  ///< c(s) in S axes, m, over any parameter s with dc/ds not zero
    LawPtr<RotationLaw> turn;     ///< q(s), axes of P -> axes of S
    double near = 0;              ///< an s near which P begins
  };
  /// Throws ModelError: no path or no turn; and at setup as CurvePoint::initialise.
  PathFollower(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "path_follower"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< "s", in its own unit, and "rate", ds/dt
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Links 'gear', 'belt' and 'differential': turns of two or three pairs, each about its own z, measured on a common
// carrier. The carrier may move: a planet carrier. Bearings are separate links; the carrier's share of the tooth force
// is in the reactions of the coupling, not in those of the bearings.

/// (7.4) phi = a theta1 + b theta2 - reference, theta being the turn of a pair about z of its S, rad.
struct TurnsOfTwo {
  double a,                                                        ///< factor of theta1
      b;                                                           ///< factor of theta2
  double reference = 0;                                            ///< a theta1 + b theta2 at the start
  static constexpr int kPairs = 2;                                 ///< two turns
  static constexpr bool kStaysInPlane = true;                      ///< planar mechanisms stay in their plane
  static constexpr Reads kReads = Reads::rotation;                 ///< the relative quaternions
  static constexpr bool kCountsTurns = true;                       ///< the turns run on past full turns
  static constexpr std::array<const char*, 1> kNames = {"teeth"};  ///< name of the row
  /// a theta1 + b theta2.
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return a * y1.rest_z() + b * y2.rest_z() + kTwoPi * (a * y1.turns + b * y2.turns);
  }
  /// phi.
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return turned(y1, y2) - reference;
  }
  /// Sets the reference.
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2) {
    reference = turned(y1, y2).v;
  }
};

/// phi = a theta1 + b theta2 + c theta3 - reference, theta being the turn of a pair about z of its S, rad.
struct TurnsOfThree {
  double a,                                                        ///< factor of theta1
      b,                                                           ///< factor of theta2
      c;                                                           ///< factor of theta3
  double reference = 0;                                            ///< a theta1 + b theta2 + c theta3 at the start
  static constexpr int kPairs = 3;                                 ///< three turns
  static constexpr bool kStaysInPlane = true;                      ///< planar mechanisms stay in their plane
  static constexpr Reads kReads = Reads::rotation;                 ///< the relative quaternions
  static constexpr bool kCountsTurns = true;                       ///< the turns run on past full turns
  static constexpr std::array<const char*, 1> kNames = {"teeth"};  ///< name of the row
  /// a theta1 + b theta2 + c theta3.
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return a * y1.rest_z() + b * y2.rest_z() + c * y3.rest_z() + kTwoPi * (a * y1.turns + b * y2.turns + c * y3.turns);
  }
  /// phi.
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return turned(y1, y2, y3) - reference;
  }
  /// Sets the reference.
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2,
                  const LockCoords<Time>& y3) {
    reference = turned(y1, y2, y3).v;
  }
};

extern template class LOCKSTEP_API PhiCoupling<TurnsOfTwo>;

/// Two gears: theta1 + ratio theta2 (external, bevel) or theta1 - ratio theta2 (internal) keeps its value at the start.
class LOCKSTEP_API Gear final : public PhiCoupling<TurnsOfTwo> {
 public:
  /// How the gears meet.
  enum class Mesh {
    external,  ///< they turn against each other
    internal,  ///< they turn the same way
    bevel      ///< as external; both z axes point away from the apex, or both towards it
  };
  /// `ratio`: turns of gear 1 per turn of gear 2, that is teeth of 2 over teeth of 1. Throws ParameterError: a ratio
  /// that is not above zero.
  Gear(const CoupledPairs& pairs, double ratio, Mesh mesh = Mesh::external);
  std::string_view type() const override { return "gear"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

/// Two pulleys with a belt that neither slips nor stretches: radius1 theta1 - radius2 theta2 keeps its value at the
/// start; of a crossed belt, radius1 theta1 + radius2 theta2.
class LOCKSTEP_API Belt final : public PhiCoupling<TurnsOfTwo> {
 public:
  /// Radii of the pulleys, m, and whether the belt is crossed.
  struct Options {
    double radius1,        ///< of pulley 1, m, above zero
        radius2;           ///< of pulley 2, m, above zero
    bool crossed = false;  ///< whether the pulleys turn against each other
  };
  /// Throws ParameterError: a radius that is not above zero.
  Belt(const CoupledPairs& pairs, Options options);
  std::string_view type() const override { return "belt"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

extern template class LOCKSTEP_API PhiCoupling<TurnsOfThree>;

/// Three turns on one carrier: theta1 + ratio theta2 - (1 + ratio) theta3 keeps its value at the start. Ratio 1 is a
/// bevel differential: both wheels and the cage. Teeth of the ring over teeth of the sun is a planetary gear: sun, ring
/// and arm.
class LOCKSTEP_API Differential final : public PhiCoupling<TurnsOfThree> {
 public:
  /// Throws ParameterError: a ratio that is not above zero.
  explicit Differential(const CoupledPairs& pairs, double ratio = 1);
  std::string_view type() const override { return "differential"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Link 'rack_and_pinion': a pinion that rolls along a rack, or the same between two joints.

/// (7.4) phi = x + radius theta - reference, m: the pinion's centre along x of S, its turn about z. The multiplier is
/// the force at the teeth along the rack, N.
struct RollingPinion {
  double radius;                                                   ///< of the pitch circle, m
  double reference = 0;                                            ///< x + radius theta at the start, m
  static constexpr bool kCountsTurns = true;                       ///< theta runs on past full turns
  static constexpr bool kStaysInPlane = true;                      ///< planar mechanisms stay in their plane
  static constexpr RowKind kKind = RowKind::translation;           ///< a length
  static constexpr std::array<const char*, 1> kNames = {"teeth"};  ///< name of the row
  /// x + radius theta, m.
  template <class T>
  T rolled(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z();
  }
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return rolled(y) - reference;
  }
  /// Sets the reference.
  void initialise(const std::string&, const LockCoords<Time>& y) { reference = rolled(y).v; }
};

extern template class LOCKSTEP_API PhiLock<RollingPinion>;

/// A pinion that rolls along a rack: its centre P moves along x of S, which is fixed to the rack and lies on the path
/// of the centre. Free: rolling.
class LOCKSTEP_API RollingRack final : public PhiLock<RollingPinion> {
 public:
  /// `radius`: of the pitch circle, m; above zero for a rack on the side of -y, below zero for one on the side of +y.
  /// Throws ParameterError: a radius that is zero or not finite.
  RollingRack(std::string name, Marker& p, Marker& s, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
};

/// phi = z2 - radius theta1 - reference, m: pair 1 is the pinion's joint (turn about z), pair 2 the rack's (sliding
/// along z).
struct PinionAndSlide {
  double radius;                               ///< of the pitch circle, m
  double reference = 0;                        ///< z2 - radius theta1 at the start, m
  static constexpr int kPairs = 2;             ///< the pinion, the rack
  static constexpr bool kStaysInPlane = true;  ///< planar mechanisms stay in their plane
  static constexpr std::array<Reads, 2> kReads = {Reads::rotation, Reads::translation};  ///< the turn, the slide
  static constexpr bool kCountsTurns = true;                                             ///< theta1 runs on
  static constexpr RowKind kKind = RowKind::translation;                                 ///< a length
  static constexpr std::array<const char*, 1> kNames = {"teeth"};                        ///< name of the row
  /// z2 - radius theta1, m.
  template <class T>
  T advance(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return rack.z - radius * pinion.angle_z();
  }
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return advance(pinion, rack) - reference;
  }
  /// Sets the reference.
  void initialise(const std::string&, const LockCoords<Time>& pinion, const LockCoords<Time>& rack) {
    reference = advance(pinion, rack).v;
  }
};

extern template class LOCKSTEP_API PhiCoupling<PinionAndSlide>;

/// A pinion and a rack whose joints are separate links on a common carrier, the ground or a moving one. They mesh at
/// the start. The carrier's share of the tooth force is in the reactions of this link, not in those of the bearings.
class LOCKSTEP_API RackAndPinion final : public PhiCoupling<PinionAndSlide> {
 public:
  /// `radius`: slide along z per radian of the pinion, m; negative reverses it. Throws ParameterError: a radius that is
  /// zero or not finite.
  RackAndPinion(const CoupledPairs& pairs, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
  static TypeInfo info();  ///< its keys in scenes
  /// Its maker for the registry: with one pair a RollingRack, with two a RackAndPinion.
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);
};

}  // namespace lockstep
