// SPDX-License-Identifier: BSD-3-Clause
// What a Dynamics keeps for joint coordinates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/dynamics/evaluate/loop_rows.h"
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/dynamics/tree/tree_reactions.h"
#include "framework/dynamics/tree/tree_recursion.h"

namespace lockstep {

// Joint coordinates: the tree of the links that were in force last, the recursion on it, and the rows that close loops.
struct Dynamics::Tree {
  long revision = -1;  // of the system, and the links, that the tree was made for
  std::vector<bool> modes;
  std::shared_ptr<const JointTree> coordinates;  // null: there is no tree
  std::string why_not;
  std::unique_ptr<TreeRecursion> recursion;
  std::vector<Motion> motions;
  VecX f, a, none;
  struct AxisInBoth {
    std::size_t angle;  // its number among the counted ones
    int slot, other;
    Vec3 a, b;                     // the axis in the axes of the slot and of the other
    int q = -1, v = -1;            // of the angle and of its rate where both are joined by a hinge of the tree:
    double sign = 1, at_zero = 0;  // sign q + at_zero
  };
  std::vector<AxisInBoth> turns;            // of counted angles whose axis is fixed in both slots
  std::size_t n_angles = 0;                 // all counted ones; 0 where none is such
  std::vector<double> angles, angle_rates;  // of a stage
  RowTable rows;                            // of the links whose multipliers are read, and of those with laws
  bool solves = false;                      // integrated states read accelerations or multipliers,
  bool reads_all = false;                   // not only those of links with laws,
  bool reads_power = false;                 // or the power of laws alone
  TreeReactions reactions;
  RowTable closure_rows;
  LoopSizes loops;  // that they close
  VecX C, Cd, correction, loaded;
  State before;                // a projection
  bool velocities_met = true;  // the last projection brought them onto J v = -Ct, up to rounding

  bool multipliers_known = true;  // those of the closures, by the last evaluation: not where redundant rows differ

  // Itself; throws ModelError if the state has other joint coordinates.
  Tree& of(const State&);
  ClosureRows& closures() { return recursion->closures(); }
  // If it `keeps` them, the last inputs and what the recursion knows are of the motions of this state, which is often the
  // next one to be evaluated. They depend on t, q, v and s alone if no law reads what a host sets.
  bool keeps = false;
  State kept;
  void keep(const State& y) { kept.t = y.t, kept.q = y.q, kept.v = y.v, kept.s = y.s, keeps = true; }
  void outward(const State&, std::vector<Motion>& out);
  void outward_once(const State&, const Inputs& of_kept);

  // The state, and the motions as found last.
  Inputs inputs(const State&);
  // Angles that are known by coordinates, and rates of angles, at the motions of `in`.
  void read_angles(const State&, Inputs& in, std::vector<double>& values, std::vector<double>& rates) const;
  // Of all counted angles, and of one.
  void find_turns(const System&);
  void find_turn(const CountedAngle&, const CountedAngle::Turn&);
  // The pivots of the closures at a state.
  void pivots(System&, const State&, SolveReport&);
  // Their rows, one a column, in the coordinates of the state.
  MatX rows_transposed(System&, const State&);
  // |C| of the closures, as Evaluation::norm measures it; not finite where something is not.
  double violation(System&, const State&);
  // Brings a state onto C = 0 and J v = -Ct of the closures by the least move in the mass metric, as Projection does.
  ProjectReport project(System&, State&, double goal, double tolerance);
  // The velocities alone; returns what is left, m/s.
  double project_velocity(System&, State&, double goal);

 private:
  void gather(System&, const State&);
  void factor(const State&);
  double velocities(State&, bool factored, double goal);
};

}  // namespace lockstep
