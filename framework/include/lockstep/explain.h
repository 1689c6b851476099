// SPDX-License-Identifier: BSD-3-Clause
// Accounts: what acts on a body, what a link does, what laws give, at one state; the equations of one link.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>

namespace lockstep {

class Dynamics;
class Force;

/// A force and a moment on a body, and what exerts them.
struct Contribution {
  std::string what;           ///< "gravity", "force 'spring'", "link 'A'", "drive A.rz"
  Vec3 force = Vec3::Zero(),  ///< world axes, N
      moment = Vec3::Zero();  ///< about the mass centre, world axes, N m
};

/// All that acts on a body, and what it makes of it. Bodies that are welded into one have one balance.
struct BodyBalance {
  std::string body;                 ///< its name; of welded ones "a + b"
  double mass = 0;                  ///< kg
  Vec3 center = Vec3::Zero(),       ///< mass centre, world, m
      acceleration = Vec3::Zero();  ///< of the mass centre, world, m/s^2
  std::vector<Contribution> parts;  ///< in the order: gravity, forces, links
  Contribution sum;                 ///< of the parts
  Contribution rate;                ///< of momentum, m a, and of angular momentum about the mass centre
  double left_force = 0,            ///< |sum - rate|, N; of rounding, unless a force or link is wrong
      left_moment = 0;              ///< and of the moments, N m
  std::string incomplete;           ///< why moments are left out, in a plane; "" where they are not
};

/// The balance of a body at a state in the slots' own coordinates. Throws ModelError for a body that does not move, and
/// what Dynamics::evaluate throws.
LOCKSTEP_API BodyBalance balance_of(Dynamics&, const State&, const Body&);

/// What a law gives at an instant.
struct LawAccount {
  std::string what;           ///< "drive rz", "translation of marker 'tool'"
  std::string unit;           ///< of the values: "m", "rad", "m/s", "rad/s"; "" for a quaternion
  std::vector<double> value,  ///< one number, three, or a quaternion
      rate,                   ///< first derivative; of a rotation the angular velocity, own axes, rad/s
      second;                 ///< second derivative; of a rotation the angular acceleration, own axes, rad/s^2
};

/// A row of a link at a state.
struct RowAccount {
  std::string name;       ///< "x", "e1"
  RowKind kind;           ///< what it measures
  double value = 0,       ///< C: m, a component of the error quaternion, or of a function
      rate = 0,           ///< Jh v + Ct
      multiplier = 0;     ///< N, twice N m, or of a function
  bool is_drive = false;  ///< whether it belongs to a drive
};

/// What a link does at a state.
struct LinkAccount {
  std::string name,                      ///< of the link
      type,                              ///< of the link
      on_p,                              ///< body of P in its first pair
      on_s;                              ///< body of S in its first pair
  bool in_force = true;                  ///< whether it acts; without rows otherwise
  bool merged = false;                   ///< whether its bodies were welded into one, so that it has no rows
  std::vector<RowAccount> rows;          ///< of the link in force
  std::vector<std::string> left_out;     ///< names of rows that were left out (System::leave_out), and hold nothing
  LinkWrench joint,                      ///< on p's body about P, drives left out
      drives;                            ///< of all drives
  std::vector<LawAccount> laws;          ///< drives, imposed motion, and the laws of its markers
  std::vector<Dependency> dependencies;  ///< sets of dependent rows that it takes part in
};

/// The account of a link at a state in the slots' own coordinates. Throws what Dynamics::evaluate throws.
LOCKSTEP_API LinkAccount account_of(Dynamics&, const State&, const Lock&);

/// The equations of one link at a state, one of each for a row. As velocities have them: J v + Ct = 0 and J a = Qc, with
/// v and a of each slot, translation (world) and turn (axes of the slot). In seven coordinates a body: Cq qd + Ct = 0 and
/// Cq qdd = Qc, with quaternions of length 1.
struct LinkEquations {
  std::vector<std::string> rows;   ///< "A.x", "A.e1": of drives too
  std::vector<std::string> slots;  ///< what moves, in the order of the columns: a body's name, of welded ones "a + b"
  VecX C;                          ///< value: m, a component of the error quaternion, or of a function
  VecX Ct;                         ///< its partial derivative in time
  VecX Qc;                         ///< what its second derivative has beside J a, with the sign turned
  MatX J;                          ///< 6 columns per slot: x y z, turns about x y z
  MatX Cq;                         ///< 7 columns per slot: x y z, and the quaternion, scalar first
};

/// The equations of a link at a state in the slots' own coordinates: in space, and of the link alone, so that of links
/// that are not in force too, and with rows that were left out. Throws ModelError for a link that was merged, and what the
/// code of the link throws.
LOCKSTEP_API LinkEquations equations_of(Dynamics&, const State&, const Lock&);

/// What a force does at a state.
struct ForceEffect {
  std::string name,              ///< of the force
      type;                      ///< of the force
  bool acts = true;              ///< whether it is switched on
  std::vector<Contribution> on;  ///< what it exerts, on each body: `what` is the body's name, of welded ones "a + b"
  std::vector<LawAccount> laws;  ///< its laws, and those of its markers
  double potential = 0,          ///< J
      dissipation = 0,           ///< W
      supply = 0;                ///< by laws and motors, W
};

/// The account of a force at a state in the slots' own coordinates. Throws what Dynamics::evaluate throws.
LOCKSTEP_API ForceEffect account_of(Dynamics&, const State&, const Force&);

}  // namespace lockstep
