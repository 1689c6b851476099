// Defects that are known and not mended yet, by what the program says: see tests/support/open_defect.h.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/program/progress.h"
#include "tests/support/catch.h"
#include "tests/support/open_defect.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace open_defects_program_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

constexpr double kG = 9.81;
const std::string kOneIdea = "One idea", kSmallProgram = "A small program", kPlainWords = "Plain words",
                  kAnswers = "Answers";
const std::string kDoubtfulReactions = "uncertain by more than 1 %", kDoubtfulTolerance = "was not reached in";

std::string quoted(const std::string& path) { return "'" + path + "'"; }
std::string defect(const std::string& name) { return quoted(defect_scene(name)); }
Table table_of(const std::string& csv) { return read_csv(kRunnerFolder + "/" + csv + ".csv"); }

/// `run` of a scene, with these words; the table has the name.
Called run(const std::string& scene, const std::string& name, const std::string& words = {}) {
  return call("run " + scene + " --no-picture --record " + name + ".csv " + words);
}

/// Largest difference of any column but the time, in parts of the column's largest number; columns of zeros are left out.
double largest_difference(const Table& a, const Table& b) {
  REQUIRE(a.n_rows() == b.n_rows());
  double worst = 0;
  for (const Column& column : a.columns()) {
    const std::vector<double>& other = b[column.name];
    double size = 0, difference = 0;
    for (std::size_t k = 0; k < other.size(); ++k) {
      size = std::max(size, std::abs(other[k]));
      difference = std::max(difference, std::abs(column.values[k] - other[k]));
    }
    if (size > 1e-9) worst = std::max(worst, difference / size);
  }
  return worst;
}

/// A scene of the samples with these reactions recorded, in a file of its own.
std::string with_reactions(const std::string& file, const std::string& name, const std::string& what) {
  Json scene = Json::parse(std::ifstream(std::string(paths::kScenes) + "/" + file));
  Json& settings = scene["run"];
  settings.erase("draw"), settings["record"] = Json::array();
  for (const Json& link : scene["links"])
    for (const char* axis : {"x", "y"}) settings["record"].push_back(link["name"].get<std::string>() + what + axis);
  const std::string path = kRunnerFolder + "/" + name + ".json";
  std::ofstream(path) << scene;
  return quoted(path);
}

}  // namespace

// Folded back, a homokinetic joint turns the output by no multiple of the input: a load of 2 N m turns the output alone,
// by -t^2 / 2 * 2 N m / 0.02 kg m^2, and the motor, which should carry it, exerts nothing.
TEST_CASE("a homokinetic joint that is folded back is refused or named", "[defect][one idea]") {
  const Called ran = run(defect("homokinetic_folded"), "homokinetic_folded");
  INFO(ran.text);
  const bool named = contains(ran.text, "'J'") && contains(ran.text, "fold");
  double behind = 0;
  if (ran.exit == 0) {
    const Table table = table_of("homokinetic_folded");
    REQUIRE(table.n_rows() == 11);
    behind = std::abs(table["out"][6] + 18) + std::abs(table["M"][6]);
  }
  expect_defect("homokinetic_folded", kOneIdea, ran.exit == 0 && !named && behind < 1e-4, named);
}

// The same joint as its output spins up freely: nothing is damped.
TEST_CASE("a folded homokinetic joint has no damped fast modes", "[one idea]") {
  for (const std::string method : {"dopri5 --tolerance 3e-9", "dopri5:stages=manifold --tolerance 1e-8"}) {
    const Called ran = run(defect("homokinetic_folded"), "no_damping", "--until 1.02 --integrator " + method);
    INFO(ran.text);
    CHECK(ran.exit == 0);
    CHECK_FALSE(contains(ran.text, "damped fast modes"));
  }
}

// Two chains or two slides guide the same body, and their directions differ by 0.1 rad or by 0.001 rad: what one allows
// the other nearly forbids.
TEST_CASE("mechanisms that are nearly redundant are named before the first step", "[defect][one idea]") {
  for (const std::string name : {"near_redundant_trammel", "near_redundant_sarrus"}) {
    const Called ran = run(defect(name), name, "--set run.max_steps=300");
    INFO(ran.text);
    const std::size_t named = ran.text.find("nearly redundant"), end = ran.text.find("run ended");
    const bool spent = contains(ran.text, "has made its 300 steps");
    CHECK(ran.exit != 1);
    expect_defect(name, kOneIdea, spent && named == std::string::npos,
                  named != std::string::npos && named < end && !spent);
  }
}

// The motion is right: a run of another method, ten thousand times tighter, agrees.
TEST_CASE("no doubt of two bodies ten metres apart whose motion is right", "[runner]") {
  int doubted = 0;
  const Called tight = run(defect("far_apart"), "far_tight", "--integrator dop853:stages=plain --tolerance 1e-12");
  CHECK(tight.exit == 0);
  for (const std::string method : {"dop853:stages=manifold", "dopri5:stages=manifold"}) {
    const Called ran = run(defect("far_apart"), "far_apart", "--tolerance 1e-8 --integrator " + method);
    INFO(ran.text);
    REQUIRE(ran.exit == 0);
    CHECK(largest_difference(table_of("far_apart"), table_of("far_tight")) < 1e-9);
    doubted += contains(ran.text, kDoubtfulTolerance) ? 1 : 0;
  }
  CHECK(doubted == 0);
}

// The dense solver at 1e-11 is the truth. Moments about z of the hinge with that axis are rounding.
TEST_CASE("no doubt of reactions of Bennett's linkage that all solvers agree on", "[runner]") {
  const std::string scene = with_reactions("overconstrained/bennett.json", "bennett_reactions", ".force_on_p_world_");
  const std::string span = "--until 2 --set run.output=0.05 --integrator dop853 ";
  const Called tight = run(scene, "bennett_tight", span + "--solver dense --tolerance 1e-11");
  CHECK(tight.exit == 0);
  int doubted = 0;
  for (const std::string solver : {"schur", "dense", "sparse"}) {
    const Called ran = run(scene, "bennett", span + "--tolerance 1e-6 --solver " + solver);
    INFO(solver << ":\n" << ran.text);
    REQUIRE(ran.exit == 0);
    CHECK(largest_difference(table_of("bennett"), table_of("bennett_tight")) < 1e-3);
    doubted += contains(ran.text, kDoubtfulReactions) ? 1 : 0;
  }
  CHECK(doubted == 0);
}

TEST_CASE("no doubt of reactions of Andrews' mechanism that are right to a thousandth", "[runner]") {
  const std::string scene = with_reactions("andrews_ivp.json", "andrews_reactions", ".force_on_p_world_");
  const Called tight = run(scene, "andrews_tight", "--integrator dop853 --tolerance 1e-10");
  const Called ran = run(scene, "andrews", "--integrator dopri5 --tolerance 1e-4");
  INFO(ran.text);
  REQUIRE((tight.exit == 0 && ran.exit == 0));
  CHECK(largest_difference(table_of("andrews"), table_of("andrews_tight")) < 2e-3);
  CHECK_FALSE(contains(ran.text, kDoubtfulReactions));
}

// In space it has one freedom, as the formulation joint knows.
TEST_CASE("a body that may slide along the plane's normal is not said to be fixed", "[defect][one idea]") {
  const std::string scene = quoted(scene_file("normal_slide", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "G", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "z"}],
    "run": {"until": 0.1, "output": 0.1, "record": ["b.z"]})"));
  CHECK(!contains(run(scene, "normal_slide").text, "no freedom is left"));
  CHECK(contains(call("check " + scene + " --planar off").text, "degrees of freedom  1"));
  int said = 0;
  for (const std::string method : {"dopri5 --formulation omega", "radau5"}) {
    const Called ran = run(scene, "normal_slide", "--integrator " + method);
    INFO(ran.text);
    CHECK(ran.exit == 0);
    said += contains(ran.text, "no freedom is left: nothing can move") ? 1 : 0;
  }
  expect_defect("no freedom is left", kOneIdea, said > 0, said == 0);
}

TEST_CASE("a plane takes what is at rest but for rounding", "[defect][one idea]") {
  const auto scene = [](const std::string& name, const std::string& velocity) {
    return quoted(scene_file(name, R"("gravity": [0, -9.81, 0], "planar": "z",
      "bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}, "velocity": [0, 0, )" +
                                       velocity +
                                       R"(]}],
      "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0]}],
      "run": {"until": 0.1, "output": 0.1, "record": ["b.x"]})"));
  };
  CHECK(run(scene("plane_at_rest", "0"), "plane_at_rest").exit == 0);
  CHECK(run(scene("plane_left", "1e-3"), "plane_left").exit == 3);  // so much leaves it
  const Called ran = run(scene("plane_rounding", "2.3e-16"), "plane_rounding");
  INFO(ran.text);
  expect_defect("planar: at rest but for rounding", kOneIdea,
                ran.exit == 3 && contains(ran.text, "2.3e-16 m/s along the normal"), ran.exit == 0);
}

// Upright, a rod of length l falls by 3 g / (2 l) of its angle; the rod's radius is a fiftieth of its length.
TEST_CASE("the softest stiffness of an unstable equilibrium is that of what grows", "[defect][one idea]") {
  const std::string scene = quoted(scene_file("upright", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0, 0.5, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0]}])"));
  const double stiffness = -kG * 0.25 / (0.25 * (1.0 / 3 + 1e-4));
  const Called called = call("statics " + scene + " --nearest --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const Json result = Json::parse(called.text);
  REQUIRE(result["stability"] == "unstable");
  CHECK(result["unstable"][0]["stiffness"].get<double>() == Approx(stiffness));
  const double softest = result["softest"];
  expect_defect("softest of an unstable equilibrium", kOneIdea, softest == 0,
                std::abs(softest - stiffness) < 1e-6 * std::abs(stiffness));
}

// Those that come beside their flat position made 100 to 200 at this tolerance, and a thousand at 1e-10.
TEST_CASE("copies in lanes pass singular positions in as many steps as alone", "[defect]") {
  const std::string sweep =
      "sweep " + quoted(std::string(paths::kSource) + "/tests/verification/scenes/parallelogram.json") +
      " --vary bodies.bar.rod.mass=0.666:0.668:16 --tolerance 1e-7 --jobs 1 --until 0.71 --set run.max_steps=1000 ";
  const Called lanes = call(sweep + "--record lanes.csv"), alone = call(sweep + "--lanes off --record alone.csv");
  INFO(lanes.text << alone.text);
  REQUIRE((lanes.exit == 0 && alone.exit == 0));
  CHECK(contains(lanes.text, "in vector lanes"));
  const auto most = [](const std::string& csv) {
    std::ifstream file(kRunnerFolder + "/" + csv);
    std::string header, row;
    std::getline(file, header);
    const auto column = std::count(header.begin(), header.begin() + static_cast<long>(header.find(",steps,")), ',') + 1;
    long steps = 0;
    int rows = 0;
    for (; std::getline(file, row); ++rows) {
      std::size_t at = 0;
      for (long k = 0; k < column; ++k) at = row.find(',', at) + 1;
      steps = std::max(steps, std::stol(row.substr(at)));
    }
    CHECK(rows == 16);
    return steps;
  };
  const long in_lanes = most("lanes.csv"), single = most("alone.csv");
  CAPTURE(in_lanes, single);
  CHECK(single < 60);
  CHECK(in_lanes <= 2 * single);
}

// To 0.71 s, beyond the first flat position, about 20 steps are enough; a run that ends 1.5e-4 rad behind it crept.
TEST_CASE("a run that ends beside a flat position makes no more steps than one that passes it", "[defect]") {
  const std::string scene = quoted(std::string(paths::kSource) + "/tests/verification/scenes/parallelogram.json");
  const auto steps_to = [&](const std::string& until, const std::string& tolerance) {
    const Called ran = run(scene, "beside_flat",
                           "--json --set bodies.bar.rod.mass=0.6666666666666666 " +
                               ("--set run.max_steps=200 --until " + until) + " --tolerance " + tolerance);
    INFO(ran.text);
    if (contains(ran.text, "has made its 200 steps")) return 200L;
    REQUIRE(ran.exit == 0);
    return Json::parse(ran.text)["steps"].get<long>();
  };
  long beside = 0, beyond = 0;
  for (const std::string tolerance : {"1e-10", "3e-11"})
    beside = std::max(beside, steps_to("0.7", tolerance)), beyond = std::max(beyond, steps_to("0.71", tolerance));
  CAPTURE(beside, beyond);
  CHECK(beyond < 60);
  CHECK(beside <= 60);
}

// A crank of 18 mm in place of 15 mm: at 171 degrees the legs are drawn straight.
TEST_CASE("a mechanism that locks names its crank and the loop that cannot follow", "[defect][plain words]") {
  const Called ran = run(defect("locks_jansen"), "locks_jansen");
  INFO(ran.text);
  CHECK(ran.exit == 6);
  CHECK(contains(ran.text, "12 rows up to there"));
  const bool two_laws = contains(ran.text, "two laws may drive one coordinate");
  expect_defect("locks", kPlainWords, two_laws && contains(ran.text, "link 'A'"),
                !two_laws && contains(ran.text, "'A'") && contains(ran.text, "loop"));
}

// A scene in millimetres with gravity to match, and 1000 kg m^2 on 1 kg at half a metre: 9810 m/s^2 and a radius of
// gyration of 32 m.
TEST_CASE("numbers that no machine has are named", "[defect][plain words]") {
  const Called checked = call("check " + defect("implausible")), ran = run(defect("implausible"), "implausible");
  INFO(checked.text << ran.text);
  CHECK((checked.exit == 0 && ran.exit == 0));
  CHECK(table_of("implausible").n_rows() == 11);
  const auto warned = [](const Called& called) {
    return contains(called.text, "gravity") && contains(called.text, "gyration");
  };
  const auto silent = [](const Called& called) { return !contains(called.text, "warning"); };
  expect_defect("implausible", kPlainWords, silent(checked) && silent(ran), warned(checked) && warned(ran));
}

TEST_CASE("a line of progress fits a terminal of 40 columns", "[defect][a small program]") {
  std::size_t longest = 0;
  for (const double t : {0.5, 12.34, 99.0}) longest = std::max(longest, progress_line(t, 100, 30, 39).size());
  CHECK(progress_line(12.34, 100, 30, 79).size() <= 79);
  CHECK(contains(progress_line(12.34, 100, 30, 79), "to go"));
  CAPTURE(longest);
  expect_defect("a progress bar in 40 columns", kSmallProgram, longest > 39,
                longest <= 39 && contains(progress_line(12.34, 100, 30, 39), "to go"));
}

TEST_CASE("a run that fails with --json gives its error once", "[defect][a small program]") {
  const Called ran = run(defect("locks_jansen"), "failed_once", "--json");
  INFO(ran.text);
  CHECK(ran.exit == 6);
  const std::size_t json = ran.text.find("{\n");
  REQUIRE(json != std::string::npos);
  const Json result = Json::parse(ran.text.substr(json));
  CHECK(result["status"] == "failed");
  const std::string error = result["error"];
  REQUIRE(error.size() > 20);
  const bool twice = contains(ran.text.substr(0, json), error.substr(0, 40));
  expect_defect("the doubled error of --json", kSmallProgram, twice, !twice);
}

// Twenty rows fall on the zeros of 0.3 sin(20 pi t). The motor's peak, over all the motion, is at the swing's ends:
// J (20 pi)^2 0.3 + m g l / 2 cos 0.3, J about the end of a rod whose radius is a fiftieth of its length.
TEST_CASE("extremes are those of the motion, not of its rows", "[defect][answers]") {
  const double rate = 20 * kPi, peak = (1.0 / 3 + 1e-4) * rate * rate * 0.3 + 0.5 * kG * std::cos(0.3);
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
  const Called inverse = call("inverse " + scene + " --record inverse_peak.csv");
  const std::string word = "peak ";
  REQUIRE(contains(inverse.text, word));
  const double by_laws = std::abs(std::stod(inverse.text.substr(inverse.text.find(word) + word.size())));
  CAPTURE(peak, most, by_laws, inverse.text);
  expect_defect("peak_between_rows", kAnswers, std::abs(most - 4.905) < 1e-3 && std::abs(by_laws - 4.905) < 1e-3,
                std::abs(most / peak - 1) < 1e-2 && std::abs(by_laws / peak - 1) < 1e-2);
}

}  // namespace open_defects_program_test
