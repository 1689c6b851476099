// SPDX-License-Identifier: BSD-3-Clause
// What a Simulation holds, whether it runs a system or a scene.
#pragma once

#include <memory>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>

namespace lockstep {

/// Steps and outputs as settings give them.
inline StepLoopOptions loop_options(const RunSettings& run) {
  return {.step = run.step,
          .tolerance = run.tolerance,
          .output = run.output,
          .output_times = run.times,
          .max_steps = run.max_steps,
          .limits = run.limits};
}

struct LOCKSTEP_API Simulation::Parts {
  Parts(System& of, RunSettings& by, std::unique_ptr<Recorder> to)
      : system(of), settings(by), recorder(std::move(to)), solver(by.solver.type) {}
  virtual ~Parts();

  virtual std::unique_ptr<Integrator> make_method() const = 0;
  virtual std::unique_ptr<LinearSolver> make_solver() const = 0;
  /// Called before the dynamics is made: what adds integrated states to the system.
  virtual void before() {}
  /// Adds observers and events, and returns the assembled start.
  virtual State begin(Dynamics&, StepLoop&, AssemblyReport&);
  virtual RunVerdict verdict() const;
  /// In a catch block: throws the error of a run with its cause, if that is found.
  virtual void rethrow(const Error&) {}
  template <class Act>
  const SimulationReport& attempt(Act act) {
    try {
      return act();
    } catch (const Error& error) {
      rethrow(error);
      throw;
    }
  }

  /// Makes and begins the run at the first call. Nothing is made where that throws.
  StepLoop& begun();
  /// Begins at another state.
  void start_from(State);

  System& system;
  RunSettings& settings;
  std::unique_ptr<Recorder> recorder;
  const std::string solver;  // as it was given
  std::unique_ptr<Dynamics> dynamics;
  std::shared_ptr<StepLoop> loop;  // its System has a weak reference
  State started;
  AssemblyReport assembly;
};

}  // namespace lockstep
