// SPDX-License-Identifier: BSD-3-Clause
// Linearization: the matrices of a mechanism at a state, its equations of motion for small deviations, and the same in
// minimal coordinates with inputs and outputs.
//
//   M dx'' + D dx' + K dx + J^T dlambda = 0,   J dx = 0        theory, section 9.4
//
// dx: per slot a translation of the mass centre, m, and a turn, rad, in slot axes.
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

// MechanismMatrices: what the equations of motion of one state are made of.

/// An unknown velocity: a column of J, a row and a column of M, D and K.
struct UnknownVelocity {
  std::string name,  ///< "rod.vx": body, and vx vy vz (world, mass centre) or wx wy wz (slot axes)
      unit;          ///< "m/s" or "rad/s"
  int slot = 0,      ///< the slot that moves
      velocity = 0;  ///< which of its six velocities
};

/// The matrices of a mechanism at one state. Rows and columns are the unknown velocities, slot by slot; rows of J are
/// those of the links in force.
struct MechanismMatrices {
  std::vector<UnknownVelocity> unknowns;  ///< names of the unknown velocities
  std::vector<std::string> rows;          ///< names of the constraint rows: "A.x"
  std::vector<RowKind> kinds;             ///< what they measure
  SparseMat M,                            ///< masses, kg, and inertias, kg m^2
      D,                                  ///< d(inertia - forces)/dv: dampers and gyroscopic terms
      K,          ///< d(inertia + J^T lambda - forces)/dx: springs, loads, and the geometric stiffness of constraints
      J;          ///< jacobian of the constraints
  VecX v,         ///< velocities at the state
      f,          ///< gravity, -w x J w and all forces: the right side of M a + J^T lambda = f
      c,          ///< the right side of J a = c
      C,          ///< residuals of the rows
      Ct,         ///< their partial derivatives in time
      a,          ///< the solution: accelerations
      lambda;     ///< and multipliers
  double length = 1;  ///< System::length(), m, by which turns are compared with translations
  /// What unrest is measured by, with all terms by their size, so that it stays where they cancel; of each slot:
  VecX loads,   ///< its forces over its mass, m/s^2
      levers,   ///< acceleration of its mass centre that moments other than reactions can give it on an arm, m/s^2
      moments;  ///< three: the moments about its mass centre, slot axes, N m
};

/// Evaluates a mechanism at a state and writes its matrices. Friction in joints enters f at the solution. Throws what
/// Dynamics::evaluate throws.
LOCKSTEP_API MechanismMatrices matrices_at(Dynamics&, const State&);

// LinearMotion: small deviations from an equilibrium, a steady rotation, or, where that is asked for, any motion.

/// In which axes deviations are seen, and whether a state that is no equilibrium is taken.
struct LinearMotionOptions {
  /// Angular velocity of the axes that turn with the mechanism, world, rad/s. Default: found from the state.
  std::optional<Vec3> spin{};
  /// Takes the coefficients of this instant where the state is neither an equilibrium nor a steady rotation.
  bool frozen = false;
};

/// How far a state is from an equilibrium, or from a steady rotation, in the axes that turn with it.
struct Unrest {
  double acceleration = 0,  ///< the largest of a slot against its limit, m/s^2; angular ones times `length`
      speed = 0;            ///< the largest of a slot against its limit, m/s
  std::string accelerates,  ///< the body of that acceleration; "" where there is none
      moves;                ///< the body of that speed
  /// 1e-6 of that body's loads and levers (MechanismMatrices), m/s^2; for an angular acceleration also of its moment over
  /// its inertia about the same principal axis. More only where round-off leaves more.
  double acceleration_limit = 0;
  double speed_limit = 0;  ///< 1e-6 of the speed that such loads give on a circle of the radius `length`, m/s
  /// Whether both are within their limits.
  bool is_still() const { return acceleration <= acceleration_limit && speed <= speed_limit; }
};

/// The linear equations of motion about a state. D and K are those in axes that turn with `spin` (9.20).
struct LinearMotion : MechanismMatrices {
  Vec3 spin = Vec3::Zero();          ///< angular velocity of the axes, world, rad/s
  Unrest unrest;                     ///< how still the state is in them
  std::vector<Finding> notes{};      ///< what was held or left out, by name
};

/// Linearises about a state, in space unless a plane was asked for (System::InSpace). A spin that is not given is zero where the mechanism rests, else that of all bodies if
/// they turn alike, else the one with which the state is steady, bodies turning on about their axes of symmetry; steady
/// is what has the same accelerations, seen from these axes, also a third of a turn later.
///
/// Throws ModelError, unless `frozen`, for a state that is neither an equilibrium nor steady, with the body and its
/// acceleration; always for what linear equations in these unknowns cannot hold, by name: differential equations of the
/// user's own, states of links that are no speeds of drives, and friction that acts while it depends on reactions.
LOCKSTEP_API LinearMotion linear_motion(Dynamics&, const State&, const LinearMotionOptions& = {});

// StateSpace: the same in minimal coordinates, with inputs and outputs.

/// A law to which a linearisation adds its input: law(t) + u. Put it in place of the law of a drive or a force.
class LOCKSTEP_API InputLaw final : public MotionLaw {
 public:
  /// Around this law; without one, around zero.
  explicit InputLaw(LawPtr<MotionLaw> law = {}) : law_(std::move(law)) {}
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Sets what is added from now on: u and its rates, the same at all times. It is zero at first.
  void add(const LawValue& u) { u_ = u; }

 private:
  LawPtr<MotionLaw> law_;
  LawValue u_;
};

/// An input of a mechanism.
struct LinearInput {
  std::string name,               ///< of the column
      unit;                       ///< of u: "N", "rad"
  std::shared_ptr<InputLaw> law;  ///< in the drive or force; an input that changes nothing is refused
};

/// A named signal.
struct Signal {
  std::string name,  ///< "rod.turn_z"
      unit;          ///< "rad"
};

/// x' = A x + B u,  y = C x + D u: deviations from a state.
///
/// States: for each freedom one displacement of a body ("rod.move_x", m, of the mass centre, world; "rod.turn_z", rad,
/// about an axis of the slot), then their rates. An input on a drive has three columns, u, u' and u'' ("A.rz", "A.rz_d",
/// "A.rz_dd"), as its value, speed and acceleration enter by themselves; an input on a force has one. Where the law of a
/// drive is its speed, the coordinate is one state more, the last ones ("A.rz", rad), and the input has two columns, u and
/// u' ("A.rz", rad/s, and "A.rz_d").
struct StateSpace {
  std::vector<Signal> states,  ///< x
      inputs,                  ///< u
      outputs;                 ///< y
  MatX A,                      ///< x' by x
      B,                       ///< x' by u
      C,                       ///< y by x
      D;                       ///< y by u
  /// Largest difference between derivatives by central differences of sixth order with two steps: of B, relative to the
  /// largest of the rows of one kind, of the forces or of the moments that a value or rate of an input gives; of C and D,
  /// to the largest of the same row. A has analytic derivatives, as far as forces and links give them.
  double accuracy = 0;
  Vec3 spin = Vec3::Zero();          ///< as LinearMotion
  Unrest unrest;                     ///< as LinearMotion
  std::vector<Finding> notes{};      ///< as LinearMotion
};

/// Linearises with inputs and outputs. The outputs are channels of the same system, made before the state was taken.
/// Throws as linear_motion(); ModelError for an input without effect, for an output that depends on an integrated state
/// (a work, a loss), and for a pose in which rows become dependent that are not so elsewhere.
LOCKSTEP_API StateSpace linearize(Dynamics&, const State&, const std::vector<LinearInput>&,
                                  const std::vector<Channel>& outputs, const LinearMotionOptions& = {});

}  // namespace lockstep
