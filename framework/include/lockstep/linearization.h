// SPDX-License-Identifier: BSD-3-Clause
// Linearization: the matrices of a mechanism at a state, its equations of motion for small deviations, and the same in
// minimal coordinates with inputs and outputs.
//
//   M dx'' + D dx' + K dx + J^T dlambda = 0,   J dx = 0        theory, section 9.4
//
// dx: per slot a translation of the centre of mass, m, and a rotation, rad, in slot axes.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/SparseCore>

#include <lockstep/author/law.h>
#include <lockstep/dynamics.h>
#include <lockstep/finding.h>
#include <lockstep/recorder.h>

namespace lockstep {

using SparseMat = Eigen::SparseMatrix<double>;  ///< sparse matrix, by columns

// MechanismMatrices: the terms of the equations of motion at one state.

/// An unknown velocity: a column of J, a row and a column of M, D and K.
struct UnknownVelocity {
  std::string name,  ///< "rod.vx": body, and vx vy vz (world, centre of mass) or wx wy wz (slot axes)
      unit;          ///< "m/s" or "rad/s"
  int slot = 0,      ///< the slot that moves
      velocity = 0;  ///< index of its six velocities
};

/// The matrices of a mechanism at one state. Rows and columns are the unknown velocities, slot by slot; rows of J are
/// the constraints of the active joints.
struct MechanismMatrices {
  std::vector<UnknownVelocity> unknowns;  ///< names of the unknown velocities
  std::vector<std::string> rows;          ///< names of the constraints: "A.x"
  std::vector<RowKind> kinds;             ///< their quantities
  SparseMat M,                            ///< masses, kg, and inertias, kg m^2
      D,                                  ///< d(inertia - forces)/dv: dampers and gyroscopic terms
      K,       ///< d(inertia + J^T lambda - forces)/dx: springs, loads, and the geometric stiffness of constraints
      J;       ///< Jacobian of the constraints
  VecX v,      ///< velocities at the state
      f,       ///< gravity, -w x J w and all forces: the right-hand side of M a + J^T lambda = f
      c,       ///< the right-hand side of J a = c
      C,       ///< residuals of the constraints
      Ct,      ///< their partial derivatives in time
      a,       ///< the solution: accelerations
      lambda;  ///< and multipliers
  double length = 1;  ///< System::length(), m, by which rotations are compared with translations
  /// Scales of the residual acceleration, of all terms by their size, so that they remain if terms cancel; per slot:
  VecX loads,   ///< its forces over its mass, m/s^2
      levers,   ///< acceleration of its centre of mass by moments other than reactions, on an arm, m/s^2
      moments;  ///< three: the moments about its centre of mass, slot axes, N m
};

/// Evaluates a mechanism at a state and writes its matrices. Friction in joints enters f at the solution. Throws what
/// Dynamics::evaluate throws.
LOCKSTEP_API MechanismMatrices matrices_at(Dynamics&, const State&);

// LinearMotion: small deviations from an equilibrium, a steady rotation, or, on request, any motion.

/// Axes of the deviations, and whether states that are no equilibrium are accepted.
struct LinearMotionOptions {
  /// Angular velocity of the axes that rotate with the mechanism, world, rad/s. Default: found from the state.
  std::optional<Vec3> spin{};
  /// Uses the coefficients of this state if it is neither an equilibrium nor a steady rotation.
  bool frozen = false;
};

/// Residual acceleration and speed: the distance from an equilibrium or a steady rotation, in axes that rotate with it.
struct Unrest {
  double acceleration = 0,  ///< the largest of a slot relative to its limit, m/s^2; angular ones times `length`
      speed = 0;            ///< the largest of a slot relative to its limit, m/s
  std::string accelerates,  ///< the body of that acceleration; "" if there is none
      moves;                ///< the body of that speed
  /// 1e-6 of that body's loads and levers (MechanismMatrices), m/s^2; for an angular acceleration also of its moment
  /// over its inertia about the same principal axis. More only if round-off is larger.
  double acceleration_limit = 0;
  double speed_limit = 0;  ///< 1e-6 of the speed that such loads give on a circle of the radius `length`, m/s
  /// Whether both are within their limits.
  bool is_still() const { return acceleration <= acceleration_limit && speed <= speed_limit; }
};

/// The linear equations of motion about a state. D and K are those in axes that rotate with `spin` (9.20).
struct LinearMotion : MechanismMatrices {
  Vec3 spin = Vec3::Zero();      ///< angular velocity of the axes, world, rad/s
  Unrest unrest;                 ///< residual motion of the state in them
  std::vector<Finding> notes{};  ///< quantities that were held or left out, by name
};

/// Linearises about a state, in space unless a plane was requested (System::InSpace). A spin that is not given is zero
/// for a mechanism at rest, else that of all bodies if they rotate alike, else the one with which the state is steady.
/// Bodies may then rotate about their symmetry axes. A state is steady if its accelerations in these axes are the same
/// a third of a revolution later.
///
/// Throws ModelError, unless `frozen`, for a state that is neither an equilibrium nor steady, with the body and its
/// acceleration. Throws it always, with the name, for user-defined differential equations, for states of joints other
/// than speeds of drives, and for active friction that depends on reactions.
LOCKSTEP_API LinearMotion linear_motion(Dynamics&, const State&, const LinearMotionOptions& = {});

// StateSpace: the same in minimal coordinates, with inputs and outputs.

/// A law to which a linearisation adds its input: law(t) + u. Use it as the law of a drive or a force.
class LOCKSTEP_API InputLaw final : public MotionLaw {
 public:
  /// Around this law; without one, around zero.
  explicit InputLaw(LawPtr<MotionLaw> law = {}) : law_(std::move(law)) {}
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Sets u and its rates, the same at all times. It is zero at first.
  void add(const LawValue& u) { u_ = u; }

 private:
  LawPtr<MotionLaw> law_;
  LawValue u_;
};

/// An input of a mechanism.
struct LinearInput {
  std::string name,               ///< of the column
      unit;                       ///< of u: "N", "rad"
  std::shared_ptr<InputLaw> law;  ///< in the drive or force; an input without effect is an error
};

/// A named signal.
struct Signal {
  std::string name,  ///< "rod.turn_z"
      unit;          ///< "rad"
};

/// x' = A x + B u,  y = C x + D u: deviations from a state.
///
/// States: for each degree of freedom one displacement of a body ("rod.move_x", m, of the centre of mass, world;
/// "rod.turn_z", rad, about an axis of the slot), then their rates. An input on a drive has three columns, u, u' and
/// u'' ("A.rz", "A.rz_d", "A.rz_dd"), for value, speed and acceleration; an input on a force has one. If the law of a
/// drive is its speed, the coordinate is an additional state at the end ("A.rz", rad), and the input has two columns, u
/// and u' ("A.rz", rad/s, and "A.rz_d").
struct StateSpace {
  std::vector<Signal> states,  ///< x
      inputs,                  ///< u
      outputs;                 ///< y
  MatX A,                      ///< x' by x
      B,                       ///< x' by u
      C,                       ///< y by x
      D;                       ///< y by u
  /// Largest difference between derivatives by central differences of sixth order with two steps. Of B: relative to the
  /// largest of the constraints of one kind, of the forces or of the moments by a value or rate of an input. Of C and
  /// D: relative to the largest of the same row. A has analytic derivatives, as far as forces and joints give them.
  double accuracy = 0;
  Vec3 spin = Vec3::Zero();      ///< as LinearMotion
  Unrest unrest;                 ///< as LinearMotion
  std::vector<Finding> notes{};  ///< as LinearMotion
};

/// Linearises with inputs and outputs. The outputs are channels of the same system, made before the state was computed.
/// Throws as linear_motion(). Throws ModelError for an input without effect, for an output that depends on an
/// integrated state (a work, a loss), and for a singular configuration.
LOCKSTEP_API StateSpace linearize(Dynamics&, const State&, const std::vector<LinearInput>&,
                                  const std::vector<Channel>& outputs, const LinearMotionOptions& = {});

}  // namespace lockstep
