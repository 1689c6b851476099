// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/closure_fronts.h"

#include <algorithm>
#include <span>

#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

namespace {

// The nodes on the way of a link's slots to where they meet, without that place.
struct Paths {
  std::vector<std::size_t> nodes;
  std::size_t end;  // the number of nodes: the ground
};

// Parents have smaller numbers than their children: from the largest number on, the paths meet in one.
Paths paths_of(std::vector<std::size_t> at, bool grounded, const std::vector<std::size_t>& parents) {
  const std::size_t ground = parents.size();
  Paths paths;
  const auto deeper = [&](std::size_t k) { return k == ground ? -1 : static_cast<int>(k); };
  const auto met = [&] {
    return std::ranges::all_of(at, [&](std::size_t k) { return k == (grounded ? ground : at.front()); });
  };
  while (!met()) {
    const std::size_t k = *std::ranges::max_element(at, {}, deeper);
    paths.nodes.push_back(k);
    std::ranges::replace(at, k, parents[k]);
  }
  paths.end = at.empty() ? ground : at.front();
  return paths;
}

// Whether a link holds something against the ground: then its rows are not met by the motions of its slots against one
// another alone.
bool is_grounded(const Lock& link, const RowEntry& e) {
  if (e.slots.n < 2) return true;
  return std::ranges::any_of(link.pairs(), [](const auto& pair) {
    return pair.first->body->slot == kGround || pair.second->body->slot == kGround;
  });
}

}  // namespace

ClosureFronts::ClosureFronts(const JointTree& tree, const System& system, const RowTable& table)
    : n_nodes(tree.nodes().size()) {
  std::vector<std::size_t> node_of(system.n_slots());
  for (std::size_t k = 0; k < n_nodes; ++k) {
    const TreeNode& t = tree.nodes()[k];
    node_of[t.slot] = k;
    parents.push_back(t.parent < 0 ? n_nodes : static_cast<std::size_t>(t.parent));
  }
  std::vector<Rows> open(n_nodes), closing(n_nodes), grounded;
  std::vector<std::vector<int>> together(n_nodes);  // of each node: those of `grounded` that pass through it
  for (const RowEntry& e : table.entries) {
    std::vector<std::size_t> at;
    for (int i = 0; i < e.slots.n; ++i) at.push_back(node_of[e.slots[i]]);
    const Paths paths = paths_of(at, is_grounded(*system.links()[e.link], e), parents);
    Rows own;
    for (int k = 0; k < e.m; ++k) own.push_back(e.first_row + k);
    for (const std::size_t k : paths.nodes) open[k].insert(open[k].end(), own.begin(), own.end());
    if (paths.end < n_nodes) {
      closing[paths.end].insert(closing[paths.end].end(), own.begin(), own.end());
      continue;
    }
    for (const std::size_t k : paths.nodes) together[k].push_back(static_cast<int>(grounded.size()));
    grounded.push_back(own);
  }
  for (std::size_t k = 0; k < n_nodes; ++k) add(open[k], closing[k], tree.nodes()[k].n_v());
  for (std::size_t k = 0; k < n_nodes; ++k)
    if (parents[k] < n_nodes) together[k].clear();  // at the roots they all meet
  add_at_ground(grounded, together);
  sources.resize(table.n_rows);
  sort_open();
  link();
  add_sides(table, node_of);
  for (std::vector<int>* numbers : {&rows, &above}) numbers->shrink_to_fit();
  all.shrink_to_fit(), parents.shrink_to_fit(), sides.shrink_to_fit();
}

void ClosureFronts::add(const Rows& open, const Rows& closing, int n_v) {
  ClosureFront front;
  front.first = static_cast<int>(rows.size());
  rows.insert(rows.end(), open.begin(), open.end());
  rows.insert(rows.end(), closing.begin(), closing.end());
  front.n_open = static_cast<int>(open.size());
  front.n = front.n_open + static_cast<int>(closing.size());
  front.Lambda = n_Lambda, front.V = n_V;
  n_Lambda += front.n * front.n;
  n_V += front.n_open * n_v;
  all.push_back(front);
}

// Links that end at the ground, `entries`, are coupled where they pass through one root, `together`. One front each, in
// the order of minimum degree: its open rows are those of the links that it couples with later.
void ClosureFronts::add_at_ground(const std::vector<Rows>& entries, const std::vector<std::vector<int>>& together) {
  Neighbours neighbours(entries.size());
  for (const std::vector<int>& clique : together)
    for (const int a : clique)
      for (const int b : clique)
        if (a < b) couple(neighbours, a, b);
  std::vector<int> weights;
  for (const Rows& own : entries) weights.push_back(static_cast<int>(own.size()));
  std::vector<std::vector<int>> below;
  std::vector<std::size_t> order_of(entries.size());
  for (MinimumDegree order(std::move(neighbours), std::move(weights)); !order.done();) {
    MinimumDegree::Pivot pivot = order.next();
    order_of[pivot.node] = below.size();
    below.push_back(std::move(pivot.below));
    below.back().push_back(pivot.node);  // itself, last
  }
  const auto first_of = [&](const auto& some) {
    std::size_t first = entries.size();
    for (const int e : some) first = std::min(first, order_of[e]);
    return n_nodes + first;
  };
  for (std::size_t k = 0; k < n_nodes; ++k)
    if (parents[k] == n_nodes && !together[k].empty()) parents[k] = first_of(together[k]);
  for (const std::vector<int>& group : below) {
    const std::span<const int> later(group.data(), group.size() - 1);
    Rows open;
    for (const int e : later) open.insert(open.end(), entries[e].begin(), entries[e].end());
    parents.push_back(first_of(later));
    add(open, entries[group.back()], 0);
  }
}

// Fronts of nodes are eliminated from the last one on, then those of the ground from the first one; of a front its rows
// from the last one on.
void ClosureFronts::sort_open() {
  std::vector<int> order(sources.size(), 0);  // by row: when it is eliminated
  int n = 0;
  const auto eliminate = [&](const ClosureFront& front) {
    for (int i = front.n; i-- > front.n_open;) order[row_of(front, i)] = n++;
  };
  for (std::size_t k = n_nodes; k-- > 0;) eliminate(all[k]);
  for (std::size_t k = n_nodes; k < all.size(); ++k) eliminate(all[k]);
  for (const ClosureFront& front : all)
    std::ranges::sort(std::span(rows).subspan(front.first, static_cast<std::size_t>(front.n_open)),
                      std::ranges::greater(), [&](int row) { return order[row]; });
}

// The numbers of open rows at the parents.
void ClosureFronts::link() {
  above.assign(rows.size(), -1);
  std::vector<int> number(sources.size(), -1);  // of each row at the parent
  for (std::size_t k = 0; k < all.size(); ++k) {
    const ClosureFront& front = all[k];
    if (front.n_open == 0) continue;
    const ClosureFront& up = all[parents[k]];
    for (int i = 0; i < up.n; ++i) number[row_of(up, i)] = i;
    for (int i = 0; i < front.n_open; ++i) above[front.first + i] = number[row_of(front, i)];
  }
}

void ClosureFronts::add_sides(const RowTable& table, const std::vector<std::size_t>& node_of) {
  for (const RowEntry& e : table.entries)
    for (int k = 0; k < e.m; ++k) {
      ClosureSource& source = sources[e.first_row + k];
      source = {static_cast<int>(sides.size()), e.slots.n, e.kind[k]};
      for (int i = 0; i < e.slots.n; ++i) {
        ClosureSide side;
        side.node = static_cast<int>(node_of[e.slots[i]]);
        side.place = all[side.node].first;
        while (rows[side.place] != e.first_row + k) ++side.place;
        sides.push_back(side);
      }
    }
}

}  // namespace lockstep
