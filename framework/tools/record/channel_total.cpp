// SPDX-License-Identifier: BSD-3-Clause
// Channels of the whole mechanism: energies, momenta; and of the run.
#include <algorithm>
#include <cmath>
#include <memory>

#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/energies.h"

namespace lockstep::channels {
namespace {

Vec3 momentum(const Sample& s) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < s.system().n_slots(); ++k) sum += s.system().slot(k).mass * s.inputs().slot(k).v;
  return sum;
}

Vec3 angular_momentum(const Sample& s) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < s.system().n_slots(); ++k) {
    const Slot& b = s.system().slot(k);
    const Motion& O = s.inputs().slot(k);
    sum += cross(O.x, Vec3(b.mass * O.v)) + O.A * (b.J * O.w);
  }
  return sum;
}

/// A number that is followed from step to step.
struct KeptNumber final : Observer {
  KeptNumber(double from, std::function<void(double&, const Sample&)> by) : first(from), follow(std::move(by)) {}
  void start(const Sample& s) override { number = first, follow(number, s); }
  void step(const Sample& s) override { follow(number, s); }
  void save(Snapshot& out) const override { out.put(number); }
  void load(SnapshotReader& in) override { number = in.get(); }

  const double first;  ///< before the start
  double number = first;
  std::function<void(double&, const Sample&)> follow;
};

// total - drives - supplied + dissipated, minus its value at the start; of links and forces that are added later, too.
void make_balance(System& system, Channel& c) {
  const EnergyTerms terms(system, true);
  const auto first = std::make_shared<KeptNumber>(NAN, [terms](double& balance, const Sample& s) {
    if (std::isnan(balance)) balance = terms.at(s).balance();
  });
  c.memory = first;
  c.value = [terms, first](const Sample& s) {
    return std::isnan(first->number) ? 0.0 : terms.at(s).balance() - first->number;
  };
}

void make_rejected(System&, Channel& c) {
  const auto count = std::make_shared<KeptNumber>(0, [](double& n, const Sample& s) { n += s.report.rejected; });
  c.memory = count;
  c.value = [count](const Sample&) { return count->number; };
}

}  // namespace

void of_totals(Entries& out) {
  add(out, "energy.kinetic", "J", "kinetic energy of all bodies", EnergyTerms::kinetic);
  add(out, "energy.potential", "J", "potential energy of gravity (0 at the origin) and of all forces",
      EnergyTerms::potential);
  add(out, "energy.total", "J", "kinetic and potential energy",
      [](const Sample& s) { return EnergyTerms::kinetic(s) + EnergyTerms::potential(s); });
  const auto add_work = [&](const char* name, const char* help, Work work) {
    out.push_back({name, "J", help, [work](System& system, Channel& c) {
                     c.value = [&q = work_of(system, work), work](const Sample& s) {
                       return q.value(s.state) + (work == Work::dissipated ? EnergyTerms::lost_in_impacts(s) : 0.0);
                     };
                   }});
  };
  add_work("energy.drives", "work of all drives and moving laws since the start", Work::drives);
  add_work("energy.supplied", "work of the laws and motors of all forces since the start", Work::supplied);
  add_work("energy.dissipated", "energy dissipated by all dampers, friction and impacts since the start",
           Work::dissipated);
  out.push_back({"energy.balance", "J",
                 "energy error: total - drives - supplied + dissipated, minus its value at the start", make_balance});
  add_vector(out, "momentum.", "N s", "momentum of all bodies, world axes", momentum);
  add_vector(out, "angular_momentum.", "N m s", "angular momentum about the origin, world axes", angular_momentum);
}

void of_run(Entries& out) {
  add(out, "step", "s", "size of the last step", [](const Sample& s) { return s.report.h; });
  out.push_back({"rejected", "", "rejected steps since the start", make_rejected});
  const auto scratch = std::make_shared<VecX>();
  const auto room = std::make_shared<RowTable>();
  add(out, "violation", "m", "largest constraint violation, rotations as lengths", [scratch, room](const Sample& s) {
    double most = violation(s.values().evaluation, s.values().rows.entries, *scratch);
    for (const auto& link : s.dynamics().system().links()) most = std::max(most, left_out_violation(*link, s, *room));
    return most;
  });
  add(out, "evaluations", "", "evaluations of the equations of motion since the start, including those for recording",
      [](const Sample& s) { return static_cast<double>(s.dynamics().work().evaluations); });
  add(out, "solver.residual", "", "largest relative residual of the constraint equations",
      [](const Sample& s) { return s.values().full_report().residual; });
  add(out, "solver.corrections", "", "proximal corrections of this solution",
      [](const Sample& s) { return static_cast<double>(s.values().report.corrections); });
  add(out, "solver.detector", "",
      "smallest relative pivot or eigenvalue, redundant constraints excluded; small near a singular configuration",
      [](const Sample& s) { return s.values().full_report().detector; });
  add(out, "solver.smallest_pivot", "", "smallest relative pivot of this solution",
      [](const Sample& s) { return s.values().full_report().smallest_pivot; });
}

}  // namespace lockstep::channels
