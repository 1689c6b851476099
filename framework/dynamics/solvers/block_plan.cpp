#include "framework/dynamics/solvers/block_plan.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <tuple>

namespace lockstep {
namespace {

using Neighbours = std::vector<int>;  // sorted

void insert(Neighbours& list, int node) {
  const auto at = std::lower_bound(list.begin(), list.end(), node);
  if (at == list.end() || *at != node) list.insert(at, node);
}
void erase(Neighbours& list, int node) { list.erase(std::lower_bound(list.begin(), list.end(), node)); }

// Minimum degree, counted in unknowns; ties to the node that was touched longest ago.
class Elimination {
 public:
  explicit Elimination(const BlockGraph& graph)
      : graph_(graph),
        live_(graph.width.size()),
        touched_(graph.width.size(), 0),
        room_(graph.width.size(), -1),
        gone_(graph.width.size(), false) {
    for (const auto& [a, b] : graph.edges) insert(live_[index(a)], b), insert(live_[index(b)], a);
    home_ = live_;
    for (int k = 0; k < static_cast<int>(graph.width.size()); ++k) put(k);
  }

  bool done() const { return queue_.empty(); }
  /// The next pivot and its later neighbours.
  std::pair<int, Neighbours> next() {
    const int pivot = std::get<2>(*queue_.begin());
    queue_.erase(queue_.begin());
    const Neighbours rest = live_[index(pivot)];
    for (const int s : rest) take(s);
    for (const int s : rest) {
      erase(live_[index(s)], pivot);
      for (const int t : rest)
        if (t != s) insert(live_[index(s)], t);
      touched_[index(s)] = ++clock_;
    }
    live_[index(pivot)].clear();
    if (pivot < graph_.n_slots)
      room_[index(pivot)] = graph_.width[index(pivot)];
    else
      charge(pivot);
    for (const int s : rest) put(s);
    if (pivot < graph_.n_slots)  // links that waited for it need not be its neighbours any more
      for (const int l : home_[index(pivot)])
        if (l >= graph_.n_slots) take(l), put(l);
    return {pivot, rest};
  }

 private:
  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  std::tuple<int, long, int> key(int k) const {
    int degree = 0;
    for (const int s : live_[index(k)]) degree += graph_.width[index(s)];
    return {degree, touched_[index(k)], k};
  }
  void put(int k) {
    if (!gone_[index(k)] && (k < graph_.n_slots || supported(k))) queue_.insert(key(k));
  }
  void take(int k) { queue_.erase(key(k)); }

  // The eliminated slot that holds the link's rows with least room to spare; -1: none.
  int support(int link) const {
    int best = -1;
    for (const int s : home_[index(link)])
      if (room_[index(s)] >= graph_.width[index(link)] && (best < 0 || room_[index(s)] < room_[index(best)])) best = s;
    return best;
  }
  bool supported(int link) const {
    const Neighbours& slots = home_[index(link)];
    return support(link) >= 0 || std::all_of(slots.begin(), slots.end(), [&](int s) { return room_[index(s)] >= 0; });
  }
  void charge(int link) {
    gone_[index(link)] = true;
    const int slot = support(link);
    if (slot < 0) return;
    room_[index(slot)] -= graph_.width[index(link)];
    for (const int l : home_[index(slot)])  // some may have lost their support
      if (l >= graph_.n_slots) take(l), put(l);
  }

  const BlockGraph& graph_;
  std::vector<Neighbours> live_, home_;  // among those that are left; in the graph
  std::vector<long> touched_;
  std::vector<int> room_;  // of an eliminated slot: rows that it can still hold; -1: not eliminated
  std::vector<bool> gone_;
  std::set<std::tuple<int, long, int>> queue_;
  long clock_ = 0;
};

// Union of slots by links; the ground is behind the slots, and a link on one slot hangs on it.
bool has_no_loop(const BlockGraph& graph) {
  const auto n_slots = static_cast<std::size_t>(graph.n_slots);
  std::vector<std::vector<int>> ends(graph.width.size() - n_slots);
  for (const auto& [a, b] : graph.edges)
    if (std::max(a, b) >= graph.n_slots)
      insert(ends[static_cast<std::size_t>(std::max(a, b)) - n_slots], std::min(a, b));
  std::vector<std::size_t> root(n_slots + 1);
  for (std::size_t k = 0; k < root.size(); ++k) root[k] = k;
  const auto find = [&](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (const std::vector<int>& slots : ends) {
    if (slots.size() > 2) return false;  // it may reach the ground as well
    const std::size_t a = find(slots.empty() ? n_slots : static_cast<std::size_t>(slots[0]));
    const std::size_t b = find(slots.size() < 2 ? n_slots : static_cast<std::size_t>(slots[1]));
    if (a == b) return false;
    root[a] = b;
  }
  return true;
}

}  // namespace

void BlockPlan::lay_out(const BlockGraph& graph, bool is_symmetric) {
  *this = {};
  symmetric = is_symmetric;
  tree = has_no_loop(graph);
  place_of_node.assign(graph.width.size(), -1);
  std::vector<Neighbours> rest;
  for (Elimination elimination(graph); !elimination.done();) {
    auto [pivot, neighbours] = elimination.next();
    const auto k = static_cast<std::size_t>(pivot);
    place_of_node[k] = static_cast<int>(nodes.size());
    nodes.push_back({pivot, graph.width[k], graph.first[k], 0, 0, 0, 0, pivot < graph.n_slots ? 1.0 : -1.0});
    rest.push_back(std::move(neighbours));
  }
  assert(nodes.size() == graph.width.size());

  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Node& pivot = nodes[k];
    pivot.D = size;
    size += static_cast<std::size_t>(pivot.width * pivot.width);
    pivot.first_later = static_cast<int>(later.size());
    pivot.n_later = static_cast<int>(rest[k].size());
    for (const int s : rest[k]) {
      const auto i = static_cast<std::size_t>(s);
      later.push_back({graph.width[i], graph.first[i], place_of_node[i], 0});
    }
    const auto begin = later.begin() + pivot.first_later;
    std::sort(begin, later.end(), [](const Later& a, const Later& b) { return a.place < b.place; });
    for (auto s = begin; s != later.end(); ++s) {
      s->U = size;
      size += static_cast<std::size_t>((symmetric ? 1 : 2) * pivot.width * s->width);
    }
  }
  for (Node& pivot : nodes) {
    pivot.first_target = targets.size();
    const Later* s = later.data() + pivot.first_later;
    const long w = pivot.width;
    multiplications += symmetric ? w * (w + 1) * (w + 2) / 6 : w * w * w / 3 + w;
    for (int b = 0; b < pivot.n_later; ++b) {
      multiplications += (symmetric ? 1 : 2) * w * (w + 1) / 2 * s[b].width;
      for (int a = 0; a <= b; ++a) {
        targets.push_back(
            find(nodes[static_cast<std::size_t>(s[a].place)].node, nodes[static_cast<std::size_t>(s[b].place)].node)
                .at);
        multiplications += (symmetric || a == b ? 1 : 2) * w * s[a].width * s[b].width;
      }
    }
  }
}

BlockPlan::Place BlockPlan::find(int row, int column) const {
  Place place = find_above(row, column);
  if (place.transposed && !symmetric) {
    const auto size_of = [&](int node) {
      return nodes[static_cast<std::size_t>(place_of_node[static_cast<std::size_t>(node)])].width;
    };
    place.at += static_cast<std::size_t>(size_of(row) * size_of(column));
  }
  return place;
}

BlockPlan::Place BlockPlan::find_above(int row, int column) const {
  int a = place_of_node[static_cast<std::size_t>(row)], b = place_of_node[static_cast<std::size_t>(column)];
  if (a == b) return {nodes[static_cast<std::size_t>(a)].D, false};
  const bool below = a > b;
  if (below) std::swap(a, b);
  const Node& pivot = nodes[static_cast<std::size_t>(a)];
  const Later* begin = later.data() + pivot.first_later;
  const Later* end = begin + pivot.n_later;
  const Later* at = std::lower_bound(begin, end, b, [](const Later& s, int place) { return s.place < place; });
  assert(at != end && at->place == b);
  return {at->U, below};
}

}  // namespace lockstep
