// Source of the tableau: W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435.
#include "integrators/rk4.h"

namespace lockstep {

namespace {

constexpr double kC[4] = {0, 0.5, 0.5, 1};
constexpr double kA[4][3] = {{}, {0.5}, {0, 0.5}, {0, 0, 1}};
constexpr double kB[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
constexpr EmbeddedScheme kScheme{"rk4", {4, 4, 4, 3, kA[0], kB, kC}};

}  // namespace

TypeInfo Rk4::type_info() { return {"rk4", "Runge-Kutta of order 4, fixed step: teaching and comparison", {}}; }

IntegratorInfo Rk4::info() const { return {"rk4", 4, false, false, 4}; }

const EmbeddedScheme* Rk4::scheme() const { return &kScheme; }

void Rk4::begin(Dynamics&, const State& state) {
  stages_.begin(kScheme.tableau, state);
  end_ = state;
}

StepReport Rk4::step(Dynamics& dynamics, State& state, double h) {
  if (state.z.size() > 0) end_.z = state.z;
  stages_.evaluate(dynamics, state, h, 0, 4);
  stages_.end(state, h, end_);
  const ProjectReport landed = land_or_throw(dynamics, end_, "rk4", state.t, h);
  take_motion(end_, state);
  StepReport report;
  report.h = h;
  report.violation = landed.before;
  report.violation_after = landed.after;
  return report;
}

}  // namespace lockstep
