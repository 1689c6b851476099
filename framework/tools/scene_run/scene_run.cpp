// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/scene_run.h"

#include <algorithm>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/simulate/decided_rows.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/rank/branch_point.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/left_out_rows.h"

namespace lockstep {
namespace {

constexpr double kOn = 1e-6;  // m, times the length: nearer than this a start is on the constraints up to its digits

// Whether anything may be decided, as far as it is known without the rows. Those are held by themselves where they are as
// at the start for good, and few enough for a dense factor.
bool is_asked_for(Mechanism& m, const State& start) {
  const NearlyRedundant choice = m.run.nearly_redundant;
  if (choice == NearlyRedundant::reported || !has_loops(m.system, start.modes)) return false;
  if (choice != NearlyRedundant::automatic) return true;
  System& system = system_of(m);
  system.setup();
  return std::ranges::none_of(system.links(), [](const auto& link) { return link->unilateral() != nullptr; }) &&
         are_few_rows(system, start.modes);
}

// Rows that were left out would stay so when those that hold their directions are released.
void refuse_switched(const Mechanism& m, const NearDependency& decided) {
  for (const EventRequest& request : m.events)
    for (const std::string& link : decided.links)
      if (switches(request.event, link))
        throw ModelError("\"nearly_redundant\" of \"run\" is \"" +
                         std::string(m.run.nearly_redundant == NearlyRedundant::held ? "held" : "free") +
                         "\", and event '" + request.event.name + "' switches joint '" + link +
                         "', on whose loop rows nearly depend on others: what is decided at the start is wrong then; "
                         "leave it \"auto\", or \"report\"");
}

// The first event that switches a link of such a loop, whichever links other events have put into force before; "" if none
// does.
std::string switching_event(const Mechanism& m, const State& start) {
  std::vector<bool> modes = start.modes;
  for (const EventRequest& request : m.events)
    for (const auto& link : m.system.links())
      if (switches(request.event, link->name())) modes[link->number()] = true;
  for (const EventRequest& request : m.events)
    if (switched_of_decided(m.system, modes, request.event) != nullptr) return request.event.name;
  return {};
}

// Decides at a pose on the constraints. False: nothing was.
bool decide(Dynamics& dynamics, Mechanism& m, const State& start, const State& pose, NearRows& near) {
  const bool by_itself = m.run.nearly_redundant == NearlyRedundant::automatic;
  near.all = decide_nearly_redundant(system_of(m), dynamics, pose, m.run.nearly_redundant);
  if (std::ranges::none_of(near.all, &NearDependency::decided)) return false;
  if (!by_itself) {
    for (const NearDependency& d : near.all)
      if (d.decided) refuse_switched(m, d);
    return true;
  }
  const std::string event = switching_event(m, start);
  if (event.empty()) return true;
  near.all = decide_nearly_redundant(system_of(m), dynamics, pose, NearlyRedundant::reported);
  for (NearDependency& d : near.all)
    if (d.undecided.empty() && !d.in_passing) d.undecided = "event '" + event + "' switches joints of such a loop";
  return false;
}

/// Brings a pose onto the constraints. False: nearly redundant ones keep it off by a little. Throws what assembly throws.
bool closes(Dynamics& dynamics, const Mechanism& m, State& pose) {
  AssemblyReport unheard;
  const State given = pose;
  try {
    find_positions(dynamics, pose, m.assembly, unheard);
  } catch (const AssemblyError&) {
    pose = given;
    approach_links(dynamics, pose, kRoundOff * m.system.length());
    if (!(dynamics.violation(pose) < kNearlyDependent * m.system.length())) throw;
    return false;
  }
  return true;
}

}  // namespace

State decided_start(Dynamics& dynamics, Mechanism& m, NearRows* out) {
  State start = m.system.start();
  if (!is_asked_for(m, start)) return start;
  State pose = start;
  NearRows near;
  bool met = false, depends = false;
  try {
    near.drawn = drawn_start(dynamics, start);
    const bool off = dynamics.violation(pose) > kOn * m.system.length();
    if (off && !m.run.assemble) return start;
    met = !off || closes(dynamics, m, pose);
    depends = dynamics.dependent_rows(pose) > 0;
    if (depends && met) dynamics.project(pose);
    dynamics.to_slots(pose);
  } catch (const Error&) {  // the run reports the error
    return start;
  }
  const bool decided = depends && decide(dynamics, m, start, pose, near);
  near.looked = met || !near.all.empty();
  if (decided) start = m.system.start(), start.q = pose.q;
  if (out != nullptr) *out = std::move(near);
  return start;
}

void refuse_driven_lock(Dynamics& dynamics, const State& start) {
  if (const Cause lock = cause_of_lock(dynamics, start); lock.found())
    throw AssemblyError({.problem = lock.fact, .advice = lock.hint});
}

AssemblyReport assemble_scene(Dynamics& dynamics, const Mechanism& m, State& start, const NearRows& near) {
  try {
    return assemble_drawn(dynamics, start, m.start_speeds, m.assembly,
                          near.drawn ? *near.drawn : drawn_start(dynamics, start));
  } catch (const AssemblyError& error) {
    rethrow_with(cause_of_start(dynamics, start), error);
  }
}

void refuse_locked(Dynamics& dynamics, const State& start) {
  if (!(start.v.lpNorm<Eigen::Infinity>() > kNegligible)) return;
  if (const BranchPoint at = branch_point(dynamics, start); at.locked)
    throw AssemblyError(
        "the start is a singular configuration: " + at.text(dynamics, start) +
        ". Constraints that are nearly redundant there hold as soon as it moves; let it start at rest, or correct the "
        "axes that should agree (lockstep check --verbose lists the constraints)");
}

std::vector<NearDependency> nearly_redundant_at(Dynamics& dynamics, Mechanism& m, const State& start) {
  if (!has_loops(m.system, start.modes)) return {};
  try {
    State pose = start;
    dynamics.to_slots(pose);
    if (dynamics.violation(pose) > kOn * system_of(m).length() || dynamics.dependent_rows(pose) == 0) return {};
    return decide_nearly_redundant(system_of(m), dynamics, pose, NearlyRedundant::reported);
  } catch (const Error&) {  // the run reports the error
    return {};
  }
}

}  // namespace lockstep
