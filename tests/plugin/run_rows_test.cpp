// SPDX-License-Identifier: BSD-3-Clause
// What a run of the program keeps of its rows, and what of them a picture shows.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/math.h>
#include <lockstep/solvers.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/detail_rows.h"
#include "framework/tools/program/run_rows.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace run_rows_test {

using namespace lockstep;

namespace {

Table table_of(long n) {
  Table table;
  table.add_column("t", "s"), table.add_column("x", "m"), table.add_column("spike"), table.add_column("end");
  for (long i = 0; i < n; ++i) {
    const double t = 0.001 * static_cast<double>(i);
    const double spike = i == 777 ? 5.0 : i == 3001 ? -3.0 : 0.0;
    const double end = i == n - 3 ? -7.0 : i == n - 2 ? 9.0 : 0.0;  // where a group may not be full
    const double row[] = {t, std::sin(40 * t) * t, spike, end};
    table.add_row(row);
  }
  return table;
}

}  // namespace

TEST_CASE("the table of a long run is not kept in memory", "[runner]") {
  System system(System::Options{{0, 0, -10}});
  system.add_particle("stone", 1, {0, 0, 2});
  Recorder recorder(system, {"stone.x", "stone.z"});
  recorder.find_extremes();
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 1e-4});
  const std::string name = std::string(paths::kBuild) + "/output/run_rows.csv";
  std::filesystem::create_directories(std::filesystem::path(name).parent_path());
  GrowingFile file(name);
  RunRows rows(file, recorder, false, true);
  std::size_t most = 0;
  loop.add_observer(recorder), loop.add_observer(rows);
  loop.progress = [&](const State&) {
    most = std::max(most, recorder.table().n_rows());
    return true;
  };
  loop.run_until(4);
  file.commit();
  CHECK(most <= 1);
  CHECK(recorder.table().n_rows() == 0);
  CHECK(rows.rows().n_rows() == 40001);
  CHECK(rows.rows().table().n_rows() <= RowEnvelope::kMost + 1);
  const Table all = read_csv(name);
  REQUIRE(all.n_rows() == 40001);
  const std::span<const ColumnRange> ranges = recorder.ranges();
  REQUIRE(ranges.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double>& x = all.columns()[k + 1].values;
    CHECK(ranges[k].last == x.back());
    CHECK(ranges[k].least == std::ranges::min(x));
    CHECK(ranges[k].most == std::ranges::max(x));
  }
  CHECK(ranges[1].last == Approx(2 - 5.0 * 16).epsilon(1e-9));
  CHECK(ranges[1].t_most == 0);
  CHECK(ranges[1].t_least == all.last("t"));
  std::filesystem::remove(name);
}

TEST_CASE("an envelope keeps all lines of a short table, and the extremes of a long one", "[runner]") {
  constexpr std::size_t kMost = 64;
  for (const long n : {1L, 63L, 64L, 65L, 66L, 67L, 200L, 202L, 4000L, 4001L, 4030L, 4031L}) {
    INFO(n << " rows");
    const Table all = table_of(n);
    RowEnvelope envelope(all, kMost);
    for (std::size_t i = 0; i < all.n_rows(); ++i) envelope.add(all, i);
    const Table kept = envelope.table();
    CHECK(envelope.n_rows() == n);
    CHECK(kept.n_rows() <= kMost + 1);
    if (n < static_cast<long>(kMost)) {
      for (std::size_t k = 0; k < all.n_columns(); ++k) CHECK(kept.columns()[k].values == all.columns()[k].values);
      continue;
    }
    CHECK(kept.first("t") == all.first("t"));
    CHECK(kept.last("t") == all.last("t"));
    CHECK(std::ranges::is_sorted(kept["t"]));
    for (const char* column : {"x", "spike", "end"}) {  // every extreme of the whole is there
      CHECK(std::ranges::max(kept[column]) == std::ranges::max(all[column]));
      CHECK(std::ranges::min(kept[column]) == std::ranges::min(all[column]));
    }
    // The curve stays between the extremes of its neighbourhood: x near an instant is near what it was there.
    const double width = 2 * all.last("t") / static_cast<double>(kMost / 4);
    for (std::size_t i = 0; i < kept.n_rows(); ++i) CHECK(std::abs(kept["x"][i]) <= kept["t"][i] + 2 * width);
  }
}

// x^2 + y^2 = 1 at every instant: a row of numbers from different instants lies elsewhere.
TEST_CASE("a path is drawn through recorded values of one time each", "[runner]") {
  Table all;
  all.add_column("t", "s"), all.add_column("x", "m"), all.add_column("y", "m");
  const auto angle = [](double t) { return 20 * kPi * t / 1e6; };  // ten turns
  for (const long n : {100L, 16383L, 16384L, 40000L, 1000000L}) {
    INFO(n << " rows");
    RowEnvelope envelope(all);
    for (long i = 0; i < n; ++i) {
      const double t = static_cast<double>(i);
      all.add_row(std::vector<double>{t, std::cos(angle(t)), std::sin(angle(t))});
      envelope.add(all, 0);
      all.clear_rows();
    }
    const Table path = envelope.path_table();
    CHECK(path.n_rows() <= RowEnvelope::kMost + 1);
    CHECK(path.n_rows() >= std::min(static_cast<std::size_t>(n), RowEnvelope::kMost / 2));
    CHECK(path.first("t") == 0);
    CHECK(path.last("t") == static_cast<double>(n - 1));
    double off = 0, gap = 0;
    for (std::size_t i = 0; i < path.n_rows(); ++i) {
      const double t = path["t"][i], x = path["x"][i], y = path["y"][i];
      keep_worst(off, std::abs(x * x + y * y - 1));
      keep_worst(off, std::hypot(x - std::cos(angle(t)), y - std::sin(angle(t))));
      if (i > 0) keep_worst(gap, t - path["t"][i - 1]);
    }
    CHECK(off < 1e-14);
    CHECK(gap == static_cast<double>(envelope.path_every()));
    CHECK(envelope.path_every() == (n < 16384 ? 1 : n < 32768 ? 2 : n < 65536 ? 4 : 64));
  }
}

// One row in 2, 4, 8, ... and the last, each once. Of the envelope, two rows for each full group of 4, 8, ... rows; of the
// open one both extremes and its end, or the one row that it has.
TEST_CASE("thinned values end in the last one, which occurs once", "[runner]") {
  constexpr long kMost = 64;
  Table all;
  all.add_column("t", "s"), all.add_column("x", "m");
  RowEnvelope envelope(all, kMost);
  for (long n = 1; n <= 1100; ++n) {
    CAPTURE(n);
    const double t = static_cast<double>(n - 1);
    all.add_row(std::vector<double>{t, 3 * t - 1});
    envelope.add(all, 0);
    all.clear_rows();
    const Table path = envelope.path_table(), table = envelope.table();
    const long every = envelope.path_every();
    std::vector<double> expected;
    for (long i = 0; i < n; i += every) expected.push_back(static_cast<double>(i));
    if ((n - 1) / every * every != n - 1) expected.push_back(t);
    CHECK(path["t"] == expected);
    CHECK(path.last("x") == 3 * t - 1);
    long group = 4;  // rows of a full one
    while (group * kMost / 4 <= n / 2) group *= 2;
    const long open = n % group;
    const long rows = n < kMost ? n : n / group * 2 + std::min(open, 1L) + (open > 1 ? 2 : 0);
    CHECK(static_cast<long>(table.n_rows()) == rows);
    CHECK(table.last("t") == t);
  }
}

TEST_CASE("an envelope continues from its saved state", "[runner]") {
  const Table all = table_of(1000);
  RowEnvelope whole(all, 64), first(all, 64), rest(all, 64);
  for (std::size_t i = 0; i < 1000; ++i) whole.add(all, i);
  for (std::size_t i = 0; i < 519; ++i) first.add(all, i);
  Snapshot saved;
  first.save(saved);
  SnapshotReader in(saved);
  rest.load(in);
  CHECK(in.at_end());
  for (std::size_t i = 519; i < 1000; ++i) rest.add(all, i);
  CHECK(rest.n_rows() == 1000);
  const Table a = whole.table(), b = rest.table();
  for (std::size_t k = 0; k < a.n_columns(); ++k) CHECK(a.columns()[k].values == b.columns()[k].values);
  const Table c = whole.path_table(), d = rest.path_table();
  CHECK(whole.path_every() == 16);
  for (std::size_t k = 0; k < c.n_columns(); ++k) CHECK(c.columns()[k].values == d.columns()[k].values);
}

namespace {

struct Ended {
  State state;
  SimulationReport report;
  WorkCount work;
  std::string error;
  long beside = 0;  // rows that only the picture has
};

// With a recorded reaction, which takes a solution at every row.
Ended ended(const Scene& scene, const std::string& reaction, bool pictures) {
  const Registry registry = builtin_registry();
  Mechanism m = build_mechanism(scene, registry);
  m.run.record.push_back({reaction, "reaction", {}});
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  const std::string name = std::string(paths::kBuild) + "/output/ended.csv";
  std::filesystem::create_directories(std::filesystem::path(name).parent_path());
  GrowingFile file(name);
  RunRows rows(file, *recorder, false, true);
  std::optional<PictureRows> more;
  if (pictures) more.emplace(make_recorder(m), *recorder, m.run.until / 300);
  std::vector<Event> events = make_events(m, *recorder);
  Dynamics dynamics = make_dynamics(m, registry);
  StepLoop loop(dynamics, make_integrator(m.run, registry), loop_options(m.run));
  loop.add_observer(*recorder), loop.add_observer(rows);
  if (more) loop.add_observer(*more);
  for (Event& event : events) loop.add_event(std::move(event));
  Ended end;
  try {
    loop.set_state(assembled_start(dynamics, m));
    loop.run_until(m.run.until);
  } catch (const Error& error) {
    end.error = error.what();
  }
  file.commit();
  std::filesystem::remove(name);
  end.state = loop.state(), end.report = loop.report(), end.work = dynamics.work();
  const Table main = rows.rows().table();
  if (more) end.beside = static_cast<long>(more->together(main).n_rows()) - static_cast<long>(main.n_rows());
  return end;
}

}  // namespace

TEST_CASE("a run does not depend on whether a picture is drawn of it", "[runner]") {
  struct Case {
    std::string file, reaction;
  };
  const std::string folder = std::string(paths::kSource) + "/tests/verification/scenes/";
  const Case cases[] = {{scene_path("overconstrained/three_balls"), "b1.force_on_p_world_z"},
                        {folder + "parallelogram.json", "B.force_on_p_world_x"},
                        {scene_path("four_bar"), "B.force_on_p_world_x"},
                        {scene_path("bouncing_pendulum"), ""}};
  long ran = 0;
  for (const auto& [path, reaction] : cases)
    for (const char* integrator : {"", "dop853", "dopri5", "radau5", "rk4", "rattle2"}) {
      INFO(path << " " << integrator);
      Scene scene = read_scene(path);
      if (*integrator != '\0') scene.run.integrator = {integrator};
      if (integrator == std::string("rk4") || integrator == std::string("rattle2"))
        scene.run.step = scene.run.until / 200;
      scene.run.output = scene.run.until / 10;
      const std::string column = reaction.empty() ? "energy.total" : reaction;
      const Ended with = ended(scene, column, true), without = ended(scene, column, false);
      CHECK(with.error == without.error);
      if (with.error.empty()) ++ran;
      if (with.error.empty()) CHECK(with.beside > 0);
      CHECK(with.state.t == without.state.t);
      CHECK((with.state.q == without.state.q));
      CHECK((with.state.v == without.state.v));
      CHECK((with.state.s == without.state.s));
      CHECK(with.report.steps == without.report.steps);
      CHECK(with.report.rejected == without.report.rejected);
      CHECK(with.report.manifold_steps == without.report.manifold_steps);
      CHECK(with.work.evaluations == without.work.evaluations);
      CHECK(with.work.factors == without.work.factors);
      CHECK(with.work.projections == without.work.projections);
      CHECK(with.work.corrections == without.work.corrections);
    }
  CHECK(ran >= 16);
}

}  // namespace run_rows_test
