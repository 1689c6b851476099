// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/integrate/culprit.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <vector>

#include <lockstep/author/stepping.h>
#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr double kContradict = 1e-6;     // residual of a row that contradicts others
constexpr double kNotableChange = 1e-2;  // relative change
constexpr double kSmall = 1e-3;          // of the largest of its kind: what is smaller changes little

// What links and forces give at one state: of each force its wrenches, 6 per slot; of each row its Jacobian, slot by
// slot, and Qhat, the acceleration that it prescribes; zeros of joints whose rows follow the motion alone.
using Given = std::array<std::vector<VecX>, 3>;

Given given_at(Dynamics& dynamics, const State& state) {
  auto all = Given{};
  auto& [forces, directions, asked] = all;
  const Solution& solution = dynamics.evaluate(state);
  const Evaluation& e = solution.evaluation;
  const Reactions reactions(solution);
  for (const auto& force : e.system().forces()) forces.push_back(wrench_of(e.system(), e.inputs(), *force, &reactions));
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    const bool computes = has_function(*e.system().links()[entry.link]);
    for (int k = 0; k < entry.m; ++k) {
      asked.push_back(VecX::Constant(1, computes ? block.Qhat(k) : 0));
      VecX& direction = directions.emplace_back(VecX::Zero(6 * entry.slots.n));
      for (int i = 0; computes && i < entry.slots.n; ++i) {
        const auto r = block.J(i, k);
        std::copy_n(r.begin(), 6, direction.begin() + 6 * i);
      }
    }
  }
  return all;
}

std::string words_of(Dynamics& dynamics, const State& state, const Force& force, const VecX& from, const VecX& to,
                     double after) {
  std::string place;
  if (!force.slots().empty()) {
    const int slot = force.slots().front();
    const Vec3& x = dynamics.inputs(state).slot(slot).x;
    place = fmt::format(", body '{}' at [{:.6g}, {:.6g}, {:.6g}]", dynamics.system().body_of_slot(slot).name, x[0],
                        x[1], x[2]);
  }
  return fmt::format(
      "force '{}' ({}) changes most: from {:.4g} to {:.4g} (N, N m) within {:.2g} s{}; if it is stiff, use an implicit "
      "method (--integrator radau5); if it jumps, let it change smoothly",
      force.name(), force.type(), from.lpNorm<Eigen::Infinity>(), to.lpNorm<Eigen::Infinity>(), after, place);
}

// What changes most between two states, `after` seconds apart; "" for nothing notable.
std::string in_words(Dynamics& dynamics, const State& state, const Given& from, const Given& to, double after) {
  double most = kNotableChange;
  std::size_t kind = 0, which = 0;
  for (std::size_t j = 0; j < from.size(); ++j) {
    double largest = 0;
    for (const auto* given : {&from[j], &to[j]})
      for (const VecX& x : *given) largest = std::max(largest, x.norm());
    for (std::size_t k = 0; k < from[j].size(); ++k) {
      const double size = std::max({from[j][k].norm(), to[j][k].norm(), kSmall * largest});
      const double change = size > 0 ? (to[j][k] - from[j][k]).norm() / size : 0.0;
      if (change > most) most = change, kind = j, which = k;
    }
  }
  if (most == kNotableChange) return {};
  const VecX &was = from[kind][which], &is = to[kind][which];
  if (kind == 0) return words_of(dynamics, state, *dynamics.system().forces()[which], was, is, after);
  return fmt::format(
      "{} changes most: {} within {:.2g} s; check its laws, the branches of its function, and whether its direction is "
      "undefined here",
      passes::row_name(dynamics.system(), dynamics.gather(state).rows(), static_cast<int>(which)),
      kind == 1 ? fmt::format("its direction by {:.2g} %", 100 * most)
                : fmt::format("the acceleration that it prescribes from {:.4g} to {:.4g}", was[0], is[0]),
      after);
}

}  // namespace

std::string who_varies(Dynamics& dynamics, const State& state, double after) {
  try {
    const double off = dynamics.violation(state) / dynamics.system().length();
    const Solution& now = dynamics.evaluate(state);
    if (const SolveReport report = now.full_report();
        report.worst_row >= 0 && report.residual > std::max(kContradict, kLeftPerViolation * off))
      return fmt::format("{} contradicts the others (residual {:.2g} % of its right-hand side){}",
                         passes::row_name(dynamics.system(), now.rows, report.worst_row), 100 * report.residual,
                         or_against_stops(dynamics.system(), now.rows));
    const Given from = given_at(dynamics, state);
    State then = state;
    StateRate rate;
    dynamics.rates(state, rate);
    then.q += after * rate.q, then.v += after * rate.v;
    then.s += after * rate.s;
    then.t += after;
    dynamics.normalize(then);
    return in_words(dynamics, state, from, given_at(dynamics, then), after);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::non_finite) throw;
    return error.what();
  }
}

VecX row_sizes(const Evaluation& at, const VecX& c) {
  VecX sizes = VecX::Zero(c.size());
  const double L = at.system().length();
  for (const RowEntry& e : at.rows().entries)
    for (int k = 0; k < e.m; ++k) sizes[e.first_row + k] = length_per_unit(e.kind[k], L) * std::abs(c[e.first_row + k]);
  return sizes;
}

std::string most_violated(Dynamics& dynamics, const State& state) {
  const Evaluation& e = dynamics.gather(state);
  VecX C, Cd;
  e.residuals(C, Cd);
  if (C.size() == 0) return "";
  Eigen::Index worst = 0;
  const double most = row_sizes(e, C).maxCoeff(&worst);
  return fmt::format("{} by {:.2g} m", passes::row_name(e.system(), e.rows(), static_cast<int>(worst)), most);
}

StepError end_not_projected(Dynamics& dynamics, const State& end, const ProjectReport& report,
                            const std::string& method, double t, double h) {
  const std::string row = most_violated(dynamics, end);
  return StepError(
      fmt::format("{}: the step of {:.6g} s from t = {:.9g} s violates the constraints by {:.3g} m, and "
                  "projection fails ({:.3g} m remain after {} iterations); take a smaller step (--step), "
                  "or --integrator dopri5, or radau5 if dampers are stiff{}",
                  method, h, t, report.before, report.after, report.rounds, row.empty() ? "" : "; worst: " + row),
      t);
}

ProjectReport project_end_or_throw(Dynamics& dynamics, State& y, const char* method, double t, double h, StagesOn on) {
  const ProjectReport report = project_end(dynamics, y, on);
  if (!report.converged) throw end_not_projected(dynamics, y, report, method, t, h);
  return report;
}

}  // namespace lockstep
