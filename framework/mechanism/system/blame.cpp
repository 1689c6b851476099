#include "framework/mechanism/system/blame.h"

#include <cmath>

#include "framework/mechanism/forces/marker_force.h"
#include "framework/mechanism/model/law_fault.h"
#include "framework/foundation/support/text.h"
#include "framework/foundation/support/thrown.h"
#include "framework/foundation/support/user_code_error.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {
namespace {

// A class's type() is the user's code too.
template <class Thing>
std::string type_of(const Thing& thing) {
  try {
    return std::string(thing.type());
  } catch (...) {
    return "?";
  }
}

template <class Thing>
std::string label_of(const char* kind, const Thing& thing) {
  return std::string(kind) + " '" + thing.name() + "' (" + type_of(thing) + of_plugin(thing.origin()) + ")";
}

template <class Thing>
[[noreturn]] void name_it(const Thing& thing, double t, const std::exception_ptr& thrown) {
  const std::string law = law_at_fault(thing, t);
  const std::string words = law.empty() ? label(thing) + " threw: " + thrown_words(thrown) : label(thing) + ": " + law;
  std::throw_with_nested(UserCodeError("t = " + number(t) + " s: " + words, thing.origin(), t));
}

template <class Thing>
[[noreturn]] void rethrow(const Thing& thing, double t) {
  const std::exception_ptr thrown = std::current_exception();
  try {
    throw;
  } catch (const UserCodeError&) {
    throw;
  } catch (const NonFiniteError&) {
    throw;
  } catch (const Error&) {  // a class of the library, or the host's own: its words name it
    if (of_plugin(thing.origin()).empty() && law_at_fault(thing, t).empty()) throw;
    name_it(thing, t, thrown);
  } catch (...) {
    if (thing.origin() == "built in" && law_at_fault(thing, t).empty()) throw;
    name_it(thing, t, thrown);
  }
}

// None threw when it was asked alone: what it was stays, and that it cannot be told who it was is said.
[[noreturn]] void rethrow_nameless(const char* kind, double t) {
  const std::exception_ptr thrown = std::current_exception();
  try {
    throw;
  } catch (const Error&) {
    throw;
  } catch (...) {
    std::throw_with_nested(UserCodeError("t = " + number(t) + " s: a " + kind + " threw: " + thrown_words(thrown) +
                                             " (asked again one by one, none of them did)",
                                         "", t));
  }
}

std::string at_time(double t) { return "t = " + number(t) + " s: "; }

// What went wrong with a law of this thing, and the next move.
template <class Thing>
std::string law_words(const Thing& thing, double t, const std::string& otherwise) {
  const std::string law = law_at_fault(thing, t);
  return law.empty() ? otherwise : ": " + law + "; look at its parameters";
}

}  // namespace

std::string label(const Lock& link) { return label_of("link", link); }
std::string label(const Force& force) { return label_of("force", force); }

std::string law_at_fault(const Lock& link, double t) {
  try {
    return link.blame(t);
  } catch (...) {  // the user's code too
    return {};
  }
}

std::string law_at_fault(const Force& force, double t) {
  const auto* with_laws = dynamic_cast<const MarkerForce*>(&force);
  return with_laws == nullptr ? "" : with_laws->blame(t);
}

void rethrow_named(const Lock& link, double t) { rethrow(link, t); }
void rethrow_named(const Force& force, double t) { rethrow(force, t); }

void rethrow_from_rows(const System& system, const Inputs& in, const RowTable& table) {
  RowTable alone;
  for (const RowRun& run : table.runs)
    for (int k = 0; k < run.n; ++k) {
      const RowEntry& e = table.entries[static_cast<std::size_t>(run.first_entry + k)];
      const Lock* link = system.links()[static_cast<std::size_t>(e.link)].get();
      const RowShape shape = run.in_plane || !e.plane
                                 ? e.shape()
                                 : RowShape{link->row_count(), e.slots.n, link->layout(), link->row_sign(), {}};
      named(*link, in.t, [&] {
        if (run.in_plane)
          link->gather_plane(Group(&link, 1), in, alone.spatial_span(shape));
        else
          link->gather(Group(&link, 1), in, alone.spatial_span(shape));
      });
    }
  rethrow_nameless("link", in.t);
}

void rethrow_from_forces(const System& system, const Inputs& in) {
  VecX f = VecX::Zero(6 * system.n_slots());
  WrenchSum sum(in.motions, f);
  for (const auto& force : system.forces()) named(*force, in.t, [&] { force->apply(in, sum); });
  rethrow_nameless("force", in.t);
}

void check_finite(const System& system, const Inputs& in, const RowTable& rows, const VecX& f) {
  for (int k = 0; k < system.n_slots(); ++k) {
    const Motion& O = in.slot(k);
    if (!O.x.allFinite() || !O.A.allFinite() || !O.v.allFinite() || !O.w.allFinite())
      throw NonFiniteError(at_time(in.t) + "body '" + system.body_of_slot(k).name +
                               "' has a position or velocity that is not finite; " + kShorterStep,
                           in.t);
  }
  for (const RowEntry& e : rows.entries) {
    const RowView block = rows.block(e);
    double sum = 0;
    for (std::size_t i = 0; i < block.size(); ++i) sum += block.numbers()[i];
    if (std::isfinite(sum)) continue;
    const Lock& link = *system.links()[static_cast<std::size_t>(e.link)];
    throw NonFiniteError(
        at_time(in.t) + label(link) + " made a number that is not finite" +
            law_words(link, in.t, std::string("; look at its function and at the pose it is in, or ") + kShorterStep),
        in.t);
  }
  if (f.allFinite()) return;
  VecX one = VecX::Zero(f.size());
  for (const auto& force : system.forces()) {
    WrenchSum sum(in.motions, one);
    force->apply(in, sum);
    if (!one.allFinite())
      throw NonFiniteError(at_time(in.t) + label(*force) + " is not finite" +
                               law_words(*force, in.t, "; look at its law and parameters"),
                           in.t);
  }
  throw NonFiniteError(at_time(in.t) + "the inertia forces are not finite; " + kShorterStep, in.t);
}

/// Names whose rate of State::s is not finite.
void diagnose_rates(const System& system, double t, const VecX& sd) {
  const auto bad = [&](int first, int n) { return !sd.segment(first, n).allFinite(); };
  for (const auto& link : system.links())
    if (bad(link->first_state(), link->n_states()))
      throw NonFiniteError(at_time(t) + label(*link) + ": the rate of its driven speed is not finite" +
                               law_words(*link, t, "; look at its parameters"),
                           t);
  for (const auto& auxiliary : system.auxiliaries())
    if (bad(auxiliary->first(), auxiliary->size()))
      throw NonFiniteError(at_time(t) + "the integrated state '" + auxiliary->name() +
                               "' has a rate that is not finite; look at what feeds it",
                           t);
  throw NonFiniteError(at_time(t) + "a rate of the integrated states is not finite; look at what feeds them",
                       t);
}

}  // namespace lockstep
