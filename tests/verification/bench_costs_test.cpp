// SPDX-License-Identifier: BSD-3-Clause
// The rules by which runs become costs in the comparison with other engines.
#include "tests/benchmark/peers/costs.h"
#include "tests/support/catch.h"

namespace bench_costs_test {

using namespace lockstep::peers;

namespace {

/// Of one method: setting, CPU, error.
Line line(double setting, double cpu, double error, const std::string& status = "ok steps=10 evaluations=40") {
  return {"lockstep", "chain-10", "m", status, setting, cpu, error, error};
}

}  // namespace

TEST_CASE("the cheapest run within the error counts when a coarser one missed it", "[verification][bench]") {
  const std::vector<Line> runs = {line(0.1, 1, 1e-2), line(0.05, 2, 1e-4), line(0.025, 4, 1e-6)};
  const MaybeCost cost = cheapest_of(runs, 1e-3, &Line::error);
  REQUIRE(cost);
  CHECK(cost->cpu == 2);
  CHECK(cost->setting == 0.05);
  CHECK_FALSE(cost->bound);
  CHECK_FALSE(cheapest_of(runs, 1e-7, &Line::error));
}

TEST_CASE("without a coarser run, or with one that was cut short, a cost is an upper bound", "[verification][bench]") {
  CHECK(cheapest_of({line(0.1, 1, 1e-4)}, 1e-3, &Line::error)->bound);
  CHECK(cheapest_of({line(0.2, 0, 0, "over-budget"), line(0.1, 1, 1e-4)}, 1e-3, &Line::error)->bound);
  CHECK_FALSE(cheapest_of({line(0.2, 0, 0, "exception: no"), line(0.1, 1, 1e-4)}, 1e-3, &Line::error)->bound);
}

TEST_CASE("an accidental agreement does not count", "[verification][bench]") {
  const std::vector<Line> runs = {line(0.1, 1, 1e-4), line(0.05, 2, 5e-3), line(0.025, 4, 1.9e-3),
                                  line(0.0125, 8, 1e-4)};
  CHECK(cheapest_of(runs, 1e-3, &Line::error)->cpu == 8);
  // a finer run that came to a wrong end speaks against it, one that stopped with an error does not
  CHECK_FALSE(cheapest_of({line(0.1, 1, 1e-4), line(0.05, 2, 1e9, "blown-up steps=3")}, 1e-3, &Line::error));
  CHECK(cheapest_of({line(0.1, 1, 1e-4), line(0.05, 2, 0, "exception: small step")}, 1e-3, &Line::error));
}

TEST_CASE("beyond the budget a converging method is continued, a stalling one is not", "[verification][bench]") {
  // order 2: four times the work, a sixteenth of the error
  std::vector<Line> runs = {line(0.4, 1, 1.6e-2), line(0.2, 2, 4e-3), line(0.1, 4, 1e-3)};
  const MaybeCost cost = continued(runs, 1e-5, &Line::error);
  REQUIRE(cost);
  CHECK(cost->guess);
  CHECK(cost->cpu == Approx(40));
  CHECK_FALSE(continued(runs, 1e-7, &Line::error));  // 100 times beyond
  runs.push_back(line(0.05, 8, 9e-4));
  CHECK_FALSE(continued(runs, 1e-5, &Line::error));
  runs.back() = line(0.05, 0, 0, "exception: no");
  CHECK_FALSE(continued(runs, 1e-5, &Line::error));
}

TEST_CASE("the best peer is the cheapest of all but lockstep, measured before guessed", "[verification][bench]") {
  std::vector<Line> runs = {line(0.2, 1, 1), line(0.1, 2, 1e-4)};
  for (const auto& [system, cpu] : {std::pair<std::string, double>{"a", 5}, {"b", 3}}) {
    runs.push_back(line(0.2, cpu / 2, 1)), runs.back().system = system;
    runs.push_back(line(0.1, cpu, 1e-4)), runs.back().system = system;
  }
  const Costs costs(runs);
  CHECK(costs.systems() == std::vector<std::string>{"lockstep", "a", "b"});
  CHECK(costs.mechanisms() == std::vector<std::string>{"chain-10"});
  CHECK(costs.cheapest("chain-10", "lockstep", 1e-3, &Line::error)->cpu == 2);
  CHECK(costs.best_peer("chain-10", 1e-3, &Line::error)->cpu == 3);
  CHECK_FALSE(costs.best_peer("chain-100", 1e-3, &Line::error));
}

}  // namespace bench_costs_test
