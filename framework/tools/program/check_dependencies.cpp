// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/check_dependencies.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include "framework/tools/program/findings.h"

namespace lockstep {
namespace {

std::string decided_words(const NearDependency& d, NearlyRedundant choice) {
  if (d.in_passing) return "It is so only near a singular configuration";
  if (!d.undecided.empty())
    return fmt::format("Not decided: {}, so solvers may differ. Check the units of lengths, then correct the geometry",
                       d.undecided);
  if (choice == NearlyRedundant::reported || !d.decided)
    return "Solvers may differ; choose \"nearly_redundant\": \"held\" or \"free\" (--nearly-redundant)";
  const std::string left_out =
      d.left_out.empty()
          ? ""
          : fmt::format(". {}: {}", d.free ? "Left out, with the redundant ones" : "Dropped, because others imply them",
                        by_joint(d.left_out));
  if (d.held())
    return "It is kept" + (d.needed.empty() ? ", so it may lock the mechanism" : ": " + d.needed) + left_out;
  return fmt::format(
      "It is released{}. Violation after a motion of 0.3 rad: {:.1g} m. To hold it: --nearly-redundant held", left_out,
      d.violation);
}

}  // namespace

void note_near(const std::vector<NearDependency>& near, NearlyRedundant choice) {
  for (const NearDependency& d : near)
    CommandFindings::add(
        {&finding::nearly_redundant, by_joint(d.rows),
         fmt::format(
             "{} of the constraints {} {} nearly redundant (relative singular value {:.2g}, 0 is redundant). {}",
             d.nearly, by_joint(d.rows), d.nearly == 1 ? "is" : "are", d.singular_value, decided_words(d, choice)),
         d.advice, d.singular_value});
}

std::string decision(const NearDependency& d, NearlyRedundant choice) {
  if (choice == NearlyRedundant::reported) return "reported";
  if (!d.decided) return choice == NearlyRedundant::automatic && d.undecided.empty() ? "reported" : "undecided";
  return d.free ? "free" : "held";
}

std::vector<DecidedNear> decided(const std::vector<NearDependency>& near, NearlyRedundant choice) {
  std::vector<DecidedNear> all;
  for (const NearDependency& d : near) all.emplace_back(d, choice);
  return all;
}

std::string grouped_text(const Json& constraints) { return by_joint(constraints.get<std::vector<std::string>>()); }

void note_not_unique(const UniquenessReport& reactions) {
  if (reactions.all_unique()) return;
  CommandFindings::add({&finding::reactions_not_unique, by_joint(reactions.rows),
                        "individual reactions are not unique, because constraints are redundant or left out",
                        "see the table \"reactions not unique\" of lockstep check --verbose"});
}

}  // namespace lockstep
