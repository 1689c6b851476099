#include "framework/dynamics/integrate/blame.h"

#include <cmath>

#include "framework/foundation/support/text.h"
#include "framework/foundation/support/thrown.h"
#include "framework/foundation/support/user_code_error.h"
#include "framework/mechanism/model/law_fault.h"
#include "framework/mechanism/system/blame.h"

namespace lockstep {
namespace {

std::string at_time(double t) { return "t = " + number(t) + " s: "; }

std::string label(const Integrator& method) {
  try {
    return "integrator '" + method.info().name + "'" + of_plugin(method.origin());
  } catch (...) {
    return "an integrator" + of_plugin(method.origin());
  }
}

// What went wrong with a law of this thing, and the next move.
template <class Thing>
std::string law_words(const Thing& thing, double t, const std::string& otherwise) {
  const std::string law = law_at_fault(thing, t);
  return law.empty() ? otherwise : ": " + law + "; look at its parameters";
}

}  // namespace

void rethrow_named(const Integrator& method, double t) {
  const std::exception_ptr thrown = std::current_exception();
  const bool of_a_plugin = !of_plugin(method.origin()).empty();
  const auto name_it = [&] {
    const std::string words = label(method) + " threw: " + thrown_words(thrown);
    std::throw_with_nested(UserCodeError(at_time(t) + words, method.origin(), t));
  };
  try {
    throw;
  } catch (const UserCodeError&) {
    throw;
  } catch (const NonFiniteError&) {
    throw;
  } catch (const SolveError&) {
    throw;
  } catch (const AssemblyError&) {
    throw;
  } catch (const StepError& error) {
    if (!of_a_plugin) throw;
    throw StepError(label(method) + ": " + error.what(), error.t);
  } catch (const ModelError&) {  // what it cannot do for this mechanism
    if (!of_a_plugin) throw;
    std::throw_with_nested(ModelError(at_time(t) + label(method) + ": " + thrown_words(thrown)));
  } catch (const Error&) {
    if (!of_a_plugin) throw;
    name_it();
  } catch (...) {
    if (method.origin() == "built in") throw;
    name_it();
  }
  std::rethrow_exception(thrown);  // never reached
}

void Dynamics::check_gathered(const State& state) const {
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Motion& O = in_.slot(k);
    if (!O.x.allFinite() || !O.A.allFinite() || !O.v.allFinite() || !O.w.allFinite())
      throw NonFiniteError(at_time(state.t) + "body '" + system_.body_of_slot(k).name +
                               "' has a position or velocity that is not finite; " + kShorter,
                           state.t);
  }
  for (const RowEntry& e : rows_.entries) {
    const RowBlock block = rows_.block(e);
    double sum = 0;
    for (std::size_t i = 0; i < block.size(); ++i) sum += block.numbers()[i];
    if (std::isfinite(sum)) continue;
    const Lock& link = *system_.links()[static_cast<std::size_t>(e.link)];
    throw NonFiniteError(
        at_time(state.t) + label(link) + " made a number that is not finite" +
            law_words(link, state.t, std::string("; look at its function and at the pose it is in, or ") + kShorter),
        state.t);
  }
  if (f_.allFinite()) return;
  VecX one = VecX::Zero(f_.size());
  for (const auto& force : system_.forces()) {
    WrenchSum sum(in_.motions, one);
    force->apply(in_, sum);
    if (!one.allFinite())
      throw NonFiniteError(at_time(state.t) + label(*force) + " is not finite" +
                               law_words(*force, state.t, "; look at its law and parameters"),
                           state.t);
  }
  throw NonFiniteError(at_time(state.t) + "the inertia forces are not finite; " + kShorter, state.t);
}

/// Names whose rate of State::s is not finite.
void Dynamics::blame_rates(const State& state, const VecX& sd) const {
  const auto bad = [&](int first, int n) { return !sd.segment(first, n).allFinite(); };
  for (const auto& link : system_.links())
    if (bad(link->first_state(), link->n_states()))
      throw NonFiniteError(at_time(state.t) + label(*link) + ": the rate of its driven speed is not finite" +
                               law_words(*link, state.t, "; look at its parameters"),
                           state.t);
  for (const auto& auxiliary : system_.auxiliaries())
    if (bad(auxiliary->first(), auxiliary->size()))
      throw NonFiniteError(at_time(state.t) + "the integrated state '" + auxiliary->name() +
                               "' has a rate that is not finite; look at what feeds it",
                           state.t);
  throw NonFiniteError(at_time(state.t) + "a rate of the integrated states is not finite; look at what feeds them",
                       state.t);
}

}  // namespace lockstep
