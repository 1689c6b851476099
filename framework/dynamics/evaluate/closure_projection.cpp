// SPDX-License-Identifier: BSD-3-Clause
// The projection in joint coordinates: onto the rows that close loops (framework/docs/solvers.md, sections 6 and 9).
#include <algorithm>

#include "framework/dynamics/evaluate/joint_coordinates.h"
#include "framework/dynamics/evaluate/projection_rule.h"

namespace lockstep {

void Dynamics::Tree::gather(System& system, const State& state) {
  motions.resize(system.n_slots() + 1);
  coordinates->motions(state, motions);
  passes::gather_rows(system, inputs(state), closure_rows);
  find_residuals(closure_rows, motions, C, Cd);
}

double Dynamics::Tree::violation(System& system, const State& state) {
  gather(system, state);
  return closures().norm(C);
}

// The recursion at the state whose rows were gathered last. The accelerations that come with it are of no interest.
void Dynamics::Tree::factor(const State& state) {
  outward(state, motions);
  recursion->read(motions, closure_rows);
  f.setZero();
  recursion->accelerate(motions, f, correction);
}

void Dynamics::Tree::pivots(System& system, const State& state, SolveReport& report) {
  gather(system, state);
  factor(state);
  closures().complete(report);
}

// J v + Ct, coordinate by coordinate.
MatX Dynamics::Tree::rows_transposed(System& system, const State& state) {
  State moved = state;
  moved.v.setZero();
  gather(system, moved);
  const VecX Ct = Cd;
  MatX Jt(moved.v.size(), closure_rows.n_rows);
  for (Eigen::Index i = 0; i < moved.v.size(); ++i) {
    moved.v[i] = 1;
    coordinates->motions(moved, motions);
    find_residuals(closure_rows, motions, C, Cd);
    Jt.row(i) = Cd - Ct;
    moved.v[i] = 0;
  }
  return Jt;
}

// H d + (J T)' z = 0,  J T d = -C,  q <- q (+) d
ProjectReport Dynamics::Tree::project(System& system, State& state, double goal, double tolerance) {
  ProjectReport report;
  coordinates->normalize(state);
  gather(system, state);
  PositionRounds rounds(goal, tolerance);
  for (;; gather(system, state)) {
    const bool ends = rounds.ends(closures().norm(C), [&] { return loops.are_met(closure_rows, C, motions); });
    if (rounds.round() == 0) report.before = rounds.residual();
    if (ends) break;
    if (!rounds.chord()) factor(state);
    recursion->correct(C, correction);
    coordinates->advance(state, 1.0, correction);
    coordinates->normalize(state);
  }
  report.after = rounds.residual(), report.rounds = rounds.round(), report.converged = rounds.converged();
  report.before_v = closures().norm(Cd);
  report.after_v = velocities(state, rounds.chord(), 0.1 * goal);
  return report;
}

double Dynamics::Tree::project_velocity(System& system, State& state, double goal) {
  gather(system, state);
  return velocities(state, false, goal);
}

// Starts from Cd at this state. A factor of a position before serves while each round leaves a tenth at most; with one of
// this position the proximal term alone leaves something.
double Dynamics::Tree::velocities(State& state, bool factored, double goal) {
  const auto met = [&](double left) { return left <= goal || loops.are_rates_met(closure_rows, Cd, motions); };
  const double first = closures().norm(Cd);
  double left = first;
  bool old = factored;
  for (int round = 0; !met(left) && round < kTreeVelocityRounds; ++round) {
    if (!factored) factor(state), factored = true;
    recursion->correct(Cd, correction);
    state.v += correction;
    coordinates->motions(state, motions);
    find_residuals(closure_rows, motions, C, Cd);
    const double last = left;
    left = closures().norm(Cd);
    if (old && !(left <= 0.1 * last))
      factored = old = false;
    else if (!(left < kStalledRows * last))
      break;
  }
  velocities_met = met(left) || left <= kVelocitiesMet * first;
  return left;
}

}  // namespace lockstep
