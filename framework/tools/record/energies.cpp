// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/energies.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {

namespace {

// The energy of a force must be a number; if its wrench is none, that is the cause.
double must_be_number(const System& system, const Force& f, const char* what, double value, const Inputs& in) {
  if (std::isfinite(value)) return value;
  check_wrench(system, in, f);
  const Thing whose = thing_of(f);
  const std::string own = whose.origin == "built in" ? "" : std::string(": ") + what + " is " + text::number(value);
  throw NonFiniteError(at_time(in.t) + whose.label() + ": its energy is not finite" + own + "; " +
                           (in.t == 0 ? "check its parameters" : kShorterStep),
                       {.thing = whose, .t = in.t});
}

// Adds the energy of slot k to a sum, which may be too large for a double.
void add_energy(const Sample& s, int k, const char* what, double energy, double& sum) {
  sum += energy;
  if (std::isfinite(sum)) return;
  const Thing body{.kind = "body", .name = s.system().body_of_slot(k).name};
  throw NonFiniteError(at_time(s.state.t) + "with " + body.words() + " the " + what + " energy is " +
                           text::number(sum) + ", which is not finite; " +
                           (s.state.t == 0 ? "check gravity, masses and speeds" : kShorterStep),
                       {.thing = body, .t = s.state.t});
}

// Over all forces at the time of the evaluation, so that forces added later count.
double power_of_forces(const System& system, Work work, const Evaluated& v) {
  double sum = 0;
  for (const auto& f : system.forces()) {
    if (!f->acts(v.in)) continue;
    sum += work == Work::dissipated
               ? must_be_number(system, *f, "dissipation()", channels::loss(*f, v), v.in)
               : must_be_number(system, *f, "supply()", named(*f, v.in.t, [&] { return f->supply(v.in); }), v.in);
  }
  return sum;
}

}  // namespace

double EnergyTerms::kinetic(const Sample& s) {
  double sum = 0;
  for (int k = 0; k < s.system().n_slots(); ++k) {
    const Slot& b = s.system().slot(k);
    const Motion& O = s.inputs().slot(k);
    add_energy(s, k, "kinetic", 0.5 * (b.mass * O.v.squaredNorm() + O.w.dot(b.J * O.w)), sum);
  }
  return sum;
}

double EnergyTerms::potential(const Sample& s) {
  double sum = 0;
  for (int k = 0; k < s.system().n_slots(); ++k)
    add_energy(s, k, "potential", -s.system().slot(k).mass * s.system().gravity().dot(s.inputs().slot(k).x), sum);
  for (const auto& f : s.system().forces())
    if (f->acts(s.inputs()))
      sum += must_be_number(s.system(), *f, "potential()",
                            named(*f, s.state.t, [&] { return f->potential(s.inputs()); }), s.inputs());
  return sum;
}

const Quadrature& work_of(System& system, Work work) {
  if (work == Work::drives)
    return quadrature(
        system, "energy.drives",
        [](const Evaluated& v) { return std::isnan(v.law_power) ? power_of_laws(v.rows, v.lambda) : v.law_power; },
        Integrand::laws);
  return quadrature(system, work == Work::supplied ? "energy.supplied" : "energy.dissipated",
                    [&system, work](const Evaluated& v) { return power_of_forces(system, work, v); });
}

double EnergyTerms::lost_in_impacts(const Sample& s) {
  double sum = 0;
  for (const auto& link : s.system().links())
    if (link->unilateral()) sum += s.state.z[link->impact_memory()];
  return sum;
}

// Only after setup links know their laws.
EnergyTerms::EnergyTerms(System& system, bool all)
    : impacts_(all ||
               std::ranges::any_of(system.links(), [](const auto& link) { return link->unilateral() != nullptr; })) {
  if (!system.ready()) system.setup();
  const bool forces = all || !system.forces().empty();
  if (all || may_have_laws(system)) drives_ = &work_of(system, Work::drives);
  if (forces) supplied_ = &work_of(system, Work::supplied), dissipated_ = &work_of(system, Work::dissipated);
}

Energies EnergyTerms::at(const Sample& s) const {
  const auto work = [&](const Quadrature* q) { return q ? q->value(s.state) : 0.0; };
  return {kinetic(s), potential(s), work(drives_), work(supplied_),
          work(dissipated_) + (impacts_ ? lost_in_impacts(s) : 0.0)};
}

}  // namespace lockstep
