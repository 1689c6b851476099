// SPDX-License-Identifier: BSD-3-Clause
// The verb sweep, called as a person, GNU parallel and Slurm call it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/report_page.h"

namespace sweep_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

const std::string kRod = std::string(paths::kScenes) + "/rod_pendulum.json";

std::vector<std::string> lines_of(const std::string& name) {
  std::ifstream file(kRunnerFolder + "/" + name);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

// A table without the times of computing, which are never the same twice.
std::vector<std::vector<std::string>> results_of(const std::string& name) {
  std::vector<std::vector<std::string>> rows;
  std::size_t cpu = 0;
  for (const std::string& line : lines_of(name)) {
    rows.push_back(cells_of(line));
    if (rows.size() == 1)
      cpu = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), "cpu [s]") - rows[0].begin());
    REQUIRE(cpu < rows.back().size());
    rows.back().erase(rows.back().begin() + static_cast<std::ptrdiff_t>(cpu));
  }
  return rows;
}

const std::string kGrid =
    "sweep '" + kRod + "' --until 0.2 --vary bodies.rod.rod.mass=1:3:3 --vary gravity.1=-9.81,-1.62 ";

std::string arm_scene() {
  return scene_file("arm", R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}],
    "run": {"integrator": "dop853", "tolerance": 1e-10, "until": 0.5, "output": 0.1,
            "record": ["arm.x", "A.rz", {"Fy": "A.force_on_p_world_y"}]})");
}

}  // namespace

TEST_CASE("histories have outputs at jumps if the scene requests them, and the table of the sweep is the same",
          "[runner]") {
  // the hinge turns at 3 rad/s from t = m on
  const auto scene = [](const std::string& more, const std::string& rows = R"("output": 0.1)") {
    return scene_file("jumping",
                      kArm + R"("parameters": {"m": 0.55}, "links": [{)" + kHinge +
                          R"(, "drive": {"axis": "rz", "law": {"type": "formula", "y": "=t>m ? 3*(t-m) : 0"}}}],
      "run": {"until": 1, "tolerance": 1e-9, "record": ["arm.ay", "arm.vy"], )" +
                          rows + more + "}");
  };
  const std::string vary = " --vary m=0.55,0.5 --histories jumping --record ";
  const Called plain = call("sweep '" + scene("") + "'" + vary + "plain.csv");
  CHECK(plain.exit == 0);
  CHECK(read_csv(kRunnerFolder + "/jumping/1.csv").n_rows() == 11);
  const std::string asks = scene(R"(, "at_jumps": true)");
  const Called swept = call("sweep '" + asks + "'" + vary + "asked.csv");
  CAPTURE(swept.text);
  CHECK(swept.exit == 0);
  REQUIRE(call("run '" + asks + "' --no-picture --record jumped.csv").exit == 0);
  const Table history = read_csv(kRunnerFolder + "/jumping/1.csv"), run = read_csv(kRunnerFolder + "/jumped.csv");
  REQUIRE(run.n_rows() == 13);  // 11 outputs, and both sides of t = 0.55
  REQUIRE(history.n_rows() == run.n_rows());
  for (const std::string& column : run.names())
    for (std::size_t i = 0; i < run.n_rows(); ++i) CHECK(history[column][i] == run[column][i]);
  // at an output the row before is there already
  CHECK(read_csv(kRunnerFolder + "/jumping/2.csv").n_rows() == 12);
  const auto cells = [](const std::string& file) {  // but for the computing time
    std::ifstream in(kRunnerFolder + "/" + file);
    std::string line, all;
    while (std::getline(in, line)) all += line.substr(0, line.find_last_of(',', line.find_last_of(',') - 1)) + "\n";
    return all;
  };
  CHECK(cells("asked.csv") == cells("plain.csv"));
  const std::string early = scene(R"(, "at_jumps": true)", R"("times": [0, 0.1, 0.2, 0.3])");
  REQUIRE(call("sweep '" + early + "'" + vary + "kept.csv").exit == 0);
  CHECK(read_csv(kRunnerFolder + "/jumping/1.csv")["t"].back() == 0.55);
  REQUIRE(call("sweep '" + early + "' --vary m=0.55,0.5 --record alone.csv").exit == 0);
  CHECK(cells("kept.csv") == cells("alone.csv"));
}

TEST_CASE("two shards together are the whole sweep", "[runner][sweep]") {
  for (const char* name : {"whole", "half_1", "half_2", "joined"}) fs::remove(kRunnerFolder + "/" + name + ".csv");
  const Called whole = call(kGrid + "--record whole.csv --histories sweep_histories");
  INFO(whole.text);
  CHECK(whole.exit == 0);
  CHECK(contains(whole.text, "  6 runs, all succeeded"));
  CHECK(call(kGrid + "--record half_1.csv --shard 1/2 --quiet").exit == 0);
  CHECK(call(kGrid + "--record half_2.csv --shard 2/2 --quiet").text.empty());
  CHECK(lines_of("half_1.csv").size() == 4);
  CHECK(lines_of("half_2.csv").front() == lines_of("whole.csv").front());
  CHECK(shell("awk 'FNR > 1 || NR == 1' half_*.csv | sort -t , -k 1,1n > joined.csv").exit == 0);
  const auto rows = results_of("whole.csv");
  REQUIRE(rows.size() == 7);
  CHECK(results_of("joined.csv") == rows);
  CHECK(rows[0][1] == "bodies.rod.rod.mass [kg]");
  CHECK(rows[2][1] == "1");
  CHECK(rows[2][2] == "-1.62");
  // The row's numbers are those of the run's own columns.
  const Table history = read_csv(kRunnerFolder + "/sweep_histories/2.csv");
  CHECK(std::stod(rows[2][3]) == history.last("t"));
  CHECK(std::stod(rows[2][4]) == history.last("phi"));
  CHECK(std::stod(rows[2][5]) == *std::min_element(history["phi"].begin(), history["phi"].end()));
  CHECK(std::stod(rows[2][6]) == *std::max_element(history["phi"].begin(), history["phi"].end()));
}

TEST_CASE("a sweep prints its results, in the units of --vary", "[runner][sweep]") {
  const std::string rod = "sweep '" + kRod + "' --until 0.5 --record units.csv ";
  const Called few = call(rod + "--vary length='500 mm:600 mm:3'");
  INFO(few.text);
  CHECK(contains(few.text, "\n  results    length"));
  CHECK(contains(few.text, "\n             550 mm "));
  CHECK(lines_of("units.csv")[2].starts_with("2,0.55,"));
  const Called many = call(rod + "--vary length='500 mm:600 mm:21'");
  INFO(many.text);
  CHECK(contains(many.text, " (length = 500 mm)"));
  CHECK(contains(many.text, "   (all 7: in the table)\n"));
}

TEST_CASE("a sweep writes a file with a separate name next to other files", "[runner][sweep]") {
  for (const char* name : {"rod_pendulum_sweep", "rod_pendulum_sweep_7of9"})
    fs::remove(kRunnerFolder + "/" + name + ".csv");
  CHECK(call(kGrid + "--quiet").exit == 0);
  CHECK(call(kGrid + "--quiet --shard 7/9").exit == 0);
  CHECK(lines_of("rod_pendulum_sweep.csv").size() == 7);
  CHECK(lines_of("rod_pendulum_sweep_7of9.csv").size() == 1);  // more shares than runs: the header alone
}

TEST_CASE("each run of a sweep has a verdict on its energy and its drift, and an exit code", "[runner][sweep]") {
  const Called r = call("sweep '" + kRod + "' --until 20 --vary run.tolerance=1e-9,0.5 --record verdicts.csv");
  INFO(r.text);
  CHECK(r.exit == 9);
  CHECK(contains(r.text, "2 runs, 1 wrong (energy, constraints or requirements)"));
  const auto rows = results_of("verdicts.csv");
  REQUIRE(rows.size() == 3);
  const auto at = static_cast<std::size_t>(std::ranges::find(rows[0], "energy") - rows[0].begin());
  CHECK(rows[1][at] == "conserved");
  CHECK(rows[2][at] == "not conserved");
  CHECK(std::stod(rows[2][at + 1]) > 1e-3);

  const Called d = call("sweep '" + kRod +
                        "' --until 5 --vary run.tolerance=1e-9,1e-3 --formulation omega --stabilization none "
                        "--record drifts.csv --json");
  INFO(d.text);
  const auto drifts = results_of("drifts.csv");
  REQUIRE(drifts.size() == 3);
  CHECK(std::stod(drifts[2][at + 2]) > std::stod(drifts[1][at + 2]));
  CHECK(contains(d.text, "\"drifted\": "));
}

TEST_CASE("a failed run in the middle has its line, and an exit code", "[runner][sweep]") {
  const Called r = call("sweep '" + kRod + "' --until 0.1 --vary length=-1,0,1 --record middle.csv");
  INFO(r.text);
  CHECK(r.exit == 1);
  CHECK(contains(r.text, "run 2 (length = 0 m) failed: "));
  CHECK(contains(r.text, "a rod needs a length"));
  const auto rows = results_of("middle.csv");
  REQUIRE(rows.size() == 4);
  CHECK(rows[1].back() == "ok");
  CHECK(contains(rows[2].back(), "failed: "));
  CHECK(rows[2][2].empty());
  CHECK(rows[3].back() == "ok");
}

TEST_CASE("impossible words are rejected before the first run", "[runner][sweep]") {
  const auto refused = [](const std::string& words, int exit, const std::string& part) {
    const Called r = call("sweep '" + kRod + "' --record never.csv " + words);
    INFO(words << "\n" << r.text);
    CHECK(r.exit == exit);
    CHECK(contains(r.text, part));
    CHECK_FALSE(fs::exists(kRunnerFolder + "/never.csv"));
  };
  fs::remove(kRunnerFolder + "/never.csv");
  refused("", 2, "--vary is required");
  refused("--vary bodies.rod.rod.mas=1", 2, "did you mean \"bodies.rod.rod.mass\"?");
  refused("--vary bodies.rod.mass=1,2", 2, "did you mean \"bodies.rod.rod.mass\"?");
  refused("--vary gravity.1=1 --shard 3/2", 2, "the last is 2/2");
  refused("--vary gravity.1=1 --vary gravity.1=2", 2, "varies twice");
  refused("--vary run.tolerance=1e-4,1e-6 --tolerance 1e-8", 2, "--tolerance: \"run.tolerance\" varies");
  refused("--vary bodies.rod.rod.mass=-1,-2", 3, "must be greater than 0");
  const Called full = call("sweep '" + kRod + "' --until 0.1 --vary gravity.1=1 --record /dev/full");
  INFO(full.text);
  CHECK(full.exit == 8);
  CHECK(contains(full.text, "file '/dev/full' cannot be written: No space left on device"));
}

TEST_CASE("integrators, steps and options of the command line go together with what varies", "[runner][sweep]") {
  const Called r =
      call("sweep '" + kRod + "' --until 0.2 --integrator rk4 --vary run.step=0.1,10ms --record steps.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  const auto rows = results_of("steps.csv");
  REQUIRE(rows.size() == 3);
  const auto steps = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), "steps") - rows[0].begin());
  CHECK(rows[1][steps] == "2");
  CHECK(rows[2][steps] == "20");
}

TEST_CASE("an interrupted sweep keeps the completed results", "[runner][sweep]") {
  const std::string swing = scene_file("long_swing", R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}],
    "run": {"integrator": "rk4", "step": 1e-3, "until": 1, "record": ["arm.x"], "output": 1})");
  // On two threads the third run is finished beside the second, which never ends.
  for (const auto& [jobs, done] : {std::pair{"1", std::vector<std::string>{"1"}}, {"2", {"1", "3"}}}) {
    std::ofstream(kRunnerFolder + "/swing_sweep.csv") << "of an earlier sweep\n";
    const Called r = call("sweep '" + swing + "' --vary run.until=0.1,1e6,0.1 --record swing_sweep.csv --jobs " + jobs,
                          "timeout --foreground --preserve-status -s INT 3");
    INFO(r.text);
    CHECK(r.exit == 130);
    CHECK(contains(r.text, "interrupted; the rows of " + std::to_string(done.size()) + " of 3 runs are in"));
    const auto rows = results_of("swing_sweep.csv.partial");
    REQUIRE(rows.size() == 1 + done.size());
    for (std::size_t k = 0; k < done.size(); ++k) {
      CHECK(rows[1 + k].front() == done[k]);
      CHECK(rows[1 + k].back() == "ok");
    }
    CHECK(lines_of("swing_sweep.csv") == std::vector<std::string>{"of an earlier sweep"});
  }
}

TEST_CASE("a sweep on several threads makes the table of one thread", "[runner][sweep]") {
  const std::string arm = "sweep '" + arm_scene() + "' ";
  struct Case {
    std::string words, says;
    std::size_t rows;
    int exit;
  };
  const std::vector<Case> cases = {
      {"--vary bodies.arm.rod.mass=1:3:20", "20 runs, all succeeded", 20, 0},
      {"--vary bodies.arm.rod.mass=1,2,3,4,-5,6,7,8,9,10,11,12", "12 runs, 1 failed", 12, 1},
      {"--vary run.integrator=dop853,radau5 --vary bodies.arm.rod.mass=1:3:8", "16 runs, all succeeded", 16, 0}};
  for (const Case& c : cases) {
    INFO(c.words);
    const Called one = call(arm + c.words + " --jobs 1 --record jobs_1.csv --histories jobs_1"),
                 four = call(arm + c.words + " --jobs 4 --record jobs_4.csv --histories jobs_4");
    INFO(one.text << four.text);
    CHECK(one.exit == c.exit);
    CHECK(four.exit == c.exit);
    CHECK(contains(one.text, c.says));
    CHECK(contains(four.text, c.says));
    const auto rows = results_of("jobs_1.csv");
    CHECK(rows.size() == 1 + c.rows);
    CHECK(results_of("jobs_4.csv") == rows);
    CHECK(shell("diff -r jobs_1 jobs_4").text.empty());
    CHECK_FALSE(fs::exists(kRunnerFolder + "/jobs_4.csv.partial"));
  }
  check_refused(call(arm + cases[0].words + " --jobs 0"), 2, {"--jobs: \"0\" is not a whole number from 1 to 1024"});
}

// The recipes are those of the page, with its scene, so that what is printed there is what works.
std::string page_part(const std::string& begin, const std::string& end) {
  std::ifstream file(std::string(paths::kSource) + "/framework/docs/sweep.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const std::size_t at = page.find(begin);
  REQUIRE(at != std::string::npos);
  return page.substr(at, page.find(end, at) - at);
}

void begin_recipe(const std::string& folder) {
  fs::remove_all(kRunnerFolder + "/" + folder);
  fs::create_directories(kRunnerFolder + "/" + folder);
  const std::string block = page_part("```json buffer.json", "\n```");
  std::ofstream(kRunnerFolder + "/" + folder + "/buffer.json") << block.substr(block.find('\n'));
}

TEST_CASE("the recipe for GNU parallel makes the table of one sweep", "[runner][sweep]") {
  if (!contains(shell("parallel --version").text, "GNU parallel")) {
    WARN("skipped: GNU parallel is not installed (tests/run installs it where it may)");
    return;
  }
  begin_recipe("parallel");
  const Called shards = shell("cd parallel && " + page_part("parallel lockstep", "\n"));
  INFO(shards.text);
  CHECK(shards.exit == 0);
  CHECK(shell("cd parallel && " + page_part("awk 'FNR", "\n")).exit == 0);
  const Called whole = call("sweep parallel/buffer.json --vary ratio=0.1:1:100 --quiet --record parallel/one.csv");
  CHECK(whole.exit == 0);
  const auto rows = results_of("parallel/one.csv");
  CHECK(rows.size() == 101);
  CHECK(results_of("parallel/all.csv") == rows);
}

// Slurm itself is not there: its variables are, one task after the other.
TEST_CASE("the recipe for Slurm makes the table of one sweep", "[runner][sweep]") {
  const std::string script = page_part("#SBATCH", "```");
  CHECK(contains(script, "--array=1-8"));
  begin_recipe("slurm");
  std::ofstream(kRunnerFolder + "/slurm/job.sh") << script << "\n";
  for (int i = 1; i <= 8; ++i) {
    const Called task =
        shell("cd slurm && SLURM_ARRAY_TASK_COUNT=8 SLURM_ARRAY_TASK_ID=" + std::to_string(i) + " sh job.sh");
    INFO(task.text);
    CHECK(task.exit == 0);
  }
  CHECK(shell("cd slurm && cat part_*.csv | grep -c ',ok$'").text == "100\n");
}

TEST_CASE("the page of a sweep has the values in the units of --vary", "[runner][sweep]") {
  const Called r =
      call("sweep '" + kRod + "' --until 0.1 --vary length='500 mm:600 mm:3' --record page.csv --report page.html");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(shell("grep -c 'length \\[mm\\]' page.html").exit == 0);
  CHECK(lines_of("page.csv")[0].starts_with("run,length [m],"));
}

// Twenty rows fall on the zeros of 0.3 sin(20 pi t). The motor's peak, over all the motion, is at the swing's ends:
// J (20 pi)^2 0.3 + m g l / 2 cos 0.3, J about the end of a rod whose radius is a fiftieth of its length.
TEST_CASE("extremes are those of the motion, not only of the recorded times", "[runner]") {
  const double rate = 20 * kPi, peak = (1.0 / 3 + 1e-4) * rate * rate * 0.3 + 0.5 * 9.81 * std::cos(0.3);
  const std::string scene = defect("peak_between_rows");
  const Called swept = call("sweep " + scene + " --vary bodies.arm.rod.mass=1 --record peak.csv");
  INFO(swept.text);
  REQUIRE(swept.exit == 0);
  std::ifstream file(kRunnerFolder + "/peak.csv");
  std::string header, row;
  REQUIRE((std::getline(file, header) && std::getline(file, row)));
  const auto cell = [&](const std::string& name) {
    const auto n = std::count(header.begin(), header.begin() + static_cast<long>(header.find(name)), ',');
    std::size_t at = 0;
    for (long k = 0; k < n; ++k) at = row.find(',', at) + 1;
    return std::stod(row.substr(at));
  };
  const double most = std::max(std::abs(cell("M min")), std::abs(cell("M max")));
  const Called inverse = call("inverse " + scene + " --record inverse_peak.csv --json");
  REQUIRE(inverse.exit == 0);
  const Json driven = Json::parse(inverse.text);
  double by_laws = 0;
  for (const Json& column : driven["columns"])
    if (column["name"] == "A.drive_rz.torque_on_p_link_z") by_laws = std::abs(column["peak"].get<double>());
  CAPTURE(peak, most, by_laws, inverse.text);
  REQUIRE(call("report " + scene + " --out peak.html --record peak_rows.csv").exit == 0);
  std::ostringstream page;
  page << std::ifstream(kRunnerFolder + "/peak.html").rdbuf();
  const report_page::Json column = report_page::Page(page.str()).data["table"]["columns"][1], range = column["range"];
  CHECK(column["name"] == "M");
  CHECK(range["resolved"] == true);
  CHECK(std::abs(range["most"].get<double>() - peak) < 1e-4 * 2 * peak);
  const double swings = 20 * range["t_most"].get<double>() - 0.5;  // of 0.05 s; the ends are in their middles
  CHECK(std::abs(swings - std::round(swings)) < 1e-2);
  CHECK(std::abs(most - peak) < 1e-4 * 2 * peak);
  CHECK(std::abs(by_laws - peak) < 1e-4 * 2 * peak);
}

TEST_CASE("a requirement of parameters that fails is the verdict of its run", "[runner][sweep]") {
  const std::string scene = scene_file("parameters", R"~("parameters": {"r": "2 m"}, "require": ["=r > 1 m"],
    "bodies": [{"name": "b", "particle": 1, "position": ["=r", 0, 0]}], "run": {"until": 1, "output": 1, "record": ["b.x"]})~");
  const Called swept = call("sweep '" + scene + "' --vary r=0.5,2 --record parameters.csv");
  CHECK(swept.exit == 9);
  CHECK(contains(swept.text, "1 wrong"));
  CHECK_FALSE(contains(swept.text, "failed"));
}

TEST_CASE("a sweep reports each broken requirement", "[runner][sweep]") {
  const std::string scene = scene_file("two", R"~("parameters": {"v": "1 m/s"},
    "require": [{"near": "=b.x < 1.5 m"}, {"slow": "=b.vx < 2 m/s"}],
    "bodies": [{"name": "b", "particle": 1, "position": [0, 0, 0], "velocity": ["=v", 0, 0]}],
    "run": {"until": 1, "output": 1, "record": ["b.x"]})~");
  const Called swept = call("sweep '" + scene + "' --vary v=1,2.5,3 --record two.csv");
  CHECK(swept.exit == 9);
  for (const char* name : {"near", "slow"}) CHECK(contains(swept.text, "requirement \"" + std::string(name) + "\""));
  CHECK(contains(swept.text, "(in 2 runs)"));
}

TEST_CASE("prescribed motions check the conditions of a scene, and reject those of unknown masses", "[runner]") {
  const auto scene = [](const std::string& mass, const std::string& condition) {
    return "'" + scene_file("conditions", R"~("bodies": [{"name": "arm")~" + mass + R"~(}], "links": [{"name": "A",
      "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0],
      "drive": {"axis": "rz", "law": {"type": "formula", "y": "=sin(3*t)"
  }
}
}], "require": [")~" + condition + R"~("], "run": {"until": 2, "output": 0.5, "record": ["A.rz"]})~") +
           "'";
  };
  const Called holds = call("kinematics " + scene("", "=A.rz < 1.001 rad"));
  CHECK(holds.exit == 0);
  const Called fails = call("kinematics " + scene("", "=A.rz < 0.9 rad"));
  CHECK(fails.exit == 9);
  const std::size_t at = fails.text.find("worst at t = 0.52"), by = fails.text.find(" by ", at);
  REQUIRE((at != std::string::npos && by != std::string::npos));  // 1 - 0.9, to 1e-5 of the range
  CHECK_THAT(std::stod(fails.text.substr(by + 4)), Catch::Matchers::WithinAbs(0.1, 2e-5));
  CHECK(contains(fails.text, "first at t = 0.373257 s"));  // asin(0.9)/3
  const Called masses = call("kinematics " + scene("", "=A.force_on_p_world.x < 1 N"));
  CHECK(masses.exit == 3);
  CHECK(contains(masses.text, "depends on masses"));
}

}  // namespace sweep_test
