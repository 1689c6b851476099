// SPDX-License-Identifier: BSD-3-Clause
// The built-in forces.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/force.h>

namespace lockstep {

template <class T>
struct Ends;
struct TypeInfo;

// Effort: the only difference between forces and torques of motors and applied loads.

/// What a motor or an applied load exerts between two markers.
enum class Effort {
  force,   ///< N: on P's body at the origin of P, the opposite on S's body at the same point
  torque,  ///< N m: on P's body, the opposite on S's body
};

// Forces 'applied_force' and 'applied_torque': a force at a marker or a torque on its body, constant or by laws.

/// The axes in which an applied vector is given.
enum class AppliedAxes {
  world,  ///< the world's
  body,   ///< those of P's body
  marker  ///< those of marker P
};

/// The vector value + law(t) direction + (laws_x, laws_y, laws_z)(t); parts without a law are zero.
struct AppliedVector {
  Vec3 value = Vec3::Zero();                ///< constant part, N or N m
  LawPtr<MotionLaw> law{};                  ///< N or N m, along `direction`
  Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
  std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N or N m, for the three components; any may be absent
  AppliedAxes axes = AppliedAxes::world;    ///< axes of all parts
};

class Applied;
extern template class LOCKSTEP_API FormulaForce<Applied>;

/// Common part of AppliedForce and AppliedTorque: a vector acts on P's body, the opposite on S's body if there is an S.
class LOCKSTEP_API Applied : public FormulaForce<Applied> {
 public:
  /// Throws ParameterError for a number that is not finite, or a law without direction; ModelError as MarkerForce does.
  Applied(std::string name, Marker& p, Marker* s, Effort effort, AppliedVector vector);
  ~Applied() override;
  /// force_on_p_world_x, .._y, .._z, N (of a torque: torque_..., N m), power, W
  std::vector<Quantity> quantities() const override;
  /// Throws ModelError when a torque, or the lever arm of a force on S, acts on a particle.
  void setup() override;
  bool stays_in_plane(Plane) const override;
  /// The formula; see namespace formula.
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

 private:
  Vec3 in_its_axes(double t) const;
  Effort effort_;
  AppliedVector vector_;
  Mat3 body_axes_ = Mat3::Identity();  // body axes -> slot axes; made by setup()
};

/// Force F at the origin of P on P's body; with S, -F on S's body at the same point.
///
///     force       F = value + law(t) direction + laws(t), in the axes chosen          N
///     potential   V = -value.x_P, of the constant part in world axes only, without S or with S on the ground   J
///     power       F.(velocity of P's body at x_P - velocity of S's body at x_P)       W; all but -dV/dt is supply
///
/// No dissipation.
class LOCKSTEP_API AppliedForce final : public Applied {
 public:
  /// The force: a constant part and laws, and their axes.
  struct Options {
    Vec3 force = Vec3::Zero();                ///< constant part, N
    LawPtr<MotionLaw> law{};                  ///< N, along `direction`
    Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
    std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N, for the components; any may be absent
    AppliedAxes axes = AppliedAxes::world;    ///< axes of all parts
  };
  /// Acts on P's body alone. Throws ParameterError for a number that is not finite, or a law without direction;
  /// ModelError as MarkerForce does.
  AppliedForce(std::string name, Marker& p, Options options);
  /// Acts between the bodies of P and S. Throws likewise.
  AppliedForce(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "applied_force"; }
  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters
};

/// Torque M on P's body; with S, -M on S's body.
///
///     torque      M = value + law(t) direction + laws(t), in the axes chosen   N m
///     power       M.(w of P's body - w of S's body)                            W, all of it supply
///
/// No dissipation, and no potential: a constant torque in space has none.
class LOCKSTEP_API AppliedTorque final : public Applied {
 public:
  /// The torque: a constant part and laws, and their axes.
  struct Options {
    Vec3 torque = Vec3::Zero();               ///< constant part, N m
    LawPtr<MotionLaw> law{};                  ///< N m, about `direction`
    Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
    std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N m, for the components; any may be absent
    AppliedAxes axes = AppliedAxes::world;    ///< axes of all parts
  };
  /// Acts on P's body alone. Throws ParameterError for a number that is not finite, or a law without direction;
  /// ModelError as MarkerForce does.
  AppliedTorque(std::string name, Marker& p, Options options);
  /// Acts between the bodies of P and S. Throws likewise.
  AppliedTorque(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "applied_torque"; }
  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters
};

// Force 'bushing': a soft joint, linear in six coordinates.

class Bushing;
extern template class LOCKSTEP_API FormulaForce<Bushing>;

/// Springs and dampers along and about the axes of S, between P and S. d = A_S' (x_P - x_S); th = rotation vector of
/// e = q_S' q_P in the axes of S, |th| < pi: small rotations.
///
///     force       F = -(K d + C dd),      dd = A_S' (v_P - v_S) - w_S x d       N, S axes; on P's body at P, -F on S's
///     torque      M = -(J' Kt th + Ct w),  w = A_S' (w_P - w_S), thd = J w      N m, S axes; on P's body, -M on S's
///                 J = 1 - 1/2 th~ + c th~^2,  c = (1 - (a/2) cot(a/2))/a^2,  a = |th|
///     potential   V = 1/2 d'K d + 1/2 th'Kt th                                  J
///     dissipation D = dd'C dd + w'Ct w                                          W
///     power       of F and M on the two bodies                                  W; -dV/dt - D for markers at rest
///
/// With J the power balance is exact for large rotations too; J' Kt th = Kt th for equal stiffnesses. S must not be
/// on a particle; P may be, when the rotational numbers are zero. Stiffnesses may be negative, damping must not.
class LOCKSTEP_API Bushing final : public FormulaForce<Bushing> {
 public:
  /// Stiffness and damping in six coordinates, in S axes.
  struct Options {
    Vec3 stiffness = Vec3::Zero();          ///< K, N/m, along the axes of S
    Vec3 damping = Vec3::Zero();            ///< C, N s/m, along the axes of S, not negative
    Vec3 torsion_stiffness = Vec3::Zero();  ///< Kt, N m/rad, about the axes of S
    Vec3 torsion_damping = Vec3::Zero();    ///< Ct, N m s/rad, about the axes of S, not negative
  };
  /// Throws ParameterError for a number that is not finite or a negative damping; ModelError as MarkerForce does.
  Bushing(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return "bushing"; }
  /// x y z (d, m), angle_x angle_y angle_z (th, rad), force_on_p_link_x .. z (N), torque_on_p_link_x .. z (N m), in S
  /// axes, and power (W)
  std::vector<Quantity> quantities() const override;
  /// Throws ModelError when S, or P with torsional numbers, is on a particle.
  void setup() override;
  bool stays_in_plane(Plane) const override;
  /// The formula; see namespace formula.
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  Options options_;
};

// Force 'joint_friction': dry and viscous friction in a joint, from the joint's reaction at the same time.

/// Friction along the free translations of P in S, and about the one free rotation axis of S. F and M are the reaction
/// of the joint's own rows (without its drives) on P's body at the origin of P, in S axes; u is the sliding velocity of
/// P in the free directions, w the rate about the free axis:
///
///     sliding   N = N0 + |F held| + |M held, normal to a single free direction|/b         N
///               force on P's body at P: -(mu(|u|) N + c |u|) u/|u|, the opposite on S's   N
///     rotation  T = mu(r |w|) (r (N0 + |F radial|) + r_a |F axial|) + c_t |w|             N m, against w
///     mu(s)     = (mu_k + (mu_s - mu_k) exp(-(s/v_s)^2)) tanh(s/v_0)                      Coulomb: mu_s = mu_k
///     |F|       = sqrt(F.F + e^2) - e, smooth as the reaction passes zero
///
/// Everything is odd in u and w and smooth at rest: below v_0 a joint creeps instead of sticking. In mu of the torque,
/// r_a replaces r when r is zero. Not supported: joints that hold more than a mask, such as screws, racks and functions,
/// markers that move on their bodies by laws, and joints with a law `turn`.
class LOCKSTEP_API JointFriction final : public Force, public Reacting {
 public:
  /// Coefficients and dimensions of the friction.
  struct Options {
    double mu = 0;                  ///< mu_k, not negative
    double mu_static = -1;          ///< mu_s; below zero: mu_k
    double stribeck_speed = 0.01;   ///< v_s, m/s, above 0
    double smoothing_speed = 1e-3;  ///< v_0, m/s, above 0
    double radius = 0;              ///< r, m: radius at which a bearing rubs under its radial load
    double axial_radius = 0;        ///< r_a, m: radius at which it rubs under its axial load
    double bending_length = 0;      ///< b, m; 0: bending moments add no normal force
    double preload = 0;             ///< N0, N: a normal force that always acts
    double viscous = 0;             ///< c, N s/m
    double viscous_turn = 0;        ///< c_t, N m s/rad
    double load_smoothing = 1e-6;   ///< e, N: size of a load below which it is smoothed
  };
  /// Throws ParameterError for an invalid number, ModelError for a joint without friction surfaces.
  JointFriction(std::string name, const Lock& link, Options options);

  std::string_view type() const override { return "joint_friction"; }
  std::vector<const Marker*> markers() const override { return {p_, s_}; }
  /// Those that apply to the joint: normal_force, friction_force (on P along the sliding, signed if there is one
  /// direction), sliding_speed; radial_force, axial_force, friction_torque (on P about the axis), turning_rate.
  std::vector<Quantity> quantities() const override;
  double reacting_quantity(int k, const Inputs&, const Reactions&) const override;
  /// Throws ModelError for a joint with a function, for markers that move on their bodies by laws, and for a joint with a
  /// law `turn`.
  void setup() override;
  bool stays_in_plane(Plane) const override { return true; }  ///< it acts along the motion that there is
  void apply(const Inputs&, WrenchSum&) const override {}     ///< nothing: all of it is in react()
  void tangent(const Inputs&, TangentSum&) const override {}  ///< nothing: all of it is in react_tangent()

  const Reacting* reacting() const override { return this; }
  std::vector<const Lock*> reads() const override { return {link_}; }
  void react(const Inputs&, const Reactions&, WrenchSum& out) const override;
  void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const override;
  double friction_loss(const Inputs&, const Reactions&) const override;
  /// mu_s N along the sliding, and mu_s (r (N0 + |F radial|) + r_a |F axial|) about the axis.
  std::vector<Grip> grips(const Inputs&, const Reactions&) const override;

  static TypeInfo info();                                                ///< name and keys of its type
  static Options options(const Params&);                                 ///< from parameters checked against info()
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  struct Pressing;
  void check_numbers() const;
  template <class T>
  T coefficient(const T& square_of_speed) const;
  double size(double square) const;
  Pressing pressing(const Inputs&, const Reactions&) const;
  template <class T, class Load>
  void act(const Pressing&, const Ends<T>&, Load&) const;
  ForceAccount account(const Inputs&, const Reactions&) const;

  const Lock* link_;
  const Marker *p_, *s_;
  Options options_;
  Vec3 sliding_ = Vec3::Zero();  // 1 in the free directions of S, if another direction is held
  Vec3 pressing_ = Vec3::Zero();
  int turning_ = -1;  // free axis of S
  Vec3 radial_ = Vec3::Zero(), axial_ = Vec3::Zero(), bending_ = Vec3::Zero();
  double arm_ = 0;
  MarkerFrame P_, S_;
};

// Forces 'force_motor' and 'torque_motor': a force or a torque by a law between two bodies, along an axis.

class Motor;
extern template class LOCKSTEP_API FormulaForce<Motor>;

/// Common part of ForceMotor and TorqueMotor: the effort f = law(t) along z of S. It prescribes no motion.
class LOCKSTEP_API Motor : public FormulaForce<Motor> {
 public:
  /// Throws ParameterError without a law; ModelError as MarkerForce does.
  Motor(std::string name, Marker& p, Marker& s, Effort effort, LawPtr<MotionLaw> law);
  ~Motor() override;
  std::vector<Quantity> quantities() const override;  ///< force, N, or torque, N m; rate, m/s or rad/s; power, W
  /// Throws ModelError when S, or P of a torque, is on a particle.
  void setup() override;
  bool stays_in_plane(Plane) const override;
  /// The formula; see namespace formula.
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

 private:
  Effort effort_;
  LawPtr<MotionLaw> law_;
};

/// Force on P's body at the origin of P along z of S, the opposite on S's body at the same point.
///
///     force    F = law(t)                                                           N, on P's body along z of S
///     rate     z_S.(v_P - v_S - w_S x (x_P - x_S)) of the markers                   m/s, of P along z in the axes of S
///     power    F z_S.(velocity of P's body at x_P - velocity of S's body at x_P)    W, put into the mechanism
///
/// No potential, no dissipation.
class LOCKSTEP_API ForceMotor final : public Motor {
 public:
  /// The law of the force, N.
  struct Options {
    LawPtr<MotionLaw> force{};  ///< N; required
  };
  /// Throws ParameterError without a law; ModelError as MarkerForce does.
  ForceMotor(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "force_motor"; }
  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters
};

/// Torque on P's body about z of S, the opposite on S's body.
///
///     torque   T = law(t)                        N m, on P's body about z of S
///     rate     z_S.(w_P - w_S) of the markers    rad/s
///     power    T z_S.(w_P - w_S) of the bodies   W, put into the mechanism
///
/// No potential, no dissipation.
class LOCKSTEP_API TorqueMotor final : public Motor {
 public:
  /// The law of the torque, N m.
  struct Options {
    LawPtr<MotionLaw> torque{};  ///< N m; required
  };
  /// Throws ParameterError without a law; ModelError as MarkerForce does.
  TorqueMotor(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "torque_motor"; }
  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters
};

// Force 'spring_damper': spring, damper and linear actuator between two points.

class SpringDamper;
extern template class LOCKSTEP_API FormulaForce<SpringDamper>;

/// Spring, damper and linear actuator on the line between the origins of P and S; a positive force pulls them together.
///
///     length      l = |x_P - x_S|                                   m
///     rate        ld = n.(v_P - v_S),   n = (x_P - x_S)/l           m/s
///     force       T = k (l - l0) + T0 + c ld + law(t)               N, positive = pulls; -T n on P, +T n on S
///     potential   V = 1/2 k (l - l0)^2 + T0 (l - l0)                J
///     dissipation D = c ld^2                                        W
///     power       T n.(v_S - v_P) of the two bodies                 W; -dV/dt - D - law ld for markers at rest
///
/// With l = 0 there is no direction and so no force; setup() rejects markers that coincide at the start unless the
/// force is zero there. k may be negative (a spring that pushes away); c and l0 must not be. x and v are those of the
/// markers, also if these move on their bodies.
class LOCKSTEP_API SpringDamper final : public FormulaForce<SpringDamper> {
 public:
  /// Stiffness, damping, free length, preload and actuator.
  struct Options {
    double stiffness = 0;       ///< k, N/m
    double damping = 0;         ///< c, N s/m, not negative
    double free_length = 0;     ///< l0, m, not negative
    double preload = 0;         ///< T0, N: force at l0, positive = pulls
    LawPtr<MotionLaw> force{};  ///< N, added to the force: a linear actuator
  };
  /// Throws ParameterError for a number that is not finite, a negative damping or free length; ModelError as
  /// MarkerForce does.
  SpringDamper(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return "spring_damper"; }
  std::vector<Quantity> quantities() const override;  ///< length, m; rate, m/s; force, N; power, W
  /// Throws ModelError for markers that coincide at the start while the force is not zero there.
  void setup() override;
  bool stays_in_plane(Plane) const override;
  /// The formula; see namespace formula.
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  Options options_;
};

// Force 'torsion_spring_damper': spring, damper and rotary actuator about an axis, full revolutions counted.

class CountedAngle;
class TorsionSpringDamper;
extern template class LOCKSTEP_API FormulaForce<TorsionSpringDamper>;

/// Spring, damper and rotary actuator about the common z axis of P and S; a positive torque rotates P back.
///
///     angle       th = 2 atan2(e3, e0), e = q_S' q_P, full revolutions counted  rad
///     rate        thd = g.(w_P - w_S), g = (z_P + z_S)/(1 + z_P.z_S)         rad/s; g = z if the axes are common
///     torque      T = k (th - th0) + T0 + c thd + law(t)                     N m; -T g on P, +T g on S
///     potential   V = 1/2 k (th - th0)^2 + T0 (th - th0)                     J
///     dissipation D = c thd^2                                                W
///     power       T g.(w_S - w_P) of the two bodies                          W; -dV/dt - D - law thd, markers at rest
///
/// g is the gradient of th, so that the power balance also holds for axes that are not exactly common. The angle is a
/// CountedAngle. At z_P = -z_S there is no angle and no torque; setup() rejects such a start. k may be negative, c must
/// not be.
class LOCKSTEP_API TorsionSpringDamper final : public FormulaForce<TorsionSpringDamper> {
 public:
  /// Stiffness, damping, free angle, preload and actuator.
  struct Options {
    double stiffness = 0;        ///< k, N m/rad
    double damping = 0;          ///< c, N m s/rad, not negative
    double free_angle = 0;       ///< th0, rad; may be more than a full revolution
    double preload = 0;          ///< T0, N m: torque at th0
    LawPtr<MotionLaw> torque{};  ///< N m, added to the torque: a rotary actuator
  };
  /// Throws ParameterError for a number that is not finite or a negative damping; ModelError as MarkerForce does.
  TorsionSpringDamper(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return "torsion_spring_damper"; }
  std::vector<Quantity> quantities() const override;  ///< angle, rad; rate, rad/s; torque, N m; power, W
  /// Throws ModelError when P or S is on a particle, or z_P = -z_S at the start.
  void setup() override;
  bool stays_in_plane(Plane) const override;
  /// The formula; see namespace formula.
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  void count_angles(AngleCounter& counter) override;

  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  Options options_;
  const CountedAngle* angle_ = nullptr;
};

}  // namespace lockstep
