// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/step_watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

constexpr long kApart = 16;  // steps between two looks at |C|

bool same_sizes(const State& a, const State& b) {
  return a.q.size() == b.q.size() && a.v.size() == b.v.size() && a.s.size() == b.s.size() && a.z.size() == b.z.size() &&
         a.coordinates == b.coordinates;
}

// What a method must not touch.
std::string wrong_parts(const State& from, const State& to) {
  if (!same_sizes(from, to)) return "changed the sizes of the state";
  if (to.modes != from.modes || to.watched != from.watched) return "switched joints, which only events may do";
  if (to.z.size() > 0 && std::memcmp(to.z.data(), from.z.data(), sizeof(double) * to.z.size()) != 0)
    return "changed the memory of joints and forces, which only an accepted step may do";
  return {};
}

std::string wrong_time(double t0, double t1, double h, const StepReport& report) {
  if (!std::isfinite(t1) || !std::isfinite(report.h))
    return fmt::format("ended at t = {} s after h = {} s", t1, report.h);
  const double rounding = 1e-14 * std::max(std::abs(t0), std::abs(t1));
  if (!(t1 > t0) || !(report.h > 0)) return fmt::format("ended at t = {:.17g} s and did not advance", t1);
  if (t1 - t0 > (1 + kNegligible) * h + rounding)
    return fmt::format("is {:.9g} s long, more than the {:.9g} s requested", t1 - t0, h);
  if (std::abs(t1 - t0 - report.h) > kNegligible * report.h + rounding)
    return fmt::format("is {:.9g} s long and reports {:.9g} s", t1 - t0, report.h);
  return {};
}

std::string wrong_numbers(const State& to) {
  const auto bad = [](const VecX& x) { return !x.allFinite(); };
  if (bad(to.q)) return "left a coordinate that is not finite";
  if (bad(to.v)) return "left a velocity that is not finite";
  if (bad(to.s)) return "left an integrated state that is not finite";
  return {};
}

// Of the slots' own coordinates; those of joints are normalised where they are read.
std::string wrong_quaternion(const State& to, const System& system) {
  for (int k = 0; !to.coordinates && k < system.n_slots(); ++k) {
    const double length2 = to.q.segment<4>(7 * k + 3).squaredNorm();
    if (std::abs(length2 - 1) > kSlight)
      return fmt::format(
          "left the quaternion of body '{}' with a length of {:.9g}; call Dynamics::normalize at its end",
          system.body_of_slot(k).name, std::sqrt(length2));
  }
  return {};
}

bool is_built_in(const Integrator& method) { return method.origin() == "built in"; }

// In every 16th step, and in 1, 2, 4, 8.
bool is_due(long n) { return n % kApart == 0 || (n < kApart && (n & (n - 1)) == 0); }

}  // namespace

void check_step(const System& system, const Integrator& method, const State& from, const State& to, double h,
                const StepReport& report) {
  std::string wrong;
  if (!is_built_in(method)) wrong = wrong_parts(from, to);
  if (wrong.empty()) wrong = wrong_time(from.t, to.t, h, report);
  if (wrong.empty()) wrong = wrong_numbers(to);
  if (wrong.empty()) wrong = wrong_quaternion(to, system);
  if (!wrong.empty())
    throw StepError(fmt::format("{}: the step from t = {:.9g} s {}", method.info().name, from.t, wrong), from.t);
}

void measure_violation(Dynamics& dynamics, const Integrator& method, const State& at, long n, StepReport& report) {
  const bool has_closures = !at.coordinates || at.coordinates->has_rows();
  if (!has_closures || (is_built_in(method) && !is_due(n))) return;
  if (const double found = dynamics.violation_of_closures(at); !(found <= report.violation_after))
    report.violation_after = found;
}

}  // namespace lockstep
