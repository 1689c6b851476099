// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/energies.h"

namespace lockstep {

namespace {

constexpr double kRounding = 1e-9;  // of the energies themselves: a smaller imbalance is no loss,
constexpr double kStill = 1e-14;    // nor one below this times m L^2 / s^2,
constexpr double kPlace = 1e-13;    // or of the length, by which rounding may move a weight: times m g L

}  // namespace

struct EnergyAudit::Books {
  struct Range {
    double least = 0, most = 0;  // zero belongs to it
    void add(double x) { least = std::min(least, x), most = std::max(most, x); }
    double size() const { return most - least; }
  };
  Books(AuditLimits l, EnergyTerms t) : limits(l), terms(t) {}
  AuditLimits limits;
  EnergyTerms terms;
  std::array<Range, 5> ranges;  // of the Energies, the potential less that at the start
  double least = 0;             // imbalance that counts, J
  double first_potential = 0, first_balance = 0, at_instants = 0, before = 0;
  double largest_kinetic = 0, largest_potential = 0;
  std::vector<bool> gives_power, booked_forces;  // of the forces
  std::vector<std::string> force_names;
  VecX f;
  Audit audit;

  // The numbers that a checkpoint keeps.
  std::array<double*, 23> numbers() {
    auto& r = ranges;
    return {&r[0].least,  &r[0].most, &r[1].least,      &r[1].most,         &r[2].least,      &r[2].most,
            &r[3].least,  &r[3].most, &r[4].least,      &r[4].most,         &first_potential, &first_balance,
            &at_instants, &before,    &largest_kinetic, &largest_potential, &audit.imbalance, &audit.violation,
            &audit.start, &audit.end, &audit.drives,    &audit.supplied,    &audit.dissipated};
  }
  void compare(const Energies& e) {
    const double off = std::abs(e.balance() - first_balance - at_instants);
    if (!(off <= audit.imbalance) && !std::isnan(audit.imbalance)) audit.imbalance = off;
  }
  // Ranges and imbalances are those of all steps: outputs may be few, or meet a motion at equal phases.
  void widen(const Energies& e) {
    const double values[] = {e.kinetic, e.potential - first_potential, e.drives, e.supplied, e.dissipated};
    for (std::size_t k = 0; k < ranges.size(); ++k) ranges[k].add(values[k]);
    largest_kinetic = std::max(largest_kinetic, e.kinetic);
    largest_potential = std::max(largest_potential, std::abs(e.potential));
  }
  void look_at_forces(const Sample&);
};

EnergyAudit::EnergyAudit(System& system, AuditLimits limits)
    : books_(std::make_unique<Books>(limits, EnergyTerms(system, false))) {}

EnergyAudit::~EnergyAudit() = default;

void EnergyAudit::start(const Sample& s) {
  Books& b = *books_ = Books(books_->limits, books_->terms);
  const double L = s.system().length(), g = s.system().gravity().norm();
  b.audit.limits = b.limits.of(L);
  for (int k = 0; k < s.system().n_slots(); ++k) b.least += s.system().slot(k).mass * L * (kStill * L + kPlace * g);
  for (const auto& force : s.system().forces()) b.force_names.push_back(force->name());
  b.gives_power.assign(b.force_names.size(), false), b.booked_forces = b.gives_power;
  const Energies first = b.terms.at(s);
  b.first_potential = first.potential;
  b.first_balance = b.before = first.balance();
  b.audit.start = first.kinetic + first.potential;
  output(s);
}

void EnergyAudit::step(const Sample& s) {
  Books& b = *books_;
  const Energies now = b.terms.at(s);
  b.before = now.balance();
  b.widen(now), b.compare(now);
  double& most = b.audit.violation;  // once it is no number it stays none
  if (!std::isnan(most) && !(s.report.violation_after <= most)) most = s.report.violation_after;
}

// The same instant after an event, an impact or a jump.
void EnergyAudit::jumped(const Sample& s) {
  if (s.cause.empty()) return;
  Books& b = *books_;
  const Energies now = b.terms.at(s);
  const double change = now.balance() - b.before;
  b.widen(now);
  b.at_instants += change;
  std::vector<Audit::Instant>& all = b.audit.instants;
  auto found = std::find_if(all.begin(), all.end(), [&](const Audit::Instant& i) { return i.cause == s.cause; });
  if (found == all.end()) found = all.insert(all.end(), {std::string(s.cause), 0, s.state.t, s.state.t, 0.0});
  ++found->count, found->last = s.state.t, found->energy += change;
}

void EnergyAudit::output(const Sample& s) {
  Books& b = *books_;
  const Energies now = b.terms.at(s);
  b.audit.drives = now.drives, b.audit.supplied = now.supplied, b.audit.dissipated = now.dissipated;
  b.audit.end = now.kinetic + now.potential;
  b.widen(now), b.compare(now);
  b.look_at_forces(s);
}

// A force whose wrench does work while it has neither potential, loss nor supply.
void EnergyAudit::Books::look_at_forces(const Sample& s) {
  const Inputs& in = s.inputs();
  for (std::size_t k = 0; k < gives_power.size(); ++k) {
    const Force& force = *s.system().forces()[k];
    if (booked_forces[k] || !force.acts(in)) continue;
    booked_forces[k] = named(
        force, in.t, [&] { return force.potential(in) != 0 || force.dissipation(in) != 0 || force.supply(in) != 0; });
    gives_power[k] = gives_power[k] || channels::power_of(force, in, nullptr, f) != 0;
  }
}

void EnergyAudit::save(Snapshot& out) const {
  Books& b = *books_;
  for (const double* x : b.numbers()) out.put(*x);
  out.put_all(b.gives_power), out.put_all(b.booked_forces);
  const Audit& a = b.audit;
  out.put(static_cast<double>(a.instants.size()));
  for (const Audit::Instant& i : a.instants) {
    out.put_text(i.cause);
    for (const double x : {static_cast<double>(i.count), i.first, i.last, i.energy}) out.put(x);
  }
}

void EnergyAudit::load(SnapshotReader& in) {
  Books& b = *books_;
  for (double* x : b.numbers()) *x = in.get();
  in.get_all(b.gives_power), in.get_all(b.booked_forces);
  if (b.gives_power.size() != b.force_names.size() || b.booked_forces.size() != b.force_names.size())
    throw ModelError("the saved energy terms belong to other forces than those of the system");
  Audit& a = b.audit;
  a.instants.clear();
  for (long n = in.get_count(); n > 0; --n) {
    Audit::Instant i;
    i.cause = in.get_text(), i.count = in.get_count();
    i.first = in.get(), i.last = in.get(), i.energy = in.get();
    a.instants.push_back(std::move(i));
  }
}

const char* Audit::verdict() const {
  constexpr const char* kWords[] = {"conserved", "not conserved", "not judged"};
  return kWords[static_cast<int>(energy)];
}

Audit EnergyAudit::result() const {
  const Books& b = *books_;
  Audit audit = b.audit;
  for (const Books::Range& r : b.ranges) audit.scale = std::max(audit.scale, r.size());
  if (audit.scale <= b.least) audit.scale = 0;  // round-off
  audit.drifted = !(audit.violation <= audit.limits.violation);
  for (std::size_t k = 0; k < b.force_names.size(); ++k)
    if (b.gives_power[k] && !b.booked_forces[k]) audit.unbooked_forces.push_back(b.force_names[k]);
  const double least = std::max(b.least, kRounding * std::max(b.largest_kinetic, b.largest_potential));
  if (audit.imbalance <= std::max(audit.limits.energy * audit.scale, least)) return audit;
  audit.energy = audit.unbooked_forces.empty() ? Audit::Energy::not_conserved : Audit::Energy::not_judged;
  return audit;
}

}  // namespace lockstep
