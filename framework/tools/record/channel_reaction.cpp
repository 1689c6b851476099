// SPDX-License-Identifier: BSD-3-Clause
// Reactions of links and the share of their drives, from multipliers and rows alone, for every type of link.
#include <spdlog/fmt/fmt.h>

#include <lockstep/author/lock.h>
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {

std::vector<ReactionPart> parts_of(const Lock& link) {
  const Driven* driven = link.driven();
  const int n = driven ? driven->n_drives() : 0;
  if (n == 0) return {{"", "the joint", Reactions::kJoint}};
  std::vector<ReactionPart> parts{{"", "the joint without its drives", Reactions::kJoint},
                                  {"drive.", n > 1 ? "all its drives" : "its drive", Reactions::kDrives}};
  for (int d = 0; d < n; ++d)
    parts.push_back({"drive_" + driven->drive(d).name + ".", "its drive on " + driven->drive(d).name, d});
  return parts;
}

Vec3 ReactionVector::of(const LinkWrench& wrench, const Marker& s, const Inputs& in) const {
  const Vec3 f = force ? wrench.force : wrench.moment;
  return world ? f : Vec3(in_world(MarkerFrame(s), in).A.transpose() * f);
}

// (8.8) lambda . Ct over the rows of the part
double power_of_part(const Lock& link, int part, const RowTable& rows, const VecX& lambda) {
  const RowEntry* e = entry_of(link, rows);
  double power = 0;
  for (int k = 0; e && k < e->m; ++k)
    if (Reactions::belongs(link.row(e->own[k]), part)) power += lambda[e->first_row + k] * rows.block(*e).Ct(k);
  return power;
}

void of_reactions(const Lock& link, Entries& out) {
  if (link.pairs().empty()) return;
  const Lock* const l = &link;
  const auto [p, s] = link.pairs().front();
  for (const auto& [prefix, by, part] : parts_of(link)) {
    for (const ReactionVector& v : kReactionVectors)
      add_vector(out, prefix + v.name, v.unit, fmt::format(fmt::runtime(v.help), by),
                 [l, v, part = part, at = v.on_p ? p : s, s = s](const Sample& x) -> Vec3 {
                   return v.of(x.wrench(*l, *at, part), *s, x.values().in);
                 });
    if (part == Reactions::kJoint) continue;
    const auto power = [l, part = part](const Evaluated& v) { return power_of_part(*l, part, v.rows, v.lambda); };
    add(out, prefix + "power", "W", "power supplied by " + by, [power](const Sample& x) { return power(x.values()); });
    add_integral(out, prefix + "work", "J", "work of " + by + " since the start", link.name() + "." + prefix + "work",
                 power, Integrand::drive);
  }
}

}  // namespace lockstep::channels
