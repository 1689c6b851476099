// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/graph.h"

#include <algorithm>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/biconnected_components.hpp>

#include <lockstep/author/lock.h>

namespace lockstep {
namespace {

void insert(std::vector<int>& sorted, int k) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), k);
  if (at == sorted.end() || *at != k) sorted.insert(at, k);
}

}  // namespace

void couple(Neighbours& neighbours, int a, int b) {
  if (a != b) insert(neighbours[a], b), insert(neighbours[b], a);
}

std::vector<std::vector<int>> LinkGraph::links_of_slots() const {
  std::vector<std::vector<int>> out(n_slots);
  for (int l = 0; l < static_cast<int>(slots.size()); ++l)
    for (const int s : slots[l]) out[s].push_back(l);
  return out;
}

// A forest has one link fewer than bodies in each of its parts. A link on one slot is attached to the ground; one on
// more than two may be as well, and counts as a loop.
bool LinkGraph::is_tree() const {
  const int ground = n_slots;
  Parts parts(n_slots + 1);
  return std::all_of(slots.begin(), slots.end(), [&](const auto& ends) {
    return (ends.size() == 1 || ends.size() == 2) && join(parts, ends.size() < 2 ? ground : ends[1], ends[0]);
  });
}

LinkGraph link_graph(const RowTable& rows, int n_slots) {
  LinkGraph graph{n_slots, {}};
  for (const RowEntry& e : rows.entries)
    graph.slots.emplace_back(e.slots.slot.begin(), e.slots.slot.begin() + e.slots.n);
  return graph;
}

bool has_loops(const System& system, const std::vector<bool>& modes) {
  RowTable rows;
  passes::lay_out(system, modes, rows);
  return !link_graph(rows, system.n_slots()).is_tree();
}

std::vector<int> ends_of(const System& system, const Lock& link) {
  const SlotList& slots = link.slots();
  std::vector<int> ends(slots.slot.begin(), slots.slot.begin() + slots.n);
  bool grounded = link.jointed() == nullptr || ends.size() == 1;
  for (const int slot : ends) grounded = grounded || system.slot(slot).freedoms == Freedoms::particle;
  for (const auto& [p, s] : link.pairs()) grounded = grounded || p->body->fixed || s->body->fixed;
  if (grounded) ends.push_back(kGround);
  std::ranges::sort(ends);
  return ends;
}

std::vector<std::size_t> loop_groups(int n_slots, const std::vector<std::pair<int, int>>& edges) {
  using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS, boost::no_property,
                                      boost::property<boost::edge_index_t, std::size_t>>;
  // Parallel edges are one: boost gives each of them a group of its own.
  std::vector<std::pair<int, int>> distinct;
  const auto sorted = [](std::pair<int, int> edge) { return std::pair<int, int>(std::minmax(edge.first, edge.second)); };
  for (const auto& edge : edges) distinct.push_back(sorted(edge));
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());  // clang 14 takes no ranges::unique of g++ 12
  Graph graph(static_cast<std::size_t>(n_slots + 1));  // the ground first
  std::size_t n = 0;
  for (const auto& [a, b] : distinct) boost::add_edge(a + 1, b + 1, n++, graph);
  std::vector<std::size_t> group(n), of_edge;
  boost::biconnected_components(graph, boost::make_iterator_property_map(group.begin(), get(boost::edge_index, graph)));
  for (const auto& edge : edges)
    of_edge.push_back(group[std::ranges::lower_bound(distinct, sorted(edge)) - distinct.begin()]);
  return of_edge;
}

MinimumDegree::MinimumDegree(Neighbours neighbours, std::vector<int> weights)
    : neighbours_(std::move(neighbours)),
      weights_(std::move(weights)),
      touched_(neighbours_.size(), 0),
      held_(neighbours_.size(), false),
      gone_(neighbours_.size(), false) {
  for (int k = 0; k < static_cast<int>(neighbours_.size()); ++k) queue_.insert(key(k));
}

MinimumDegree::Key MinimumDegree::key(int node) const {
  int degree = 0;
  for (const int k : neighbours_[node]) degree += weights_[k];
  return {held_[node], degree, touched_[node], node};
}

void MinimumDegree::hold(int node, bool on) {
  if (gone_[node] || held_[node] == on) return;
  queue_.erase(key(node));
  held_[node] = on;
  queue_.insert(key(node));
}

MinimumDegree::Pivot MinimumDegree::next() {
  const int pivot = std::get<3>(*queue_.begin());
  queue_.erase(queue_.begin());
  gone_[pivot] = true;
  ++clock_;
  const std::vector<int> below = std::move(neighbours_[pivot]);
  for (const int a : below) {
    queue_.erase(key(a));
    std::erase(neighbours_[a], pivot);
    for (const int b : below)
      if (b != a) insert(neighbours_[a], b);
    touched_[a] = clock_;
    queue_.insert(key(a));
  }
  return {pivot, below};
}

}  // namespace lockstep
