// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <algorithm>

#include "framework/dynamics/evaluate/loop_rows.h"
#include "framework/dynamics/evaluate/projection_rule.h"

namespace lockstep {

ProjectReport Projection::project(Evaluation& e, Factor& factor, State& state, double goal) {
  ProjectReport report;
  normalize_state(state);
  if (e.covers(state) && e.rows().n_rows == 0) return report;
  zero_.setZero(state.v.size());
  const bool factored = positions(e, factor, state, goal, report);
  report.before_v = e.norm(Cd_);  // at the projected position
  report.after_v = velocities(e, factor, factored, state, 0.1 * goal);
  return report;
}

// d = -M^-1 Jh^T z, (S + E) z = C. Returns whether the factor is still good for the velocities.
bool Projection::positions(Evaluation& e, Factor& factor, State& state, double goal, ProjectReport& report) {
  PositionRounds rounds(goal, tolerance_);
  for (;;) {
    e.rows_at(state);
    e.check();
    e.residuals(C_, Cd_);
    const bool ends = rounds.ends(e.norm(C_), [&] { return e.loops().are_met(e.rows(), C_, e.inputs().motions); });
    if (rounds.round() == 0) report.before = rounds.residual();
    if (ends) break;
    C_ = -C_;
    if (!rounds.chord()) factor.compute(e);
    factor.solve(e, zero_, C_, d_, lambda_);
    advance_state(state, 1.0, d_);
  }
  report.after = rounds.residual();
  report.rounds = rounds.round();
  report.converged = rounds.converged();
  return rounds.chord();
}

double Projection::project_velocity(Evaluation& e, Factor& factor, State& state, double goal) {
  e.rows_at(state);
  e.check();
  e.residuals(C_, Cd_);
  zero_.setZero(state.v.size());
  return velocities(e, factor, false, state, goal);
}

// Starts from Cd_ at this state. One factor serves all rounds, since the pose, and so the Jacobians, do not change.
double Projection::velocities(const Evaluation& e, Factor& factor, bool factored, State& state, double goal) {
  d_.resize(state.v.size()),
      lambda_.resize(e.rows().n_rows);  // sized here, since the first round may come late in a run
  const auto met = [&] { return e.norm(Cd_) <= goal || e.loops().are_rates_met(e.rows(), Cd_, e.inputs().motions); };
  for (int round = 0; round < kVelocityRounds && !met(); ++round) {
    if (!factored) factor.compute(e);
    factored = true;
    Cd_ = -Cd_;
    factor.solve(e, zero_, Cd_, d_, lambda_);
    state.v += d_;
    e.velocity_residual(state.v, Cd_);
  }
  return e.norm(Cd_);
}

}  // namespace lockstep
