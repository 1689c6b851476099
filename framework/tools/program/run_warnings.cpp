// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_warnings.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/analysis.h>
#include <lockstep/author/integrator.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/tree.h"
#include "framework/dynamics/simulate/along_laws.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/loop_rows.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

// Springs with a negative stiffness.
std::vector<Finding> negative_stiffness(const Scene& scene) {
  std::vector<Finding> all;
  for (const Value& force : items(scene.root, "forces")) {
    const std::string* name = text_under(force, "name");
    const Value* k = force.find("stiffness");
    if (k == nullptr || name == nullptr) continue;
    const std::string* text = k->text();
    if (text != nullptr ? text->starts_with('-') : k->number() != nullptr && *k->number() < 0)
      all.push_back({&finding::negative_stiffness, "force '" + *name + "'",
                     fmt::format("force '{}', stiffness: {} is negative: it pushes away from its free length or angle",
                                 *name, plain_text(*k))});
  }
  return all;
}

// Whether a constraint may be released: one-sided joints, and those that events release.
bool may_let_go(const Mechanism& m) {
  return std::ranges::any_of(m.system.links(), [](const auto& link) { return link->unilateral() != nullptr; }) ||
         std::ranges::any_of(m.events, [](const EventRequest& e) { return !e.event.deactivate.empty(); });
}

// The active joints with constraints, merged ones too.
std::vector<std::string> holding(const System& system, const State& state) {
  std::vector<std::string> names;
  for (const auto& link : system.links())
    if (state.modes[link->number()] && link->row_count() > 0) names.push_back(link->name());
  return names;
}

}  // namespace

std::optional<std::vector<std::string>> moved_by_laws(Dynamics& dynamics, State at, double until) {
  constexpr double kMoves = 1e-9, kOff = 1e-6;  // m/s; m
  constexpr int kInstants = 127;
  std::vector<std::string> names;
  dynamics.to_slots(at);
  at.v.setZero();
  VecX C0, C, Cd;
  const bool ends = succeeds([&] {
    for (int k = 0; k <= kInstants; ++k) {
      at.t = until * std::sqrt(static_cast<double>(k) / kInstants);  // of no period
      const Evaluation& e = dynamics.gather_rows(at);
      e.residuals(C, Cd);
      if (k == 0) C0 = C;
      for (int row = 0; row < C.size(); ++row)
        if (!(std::abs(Cd[row]) <= kMoves && std::abs(C[row] - C0[row]) <= kOff))
          add_name(NamedRow(dynamics.system(), e.rows(), row).link->name(), names);
    }
  });
  return ends || !names.empty() ? std::optional(names) : std::nullopt;
}

std::vector<Finding> settings_to_warn_of(const Scene& scene, const Mechanism& m, const Arguments& args, bool adaptive) {
  const RunSettings& run = m.run;
  std::vector<Finding> all = negative_stiffness(scene);
  if (!run.times.empty() && run.until >= 0 && run.times.back() > run.until)
    all.push_back({&finding::outputs_beyond_end, "",
                   fmt::format("run.times: {:g} s is after the end of the run at {:g} s and is not recorded",
                               run.times.back(), run.until),
                   "", run.times.back(), run.until, "s"});
  if (run.output > run.until && run.until > 0)
    all.push_back(
        {&finding::outputs_beyond_end, "",
         fmt::format("run.output: {:g} s is longer than the run of {:g} s: only its start and its end are recorded",
                     run.output, run.until),
         "", run.output, run.until, "s"});
  const Value* settings = scene.root.find("run");
  const bool in_scene = args["--integrator"].empty() && settings != nullptr && settings->find("tolerance") != nullptr;
  if ((in_scene || !args["--tolerance"].empty()) && !adaptive)
    all.push_back({&finding::setting_unused, "",
                   fmt::format("tolerance: it has no effect, as \"{}\" has fixed steps", run.integrator.type)});
  return all;
}

// With a separate mechanism: the run decides on its constraints, and reports on its settings, again.
void refuse_impossible_formulation(const RunSettings& run, const Loaded& loaded) {
  if (run.formulation != Formulation::joint) return;
  std::string why;
  try {
    const FindingScope unheard;
    Mechanism m = build_mechanism(loaded.scene, loaded.registry);
    Dynamics dynamics = make_dynamics(m, loaded.registry);
    why = why_not_joint(dynamics, decided_start(dynamics, m), *make_integrator(m.run, loaded.registry));
  } catch (const Error&) {
    return;
  }
  refuse_joint(why);
}

// Other errors than those of laws are left to the run.
void refuse_short_laws(const Mechanism& m, Dynamics& dynamics, const State& start) {
  if (std::ranges::any_of(m.events, [](const EventRequest& e) { return e.event.stop || !e.event.deactivate.empty(); }))
    return;
  State end = start;
  dynamics.to_slots(end);
  end.t = std::max(start.t, m.run.until);
  try {
    dynamics.gather(end);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::model) throw;
  }
}

BranchPoint warn_of_branches(Dynamics& dynamics, StepLoop& sim) {
  State start = sim.state();
  dynamics.to_slots(start);
  BranchPoint at = branch_point(dynamics, start);
  if (!at.singular) return at;
  if (!at.drives.empty()) {
    sim.add_finding({&finding::singular_start, "", "the start is a singular configuration: " + at.text(dynamics, start),
                     "start near the configuration, on the side that is meant"});
    return at;
  }
  constexpr double kOff = 1e-3;  // of the velocity
  const bool moves = at.moves(start.v);
  const double off = moves && at.all ? at.off_branches(dynamics.system(), start.v) : 0;
  sim.add_finding(
      {&finding::singular_start, "",
       fmt::format("the start is a singular configuration: {}{}", at.text(dynamics, start),
                   !moves ? ". It is at rest, so its motion is not determined"
                   : off > kOff
                       ? fmt::format(". The start velocity is along none of them (relative deviation {:.2g})", off)
                       : ". It continues along its velocity"),
       !moves       ? "give a small start velocity along one of them, or start near the configuration"
       : off > kOff ? "give a velocity along one of them"
                    : ""});
  return at;
}

void warn_of_no_freedom(const Mechanism& m, Dynamics& dynamics, StepLoop& sim, int most) {
  const System& system = m.system;
  if (system.n_velocities() == 0 || system.n_velocities() > most || may_let_go(m)) return;
  const MobilityReport mobile = mobility(dynamics, sim.state());
  if (mobile.freedoms > 0) return;
  if (const auto moved = moved_by_laws(dynamics, sim.state(), m.run.until); !moved || !moved->empty()) return;
  State state = sim.state();
  dynamics.to_slots(state);
  if (const System::InSpace look = dynamics.look_in_space(); mobility(dynamics, state).freedoms > 0)
    return;  // along the plane's normal
  if (mobile.driven > 0)
    return sim.add_finding({&finding::no_freedom, "",
                            "no degree of freedom is left: constant laws hold " + text::join(mobile.drives),
                            "for a constant speed, give the drive \"speed\" instead of \"law\""});
  const std::vector<std::string> links = holding(system, sim.state());
  const std::string axis = odd_axis(dynamics, sim.state());
  sim.add_finding(
      {&finding::no_freedom, "",
       fmt::format("no degree of freedom: the constraints of {} hold all {} unknown velocities{}", first_of(links),
                   mobile.unknowns, mobile.redundant > 0 ? fmt::format("; {} redundant", mobile.redundant) : ""),
       axis.empty() ? "use a joint that leaves the motion free, or correct the geometry (lockstep check --verbose)"
                    : axis});
}

}  // namespace lockstep
