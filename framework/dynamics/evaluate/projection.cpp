#include "framework/dynamics/evaluate/projection.h"

#include <algorithm>
#include <cmath>

namespace lockstep {

namespace {
constexpr int kRounds = 6;  // positions; quadratic with a fresh factor, so three are usual
constexpr int kVelocityRounds = 3;
constexpr double kUlp = std::numeric_limits<double>::epsilon();
}  // namespace

ProjectReport Projection::project(Evaluation& e, Factor& factor, State& state, double goal) {
  ProjectReport report;
  normalize(state);
  if (e.covers(state) && e.rows().n_rows == 0) return report;
  zero_.setZero(state.v.size());
  const bool factored = positions(e, factor, state, goal, report);
  report.before_v = e.norm(Cd_);  // at the projected position
  report.after_v = velocities(e, factor, factored, state, 0.1 * goal);
  return report;
}

// d = -M^-1 Jh^T z, (S + E) z = C. Not below round-off of the largest position. Returns whether the factor serves still.
bool Projection::positions(Evaluation& e, Factor& factor, State& state, double goal, ProjectReport& report) {
  double x_max = 0;
  for (Eigen::Index k = 0; k + 7 <= state.q.size(); k += 7)
    x_max = std::max(x_max, state.q.segment<3>(k).lpNorm<Eigen::Infinity>());
  goal = std::max(goal, 1e-14 * e.system().length() + 4 * kUlp * x_max);
  double before = 0;
  for (int round = 0;; ++round) {
    e.at(state);
    e.check();
    e.residuals(C_, Cd_);
    const double now = e.norm(C_);
    if (round == 0) report.before = now;
    report.after = now;
    report.rounds = round;
    const bool serves = round > 0 && now <= 0.1 * before;
    if (now <= goal) return serves;
    // no further progress, but within the tolerance: the round-off of this mechanism
    if (round > 1 && now > 0.5 * before && now <= tolerance_) return serves;
    if (round == kRounds || !std::isfinite(now)) {
      report.converged = now <= tolerance_;
      return serves;
    }
    before = now;
    C_ = -C_;
    if (!serves) factor.compute(e);
    factor.solve(e, zero_, C_, d_, lambda_);
    advance(state, 1.0, d_);
  }
}

double Projection::project_velocity(Evaluation& e, Factor& factor, State& state, double goal) {
  e.at(state);
  e.check();
  e.residuals(C_, Cd_);
  zero_.setZero(state.v.size());
  return velocities(e, factor, false, state, goal);
}

// From Cd_ at this state; one factor for all rounds. The jacobians are those of the pose, which stays.
double Projection::velocities(const Evaluation& e, Factor& factor, bool factored, State& state, double goal) {
  goal = std::max(goal, 8 * kUlp * state.v.lpNorm<Eigen::Infinity>());
  for (int round = 0; round < kVelocityRounds && !(e.norm(Cd_) <= goal); ++round) {
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
