// SPDX-License-Identifier: BSD-3-Clause
// SameSteps: an adaptive method that makes the steps of another run.
//
// The end of an adaptive run jumps if a number of its scene makes a step longer or shorter. On the same steps it is a
// smooth function of that number, and its differences are derivatives of the discrete solution (internal numerical
// differentiation, Bock 1981).
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <lockstep/author/integrator.h>

namespace lockstep {

/// The steps that a method advised in a run.
struct StepSequence {
  std::vector<std::vector<double>> advised;  ///< s, in their order, after each beginning of the method, as at events
  bool is_known = false;                     ///< whether runs repeat them; else a run writes them
};

/// The method inside, with the steps of a sequence. Where it has none, the method chooses its own.
class SameSteps final : public Integrator {
 public:
  SameSteps(std::unique_ptr<Integrator> inside, StepSequence& steps) : inside_(std::move(inside)), steps_(steps) {
    set_origin(inside_->origin());
  }
  IntegratorInfo info() const override { return inside_->info(); }
  void begin(Dynamics& dynamics, const State& state) override { inside_->begin(dynamics, state); }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    StepReport report = inside_->step(dynamics, state, h);
    if (n_parts_ == 0) return report;
    if (!steps_.is_known && report.rejected > 0) steps_.advised.back()[n_ - 1] = report.h;
    report.h_next = next(report.h_next);
    return report;
  }
  bool dense(double t, State& out) const override { return inside_->dense(t, out); }
  /// A repeated step may have a larger error than the first one had.
  void set_tolerance(const Tolerance& tolerance) override {
    const double room = steps_.is_known ? 10 : 1;
    inside_->set_tolerance({room * tolerance.relative, room * tolerance.atol_x});
  }
  double first_step(Dynamics& dynamics, const State& state, double largest) override {
    ++n_parts_, n_ = 0;
    return next(inside_->first_step(dynamics, state, largest));
  }
  void save(Snapshot& out) const override {
    out.put(static_cast<double>(n_parts_)), out.put(static_cast<double>(n_));
    inside_->save(out);
  }
  void restore(SnapshotReader& in) override {
    n_parts_ = static_cast<std::size_t>(in.get_count()), n_ = static_cast<std::size_t>(in.get_count());
    inside_->restore(in);
  }
  const EmbeddedScheme* scheme() const override { return inside_->scheme(); }
  bool saves_all() const override { return inside_->saves_all(); }

 private:
  // The step to make, of the sequence or the method's `own`.
  double next(double own) {
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

  std::unique_ptr<Integrator> inside_;
  StepSequence& steps_;
  std::size_t n_parts_ = 0, n_ = 0;  // beginnings so far, and steps advised since the last
};

}  // namespace lockstep
