// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/schur_plan.h"

#include <algorithm>
#include <map>

#include "framework/dynamics/solvers/graph.h"

namespace lockstep::schur {
namespace {

/// The graph of elimination: links first, then hubs.
struct Graph {
  LinkGraph links;
  std::vector<int> hub_of_slot;  // its node; -1: none
  std::vector<int> slot_of_hub;
  Neighbours neighbours;

  Graph(const RowTable& rows, int n_slots) {
    links = link_graph(rows, n_slots);
    const std::vector<std::vector<int>> on_slot = links.links_of_slots();
    for (int s = 0; s < n_slots; ++s) {
      const bool hub = on_slot[s].size() > Plan::kHub;
      hub_of_slot.push_back(hub ? n_links() + static_cast<int>(slot_of_hub.size()) : -1);
      if (hub) slot_of_hub.push_back(s);
    }
    neighbours.resize(n_links() + slot_of_hub.size());
    for (int s = 0; s < n_slots; ++s)
      for (const int a : on_slot[s]) {
        if (is_hub(s))
          couple(neighbours, a, hub_of_slot[s]);
        else
          for (const int b : on_slot[s]) couple(neighbours, a, b);
      }
  }

  int n_links() const { return static_cast<int>(links.slots.size()); }
  int n() const { return static_cast<int>(neighbours.size()); }
  bool is_hub(int slot) const { return hub_of_slot[slot] >= 0; }

  /// Links that must not be eliminated before their hub: the pivot of a link on hubs alone would be E. Slots that are not
  /// hubs fall into parts. A part attached to one hub by one link may go before it; in a part that is also held elsewhere
  /// (the ground, another hub, a loop) the links on hubs wait.
  std::vector<bool> waiting_links() const {
    Parts parts(links.n_slots);
    const auto part_of = [&](int l) {  // -1: on hubs only
      int found = -1;
      for (const int s : links.slots[l]) found = is_hub(s) ? found : parts.find_set(s);
      return found;
    };
    const auto on_hub = [&](int l) {
      return std::any_of(links.slots[l].begin(), links.slots[l].end(), [&](int s) { return is_hub(s); });
    };
    for (int l = 0; l < n_links(); ++l)
      for (const int s : links.slots[l])
        if (!is_hub(s)) join(parts, part_of(l), s);
    std::vector<int> holds(links.n_slots, 0);  // links that tie the part to the ground or a hub
    for (int l = 0; l < n_links(); ++l)
      if (part_of(l) >= 0 && (links.slots[l].size() == 1 || on_hub(l))) ++holds[part_of(l)];
    std::vector<bool> waiting(n_links());
    for (int l = 0; l < n_links(); ++l) waiting[l] = on_hub(l) && (part_of(l) < 0 || holds[part_of(l)] > 1);
    return waiting;
  }
};

std::vector<MinimumDegree::Pivot> order_of(const Graph& graph) {
  MinimumDegree order(graph.neighbours, std::vector<int>(graph.n(), 1));
  const std::vector<bool> waiting = graph.waiting_links();
  for (int l = 0; l < graph.n_links(); ++l) order.hold(l, waiting[l]);
  std::vector<MinimumDegree::Pivot> pivots;
  while (!order.done()) {
    pivots.push_back(order.next());
    if (pivots.back().node < graph.n_links()) continue;
    for (const int l : pivots.back().below) order.hold(l, false);  // the hub is gone
  }
  return pivots;
}

/// Writes the plan node by node, number after number.
class Layout {
 public:
  Layout(const RowTable& rows, const Graph& graph, Plan& plan) : rows_(rows), graph_(graph), plan_(plan) {}

  void lay_out(const std::vector<MinimumDegree::Pivot>& order) {
    std::vector<int> when(graph_.n());  // of each node of the graph
    for (const MinimumDegree::Pivot& p : order) {
      when[p.node] = static_cast<int>(plan_.nodes.size());
      plan_.nodes.push_back(node_of(p.node));
    }
    block_of_.resize(plan_.nodes.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      std::vector<int> below = order[k].below;
      for (int& q : below) q = when[q];
      std::sort(below.begin(), below.end());
      add_blocks(plan_.nodes[k], below);
    }
    for (Node& node : plan_.nodes) add_targets(node);
  }

 private:
  /// Takes room for n columns of m rows, each a pack. Returns where they begin.
  static std::size_t take(std::size_t& size, int m, int n) {
    const std::size_t at = aligned_to(size, pack_size(m));
    size = at + static_cast<std::size_t>(n * pack_size(m));
    return at;
  }

  Node node_of(int number) {
    Node node;
    if (number >= graph_.n_links()) {
      node.m = plan_.planar ? 3 : 6;
      node.hub_slot = graph_.slot_of_hub[number - graph_.n_links()];
      plan_.hubs.push_back(static_cast<int>(plan_.nodes.size()));
    } else {
      const RowEntry& e = rows_.entries[number];
      node.m = e.m;
      node.link = number;
      node.n_turned = n_turned(e.layout);
      node.turned = node.n_turned > 0;
      node.first_row = e.first_row;
      node.R = e.offset + e.shape().R();
      node.kinds = {e.kind, e.m};
      add_sides(e, node);
    }
    node.x = take(plan_.size_x, node.m, 1);
    return node;
  }

  void add_sides(const RowEntry& e, Node& node) {
    const RowShape shape = e.shape();
    node.first_side = static_cast<int>(plan_.sides.size());
    node.n_sides = e.slots.n;
    for (int i = 0; i < e.slots.n; ++i) {
      const std::size_t Y = take(plan_.size_Y, node.m, n_columns(e.layout));
      const bool hub = graph_.is_hub(e.slots[i]);
      plan_.sides.push_back({e.slots[i], shape.sign_of(i), node.turned, hub, e.offset + shape.J(i), Y});
      node.on_hub = node.on_hub || hub;
    }
  }

  void add_blocks(Node& node, const std::vector<int>& below) {
    node.D = take(plan_.size_A, node.m, node.m);
    node.first_later = static_cast<int>(plan_.later.size());
    node.n_later = static_cast<int>(below.size());
    for (const int q : below) {
      const Node& other = plan_.nodes[q];
      Later later;
      later.node = q, later.m = other.m, later.x = other.x;
      later.block = take(plan_.size_A, other.m, node.m);
      add_terms(node, other, later);
      block_of_[&node - plan_.nodes.data()][q] = later.block;
      plan_.later.push_back(later);
    }
  }

  void add_terms(const Node& pivot, const Node& other, Later& out) {
    out.first_term = static_cast<int>(plan_.terms.size());
    for (int i = 0; i < std::max(pivot.n_sides, 1); ++i)
      for (int j = 0; j < std::max(other.n_sides, 1); ++j) {
        const Side* a = pivot.link < 0 ? nullptr : &plan_.sides[pivot.first_side + i];
        const Side* b = other.link < 0 ? nullptr : &plan_.sides[other.first_side + j];
        const bool meet = a && b ? a->slot == b->slot && !a->hub
                          : a    ? a->slot == other.hub_slot
                          : b    ? b->slot == pivot.hub_slot
                                 : false;
        if (meet) plan_.terms.push_back({a ? pivot.first_side + i : -1, b ? other.first_side + j : -1});
      }
    out.n_terms = static_cast<int>(plan_.terms.size()) - out.first_term;
  }

  void add_targets(Node& node) {
    node.first_target = static_cast<int>(plan_.targets.size());
    const std::span<const Later> later = plan_.later_of(node);
    for (std::size_t s = 0; s < later.size(); ++s)
      for (std::size_t t = 0; t <= s; ++t)
        plan_.targets.push_back(s == t ? plan_.nodes[later[s].node].D : block_of_[later[t].node].at(later[s].node));
  }

  const RowTable& rows_;
  const Graph& graph_;
  Plan& plan_;
  std::vector<std::map<int, std::size_t>> block_of_;  // of each node: later node -> block
};

}  // namespace

// Of each node its own block, T and p, and its part of the solutions; of each side Y, J Y^T, J a of the start and the residual,
// and Y^T x; of each later node its terms, L, and the products with those before it.
Operations count_operations(const Plan& plan) {
  const int nv = plan.planar ? 2 : 3, nw = plan.planar ? 1 : 3, solutions = plan.tree ? 1 : 2;
  Operations sum;
  sum.add((nv + nw) * (nv + nw) * plan.n_slots, plan.n_slots);
  for (const Node& node : plan.nodes) {
    const int m = node.m, columns = node.turned ? nw : nv + nw;
    const int side = nw * nw + columns * (3 + m + solutions * m);
    sum.add(m * (m + 2 + 2 * solutions) + node.n_sides * side, 1 + 2 * m + node.n_sides);
    int rows = 0, visits = 1;
    for (const Later& later : plan.later_of(node)) {
      const bool on_hub = node.link < 0 || plan.nodes[later.node].link < 0;  // a Jacobian
      const int numbers = m * (on_hub ? later.m : node.turned && later.m == m ? columns : columns * later.m);
      rows += later.m;
      sum.add(later.n_terms * numbers + m * (m + solutions * (1 + later.m) + rows), ++visits);
    }
  }
  return sum;
}

Plan make_plan(const RowTable& rows, int n_slots, bool planar) {
  const Graph graph(rows, n_slots);
  Plan plan;
  plan.n_slots = n_slots;
  plan.n_rows = rows.n_rows;
  plan.planar = planar;
  plan.tree =
      graph.slot_of_hub.empty() && graph.links.is_tree();  // before its hub is gone, a link's pivot may be E alone
  Layout(rows, graph, plan).lay_out(order_of(graph));
  return plan;
}

}  // namespace lockstep::schur
