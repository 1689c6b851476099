// SPDX-License-Identifier: BSD-3-Clause
// Channels of forces: their own quantities, power, stored and dissipated energy.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>

#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {

double loss(const Force& f, const Evaluated& v) {
  if (!f.acts(v.in)) return 0;
  return named(f, v.in.t, [&] {
    const Reacting* own = f.reacting();
    return f.dissipation(v.in) + (own ? own->friction_loss(v.in, Reactions(v)) : 0.0);
  });
}

double power_of(const Force& f, const Inputs& in, const Reactions* reactions, VecX& scratch) {
  if (!f.acts(in)) return 0;
  const int n_slots = static_cast<int>(in.motions.size()) - 1;
  scratch.setZero(6 * n_slots);
  WrenchSum sum(in.motions, scratch);
  named(f, in.t, [&] {
    f.apply(in, sum);
    if (reactions) f.reacting()->react(in, *reactions, sum);
  });
  double power = 0;
  for (int k = 0; k < n_slots; ++k)
    power += scratch.segment<3>(6 * k).dot(in.slot(k).v) + scratch.segment<3>(6 * k + 3).dot(in.slot(k).w);
  return power;
}

void of_force(const Force& force, Entries& out) {
  const Force* const f = &force;
  const Reacting* const reacting = force.reacting();
  const Observable* const observable = force.observable();
  const std::vector<Quantity> own = reacting     ? reacting->quantities()
                                    : observable ? observable->quantities()
                                                 : std::vector<Quantity>{};
  std::vector<bool> loads;  // those quantities that vanish while the force does not act
  for (const Quantity& q : own) loads.push_back(q.unit == "N" || q.unit == "N m" || q.unit == "W" || q.unit == "J");
  add_own(out, own, fmt::format("{} force", force.type()), [f, reacting, observable, loads](int k, const Sample& s) {
    const Evaluated& v = s.values();
    if (loads[k] && !f->acts(v.in)) return 0.0;
    return named(*f, v.in.t, [&] {
      return reacting ? reacting->reacting_quantity(k, v.in, Reactions(v)) : observable->quantity(k, v.in);
    });
  });
  // A force's own quantity of that name takes precedence.
  const auto free = [&out](const char* name) { return std::ranges::find(out, name, &Entry::name) == out.end(); };
  const auto scratch = std::make_shared<VecX>();
  if (free("power"))
    add(out, "power", "W", "power of the force on the bodies", [f, reacting, scratch](const Sample& s) {
      const Reactions reactions(s.values());
      return power_of(*f, s.values().in, reacting ? &reactions : nullptr, *scratch);
    });
  if (free("potential"))
    add(out, "potential", "J", "energy stored in the force", [f](const Sample& s) {
      const Inputs& in = s.values().in;
      return f->acts(in) ? named(*f, s.state.t, [&] { return f->potential(in); }) : 0.0;
    });
  if (free("dissipation"))
    add(out, "dissipation", "W", "power dissipated by dampers and friction",
        [f](const Sample& s) { return loss(*f, s.values()); });
  add_integral(out, "dissipated", "J", "energy dissipated since the start", force.name() + ".dissipated",
               [f](const Evaluated& v) { return loss(*f, v); });
}

}  // namespace lockstep::channels
