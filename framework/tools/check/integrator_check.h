// IntegratorCheck: the trials of check_integrator, one function each.
#pragma once

#include <string>

#include <lockstep/check.h>
#include "framework/tools/check/closed_motion.h"

namespace lockstep {

class IntegratorCheck {
 public:
  IntegratorCheck(const IntegratorMaker& make, CheckReport& report);
  void run();

 private:
  // -- integrator_orders.cpp
  struct Run {
    double error = 0, h = 0;  ///< largest error after a step; mean step
    bool fine = false;        ///< it came to its end with numbers
  };
  void order_of_steps(const ClosedMotion&);
  void order_of_tolerances(const ClosedMotion&);
  void dense_output(const ClosedMotion&);
  Run fixed_run(const ClosedMotion&, int n_steps);
  Run adaptive_run(const ClosedMotion&, double tolerance);
  void judge_order(const ClosedMotion&, double measured, const std::string& how);

  // -- integrator_check.cpp
  void steps(ClosedMotion&);
  void throws(ClosedMotion&);
  void repeats(ClosedMotion&);
  void goes_back(ClosedMotion&);

  std::unique_ptr<Integrator> made() const;  ///< with a tolerance, where it has one
  /// n steps of about h each from `state`, without begin().
  void go(Integrator&, Dynamics&, State& state, int n, double h) const;
  void add(const std::string& key, std::string what, std::string look, double weight = 0);

  const IntegratorMaker& make_;
  CheckReport& report_;
  IntegratorInfo info_;
};

}  // namespace lockstep
