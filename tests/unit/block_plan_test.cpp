// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/block_plan.h"

#include <algorithm>
#include <random>

#include "tests/support/block_work.h"
#include "tests/support/catch.h"

namespace block_plan_test {

using namespace lockstep;

namespace {

/// Bodies (6) and links (5 rows); parents[k]: the body that body k hangs on, -1 the ground.
BlockGraph tree(const std::vector<int>& parents) {
  BlockGraph g;
  g.n_slots = static_cast<int>(parents.size());
  g.width.assign(parents.size(), 6);
  for (int k = 0; k < g.n_slots; ++k) {
    const int link = static_cast<int>(g.width.size());
    g.width.push_back(5);
    g.edges.emplace_back(k, link);
    if (parents[k] >= 0) g.edges.emplace_back(link, parents[k]);
  }
  int at = 0;
  for (const int w : g.width) g.first.push_back(at), at += w;
  return g;
}

std::size_t couplings(const BlockPlan& plan) { return plan.later.size(); }

/// A link stands behind one of its slots at least, and no slot carries more rows before it than it has freedoms unless
/// all the link's slots are gone.
void check_links_wait(const BlockGraph& g, const BlockPlan& plan) {
  for (int l = g.n_slots; l < static_cast<int>(g.width.size()); ++l) {
    int before = 0;
    for (const auto& [a, b] : g.edges) {
      if (a != l && b != l) continue;
      const int slot = a == l ? b : a;
      if (plan.place_of_node[slot] < plan.place_of_node[l]) ++before;
    }
    CAPTURE(l);
    CHECK(before >= 1);
  }
}

}  // namespace

TEST_CASE("A tree makes no fill, for every shape", "[unit][kkt]") {
  std::mt19937 bits(3);
  for (int kind = 0; kind < 4; ++kind) {
    CAPTURE(kind);
    std::vector<int> parents;
    for (int k = 0; k < 60; ++k) {
      const int any = k == 0 ? -1 : static_cast<int>(bits() % static_cast<unsigned>(k));
      parents.push_back(kind == 0   ? k - 1
                        : kind == 1 ? std::min(k - 1, 0)
                        : kind == 2 ? any
                                    : (k % 7 == 0 ? -1 : k - 1));
    }
    const BlockGraph g = tree(parents);
    BlockPlan plan;
    plan.lay_out(g, true);
    CHECK(plan.nodes.size() == g.width.size());
    CHECK(couplings(plan) == g.edges.size());
    check_links_wait(g, plan);
  }
}

TEST_CASE("A joint never precedes the space of its constraints", "[unit][kkt]") {
  // two bodies and three links of five rows in a row, ground to ground: 15 rows on 12 freedoms
  BlockGraph g = tree({-1, 0});
  g.width.push_back(5), g.first.push_back(22);
  g.edges.emplace_back(4, 1);
  BlockPlan plan;
  plan.lay_out(g, true);
  check_links_wait(g, plan);
  CHECK(plan.nodes.back().node >= g.n_slots);  // the third waits for both bodies
  // a body on the ground by two links: one of them finds no room on the body, and waits for it all the same
  BlockGraph doubled = tree({-1});
  doubled.width.push_back(5), doubled.first.push_back(11);
  doubled.edges.emplace_back(0, 2);
  plan.lay_out(doubled, true);
  CHECK(plan.nodes.front().node == 0);
}

TEST_CASE("A plan knows a tree from a loop", "[unit][kkt]") {
  BlockPlan plan;
  const auto is_tree = [&](const BlockGraph& g) {
    plan.lay_out(g, true);
    return plan.tree;
  };
  const auto with_link = [](BlockGraph g, const std::vector<int>& slots) {
    const int link = static_cast<int>(g.width.size());
    g.width.push_back(1), g.first.push_back(g.first.back() + g.width[g.width.size() - 2]);
    for (const int s : slots) g.edges.emplace_back(link, s);
    return g;
  };
  const BlockGraph chain = tree({-1, 0, 1, -1});
  CHECK(is_tree(chain));
  BlockGraph sprung = chain;
  sprung.edges.emplace_back(0, 2);  // a stiff force closes no loop of links
  CHECK(is_tree(sprung));
  CHECK_FALSE(is_tree(with_link(chain, {2})));           // back to the ground
  CHECK_FALSE(is_tree(with_link(chain, {2, 0})));        // among themselves
  CHECK_FALSE(is_tree(with_link(chain, {3, 2})));        // by two ways to the ground
  CHECK_FALSE(is_tree(with_link(chain, {0, 1, 2, 3})));  // nobody knows
}

TEST_CASE("Blocks are found at their places, from both sides", "[unit][kkt]") {
  const BlockGraph g = tree({-1, 0, 1, 1});
  BlockPlan full, half;
  full.lay_out(g, false), half.lay_out(g, true);
  std::vector<std::size_t> seen;
  for (const auto& [a, b] : g.edges) {
    const BlockPlan::Place ab = full.find(a, b), ba = full.find(b, a);
    CHECK(ab.transposed != ba.transposed);
    CHECK((ab.at > ba.at ? ab.at - ba.at : ba.at - ab.at) == 30);  // one behind the other
    CHECK(half.find(a, b).at == half.find(b, a).at);
    CHECK(half.find(a, b).transposed != half.find(b, a).transposed);
    CHECK(full.find_above(a, b).at == std::min(ab.at, ba.at));
    seen.push_back(ab.at), seen.push_back(ba.at);
  }
  std::sort(seen.begin(), seen.end());
  CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
  CHECK(full.size == half.size + 30 * g.edges.size());
}

TEST_CASE("Work grows with the bodies alone", "[unit][kkt]") {
  const auto work = [](int n, bool hub, bool symmetric) {
    std::vector<int> parents;
    for (int k = 0; k < n; ++k) parents.push_back(hub ? std::min(k - 1, 0) : k - 1);
    BlockGraph g = tree(parents);
    if (!hub)
      for (int k = 0; k + 1 < n; ++k) g.edges.emplace_back(k, k + 1);  // stiff springs along the joints
    BlockPlan plan;
    plan.lay_out(g, symmetric);
    return static_cast<double>(test::multiplications(plan)) / n;
  };
  for (const bool hub : {false, true})
    for (const bool symmetric : {false, true})
      CHECK(work(1000, hub, symmetric) == Approx(work(100, hub, symmetric)).epsilon(0.02));
}

}  // namespace block_plan_test
