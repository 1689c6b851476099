// Work against precision on a mechanism whose motion is known, with an integrator that lies and one that fails.
#include "framework/analysis/work_precision.h"

#include <fstream>
#include <iterator>

#include "framework/kkt/schur_solver.h"
#include "framework/links/joints.h"
#include "framework/support/error.h"
#include "integrators/dop853.h"
#include "integrators/dopri5.h"
#include "integrators/rk4.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace lockstep {
namespace {

/// A body that falls freely: x = v t + g t^2 / 2, which methods of order 2 and higher meet exactly; and a rod on a
/// hinge.
Subject falling() {
  auto sys = std::make_shared<System>(System::Options{Vec3(0, 0, -10)});
  sys->add_body("stone", sphere(1.0, 0.1));
  sys->setup();
  return {sys, sys.get(), sys->start()};
}
Subject swinging() {
  auto sys = std::make_shared<System>(System::Options{Vec3(0, -9.81, 0)});
  Body& bar = sys->add_body("rod", rod(1.0, {0, 0, 0}, {1, 0, 0}));
  sys->add<Revolute>("hinge", bar, sys->ground(), at({0, 0, 0}));
  sys->setup();
  return {sys, sys.get(), sys->start()};
}

/// Moves nothing but the time, and at steps below `fails_below` nothing at all.
class Frozen final : public Integrator {
 public:
  explicit Frozen(double fails_below, bool adaptive = false) : fails_below_(fails_below), adaptive_(adaptive) {}
  IntegratorInfo info() const override { return {"frozen", 1, false, adaptive_, 1}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics&, State& state, double h) override {
    if (h < fails_below_) throw StepError("frozen: too cold", state.t);
    state.t += h;
    StepReport report;
    report.h = h;
    return report;
  }

 private:
  double fails_below_;
  bool adaptive_;
};

template <class M>
MethodChoice choice(const std::string& name) {
  return {name, [] { return std::make_unique<M>(); }};
}

WorkPrecisionOptions quick_options() {
  WorkPrecisionOptions options;
  options.solvers = {{"schur", [] { return std::make_unique<SchurSolver>(); }}};
  options.formulations = {Formulation::omega};
  options.stabilizations = {Stabilization::Kind::project};
  options.reference = choice<Dop853>("dop853"), options.second = choice<Dopri5>("dopri5");
  options.tolerances = {1e-4, 1e-8};
  options.steps = {1, 4};
  options.repeats = 1;
  options.budget = 300;
  return options;
}

}  // namespace

TEST_CASE("errors are those of the history", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4"), {"frozen", [] { return std::make_unique<Frozen>(0.0); }}};
  const WorkPrecision result = work_precision({.make = falling, .length = 2.0, .outputs = 4}, options);
  REQUIRE(result.runs.size() == 4);
  CHECK(result.left_out.empty());
  CHECK(result.agreement.position < 1e-10);
  CHECK(result.size.position == Approx(20.0));  // 10 t^2 / 2
  CHECK(result.size.velocity == Approx(20.0));
  for (const WorkPrecisionRun& run : result.runs) {
    INFO(label(run));
    REQUIRE(run.done());
    const bool frozen = run.integrator == "frozen";
    CHECK(run.error.position == Approx(frozen ? 20.0 : 0.0).margin(1e-10));
    CHECK(run.error.velocity == Approx(frozen ? 20.0 : 0.0).margin(1e-10));
    CHECK(run.error.energy == Approx(0.0).margin(1e-9));  // at rest at the start: the frozen stone keeps its energy too
  }
  CHECK(result.runs.front().setting == Approx(0.5));
  CHECK(result.runs.back().setting == Approx(0.125));
}

TEST_CASE("finer settings err less and cost more evaluations", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5"), choice<Rk4>("rk4")};
  options.steps = {4, 16};
  options.formulations = {Formulation::omega, Formulation::quaternion};
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  REQUIRE(result.runs.size() == 8);
  CHECK(result.agreement.position < 1e-9);
  for (std::size_t i = 0; i < 4; ++i) {
    const WorkPrecisionRun &coarse = result.runs[i], &fine = result.runs[i + 4];
    INFO(label(coarse) << " and " << label(fine));
    CHECK(label(coarse).substr(0, 4) == label(fine).substr(0, 4));
    CHECK(fine.error.position < 0.1 * coarse.error.position);
    CHECK(fine.evaluations > coarse.evaluations);
  }
  // rk4: error falls with the fourth power of the step, 256 times
  CHECK(result.runs[2].error.position / result.runs[6].error.position == Approx(256.0).epsilon(0.5));
  const WorkPrecisionRun* best = cheapest(result, 1e-5);
  REQUIRE(best != nullptr);
  CHECK(best->error.position <= 1e-5);
  CHECK(cheapest(result, 1e-30) == nullptr);
}

TEST_CASE("a failure is a result with its reason", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {{"frozen", [] { return std::make_unique<Frozen>(0.3); }}};
  const WorkPrecision result = work_precision({.make = falling, .length = 2.0, .outputs = 4}, options);
  REQUIRE(result.runs.size() == 2);
  CHECK(result.runs[0].done());
  CHECK(result.runs[1].failure == "frozen: too cold");

  const std::string file = std::string(paths::kBuild) + "/work_precision_test.csv";
  write_runs(file, result);
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  CHECK(text.find("position error [m]") != std::string::npos);
  CHECK(text.find("frozen,omega,project,sparse,,0.125,,,,") != std::string::npos);
  CHECK(text.find("\"frozen: too cold\"") != std::string::npos);

  const ChartSpec chart = work_precision_chart(result, "two runs", ChartBy::integrator);
  REQUIRE(chart.panels.size() == 1);
  const auto& series = chart.panels[0].series;
  REQUIRE(series.size() >= 2);
  CHECK(series[0].label == "frozen");
  CHECK(series[0].x.size() == 1);
  CHECK(series[1].label == "failed");
}

TEST_CASE("runs that the budget does not reach are named", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4")};
  options.steps = {1, 1 << 18};  // a quarter of a million steps an output: far more than the share of a small budget
  options.budget = 2;
  options.reference_tolerance = 1e-9;
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 50}, options);
  const bool named = !result.left_out.empty();
  const bool given_up = result.runs.size() == 2 && result.runs[1].failure.find("given up") == 0;
  CHECK((named || given_up));
}

TEST_CASE("a reference that cannot be made is an error", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4")};
  options.reference = {"frozen", [] { return std::make_unique<Frozen>(1e9, true); }};
  CHECK_THROWS_AS(work_precision({.make = falling, .length = 1.0}, options), StepError);
  CHECK_THROWS_AS(work_precision({.make = falling, .length = 0.0}, options), ModelError);
}

}  // namespace lockstep
