// SPDX-License-Identifier: BSD-3-Clause
// Pages of many runs, and of modes: what they hold, against the runs themselves.
#include <lockstep/report.h>

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/report/histories.h"
#include "framework/tools/report/modes_page.h"
#include "framework/tools/sweep/watched_run.h"
#include "tests/support/catch.h"
#include "tests/support/report_page.h"

namespace report_runs_test {

using namespace lockstep;
using namespace lockstep::report_page;

TEST_CASE("a page of many runs holds their table as it is", "[report]") {
  const std::string csv = "run,mass [kg],x final [m],status\n1,0.5,</script>,\"failed: \"\"a\"\", b\"\n";
  const std::string page = report::points_page(
      {.text = {.title = "<masses>"}, .csv = csv, .x = "mass [kg]", .y = "x final [m]", .log = true});
  const Json data = Json::parse(element(page, "data"));
  CHECK(data["kind"] == "points");
  CHECK(data["csv"] == csv);
  CHECK(data["text"]["title"] == "<masses>");
  CHECK(data["x"] == "mass [kg]");
  CHECK(data["log"] == true);
  CHECK(page.find("<title>&lt;masses>") != std::string::npos);
}

const char* const kSwinging = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
  "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
  "run": {"until": 0.5, "output": 0.005, "integrator": "dop853", "tolerance": 1e-9, "record": ["rod.x", "rod.y"]}})";

TEST_CASE("a page of many runs keeps their histories and their motion", "[report]") {
  const Scene scene = scene_from_text(kSwinging, "swinging.json");
  const Registry registry = builtin_registry();
  const Table columns = recorded_columns(scene, registry);
  report::Histories kept(3);
  std::vector<Table> tables(3);
  for (const long run : {3L, 1L}) {
    CHECK(kept.keeps(run));
    const std::unique_ptr<report::Frames> seen = kept.watcher();
    const SweepRun done =
        watched_run(scene, registry, columns, {}, &tables[run - 1],
                    {seen.get(), [&](const Mechanism& m, const Table& table) { kept.add(run, table, *seen, m); }});
    CHECK(!done.failed);
  }
  CHECK(kept.json()["runs"].size() == 2);
  CHECK(kept.left_out().empty());
  const std::string text =
      report::points_page({.csv = "run,x\n1,2\n2,3\n3,4\n", .x = "run", .y = "x", .histories = &kept});
  const Json data = Json::parse(element(text, "data"))["histories"];
  const std::vector<unsigned char> bytes = bytes_of(element(text, "numbers"));
  REQUIRE(data["runs"].size() == 2);
  CHECK(data["runs"][0]["run"] == 1);
  CHECK(data["runs"][1]["run"] == 3);
  CHECK(data["mechanisms"].size() == 1);  // the same one twice
  for (const Json& run : data["runs"]) {
    const Table& table = tables[run["run"].get<std::size_t>() - 1];
    const std::vector<double> x = read(bytes, run["table"]["columns"][1]["values"]);
    REQUIRE(x.size() == table.n_rows());
    for (std::size_t k = 0; k < x.size(); ++k) CHECK(x[k] == Approx(table["rod.x"][k]).margin(1e-7));
    const std::vector<double> rows = read(bytes, run["frames"]["rows"]);
    CHECK(rows[0] == Approx(table["rod.x"][0]).margin(1e-7));
    CHECK(rows[rows.size() - run["frames"]["width"].get<std::size_t>() + 1] ==
          Approx(table["rod.y"].back()).margin(1e-7));
  }
}

TEST_CASE("of very many runs a page keeps some, and of these some outputs", "[report]") {
  const Scene scene = scene_from_text(kSwinging, "swinging.json");
  const Registry registry = builtin_registry();
  const Table columns = recorded_columns(scene, registry);
  report::Histories kept(100'000);
  long n = 0;
  for (long run = 1; run <= 100'000; ++run) n += kept.keeps(run) ? 1 : 0;
  CHECK(n == 2000);
  Table table = columns;
  const std::unique_ptr<report::Frames> seen = kept.watcher();
  Scene fine = scene;
  fine.run.output = 0.5 / 4000;
  watched_run(fine, registry, columns, {}, &table,
              {seen.get(), [&](const Mechanism& m, const Table& t) { kept.add(1, t, *seen, m); }});
  CHECK(table.n_rows() == 4001);
  const Json data = kept.json();
  const auto rows = data["runs"][0]["table"]["columns"][0]["values"]["n"].get<std::size_t>();
  const auto frames = data["runs"][0]["frames"]["n"].get<std::size_t>();
  CHECK(rows * 3 <= 2000 + 6);  // 4 million over 2000 runs; the last row stays
  CHECK(rows >= 30);
  CHECK(frames >= 30);
  CHECK(frames * data["runs"][0]["frames"]["width"].get<std::size_t>() <= 2000);
  const auto stride = data["runs"][0]["table"]["stride"].get<std::size_t>();
  const auto said = kept.left_out();
  CAPTURE(said, rows, frames);
  CHECK(said.starts_with("1 run in 50, 1 row in " + std::to_string(stride) + ", 1 frame in "));
  // Of 4001 instants about every so many are there: frames are also added where bodies moved far.
  const auto instants = std::stoul(said.substr(said.rfind(' ') + 1));
  CHECK(instants > 1);
  CHECK(data["runs"][0]["frames"]["stride"] == instants);
  CHECK(2 * frames >= 4001 / instants);
  CHECK(frames <= 2 * (4001 / instants) + 2);
}

TEST_CASE("runs of mechanisms with different shapes keep their columns, and as much motion as fits", "[report]") {
  const Registry registry = builtin_registry();
  const auto add = [&](report::Histories& kept, long run, int metres) {
    std::string text = kSwinging;
    const std::string to = "[1, 0, 0]";
    text.replace(text.find(to), to.size(), "[" + std::to_string(metres) + ", 0, 0]");
    const Scene scene = scene_from_text(text, "swinging.json");
    const std::unique_ptr<report::Frames> seen = kept.watcher();
    Table table;
    watched_run(scene, registry, recorded_columns(scene, registry), {}, &table,
                {seen.get(), [&](const Mechanism& m, const Table& t) { kept.add(run, t, *seen, m); }});
  };
  report::Histories one(1);
  add(one, 1, 1);
  const std::size_t bytes = one.json()["mechanisms"][0].dump().size();
  report::Histories kept(6, 3 * bytes);  // room for two, and the third of equal size
  for (long run = 1; run <= 6; ++run) add(kept, run, run == 6 ? 1 : static_cast<int>(run));
  CHECK(kept.json()["runs"].size() == 6);
  const Json data = kept.json();
  CHECK(data["mechanisms"].size() < 5);
  std::size_t size = 0;
  for (const Json& mechanism : data["mechanisms"]) size += mechanism.dump().size();
  CHECK(size <= 3 * bytes);
  long without = 0;
  for (const Json& run : data["runs"]) {
    CHECK(run["table"]["columns"].size() == 3);
    CHECK(run.contains("mechanism") == run.contains("frames"));
    without += run.contains("mechanism") ? 0 : 1;
  }
  CHECK(without == 5 - static_cast<long>(data["mechanisms"].size()));
  CHECK(without > 0);
  CHECK(data["runs"][5]["mechanism"] == 0);  // looks as the first
  CHECK(kept.left_out() == "no motion of " + std::to_string(without) + " of them");
}

TEST_CASE("a page of modes holds the shapes by body, about the origins of their frames", "[report]") {
  const Scene scene = scene_from_text(kSwinging, "swinging.json");
  Mechanism m = build_mechanism(scene, builtin_registry());
  Dynamics dynamics(system_of(m), make_solver(m.run, builtin_registry()));
  const State rest = m.system.start();
  using Z = std::complex<double>;
  const std::vector<report::ShownMode> modes{
      {"1: 2 Hz", "undamped", 2, 0, {{Z(1, 2), Z(3), Z(0), Z(0), Z(0), Z(0.5, -1)}}}};
  const Page page(report::modes_page({.title = "</title>"}, Sample(dynamics, rest, StepReport{}), m, modes, 0.25));
  CHECK(page.data["kind"] == "modes");
  CHECK(page.data["length"] == 0.25);
  CHECK(page.data["modes"][0]["name"] == "1: 2 Hz");
  CHECK(page.data["modes"][0]["shape"] == Json::parse("[[1, 3, 0, 0, 0, 0.5, 2, 0, 0, 0, 0, -1]]"));
  CHECK(page.data["pivots"] == Json::parse("[[0.5, 0, 0]]"));  // the mass centre of the rod
  CHECK(page.data["frames"]["n"] == 1);
  CHECK(page.data["table"]["columns"].empty());
}

}  // namespace report_runs_test
