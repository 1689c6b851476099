// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/rows_in_plane.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/lay_out.h"
#include "framework/mechanism/system/rows_at_start.h"

namespace lockstep {

bool may_have_laws(const Lock& link) {
  const Jointed* joint = link.jointed();
  if (joint == nullptr || joint->has_laws()) return true;
  if (link.row_count() != count_rows(joint->rows())) return true;  // functions may read the time
  return std::ranges::any_of(link.pairs(), [](const auto& pair) {
    return pair.first->translation_law || pair.first->rotation_law || pair.second->translation_law ||
           pair.second->rotation_law;
  });
}

bool may_have_laws(const System& system) {
  return std::ranges::any_of(system.links(), [](const auto& link) { return may_have_laws(*link); });
}

bool leave_out_normal_rows(const JointTree& tree, const System& system, RowTable& table) {
  const Plane plane = tree.planar()->plane();
  const auto link_of = [&](const RowEntry& e) -> const Lock& { return *system.links()[e.link]; };
  if (std::ranges::any_of(table.entries, [&](const RowEntry& e) { return !link_of(e).stays_in_plane(plane); }))
    return false;
  std::vector<bool> shown(system.links().size(), false);
  std::vector<unsigned> absent(system.links().size(), 0U);
  try {
    State start;
    tree.read_off(system.start(), nullptr, start);
    start.coordinates = std::shared_ptr<const Coordinates>(std::shared_ptr<void>(), &tree);
    RowsAtStart at_start(system, plane, std::move(start));
    for (const RowEntry& e : table.entries) {
      const std::span<const RowAtStart> rows = at_start.of(link_of(e));
      shown[e.link] = true;
      unsigned& gone = absent[e.link] = (1U << link_of(e).row_count()) - 1;
      for (int k = 0; k < e.m; ++k) {
        const RowAtStart& r = rows[e.own[k]];
        if (r.lies_in() && r.is_tilted()) return false;
        if (r.lies_in()) {
          gone &= ~(1U << e.own[k]);
          continue;
        }
        const bool is_met = r.demand <= kNegligible * std::max(1.0, system.length());
        if (!is_met || (r.along == 0 && r.about == 0) || may_have_laws(link_of(e))) return false;
      }
    }
  } catch (const Error&) {  // a function that is not everywhere
    return false;
  }
  lay_out_without(absent, system, shown, table);
  return true;
}

}  // namespace lockstep
