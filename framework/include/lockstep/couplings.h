// Gears, belts, racks, cams and curves.
#pragma once

#include <memory>
#include <string>

#include <lockstep/params.h>
#include <lockstep/phi_links.h>

namespace lockstep {

// Links 'cam_roller' and 'cam_flat': a disc cam about z of S, its profile a law r(psi), and what rides on it.


/// The closed curve c(u) = r(u) (cos u, sin u) of a law r, one turn of which, 0 to 2 pi, is the profile.
class LOCKSTEP_API CamProfile {
 public:
  using Vec2 = Eigen::Vector2d;
  /// A point of the profile with its derivatives.
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


// Links 'point_on_curve' and 'path_follower': P stays on a space curve c(s), fixed to S.


/// A curve c(s) in S axes and the frame in which the present step sees it: the tangent t and two normals n1, n2 at the
/// last accepted s. P lies in the plane normal to t where t . c(s) = t . rho, which gives s(rho) with both derivatives
/// from c, c_s and c_ss alone:
///
///   s_rho = t / (t . c_s)          s_rho,rho = - (t . c_ss) / (t . c_s)^3  t t^T
///   phi_i = n_i . (rho - c(s))
///
/// (7.6) would take s as a massless unknown of its own; this needs none and is exact on and off the path. The normals
/// are carried along the curve from step to step; reactions in axes do not depend on them.
class LOCKSTEP_API CurvePoint {
 public:
  CurvePoint() = default;
  CurvePoint(LawPtr<TranslationLaw> path, double near) : path_(std::move(path)), near_(near) {}
  const LawPtr<TranslationLaw>& path() const { return path_; }

  /// Unit tangent t of the curve and two normals, n1 and n2.
  struct Frame {
    Vec3 t, n1, n2;
  };
  /// From what was remembered.
  Frame frame(const double* memory) const;
  /// The s of the plane normal to t through rho, by Newton's method from `s`; NaN when there is none near.
  double in_plane(const Vec3& t, const Vec3& rho, double s) const;
  /// The s of the point nearest to rho, searched from `s`; NaN when there is none.
  double nearest(const Vec3& rho, double s) const;

  /// s on jets, with the curve at it.
  template <class T>
  T parameter(const LockCoords<T>& y, const Frame& f, TranslationValue& at) const {
    const T tau = f.t[0] * y.x + f.t[1] * y.y + f.t[2] * y.z;
    const double s = in_plane(f.t, Vec3(y.x.v, y.y.v, y.z.v), expected(y));
    at = path_->at(s);
    const double c1 = f.t.dot(at.v);
    return jet_detail::chain(tau, s, 1 / c1, -f.t.dot(at.a) / (c1 * c1 * c1));
  }
  /// phi_i on jets.
  template <class T>
  T offset(const LockCoords<T>& y, const Vec3& n, const T& s, const TranslationValue& at) const {
    return n[0] * y.x + n[1] * y.y + n[2] * y.z - jet_detail::chain(s, n.dot(at.x), n.dot(at.v), n.dot(at.a));
  }

  // -- memory: s, its rate, the instant; n1
  static constexpr int kMemory = 6;
  void initialise(const std::string& link, const LockCoords<Time>& y) const;
  void reset(std::span<double> z, const LockCoords<Time>& y) const;
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;

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
  CurvePoint curve;
  static constexpr int kRows = 2;
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr int kMemory = CurvePoint::kMemory;
  static constexpr std::array<const char*, 2> kNames = {"normal1", "normal2"};

  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at)};
  }
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

/// The same, and the axes of P turned with the path: e = q(s)' r, three rows vec(e) = 0.
struct OnPath {
  CurvePoint curve;
  LawPtr<RotationLaw> turn;
  static constexpr int kRows = 5;
  static constexpr Reads kReads = Reads::both;
  static constexpr RowKind kKind = RowKind::function;
  static constexpr int kMemory = CurvePoint::kMemory;
  static constexpr std::array<const char*, 5> kNames = {"normal1", "normal2", "turn1", "turn2", "turn3"};

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
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

/// Free: moving along the curve, all turns. A closed curve is a law that repeats.
class LOCKSTEP_API PointOnCurve final : public PhiLock<OnCurve>, public Observable {
 public:
  /// `path`: c(s) in S axes, m, of any parameter s on which it moves without a halt; `near`: an s near which P begins.
  PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near = 0);
  std::string_view type() const override { return "point_on_curve"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< s, rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Free: moving along the curve. The axes of P are those of S turned by q(s).
class LOCKSTEP_API PathFollower final : public PhiLock<OnPath>, public Observable {
 public:
  /// The path, the turn along it, and where P begins.
  struct Options {
    LawPtr<TranslationLaw> path;  ///< c(s) in S axes, m, of any parameter s on which it moves without a halt
    LawPtr<RotationLaw> turn;     ///< q(s) in S axes
    double near = 0;              ///< an s near which P begins
  };
  /// Throws ModelError: a path or a turn that is missing.
  PathFollower(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "path_follower"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< s, rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};


// Links 'gear', 'belt' and 'differential': turns of two or three pairs, each about its own z, measured on a common
// carrier. The carrier may move: a planet carrier. Bearings are links of their own; the carrier's share of the tooth
// force is in the reactions of the coupling, not in those of the bearings.


/// (7.4) phi = a theta1 + b theta2 - reference.
struct TurnsOfTwo {
  double a, b;           ///< factors of the two turns
  double reference = 0;  ///< a theta1 + b theta2 of the start
  static constexpr int kPairs = 2;
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return a * y1.angle_z() + b * y2.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return turned(y1, y2) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2) {
    reference = turned(y1, y2).v;
  }
};

/// phi = a theta1 + b theta2 + c theta3 - reference.
struct TurnsOfThree {
  double a, b, c;        ///< factors of the three turns
  double reference = 0;  ///< of the start
  static constexpr int kPairs = 3;
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return a * y1.angle_z() + b * y2.angle_z() + c * y3.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return turned(y1, y2, y3) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2,
                  const LockCoords<Time>& y3) {
    reference = turned(y1, y2, y3).v;
  }
};

/// Two gears: theta1 + ratio theta2 = as at the start (external, bevel), theta1 - ratio theta2 (internal). Bevel: both
/// z axes point away from the apex, or both towards it.
class LOCKSTEP_API Gear final : public PhiCoupling<TurnsOfTwo> {
 public:
  enum class Mesh { external, internal, bevel };
  /// `ratio`: turns of gear 1 per turn of gear 2, that is teeth of 2 to teeth of 1; above zero. Throws ModelError.
  Gear(const CoupledPairs& pairs, double ratio, Mesh mesh = Mesh::external);
  std::string_view type() const override { return "gear"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Two pulleys: radius1 theta1 = radius2 theta2 as at the start, or opposed when the belt is crossed. It does not slip
/// or stretch.
class LOCKSTEP_API Belt final : public PhiCoupling<TurnsOfTwo> {
 public:
  /// Radii of the pulleys, m, and whether the belt is crossed.
  struct Options {
    double radius1, radius2;  ///< of the pulleys, m, above zero
    bool crossed = false;     ///< the pulleys turn against each other
  };
  /// Throws ModelError: a radius that is not above zero.
  Belt(const CoupledPairs& pairs, Options options);
  std::string_view type() const override { return "belt"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Three turns on one carrier: theta1 + ratio theta2 = (1 + ratio) theta3 as at the start. With ratio 1 a bevel
/// differential: both wheels and the cage; with (teeth of the ring)/(teeth of the sun) a planetary gear: sun, ring and
/// arm.
class LOCKSTEP_API Differential final : public PhiCoupling<TurnsOfThree> {
 public:
  /// `ratio` above zero. Throws ModelError.
  explicit Differential(const CoupledPairs& pairs, double ratio = 1);
  std::string_view type() const override { return "differential"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};


// Link 'rack_and_pinion': a pinion that rolls along a rack, or the same between two joints.


/// (7.4) phi = x + radius theta - reference, m: the pinion's centre along x of S, its turn about z. Its multiplier is
/// the force at the teeth along the rack.
struct RollingPinion {
  double radius;         ///< of the pitch circle, m
  double reference = 0;  ///< of the start, m
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T rolled(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return rolled(y) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y) { reference = rolled(y).v; }
};

/// A pinion that rolls along a rack: its centre P moves along x of S, which is fixed to the rack and lies on the line
/// of the centre. Free: rolling.
class LOCKSTEP_API RollingRack final : public PhiLock<RollingPinion> {
 public:
  /// `radius`: of the pitch circle, m; negative when the rack lies on the other side (above the pinion).
  RollingRack(std::string name, Marker& p, Marker& s, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
};

/// phi = z2 - radius theta1 - reference, m: pair 1 is the pinion's joint (turn about z), pair 2 the rack's (sliding
/// along z).
struct PinionAndSlide {
  double radius;         ///< of the pitch circle, m
  double reference = 0;  ///< of the start, m
  static constexpr int kPairs = 2;
  static constexpr std::array<Reads, 2> kReads = {Reads::rotation, Reads::translation};
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T advance(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return rack.z - radius * pinion.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return advance(pinion, rack) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& pinion, const LockCoords<Time>& rack) {
    reference = advance(pinion, rack).v;
  }
};

/// Pinion and rack in joints of their own on a common carrier, the ground or a moving one. They mesh at the start. The
/// carrier's share of the tooth force is in the reactions of this link, not in those of the bearings.
class LOCKSTEP_API RackAndPinion final : public PhiCoupling<PinionAndSlide> {
 public:
  /// `radius`: slide along z per radian of the pinion, m; negative reverses it.
  RackAndPinion(const CoupledPairs& pairs, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
  static TypeInfo info();
  /// With one pair a RollingRack, with two a RackAndPinion.
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
