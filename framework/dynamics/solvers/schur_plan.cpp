#include "framework/dynamics/solvers/schur_plan.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

namespace lockstep::schur {
namespace {

// The graph of elimination: links first, then hubs.
struct Graph {
  int n_links = 0;
  std::vector<int> hub_of_slot;  // number among the hubs; -1: none
  std::vector<int> slot_of_hub;
  std::vector<std::set<int>> neighbours;

  int n() const { return n_links + static_cast<int>(slot_of_hub.size()); }
  int hub_node(int slot) const {
    const int h = hub_of_slot[static_cast<std::size_t>(slot)];
    return h < 0 ? -1 : n_links + h;
  }
};

Graph make_graph(const RowTable& rows, int n_slots) {
  Graph g;
  g.n_links = static_cast<int>(rows.entries.size());
  std::vector<std::vector<int>> on_slot(static_cast<std::size_t>(n_slots));
  for (int l = 0; l < g.n_links; ++l) {
    const SlotList& slots = rows.entries[static_cast<std::size_t>(l)].slots;
    for (int i = 0; i < slots.n; ++i) on_slot[static_cast<std::size_t>(slots[i])].push_back(l);
  }
  g.hub_of_slot.assign(static_cast<std::size_t>(n_slots), -1);
  for (int s = 0; s < n_slots; ++s)
    if (on_slot[static_cast<std::size_t>(s)].size() > Plan::kHub) {
      g.hub_of_slot[static_cast<std::size_t>(s)] = static_cast<int>(g.slot_of_hub.size());
      g.slot_of_hub.push_back(s);
    }
  g.neighbours.resize(static_cast<std::size_t>(g.n()));
  const auto join = [&](int a, int b) {
    if (a == b) return;
    g.neighbours[static_cast<std::size_t>(a)].insert(b);
    g.neighbours[static_cast<std::size_t>(b)].insert(a);
  };
  for (int s = 0; s < n_slots; ++s) {
    const std::vector<int>& links = on_slot[static_cast<std::size_t>(s)];
    if (const int hub = g.hub_node(s); hub >= 0) {
      for (const int l : links) join(l, hub);
    } else {
      for (const int a : links)
        for (const int b : links) join(a, b);
    }
  }
  return g;
}

// A forest with the ground as one body has one link fewer than bodies in each part.
bool is_tree(const RowTable& rows, int n_slots) {
  std::vector<int> part(static_cast<std::size_t>(n_slots + 1));  // the last is the ground
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int k) {
    while (part[static_cast<std::size_t>(k)] != k) {
      part[static_cast<std::size_t>(k)] = part[static_cast<std::size_t>(part[static_cast<std::size_t>(k)])];
      k = part[static_cast<std::size_t>(k)];
    }
    return k;
  };
  for (const RowEntry& e : rows.entries) {
    int a = root(e.slots.n < 2 ? n_slots : e.slots[1]);
    const int b = root(e.slots[0]);
    if (a == b || e.slots.n > 2) return false;
    part[static_cast<std::size_t>(b)] = a;
  }
  return true;
}

// Minimum degree; of equals the one that was touched longest ago, so that pivots that follow one another do not wait
// for one another. A link may lean on a hub alone: before the hub is gone its pivot would be E.
class Order {
 public:
  Order(const RowTable& rows, Graph& g) : g_(g), touched_(static_cast<std::size_t>(g.n()), 0) {
    blocked_.assign(static_cast<std::size_t>(g.n()), false);
    block_links(rows);
    for (int k = 0; k < g.n(); ++k) queue_.insert(key(k));
    below.resize(static_cast<std::size_t>(g.n()));
    while (!queue_.empty()) eliminate(std::get<3>(*queue_.begin()));
  }
  std::vector<int> sequence;
  std::vector<std::vector<int>> below;  // of each node: those coupled with it when it goes

 private:
  using Key = std::tuple<bool, std::size_t, int, int>;
  Key key(int k) const {
    const auto i = static_cast<std::size_t>(k);
    return {blocked_[i], g_.neighbours[i].size(), touched_[i], k};
  }
  // Slots that are no hubs fall into parts. A part that hangs at one hub by one link is free to go before it. In one
  // that is held elsewhere too (the ground, another hub, a loop) the links on hubs wait.
  void block_links(const RowTable& rows) {
    std::vector<int> part(g_.hub_of_slot.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](int k) {
      while (part[static_cast<std::size_t>(k)] != k) k = part[static_cast<std::size_t>(k)];
      return k;
    };
    const auto each = [&](int l, auto&& visit) {  // visit(slot, whether it is a hub)
      const SlotList& slots = rows.entries[static_cast<std::size_t>(l)].slots;
      for (int i = 0; i < slots.n; ++i) visit(slots[i], g_.hub_node(slots[i]) >= 0);
    };
    const auto part_of = [&](int l) {
      int found = -1;
      each(l, [&](int slot, bool hub) { found = hub ? found : root(slot); });
      return found;
    };
    for (int l = 0; l < g_.n_links; ++l) {
      const int first = part_of(l);
      each(l, [&](int slot, bool hub) {
        if (!hub) part[static_cast<std::size_t>(root(slot))] = first;
      });
    }
    std::vector<int> holds(part.size(), 0);  // links that tie the part to something else
    std::vector<bool> on_hub(static_cast<std::size_t>(g_.n_links), false);
    for (int l = 0; l < g_.n_links; ++l) {
      const int p = part_of(l);
      each(l, [&](int, bool hub) { on_hub[static_cast<std::size_t>(l)] = on_hub[static_cast<std::size_t>(l)] || hub; });
      const bool to_ground = rows.entries[static_cast<std::size_t>(l)].slots.n == 1;
      if (p >= 0 && (to_ground || on_hub[static_cast<std::size_t>(l)])) ++holds[static_cast<std::size_t>(p)];
    }
    for (int l = 0; l < g_.n_links; ++l) {
      const int p = part_of(l);
      blocked_[static_cast<std::size_t>(l)] =
          on_hub[static_cast<std::size_t>(l)] && (p < 0 || holds[static_cast<std::size_t>(p)] > 1);
    }
  }
  void eliminate(int p) {
    const auto ip = static_cast<std::size_t>(p);
    queue_.erase(key(p));
    sequence.push_back(p);
    below[ip].assign(g_.neighbours[ip].begin(), g_.neighbours[ip].end());
    ++clock_;
    for (const int a : below[ip]) {
      const auto ia = static_cast<std::size_t>(a);
      queue_.erase(key(a));
      g_.neighbours[ia].erase(p);
      for (const int b : below[ip])
        if (b != a) g_.neighbours[ia].insert(b);
      touched_[ia] = clock_;
      if (p >= g_.n_links) blocked_[ia] = false;
      queue_.insert(key(a));
    }
    g_.neighbours[ip].clear();
  }

  Graph& g_;
  std::vector<bool> blocked_;
  std::vector<int> touched_;
  std::set<Key> queue_;
  int clock_ = 0;
};

Node node_of(const RowEntry& e, int link, const Graph& g, Plan& plan) {
  const RowShape shape = e.shape();
  Node node;
  node.m = e.m;
  node.link = link;
  node.layout = e.layout;
  node.first_row = e.first_row;
  node.rows = e.offset;
  node.R = e.offset + shape.R();
  node.first_side = static_cast<int>(plan.sides.size());
  node.n_sides = e.slots.n;
  for (int i = 0; i < e.slots.n; ++i) {
    plan.size_Y = aligned_to(plan.size_Y, 8);
    plan.sides.push_back(
        {e.slots[i], shape.sign_of(i), g.hub_node(e.slots[i]) >= 0, e.offset + shape.J(i), plan.size_Y});
    plan.size_Y += static_cast<std::size_t>(n_columns(e.layout) * node.ld());
    node.on_hub = node.on_hub || plan.sides.back().hub;
  }
  for (int k = 0; k < e.m; ++k) {
    const RowKind kind = e.kind[static_cast<std::size_t>(k)];
    if (kind == RowKind::translation) node.translations |= 1u << k;
    if (kind == RowKind::rotation) node.rotations |= 1u << k;
  }
  return node;
}

void add_terms(Plan& plan, const Node& pivot, const Node& other, Later& out) {
  out.first_term = static_cast<int>(plan.terms.size());
  for (int i = 0; i < std::max(pivot.n_sides, 1); ++i)
    for (int j = 0; j < std::max(other.n_sides, 1); ++j) {
      const Side* a = pivot.link < 0 ? nullptr : &plan.sides[static_cast<std::size_t>(pivot.first_side + i)];
      const Side* b = other.link < 0 ? nullptr : &plan.sides[static_cast<std::size_t>(other.first_side + j)];
      const bool meet = a && b ? a->slot == b->slot && !a->hub
                        : a    ? a->slot == other.hub_slot
                        : b    ? b->slot == pivot.hub_slot
                               : false;
      if (meet) plan.terms.push_back({a ? pivot.first_side + i : -1, b ? other.first_side + j : -1});
    }
  out.n_terms = static_cast<int>(plan.terms.size()) - out.first_term;
}

}  // namespace

Plan make_plan(const RowTable& rows, int n_slots, bool planar) {
  Graph graph = make_graph(rows, n_slots);
  Plan plan;
  plan.n_slots = n_slots;
  plan.planar = planar;
  plan.n_rows = rows.n_rows;
  // Before a hub is gone, its links may lean on nothing but E.
  plan.tree = graph.slot_of_hub.empty() && is_tree(rows, n_slots);
  Order order(rows, graph);

  std::vector<int> when(static_cast<std::size_t>(graph.n()));
  for (std::size_t k = 0; k < order.sequence.size(); ++k)
    when[static_cast<std::size_t>(order.sequence[k])] = static_cast<int>(k);
  for (const int p : order.sequence) {
    Node node;
    if (p < graph.n_links) {
      node = node_of(rows.entries[static_cast<std::size_t>(p)], p, graph, plan);
    } else {
      node.m = planar ? 3 : 6;
      node.hub_slot = graph.slot_of_hub[static_cast<std::size_t>(p - graph.n_links)];
      plan.hubs.push_back(static_cast<int>(plan.nodes.size()));
    }
    plan.size_x = aligned_to(plan.size_x, node.ld());
    node.x = plan.size_x;
    plan.size_x += static_cast<std::size_t>(node.ld());
    plan.nodes.push_back(node);
  }

  std::vector<std::map<int, std::size_t>> block_of(plan.nodes.size());  // later node -> block
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    Node& node = plan.nodes[k];
    plan.size_A = aligned_to(plan.size_A, node.ld());
    node.D = plan.size_A;
    plan.size_A += static_cast<std::size_t>(node.ld() * node.m);
    node.first_later = static_cast<int>(plan.later.size());
    std::vector<int> below;
    for (const int q : order.below[static_cast<std::size_t>(order.sequence[k])])
      below.push_back(when[static_cast<std::size_t>(q)]);
    std::sort(below.begin(), below.end());
    for (const int q : below) {
      const Node& other = plan.nodes[static_cast<std::size_t>(q)];
      Later l;
      l.node = q, l.m = other.m, l.x = other.x;
      plan.size_A = aligned_to(plan.size_A, other.ld());
      l.block = plan.size_A;
      plan.size_A += static_cast<std::size_t>(other.ld() * node.m);
      add_terms(plan, node, other, l);
      block_of[k][q] = l.block;
      plan.later.push_back(l);
    }
    node.n_later = static_cast<int>(below.size());
  }
  for (Node& node : plan.nodes) {
    node.first_target = static_cast<int>(plan.targets.size());
    for (int s = 0; s < node.n_later; ++s)
      for (int t = 0; t <= s; ++t) {
        const int i = plan.later[static_cast<std::size_t>(node.first_later + s)].node;
        const int j = plan.later[static_cast<std::size_t>(node.first_later + t)].node;
        plan.targets.push_back(s == t ? plan.nodes[static_cast<std::size_t>(i)].D
                                      : block_of[static_cast<std::size_t>(j)].at(i));
      }
  }
  return plan;
}

}  // namespace lockstep::schur
