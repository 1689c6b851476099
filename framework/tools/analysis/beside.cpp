#include "framework/tools/analysis/beside.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

bool Beside::along(const State& from, double time, State& out) try {
  out = from;
  advance_state(out, time, from.v);
  out.t = from.t + time;
  return project_.project(evaluation_, factor_, out, kRoundOff * evaluation_.system().length()).converged;
} catch (const Error&) {
  return false;
}

double Beside::indicator_along(const State& from, double time, State& out) try {
  return along(from, time, out) ? indicator(out) : HUGE_VAL;
} catch (const Error&) {
  return HUGE_VAL;
}

void Beside::factor(const State& state) {
  evaluation_.at(state);
  if (evaluation_.redundant() == Kkt::kUnknown) evaluation_.set_redundant(of_run_.redundancy(state).rows);
  factor_.compute(evaluation_);
}

double Beside::indicator(const State& state) {
  factor(state);
  SolveReport report;
  factor_.complete(report);
  return std::max(report.detector, 0.0);
}

const VecX& Beside::multipliers(const State& state) {
  factor(state);
  c_.resize(evaluation_.rows().n_rows);
  for (const RowEntry& e : evaluation_.rows().entries)
    for (int k = 0; k < e.m; ++k) c_[e.first_row + k] = evaluation_.rows().block(e).Qhat(k);
  factor_.solve_motion(evaluation_, evaluation_.force(), c_, a_, lambda_);
  return lambda_;
}

double fastest(const Inputs& in, double length) {
  double w2 = 0;
  for (const Motion& O : in.motions) w2 = std::max({w2, O.v.squaredNorm() / (length * length), O.w.squaredNorm()});
  return std::sqrt(w2);
}

State in_slots(const Sample& sample) {
  State state = sample.state;
  sample.dynamics().to_slots(state);
  return state;
}

bool has_rows(const Sample& sample) { return !sample.state.coordinates || sample.state.coordinates->has_rows(); }

}  // namespace lockstep
