// Every public header in one.
#pragma once

/// @namespace lockstep
/// Simulation of mechanisms of rigid bodies by the lock formulation: everything that a host or a plugin may use.

#include <lockstep/analysis.h>
#include <lockstep/assembly.h>
#include <lockstep/batch.h>
#include <lockstep/body.h>
#include <lockstep/charts.h>
#include <lockstep/check.h>
#include <lockstep/combined_laws.h>
#include <lockstep/couplings.h>
#include <lockstep/dynamics.h>
#include <lockstep/equations.h>
#include <lockstep/error.h>
#include <lockstep/export.h>
#include <lockstep/force.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/function_laws.h>
#include <lockstep/integrator.h>
#include <lockstep/integrators.h>
#include <lockstep/jet.h>
#include <lockstep/joints.h>
#include <lockstep/kernel.h>
#include <lockstep/law.h>
#include <lockstep/law_checks.h>
#include <lockstep/laws.h>
#include <lockstep/loader.h>
#include <lockstep/lock.h>
#include <lockstep/log.h>
#include <lockstep/mask.h>
#include <lockstep/math.h>
#include <lockstep/memory.h>
#include <lockstep/newton.h>
#include <lockstep/params.h>
#include <lockstep/phi.h>
#include <lockstep/phi_function.h>
#include <lockstep/phi_links.h>
#include <lockstep/recorder.h>
#include <lockstep/registry.h>
#include <lockstep/relative.h>
#include <lockstep/rows.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solver.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include <lockstep/state.h>
#include <lockstep/step_loop.h>
#include <lockstep/stepping.h>
#include <lockstep/sweep.h>
#include <lockstep/system.h>
#include <lockstep/text.h>
#include <lockstep/vec.h>
#include <lockstep/version.h>
