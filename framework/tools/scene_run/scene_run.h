// SPDX-License-Identifier: BSD-3-Clause
// What every run of a scene begins with, and what is found of it at its end.
#pragma once

#include <optional>
#include <set>

#include <lockstep/analysis.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/tools/simulation/simulation_parts.h"

namespace lockstep {

/// Makes a recorder with the channels that the scene asks for. Make it before the StepLoop; the mechanism must stay
/// where it is in memory. `only`: columns of these names alone; null: all. Throws SceneError with the places in the file of
/// channels that do not exist, also of those of events.
LOCKSTEP_API std::unique_ptr<Recorder> make_recorder(Mechanism&, const std::set<std::string>* only = nullptr);

/// Makes the scene's events with their conditions; `recorder` keeps their channels up to date. Make them before the
/// StepLoop too. Throws SceneError with the place in the file of a channel that does not exist.
LOCKSTEP_API std::vector<Event> make_events(Mechanism&, Recorder& recorder);

/// The dynamics with the solver, formulation and stabilisation of the run settings.
inline Dynamics make_dynamics(Mechanism& m, const Registry& registry) {
  return Dynamics(system_of(m), make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
}

/// build_mechanism(); an error of the scene also lists unknown channels of "record" and of events.
LOCKSTEP_API Mechanism build_observed(const Scene&, const Registry&);

/// Rows that nearly depend on others at a start.
struct NearRows {
  bool looked = false;  ///< whether they were looked for
  std::vector<NearDependency> all;
  std::optional<DrawnStart> drawn{};  ///< the start before rows were decided, if they were looked for
};

/// The start of the system, to be assembled, when it is decided what rows hold that nearly depend on others, where the run
/// settings require that; `near`, if given, reports it. If anything was decided its positions are those, with all rows
/// on the constraints, at which it was. Nothing is decided at a start that is off them and is not or cannot be assembled.
/// NearlyRedundant::automatic decides nothing near one-sided joints, nor if an event switches a joint of such a loop;
/// what is asked for by name throws ModelError there.
LOCKSTEP_API State decided_start(Dynamics& dynamics, Mechanism& m, NearRows* near = nullptr);

/// Rows that nearly depend on others at an assembled start, where nothing is decided; none where that cannot be found out.
LOCKSTEP_API std::vector<NearDependency> nearly_redundant_at(Dynamics& dynamics, Mechanism& m, const State& start);

/// Throws AssemblyError if a start moves in a singular position in which the mechanism is locked.
LOCKSTEP_API void refuse_locked(Dynamics&, const State& start);

/// Throws AssemblyError if drives are to move a mechanism whose joints leave it no degree of freedom.
LOCKSTEP_API void refuse_driven_lock(Dynamics&, const State& start);

/// assemble() with the settings of the scene; the cause of a start that cannot be assembled precedes the error.
/// `near`: of decided_start(), which gave the state.
LOCKSTEP_API AssemblyReport assemble_scene(Dynamics&, const Mechanism&, State&, const NearRows& near);

/// The same start, assembled unless the scene forbids it; counted angles begin with the drives. `report`, if given,
/// takes what assembly changed. Throws what assemble() and refuse_locked() throw.
inline State assembled_start(Dynamics& dynamics, Mechanism& m, AssemblyReport* report = nullptr) {
  NearRows near;
  State start = decided_start(dynamics, m, &near);
  if (m.run.assemble) {
    AssemblyReport assembled = assemble_scene(dynamics, m, start, near);
    if (report != nullptr) *report = std::move(assembled);
  } else {
    begin_turns(dynamics, start);
  }
  refuse_locked(dynamics, start);
  return start;
}

/// What depends on how redundant constraints share a load: forces such as friction, events, requirements. One finding that
/// names them, by the first of these states in which there are some, or none. States in singular positions, and those that
/// cannot be evaluated, are skipped.
LOCKSTEP_API std::vector<Finding> share_findings(System&, const Mechanism&, std::initializer_list<const State*>);

class Doubts;
class SingularWatch;

/// What speaks against the result of a run so far: singular positions, doubts, energy and drift; then whether it is stiff.
LOCKSTEP_API std::vector<Finding> run_findings(StepLoop&, const Audit&, const Doubts&, const SingularWatch&);

}  // namespace lockstep
