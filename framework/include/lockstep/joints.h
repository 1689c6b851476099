// The joints.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <lockstep/body.h>
#include <lockstep/lock.h>
#include <lockstep/params.h>
#include <lockstep/phi_links.h>

namespace lockstep {

// Link 'distance'.


/// (7.4) |rho| - f(t). The multiplier is the axial force: positive pulls the two points together.
struct DistanceFunction {
  LawPtr<MotionLaw> law;  ///< f(t), m; null: `length`
  double length = 0;      ///< m
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::sqrt;
    return sqrt(y.x * y.x + y.y * y.y + y.z * y.z) - (law ? law_at(*law, y.t) : T(length));
  }
  double length_at(double t) const { return law ? law->at(t).y : length; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const {
    if (law) law->breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const { return law ? law_fault("the law of its length", law, t) : ""; }
};

/// Distance between the origins of P and S, constant or by a law (m). Free: everything that keeps the distance; without
/// a direction, hence refused, at length zero.
class LOCKSTEP_API Distance final : public PhiLock<DistanceFunction> {
 public:
  Distance(std::string name, Marker& p, Marker& s, double length);
  Distance(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> length);
  /// At the distance of the start.
  Distance(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "distance"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);

 protected:
  RowPlan plan_rows() override;
};


// The joints: each a mask and a name. P is on O1, S on O2; axes are those of S. "Free" says what P may do seen from S.


/// A joint that is nothing but a mask: the class says its name, its rows and one line of help.
template <class Self, Mask kMask>
class MaskJoint : public MarkerLock {
 public:
  MaskJoint(std::string name, Marker& p, Marker& s) : MarkerLock(std::move(name), p, s, kMask) {}
  std::string_view type() const override { return Self::kType; }
  static TypeInfo info() { return {Self::kType, Self::kHelp, {}}; }
  static std::unique_ptr<Lock> make(const Site& site, const Params&) {
    return std::make_unique<Self>(site.name, site.p(), site.s());
  }
};

/// Free: nothing. Holds P in S, position and orientation (table 1: fixed). With move() and turn() it is the full
/// motion.
struct LOCKSTEP_API Fixed final : MaskJoint<Fixed, Mask::all> {
  static constexpr const char* kType = "fixed";
  static constexpr const char* kHelp = "holds P in S; free: nothing";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along z of S, all turns. The origin of P stays on the z axis of S.
struct LOCKSTEP_API PointOnLine final : MaskJoint<PointOnLine, Mask::x | Mask::y> {
  static constexpr const char* kType = "point_on_line";
  static constexpr const char* kHelp = "origin of P on the z axis of S; free: sliding along z, all turns";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S, all turns. The origin of P stays in the xy plane of S.
struct LOCKSTEP_API PointOnPlane final : MaskJoint<PointOnPlane, Mask::z> {
  static constexpr const char* kType = "point_on_plane";
  static constexpr const char* kHelp = "origin of P in the xy plane of S; free: sliding along x and y, all turns";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S, turning about z of S. The xy planes of P and S coincide.
struct LOCKSTEP_API PlaneOnPlane final : MaskJoint<PlaneOnPlane, Mask::z | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "plane_on_plane";
  static constexpr const char* kHelp =
      "planar joint, xy planes of P and S coincide; free: sliding along x and y, turning about z";
  using MaskJoint::MaskJoint;
};
/// Free: turning about z of S.
struct LOCKSTEP_API Revolute final : MaskJoint<Revolute, Mask::xyz | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "revolute";
  static constexpr const char* kHelp = "hinge; free: turning about z of S";
  using MaskJoint::MaskJoint;
};
/// Free: turning about and sliding along z of S.
struct LOCKSTEP_API Cylindrical final : MaskJoint<Cylindrical, Mask::x | Mask::y | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "cylindrical";
  static constexpr const char* kHelp = "shaft in a bore; free: turning about and sliding along z of S";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x, y and z of S. No turns.
struct LOCKSTEP_API AngularAlignment final : MaskJoint<AngularAlignment, Mask::e123> {
  static constexpr const char* kType = "angular_alignment";
  static constexpr const char* kHelp = "axes of P parallel to those of S; free: sliding along x, y and z";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S. Two parallel shafts along z turn together (the paper's Oldham joint as one lock).
struct LOCKSTEP_API Oldham final : MaskJoint<Oldham, Mask::z | Mask::e123> {
  static constexpr const char* kType = "oldham";
  static constexpr const char* kHelp = "parallel shafts along z turn together; free: sliding along x and y of S";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along z of S.
struct LOCKSTEP_API Prismatic final : MaskJoint<Prismatic, Mask::x | Mask::y | Mask::e123> {
  static constexpr const char* kType = "prismatic";
  static constexpr const char* kHelp = "slider; free: sliding along z of S";
  using MaskJoint::MaskJoint;
};
/// Free: swinging about every axis normal to z of S. Shafts along z_P and z_S meet in one point and turn at equal rates
/// at every bend (4.21), short of a half turn.
struct LOCKSTEP_API Rzeppa final : MaskJoint<Rzeppa, Mask::xyz | Mask::e3> {
  static constexpr const char* kType = "rzeppa";
  static constexpr const char* kHelp =
      "constant-velocity joint, shafts along z meet in one point; free: swinging about axes normal to z";
  using MaskJoint::MaskJoint;
};
/// Free: all translations, swinging about every axis normal to z of S. The orientation half of the Rzeppa joint.
struct LOCKSTEP_API Homokinetic final : MaskJoint<Homokinetic, Mask::e3> {
  static constexpr const char* kType = "homokinetic";
  static constexpr const char* kHelp =
      "shafts along z turn at equal rates wherever they are; free: all translations, swinging about axes normal to z";
  using MaskJoint::MaskJoint;
};
/// Free: all turns. The origins of P and S coincide.
struct LOCKSTEP_API Spherical final : MaskJoint<Spherical, Mask::xyz> {
  static constexpr const char* kType = "spherical";
  static constexpr const char* kHelp = "ball joint, origins coincide; free: all turns";
  using MaskJoint::MaskJoint;
};

/// The lock itself, by its mask in words: "x y z e1 e2".
class LOCKSTEP_API GenericLock final : public MarkerLock {
 public:
  using MarkerLock::MarkerLock;
  std::string_view type() const override { return "lock"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};


// Link 'screw'.


/// (7.4) phi = z - lead theta / 2 pi - reference - f(t), m. Its multiplier is the axial force of the thread.
struct LOCKSTEP_API ScrewThread {
  double lead;               ///< advance per turn, m; negative for a left-hand thread
  LawPtr<MotionLaw> slip{};  ///< f(t), distance from the thread, m; null: none
  double reference = 0;      ///< z - lead theta / 2 pi of the start, m
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"thread"};
  template <class T>
  T advance(const LockCoords<T>& y) const {
    return y.z - lead / kTwoPi * y.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T phi = advance(y) - reference;
    return slip ? phi - law_at(*slip, y.t) : phi;
  }
  void initialise(const std::string&, const LockCoords<Time>& y) { reference = advance(y).v; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  std::string diagnose(double t) const;
};

/// Free: turning about z of S, and with it sliding along z. Turns are counted without end.
class LOCKSTEP_API Screw final : public PhiLock<ScrewThread>, public Observable {
 public:
  /// `lead`: m per turn, negative for a left-hand thread; `slip`: law of the distance from the thread, m. The poses of
  /// the start lie on the thread. Throws ModelError: a lead that is not finite.
  Screw(std::string name, Marker& p, Marker& s, double lead, LawPtr<MotionLaw> slip = {});
  std::string_view type() const override { return "screw"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< angle (counted), rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};


// Link 'stop': one end of the travel of one coordinate; a unilateral link.


/// +-(coordinate - limit), so that C >= 0 is the free side: above a low end, below a high one.
struct StopAlong {
  int axis;      ///< of S: 0 x, 1 y, 2 z
  double limit;  ///< m
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * ((axis == 0 ? y.x : axis == 1 ? y.y : y.z) - limit);
  }
};
/// The same of the turn about z of S, counted past full turns.
struct StopAbout {
  double limit;  ///< rad
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * (y.angle_z() - limit);
  }
};

/// Free: everything, until the coordinate x, y or z of P seen from S comes to its limit.
class LOCKSTEP_API SlideStop final : public PhiLock<StopAlong> {
 public:
  /// Where the travel ends, m.
  struct Options {
    int axis = 0;      ///< of S: 0 x, 1 y, 2 z
    double limit = 0;  ///< m
    bool low = true;   ///< the coordinate stays above the limit, else below it
  };
  /// Throws ModelError: a limit that is not finite.
  SlideStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// Free: everything, until the turn about z of S comes to its limit (rad, counted past full turns; at the start within
/// half a turn of zero).
class LOCKSTEP_API TurnStop final : public PhiLock<StopAbout> {
 public:
  /// Where the turn ends, rad.
  struct Options {
    double limit = 0;  ///< rad
    bool low = true;   ///< the angle stays above the limit, else below it
  };
  /// Throws ModelError: a limit that is not finite.
  TurnStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// Type "stop" of files. Unilateral by itself, without restitution until set_unilateral() says more.
struct LOCKSTEP_API Stop {
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};


// Link 'universal'.


/// (7.4) phi = x_S . y_P = 2 (e1 e2 - e0 e3): the two pins of the cross stay normal to each other.
struct Cross {
  static constexpr Reads kReads = Reads::rotation;
  static constexpr std::array<const char*, 1> kNames = {"cross"};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * (y.e1 * y.e2 - y.e0 * y.e3);
  }
};

/// Hooke's joint: free to turn about x of S and about y of P, the pins of its cross; origins coincide.
class LOCKSTEP_API Universal final : public PhiLock<Cross> {
 public:
  Universal(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "universal"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
