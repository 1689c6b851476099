// Step control of implicit Runge-Kutta methods: Hairer & Wanner, Solving Ordinary Differential Equations II (1996),
// IV.8; prediction by K. Gustafsson, ACM Trans. Math. Softw. 20 (1994) 496.
#pragma once

#include "framework/dynamics/integrate/step_control.h"

namespace lockstep {

/// For an estimate that goes with h^4. A step that took many iterations is followed by a more careful one; safety 0.9,
/// factors 0.2 ... 5, no growth after a rejection.
class LOCKSTEP_API PredictiveControl final : public StepControl {
 public:
  void begin() override { h_ = 0; }
  double accept(double h, double error, int iterations, bool after_rejection) override;
  double reject(double error, int iterations) const override;
  void save(Snapshot& out) const override { out.put(h_), out.put(error_); }
  void restore(const Snapshot& in) override { h_ = in.get(), error_ = in.get(); }

  static constexpr int kMostIterations = 10;

 private:
  double h_ = 0, error_ = 0;  // of the step accepted before; 0: none
};

}  // namespace lockstep
