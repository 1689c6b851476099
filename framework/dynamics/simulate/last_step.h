// SPDX-License-Identifier: BSD-3-Clause
// LastStep: the last step of a run for its observers. Internal to the step loop.
#pragma once

#include <utility>

#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/step_interval.h"

namespace lockstep {

/// The last step of a loop. What is looked at is no work of the run, except what its own next output needs too.
class LastStep final : public InsideStep {
 public:
  LastStep(Dynamics& dynamics, StepInterval& interval, const Sample& end, double next_output)
      : dynamics_(dynamics), interval_(interval), end_(end), next_output_(next_output), counted_(dynamics.work()) {}
  LastStep(const LastStep&) = delete;
  LastStep& operator=(const LastStep&) = delete;
  ~LastStep() override { dynamics_.work() = counted_; }
  double begin() const override { return interval_.from().t; }
  const Sample& end() const override { return end_; }
  bool has_states() const override { return interval_.has_dense(); }
  Sample at(double t) const override {
    end_.forget();
    if (next_output_ < end_.state.t) prepare();
    return {dynamics_, interval_.at(t), interval_.report()};
  }
  bool along_laws() const override { return end_.state.coordinates && end_.state.coordinates->n_v() == 0; }

 private:
  void prepare() const {
    std::swap(dynamics_.work(), counted_);
    interval_.prepare(std::exchange(next_output_, kNever));
    std::swap(dynamics_.work(), counted_);
  }

  Dynamics& dynamics_;
  StepInterval& interval_;
  const Sample& end_;
  mutable double next_output_;
  mutable WorkCount counted_;
};

}  // namespace lockstep
