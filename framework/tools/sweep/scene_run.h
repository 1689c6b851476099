// What every run of a scene begins with.
#pragma once

#include <lockstep/sweep.h>

namespace lockstep {

/// The dynamics with the solver, formulation and stabilisation of the run settings.
inline Dynamics make_dynamics(Mechanism& m, const Registry& registry) {
  return Dynamics(m.system, make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
}

/// The start of the system, assembled unless the scene says otherwise.
inline State assembled_start(Dynamics& dynamics, const Mechanism& m) {
  State start = dynamics.system().start();
  if (m.run.assemble) assemble(dynamics, start, m.start_speeds, m.assembly);
  return start;
}

inline StepLoopOptions loop_options(const RunSettings& run) {
  return {.step = run.step,
          .tolerance = run.tolerance,
          .output = run.output,
          .output_times = run.times,
          .max_steps = run.max_steps};
}

}  // namespace lockstep
