// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/system/diagnose.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <lockstep/system.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

template <class T>
Thing thing_of_kind(const char* kind, const T& thing) {
  Thing made{.kind = kind, .name = thing.name(), .type = "?", .origin = thing.origin()};
  succeeds([&] { made.type = std::string(thing.type()); });  // else it stays "?"
  return made;
}

// What is wrong with one of its laws, "" if nothing is; runs user code.
std::string law_fault_of(const Lock& link, double t) {
  std::string fault;
  succeeds([&] { fault = link.driven() == nullptr ? "" : link.driven()->diagnose(t); });
  return fault;
}
std::string law_fault_of(const Force& force, double t) {
  std::string fault;
  succeeds([&] { fault = force.diagnose(t); });
  return fault;
}

// Names one of its laws if that is at fault, else gives the advice `otherwise`.
template <class T>
[[noreturn]] void refuse_number(const T& thing, double t, const std::string& what, const std::string& otherwise) {
  const std::string law = law_fault_of(thing, t);
  const Thing whose = thing_of(thing);
  std::string advice = law.empty() ? otherwise : "check its parameters";
  if (law.empty() ? whose.of_a_plugin() : law.find(" of plugin ") != std::string::npos)  // a hint of the step misleads
    advice = (law.empty() ? "test " + whose.type + " by check_" + (whose.kind == "joint" ? "lock" : "force")
                          : "test it by check_law") +
             ", or " + advice.substr(0, advice.find(", or "));
  throw NonFiniteError(at_time(t) + whose.label() + what + (law.empty() ? "" : ": " + law) + "; " + advice,
                       {.thing = whose, .advice = advice, .t = t});
}

// "body 'b' at [1, 0, 0]" of the moving bodies among these slots.
template <class SlotNumbers>
std::string place_of(const System& system, const Inputs& in, const SlotNumbers& slots) {
  std::string words;
  for (const int slot : slots) {
    const Vec3& x = in.slot(slot).x;
    words += (words.empty() ? "body '" : ", body '") + system.body_of_slot(slot).name + "' at [" + text::brief(x[0]) +
             ", " + text::brief(x[1]) + ", " + text::brief(x[2]) + "]";
  }
  return words;
}

// The number of a joint's rows that is not finite, and its bodies: ": Qhat of constraint z is nan with body 'b' at ...".
std::string bad_number(const System& system, const Inputs& in, const RowEntry& e, const RowView& block,
                       const Lock& link) {
  std::vector<int> slots;
  for (int i = 0; i < e.slots.n; ++i) slots.push_back(e.slots[i]);
  for (int k = 0; k < e.m; ++k) {
    double J = 0;
    for (int i = 0; i < e.slots.n; ++i)
      for (const double x : block.J(i, k)) J += x;
    for (const auto& [what, x] : {std::pair{"the value C", static_cast<double>(block.C(k))},
                                  {"the rate Ct", static_cast<double>(block.Ct(k))},
                                  {"the acceleration Qhat", static_cast<double>(block.Qhat(k))},
                                  {"the Jacobian", J}})
      if (!std::isfinite(x))
        return std::string(": ") + what + " of constraint " + link.row_name(e.own[k]) + " is " + text::number(x) +
               " with " + place_of(system, in, slots);
  }
  return {};
}

// A mass that was set after the body was made.
void check_mass_finite(const Body& body, double t) {
  const MassProperties& m = body.mass;
  const auto refuse = [&](const std::string& what) {
    const Thing whose{.kind = "body", .name = body.name};
    throw NonFiniteError(at_time(t) + whose.words() + " has " + what + "; it must be finite: check what sets it",
                         {.thing = whose, .advice = "check what sets its mass", .t = t});
  };
  if (!std::isfinite(m.mass)) refuse("a mass of " + text::number(m.mass) + " kg");
  if (!m.center.allFinite()) refuse("a centre of mass that is not finite");
  if (!m.J.allFinite()) refuse("an inertia that is not finite");
}

}  // namespace

Thing thing_of(const Lock& link) { return thing_of_kind("joint", link); }
Thing thing_of(const Force& force) { return thing_of_kind("force", force); }

bool has_function(const Lock& link) {
  const Jointed* joint = link.jointed();
  return joint == nullptr || joint->has_laws() || link.row_count() > count_rows(joint->rows());
}

std::string tests_first(const System& system, const std::vector<std::string>& names) {
  std::string tests;
  const auto add = [&](const std::string& type, const std::string& origin, const char* check) {
    const std::string test = type + " by " + check;
    if (of_plugin(origin).empty() || tests.find(" " + test) != std::string::npos) return;
    tests += (tests.empty() ? "first test " : " and ") + test;
  };
  const auto add_law = [&](const auto& law) {
    if (const LawLabel* label = law ? label_of(law) : nullptr) add(label->type, label->origin, "check_law");
  };
  const auto named = [&](const std::string& name) {
    return names.empty() || std::ranges::find(names, name) != names.end();
  };
  for (const auto& link : system.links()) {
    if (!named(link->name())) continue;
    add(thing_of(*link).type, link->origin(), "check_lock");
    for (const auto& [p, s] : link->pairs())
      for (const Marker* marker : {p, s}) add_law(marker->translation_law), add_law(marker->rotation_law);
    if (const Jointed* joint = link->jointed()) {
      add_law(joint->imposed().move), add_law(joint->imposed().turn);
      for (const Drive& drive : joint->imposed().drives) add_law(drive.law);
    }
  }
  for (const auto& force : system.forces()) {
    if (!named(force->name())) continue;
    add(thing_of(*force).type, force->origin(), "check_force");
    for (const ForceLaw& law : force->laws()) add_law(law.law);
  }
  return tests.empty() ? "" : tests + "; otherwise ";
}

Thing thing_of_row(const System& system, const RowTable& table, int row) {
  for (const RowEntry& e : table.entries)
    if (row >= e.first_row && row < e.first_row + e.m) return thing_of(*system.links()[e.link]);
  return {};
}

std::string or_against_stops(const System& system, const RowTable& table) {
  std::string stops, driven;
  for (const RowEntry& e : table.entries) {
    const Lock& link = *system.links()[e.link];
    if (link.unilateral() != nullptr) stops += (stops.empty() ? "'" : "', '") + link.name();
    if ((link.driven() != nullptr && link.driven()->n_drives() > 0) ||
        (link.jointed() != nullptr && link.jointed()->has_laws()))
      driven += (driven.empty() ? " of joint '" : "', '") + link.name();
  }
  if (stops.empty()) return {};
  return ", or a law" + (driven.empty() ? driven : driven + "'") + " drives against the closed one-sided joint " +
         stops + "'";
}

ErrorContext context_of(const Lock& link, double t) {
  return {.thing = thing_of(link), .t = t, .fault = law_fault_of(link, t)};
}
ErrorContext context_of(const Force& force, double t) {
  return {.thing = thing_of(force), .t = t, .fault = law_fault_of(force, t)};
}

ErrorContext context_of(const Auxiliary& auxiliary, double t) {
  return {.thing = {.kind = "integrated state", .name = auxiliary.name()}, .t = t};
}

ErrorContext context_of(const CountedAngle& angle, double t) {
  return {.thing = {.kind = "counted angle", .name = angle.name()}, .t = t};
}

void rethrow_from_group(const System& system, const Inputs& in, const RowTable& table, const RowRun& run) {
  const auto entry = [&](int k) -> const RowEntry& { return table.entries[run.first_entry + k]; };
  const auto link_of = [&](const RowEntry& e) { return system.links()[e.link].get(); };
  if (run.n == 1 && (run.in_plane || !entry(0).plane)) rethrow_in(context_of(*link_of(entry(0)), in.t));
  RowTable scratch;
  for (int k = 0; k < run.n; ++k) {
    const RowEntry& e = entry(k);
    const Lock* link = link_of(e);
    const RowShape shape = run.in_plane || !e.plane ? e.shape() : link->shape();
    named(*link, in.t, [&] {
      if (run.in_plane)
        link->planar()->gather_plane(Group(&link, 1), in, scratch.alone(shape));
      else
        link->gather(Group(&link, 1), in, scratch.alone(shape));
    });
  }
  // No single joint throws on its own: an Error is passed on as it is, anything else names the group.
  try {
    throw;
  } catch (const Error&) {
    throw;
  } catch (...) {
    ErrorContext group{.thing = thing_of(*link_of(entry(0))), .t = in.t};
    group.thing.name.clear();
    group.label = "one of the " + std::to_string(run.n) + " joints of type '" + group.thing.type + "'" +
                  of_plugin(group.thing.origin) + " (none of them throws alone)";
    rethrow_in(group);
  }
}

void refuse_laws(const Lock& link, double t) {
  refuse_number(link, t, " computed a number that is not finite", "check its laws");
}

VecX wrench_of(const System& system, const Inputs& in, const Force& force, const Reactions* reactions) {
  VecX f = VecX::Zero(6 * system.n_slots());
  WrenchSum sum(in.motions, f);
  if (!force.acts(in)) return f;
  named(force, in.t, [&] {
    force.apply(in, sum);
    if (reactions != nullptr && force.reacting() != nullptr) force.reacting()->react(in, *reactions, sum);
  });
  return f;
}

void check_wrench(const System& system, const Inputs& in, const Force& force) {
  if (!wrench_of(system, in, force).allFinite())
    refuse_number(force, in.t,
                  " is not finite" + (force.slots().empty() ? "" : " with " + place_of(system, in, force.slots())),
                  "check its law and parameters");
}

void check_finite(const System& system, const Inputs& in, const RowTable& table, const VecX& f) {
  for (int k = 0; k < system.n_slots(); ++k) {
    const Motion& O = in.slot(k);
    if (O.x.allFinite() && O.A.allFinite() && O.v.allFinite() && O.w.allFinite()) continue;
    const Thing body{.kind = "body", .name = system.body_of_slot(k).name};
    throw NonFiniteError(at_time(in.t) + body.words() + " has a position or velocity that is not finite" +
                             (in.t == 0 ? "; check its start" : std::string("; ") + kShorterStep),
                         {.thing = body, .advice = kShorterStep, .t = in.t});
  }
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    double sum = 0;
    for (std::size_t i = 0; i < block.size(); ++i) sum += block.numbers()[i];
    if (!std::isfinite(sum)) {
      const Lock& link = *system.links()[e.link];
      std::string own = has_function(link) ? "check its function and its pose" : in.t == 0 ? "check its pose" : "";
      refuse_number(link, in.t, " computed a number that is not finite" + bad_number(system, in, e, block, link),
                    own + (in.t == 0 ? "" : (own.empty() ? "" : ", or ") + std::string(kShorterStep)));
    }
  }
  if (f.allFinite()) return;
  for (const auto& force : system.forces()) check_wrench(system, in, *force);
  for (const Body& body : system.bodies())
    if (body.slot != kGround) check_mass_finite(body, in.t);
  throw NonFiniteError(at_time(in.t) + "the inertia forces are not finite; " + kShorterStep,
                       {.thing = {.kind = "mechanism"}, .advice = kShorterStep, .t = in.t});
}

void diagnose_rates(const System& system, double t, const VecX& sd) {
  const auto bad = [&](int first, int n) { return !sd.segment(first, n).allFinite(); };
  for (const auto& link : system.links())
    if (bad(link->first_state(), link->n_own_states()))
      refuse_number(*link, t, ": the rate of its driven speed is not finite", "check its parameters");
  for (const auto& auxiliary : system.auxiliaries())
    if (bad(auxiliary->first(), auxiliary->size()))
      throw NonFiniteError(at_time(t) + "the integrated state '" + auxiliary->name() +
                               "' has a rate that is not finite; check its inputs",
                           {.thing = {.kind = "integrated state", .name = auxiliary->name()}, .t = t});
  for (const auto& angle : system.counted_angles())
    if (bad(angle->first(), CountedAngle::kStates))
      throw NonFiniteError(at_time(t) + "the " + angle->name() + " has a rate that is not finite; " + kShorterStep,
                           {.thing = {.kind = "counted angle", .name = angle->name()}, .t = t});
  throw NonFiniteError(at_time(t) + "a rate of the integrated states is not finite; check their inputs",
                       {.thing = {.kind = "mechanism"}, .t = t});
}

}  // namespace lockstep
