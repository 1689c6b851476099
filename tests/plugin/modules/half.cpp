// SPDX-License-Identifier: BSD-3-Clause
// A plugin that gives up half way: nothing of it may stay.
#include <lockstep/author/plugin.h>
#include <lockstep/error.h>

namespace {

struct Still final : lockstep::MotionLaw {
  lockstep::LawValue at(double) const override { return {}; }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) {
  registry.laws.add({"half_law", "registered before the failure", {}},
                    [](const lockstep::Params&) { return std::make_shared<Still>(); });
  throw lockstep::PluginError("the other half is missing");
}
