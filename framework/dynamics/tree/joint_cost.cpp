// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/joint_cost.h"

#include <fmt/format.h>

#include <lockstep/author/passes.h>
#include "framework/dynamics/solvers/schur_plan.h"

namespace lockstep {

namespace {

// Multiply-adds, in space of columns: of a node with its motion, of a coordinate; of a row's side, of a row that is open at a
// node, of one with a coordinate there, of one that ends there, and of that with another one; of a row as its link writes it
// (in space half of the theory's (5.2)).
struct Counts {
  int node, coordinate, side, open, step, end, other, row;
};
constexpr Counts kInSpace{250, 60, 36, 14, 9, 20, 4, 50}, kInPlane{75, 35, 20, 12, 8, 15, 5, 16},
    kAtGround{0, 0, 0, 1, 0, 0, 2, 0};

}  // namespace

// Rows that end at a node are more than the coordinates beyond it: some depend on others for certain. Rows that are open there
// take rounding from pivots that are proximal terms alone, and are corrected, which visits all again.
Operations count_operations(const JointTree& tree, const ClosureFronts& fronts, const RowTable& closures) {
  const Counts& there = tree.planar() && fronts.in_plane ? kInPlane : kInSpace;
  Operations sum;
  std::vector<int> more(fronts.all.size() + 1, 0);  // rows than coordinates, of each front
  int visits = 1;
  for (std::size_t k = fronts.all.size(); k-- > 0;) {
    const ClosureFront& front = fronts.all[k];
    const bool moves = k < fronts.n_nodes;
    const Counts& one = moves ? there : kAtGround;
    const int open = front.n_open, n_v = moves ? tree.nodes()[k].n_v() : 0;
    const double rows = open * (n_v * one.step + one.open) + 0.5 * open * (open + 1) * (n_v + 1);
    sum.add(one.node + n_v * one.coordinate + rows, moves + n_v + open);
    for (int j = open; j < front.n; ++j) sum.add(one.end + j * one.other + 0.5 * j * (j + 1), 2);
    more[k] += front.n - open;
    if (moves && front.n > open && open > 0 && more[k] > 0) visits = 2;
    if (moves && fronts.parents[k] < fronts.n_nodes) more[fronts.parents[k]] += more[k] - n_v;
  }
  for (const RowEntry& e : closures.entries) sum.add(e.m * e.slots.n * there.side, e.m);
  sum.visits *= visits;
  return sum;
}

Operations count_in_omega(const System& system, const std::vector<bool>& modes, const RowTable& closures) {
  RowTable all;
  passes::lay_out(system, modes, all);
  Operations sum = schur::count_operations(schur::make_plan(all, system.n_slots(), bool(system.plane())));
  for (const RowEntry& e : all.entries)
    if (closures.entry_of_link[e.link] < 0) sum.add((system.plane() ? kInPlane : kInSpace).row * e.m, 1);
  return sum;
}

std::string why_dearer(const JointTree& tree, const ClosureFronts& fronts, const RowTable& closures,
                       const System& system, const std::vector<bool>& modes) {
  for (const auto& own : system.auxiliaries())
    if (tree.may_be_redundant() && own->reads_solution() && !own->vanishes_without_laws())
      return "the states of '" + own->name() +
             "' read accelerations or reactions, which only formulation omega computes in every evaluation";
  const double along = count_operations(tree, fronts, closures).total(),
               omega = count_in_omega(system, modes, closures).total();
  return along <= omega ? "" : fmt::format("joint coordinates need {:.0f} operations, omega {:.0f}", along, omega);
}

}  // namespace lockstep
