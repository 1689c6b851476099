#include <lockstep/recorder.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr double kRounding = 1e-9;  // of the energies themselves: a smaller imbalance is no loss,
constexpr double kStill = 1e-14;    // nor one below this times m L^2 / s^2,
constexpr double kPlace = 1e-13;    // or of the length, by which rounding may move a weight: times m g L

enum : std::size_t { kKinetic, kPotential, kDrives, kSupplied, kDissipated };

// What a channel without the quantity is worth.
double value_of(const Channel& c, const Sample& s) { return c.value ? c.value(s) : 0.0; }

}  // namespace

struct EnergyAudit::Books {
  struct Range {
    double least = 0, most = 0;  // zero belongs to it
    void add(double x) { least = std::min(least, x), most = std::max(most, x); }
    double size() const { return most - least; }
  };
  AuditLimits limits;
  std::vector<Channel> channels;
  Range kinetic, potential, drives, supplied, dissipated;
  double least = 0;  // imbalance that counts, J
  double first_potential = 0, first_balance = 0, at_instants = 0, before = 0;
  double largest_kinetic = 0, largest_potential = 0;
  std::vector<bool> gives_power, booked_forces;  // of the forces
  std::vector<std::string> force_names;
  VecX f;
  Audit audit;

  struct Energies {
    double kinetic, potential, drives, supplied, dissipated;
    double balance() const { return kinetic + potential - drives - supplied + dissipated; }
  };
  Energies energies(const Sample& s) const {
    return {value_of(channels[kKinetic], s), value_of(channels[kPotential], s), value_of(channels[kDrives], s),
            value_of(channels[kSupplied], s), value_of(channels[kDissipated], s)};
  }
  double balance(const Sample& s) const { return energies(s).balance(); }
  void compare(const Energies& e) {
    const double off = std::abs(e.balance() - first_balance - at_instants);
    if (!(off <= audit.imbalance) && !std::isnan(audit.imbalance)) audit.imbalance = off;
  }
  // Ranges and imbalances are those of all steps: outputs may be few, or meet a motion at equal phases.
  void widen(const Energies& e) {
    kinetic.add(e.kinetic), potential.add(e.potential - first_potential);
    drives.add(e.drives), supplied.add(e.supplied), dissipated.add(e.dissipated);
    largest_kinetic = std::max(largest_kinetic, e.kinetic);
    largest_potential = std::max(largest_potential, std::abs(e.potential));
  }
  void look_at_forces(const Sample&);
};

EnergyAudit::EnergyAudit(System& system, AuditLimits limits) : books_(std::make_unique<Books>()) {
  books_->limits = limits;
  const bool links = !system.links().empty(), forces = !system.forces().empty();
  const bool impacts = std::any_of(system.links().begin(), system.links().end(),
                                   [](const auto& link) { return link->unilateral() != nullptr; });
  const auto add = [&](const char* name, bool present) {  // nothing is integrated in vain
    books_->channels.push_back(present ? make_channel(system, name) : Channel{});
  };
  add("energy.kinetic", true), add("energy.potential", true);
  add("energy.drives", links), add("energy.supplied", forces), add("energy.dissipated", forces || impacts);
}

EnergyAudit::~EnergyAudit() = default;

void EnergyAudit::start(const Sample& s) {
  Books& b = *books_;
  b.kinetic = b.potential = b.drives = b.supplied = b.dissipated = {};
  b.at_instants = b.largest_kinetic = b.largest_potential = 0;
  b.audit = {};
  b.audit.limits = b.limits.of(s.system().length());
  b.least = 0;
  const double L = s.system().length(), g = s.system().gravity().norm();
  for (int k = 0; k < s.system().n_slots(); ++k) b.least += s.system().slot(k).mass * L * (kStill * L + kPlace * g);
  b.force_names.clear();
  for (const auto& force : s.system().forces()) b.force_names.push_back(force->name());
  b.gives_power.assign(s.system().forces().size(), false);
  b.booked_forces.assign(s.system().forces().size(), false);
  b.first_potential = value_of(b.channels[kPotential], s);
  b.first_balance = b.before = b.balance(s);
  b.audit.start = value_of(b.channels[kKinetic], s) + b.first_potential;
  output(s);
}

void EnergyAudit::step(const Sample& s) {
  Books& b = *books_;
  const Books::Energies now = b.energies(s);
  b.before = now.balance();
  b.widen(now), b.compare(now);
  double& most = b.audit.violation;  // once it is no number it stays none
  if (!std::isnan(most) && !(s.report.violation_after <= most)) most = s.report.violation_after;
}

// The same instant after an event, an impact or a jump.
void EnergyAudit::jumped(const Sample& s) {
  if (s.cause.empty()) return;
  Books& b = *books_;
  const Books::Energies now = b.energies(s);
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
  const Books::Energies now = b.energies(s);
  b.audit.drives = now.drives, b.audit.supplied = now.supplied, b.audit.dissipated = now.dissipated;
  b.audit.end = now.kinetic + now.potential;
  b.widen(now), b.compare(now);
  b.look_at_forces(s);
}

// A force whose wrench does work while it has neither potential, loss nor supply.
void EnergyAudit::Books::look_at_forces(const Sample& s) {
  const System& system = s.system();
  const Inputs& in = s.inputs();
  for (std::size_t k = 0; k < gives_power.size(); ++k) {
    if (booked_forces[k]) continue;
    const Force& force = *system.forces()[k];
    if (!force.acts(in)) continue;
    named(force, s.state.t, [&] {
      booked_forces[k] = force.potential(in) != 0 || force.dissipation(in) != 0 || force.supply(in) != 0;
      f.setZero(6 * system.n_slots());
      WrenchSum sum(in.motions, f);
      force.apply(in, sum);
    });
    double power = 0;
    for (int i = 0; i < system.n_slots(); ++i)
      power += f.segment<3>(6 * i).dot(in.slot(i).v) + f.segment<3>(6 * i + 3).dot(in.slot(i).w);
    gives_power[k] = gives_power[k] || power != 0;
  }
}

void EnergyAudit::save(Snapshot& out) const {
  const Books& b = *books_;
  for (const Books::Range* r : {&b.kinetic, &b.potential, &b.drives, &b.supplied, &b.dissipated})
    out.put(r->least), out.put(r->most);
  for (const double x :
       {b.first_potential, b.first_balance, b.at_instants, b.before, b.largest_kinetic, b.largest_potential})
    out.put(x);
  out.put_all(b.gives_power), out.put_all(b.booked_forces);
  const Audit& a = b.audit;
  for (const double x : {a.imbalance, a.violation, a.start, a.end, a.drives, a.supplied, a.dissipated}) out.put(x);
  out.put(static_cast<double>(a.instants.size()));
  for (const Audit::Instant& i : a.instants) {
    out.put_text(i.cause);
    for (const double x : {static_cast<double>(i.count), i.first, i.last, i.energy}) out.put(x);
  }
}

void EnergyAudit::load(SnapshotReader& in) {
  Books& b = *books_;
  for (Books::Range* r : {&b.kinetic, &b.potential, &b.drives, &b.supplied, &b.dissipated})
    r->least = in.get(), r->most = in.get();
  for (double* x :
       {&b.first_potential, &b.first_balance, &b.at_instants, &b.before, &b.largest_kinetic, &b.largest_potential})
    *x = in.get();
  in.get_all(b.gives_power), in.get_all(b.booked_forces);
  if (b.gives_power.size() != b.force_names.size() || b.booked_forces.size() != b.force_names.size())
    throw ModelError("the saved books of the energy are those of other forces than the system has");
  Audit& a = b.audit;
  for (double* x : {&a.imbalance, &a.violation, &a.start, &a.end, &a.drives, &a.supplied, &a.dissipated}) *x = in.get();
  a.instants.clear();
  for (long n = in.get_count(); n > 0; --n) {
    Audit::Instant i;
    i.cause = in.get_text(), i.count = in.get_count();
    i.first = in.get(), i.last = in.get(), i.energy = in.get();
    a.instants.push_back(std::move(i));
  }
}

const char* Audit::verdict() const {
  switch (energy) {
    case Energy::conserved:
      return "conserved";
    case Energy::not_conserved:
      return "not conserved";
    default:
      return "not judged";
  }
}

Audit EnergyAudit::result() const {
  const Books& b = *books_;
  Audit audit = b.audit;
  audit.scale =
      std::max({b.kinetic.size(), b.potential.size(), b.drives.size(), b.supplied.size(), b.dissipated.size()});
  audit.drifted = !(audit.violation <= audit.limits.violation);
  for (std::size_t k = 0; k < b.force_names.size(); ++k)
    if (b.gives_power[k] && !b.booked_forces[k]) audit.unbooked_forces.push_back(b.force_names[k]);
  const double least = std::max(b.least, kRounding * std::max(b.largest_kinetic, b.largest_potential));
  if (audit.imbalance <= std::max(audit.limits.energy * audit.scale, least)) return audit;
  audit.energy = audit.unbooked_forces.empty() ? Audit::Energy::not_conserved : Audit::Energy::not_judged;
  return audit;
}

}  // namespace lockstep
