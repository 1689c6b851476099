#include "framework/dynamics/simulate/consistency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/scales.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

// The name of the row whose number is largest. For error messages.
std::string largest_row(const Evaluation& at, const VecX& sizes) {
  Eigen::Index worst = 0;
  if (sizes.size() > 0) sizes.maxCoeff(&worst);
  return sizes.size() > 0 ? at.system().row_name(at.rows(), static_cast<int>(worst)) : "no row";
}

// Each row as Evaluation::norm counts it.
VecX norms(const Evaluation& at, const VecX& c) {
  VecX sizes = VecX::Zero(c.size());
  const double L = at.system().length();
  for (const RowEntry& e : at.rows().entries)
    for (int k = 0; k < e.m; ++k)
      sizes[e.first_row + k] = length_per_unit(e.kind[static_cast<std::size_t>(k)], L) * std::abs(c[e.first_row + k]);
  return sizes;
}

}  // namespace

void check_gradients(const Evaluation& e) {
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int k = 0; entry.slots.n > 0 && k < entry.m; ++k) {
      double largest = 0;
      for (int i = 0; i < entry.slots.n; ++i)
        for (const double x : block.J(i, k)) largest = std::max(largest, std::abs(x));
      if (largest == 0)
        throw AssemblyError(
            fmt::format("{} has no gradient at the start: no motion of its bodies changes it here, as at the centre of "
                        "a curve or on "
                        "the axis of a cam; start them elsewhere",
                        e.system().row_name(e.rows(), entry.first_row + k)));
    }
  }
}

VecX start_distances(const Evaluation& e, const VecX& C) {
  VecX off = norms(e, C);
  const double L = e.system().length();
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int k = 0; k < entry.m; ++k) {
      const int row = entry.first_row + k;
      if (entry.kind[static_cast<std::size_t>(k)] == RowKind::rotation || C[row] == 0) continue;
      double square = 0;  // of the gradient, by m; turns count as lengths
      for (int i = 0; i < entry.slots.n; ++i) {
        const auto J = block.J(i, k);
        for (std::size_t c = 0; c < 6; ++c) square += J[c] * J[c] / (c < 3 ? 1.0 : L * L);
      }
      if (square > 0) off[row] = std::max(off[row], std::abs(C[row]) / std::sqrt(square));
    }
  }
  return off;
}

double start_distance(const Evaluation& e, const VecX& C) {
  const VecX off = start_distances(e, C);
  return off.hasNaN() ? std::numeric_limits<double>::quiet_NaN() : off.size() > 0 ? off.maxCoeff() : 0.0;
}

void check_start(Dynamics& dynamics, const State& s, double limit) {
  const Evaluation& at = dynamics.gather_rows(s);
  check_gradients(at);
  VecX C, Cd;
  at.residuals(C, Cd);
  const double c = start_distance(at, C);
  if (!(c <= limit))
    throw AssemblyError(
        fmt::format("the start at t = {:.9g} s violates the constraints by {:.3g} m (limit {:.3g} m), most of "
                    "all {}; assemble it first",
                    s.t, c, limit, largest_row(at, start_distances(at, C))));
  const VecX speeds = norms(at, Cd);
  const double cv = dynamics.violation_v(s);
  if (!(cv <= limit))
    throw AssemblyError(fmt::format(
        "the start velocities at t = {:.9g} s violate the constraints by {:.3g} m/s (limit {:.3g} m/s), most "
        "of all {}; assemble them first",
        s.t, cv, limit, largest_row(at, speeds)));
}

double before_jump(double jump, double span) { return 1e-10 * std::max(std::abs(jump), span); }

void cross_rest(Dynamics& dynamics, State& state, double t, StateRate& rate) {
  const double h = t - state.t;
  if (h > 0) {
    dynamics.rates(state, rate);
    state.q += h * rate.q;
    state.v += h * rate.v;
    state.s += h * rate.s;
    dynamics.normalize(state);
  }
  state.t = t;
}

void engage_links(Dynamics& dynamics, State& state, const std::vector<std::string>& links) {
  for (const std::string& name : links) {
    const Lock& link = dynamics.system().link(name);
    const int n = link.n_own_states();
    if (n == 0) continue;
    const Inputs& in = dynamics.inputs(state);
    named(link, state.t, [&] {
      link.stateful()->engage(in, {state.s.data() + link.first_state(), static_cast<std::size_t>(n)});
    });
  }
}

namespace {

// Whether all that is wanting where its markers are apart is to hold them as they stand.
bool could_hold(const Lock& link) {
  const Jointed* joint = link.jointed();
  return joint != nullptr && joint->imposed().empty() && joint->mask() != Mask::none && !link.unilateral() &&
         link.row_count() == count_rows(joint->mask());
}

}  // namespace

void check_links(Dynamics& dynamics, const State& state, const std::vector<std::string>& links,
                 const std::string& cause, double limit) {
  const Evaluation& at = dynamics.gather_rows(state);
  const RowTable& rows = at.rows();
  for (const std::string& name : links) {
    const Lock& link = dynamics.system().link(name);
    const int entry = rows.entry_of_link[static_cast<std::size_t>(link.number())];
    if (entry < 0) continue;
    const RowEntry& e = rows.entries[static_cast<std::size_t>(entry)];
    VecX c = VecX::Zero(rows.n_rows);
    for (int k = 0; k < e.m; ++k) c[e.first_row + k] = rows.block(e).C(k);
    const double violation = at.norm(c);
    if (!(violation <= limit))
      throw AssemblyError(
          fmt::format("{} activates link '{}' at t = {:.9g} s, where it is {:.3g} m apart (limit {:.3g} m); "
                      "activate it when its markers meet{}",
                      cause, name, state.t, violation, limit,
                      could_hold(link) ? ", or let it \"hold\" where its bodies stand" : ""));
  }
}

void make_consistent(Dynamics& dynamics, State& state, const std::string& cause, double limit) {
  double left = 0;
  if (dynamics.options().stabilization.kind == Stabilization::Kind::project) {
    const double violation = dynamics.violation(state);
    const bool near = violation <= limit;
    const ProjectReport report = near ? dynamics.project(state) : ProjectReport{};
    if (!near || !report.converged)
      throw AssemblyError(fmt::format("{} leaves the constraints violated by {:.3g} m at t = {:.9g} s (limit {:.3g} m)",
                                      cause, violation, state.t, limit));
    left = report.after_v;
  } else {
    left = dynamics.project_velocity(state);
  }
  if (!(left <= limit)) {
    const Evaluation& at = dynamics.gather_rows(state);
    VecX C, Cd;
    at.residuals(C, Cd);
    throw AssemblyError(fmt::format(
        "{} at t = {:.9g} s leaves inconsistent velocities: they violate the constraints by {:.3g} m/s "
        "(limit {:.3g} m/s), most of all {}; two laws may drive one coordinate{}: look at the drives of "
        "these links",
        cause, state.t, left, limit, largest_row(at, norms(at, Cd)), or_against_stops(dynamics.system(), at.rows())));
  }
  dynamics.accept(state);
}

PositionJump::PositionJump(Dynamics& dynamics, const State& state) {
  dynamics.gather_rows(state).residuals(before_, rates_before_);
}

bool PositionJump::changes_rows(Dynamics& dynamics, const State& state) const {
  VecX C, Cd;
  dynamics.gather_rows(state).residuals(C, Cd);
  return C != before_ || Cd != rates_before_;
}

std::string PositionJump::refusal(Dynamics& dynamics, const State& state, double limit) const {
  const Evaluation& at = dynamics.gather_rows(state);
  VecX C, Cd;
  at.residuals(C, Cd);
  C -= before_;
  const double jump = at.norm(C);
  if (jump <= limit) return "";
  return fmt::format(
      "a law jumps in position at t = {:.9g} s: {} by {:.3g} m (limit {:.3g} m), which no motion follows; "
      "let it pass from one value to the other in a time (types ramp, cycloid, spline)",
      state.t, largest_row(at, norms(at, C)), jump, limit);
}

}  // namespace lockstep
