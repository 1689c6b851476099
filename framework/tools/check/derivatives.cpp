// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/derivatives.h"

#include <lockstep/author/check.h>
#include <lockstep/error.h>

namespace lockstep {
namespace {

// Other findings, such as jumps, are no wrong derivatives.
void refuse_differences(const CheckReport& report, const Thing& thing, const std::string& advice) {
  for (const CheckFinding& f : report.findings())
    if (f.what.find("finite differences") != std::string::npos)
      throw ModelError(thing.words() + ": " + f.what + "; " + advice, {.thing = thing, .advice = advice});
}

}  // namespace

void refuse_wrong_derivatives(System& system, double until, const std::function<bool(const Lock&)>& is_own,
                              const DerivativeAdvice& advice) {
  CheckOptions options{.states = 1};
  if (until > 0) options.to = until;
  const auto look_at = [&](const auto& law) {
    if (!law) return;
    const LawLabel* label = label_of(law);
    const std::string name = label != nullptr ? label->type : "";
    refuse_differences(check_law(*law, options, name), {.kind = "law", .name = name}, advice.law);
  };
  for (const auto& link : system.links()) {
    if (is_own(*link))
      refuse_differences(check_lock(system, *link, options), {.kind = "joint", .name = link->name()}, advice.joint);
    for (const auto& [p, s] : link->pairs())
      for (const Marker* marker : {p, s}) look_at(marker->translation_law), look_at(marker->rotation_law);
    if (const Jointed* joint = link->jointed()) {
      look_at(joint->imposed().move), look_at(joint->imposed().turn);
      for (const Drive& drive : joint->imposed().drives) look_at(drive.law);
    }
  }
}

}  // namespace lockstep
