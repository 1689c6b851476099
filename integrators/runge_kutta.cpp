#include "integrators/runge_kutta.h"

#include <spdlog/fmt/fmt.h>

#include "framework/support/error.h"

namespace lockstep {

void Stages::begin(const Tableau& tableau, const State& y) {
  tableau_ = tableau;
  stage_ = y;
  k_.resize(static_cast<std::size_t>(tableau.n_all));
  for (StateRate& k : k_) k = sized_like(y);
}

void Stages::evaluate(Dynamics& dynamics, const State& y, double h, int first, int last) {
  stage_.z = y.z;
  for (int i = first; i < last; ++i) {
    combine(y, h, tableau_.a + i * tableau_.stride, i, stage_);
    stage_.t = y.t + tableau_.c[i] * h;
    dynamics.rate(stage_, k_[static_cast<std::size_t>(i)]);
  }
}

void Stages::combine(const State& y, double h, const double* w, int n, State& out) const {
  copy_motion(y, out);
  for (int i = 0; i < n; ++i) {
    if (w[i] == 0) continue;
    out.q += (h * w[i]) * k(i).q;
    out.v += (h * w[i]) * k(i).v;
    out.s += (h * w[i]) * k(i).s;
  }
  out.t = y.t + h;
}

void Stages::sum(double h, const double* w, int n, StateRate& out) const {
  out.q.setZero();
  out.v.setZero();
  out.s.setZero();
  for (int i = 0; i < n; ++i) {
    if (w[i] == 0) continue;
    out.q += (h * w[i]) * k(i).q;
    out.v += (h * w[i]) * k(i).v;
    out.s += (h * w[i]) * k(i).s;
  }
}

ProjectReport land(Dynamics& dynamics, State& y) {
  if (dynamics.options().stabilization.kind == Stabilization::Kind::project) return dynamics.project(y);
  ProjectReport report;
  dynamics.normalize(y);
  report.before = report.after = dynamics.violation(y);
  return report;
}

ProjectReport land_or_throw(Dynamics& dynamics, State& y, const char* method, double t, double h) {
  const ProjectReport report = land(dynamics, y);
  if (report.converged) return report;
  throw StepError(
      fmt::format(
          "{}: the step of {:.6g} s from t = {:.9g} s left the constraints by {:.3g} m and could not be brought back "
          "({:.3g} m remain after {} rounds); take a smaller step (--step), a method that chooses its own "
          "(--integrator dopri5), or look for a singular place (lockstep check)",
          method, h, t, report.before, report.after, report.rounds),
      t);
}

StateRate sized_like(const State& y) {
  return {VecX::Zero(y.q.size()), VecX::Zero(y.v.size()), VecX::Zero(y.s.size())};
}

void copy_motion(const State& in, State& out) {
  out.t = in.t;
  out.q = in.q;
  out.v = in.v;
  out.s = in.s;
}

}  // namespace lockstep
