// SPDX-License-Identifier: BSD-3-Clause
// A plugin that leaves a trace as soon as any of its code runs.
#include <cstdlib>

#include <lockstep/author/plugin.h>

namespace {

const int kTrace = setenv("LOCKSTEP_TEST_PROBE", "ran", 1);

struct Still final : lockstep::MotionLaw {
  static lockstep::TypeInfo info() { return {"probe_law", "always the number of the trace", {}}; }
  static lockstep::LawPtr<lockstep::MotionLaw> make(const lockstep::Params&) { return std::make_shared<Still>(); }
  lockstep::LawValue at(double) const override { return {7.0 + kTrace, 0, 0}; }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.laws.add<Still>(); }
