// SPDX-License-Identifier: BSD-3-Clause
// Statics: where a mechanism rests under its loads, and whether it stays there.
#pragma once

#include <string>
#include <vector>

#include <lockstep/finding.h>
#include <lockstep/state.h>

namespace lockstep {

class Dynamics;
class Evaluation;

/// A motion that the links leave free, at a position of rest.
struct FreeMotion {
  /// What holds it, 1/s^2: the square of its angular frequency without damping. Below zero it grows instead.
  double stiffness = 0;
  double bound = 0;  ///< stiffnesses of this motion of at most this size, 1/s^2, are zero: round-off of its own terms
  /// 6 per slot: m (world) and rad (slot axes). The largest of all moves, and turns times System::length(), is 1 m.
  VecX motion;
  std::string words;  ///< "'crank' turns about z, 'slider' moves along x"
};

/// What the free motions of a mechanism at rest do when they are disturbed.
struct Stability {
  /// The verdict.
  enum class Kind {
    stable,      ///< every free motion is held
    neutral,     ///< some are held by nothing, and the others are held
    unstable,    ///< at least one grows
    not_judged,  ///< too many unknowns for dense matrices
    gripped      ///< friction holds it, short of its limits: small disturbances move nothing
  };
  Kind kind = Kind::stable;  ///< the verdict
  int freedoms = 0;          ///< number of free motions
  double softest = 0;        ///< smallest stiffness, 1/s^2, that is not 0 within its bound: of what grows if anything does
  /// Whether the loads have a potential here. Without one (follower forces) an oscillation may grow too, and damping is
  /// not looked at.
  bool has_potential = true;
  std::vector<FreeMotion> unstable,  ///< those that grow, fastest first
      neutral;                       ///< those that nothing holds
};
/// "stable", "neutral", "unstable", "not judged", "gripped".
LOCKSTEP_API std::string to_string(Stability::Kind);

/// Judges a state at rest: eigenvalues of K against M in the null space of the rows, K with the geometric stiffness of
/// the links. One-sided links in force count as two-sided. `lambda`: 1 per row, at this evaluation. Zero is what
/// lies within 1e-12 of the terms of u^T K u by their size, for each motion u by itself; without a potential, within
/// 1e-14 of the norm of K too. In a plane it judges within it. It allocates, and is dense: up to 1200 unknowns.
LOCKSTEP_API Stability judge_rest(const Evaluation&, const VecX& lambda);

/// How an equilibrium is looked for.
struct EquilibriumOptions {
  /// Largest unbalanced force, relative to the largest force on a body (moments by System::length()).
  double tolerance = 1e-10;
  int iterations = 200;           ///< of Newton's method, at most
  int relaxation_steps = 20'000;  ///< of dynamic relaxation, at most
  /// Whether friction (Reacting::grips) may hold the state given; false: the equilibrium is one without friction.
  bool friction = true;
  bool nearest = false;           ///< takes what Newton's method meets first, stable or not; false: goes downhill
};

/// What friction carries at rest, and what it could.
struct GripReport {
  std::string force,   ///< its name
      what,            ///< "sliding", "turning"
      unit;            ///< "N", "N m"
  double carries = 0,  ///< the size of it
      most = 0;        ///< its limit
};

/// What was found, and how.
struct EquilibriumReport {
  bool by_friction = false;          ///< whether friction holds the state given, so that nothing moved
  bool relaxed = false;              ///< whether dynamic relaxation was needed
  int iterations = 0;                ///< of Newton's method
  int relaxation_steps = 0;          ///< of dynamic relaxation
  double unbalanced = 0;             ///< largest unbalanced force, relative as in the options
  double largest_force = 0;          ///< to which it is relative, N
  double largest_move = 0;           ///< of a mass centre since the state given, m
  std::string moved_most;            ///< its body; "" where none moved
  VecX lambda;                       ///< multipliers, 1 per row in force
  Stability stability;               ///< of what was found
  std::vector<std::string> left;     ///< unstable positions of rest that were met and left, by the motion that grew
  std::vector<std::string> pressed;  ///< one-sided links that carry load
  std::vector<std::string> free;     ///< one-sided links that are free
  /// What friction carries in the state given, where it holds that state (`by_friction`), or would have to carry there,
  /// where it does not; empty where none has a part in it.
  std::vector<GripReport> grips;
  std::vector<Finding> notes;  ///< what of the scene does not act as in a run
  /// How it was found, in words: "Newton's method, 7 iterations".
  LOCKSTEP_API std::string method() const;
};

/// Moves a state into equilibrium, at its time: forces and laws have their values there, drives hold their coordinates,
/// friction holds the state given if it can (then nothing moves), and none acts elsewhere,
/// velocities of bodies are zero (a marker that moves by a law keeps its rate, and is noted), integrated states keep their values. Newton's method on rows and forces with a line search,
/// downhill: up to 400 unknowns in the free motions, against each stiffness by its size; beyond with the sparse matrix
/// K + s M, s as large as it takes. Where that fails, dynamic relaxation. One-sided links come
/// into force where they are touched and are released where they would pull. A system whose plane is known
/// (System::InSpace) is looked at in space; it is planar again afterwards, unless what is found lies outside of the plane.
/// The state, in the slots' own coordinates, must fit its rows nearly (assemble()). Throws SolveError where nothing is found, naming what nothing holds, and what
/// an evaluation throws; the state is then unchanged.
LOCKSTEP_API EquilibriumReport find_equilibrium(Dynamics&, State&, const EquilibriumOptions& options = {});

// Several equilibria of one mechanism.

/// An equilibrium, and how many starts led to it.
struct Equilibrium {
  State state;               ///< in the slots' own coordinates, at rest
  EquilibriumReport report;  ///< of its first search
  int found = 0;             ///< number of starts
};

/// What was found from many starts.
struct EquilibriaReport {
  int starts = 0,                ///< tried, the one given included
      failed = 0;                ///< that led nowhere
  std::vector<Equilibrium> all;  ///< stable ones first
};

/// How several equilibria are looked for.
struct EquilibriaOptions {
  int starts = 100;    ///< random ones
  unsigned seed = 1;   ///< of their numbers
  double same = 1e-6;  ///< poses nearer to one another than this share of System::length() are one
};

/// Looks for equilibria downhill from this state, then from random poses that fit the rows, by turns as
/// EquilibriumOptions::nearest, which finds unstable ones too, and downhill. All of them are without friction. Where a motion is held by nothing, the
/// positions along it count as one: those of the same softest stiffness and largest force that are the same in all that
/// is held. Throws as find_equilibrium() does for the state given.
LOCKSTEP_API EquilibriaReport find_equilibria(Dynamics&, const State&, const EquilibriaOptions& options = {});

}  // namespace lockstep
