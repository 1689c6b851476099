// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/block_plan.h"

#include <algorithm>
#include <cassert>

#include "framework/dynamics/solvers/graph.h"

namespace lockstep {
namespace {

// Which links may be eliminated: one waits until one of its slots that has room for its rows is gone, or all are.
class Support {
 public:
  Support(const BlockGraph& graph, const Neighbours& home, MinimumDegree& order)
      : graph_(graph), home_(home), order_(order), room_(graph.n_slots, -1) {
    for (int l = graph.n_slots; l < static_cast<int>(graph.width.size()); ++l) update(l);
  }
  void eliminated(int node) {
    if (node < graph_.n_slots)
      room_[node] = graph_.width[node];
    else if (const int slot = support(node); slot >= 0)
      room_[slot] -= graph_.width[node], node = slot;
    else
      return;
    for (const int l : home_[node])
      if (l >= graph_.n_slots) update(l);
  }

 private:
  // The eliminated slot that holds the link's rows with least room to spare; -1: none.
  int support(int link) const {
    int best = -1;
    for (const int s : home_[link])
      if (room_[s] >= graph_.width[link] && (best < 0 || room_[s] < room_[best])) best = s;
    return best;
  }
  void update(int link) {
    const bool all_gone = std::all_of(home_[link].begin(), home_[link].end(), [&](int s) { return room_[s] >= 0; });
    order_.hold(link, support(link) < 0 && !all_gone);
  }

  const BlockGraph& graph_;
  const Neighbours& home_;  // in the whole graph
  MinimumDegree& order_;
  std::vector<int> room_;  // of an eliminated slot: rows that it can still hold; -1: not eliminated
};

LinkGraph links_of(const BlockGraph& graph, const Neighbours& home) {
  LinkGraph links;
  links.n_slots = graph.n_slots;
  for (auto at = home.begin() + graph.n_slots; at != home.end(); ++at) links.slots.emplace_back(at->begin(), at->end());
  return links;
}

}  // namespace

void BlockPlan::lay_out(const BlockGraph& graph, bool is_symmetric) {
  *this = {};
  symmetric = is_symmetric;
  Neighbours home(graph.width.size());
  for (const auto& [a, b] : graph.edges) couple(home, a, b);
  tree = links_of(graph, home).is_tree();
  place_of_node.assign(graph.width.size(), -1);
  std::vector<std::vector<int>> rest;
  MinimumDegree order(home, graph.width);
  for (Support support(graph, home, order); !order.done();) {
    const auto [pivot, below] = order.next();
    support.eliminated(pivot);
    place_of_node[pivot] = static_cast<int>(nodes.size());
    nodes.push_back({pivot, graph.width[pivot], graph.first[pivot], 0, 0, 0, 0, pivot < graph.n_slots ? 1.0 : -1.0});
    rest.push_back(below);
  }

  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Node& pivot = nodes[k];
    pivot.D = size;
    size += pivot.width * pivot.width;
    pivot.first_later = static_cast<int>(later.size());
    pivot.n_later = static_cast<int>(rest[k].size());
    for (const int s : rest[k]) later.push_back({graph.width[s], graph.first[s], place_of_node[s], 0});
    const auto begin = later.begin() + pivot.first_later;
    std::sort(begin, later.end(), [](const Later& a, const Later& b) { return a.place < b.place; });
    for (auto s = begin; s != later.end(); ++s) {
      s->U = size;
      size += (symmetric ? 1 : 2) * pivot.width * s->width;
    }
  }
  for (Node& pivot : nodes) {
    pivot.first_target = targets.size();
    const Later* s = later.data() + pivot.first_later;
    for (int b = 0; b < pivot.n_later; ++b)
      for (int a = 0; a <= b; ++a) targets.push_back(find(nodes[s[a].place].node, nodes[s[b].place].node).at);
  }
}

BlockPlan::Place BlockPlan::find(int row, int column) const {
  Place place = find_above(row, column);
  if (place.transposed && !symmetric) {
    const auto size_of = [&](int node) { return nodes[place_of_node[node]].width; };
    place.at += size_of(row) * size_of(column);
  }
  return place;
}

BlockPlan::Place BlockPlan::find_above(int row, int column) const {
  int a = place_of_node[row], b = place_of_node[column];
  if (a == b) return {nodes[a].D, false};
  const bool below = a > b;
  if (below) std::swap(a, b);
  const Node& pivot = nodes[a];
  const Later* begin = later.data() + pivot.first_later;
  const Later* end = begin + pivot.n_later;
  const Later* at = std::lower_bound(begin, end, b, [](const Later& s, int place) { return s.place < place; });
  assert(at != end && at->place == b);
  return {at->U, below};
}

}  // namespace lockstep
