#include "framework/dynamics/integrate/blame.h"

#include "framework/mechanism/model/law_fault.h"
#include "framework/foundation/support/text.h"
#include "framework/foundation/support/thrown.h"
#include "framework/foundation/support/user_code_error.h"
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

}  // namespace lockstep
