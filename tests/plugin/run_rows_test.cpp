// What a run of the program keeps of its rows, and what of them a picture shows.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <lockstep/integrators.h>
#include <lockstep/solvers.h>
#include "framework/tools/program/run_rows.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace run_rows_test {

using namespace lockstep;

namespace {

Table table_of(long n) {
  Table table;
  table.add_column("t", "s"), table.add_column("x", "m"), table.add_column("spike");
  for (long i = 0; i < n; ++i) {
    const double t = 0.001 * static_cast<double>(i);
    const double row[] = {t, std::sin(40 * t) * t, i == 777 ? 5.0 : i == 3001 ? -3.0 : 0.0};
    table.add_row(row);
  }
  return table;
}

}  // namespace

TEST_CASE("rows of a long run are not kept in memory", "[runner]") {
  System system(System::Options{{0, 0, -10}});
  system.add_particle("stone", 1, {0, 0, 2});
  Recorder recorder(system, {"stone.x", "stone.z"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 1e-4});
  const std::string name = std::string(paths::kBuild) + "/output/run_rows.csv";
  std::filesystem::create_directories(std::filesystem::path(name).parent_path());
  GrowingFile file(name);
  RunRows rows(file, recorder, false);
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
  const SweepRun ranges = rows.rows().ranges(), read = recorded_run(all);
  CHECK(ranges.t == all.last("t"));
  REQUIRE(ranges.columns.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(ranges.columns[k].last == read.columns[k].last);
    CHECK(ranges.columns[k].least == read.columns[k].least);
    CHECK(ranges.columns[k].most == read.columns[k].most);
  }
  CHECK(ranges.columns[1].last == Approx(2 - 5.0 * 16).epsilon(1e-9));
  std::filesystem::remove(name);
}

TEST_CASE("an envelope of rows shows all of few rows, and the extremes of many", "[runner]") {
  constexpr std::size_t kMost = 64;
  for (const long n : {1L, 63L, 64L, 65L, 200L, 4000L, 4001L}) {
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
    if (n != 4000) continue;
    for (const char* column : {"x", "spike"}) {  // every extreme of the whole is there, the open group's apart
      CHECK(std::ranges::max(kept[column]) == std::ranges::max(all[column]));
      CHECK(std::ranges::min(kept[column]) == std::ranges::min(all[column]));
    }
    // The curve stays between the extremes of its neighbourhood: x near an instant is near what it was there.
    const double width = 2 * all.last("t") / static_cast<double>(kMost / 4);
    for (std::size_t i = 0; i < kept.n_rows(); ++i) CHECK(std::abs(kept["x"][i]) <= kept["t"][i] + 2 * width);
  }
}

TEST_CASE("an envelope of rows goes on from what it saved", "[runner]") {
  const Table all = table_of(1000);
  RowEnvelope whole(all, 64), first(all, 64), rest(all, 64);
  for (std::size_t i = 0; i < 1000; ++i) whole.add(all, i);
  for (std::size_t i = 0; i < 519; ++i) first.add(all, i);
  Snapshot saved;
  first.save(saved);
  rest.load(saved);
  CHECK(saved.at_end());
  for (std::size_t i = 519; i < 1000; ++i) rest.add(all, i);
  CHECK(rest.n_rows() == 1000);
  const Table a = whole.table(), b = rest.table();
  for (std::size_t k = 0; k < a.n_columns(); ++k) CHECK(a.columns()[k].values == b.columns()[k].values);
  CHECK(whole.ranges().columns[1].least == rest.ranges().columns[1].least);
}

TEST_CASE("a NaN among the rows stays in their range", "[runner]") {
  Table all;
  all.add_column("t", "s"), all.add_column("x");
  for (const double x : {1.0, std::numeric_limits<double>::quiet_NaN(), 2.0}) all.add_row(std::vector<double>{x, x});
  RowEnvelope envelope(all);
  for (std::size_t i = 0; i < 3; ++i) envelope.add(all, i);
  const SweepRun ranges = envelope.ranges();
  CHECK(ranges.columns[0].last == 2);
  CHECK(std::isnan(ranges.columns[0].least));
  CHECK(std::isnan(ranges.columns[0].most));
}

}  // namespace run_rows_test
