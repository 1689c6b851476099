// SPDX-License-Identifier: BSD-3-Clause
// All that who builds and runs mechanisms needs. Who writes types or fills a registry includes headers of author/, who
// evaluates without a Simulation dynamics.h.
#pragma once

/// @namespace lockstep
/// Simulation of mechanisms of rigid bodies by the lock formulation: everything that a host or a plugin may use.

#include <lockstep/analysis.h>
#include <lockstep/assembly.h>
#include <lockstep/author/loader.h>
#include <lockstep/body.h>
#include <lockstep/branches.h>
#include <lockstep/charts.h>
#include <lockstep/combined_laws.h>
#include <lockstep/couplings.h>
#include <lockstep/dynamics_options.h>
#include <lockstep/equilibrium.h>
#include <lockstep/error.h>
#include <lockstep/explain.h>
#include <lockstep/finding.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/function_laws.h>
#include <lockstep/joints.h>
#include <lockstep/kinematics.h>
#include <lockstep/laws.h>
#include <lockstep/log.h>
#include <lockstep/math.h>
#include <lockstep/recorder.h>
#include <lockstep/report.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solid.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include <lockstep/state.h>
#include <lockstep/step_loop.h>
#include <lockstep/sweep.h>
#include <lockstep/system.h>
#include <lockstep/table.h>
#include <lockstep/text.h>
#include <lockstep/version.h>
