#include "framework/mechanism/system/blame.h"

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

}  // namespace

std::string label(const Lock& link) { return label_of("link", link); }
std::string label(const Force& force) { return label_of("force", force); }

std::string law_at_fault(const Lock& link, double t) {
  try {
    return link.driven() == nullptr ? "" : link.driven()->diagnose(t);
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
      const RowShape shape = run.in_plane || !e.plane ? e.shape() : link->shape();
      named(*link, in.t, [&] {
        if (run.in_plane)
          link->planar()->gather_plane(Group(&link, 1), in, alone.spatial_span(shape));
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

}  // namespace lockstep
