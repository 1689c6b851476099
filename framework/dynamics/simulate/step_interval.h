// SPDX-License-Identifier: BSD-3-Clause
// StepInterval: the last step, the states inside it, and where it is cut. Internal to the step loop.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <lockstep/author/integrator.h>
#include <lockstep/dynamics.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/step_watch.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

class StepInterval {
 public:
  StepInterval(Dynamics& dynamics, Integrator& method) : dynamics_(dynamics), method_(method), info_(method.info()) {}

  /// Starts a new run from this state.
  void start(const State&);
  /// Restarts the method at this state.
  void begin(const State&);
  /// One step of the method, at most h, from `state`, which becomes its end; checked. What it throws leaves the state as
  /// it was. Without guards only dense output needs states inside it.
  void make(State& state, double h, bool has_guards);

  /// After n steps: see measure_violation().
  void measure(const State& at, long n) { measure_violation(dynamics_, method_, at, n, report_); }

  const IntegratorInfo& method() const { return info_; }
  /// Whether the method may keep accelerations from step to step. Those with a scheme() evaluate each stage again, and
  /// so do the explicit ones of the library that take joint coordinates.
  bool keeps_accelerations() const {
    return method_.scheme() == nullptr && (info_.implicit || !info_.joint || method_.origin() != "built in");
  }
  const State& from() const { return from_; }
  const StepReport& report() const { return report_; }
  bool has_dense() const { return has_dense_; }

  /// The state at t inside the step, on the constraints, valid until the next call: by dense output, or for a method
  /// without it by a shorter step.
  const State& at(double t);
  /// Work of the method for the states inside the step, which is one of the run if it has outputs there.
  void prepare(double t) {
    if (has_dense_ && t > from_.t) named(method_, t, [&] { return method_.dense(t, inside_); });
  }
  /// Puts the method back to the end of the step, if shorter ones were made.
  void put_back_method();
  /// The state at t becomes the end of the step.
  void cut(double t, State& state);

  /// Remembers what acts at the state that a call ends with, where the method may keep accelerations from step to step:
  /// forces except those that depend on reactions, and what rows prescribe. The caller may have changed it,
  void note_acting(const State&);
  /// which this says.
  bool acts_otherwise(const State&);

  // -- checkpoints: the report of the last step, and the method
  void save(Snapshot&) const;
  /// In place of start() and begin(). Throws ModelError if the method reads less than it saved.
  void load(const State&, SnapshotReader&);

 private:
  bool read_acting(const State&, VecX& out);

  Dynamics& dynamics_;
  Integrator& method_;
  const IntegratorInfo info_;
  State from_, inside_, before_part_, slots_;
  Snapshot before_, after_;  // the method's memory around the step
  StepReport report_;
  bool has_dense_ = false;
  bool is_back_ = false;  // the method is inside the step, after shorter ones
  bool remembers_ = false;
  VecX acted_, acts_, C_, Cd_;
};

// Whether the rows leave no velocity free. Without the number of redundant ones, as many as there are velocities count.
inline bool moved_by_laws(const Sample& sample) {
  if (sample.state.coordinates) return sample.state.coordinates->n_v() == 0;
  const Evaluation& all = sample.values().evaluation;
  return all.rows().n_rows - std::max(all.redundant(), 0) == all.system().n_velocities();
}

/// The last step of a loop. What is looked at is no work of the run, except what its own next output needs too.
class LastStep final : public InsideStep {
 public:
  /// `output`: between two rows, s. `along`: whether laws alone move the mechanism, once that is known; null: never asked.
  LastStep(Dynamics& dynamics, StepInterval& interval, const Sample& end, double next_output, double output = 0,
           std::optional<bool>* along = nullptr)
      : dynamics_(dynamics),
        interval_(interval),
        end_(end),
        next_output_(next_output),
        output_(output),
        along_laws_(along),
        counted_(dynamics.work()) {}
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
  bool along_laws() const override {
    constexpr int kShort = 4;  // steps between two outputs: the error of something limits them
    if (along_laws_ == nullptr || kShort * (end_.state.t - begin()) < output_) return false;
    if (!*along_laws_) succeeds([&] { *along_laws_ = moved_by_laws(end_); });
    return along_laws_->value_or(false);
  }

 private:
  void prepare() const {
    std::swap(dynamics_.work(), counted_);
    interval_.prepare(std::exchange(next_output_, HUGE_VAL));
    std::swap(dynamics_.work(), counted_);
  }

  Dynamics& dynamics_;
  StepInterval& interval_;
  const Sample& end_;
  mutable double next_output_;
  const double output_;
  std::optional<bool>* const along_laws_;
  mutable WorkCount counted_;
};

}  // namespace lockstep
