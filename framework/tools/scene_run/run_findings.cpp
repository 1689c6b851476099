// SPDX-License-Identifier: BSD-3-Clause
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include <lockstep/text.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/branch_point.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

void add_energy(std::vector<Finding>& all, const Audit& audit, bool adaptive, const std::string& first) {
  const std::string off =
      fmt::format("the energy balance is off by {} J, {}", text::brief(audit.imbalance),
                  audit.scale > 0 ? fmt::format("{} % of the energy exchanged (limit {:g} %)",
                                                text::brief(100 * audit.imbalance_share()), 100 * audit.limits.energy)
                                  : "and none was exchanged");
  if (audit.energy == Audit::Energy::not_conserved)
    all.push_back({&finding::energy_not_conserved, "", off,
                   first + (adaptive ? "use a smaller tolerance (--tolerance), or find singular configurations "
                                       "(lockstep check)"
                                     : "use a smaller step (--step)"),
                   audit.imbalance_share(), audit.limits.energy});
  if (audit.energy == Audit::Energy::not_judged)
    all.push_back({&finding::energy_not_judged, "",
                   fmt::format("{}: force{} {} {} work without potential, dissipation or supply", off,
                               audit.unbooked_forces.size() > 1 ? "s" : "", text::join(audit.unbooked_forces),
                               audit.unbooked_forces.size() > 1 ? "do" : "does"),
                   "", audit.imbalance_share(), audit.limits.energy});
}

}  // namespace

std::vector<Finding> share_findings(System& system, const Mechanism& m, std::initializer_list<const State*> states) {
  std::vector<ChannelRequest> read = m.run.require;
  for (ChannelRequest& r : read)
    r.name = "requirement " + (r.name.empty() ? "" : "'" + r.name + "' ") + "(" + r.channel.substr(1) + ")";
  for (const EventRequest& e : m.events)
    read.push_back({e.channel, "event '" + e.event.name + "' (" + e.channel + ")"});
  const bool reacts = std::ranges::any_of(m.system.forces(), [](const auto& f) { return f->reacting() != nullptr; });
  if (!reacts && !are_of_reactions(read)) return {};
  Dynamics eye(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  for (const State* const state : states) try {
      UniquenessReport found = uniqueness(eye, *state);
      for (std::string& name : columns_not_unique(read, found)) found.readers.push_back(std::move(name));
      if (found.readers.empty() || branch_point(eye, *state).singular) continue;  // there reactions have no value
      return {{&finding::depends_on_share, "",
               "the result depends on how redundant constraints share a load, by " + first_of(found.readers),
               "release the redundant constraints, which lockstep check --verbose lists, or add the compliance of the "
               "joints"}};
    } catch (const Error&) {  // the run reports the error
    }
  return {};
}

std::vector<Finding> run_findings(StepLoop& run, const Audit& audit, const Doubts& doubts,
                                  const SingularWatch& singular) {
  const SimulationReport& report = run.report();
  const IntegratorInfo& method = run.integrator().info();
  std::vector<Finding> all;
  if (!singular.passed().empty())
    all.push_back(finding_of(singular.passed(), singular.n_passed(), method,
                             run.dynamics().options().stabilization.kind == Stabilization::Kind::project));
  for (Finding& f : doubts.findings(report.steps, run.state().t)) all.push_back(std::move(f));
  add_energy(all, audit, method.adaptive, tests_first(run.dynamics().system()));
  if (audit.drifted)
    all.push_back({&finding::constraints_drifted, "",
                   fmt::format("constraint violation up to {:.2g} m after a step (limit {:.2g} m)", audit.violation,
                               audit.limits.violation),
                   "project after each step (\"stabilization\": \"project\")", audit.violation, audit.limits.violation,
                   "m"});
  if (std::isfinite(report.stiff_since))
    all.push_back({&finding::stiff, "",
                   fmt::format("damped fast modes limited the steps from t = {:.4g} s on", report.stiff_since),
                   "an implicit method, such as --integrator radau5, may be cheaper: compare by lockstep advise",
                   std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(), "",
                   report.stiff_since});
  return all;
}

}  // namespace lockstep
