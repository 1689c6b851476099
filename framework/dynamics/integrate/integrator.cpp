// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/integrator.h>

#include <cmath>
#include <limits>
#include <typeinfo>

#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {

Integrator::~Integrator() = default;

void check_tolerance(const Tolerance& t) {
  const auto bad = [](double x) { return !std::isfinite(x) || x < 0; };
  if (bad(t.relative) || t.relative + t.atol_x == 0)
    throw ModelError("the tolerance is " + text::brief(t.relative) + "; it must be greater than 0, such as 1e-8");
  if (bad(t.atol_x))
    throw ModelError("the absolute tolerance is " + text::brief(t.atol_x) + " m; it must be greater than 0");
  if (t.relative > 100)
    throw ModelError("the tolerance of " + text::brief(t.relative) +
                     " allows errors many times larger than the motion; take 1 or less, such as 1e-6");
  if (const double rounding = std::numeric_limits<double>::epsilon(); t.relative > 0 && t.relative < rounding)
    throw ModelError("the tolerance of " + text::brief(t.relative) + " is below the round-off of double precision (" +
                     text::brief(rounding) + "); take 1e-13 or more");
}

void UnmetTolerance::count(const StepReport& step, double t) {
  if (!(step.error > 1)) return;
  if (steps++ == 0) first = t;
  largest = std::max(largest, step.error), lost = std::hypot(lost, step.h * (step.error - 1));
}

Tolerance tolerance_of(double relative) {
  const Tolerance t{relative, 1e-2 * relative};
  check_tolerance(t);
  return t;
}

ErrorContext context_of(const Integrator& method, double t) {
  const bool ours = method.origin().empty() && is_of_lockstep(typeid(method));  // made in C++
  ErrorContext context{.thing = {.kind = "integrator", .name = "?", .origin = ours ? "built in" : method.origin()},
                       .t = t,
                       .refuses = true};
  try {
    context.thing.name = method.info().name;
  } catch (...) {  // info() is user code, too; the name stays "?"
  }
  return context;
}

}  // namespace lockstep
