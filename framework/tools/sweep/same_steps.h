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
  StepReport step(Dynamics&, State&, double h) override;
  bool dense(double t, State& out) const override { return inside_->dense(t, out); }
  void set_tolerance(const Tolerance&) override;
  double first_step(Dynamics&, const State&, double largest) override;
  void save(Snapshot&) const override;
  void restore(SnapshotReader&) override;
  const EmbeddedScheme* scheme() const override { return inside_->scheme(); }
  bool saves_all() const override { return inside_->saves_all(); }

 private:
  double next(double own);

  std::unique_ptr<Integrator> inside_;
  StepSequence& steps_;
  std::size_t n_parts_ = 0, n_ = 0;  // beginnings so far, and steps advised since the last
};

}  // namespace lockstep
