// Projection of a state onto the constraints: least move in the mass metric, positions first, then velocities.
#include <algorithm>

#include "framework/dynamics/evaluate/dynamics.h"
#include "framework/dynamics/evaluate/projection_rule.h"

namespace lockstep {
/// (S + E) z = C, d = M^-1 Jh^T z, q <- q (-) d, which is the solution of M d + Jh^T z = 0, Jh d = -C. One factor
/// serves all rounds while it is good enough (chord). Stops at the goal, not below round-off of the largest position.
void Dynamics::project_position(State& state, double goal, ProjectReport& report) {
  double x_max = 0;
  for (int k = 0; k < system_.n_slots(); ++k)
    x_max = std::max(x_max, state.q.segment<3>(7 * k).lpNorm<Eigen::Infinity>());
  PositionRounds rounds(goal, options_.stabilization.tolerance, system_.length(), x_max);
  for (;;) {
    gather(state);
    residuals(C_, Cd_);
    const bool ends = rounds.ends(norm(C_));
    if (rounds.round() == 0) report.before = rounds.residual();
    factored_ = rounds.chord();
    if (ends) break;
    C_ = -C_;
    solve(zero_, C_, d_, lambda_);
    move(state, d_);
  }
  report.after = rounds.residual();
  report.rounds = rounds.round();
  report.converged = rounds.converged();
}

ProjectReport Dynamics::project(State& state) { return project(state, 1e-2 * options_.stabilization.tolerance); }

ProjectReport Dynamics::project(State& state, double goal) {
  ProjectReport report;
  normalize(state);
  prepare(state);
  if (rows_.n_rows == 0) return report;
  ++work_.projections;
  project_position(state, goal, report);
  report.before_v = norm(Cd_);  // at the projected position, which was gathered last
  report.after_v = velocity_rounds(state, 0.1 * goal);
  return report;
}

double Dynamics::project_velocity(State& state) {
  gather(state);
  residuals(C_, Cd_);
  return velocity_rounds(state, 1e-3 * options_.stabilization.tolerance);
}

/// M dv + Jh^T z = 0, Jh dv = -(Jh v + Ct), from residuals gathered at this state; the same factor for all rounds.
double Dynamics::velocity_rounds(State& state, double goal) {
  goal = velocity_goal(goal, state.v.lpNorm<Eigen::Infinity>());
  for (int round = 0; round < kVelocityRounds; ++round) {
    if (norm(Cd_) <= goal) break;
    Cd_ = -Cd_;
    solve(zero_, Cd_, d_, lambda_);
    state.v += d_;
    update_velocities(state);
    residuals(C_, Cd_);
  }
  return norm(Cd_);
}

/// New velocities at the same pose: the jacobians stand, only v and w of the slots are written anew.
void Dynamics::update_velocities(const State& state) {
  for (int k = 0; k < system_.n_slots(); ++k) {
    Motion& O = motions_[static_cast<std::size_t>(k + 1)];
    O.v = state.v.segment<3>(6 * k);
    O.w = state.v.segment<3>(6 * k + 3);
  }
}

}  // namespace lockstep
