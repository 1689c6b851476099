// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <cmath>

#include "framework/dynamics/evaluate/loop_rows.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/mechanism/rows/loads.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

std::span<const double> view(const VecX& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

}  // namespace

const Inputs& StateInputs::at(const System& system, const State& state) {
  passes::motions(system, state, motions_);
  look_at(state);
  in_.motions = motions_;
  return in_;
}

void StateInputs::look_at(const State& state) {
  in_ = {.t = state.t, .motions = {}, .s = view(state.s), .z = view(state.z), .angle_rates = {}, .angles = {}};
}

Evaluation::Evaluation(System& system, const State& state) : Evaluation(system) { at(state); }

bool Evaluation::covers(const State& state) const {
  return layout_ && system_.ready() && system_.revision() == layout_->revision && state.modes == layout_->modes;
}

void Evaluation::lay_out(const State& state) {
  if (covers(state)) return system_.check_size(state);
  system_.setup();
  system_.check_size(state);
  layout_ = nullptr, redundant_ = Kkt::kUnknown;
  passes::lay_out(system_, state.modes, rows_);
  f_.setZero(6 * system_.n_slots());
  reacting_.clear();
  for (const auto& force : system_.forces())
    if (force->reacting() != nullptr) reacting_.push_back(force.get());
  loops_ = std::make_shared<const LoopSizes>(system_, state.modes);
  layout_ = std::make_shared<const Layout>(Layout{system_.revision(), state.modes, has_loops(system_, state.modes)});
}

void Evaluation::at(const State& state) {
  rows_at(state);
  passes::gather_forces(system_, inputs(), f_);
}

void Evaluation::rows_at(const State& state) {
  lay_out(state);
  passes::gather_rows(system_, inputs_.at(system_, state), rows_);
  f_.setZero();
}

void Evaluation::check() const { check_finite(system_, inputs(), rows_, f_); }

void Evaluation::residuals(VecX& C, VecX& Cd) const { find_residuals(rows_, inputs().motions, C, Cd); }

void Evaluation::velocity_residual(const VecX& v, VecX& Cd) const {
  check_size("Evaluation::velocity_residual: a vector", v.size(), f_.size());
  Cd.resize(rows_.n_rows);
  for (const RowEntry& e : rows_.entries)
    for (int k = 0; k < e.m; ++k) Cd[e.first_row + k] = rows_.block(e).Ct(k);
  for_each_jacobian(rows_, [&](int row, int slot, const auto& J) { Cd[row] += J.dot(v.segment<6>(6 * slot)); });
}

double Evaluation::norm(const VecX& c) const {
  check_size("Evaluation::norm: a vector", c.size(), rows_.n_rows);
  double worst = 0;
  const double L = system_.length();
  for (const RowEntry& e : rows_.entries)
    for (int k = 0; k < e.m; ++k) {
      const double x = length_per_unit(e.kind[k], L) * std::abs(c[e.first_row + k]);
      worst = x > worst || std::isnan(x) ? x : worst;
    }
  return worst;
}

void Evaluation::react(const VecX& lambda, VecX& f) const {
  check_size("Evaluation::react, lambda: a vector", lambda.size(), rows_.n_rows);
  check_size("Evaluation::react, f: a vector", f.size(), f_.size());
  const Reactions reactions(rows_, view(lambda));
  WrenchSum sum(inputs().motions, f);
  for (const Force* force : reacting_)
    if (force->acts(inputs())) named(*force, inputs().t, [&] { force->reacting()->react(inputs(), reactions, sum); });
}

}  // namespace lockstep
