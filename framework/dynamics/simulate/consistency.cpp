// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/consistency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/integrate/culprit.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

// The size of the gradient of each row of an entry, rotations as lengths.
template <class Act>
void for_each_gradient(const Evaluation& e, const Act& act) {
  const double L = e.system().length();
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int k = 0; entry.slots.n > 0 && k < entry.m; ++k) {
      double square = 0;
      for (int i = 0; i < entry.slots.n; ++i) {
        const auto J = block.J(i, k);
        for (std::size_t c = 0; c < 6; ++c) square += J[c] * J[c] / (c < 3 ? 1.0 : L * L);
      }
      act(entry.first_row + k, entry.kind[k], std::sqrt(square));
    }
  }
}

// Whether it could hold its markers in their present pose.
bool could_hold(const Lock& link) {
  const Jointed* joint = link.jointed();
  return joint != nullptr && joint->imposed().empty() && joint->mask() != Mask::none && !link.unilateral() &&
         link.row_count() == count_rows(joint->mask());
}

}  // namespace

// A row of the rotation alone, e3 = 0, holds the rotation about z by e0/2 (4.21).
double unfolded(const Lock& link, const Inputs& in) {
  const Jointed* const joint = link.jointed();
  if (joint == nullptr || count_rows(joint->mask() & Mask::e123) != 1 || joint->imposed().turn) return 1;
  const auto [p, s] = link.pairs().front();
  return std::abs(MovingPair<Reads::rotation>(MarkerFrame(*p), MarkerFrame(*s), in).y()[3]);
}

std::string worst_rows(const Evaluation& e, const VecX& sizes) {
  std::vector<int> order(sizes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, std::greater{}, [&](int row) { return sizes[row]; });
  std::vector<std::string> words;
  for (std::size_t i = 0; i < order.size() && i < 3; ++i)
    words.push_back(passes::row_name(e.system(), e.rows(), order[i]) + " (" + text::brief(sizes[order[i]]) + ")");
  return words.empty() ? "no constraint" : text::join(words);
}

void check_gradients(const Evaluation& e) {
  for_each_gradient(e, [&](int row, RowKind, double size) {
    if (size == 0)
      throw AssemblyError(
          fmt::format("{} has no gradient at the start, as at the centre of a curve or on the axis of a cam; start its "
                      "bodies elsewhere",
                      passes::row_name(e.system(), e.rows(), row)));
  });
}

VecX start_distances(const Evaluation& e, const VecX& C) {
  VecX off = row_sizes(e, C);
  for_each_gradient(e, [&](int row, RowKind kind, double size) {
    if (kind != RowKind::rotation && C[row] != 0 && size > 0) off[row] = std::max(off[row], std::abs(C[row]) / size);
  });
  return off;
}

double start_distance(const Evaluation& e, const VecX& C) {
  const VecX off = start_distances(e, C);
  return off.hasNaN() ? std::numeric_limits<double>::quiet_NaN() : off.size() > 0 ? off.maxCoeff() : 0.0;
}

void check_start(Dynamics& dynamics, const State& s, double limit) {
  const Evaluation& at = dynamics.gather_rows(s);
  check_gradients(at);
  for (const RowEntry& entry : at.rows().entries) {
    const Lock& link = *at.system().links()[entry.link];
    if (!(unfolded(link, at.inputs()) > kSlight))
      throw AssemblyError(
          fmt::format("joint '{}' is folded by 180 deg at the start, where its constraint of a rotation has no effect; "
                      "start it elsewhere",
                      link.name()));
  }
  const VecX C = Residuals(at).C;
  const double c = start_distance(at, C);
  if (!(c <= limit))
    throw AssemblyError(fmt::format(
        "the start at t = {:.9g} s violates the constraints by {:.3g} m (limit {:.3g} m), worst: {}; assemble it first",
        s.t, c, limit, worst_rows(at, start_distances(at, C))));
  check_velocities(dynamics, s, dynamics.violation_v(s), limit, "the start", "assemble it first, or ");
}

void check_velocities(Dynamics& dynamics, const State& state, double left, double limit, const std::string& cause,
                      const char* advice) {
  if (left <= limit) return;
  const Evaluation& at = dynamics.gather_rows(state);
  throw AssemblyError(fmt::format(
      "{} at t = {:.9g} s leaves inconsistent velocities: they violate the constraints by {:.3g} m/s (limit {:.3g} "
      "m/s), worst: {}; two laws may drive one coordinate{}, nearly redundant constraints may lock a drive, or it is "
      "in a limit position (dead centre): {}check the axes and drives of these joints",
      cause, state.t, left, limit, worst_rows(at, row_sizes(at, Residuals(at).Cd)),
      or_against_stops(dynamics.system(), at.rows()), advice));
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

void check_links(Dynamics& dynamics, const State& state, const std::vector<std::string>& links,
                 const std::string& cause, double limit) {
  const Evaluation& at = dynamics.gather_rows(state);
  const RowTable& rows = at.rows();
  const VecX sizes = row_sizes(at, Residuals(at).C);
  for (const std::string& name : links) {
    const Lock& link = dynamics.system().link(name);
    const int entry = rows.entry_of_link[link.number()];
    if (entry < 0) continue;
    const RowEntry& e = rows.entries[entry];
    const double violation = sizes.segment(e.first_row, e.m).lpNorm<Eigen::Infinity>();
    if (!(violation <= limit))
      throw AssemblyError(fmt::format(
          "{} activates joint '{}' at t = {:.9g} s, when it is {:.3g} m apart (limit {:.3g} m); activate it when its "
          "markers meet{}",
          cause, name, state.t, violation, limit, could_hold(link) ? ", or let it \"hold\" the present pose" : ""));
  }
}

void make_consistent(Dynamics& dynamics, State& state, const std::string& cause, double limit) {
  double left = 0;
  if (dynamics.options().stabilization.kind == Stabilization::Kind::project) {
    const double violation = dynamics.violation(state);
    const bool near = violation <= limit;
    const ProjectReport report = near ? dynamics.project(state) : ProjectReport{};
    if (!near || !report.converged)
      throw AssemblyError(fmt::format("{} violates the constraints by {:.3g} m at t = {:.9g} s (limit {:.3g} m)", cause,
                                      violation, state.t, limit));
    left = report.after_v;
  } else {
    left = dynamics.project_velocity(state);
  }
  check_velocities(dynamics, state, left, limit, cause);
  dynamics.accept(state);
}

// The coordinates that active drives prescribe.
static std::vector<PositionJump::Prescribed> prescribed(const System& system, const State& state) {
  std::vector<PositionJump::Prescribed> all;
  for (const auto& link : system.links())
    if (const Jointed* joint = link->jointed(); joint != nullptr && state.modes[link->number()])
      for (int d = 0; const Drive& drive : joint->imposed().drives) {
        const LawValue law = drive.law->at(state.t);
        const Quantity of = link->driven()->drive(d++);
        all.push_back({link.get(), "drive " + link->name() + "." + of.name, of.unit, drive.speed ? 0 : law.y,
                       drive.speed ? law.y : law.yd});
      }
  return all;
}

PositionJump::PositionJump(Dynamics& dynamics, const State& state)
    : before_(dynamics.gather_rows(state)), prescribed_(prescribed(dynamics.system(), state)) {}

bool PositionJump::changes_rows(Dynamics& dynamics, const State& state) const {
  return Residuals(dynamics.gather_rows(state)) != before_;
}

std::string PositionJump::cause(const System& system, const State& state) const {
  for (std::size_t k = 0; const Prescribed& now : prescribed(system, state))
    if (const double was = prescribed_[k++].yd; std::abs(now.yd - was) > kSlight * std::abs(now.yd + was))
      return "the jump of " + now.name + " in speed, an impact whose load is not recorded";
  return "the jump of a law";
}

std::optional<AssemblyError> PositionJump::refusal(Dynamics& dynamics, const State& state, double limit) const {
  const Evaluation& at = dynamics.gather_rows(state);
  const VecX C = Residuals(at).C - before_.C;
  const double jump = at.norm(C);
  if (jump <= limit) return {};
  Eigen::Index worst = 0;
  row_sizes(at, C).maxCoeff(&worst);
  const System& system = dynamics.system();
  Thing thing = thing_of_row(system, at.rows(), static_cast<int>(worst));
  std::string who = "a law of " + thing.words(), far = fmt::format("{:.3g} m", jump);
  double most = limit;
  for (std::size_t k = 0; const Prescribed& now : prescribed(system, state))
    if (const double by = std::abs(now.y - prescribed_[k++].y); by > most)
      most = by, thing = thing_of(*now.link), who = now.name, far = fmt::format("{:.4g} {}", by, now.unit);
  return AssemblyError(fmt::format("{} jumps in position at t = {:.9g} s by {}; use a continuous law (ramp, cycloid, "
                                   "spline), \"continue\": true of a sequence, or \"drift\": true of a repeat",
                                   who, state.t, far),
                       {.thing = std::move(thing), .t = state.t});
}

}  // namespace lockstep
