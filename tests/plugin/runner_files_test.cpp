// SPDX-License-Identifier: BSD-3-Clause
// What the program writes and reads: tables, pictures, reports, and what becomes of them when a run fails.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/program/run_report.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_files_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string& kFolder = kRunnerFolder;

// What a page of the folder shows.
nlohmann::json page(const std::string& name) {
  std::ifstream in(kFolder + "/" + name, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::size_t begin = text.find(" id=\"data\">") + 11;
  return nlohmann::json::parse(text.substr(begin, text.find("</script>", begin) - begin));
}

}  // namespace

TEST_CASE("joints with constraints that are not unique are marked by name, stops too", "[runner]") {
  UniquenessReport reactions;
  reactions.rows = {"A.x", "A.y", "A.stop_rz_low.rz", "A.stop_rz_high.rz"};
  const auto marked = marked_links(reactions);
  std::vector<std::string> names, rows;
  for (const auto& [link, why] : marked) names.push_back(link), rows.push_back(why.substr(0, why.find(';')));
  CHECK(names == std::vector<std::string>{"A", "A.stop_rz_low", "A.stop_rz_high"});
  CHECK(rows == std::vector<std::string>{"reaction not unique: constraint x, y", "reaction not unique: constraint rz",
                                         "reaction not unique: constraint rz"});
}

TEST_CASE("run, report, sweep and chart write pages", "[runner]") {
  for (const char* name : {"bar.html", "short.html", "grid.html"}) fs::remove(kFolder + "/" + std::string(name));
  const Called run = call("run '" + kFourBar + "' --until 0.1 --record bar.csv --report pages/../bar.html");
  INFO(run.text);
  CHECK(run.exit == 0);
  CHECK(contains(run.text, "bar.html"));
  const nlohmann::json bar = page("bar.html");
  CHECK(bar["text"]["command"] == "lockstep run four_bar.json --until 0.1 --record bar.csv --report bar.html");
  CHECK(bar["text"]["title"] == "Four-bar at 10 rad/s: angles, pin forces and the torque it takes");
  CHECK(contains(bar["text"]["scene"], "\"axial_inertia\": 1e-4"));  // as its author wrote it
  CHECK(bar["table"]["rows"] == 11);
  bool conserved = false;
  for (const nlohmann::json& fact : bar["text"]["facts"]) conserved = conserved || contains(fact[1], "energy ok");
  CHECK(conserved);

  const Called report = call("report '" + kFourBar + "' --until 0.1 --record short.csv --quiet");
  INFO(report.text);
  CHECK(report.exit == 0);
  CHECK(report.text.empty());
  CHECK(page("short.html")["table"]["rows"] == 11);

  const std::string rod = std::string(paths::kScenes) + "/rod_pendulum.json";
  const Called sweep = call(
      "sweep '" + rod + "' --vary gravity.1=-9.81,-1.62 --until 0.1 --record grid.csv --shard 1/1 --report grid.html");
  INFO(sweep.text);
  CHECK(sweep.exit == 0);
  const nlohmann::json grid = page("grid.html");
  CHECK(contains(grid["text"]["command"], "--shard 1/1"));
  const std::string header = std::string(grid["csv"]).substr(0, std::string(grid["csv"]).find('\n'));
  for (const char* axis : {"x", "y"}) CHECK(contains("," + header + ",", "," + std::string(grid[axis]) + ","));
  CHECK(contains(grid["x"], "gravity.1"));

  check_refused(call("run '" + kFourBar + "' --until 0.1 --record bar.csv --report bar.csv"), 2,
                {"the report would replace 'bar.csv', another result; name it bar.html"});
  check_refused(call("run '" + kFourBar + "' --until 0.1 --record bar.csv --report bar.png"), 2,
                {"the report would replace 'bar.png'"});
  const std::string own = scene_file("own", kArm + R"("run": {"until": 0.1})");
  const Called over = call("run '" + own + "' --record bar.csv --report '" + own + "'");
  CHECK(over.exit == 2);
  CHECK(contains(over.text, "a file of the scene"));
}

// A four-bar in space has three redundant rows, which share forces along the axes and moments across them.
TEST_CASE("the page of a run marks joints whose reactions are not unique", "[runner]") {
  for (const char* name : {"full.html", "flat.html"}) fs::remove(kFolder + "/" + std::string(name));
  const std::string run = "run '" + kFourBar + "' --until 0.05 --no-picture ";
  REQUIRE(call(run + "--full --record full.csv --report full.html").exit == 0);
  const nlohmann::json marked = page("full.html")["text"]["marked"];
  INFO(marked.dump());
  REQUIRE(marked.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(marked[k][0] == std::string(1, "ABCD"[k]));
    CHECK(contains(marked[k][1], "not unique"));
  }
  REQUIRE(call(run + "--record flat.csv --report flat.html").exit == 0);
  CHECK(page("flat.html")["text"]["marked"].empty());
}

TEST_CASE("a run that fails leaves a report of what it computed", "[runner]") {
  const std::string page = kFolder + "/broken.partial.html";
  fs::remove(page);
  std::ofstream(kFolder + "/broken.html") << "an older one";
  const std::string few = scene_file(
      "few", kArm + R"("run": {"until": 1, "integrator": "rk4", "step": 0.01, "max_steps": 20, "output": 0.05})");
  const Called r = call("run '" + few + "' --record broken.csv --report broken.html");
  INFO(r.text);
  CHECK(r.exit == 6);
  CHECK(contains(r.text, "unfinished report: "));
  std::ifstream in(page);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  CHECK(contains(text, "the run ended at t = 0.2 s"));
  CHECK(contents_of(kFolder + "/broken.html") == "an older one");
}

TEST_CASE("a number that is none stops the run, what was computed is kept", "[runner]") {
  const std::string blow = scene_file("blow", kArm + R"("links": [{)" + kHinge + R"(,
    "drive": {"axis": "rz", "law": {"type": "sequence", "laws": [{"type": "constant", "value": 0}, {"type": "polynomial", "coefficients": [0, 1e308, 1e308]}],
    "durations": [0.5, 9]}}}], "run": {"integrator": "rk4", "step": 0.1, "until": 2, "record": ["arm.x"]})");
  fs::remove(kFolder + "/blow.csv");  // of an earlier run
  const Called r = call("run '" + blow + "' --record blow.csv");
  INFO(r.text);
  CHECK(r.exit == 7);
  CHECK(contains(r.text, "joint 'A'"));
  CHECK(contains(r.text, "t = 0.5 s"));
  CHECK(contains(r.text, " rows in "));
  CHECK(read_csv(kFolder + "/blow.csv.partial").n_rows() >= 5);
  CHECK_FALSE(fs::exists(kFolder + "/blow.csv"));
  const Called full = call("run '" + blow + "' --record /dev/full");
  INFO(full.text);
  CHECK(full.exit == 7);  // the run's own error, not the disk's
  CHECK(contains(full.text, "saved: no rows: "));
  CHECK(contains(full.text, "joint 'A'"));
}

TEST_CASE("results replace neither what a scene is read from nor what another run writes", "[runner]") {
  const std::string arm = scene_file("input_arm", kArm + R"("links": [{)" + kHinge + R"(,
    "drive": {"axis": "rz", "law": {"type": "spline", "file": "input_law.csv"}}}], "run": {"until": 0.1})");
  const std::string law = kFolder + "/input_law.csv", text = "t,y\n0,0\n1,1\n2,0\n";
  std::ofstream(law) << text;
  const auto bytes = [](const std::string& file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (const char* record : {"input_law.csv", "input_arm.json", "./input_law.csv"}) {
    const std::string scene = bytes(arm);
    for (const char* verb : {"run", "sweep --vary gravity.1=-1,-2"}) {
      const Called r = call(std::string(verb) + " '" + arm + "' --record " + record);
      INFO(r.text);
      CHECK(r.exit == 2);
      CHECK(contains(r.text, "would replace"));
      CHECK(bytes(law) == text);
      CHECK(bytes(arm) == scene);
    }
  }
  const std::string busy = kFolder + "/busy.csv";
  fs::remove(busy);
  const Called two = shell("cd '" + kFolder + "' && (lockstep run '" + kFourBar +
                           "' --until 1000 --quiet --record busy.csv & sleep 0.5; lockstep run '" + kFourBar +
                           "' --quiet --record busy.csv; echo second $?; kill %1)");
  INFO(two.text);
  CHECK(contains(two.text, "being written by another run"));
  CHECK(contains(two.text, "second 8"));
}

TEST_CASE("an interrupted run ends after its step, and its table does not replace the old one", "[runner]") {
  const std::string swing = scene_file("swing", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "rk4", "step": 1e-3, "until": 1e6, "output": 1, "record": ["arm.x"]})");
  std::ofstream(kFolder + "/swing.csv") << "t,old\n0,1\n";
  const Called r = call("run '" + swing + "' --record swing.csv", "timeout --foreground --preserve-status -s INT 3");
  INFO(r.text);
  CHECK(r.exit == 130);
  CHECK(contains(r.text, "interrupted at t = "));
  CHECK(contains(r.text, "rows saved in swing.csv.partial"));
  CHECK_FALSE(contains(r.text, "the caller"));
  CHECK(read_csv(kFolder + "/swing.csv.partial").n_rows() >= 1);
  CHECK(contents_of(kFolder + "/swing.csv") == "t,old\n0,1\n");
  check_refused(call("run '" + swing + "' --record swing.csv", "timeout --foreground --preserve-status -s TERM 2"), 130,
                {"interrupted at t = "});
}

// sin 0.3 = 0.2955...: the row is the start itself.
TEST_CASE("a run or sweep of zero duration has one line", "[runner]") {
  const std::string members =
      kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge +
      R"(, "start": {"position": {"rz": 0.3}}}], "run": {"until": 0, "output": 0.1, "record": ["arm.y"]})";
  const std::string scene = scene_file("at_start", members);
  const std::string never =
      scene_file("never", kArm + R"("links": [{)" + kHinge + R"(}], "run": {"record": ["arm.y"]})");
  for (const std::string& words :
       {scene + "'", never + "' --until 0", never + "' --until 0s --integrator rk4 --step 1ms"}) {
    fs::remove(kFolder + "/at_start.csv");
    const Called r = call("run '" + words + " --record at_start.csv --report at_start.html --strict");
    INFO(words << '\n' << r.text);
    CHECK(r.exit == 0);
    const Table table = read_csv(kFolder + "/at_start.csv");
    CHECK(table.n_rows() == 1);
    CHECK(table.last("t") == 0);
    CHECK(table.last("arm.y") == Approx(words.starts_with(scene) ? 0.5 * std::sin(0.3) : 0.0).margin(1e-15));
  }
  const Called swept = call("sweep '" + scene + "' --vary gravity.1=-1,-2,-3,-4 --record at_starts.csv");
  INFO(swept.text);
  CHECK(swept.exit == 0);
  const std::string rows = contents_of(kFolder + "/at_starts.csv");
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 5);
  CHECK(contains(rows, "\n4,-4,0,"));  // to t = 0
  check_refused(call("run '" + never + "'"), 3, {"the scene has no end time"});
  check_refused(call("run '" + never + "' --until -1s"), 2, {"--until: the value is -1s; it must be 0 or greater"});
}

TEST_CASE("an interrupted chart writes the runs that are done", "[runner]") {
  fs::remove(kFolder + "/charts/four_bar_chart.csv");
  // The first runs, the references, take longer on a busy machine: wait longer until one run is done before the signal.
  Called r;
  for (const char* seconds : {"3", "8", "20"}) {
    r = call("chart '" + kFourBar + "' --until 0.05 --budget 60 --out charts --quiet",
             std::string("timeout --foreground --preserve-status -s INT ") + seconds);
    if (contains(r.text, "the completed runs are written")) break;
  }
  INFO(r.text);
  CHECK(r.exit == 130);
  CHECK(contains(r.text, "the completed runs are written"));
  std::ifstream file(kFolder + "/charts/four_bar_chart.csv");
  std::string line;
  int n_lines = 0;
  while (std::getline(file, line)) {
    CHECK_FALSE(contains(line, "interrupted"));
    ++n_lines;
  }
  CHECK(n_lines > 1);
}

TEST_CASE("a table is never written where its picture goes", "[runner]") {
  for (const char* ending : {"png", "svg", "PNG"}) {
    const Called r = call("run '" + kFourBar + "' --record way." + ending);
    INFO(r.text);
    CHECK(r.exit == 2);
    CHECK(contains(r.text, "--record way.csv"));
  }
}

TEST_CASE("a picture that fails hides neither summary nor table", "[runner]") {
  fs::create_directories(kFolder + "/broken");
  const std::string gnuplot = kFolder + "/broken/gnuplot";
  std::ofstream(gnuplot) << "#!/bin/sh\necho out of ink\nexit 1\n";
  fs::permissions(gnuplot, fs::perms::owner_all);
  const Called broken = call("run '" + kFourBar + "' --record inkless.csv", "PATH='" + kFolder + "/broken':\"$PATH\"");
  INFO(broken.text);
  CHECK(broken.exit == 0);
  CHECK(contains(broken.text, "inkless.csv"));
  CHECK(contains(broken.text, "simulated  0.7 s"));
  CHECK(contains(broken.text, "no picture: gnuplot could not draw"));
  CHECK(contains(broken.text, "out of ink"));
  const Called none = call("run '" + kFourBar + "' --record bare.csv", "PATH=/nowhere");
  CHECK(none.exit == 0);
  CHECK(contains(none.text, "no picture: gnuplot is not installed"));
  const Called torn = call("run '" + kFourBar + "' --record /dev/full");
  INFO(torn.text);
  CHECK(torn.exit == 8);
  CHECK(contains(torn.text, "file '/dev/full' cannot be written: No space left on device"));
  CHECK(contains(torn.text, "energy ok"));
  CHECK(fs::is_character_file("/dev/full"));  // a device is written to, and never replaced
}

TEST_CASE("a picture of some columns gives their number", "[runner]") {
  const std::string wide = scene_file("wide", kArm + R"("gravity": [0, -9.81, 0], "run": {"until": 0.1, "record":
    ["arm.x", "arm.y", "arm.z", "arm.vx", "arm.vy", "arm.vz", "arm.qw", "arm.qx", "arm.qy", "arm.qz",
     "arm.ax", "arm.ay", "arm.az", {"x2": "arm.x"}, {"x3": "arm.x"}, {"x4": "arm.x"}, {"x5": "arm.x"}]})");
  const Called r = call("run '" + wide + "' --record wide.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  if (contains(r.text, "wide.png")) CHECK(contains(r.text, "drawn: 16 of 17 columns, at most six per panel; choose with run.draw"));
}

TEST_CASE("a scene reads files of its folder only, unless it is allowed more", "[runner]") {
  fs::create_directories(kFolder + "/within");
  for (const char* file : {"/within/rise.csv", "/outside.csv", "/within/below/rise.csv"}) {
    fs::create_directories(fs::path(kFolder + file).parent_path());
    std::ofstream(kFolder + file) << "t,y\n0,0\n0.5,0.1\n1,0.3\n2,0.5\n";
  }
  std::error_code none;
  fs::remove(kFolder + "/within/link.csv", none);
  fs::create_symlink(kFolder + "/outside.csv", kFolder + "/within/link.csv");
  const auto run = [&](const std::string& file, const std::string& options = {}) {
    std::ofstream(kFolder + "/within/driven.json")
        << R"({"lockstep": 1, )" << kArm << R"("links": [{)" << kHinge
        << R"(, "drive": {"axis": "rz", "law": {"type": "spline", "file": ")" << file
        << R"("}}}], "run": {"until": 1, "output": 0.5, "record": ["arm.x"]}})";
    return call("run within/driven.json --record driven.csv " + options);
  };
  CHECK(run("rise.csv").exit == 0);
  CHECK(run("below/../below/rise.csv").exit == 0);
  for (const std::string& file : {std::string("../outside.csv"), kFolder + "/outside.csv", std::string("/etc/hostname"),
                                  std::string("link.csv")}) {
    const Called r = run(file);
    CAPTURE(file, r.text);
    CHECK(r.exit == 2);
    CHECK(contains(r.text, "\"" + file + "\" is outside the scene's folder"));
    CHECK(contains(r.text, "--allow-files"));
  }
  CHECK(run("../outside.csv", "--allow-files").exit == 0);

  // meshes likewise
  std::ofstream(kFolder + "/outside.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto look = [&](const std::string& file, const std::string& options = {}) {
    std::ofstream(kFolder + "/within/seen.json")
        << R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1, "visual": {"shapes": [{"mesh": ")" << file
        << R"("}]}}], "run": {"until": 1, "output": 0.5}})";
    return call("check within/seen.json " + options);
  };
  CHECK(look("../outside.obj").exit == 2);
  CHECK(contains(look("../outside.obj").text, "\"../outside.obj\" is outside the scene's folder"));
  CHECK(look("../outside.obj", "--allow-files").exit == 0);
  fs::copy_file(kFolder + "/outside.obj", kFolder + "/within/inside.obj", fs::copy_options::overwrite_existing);
  CHECK(look("inside.obj").exit == 0);

  // scenes that are included likewise; what they read is named from where they stand
  for (const char* folder : {"/within/below/", "/"})
    std::ofstream(kFolder + folder + "part.json")
        << R"({"lockstep": 1, )" << kArm << R"("links": [{)" << kHinge
        << R"(, "drive": {"axis": "rz", "law": {"type": "spline", "file": "rise.csv"}}}]})";
  fs::copy_file(kFolder + "/within/rise.csv", kFolder + "/rise.csv", fs::copy_options::overwrite_existing);
  const auto include = [&](const std::string& part, const std::string& options = {}) {
    std::ofstream(kFolder + "/within/whole.json") << R"({"lockstep": 1, "include": [{"scene": ")" << part
                                                  << R"("}], "run": {"until": 1, "output": 0.5, "record": ["arm.x"]}})";
    return call("run within/whole.json --record driven.csv " + options);
  };
  CHECK(include("below/part.json").exit == 0);
  const Called outside = include("../part.json");
  CAPTURE(outside.text);
  CHECK(outside.exit == 2);
  CHECK(contains(outside.text, "part.json\" is outside the scene's folder"));
  CHECK(include("../part.json", "--allow-files").exit == 0);
}

TEST_CASE("a scene named from its folder reads the files next to it", "[runner]") {
  fs::create_directories(kFolder + "/beside");
  const std::string cd = "cd '" + kFolder + "/beside' && ";
  // how a gear meshes is no file
  std::ofstream(kFolder + "/beside/gears.json") << R"({"lockstep": 1, "bodies": [
      {"name": "sun", "cylinder": {"mass": 1, "radius": 0.1, "length": 0.02}},
      {"name": "ring", "cylinder": {"mass": 1, "radius": 0.2, "length": 0.02}}],
    "links": [{"name": "A", "type": "revolute", "p": "sun", "s": "ground", "at": [0, 0, 0]},
      {"name": "B", "type": "revolute", "p": "ring", "s": "ground", "at": [0, 0, 0]},
      {"name": "G", "type": "gear", "pairs": ["A", "B"], "teeth_1": 20, "teeth_2": 40, "mesh": "internal"}],
    "run": {"until": 0.1, "output": 0.1, "record": ["A.rz"]}})";
  for (const char* words : {"lockstep check gears.json", "lockstep check ./gears.json", "lockstep check - < gears.json",
                            "lockstep run gears.json --record gears.csv"}) {
    const Called r = shell(cd + words);
    CAPTURE(words, r.text);
    CHECK(r.exit == 0);
  }
  // what is not there cannot be read; what lies outside may not be, whether it is there or not
  const auto check = [&](const std::string& file) {
    std::ofstream(kFolder + "/beside/driven.json")
        << R"({"lockstep": 1, )" << kArm << R"("links": [{)" << kHinge
        << R"(, "drive": {"axis": "rz", "law": {"type": "spline", "file": ")" << file
        << R"("}}}], "run": {"until": 1, "output": 0.5, "record": ["arm.x"]}})";
    return shell(cd + "lockstep check driven.json");
  };
  for (const char* file : {"nothere.csv", "sub/nothere.csv", "./nothere.csv", "../beside/nothere.csv"}) {
    const Called r = check(file);
    CAPTURE(file, r.text);
    CHECK(r.exit == 8);
    CHECK(contains(r.text, "nothere.csv: cannot be opened"));
    CHECK_FALSE(contains(r.text, "outside"));
  }
  for (const char* file : {"../nothere.csv", "/nothere.csv", "sub/../../nothere.csv"}) {
    const Called r = check(file);
    CAPTURE(file, r.text);
    CHECK(r.exit == 2);
    CHECK(contains(r.text, "\"" + std::string(file) + "\" is outside the scene's folder"));
  }
}

TEST_CASE("a full standard output is reported", "[runner]") {
  check_refused(shell("lockstep check '" + kFourBar + "' --json > /dev/full"), 8,
                {"standard output cannot be written; the printed text is incomplete"});
}

}  // namespace runner_files_test
