// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/sweep/same_steps.h"

namespace lockstep {

double SameSteps::next(double own) {
  std::vector<std::vector<double>>& all = steps_.advised;
  if (!steps_.is_known) {
    all.resize(n_parts_);
    all.back().resize(n_), all.back().push_back(own);
  } else if (n_parts_ <= all.size() && n_ < all[n_parts_ - 1].size()) {
    own = all[n_parts_ - 1][n_];
  }
  ++n_;
  return own;
}

double SameSteps::first_step(Dynamics& dynamics, const State& state, double largest) {
  ++n_parts_, n_ = 0;
  return next(inside_->first_step(dynamics, state, largest));
}

StepReport SameSteps::step(Dynamics& dynamics, State& state, double h) {
  StepReport report = inside_->step(dynamics, state, h);
  if (n_parts_ == 0) return report;
  if (!steps_.is_known && report.rejected > 0) steps_.advised.back()[n_ - 1] = report.h;
  report.h_next = next(report.h_next);
  return report;
}

// A repeated step may have a larger error than the first one had.
void SameSteps::set_tolerance(const Tolerance& tolerance) {
  const double room = steps_.is_known ? 10 : 1;
  inside_->set_tolerance({room * tolerance.relative, room * tolerance.atol_x});
}

void SameSteps::save(Snapshot& out) const {
  out.put(static_cast<double>(n_parts_)), out.put(static_cast<double>(n_));
  inside_->save(out);
}

void SameSteps::restore(SnapshotReader& in) {
  n_parts_ = static_cast<std::size_t>(in.get_count()), n_ = static_cast<std::size_t>(in.get_count());
  inside_->restore(in);
}

}  // namespace lockstep
