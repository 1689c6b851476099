// check_integrator: measures a method's order on motions with closed forms, and tries what the step loop relies on.
#pragma once

#include <functional>
#include <memory>

#include "framework/tools/check/report.h"
#include "framework/dynamics/integrate/integrator.h"
#include "framework/mechanism/params/params.h"
#include "framework/description/registry/registry.h"

namespace lockstep {

using IntegratorMaker = std::function<std::unique_ptr<Integrator>()>;

/// On a free top (it turns about its angular momentum and about its axis at steady rates) and a large pendulum on a
/// hinge (elliptic functions; rows, projection, a force with memory):
///
///   order: error against the step, halved from coarse to fine; adaptive methods: against the mean step, and the error
///   against the tolerance (slope one);   steps of at most h, time and report agree, memory and links left alone, unit
///   quaternions, C = 0 where the dynamics projects;   a step that throws leaves the state as it was;   two runs are
///   equal, a method begun anew too, after a rewind too; save() and restore() take a step back and make a checkpoint;
///   dense(): ends and order
///
/// `options`: its seed only.
LOCKSTEP_API CheckReport check_integrator(const IntegratorMaker&, const CheckOptions& options = {});

/// The same for a registered type. Throws what the maker throws.
LOCKSTEP_API CheckReport check_integrator(const Registry&, const std::string& type, const Params& params = {},
                                          const CheckOptions& options = {});

}  // namespace lockstep
