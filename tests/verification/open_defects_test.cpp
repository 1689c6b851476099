// SPDX-License-Identifier: BSD-3-Clause
// Defects that are known and not mended yet, by what a run gives: see tests/support/open_defect.h.
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "framework/tools/precision/work_precision.h"
#include "tests/support/catch.h"
#include "tests/support/open_defect.h"

namespace open_defects_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

constexpr double kG = 9.81;
const std::string kSmallProgram = "A small program";

/// As Rk4, and every step is told `cost` times.
class Counted final : public Integrator {
 public:
  Counted(long* steps, long cost) : steps_(steps), cost_(cost) {}
  IntegratorInfo info() const override { return method_.info(); }
  void begin(Dynamics& dynamics, const State& state) override { method_.begin(dynamics, state); }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    *steps_ += cost_;
    return method_.step(dynamics, state, h);
  }

 private:
  Rk4 method_;
  long* steps_;
  long cost_;
};

}  // namespace

// Clock and cost are counts of steps. The dear method comes near the truth within the budget, though not within its half.
TEST_CASE("in a chart each method has its first hit before another has its second", "[defect][a small program]") {
  long n_steps = 0;
  WorkPrecisionOptions options;
  options.integrators = {{"cheap", [&] { return std::make_unique<Counted>(&n_steps, 1); }},
                         {"dear", [&] { return std::make_unique<Counted>(&n_steps, 400); }}};
  options.solvers = {{"sparse", [] { return std::make_unique<SparseSolver>(); }}};
  options.formulations = {Formulation::omega};
  options.stabilizations = {Stabilization::Kind::project};
  options.references = {{"dop853", [] { return std::make_unique<Dop853>(); }},
                        {"dopri5", [] { return std::make_unique<Dopri5>(); }}};
  options.reference_tolerance = 1e-9;
  options.repeats = 1;
  options.steps = {1, 2, 4, 8, 16, 32, 64, 128};
  options.clock = options.cpu = [&] { return static_cast<double>(n_steps); };
  const Trajectory swinging{.make =
                                [] {
                                  auto sys = std::make_shared<System>(System::Options{Vec3(0, -kG, 0)});
                                  Body& bar = sys->add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
                                  sys->add<Revolute>("hinge", bar, sys->ground(), pose_at({0, 0, 0}));
                                  sys->setup();
                                  return Subject{sys, sys.get(), sys->start()};
                                },
                            .length = 1.0,
                            .outputs = 10};
  std::vector<WorkPrecisionRun> order;
  double spent = 0;
  options.measured = [&](const WorkPrecisionRun& run) { order.push_back(run); };
  const auto first_hits = [&](double budget) {
    n_steps = 0, order.clear(), options.budget = budget;
    const WorkPrecision result = work_precision(swinging, options);
    const auto hit = [&](const WorkPrecisionRun& run) {
      return run.done() && std::all_of(kErrorKinds.begin(), kErrorKinds.end(), [&](ErrorKind kind) {
               return run.error.of(kind) <= options.first_hit * result.size.of(kind);
             });
    };
    std::vector<std::string> hits;
    spent = 0;  // by the dear one up to its first hit
    for (const WorkPrecisionRun& run : order) {
      if (run.integrator == "dear" && std::count(hits.begin(), hits.end(), "dear") == 0) spent += run.cpu;
      if (hit(run)) hits.push_back(run.integrator);
    }
    return hits;
  };
  const auto position = [](const std::vector<std::string>& hits, const std::string& name, int nth) {
    for (std::size_t k = 0; k < hits.size(); ++k)
      if (hits[k] == name && --nth == 0) return k;
    return std::numeric_limits<std::size_t>::max();
  };
  const std::vector<std::string> ample = first_hits(1e6);
  const std::vector<std::string> scarce = first_hits(1.3 * spent);
  CAPTURE(ample, scarce);
  CHECK(position(ample, "dear", 1) < position(ample, "cheap", 2));
  REQUIRE(position(scarce, "cheap", 1) < scarce.size());
  expect_defect("first hits of a chart", kSmallProgram, position(scarce, "cheap", 2) < position(scarce, "dear", 1),
                position(scarce, "dear", 1) < position(scarce, "cheap", 2));
}

}  // namespace open_defects_test
