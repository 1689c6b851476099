// SPDX-License-Identifier: BSD-3-Clause
// Accounts: the loads on a body, the constraints of a joint and the values of laws at one state; the equations of one
// joint.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>

namespace lockstep {

class Dynamics;
class Force;

/// A force and a moment on a body, and their source.
struct Contribution {
  std::string what;           ///< "gravity", "force 'spring'", "joint 'A'", "drive A.rz"
  Vec3 force = Vec3::Zero(),  ///< world axes, N
      moment = Vec3::Zero();  ///< about the centre of mass, world axes, N m
};

/// The balance of forces and momentum of a body. Bodies that are welded into one have one balance.
struct BodyBalance {
  std::string body;                 ///< its name; of welded ones "a + b"
  double mass = 0;                  ///< kg
  Vec3 center = Vec3::Zero(),       ///< centre of mass, world, m
      acceleration = Vec3::Zero();  ///< of the centre of mass, world, m/s^2
  std::vector<Contribution> parts;  ///< in the order: gravity, forces, joints
  Contribution sum;                 ///< of the parts
  Contribution rate;                ///< of momentum, m a, and of angular momentum about the centre of mass
  double left_force = 0,            ///< |sum - rate|, N; round-off, unless a force or joint is wrong
      left_moment = 0;              ///< the same of the moments, N m
  std::string incomplete;           ///< which loads are not computed, in a plane; "" if none
};

/// The balance of a body at a state in the slots' own coordinates. Throws ModelError for a body that does not move, and
/// what Dynamics::evaluate throws.
LOCKSTEP_API BodyBalance balance_of(Dynamics&, const State&, const Body&);

/// The values of a law at one time.
struct LawAccount {
  std::string what;           ///< "drive rz", "translation of marker 'tool'"
  std::string unit;           ///< of the values: "m", "rad", "m/s", "rad/s"; "" for a quaternion
  std::vector<double> value,  ///< one number, three, or a quaternion
      rate,                   ///< first derivative; of a rotation the angular velocity, own axes, rad/s
      second;                 ///< second derivative; of a rotation the angular acceleration, own axes, rad/s^2
};

/// A constraint of a joint at a state.
struct RowAccount {
  std::string name;       ///< "x", "e1"
  RowKind kind;           ///< its quantity
  double value = 0,       ///< C: m, a component of the error quaternion, or of a function
      rate = 0,           ///< Jh v + Ct
      multiplier = 0;     ///< of a translation minus the force, of a rotation minus twice the moment
  bool is_drive = false;  ///< whether it belongs to a drive
  LinkWrench on_p;        ///< its load on p's body about P, axes of S
};

/// The account of a joint at a state.
struct LinkAccount {
  std::string name,                      ///< of the joint
      type,                              ///< of the joint
      on_p,                              ///< body of P in its first pair
      on_s;                              ///< body of S in its first pair
  bool in_force = true;                  ///< whether it is active; otherwise, and if open, it has no constraints
  bool merged = false;                   ///< whether its bodies were welded into one, so that it has no constraints
  std::vector<Vec3> axes;                ///< x, y and z of S, world; empty without markers
  std::vector<RowAccount> rows;          ///< its constraints, if it is active
  std::vector<std::string> left_out;     ///< names of constraints that were left out (System::leave_out)
  LinkWrench joint,                      ///< on p's body about P, without drives
      drives;                            ///< of all drives
  std::string incomplete;                ///< which loads are not computed, in a plane; "" if none
  std::vector<LawAccount> laws;          ///< drives, imposed motion, and the laws of its markers
  std::vector<Dependency> dependencies;  ///< groups of dependent constraints that include some of this object
};

/// The account of a joint at a state in the slots' own coordinates. Throws what Dynamics::evaluate throws.
LOCKSTEP_API LinkAccount account_of(Dynamics&, const State&, const Lock&);

/// The equations of one joint at a state, one entry per constraint. In velocities: J v + Ct = 0 and J a = Qc, with v
/// and a of each slot, translation (world) and rotation (axes of the slot). In seven coordinates per body: Cq qd + Ct =
/// 0 and Cq qdd = Qc, with unit quaternions.
struct LinkEquations {
  std::vector<std::string> rows;   ///< "A.x", "A.e1": of drives too
  std::vector<std::string> slots;  ///< moving bodies, in the order of the columns: a name, of welded ones "a + b"
  VecX C;                          ///< value: m, a component of the error quaternion, or of a function
  VecX Ct;                         ///< its partial derivative in time
  VecX Qc;                         ///< right-hand side of J a = Qc
  MatX J;                          ///< 6 columns per slot: x y z, rotations about x y z
  MatX Cq;                         ///< 7 columns per slot: x y z, and the quaternion, scalar first
};

/// The equations of a joint at a state in the slots' own coordinates: in space, of this joint alone, also if it is not
/// active, and with constraints that were left out. Throws ModelError for a merged joint, and what the code of the
/// joint throws.
LOCKSTEP_API LinkEquations equations_of(Dynamics&, const State&, const Lock&);

/// The account of a force at a state.
struct ForceEffect {
  std::string name,              ///< of the force
      type;                      ///< of the force
  bool acts = true;              ///< whether it is active
  std::vector<Contribution> on;  ///< its load on each body: `what` is the body's name, of welded ones "a + b"
  std::vector<LawAccount> laws;  ///< its laws, and those of its markers
  double potential = 0,          ///< J
      dissipation = 0,           ///< by dampers and friction, W
      supply = 0;                ///< by laws and motors, W
};

/// The account of a force at a state in the slots' own coordinates. Throws what Dynamics::evaluate throws.
LOCKSTEP_API ForceEffect account_of(Dynamics&, const State&, const Force&);

}  // namespace lockstep
