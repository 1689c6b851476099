// What counts as a small pivot in the elimination: for the solver `schur` and for batches in lanes. Private to the room.
#pragma once

#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep::schur {

/// PivotFloors of the present matrix by kind of row. e(i), j(i): number i of Numbers::E and of Numbers::rows.
template <class E, class J>
std::array<double, 3> measure_pivot_floors(const Plan& plan, E&& e, J&& j) {
  PivotFloors floors;
  const int nv = plan.planar ? 2 : 3, nw = plan.planar ? 1 : 3;
  for (const Node& node : plan.nodes) {
    if (node.link < 0) continue;
    const int ld = plan.storage == Storage::packed ? node.ld() : node.m;
    for (int k = 0; k < node.m; ++k) floors.add(node.kinds.of(k), e(node.x + static_cast<std::size_t>(k)));
    for (const Side& side : plan.sides_of(node))
      for (int k = 0; k < node.m; ++k) {
        if (node.kinds.of(k) != RowKind::translation) continue;
        double arm2 = 0;
        for (int c = 0; c < nw; ++c) {
          const double arm = j(side.J + static_cast<std::size_t>(((side.turned ? 0 : nv) + c) * ld + k));
          arm2 += arm * arm;
        }
        floors.arm2 = std::max(floors.arm2, arm2);
      }
  }
  return floors.by_kind();
}

}  // namespace lockstep::schur
