// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/analysis.h>

#include <set>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace grid_test {

using namespace lockstep;
using namespace lockstep::testing;

TEST_CASE("a grid has each combination once, the last list changing fastest", "[unit][analysis]") {
  const Grid grid({2, 1, 3});
  CHECK(grid.n_runs() == 6);
  CHECK(grid.at(1) == std::vector<std::size_t>{0, 0, 0});
  CHECK(grid.at(2) == std::vector<std::size_t>{0, 0, 1});
  CHECK(grid.at(4) == std::vector<std::size_t>{1, 0, 0});
  std::set<std::vector<std::size_t>> all;
  for (long run = 1; run <= grid.n_runs(); ++run) all.insert(grid.at(run));
  CHECK(all.size() == 6);
  CHECK(Grid({}).n_runs() == 1);
  CHECK(Grid({}).at(1).empty());
}

TEST_CASE("the shards of a grid have each run once, however many they are", "[unit][analysis]") {
  for (const std::size_t n_runs : {1u, 7u, 12u})
    for (const long n_shards : {1l, 2l, 5l, 12l, 20l}) {
      const Grid grid({n_runs});
      std::multiset<long> runs;
      for (long i = 1; i <= n_shards; ++i)
        for (long k = 0; k < grid.n_runs({i, n_shards}); ++k) runs.insert(Grid::run({i, n_shards}, k));
      INFO(n_runs << " runs, " << n_shards << " shards");
      CHECK(runs.size() == n_runs);
      CHECK(std::set<long>(runs.begin(), runs.end()).size() == n_runs);
      CHECK(*runs.begin() == 1);
      CHECK(*runs.rbegin() == static_cast<long>(n_runs));
    }
  CHECK(Grid::run({2, 3}, 0) == 2);
  CHECK(Grid::run({2, 3}, 1) == 5);
}

TEST_CASE("a grid without runs or with too many is rejected", "[unit][analysis]") {
  CHECK(says(message_of<ModelError>([] { Grid({3, 0}); }), {"has no values"}));
  CHECK(says(message_of<ModelError>([] { Grid({100'000, 100'000}); }), {"more than 1000000000 runs"}));
  const std::size_t huge = ~std::size_t{0};
  CHECK(says(message_of<ModelError>([&] { Grid({huge, huge}); }), {"more than 1000000000 runs"}));
}

TEST_CASE("a share is i of n, counted from 1", "[unit][analysis]") {
  CHECK(read_shard("2/8").index == 2);
  CHECK(read_shard("2/8").count == 8);
  CHECK(read_shard("1/1").count == 1);
  for (const char* text :
       {"", "3", "/", "0/8", "1/0", "-1/8", "1/8x", " 1/8", "1.5/8", "1/2/3", "99999999999999999999/8"}) {
    INFO(text);
    CHECK(says(message_of<ModelError>([&] { read_shard(text); }), {"as in 2/8"}));
  }
  CHECK(says(message_of<ModelError>([] { read_shard("9/8"); }), {"no share 9 of 8", "8/8"}));
}

}  // namespace grid_test
