// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/sweep/same_steps.h"

namespace lockstep {

double SameSteps::next(double own) {
  if (!steps_.is_known)
    steps_.advised.resize(n_), steps_.advised.push_back(own);
  else if (n_ < steps_.advised.size())
    own = steps_.advised[n_];
  ++n_;
  return own;
}

double SameSteps::first_step(Dynamics& dynamics, const State& state, double largest) {
  return next(inside_->first_step(dynamics, state, largest));
}

StepReport SameSteps::step(Dynamics& dynamics, State& state, double h) {
  StepReport report = inside_->step(dynamics, state, h);
  if (!steps_.is_known && report.rejected > 0 && n_ > 0) steps_.advised[n_ - 1] = report.h;
  report.h_next = next(report.h_next);
  return report;
}

// A repeated step may have a larger error than the first one had.
void SameSteps::set_tolerance(const Tolerance& tolerance) {
  const double room = steps_.is_known ? 10 : 1;
  inside_->set_tolerance({room * tolerance.relative, room * tolerance.atol_x});
}

void SameSteps::save(Snapshot& out) const {
  out.put(static_cast<double>(n_));
  inside_->save(out);
}

void SameSteps::restore(SnapshotReader& in) {
  n_ = static_cast<std::size_t>(in.get_count());
  inside_->restore(in);
}

}  // namespace lockstep
