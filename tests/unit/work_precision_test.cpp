// SPDX-License-Identifier: BSD-3-Clause
// Work against precision on a mechanism whose motion is known, with an integrator that lies and one that fails.
#include "framework/tools/precision/work_precision_chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace lockstep {
namespace {

/// A body that falls freely: x = v t + g t^2 / 2, which methods of order 2 and higher meet exactly; and a rod on a
/// hinge.
Subject falling() {
  auto sys = std::make_shared<System>(System::Options{Vec3(0, 0, -10)});
  sys->add_body("stone", shapes::sphere(1.0, 0.1));
  sys->setup();
  return {sys, sys.get(), sys->start()};
}
Subject swinging() {
  auto sys = std::make_shared<System>(System::Options{Vec3(0, -9.81, 0)});
  Body& bar = sys->add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  sys->add<Revolute>("hinge", bar, sys->ground(), pose_at({0, 0, 0}));
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
  options.solvers = {{"sparse", [] { return std::make_unique<SparseSolver>(); }}};
  options.formulations = {Formulation::omega};
  options.stabilizations = {Stabilization::Kind::project};
  options.references = {choice<Dop853>("dop853"), choice<Dopri5>("dopri5")};
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
  for (std::size_t i = 0; i < 8; i += 2) {  // combination after combination, coarse before fine
    const WorkPrecisionRun &coarse = result.runs[i], &fine = result.runs[i + 1];
    INFO(label(coarse) << " and " << label(fine));
    CHECK(same_way(coarse, fine));
    CHECK(fine.setting < coarse.setting);
    CHECK(fine.error.position < 0.1 * coarse.error.position);
    CHECK(fine.error.reaction < 0.1 * coarse.error.reaction);
    CHECK(fine.evaluations > coarse.evaluations);
    // rk4: error falls with the fourth power of the step, 256 times
    if (coarse.integrator == "rk4") CHECK(coarse.error.position / fine.error.position == Approx(256.0).epsilon(0.5));
  }
  const std::vector<CostAtError> costs = costs_at_error(result, 1e-5);
  REQUIRE_FALSE(costs.empty());
  CHECK(costs.front().run->error.position <= 1e-5);
  CHECK(costs_at_error(result, 1e-30).empty());
}

TEST_CASE("the load of the joints is the reaction of the hinge", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5")};
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 200}, options);
  // A rod let go level from its hinge: 3/2 m g sin(a) below, and 10/4 m g hanging down, in the line of the rod, which
  // it passes after 0.61 s.
  CHECK(result.size.reaction == Approx(2.5 * 9.81).epsilon(1e-3));
  CHECK(result.size.energy == Approx(0.5 * 9.81).epsilon(1e-3));  // all of it kinetic below
}

TEST_CASE("looking costs a run nothing", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4")};
  options.steps = {3};
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 10}, options);
  REQUIRE(result.runs.size() == 1);
  CHECK(result.runs.front().steps == 30);
  CHECK(result.runs.front().evaluations == 4 * 30);
}

TEST_CASE("a failure is a result with its reason", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {{"frozen", [] { return std::make_unique<Frozen>(0.3); }}};
  const WorkPrecision result = work_precision({.make = falling, .length = 2.0, .outputs = 4}, options);
  REQUIRE(result.runs.size() == 2);
  CHECK(result.runs[0].done());
  CHECK(result.runs[1].failure == "frozen: too cold");

  const std::string text = runs_text(result);
  CHECK(text.find("position error [m]") != std::string::npos);
  CHECK(text.find("reaction error [N]") != std::string::npos);
  CHECK(text.find("frozen,omega,project,sparse,,0.125,,,,,") != std::string::npos);
  CHECK(text.find(",frozen: too cold\n") != std::string::npos);

  const GridSpec chart = integrators_chart(result, "two runs", result.runs.front(), CostKind::evaluations);
  REQUIRE_FALSE(chart.panels.empty());
  const GridPanel& panel = chart.panels.front();
  std::size_t n_crosses = 0;
  for (const Series& series : panel.series)
    if (series.style == SeriesStyle::crosses) {
      ++n_crosses;
      CHECK(series.label == "frozen");
      REQUIRE(series.y.size() == 1);
      CHECK(series.y[0] > panel.strip_from);
      CHECK(series.y[0] < panel.y_range.second);
    }
  CHECK(n_crosses == 1);
  const auto rings = std::ranges::find(panel.series, SeriesStyle::rings, &Series::style);
  REQUIRE(rings != panel.series.end());
  CHECK(rings->y == std::vector{panel.series[rings - panel.series.begin() - 1].y.front()});  // a finer run failed
  CHECK(panel.strip_from > 20.0);  // above the error of the run that ended
  WorkPrecision far = result;
  far.runs.push_back(far.runs[0]), far.runs.back().error.position = 1e9;  // off the scale, not failed
  const GridPanel strip = integrators_chart(far, "far", far.runs.front(), CostKind::evaluations).panels.front();
  CHECK(std::ranges::any_of(strip.series, [&](const Series& s) {
    return s.style == SeriesStyle::rings && s.label == "frozen" && s.y.front() > strip.strip_from;
  }));
  CHECK(runs_text(result).find("frozen: too cold") != std::string::npos);
}

TEST_CASE("methods that a mechanism does not support are left out with the reason", "[unit][work_precision]") {
  class Unsuited final : public Integrator {
   public:
    IntegratorInfo info() const override { return {"unsuited", 1, false, false, 1}; }
    void begin(Dynamics&, const State&) override { throw ModelError("unsuited: only for clocks"); }
    StepReport step(Dynamics&, State&, double) override { return {}; }
  };
  WorkPrecisionOptions options = quick_options();
  options.integrators = {{"unsuited", [] { return std::make_unique<Unsuited>(); }}, choice<Rk4>("rk4")};
  const WorkPrecision result = work_precision({.make = falling, .length = 1.0, .outputs = 2}, options);
  REQUIRE(result.unsuited.size() == 1);
  CHECK(result.unsuited[0].what.find("unsuited, omega") == 0);
  CHECK(result.unsuited[0].why == "unsuited: only for clocks");
  for (const WorkPrecisionRun& run : result.runs) CHECK(run.integrator == "rk4");
}

TEST_CASE("a key without effect does not make a separate method", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5"), choice<Dopri5>("dopri5:key=other"), choice<Dop853>("dop853")};
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  CHECK(result.runs.size() == 4);
  for (const WorkPrecisionRun& run : result.runs) CHECK(run.integrator != "dopri5:key=other");
  CHECK(result.left_out.empty());
  std::swap(options.integrators[0], options.integrators[1]);  // the shorter name is kept, though it runs later
  const WorkPrecision swapped = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  CHECK(swapped.runs.size() == 4);
  for (const WorkPrecisionRun& run : swapped.runs) CHECK(run.integrator != "dopri5:key=other");
}

TEST_CASE("the method with fewer changes comes first, and a key is a change", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4"), choice<Dopri5>("dopri5:key=other"), choice<Dop853>("dop853")};
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  CHECK(values_of(result, ChartBy::integrator) == std::vector<std::string>{"rk4", "dop853", "dopri5:key=other"});
}

TEST_CASE("a picture lists all methods of the Pareto front, in lines", "[unit][work_precision]") {
  WorkPrecision result;
  for (int k = 0; k < 12; ++k) {
    WorkPrecisionRun run;
    run.integrator = "a_method_with_a_long_name:key=" + std::to_string(k), run.solver = "sparse";
    run.error.position = std::pow(0.1, k), run.cpu = k + 1, run.setting = 1;
    result.runs.push_back(run);
  }
  const GridSpec chart = integrators_chart(result, "many", result.runs.front(), CostKind::cpu);
  std::string all;
  for (const std::string& line : chart.remarks) {
    CHECK(line.size() <= 250);
    all += line;
  }
  for (const WorkPrecisionRun& run : result.runs) CHECK(all.find(run.integrator + ", omega") != std::string::npos);
}

TEST_CASE("one dimension at a time keeps the others at the base", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5"), choice<Rk4>("rk4")};
  options.formulations = {Formulation::omega, Formulation::quaternion};
  options.stabilizations = {Stabilization::Kind::project, Stabilization::Kind::none};
  options.tolerances = {1e-4}, options.steps = {4};
  const auto n_runs = [&] {
    return work_precision({.make = swinging, .length = 0.5, .outputs = 5}, options).runs.size();
  };
  CHECK(n_runs() == 8);
  options.separately = true;
  CHECK(n_runs() == 4);
}

TEST_CASE("joint coordinates run once for all solvers, and with loops for each stabilisation",
          "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5")};
  options.stabilizations = {Stabilization::Kind::project, Stabilization::Kind::none};
  options.solvers.push_back({"dense", [] { return std::make_unique<DenseSolver>(); }});
  options.tolerances = {1e-4};
  const auto n_runs = [&](Formulation formulation, bool loops) {
    options.formulations = {formulation}, options.loops = loops;
    return work_precision({.make = swinging, .length = 0.5, .outputs = 5}, options).runs.size();
  };
  CHECK(n_runs(Formulation::omega, false) == 4);
  for (const Formulation formulation : {Formulation::joint, Formulation::automatic}) {
    CHECK(n_runs(formulation, false) == 1);
    CHECK(n_runs(formulation, true) == 2);
  }
}

TEST_CASE("a formulation that the base's solver does not take is drawn with another", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5")};
  options.formulations = {Formulation::omega, Formulation::quaternion};
  options.solvers.insert(options.solvers.begin(), {"schur", [] { return std::make_unique<SchurSolver>(); }});
  const WorkPrecision result = work_precision({.make = swinging, .length = 0.5, .outputs = 5}, options);
  WorkPrecisionRun base;
  base.integrator = "dopri5", base.solver = "schur";
  base.formulation = Formulation::omega, base.stabilization = Stabilization::Kind::project;
  const GridSpec chart = forms_chart(result, "forms", base, ChartBy::formulation, {"dopri5"});
  REQUIRE(!chart.panels.empty());
  for (const char* name : {"omega", "quaternion"}) {
    CAPTURE(name);
    CHECK(std::ranges::any_of(chart.panels.front().series, [&](const Series& s) { return s.label == name; }));
  }
  REQUIRE(!chart.remarks.empty());
  CHECK(chart.remarks.front() == "curves: stabilisation project, solver schur; quaternion: sparse");
  WorkPrecision own = result;
  for (WorkPrecisionRun& run : own.runs)
    if (run.formulation == Formulation::omega) run.formulation = Formulation::automatic;
  base.formulation = Formulation::automatic;
  const GridSpec by_itself = forms_chart(own, "forms", base, ChartBy::formulation, {"dopri5"});
  REQUIRE(!by_itself.panels.empty());
  CHECK(
      std::ranges::any_of(by_itself.panels.front().series, [](const Series& s) { return s.label == "auto = omega"; }));
  base.formulation = Formulation::omega;
  for (const char* solver : {"schur", "sparse"}) {  // the first runs as auto, the other as omega
    CAPTURE(solver);
    WorkPrecision mixed = result;
    for (WorkPrecisionRun& run : mixed.runs)
      if (run.formulation == Formulation::omega && run.solver == "schur") run.formulation = Formulation::automatic;
    const GridSpec solvers = forms_chart(mixed, "solvers", base, ChartBy::solver, {"dopri5"});
    REQUIRE(!solvers.panels.empty());
    CHECK(std::ranges::any_of(solvers.panels.front().series, [&](const Series& s) { return s.label == solver; }));
  }
  base.stabilization = Stabilization::Kind::none;  // of which there are no runs: no curves, and no panels
  CHECK(integrators_chart(result, "none", base, CostKind::cpu).panels.empty());
}

// A clock that counts steps: 1 ms each. What the budget allows is then known without asking the machine.
TEST_CASE("the budget is kept by work", "[unit][work_precision]") {
  struct Ticking final : public Integrator {
    explicit Ticking(long* count) : n(count) {}
    IntegratorInfo info() const override { return {"ticking", 1, false, false, 1}; }
    void begin(Dynamics&, const State&) override {}
    StepReport step(Dynamics& dynamics, State& state, double h) override {
      ++*n;
      dynamics.rate(state, rate);
      state.v += h * rate.v;
      dynamics.advance(state, h, state.v);
      state.t += h;
      StepReport report;
      report.h = h;
      return report;
    }
    long* n;
    StateRate rate{};
  };
  long n_steps = 0;
  WorkPrecisionOptions options = quick_options();
  options.integrators = {{"ticking", [&] { return std::make_unique<Ticking>(&n_steps); }}};
  options.formulations = {Formulation::omega, Formulation::quaternion};
  options.steps = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384};
  options.clock = options.cpu = [&] { return 1e-3 * static_cast<double>(n_steps); };
  options.reference_tolerance = 1e-9;
  for (const double budget : {0.2, 2.0, 10.0}) {
    n_steps = 0;
    options.budget = budget;
    const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 10}, options);
    INFO(budget << " s: " << n_steps << " steps");
    CHECK(1e-3 * static_cast<double>(n_steps) <= budget + 2e-3);
    CHECK(1e-3 * static_cast<double>(n_steps) >= 0.4 * budget);
    CHECK(result.left_out.size() == 2);
    CHECK(result.open.size() == 2);
    long finest = 0;
    for (const WorkPrecisionRun& run : result.runs) {
      CHECK(run.done());
      finest = std::max(finest, run.steps);
    }
    CHECK(finest >= 100 * budget);
  }
}

// A method that is a hundred times as dear as the others, of which there are many forms: it has its first hits before
// their forms are tried, and only half of the budget goes into that.
TEST_CASE("every integrator has its first results before variants are measured", "[unit][work_precision]") {
  long n_steps = 0;
  struct Dear final : public Integrator {
    Dear(long* n, long cost) : n_(n), cost_(cost) {}
    IntegratorInfo info() const override { return method_.info(); }
    void begin(Dynamics& dynamics, const State& state) override { method_.begin(dynamics, state); }
    StepReport step(Dynamics& dynamics, State& state, double h) override {
      *n_ += cost_;
      return method_.step(dynamics, state, h);
    }
    Rk4 method_;
    long *n_, cost_;
  };
  WorkPrecisionOptions options = quick_options();
  options.integrators = {{"cheap", [&] { return std::make_unique<Dear>(&n_steps, 1); }},
                         {"dear", [&] { return std::make_unique<Dear>(&n_steps, 100); }}};
  options.formulations = {Formulation::omega, Formulation::quaternion};
  options.stabilizations = {Stabilization::Kind::project, Stabilization::Kind::baumgarte, Stabilization::Kind::none};
  options.steps = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384};
  options.clock = options.cpu = [&] { return 1e-3 * static_cast<double>(n_steps); };
  options.reference_tolerance = 1e-9;
  options.budget = 20;
  std::vector<std::string> order;
  options.measured = [&](const WorkPrecisionRun& run) {
    order.push_back(run.integrator +
                    (run.formulation == Formulation::omega && run.stabilization == Stabilization::Kind::project
                         ? ""
                         : ", another form"));
  };
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 10}, options);
  const auto hit = [&](const WorkPrecisionRun& run) {
    return run.integrator == "dear" && run.done() && run.error.position < 1e-3 * result.size.position;
  };
  CHECK(std::any_of(result.runs.begin(), result.runs.end(), hit));
  const auto other = std::find_if(order.begin(), order.end(), [](const auto& o) { return o.ends_with("form"); });
  CHECK(std::count(order.begin(), other, "dear") >= 1);
  CHECK(other != order.end());
  CHECK(1e-3 * static_cast<double>(n_steps) <= options.budget + 0.2);

  options.target = 1e-4;
  n_steps = 0, order.clear();
  work_precision({.make = swinging, .length = 1.0, .outputs = 10}, options);
  const auto second = std::find_if(order.begin(), order.end(), [](const auto& o) { return o.ends_with("form"); });
  CHECK(std::count(order.begin(), second, "cheap") >= 2);  // until it was met and confirmed
  CHECK(std::count(second, order.end(), "cheap") == 0);
}

TEST_CASE("a combination that cannot win any more ends", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Dopri5>("dopri5"), choice<Rk4>("rk4")};
  options.tolerances = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10};
  options.steps = {1, 4, 16, 64, 256, 1024};
  options.target = 1e-4;
  const WorkPrecision result = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  int n_met = 0;
  for (const WorkPrecisionRun& run : result.runs)
    if (run.integrator == "dopri5") n_met += run.error.position <= options.target ? 1 : 0;
  CHECK(n_met == 2);  // the one that met it and the finer one that confirmed it
  REQUIRE_FALSE(costs_at_error(result, options.target).empty());
  CHECK(costs_at_error(result, options.target).front().confirmed);
}

TEST_CASE("a reference that cannot be made is an error", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4")};
  options.references = {{"frozen", [] { return std::make_unique<Frozen>(1e9, true); }}};
  testing::check_words(
      testing::message_of<StepError>([&] { work_precision({.make = falling, .length = 1.0}, options); }),
      {"no reference solution could be computed", "--budget"});
  testing::check_words(
      testing::message_of<ModelError>([&] { work_precision({.make = falling, .length = 0.0}, options); }),
      {"a chart of 0 s", "a length > 0"});
}

TEST_CASE("if one reference fails the next is used", "[unit][work_precision]") {
  WorkPrecisionOptions options = quick_options();
  options.integrators = {choice<Rk4>("rk4")};
  options.references.insert(options.references.begin(), {"frozen", [] { return std::make_unique<Frozen>(1e9, true); }});
  const WorkPrecision two = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  CHECK(two.reference == "dop853 at 1e-13");
  CHECK(two.second == "dopri5 at 1e-13");
  options.references = {choice<Dop853>("dop853")};
  const WorkPrecision one = work_precision({.make = swinging, .length = 1.0, .outputs = 5}, options);
  CHECK(one.second == "dop853 at 1e-11");
  CHECK(one.agreement.position < 1e-8);
}

}  // namespace lockstep
