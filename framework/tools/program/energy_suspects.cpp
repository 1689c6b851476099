// SPDX-License-Identifier: BSD-3-Clause
// What may have changed the energy of a run that did not conserve it.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/author/check.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/tools/program/run_words.h"

namespace lockstep {
namespace {

// What a check finds wrong with the powers of a force; "" if nothing, or if it cannot be checked.
std::string wrong_power(System& system, const Force& force) try {
  const CheckReport report = check_force(system, force, {.states = 2});
  for (const CheckFinding& f : report.findings())
    if (f.what.starts_with("gives ") || f.what.starts_with("dissipation() is "))
      return fmt::format("force '{}' ({}), which {}", force.name(), force.type(), f.what);
  return {};
} catch (const std::exception&) {
  return {};
}

std::string passed_clause(const std::vector<PassedPosition>& passed, long n) {
  const PassedPosition& first = passed.front();
  return fmt::format("the singular configuration at t = {:.6g} s{}{}", first.t,
                     first.links.empty() ? "" : fmt::format(" (joints {})", first_of(first.links)),
                     n > 1 ? fmt::format(", the first of {}", n) : "");
}

}  // namespace

// The likeliest first: forces whose potential, dissipation or supply do not fit their load (check_force() at a few
// states near the start), singular configurations that the motion passed, constraint violation, unprojected stages in
// loops with drives, long rotations in fixed steps.
std::vector<Finding> suspects_of(const EndedRun& run, System& system, long n_passed) {
  constexpr double kLongTurn = 0.5, kOff = 1e-6;  // rad in a step; of the length
  constexpr std::size_t kMost = 4;
  std::vector<Finding> all;
  const auto add = [&](const std::string& clause) { all.push_back({&finding::energy_suspect, "", clause}); };
  if (run.audit.energy != Audit::Energy::not_conserved) return {};
  const SimulationReport& r = run.sim.report();
  Dynamics& dynamics = run.sim.dynamics();
  for (const auto& force : system.forces())
    if (const std::string words = wrong_power(system, *force); !words.empty()) add(words);
  if (!run.passed.empty()) add(passed_clause(run.passed, n_passed));
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  if (!projects && run.audit.violation > kOff * system.length())
    add(fmt::format("the constraint violation of {:.2g} m, which does work (use stabilization project)",
                    run.audit.violation));
  if (run.formulation == "omega" && projects && run.audit.drives != 0 && has_loops(system, run.sim.state().modes))
    add(std::string("the work of the drives, which unprojected stages compute less accurately in loops (use ") +
        (run.sim.integrator().info().joint ? "formulation joint, or " : "") + "a smaller step or tolerance)");
  if (!run.sim.integrator().info().adaptive && r.largest_turn > kLongTurn)
    add(fmt::format("long steps: body '{}' rotates by up to {:.2g} rad in one of them", r.turned_most, r.largest_turn));
  return {all.begin(), all.begin() + static_cast<long>(std::min(all.size(), kMost))};
}

}  // namespace lockstep
