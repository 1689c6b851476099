#include "framework/tools/program/suspects.h"

#include <spdlog/fmt/fmt.h>

#include <exception>

#include <lockstep/author/check.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/program/check_dependencies.h"

namespace lockstep {
namespace {

constexpr std::size_t kMost = 4;  // clauses

// What a check finds wrong with the powers of a force; "" where nothing is, or it cannot be looked at.
std::string wrong_power(System& system, const Force& force) try {
  const CheckReport report = check_force(system, force, {.states = 2});
  for (const Finding& f : report.findings())
    if (f.what.starts_with("gives ") || f.what.starts_with("dissipation() is "))
      return fmt::format("force '{}' ({}), which {}", force.name(), force.type(), f.what);
  return {};
} catch (const std::exception&) {
  return {};
}

std::string passed_clause(const EndedRun& run) {
  const PassedPosition& first = run.passed.front();
  return fmt::format("the singular position at t = {:.6g} s{}{}", first.t,
                     first.links.empty() ? "" : fmt::format(" (links {})", first_of(first.links)),
                     run.n_passed > 1 ? fmt::format(", the first of {}", run.n_passed) : "");
}

}  // namespace

std::vector<std::string> suspects_of(const EndedRun& run, System& system) {
  constexpr double kLongTurn = 0.5, kOff = 1e-6;  // rad in a step; of the length
  std::vector<std::string> all;
  if (run.audit.energy != Audit::Energy::not_conserved) return all;
  const SimulationReport& r = run.sim.report();
  Dynamics& dynamics = run.sim.dynamics();
  for (const auto& force : system.forces())
    if (std::string words = wrong_power(system, *force); !words.empty()) all.push_back(std::move(words));
  if (!run.passed.empty()) all.push_back(passed_clause(run));
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  if (!projects && run.audit.violation > kOff * system.length())
    all.push_back(
        fmt::format("the links, which are off by {:.2g} m: what they let go does work (take stabilization project)",
                    run.audit.violation));
  if (run.formulation == "omega" && projects && run.audit.drives != 0 && has_loops(system, run.sim.state().modes))
    all.push_back(
        "the work of the drives: stages off the constraints of a loop know their forces less well (take formulation "
        "joint, or stages manifold)");
  if (!run.sim.integrator().info().adaptive && r.largest_turn > kLongTurn)
    all.push_back(
        fmt::format("the steps, in which body '{}' turns by up to {:.2g} rad", r.turned_most, r.largest_turn));
  if (all.size() > kMost) all.resize(kMost);
  return all;
}

}  // namespace lockstep
