// SPDX-License-Identifier: BSD-3-Clause
// The rules of what counts, on runs written down by hand.
#include "framework/tools/precision/pareto.h"

#include "tests/support/catch.h"

namespace lockstep {
namespace {

WorkPrecisionRun run_of(const std::string& integrator, double setting, double error, double cpu,
                        const std::string& failure = {}) {
  WorkPrecisionRun run;
  run.integrator = integrator, run.solver = "sparse", run.setting = setting;
  run.error = {error, 10 * error, 100 * error, 1000 * error};
  run.cpu = cpu, run.evaluations = static_cast<long>(1e6 * cpu), run.failure = failure;
  run.given_up = failure.starts_with("stopped after");
  return run;
}

std::vector<double> settings(const std::vector<const WorkPrecisionRun*>& runs) {
  std::vector<double> all;
  for (const WorkPrecisionRun* run : runs) all.push_back(run->setting);
  return all;
}

}  // namespace

TEST_CASE("the front is what nothing beats in both", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 8, 1e-1, 1),
                 run_of("a", 4, 1e-2, 2),
                 run_of("a", 2, 1e-3, 4),
                 run_of("b", 7, 5e-2, 3),
                 run_of("b", 5, 1e-4, 3.5),
                 run_of("b", 3, 1e-9, 100),
                 run_of("c", 1, 0, 0.1, "fell apart")};
  CHECK(settings(pareto_front(result)) == std::vector<double>{8, 4, 5, 3});
  CHECK(settings(pareto_front(result, ErrorKind::reaction, CostKind::evaluations)) == std::vector<double>{8, 4, 5, 3});
  result.agreement.position = 2e-4;  // the truth is no better known than that: what is finer is not better
  CHECK(settings(pareto_front(result)) == std::vector<double>{8, 4, 5});
  CHECK(pareto_front(WorkPrecision{}).empty());
}

TEST_CASE("an accidental agreement counts nowhere", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 8, 1e-6, 1), run_of("a", 4, 1e-2, 2), run_of("a", 2, 1.5e-2, 4), run_of("a", 1, 1e-7, 8)};
  CHECK_FALSE(counts(result, result.runs[0]));  // 1e-6, and finer 1e-2
  CHECK(counts(result, result.runs[1]));        // the finer one errs 1.5 times as much only
  CHECK(counts(result, result.runs[2]));
  CHECK(counts(result, result.runs[3]));
  CHECK(settings(pareto_front(result)) == std::vector<double>{4, 1});
  const auto costs = costs_at_error(result, 1e-6);
  REQUIRE(costs.size() == 1);
  CHECK(costs[0].run->setting == 1);
  CHECK_FALSE(costs[0].upper_bound);
  CHECK_FALSE(costs[0].confirmed);

  result.agreement.position = 1e-2;  // as good as the truth, all of them
  CHECK(counts(result, result.runs[0]));
}

TEST_CASE("a finer run that fails takes the coarser ones' credit, one that ran out of time does not",
          "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 2, 1e-3, 1), run_of("a", 1, 0, 5, "singular"), run_of("b", 2, 1e-3, 1),
                 run_of("b", 1, 0, 5, "stopped after 5 s of CPU time")};
  CHECK_FALSE(counts(result, result.runs[0]));
  CHECK_FALSE(counts(result, result.runs[1]));
  CHECK(counts(result, result.runs[2]));
}

TEST_CASE("a wrong run counts nowhere, however small its error", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 2, 1e-3, 1), run_of("a", 1, 1e-4, 2)};
  result.runs[0].wrong = true;
  CHECK(settings(pareto_front(result)) == std::vector<double>{1});
  REQUIRE(costs_at_error(result, 1e-2).size() == 1);
  CHECK(costs_at_error(result, 1e-2)[0].run->setting == 1);
}

TEST_CASE("a cost is an upper bound until the next coarser run missed", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 4, 1e-4, 1), run_of("a", 2, 1e-5, 2),      run_of("b", 4, 1e-2, 1.5),
                 run_of("b", 2, 1e-5, 3), run_of("c", 4, 0, 1, "blew"), run_of("c", 2, 1e-4, 5)};
  const auto costs = costs_at_error(result, 1e-3);
  REQUIRE(costs.size() == 3);
  CHECK(costs[0].run->integrator == "a");
  CHECK(costs[0].run->setting == 4);
  CHECK(costs[0].upper_bound);  // the coarsest that was made
  CHECK(costs[0].confirmed);
  CHECK(costs[1].run->integrator == "b");
  CHECK_FALSE(costs[1].upper_bound);
  CHECK_FALSE(costs[1].confirmed);
  CHECK(costs[2].run->integrator == "c");
  CHECK_FALSE(costs[2].upper_bound);  // the coarser one failed
  const auto finer = costs_at_error(result, 2e-5);
  REQUIRE(finer.size() == 2);
  CHECK(finer[0].run->setting == 2);
  CHECK_FALSE(finer[0].upper_bound);
  const auto of_loads = costs_at_error(result, 2e-2, ErrorKind::reaction);
  REQUIRE(of_loads.size() == 2);
}

TEST_CASE("of about equal costs that of the earlier combination is recommended", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 2, 1e-5, 1.1), run_of("a", 1, 1e-7, 4), run_of("b", 2, 1e-5, 1), run_of("b", 1, 1e-7, 4),
                 run_of("c", 1, 1e-5, 0.5)};
  const auto chosen = [&] { return recommended(costs_at_error(result, 1e-4))->run->integrator; };
  CHECK(chosen() == "a");  // c is cheaper, but no finer run confirms it
  result.runs[0].cpu = 1.3;
  CHECK(chosen() == "b");
  result.runs = {run_of("c", 1, 1e-5, 0.5)};
  CHECK(chosen() == "c");
  // A finer run that is cheaper by chance, and not confirmed itself, does not replace the setting that it confirms.
  result.runs = {run_of("a", 2, 1e-5, 1), run_of("a", 1, 1e-6, 0.9)};
  REQUIRE(costs_at_error(result, 1e-4).size() == 1);
  CHECK(costs_at_error(result, 1e-4)[0].run->setting == 2);
  CHECK(costs_at_error(result, 1e-4)[0].confirmed);
  CHECK(recommended({}) == nullptr);
}

TEST_CASE("a cost at an error is the least of all runs within it", "[unit][pareto]") {
  WorkPrecision result;
  result.runs = {run_of("a", 4, 5e-4, 3), run_of("a", 2, 1e-5, 2), run_of("a", 1, 1e-7, 4)};
  for (const double error : {1e-3, 1e-5}) {
    const auto costs = costs_at_error(result, error);
    REQUIRE(costs.size() == 1);
    CHECK(costs[0].run->setting == 2);
    CHECK(costs[0].run->cpu == 2);
  }
}

}  // namespace lockstep
