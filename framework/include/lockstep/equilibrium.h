// SPDX-License-Identifier: BSD-3-Clause
// Statics: the equilibrium of a mechanism under its loads, and its stability.
#pragma once

#include <string>
#include <vector>

#include <lockstep/finding.h>
#include <lockstep/state.h>

namespace lockstep {

class Dynamics;
class Evaluation;

/// A motion that the joints leave free, at a position of rest.
struct FreeMotion {
  /// Stiffness over mass, 1/s^2: the square of its angular frequency without damping. Below zero the motion grows.
  double stiffness = 0;
  double bound = 0;  ///< stiffnesses up to this size, 1/s^2, count as zero: round-off of the terms of this motion
  /// 6 per slot: m (world) and rad (slot axes). The largest displacement, or rotation times System::length(), is 1 m.
  VecX motion;
  std::string words;  ///< "'crank' rotates about z, 'slider' moves along x"
};

/// The stability of a mechanism at rest.
struct Stability {
  /// The verdict.
  enum class Kind {
    stable,      ///< every free motion has a positive stiffness
    neutral,     ///< some have no stiffness, and the others a positive one
    unstable,    ///< at least one grows
    not_judged,  ///< too many unknowns for dense matrices
    gripped      ///< static friction holds it below its limits: small disturbances move nothing
  };
  Kind kind = Kind::stable;  ///< the verdict
  int freedoms = 0;          ///< number of free motions
  double softest = 0;        ///< lowest stiffness, 1/s^2, that is not 0 within its bound; negative if a motion grows
  /// Whether the loads have a potential here. Without one (follower forces) an oscillation may grow too, and damping is
  /// not examined.
  bool has_potential = true;
  std::vector<FreeMotion> unstable{},  ///< those that grow, fastest first
      neutral{};                       ///< those without stiffness
};
/// "stable", "neutral", "unstable", "not judged", "sticking".
LOCKSTEP_API std::string to_string(Stability::Kind);

/// Judges a state at rest by the eigenvalues of K against M in the null space of the constraints. K includes the
/// geometric stiffness of the joints. Active one-sided joints count as two-sided. `lambda`: 1 per constraint, at this
/// evaluation. Values within 1e-12 of the terms of u^T K u by their size count as zero, for each motion u; without a
/// potential, within 1e-14 of the norm of K too. A planar system is judged in its plane. It allocates, and is dense: up
/// to 1200 unknowns.
LOCKSTEP_API Stability judge_rest(const Evaluation&, const VecX& lambda);

/// Options of the search for an equilibrium.
struct EquilibriumOptions {
  /// Largest unbalanced force, relative to the largest force on a body (moments over System::length()).
  double tolerance = 1e-10;
  int iterations = 200;           ///< of Newton's method, at most
  int relaxation_steps = 20'000;  ///< of dynamic relaxation, at most
  /// Whether friction (`Reacting::grips`) may hold the given state; false: the equilibrium without friction.
  bool friction = true;
  bool nearest = false;  ///< accepts the first equilibrium found, stable or not; false: a stable one
};

/// The load of static friction at rest, and its limit.
struct GripReport {
  std::string force,   ///< its name
      what,            ///< "sliding", "turning"
      unit;            ///< "N", "N m"
  double carries = 0,  ///< the size of the load
      most = 0;        ///< its limit
};

/// An equilibrium, and how it was found.
struct EquilibriumReport {
  bool by_friction = false;          ///< whether friction holds the given state, so that nothing moved
  bool relaxed = false;              ///< whether dynamic relaxation was needed
  int iterations = 0;                ///< of Newton's method
  int relaxation_steps = 0;          ///< of dynamic relaxation
  double unbalanced = 0;             ///< largest unbalanced force, relative to `largest_force`
  double largest_force = 0;          ///< N
  double largest_move = 0;           ///< of a centre of mass from the given state, m
  std::string moved_most;            ///< its body; "" if none moved
  double energy = 0;                 ///< potential energy, J
  VecX lambda;                       ///< multipliers, 1 per active constraint
  Stability stability;               ///< of the equilibrium
  /// Whether constraints nearly lose rank there, within 1e-3: reactions may grow without bound. Not found beyond 300
  /// constraints.
  bool singular = false;
  std::vector<std::string> left;     ///< unstable equilibria that were found and left, by the motion that grew
  std::vector<std::string> pressed;  ///< one-sided joints that carry load
  std::vector<std::string> free;     ///< one-sided joints that are free
  /// The loads of static friction at the given state if it holds that state (`by_friction`), else those that it would
  /// need; empty without friction.
  std::vector<GripReport> grips;
  std::vector<Finding> notes;  ///< parts of the scene that act otherwise than in a run
  /// How it was found, in words: "Newton's method, 7 iterations".
  LOCKSTEP_API std::string method() const;
};

/// Moves a state into equilibrium, at its time. Forces and laws have their values at that time, drives hold their
/// coordinates, velocities of bodies are zero, integrated states keep their values. A marker that moves by a law keeps
/// its rate, and is noted. Friction holds the given state if it can, and then nothing moves; otherwise it does not act.
/// The method is Newton's on constraints and forces, with a line search that reduces the potential energy. Up to 400
/// unknowns it uses the free motions and the size of each stiffness; beyond, the sparse matrix K + s M with a
/// sufficient s. If that fails, dynamic relaxation follows. One-sided joints close on contact and open when they would
/// pull. A system with a plane (System::InSpace) is solved in space; it is planar again afterwards, unless the
/// equilibrium leaves the plane. The state, in the slots' own coordinates, must nearly satisfy its constraints
/// (assemble()). Throws SolveError, naming motions without stiffness, if nothing is found, and what an evaluation
/// throws. The state is then unchanged.
LOCKSTEP_API EquilibriumReport find_equilibrium(Dynamics&, State&, const EquilibriumOptions& options = {});

// Several equilibria of one mechanism.

/// An equilibrium, and the number of starts that led to it.
struct Equilibrium {
  State state;               ///< in the slots' own coordinates, at rest
  EquilibriumReport report;  ///< of its first search
  int found = 0;             ///< number of starts
};

/// The equilibria found from many starts.
struct EquilibriaReport {
  int starts = 0,                ///< all of them, the given one included
      failed = 0,                ///< those without an equilibrium,
      unassembled = 0;           ///< of these, those that could not be assembled
  std::vector<Equilibrium> all;  ///< stable ones first, those near a singular configuration last
};

/// Options of the search for several equilibria.
struct EquilibriaOptions {
  int starts = 100;    ///< random ones
  unsigned seed = 1;   ///< of the random numbers
  /// Poses closer than this share of System::length() are the same; near a singular configuration, within 2e-3.
  double same = 1e-6;
};

/// Searches a stable equilibrium from this state, then from random assembled poses, alternately with and without
/// EquilibriumOptions::nearest, which finds unstable ones too. All of them are without friction. Positions along a
/// motion without stiffness count as one equilibrium: they have the same potential energy, and the same pose in all
/// other motions. Moves count from the given state. Throws as find_equilibrium() does for the given state.
LOCKSTEP_API EquilibriaReport find_equilibria(Dynamics&, const State&, const EquilibriaOptions& options = {});

}  // namespace lockstep
