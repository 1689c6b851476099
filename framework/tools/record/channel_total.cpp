// Channels of the whole mechanism: energies, momenta; and of the run.
#include <cmath>
#include <memory>

#include <lockstep/error.h>
#include <lockstep/text.h>

#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/quadrature.h"

namespace lockstep::channels {
namespace {

// What a force says of its energy must be a number; where the force itself is none, that is the cause.
double must_be_number(const System& system, const Force& f, const char* what, double value, const Inputs& in) {
  if (std::isfinite(value)) return value;
  check_wrench(system, in, f);
  throw NonFiniteError(at_time(in.t) + thing_of(f).label() + ": its " + what + " is " + text::number(value) +
                           "; it must be a finite number",
                       {.thing = thing_of(f), .t = in.t});
}

// Adds the energy of slot k to a sum, which may be too large for a double.
void add_energy(const Sample& s, int k, const char* what, double energy, double& sum) {
  sum += energy;
  if (std::isfinite(sum)) return;
  const Thing body{.kind = "body", .name = s.system().body_of_slot(k).name};
  throw NonFiniteError(at_time(s.state.t) + "with " + body.words() + " the " + what + " energy is " +
                           text::number(sum) + "; it must be a finite number: look at gravity, masses and speeds",
                       {.thing = body, .t = s.state.t});
}

double kinetic(const Sample& s) {
  double sum = 0;
  for (int k = 0; k < s.system().n_slots(); ++k) {
    const Slot& b = s.system().slot(k);
    const Motion& O = s.inputs().slot(k);
    add_energy(s, k, "kinetic", 0.5 * (b.mass * O.v.squaredNorm() + O.w.dot(b.J * O.w)), sum);
  }
  return sum;
}

double potential(const Sample& s) {
  double sum = 0;
  for (int k = 0; k < s.system().n_slots(); ++k)
    add_energy(s, k, "potential", -s.system().slot(k).mass * s.system().gravity().dot(s.inputs().slot(k).x), sum);
  if (s.system().forces().empty()) return sum;
  for (const auto& f : s.system().forces())
    if (f->acts(s.inputs()))
      sum += must_be_number(s.system(), *f, "potential()",
                            named(*f, s.state.t, [&] { return f->potential(s.inputs()); }), s.inputs());
  return sum;
}

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

// Over all forces at the time of the evaluation, so that forces added later count.
double dissipation(const System& system, const Evaluated& v) {
  double sum = 0;
  for (const auto& f : system.forces()) sum += must_be_number(system, *f, "dissipation()", loss(*f, v), v.in);
  return sum;
}

double supply(const System& system, const Evaluated& v) {
  double sum = 0;
  for (const auto& f : system.forces())
    if (f->acts(v.in))
      sum += must_be_number(system, *f, "supply()", named(*f, v.in.t, [&] { return f->supply(v.in); }), v.in);
  return sum;
}

const Quadrature& drives(System& system) { return quadrature(system, "energy.drives", power_of_laws, true); }
const Quadrature& dissipated(System& system) {
  return quadrature(system, "energy.dissipated", [&system](const Evaluated& v) { return dissipation(system, v); });
}

const Quadrature& supplied(System& system) {
  return quadrature(system, "energy.supplied", [&system](const Evaluated& v) { return supply(system, v); });
}

// total - drives - supplied + dissipated, minus its value at the start; of links and forces that are added later, too.
void make_balance(System& system, Channel& c) {
  const auto sum = [&led = drives(system), &fed = supplied(system), &lost = dissipated(system)](const Sample& s) {
    return kinetic(s) + potential(s) + lost_in_impacts(s.system(), s.state) - led.value(s.state) - fed.value(s.state) +
           lost.value(s.state);
  };
  struct Start {
    bool begun = false;
    double value = 0;
  };
  const auto start = std::make_shared<Start>();
  c.track = [sum, start](const Sample& s) {
    if (!start->begun) *start = {true, sum(s)};
  };
  c.value = [sum, start](const Sample& s) { return start->begun ? sum(s) - start->value : 0.0; };
  c.restart = [start] { start->begun = false; };
  c.save = [start](Snapshot& out) { out.put(start->begun ? 1 : 0), out.put(start->value); };
  c.load = [start](SnapshotReader& in) { start->begun = in.get_flag(), start->value = in.get(); };
}

void make_rejected(System&, Channel& c) {
  const auto count = std::make_shared<double>(0);
  c.track = [count](const Sample& s) { *count += s.report.rejected; };
  c.value = [count](const Sample&) { return *count; };
  c.restart = [count] { *count = 0; };
  c.save = [count](Snapshot& out) { out.put(*count); };
  c.load = [count](SnapshotReader& in) { *count = in.get(); };
}

}  // namespace

double lost_in_impacts(const System& system, const State& state) {
  double sum = 0;
  for (const auto& link : system.links())
    if (link->unilateral()) sum += state.z[link->impact_memory()];
  return sum;
}

void of_totals(Entries& out) {
  add(out, "energy.kinetic", "J", "kinetic energy of all bodies", kinetic);
  add(out, "energy.potential", "J", "of gravity (0 at the origin) and of all forces that store energy", potential);
  add(out, "energy.total", "J", "kinetic and potential energy",
      [](const Sample& s) { return kinetic(s) + potential(s); });
  const auto add_work = [&](const char* name, const char* help, const Quadrature& (*work)(System&), bool impacts) {
    out.push_back({name, "J", help, [=](System& system, Channel& c) {
                     const Quadrature& q = work(system);
                     c.value = [&q, impacts](const Sample& s) {
                       return q.value(s.state) + (impacts ? lost_in_impacts(s.system(), s.state) : 0.0);
                     };
                   }});
  };
  add_work("energy.drives", "work of all drives and moving laws since the start", drives, false);
  add_work("energy.supplied", "work of the laws and motors of all forces since the start", supplied, false);
  add_work("energy.dissipated", "energy taken out by all dampers, friction and impacts since the start", dissipated,
           true);
  out.push_back({"energy.balance", "J",
                 "total - drives - supplied + dissipated, minus its value at the start: the error of the run",
                 make_balance});
  add_vector(out, "momentum.", "N s", "momentum of all bodies, world axes", momentum);
  add_vector(out, "angular_momentum.", "N m s", "angular momentum about the origin, world axes", angular_momentum);
}

void of_run(Entries& out) {
  add(out, "step", "s", "the step that led here", [](const Sample& s) { return s.report.h; });
  out.push_back({"rejected", "", "tries thrown away since the start", make_rejected});
  const auto scratch = std::make_shared<VecX>();
  add(out, "violation", "m", "largest residual of all rows, turns as lengths",
      [scratch](const Sample& s) { return violation(s.values().evaluation, s.values().rows.entries, *scratch); });
  add(out, "evaluations", "", "evaluations of the equations of motion so far, those for the record included",
      [](const Sample& s) { return static_cast<double>(s.dynamics().work().evaluations); });
  add(out, "solver.residual", "", "largest residual of the rows' equations, relative",
      [](const Sample& s) { return s.values().full_report().residual; });
  add(out, "solver.corrections", "", "proximal corrections of this solution",
      [](const Sample& s) { return static_cast<double>(s.values().report.corrections); });
  add(out, "solver.detector", "", "smallest relative pivot beyond the usual ones: how near a singular position is",
      [](const Sample& s) { return s.values().full_report().detector; });
  add(out, "solver.smallest_pivot", "", "smallest relative pivot of this solution",
      [](const Sample& s) { return s.values().full_report().smallest_pivot; });
}

}  // namespace lockstep::channels
