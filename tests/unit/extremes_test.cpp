// SPDX-License-Identifier: BSD-3-Clause
// Extremes of columns between rows: against closed forms, and against the same motion looked at very often.
#include "framework/tools/record/extremes.h"

#include <array>
#include <cmath>
#include <limits>

#include <lockstep/author/registry.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solid.h>
#include <lockstep/sweep.h>
#include "tests/support/catch.h"

namespace extremes_test {

using namespace lockstep;

namespace {

Table columns_of(const std::vector<std::string>& names) {
  Table table;
  table.add_column("t", "s");
  for (const std::string& name : names) table.add_column(name);
  return table;
}

// The extremes of f, which is seen in steps of h; `looks` counts what is computed inside of them.
template <class F>
ColumnRange range_of(const F& f, double until, double h, bool inside, int& looks) {
  Extremes extremes;
  const Table table = columns_of({"f"});
  extremes.begin(table.columns());
  const double start[] = {f(0.0)};
  extremes.begin_part(0, start);
  looks = 0;
  const Extremes::Look look = [&](double t, Extremes::Numbers, std::span<double> values) {
    ++looks, values[0] = f(t);
    return true;
  };
  for (double t = 0; t < until;) {
    t = std::min(t + h * (1 + 0.3 * std::sin(17 * t)), until);  // steps of different lengths
    const double values[] = {f(t)};
    extremes.add_step(t, values, 1, inside ? look : Extremes::Look());
  }
  return extremes.ranges()[0];
}

}  // namespace

TEST_CASE("extremes between steps are those of the curve, with few looks", "[unit][record]") {
  const auto wave = [](double t) { return 3 + 2 * std::sin(1.3 * t + 0.2); };
  for (const double h : {0.1, 0.4, 0.8}) {
    int looks = 0;
    const ColumnRange r = range_of(wave, 20, h, true, looks);
    INFO(h << ": " << looks << " looks");
    CHECK(r.most == Approx(5).margin(4e-5));
    CHECK(r.least == Approx(1).margin(4e-5));
    CHECK(wave(r.t_most) == r.most);
    CHECK(r.resolved);
    CHECK(looks < 12 / h);
  }
  int looks = 0;
  const auto peak = [](double t) { return std::exp(-20 * (t - 3.03) * (t - 3.03)) - 0.1 * t; };
  const ColumnRange narrow = range_of(peak, 6, 0.12, true, looks);
  double most = -1;
  for (int i = 0; i < 1'000'000; ++i) most = std::max(most, peak(6e-6 * i));
  CHECK(narrow.most == Approx(most).margin(2e-5));
}

TEST_CASE("a curve that oscillates within steps is reported as unresolved", "[unit][record]") {
  int looks = 0;
  const ColumnRange fast = range_of([](double t) { return std::sin(400 * t); }, 20, 0.3, true, looks);
  CHECK_FALSE(fast.resolved);
  CHECK(looks < 400);
}

TEST_CASE("without states inside steps the parabola through their ends is the extreme", "[unit][record]") {
  int looks = 0;
  const auto wave = [](double t) { return 2 * std::sin(1.3 * t + 0.2); };
  const ColumnRange r = range_of(wave, 20, 0.1, false, looks);
  CHECK(looks == 0);
  CHECK(r.most == Approx(2).margin(4e-4));
  CHECK(r.resolved);
  CHECK_FALSE(range_of(wave, 20, 0.9, false, looks).resolved);
}

TEST_CASE("a column that holds a NaN has no range, wherever the NaN is", "[unit][record]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Table table = columns_of({"x", "whole"});
  for (std::size_t where = 0; where < 4; ++where) {
    Extremes extremes;
    extremes.begin(table.columns());
    for (std::size_t i = 0; i < 4; ++i) {
      const double x = std::array{3.0, -2.0, 7.0, 5.0}[i], row[] = {0.1 * double(i), i == where ? nan : x, x};
      extremes.take_row(row);
    }
    const ColumnRange holed = extremes.ranges()[0], whole = extremes.ranges()[1];
    CHECK((std::isnan(holed.least) && std::isnan(holed.most)));
    CHECK(std::isnan(holed.last) == (where == 3));
    CHECK((whole.last == 5 && whole.least == -2 && whole.most == 7));
    CHECK(whole.t_most == 0.2);
  }
}

TEST_CASE("extremes of a run are those of its motion, for few outputs and any method", "[unit][record]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  const double I_zz = rod.mass.J(2, 2) + 0.25;            // about the hinge
  const double most = 9.81 * (1 + 0.5 * 2 * 0.5 / I_zz);  // m g + m w^2 l/2, w^2 = m g l / I at the bottom
  for (const char* method : {"dopri5", "dop853", "rk4", "radau5", "generalized_alpha"}) {
    INFO(method);
    Simulation run(
        system,
        {.integrator = method, .tolerance = 1e-8, .step = std::string(method) == "dopri5" ? 0 : 0.01, .output = 0.7});
    run.record({"A.rz", "A.force_on_p_world_y", {"F", "=norm(A.force_on_p_world)"}});
    run.recorder().find_extremes();
    run.run_until(3);
    const std::span<const ColumnRange> ranges = run.recorder().ranges();
    REQUIRE(ranges.size() == 3);
    const double part = std::string(method) == "generalized_alpha" ? 2e-3 : 1e-4;  // of its own error
    CHECK(ranges[0].least == Approx(-kPi).margin(part * kPi));
    CHECK(ranges[1].most == Approx(most).margin(part * most));
    CHECK(ranges[2].most == Approx(most).margin(part * most));
  }
}

TEST_CASE("extremes of a prescribed motion are found however long its steps are", "[unit][record]") {
  const Scene scene = scene_from_text(R"~({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0],
                "drive": {"axis": "rz", "law": {"type": "formula", "y": "=0.3*sin(2*pi*10*t)"
}
}
}],
    "run": {"until": 1, "output": 0.05, "record": [{"M": "A.drive.torque_on_p_link_z"}]}
})~",
                                      "arm.json");
  const Registry registry = builtin_registry();
  const Mechanism m = build_mechanism(scene, registry);
  const double I_zz = m.system.bodies()[1].mass.J(2, 2) + 0.25, w = 20 * kPi;
  double least = 0, most = 0;  // M = I y'' + m g l/2 cos y
  for (int i = 0; i < 1'000'000; ++i) {
    const double y = 0.3 * std::sin(w * 1e-6 * i), M = -w * w * I_zz * y + 0.5 * 9.81 * std::cos(y);
    least = std::min(least, M), most = std::max(most, M);
  }
  const SweepRun run = sweep_run(scene, registry, recorded_columns(scene, registry));
  REQUIRE(run.columns.size() == 1);
  CHECK(run.columns[0].most == Approx(most).margin(1e-4 * (most - least)));
  CHECK(run.columns[0].least == Approx(least).margin(1e-4 * (most - least)));
  CHECK(run.columns[0].last == Approx(0.5 * 9.81).epsilon(1e-6));
  CHECK(run.columns[0].resolved);
}

TEST_CASE("a pulse of a run along laws is found between outputs", "[unit][record]") {
  const auto pulse = [](double t) { return 0.01 * std::exp(-std::pow((t - 0.537) / 0.004, 2)); };
  const Scene scene =
      scene_from_text(R"~({"lockstep": 1, "gravity": [0, 0, 0], "bodies": [{"name": "b", "particle": 2}],
    "joints": [{"name": "A", "type": "lock", "mask": "y z", "p": "b", "s": "ground", "at": [0, 0, 0], "drive":
      {"axis": "x", "law": {"type": "formula", "y": "=0.01*exp(-((t-0.537)/0.004)^2)"}}}],
    "run": {"until": 1, "output": 0.1, "record": ["b.x", {"F": "A.drive.force_on_p_link_x"}]}})~",
                      "pulse.json");
  const SweepRun run = sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()));
  CHECK(run.columns[0].most == Approx(pulse(0.537)).epsilon(1e-3));
  CHECK(run.columns[1].least == Approx(-2 * 2 * 0.01 / (0.004 * 0.004)).epsilon(1e-3));  // m x'' at the peak
}

}  // namespace extremes_test
