// What every run of a scene begins with.
#pragma once

#include <lockstep/analysis.h>
#include <lockstep/sweep.h>

namespace lockstep {

/// The dynamics with the solver, formulation and stabilisation of the run settings.
inline Dynamics make_dynamics(Mechanism& m, const Registry& registry) {
  return Dynamics(m.system, make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
}

/// Decides what rows hold that nearly depend on others, at the start on the constraints, as the run settings say. Nothing
/// is decided for a start that is not, or that cannot be assembled.
LOCKSTEP_API std::vector<NearDependency> decide_nearly_redundant(Dynamics& dynamics, Mechanism& m);

/// The start of the system, assembled unless the scene says otherwise, when it is decided what rows hold that nearly depend
/// on others; `near`, where given, tells that.
inline State assembled_start(Dynamics& dynamics, Mechanism& m, std::vector<NearDependency>* near = nullptr) {
  std::vector<NearDependency> found = decide_nearly_redundant(dynamics, m);
  if (near != nullptr) *near = std::move(found);
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
