// SPDX-License-Identifier: BSD-3-Clause
// The verbs statics, kinematics, inverse and explain, and assemble --branches, as a person calls them.
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/worst.h"

namespace runner_analyses_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::json;

namespace {

std::string sample(const std::string& name) { return "'" + std::string(paths::kScenes) + "/" + name + ".json'"; }

Json json_of(const std::string& words) {
  const Called called = call(words);
  INFO(called.text);
  REQUIRE(called.exit == 0);
  return Json::parse(called.text);
}

// The last value, in rad, of a column of a document.
double last_of(const std::string& document, const std::string& column) {
  const Json all = Json::parse(document);
  for (const Json& c : all["columns"])
    if (c["name"] == column && c["unit"] == "rad") return c["values"].back();
  FAIL("no column " << column << " in rad");
  return 0;
}

}  // namespace

TEST_CASE("runner: check counts degrees of freedom, redundant constraints and reactions", "[plugin][runner]") {
  const Json four_bar = json_of("check " + sample("four_bar") + " --full --json");
  CHECK(four_bar["rank"] == 18);
  CHECK(four_bar["redundant"] == 3);
  CHECK(four_bar["dependencies"].size() == 1);
  CHECK(four_bar["rows_not_unique"].size() == 12);
  const Called text = call("check " + sample("pendulum") + " --verbose");
  CHECK(text.exit == 0);
  CHECK(value_of(text.text, "degrees of freedom") == "1");
  CHECK_FALSE(value_of(text.text, "rank").empty());
  CHECK(value_of(text.text, "redundant constraints") == "0");
  CHECK(value_of(text.text, "reactions") == "all are unique");
  const Called door = call("check '" + std::string(paths::kSource) + "/tests/stability/scenes/door.json' --verbose");
  CHECK(says(door.text, {"reactions not unique",
                         "1 of low y e1; high y e1 is nearly redundant (relative singular value "
                         "6.9e-08"}));
  CHECK(row_of(door.text, "low y e1; high y e1") == "low y e1; high y e1 1 1");  // one redundant, one nearly
  CHECK(value_of(door.text, "reactions").empty());
  const Called flat = call("check --verbose " + sample("slider_crank"));
  CHECK(value_of(flat.text, "plane") == "normal z; out-of-plane constraints are not counted (--full counts them)");
  const Called old_name = call("mobility " + sample("pendulum"));
  CHECK(contains(old_name.text, text.text));
  CHECK(contains(old_name.text, "warning: `lockstep mobility` is now `lockstep check --verbose`"));
}

TEST_CASE("runner: statics prints poses, reactions and stability", "[plugin][runner]") {
  const Json j = json_of("statics " + sample("rod_pendulum") + " --json");
  CHECK(j["stability"] == "stable");
  CHECK(j["freedoms"] == 1);
  CHECK(j["unbalanced"].get<double>() <= 1e-10);
  CHECK(j["reactions"].size() == 1);
  const Called words = call("statics " + sample("double_pendulum"));
  CHECK(words.exit == 0);
  CHECK(contains(words.text, "Newton's method"));
  CHECK(value_of(words.text, "stability") == "stable");
  CHECK(value_of(words.text, "remaining degrees of freedom") == "2");
  CHECK(contains(value_of(words.text, "lowest natural frequency"), " Hz ("));
  const Json all = json_of("statics " + sample("rod_pendulum") + " --all 20 --json");
  REQUIRE(all["equilibria"].size() == 2);
  CHECK(all["equilibria"][0]["stability"] == "stable");
  CHECK(all["equilibria"][1]["stability"] == "unstable");
  CHECK(all["equilibria"][1]["growth_time"].get<double>() > 0);
  const Called overview = call("statics " + sample("rod_pendulum") + " --all 20");
  INFO(overview.text);
  CHECK(row_of(overview.text, "nr").starts_with("nr stability lowest frequency [Hz] growth time constant [s] "));
  CHECK(row_of(overview.text, "1").starts_with("1 stable 0.610521 "));
  CHECK(row_of(overview.text, "2").starts_with("2 unstable 0."));
  CHECK_FALSE(contains(overview.text, "reactions at P"));
  const Called places = call("statics " + sample("rod_pendulum") + " --all 20 --set run.record.0.phi=rod.y");
  CHECK(says(places.text, {"phi -0.5 m", "phi 0.5 m"}));  // recorded positions are listed
  const Called listed = call("statics " + sample("rod_pendulum") + " --all 20 --verbose");
  CHECK(value_of(listed.text, "starts") == "20 random ones, and the given one; there may be more equilibria");
  CHECK(says(listed.text, {"starts that lead here", "without damping"}));
  CHECK(value_of(listed.text, "fastest growth").starts_with("time constant 0."));
  CHECK(call("statics " + sample("rod_pendulum") + " --all 20 -v").text == listed.text);
  check_refused(call("statics " + sample("rod_pendulum") + " --all some"), 2,
                {"--all: \"some\" is not a whole number from 1 to 1000000"});
  const Called standing = call("statics " + sample("rod_pendulum") + " --nearest --at 0.5 --json");
  CHECK(standing.exit == 0);
}

// Two rods of 1 m on a slider: mirrored positions differ in no recorded quantity, and folded rods rotate freely about A.
TEST_CASE("runner: statics --all shows what differs, moves from the given start, and a family as one",
          "[plugin][runner]") {
  const std::string path = scene_file("toggle", R"("gravity": [0, 0, 0],
    "bodies": [{"name": "left", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.8, 0.6, 0]}},
               {"name": "right", "rod": {"mass": 1, "from": [0.8, 0.6, 0], "to": [1.6, 0, 0]}},
               {"name": "slider", "sphere": {"mass": 1, "radius": 0.05}, "position": [1.6, 0, 0]}],
    "joints": [{"name": "A", "type": "revolute", "p": "left", "s": "ground", "at": [0, 0, 0]},
               {"name": "B", "type": "revolute", "p": "right", "s": "left", "at": [0.8, 0.6, 0]},
               {"name": "C", "type": "revolute", "p": "slider", "s": "right", "at": [1.6, 0, 0]},
               {"name": "D", "type": "prismatic", "p": "slider", "s": "ground", "at": [1.6, 0, 0], "axis": "x"}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "slider", "s": "ground", "at_p": [1.6, 0, 0],
                "at_s": [3, 0, 0], "stiffness": 1000, "damping": 5, "free_length": 1.5}],
    "run": {"until": 2, "output": 0.01, "record": ["slider.x"]})");
  const Json all = json_of("statics '" + path + "' --all 60 --json")["equilibria"];
  int folded = 0;
  for (const Json& e : all) {
    const double x = e["bodies"]["slider"]["position"][0];
    folded += std::abs(x) < 1e-6 && e["stability"] == "neutral" ? 1 : 0;
    double most = 0;
    const std::map<std::string, std::array<double, 2>> start{
        {"left", {0.4, 0.3}}, {"right", {1.2, 0.3}}, {"slider", {1.6, 0}}};
    for (const auto& [name, at] : start) {
      const Json& to = e["bodies"][name]["position"];
      most = std::max(most, std::hypot(to[0].get<double>() - at[0], to[1].get<double>() - at[1]));
    }
    CHECK(e["largest_move"].get<double>() == Approx(most).margin(1e-9));
  }
  CHECK(folded == 1);
  const Called text = call("statics '" + path + "' --all 60");
  INFO(text.text);
  const std::string first = row_of(text.text, "1"), second = row_of(text.text, "2");
  CHECK(first.find("slider.x 1.5 m") != std::string::npos);
  CHECK(first.substr(first.find("slider.x")) != second.substr(second.find("slider.x")));
  CHECK(contains(first, ".y "));
}

namespace {

// A table of statics --vary, and the statuses of its rows; of failed rows the statuses alone.
std::pair<Table, std::vector<std::string>> varied(const std::string& name) {
  std::ifstream file(kRunnerFolder + "/" + name);
  std::string numbers;
  std::vector<std::string> statuses;
  for (std::string line; std::getline(file, line);) {
    const std::size_t last = line.find_last_of(',', line.find('"'));
    statuses.push_back(line.substr(last + 1));
    if (!contains(statuses.back(), "failed: ")) numbers += line.substr(0, last) + "\n";
  }
  REQUIRE((!statuses.empty() && statuses.front() == "status"));
  statuses.erase(statuses.begin());
  std::istringstream text(numbers);
  return {read_csv(text, name), statuses};
}

}  // namespace

// A mass on a spring hangs lower by m g/k: exact for every mass.
TEST_CASE("runner: statics --vary draws a path, one line per value", "[plugin][runner]") {
  const std::string scene = scene_file("hanging.json", R"("gravity": [0, -10, 0],
    "bodies": [{"name": "load", "mass": 1, "inertia": [0.1, 0.1, 0.1], "position": [0, -1, 0]}],
    "links": [{"name": "guide", "type": "prismatic", "p": "load", "s": "ground", "at": [0, -1, 0], "axis": "y"}],
    "markers": [{"name": "hook", "body": "load", "at": [0, 0, 0]}, {"name": "top", "body": "ground", "at": [0, 0, 0]}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "hook", "s": "top", "stiffness": 100,
                "free_length": 1}], "run": {"until": 1})");
  const Called called = call("statics " + scene + " --vary bodies.load.mass=1:4:4 --record path.csv");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  CHECK_FALSE(contains(called.text, "warning"));
  const auto& [table, statuses] = varied("path.csv");
  REQUIRE(table.n_rows() == 4);
  CHECK(statuses == std::vector<std::string>(4, "ok"));
  for (std::size_t i = 0; i < 4; ++i) {
    const double mass = table["bodies.load.mass"][i];
    CHECK(table["spring.force"][i] == Approx(10 * mass));
    CHECK(table["load.qx"][i] == 0);
    CHECK(mass == static_cast<double>(i + 1));
    CHECK(std::abs(table["load.y"][i] + 1 + mass * 10 / 100) <= 1e-11);
    CHECK(table["stable"][i] == 1);
    CHECK(std::abs(table["lowest_eigenvalue"][i] - 100 / mass) <= 1e-7);
  }
  // Rows of a run that was broken off are no result, and a table stays where no value has an equilibrium.
  std::ofstream(kRunnerFolder + "/path.csv.partial") << "stale\n";
  const std::string four_bar = "statics " + sample("four_bar") + " --vary crank=10,11 --record path.csv";
  CHECK(call(four_bar).exit != 0);
  CHECK(varied("path.csv").second.size() == 4);
  check_refused(call("statics " + scene + " --vary bodies.load.mass=1:4:4 --json"), 2,
                {"--json: with --vary the result is CSV"});
  // A failed value is a row, the first one too.
  CHECK(call("statics " + scene + " --vary bodies.load.mass=-1,1 --record failed.csv").exit == 1);
  const auto& [rest, ends] = varied("failed.csv");
  CHECK(rest.n_rows() == 1);
  REQUIRE(ends.size() == 2);
  CHECK(contains(ends[0], "failed: "));
  CHECK(ends[1] == "ok");
  const Called shown = call("statics " + scene + " --vary bodies.load.mass=1");
  CHECK(contains(shown.text, ",spring.force [N],status\n"));
  CHECK_FALSE(contains(shown.text, "load.qx"));
  const Called one = call("statics " + scene);
  CHECK(row_of(one.text, "spring.force") == "spring.force 10 N");
  CHECK(row_of(one.text, "spring.length") == "spring.length 1.1 m");
}

// A lever on a spring falls through if the spring is soft, and stays below.
TEST_CASE("runner: statics --vary reports another branch, and begins each line of a grid at the start",
          "[plugin][runner]") {
  const std::string lever =
      scene_file("lever.json", R"("gravity": [0, -9.81, 0], "parameters": {"k": 2000, "load": 100},
    "bodies": [{"name": "lever", "rod": {"mass": 4, "from": [0, 0, 0], "to": [0.8, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "lever", "s": "ground", "at": [0, 0, 0]}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "lever", "s": "ground", "at_p": [0.6, 0, 0],
                "at_s": [0.6, -0.4, 0], "stiffness": "=k", "free_length": 0.45},
               {"name": "push", "type": "applied_force", "p": "lever", "at_p": [0.8, 0, 0], "force": [0, "=-load", 0]}],
    "run": {"until": 1, "record": ["A.rz"]})");
  const Called path = call("statics " + lever + " --vary k=2000,500,2000 --record branches.csv");
  INFO(path.text);
  CHECK(path.exit == 0);
  CHECK(contains(path.text, "warning: k = 500: another branch: 'lever' moved by "));
  const auto& [table, statuses] = varied("branches.csv");
  REQUIRE(statuses.size() == 3);
  CHECK(statuses[0] == "ok");
  CHECK(statuses[1].starts_with("another branch: "));
  CHECK(table["A.rz"][2] < table["A.rz"][0] - 0.5);  // it stays there
  CHECK(call("statics " + lever + " --vary load=100,50 --vary k=2000,500 --record grid.csv").exit == 0);
  const auto& [grid, ends] = varied("grid.csv");
  REQUIRE(grid.n_rows() == 4);
  CHECK(grid["A.rz"][2] > grid["A.rz"][0]);  // less load on the stiff spring again
  CHECK(ends[2] == "ok");
}

TEST_CASE("runner: statics marks reactions that are not unique, and lists joints that are left out",
          "[plugin][runner]") {
  const std::string door = "statics '" + std::string(paths::kSource) + "/tests/stability/scenes/door.json' ";
  const Called free = call(door + "--nearly-redundant free");
  INFO(free.text);
  CHECK(free.exit == 0);
  CHECK(row_of(free.text, "high").ends_with("left out"));
  CHECK(row_of(free.text, "low").ends_with("not unique"));
  CHECK(says(free.text, {"reactions-not-unique: ", "nearly-redundant: "}));
  CHECK_FALSE(contains(free.text, "grows"));  // it is neutral
}

TEST_CASE("runner: statics names what nothing holds", "[plugin][runner]") {
  const std::string scene = scene_file("falls.json", R"("gravity": [0, -10, 0],
    "bodies": [{"name": "crate", "mass": 1, "inertia": [0.1, 0.1, 0.1]}], "run": {"until": 1})");
  const Called called = call("statics " + scene);
  CHECK(called.exit == 6);
  CHECK(contains(called.text, "'crate' moves along -y, and nothing holds it"));
}

// What a run integrates, the laws alone give.
TEST_CASE("runner: kinematics and inverse write what a run writes", "[plugin][runner]") {
  REQUIRE(call("run " + sample("four_bar") + " --quiet --record by_run.csv").exit == 0);
  REQUIRE(call("kinematics " + sample("four_bar") + " --record by_kinematics.csv").exit == 0);
  REQUIRE(call("inverse " + sample("four_bar") + " --record by_inverse.csv").exit == 0);
  const Table run = read_csv(kRunnerFolder + "/by_run.csv"),
              kinematics = read_csv(kRunnerFolder + "/by_kinematics.csv"),
              inverse = read_csv(kRunnerFolder + "/by_inverse.csv");
  REQUIRE(kinematics.n_rows() == run.n_rows());
  REQUIRE(inverse.n_rows() == run.n_rows());
  for (const Column& c : run.columns()) {
    CAPTURE(c.name);
    double size = 1, error = 0;
    for (std::size_t i = 0; i < run.n_rows(); ++i) {
      keep_worst(size, std::abs(c.values[i]));
      for (const Table* other : {&kinematics, &inverse}) keep_worst(error, std::abs((*other)[c.name][i] - c.values[i]));
    }
    CHECK(error <= 1e-7 * size);
  }
  CHECK(inverse.has("A.drive_rz.torque_on_p_link_z"));
  CHECK(inverse.has("D.torque_on_p_world_z"));
  CHECK(inverse["A.force_on_p_world_x"].back() == inverse["Ax"].back());  // recorded under another name
  for (std::size_t i = 0; i < inverse.n_rows(); ++i)
    CHECK(inverse["A.drive_rz.torque_on_p_link_z"][i] == inverse["drive_torque"][i]);
}

// An angle about x has no value where the crank has turned by half a turn about z; only a column reads it.
TEST_CASE("runner: a recorded angle without a value ends neither kinematics nor inverse", "[plugin][runner]") {
  const std::string scene = scene_file("turned", R"("bodies": [{"name": "crank", "rod": {"mass": 1, "from": [0, 0, 0],
      "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0],
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 3}}}],
    "run": {"until": 2, "output": 0.25, "record": ["A.rz", "crank.angle_x"]})");
  for (const std::string verb : {"kinematics ", "inverse "}) {
    const Called r = call(verb + scene + " --record turned.csv");
    INFO(r.text);
    CHECK(r.exit == 0);
    const Table table = read_csv(kRunnerFolder + "/turned.csv");
    REQUIRE(table.n_rows() == 9);
    CHECK(table["A.rz"].back() == Approx(6));
  }
}

// Two hinges whose axes are nearly one: nothing is redundant, and nothing is shared.
TEST_CASE("runner: explain does not call nearly dependent constraints redundant", "[plugin][runner]") {
  const Called r = call("explain '" + std::string(paths::kSource) +
                        "/tests/stability/scenes/flat_cranks.json' A --set before=1e-3 --json");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(Json::parse(r.text)["dependencies"].empty());
}

TEST_CASE("runner: explain names the command that lists reactions that are not unique", "[plugin][runner]") {
  const Called r = call("explain '" + std::string(paths::kSource) +
                        "/tests/stability/scenes/door.json' low --set links.high.at.0=0");
  INFO(r.text);
  CHECK(contains(r.text, "; lockstep check --verbose lists them"));
}

TEST_CASE("runner: kinematics needs no masses, and rejects too few drives", "[plugin][runner]") {
  const std::string members = R"("bodies": [{"name": "arm"}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": "z",
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 2}}}],
    "run": {"until": 1, "output": 0.25, "record": [)";
  const Called moves = call("kinematics " + scene_file("massless.json", members + R"("arm.angle_z"]})") + " --json");
  INFO(moves.text);
  REQUIRE(moves.exit == 0);
  CHECK(std::abs(last_of(moves.text, "arm.angle_z") - 2) <= 1e-12);
  const Called forces =
      call("kinematics " + scene_file("massless_force.json", members + R"("A.force_on_p_world_x"]})"));
  CHECK(forces.exit == 3);
  CHECK(contains(forces.text, "depends on masses, and arm has none"));
  std::string inert = members;
  inert.replace(inert.find(R"("arm")"), 5, R"("arm", "inertia": [1, 2, 3])");
  CHECK(call("kinematics " + scene_file("inert.json", inert + R"("arm.angle_z"]})")).exit == 0);
  const Called few = call("kinematics " + sample("double_pendulum"));
  CHECK(few.exit == 3);
  CHECK(contains(few.text, "2 free motions are not driven"));
  CHECK(contains(few.text, "Drive "));
}

// Words that depend on masses count in what follows the name of a thing alone.
TEST_CASE("runner: kinematics takes the names of bodies for no quantities", "[plugin][runner]") {
  const std::string members = R"("bodies": [{"name": "mass_c"}, {"name": "force_b"}],
    "links": [{"name": "A", "type": "revolute", "p": "mass_c", "s": "ground", "at": [0, 0, 0], "axis": "z",
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 2}}},
              {"name": "B", "type": "revolute", "p": "force_b", "s": "ground", "at": [0, 0, 0], "axis": "z",
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 3}}}],
    "run": {"until": 1, "output": 0.25, "record": [)";
  const Called moves =
      call("kinematics " + scene_file("mass_c.json", members + R"("mass_c.x", "force_b.angle_z"]})") + " --json");
  INFO(moves.text);
  REQUIRE(moves.exit == 0);
  CHECK(std::abs(last_of(moves.text, "force_b.angle_z") - 3) <= 1e-12);
  const Called forces = call("kinematics " + scene_file("mass_c_force.json", members + R"("A.force_on_p_world_x"]})"));
  CHECK(forces.exit == 3);
  CHECK(contains(forces.text, "\"A.force_on_p_world_x\" depends on masses"));
}

TEST_CASE("runner: kinematics and inverse report what assembly moved, and print no columns of zeros",
          "[plugin][runner]") {
  const std::string turned = scene_file("begins_turned", kArm + R"("links": [{)" + kHinge + R"(,
    "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1, "y0": 0.5}}}], "run": {"until": 1, "record": ["A.rz"]})");
  const Called kinematics = call("kinematics " + turned);
  INFO(kinematics.text);
  CHECK(contains(value_of(kinematics.text, "assembled"), "rotated 'arm' by 0.5 rad"));
  const Called inverse = call("inverse " + sample("four_bar") + " --until 0.1 --record zeros.csv");
  INFO(inverse.text);
  CHECK_FALSE(row_of(inverse.text, "drive_torque").empty());
  CHECK(row_of(inverse.text, "theta_dd").empty());
  CHECK(row_of(inverse.text, "t").empty());
  CHECK(contains(call("inverse " + sample("four_bar") + " --until 0.1 --record zeros.csv --json").text, "theta_dd"));
}

TEST_CASE("runner: kinematics reports the effect of a long interval between poses", "[plugin][runner]") {
  const Called ends = call("kinematics " + sample("four_bar") + " --until 0.1 --output 0.2 --record ends.csv");
  CHECK(ends.exit == 0);
  CHECK(contains(ends.text, "only start and end are computed"));
  const Table table = read_csv(kRunnerFolder + "/ends.csv");
  REQUIRE(table.n_rows() == 2);
  CHECK(table.columns().front().values.back() == 0.1);
  const Called many = call("kinematics " + sample("four_bar") + " --until 1 --output 1e-12");
  CHECK(many.exit == 2);
  CHECK(contains(many.text, "--output"));
  CHECK(contains(many.text, "1e+12 rows"));
}

TEST_CASE("runner: the instant 0 of --at may be written as any other", "[plugin][runner]") {
  for (const std::string verb : {"statics", "explain", "matrices"})
    for (const std::string at : {"0", "0.0", "'0 s'", "0s"}) {
      const Called called = call(verb + " " + sample("four_bar") + " --at " + at);
      CAPTURE(verb, at, called.text);
      CHECK(called.exit == 0);
    }
  for (const std::string verb : {"statics", "explain", "matrices"}) {
    const Called before = call(verb + " " + sample("four_bar") + " --at=-1");
    CAPTURE(verb, before.text);
    CHECK(before.exit == 2);
    CHECK(contains(before.text, "it must be 0 or greater"));
  }
}

TEST_CASE("runner: statics rejects --nearest with --all", "[plugin][runner]") {
  const Called called = call("statics " + sample("rod_pendulum") + " --all 3 --nearest");
  CHECK(called.exit == 2);
  CHECK(contains(called.text, "--nearest"));
}

TEST_CASE("runner: explain sums up what acts on a body", "[plugin][runner]") {
  const Json j = json_of("explain " + sample("four_bar") + " coupler --at 0.1 --json");
  CHECK(j["body"] == "coupler");
  CHECK(j["parts"].size() == 3);  // gravity, B, C
  for (int k = 0; k < 2; ++k) {
    double sum = 0;
    for (const Json& part : j["parts"]) sum += part["force"][k].get<double>();
    CHECK(std::abs(sum - 1.2 * j["acceleration"][k].get<double>()) <= 1e-9);
  }
  const Called link = call("explain " + sample("four_bar") + " A --planar off");
  INFO(link.text);
  CHECK(link.exit == 0);
  CHECK(row_of(link.text, "of") == "of unit value rate [per s] second derivative [per s^2]");
  CHECK(row_of(link.text, "drive rz") == "drive rz rad [0] [10] [0]");
  CHECK(row_of(link.text, "axes of S, world") == "axes of S, world x = [1, 0, 0], y = [0, 1, 0], z = [0, 0, 1]");
  CHECK(row_of(link.text, "constraint") == "constraint force [N] moment [N m] value rate units driven");
  CHECK(row_of(link.text, "x").starts_with("x ["));
  CHECK(row_of(link.text, "x").ends_with(" m, m/s"));
  CHECK(row_of(link.text, "e1").ends_with(" 1, 1/s"));
  CHECK(row_of(link.text, "constraints") == "constraints redundant nearly redundant");
  CHECK(contains(link.text, "D z e1 e2  3 "));
  const Called unknown = call("explain " + sample("four_bar") + " couplr");
  CHECK(unknown.exit == 2);
  CHECK(contains(unknown.text, "did you mean \"coupler\"?"));
}

TEST_CASE("runner: explain gives the laws and powers of a force", "[plugin][runner]") {
  const std::string scene = "'" + scene_file("force_by_law", R"(
    "bodies": [{"name": "m", "particle": 2, "velocity": [3, 0, 0]}],
    "forces": [{"name": "push", "type": "applied_force", "p": "m", "direction": [2, 0, 0],
                "law": {"type": "sine", "amplitude": 5, "omega": 4}}],
    "run": {"until": 1})") + "'";
  const Json j = json_of("explain " + scene + " push --at 0.3 --json");
  const double s = std::sin(1.2), c = std::cos(1.2);
  REQUIRE(j["laws"].size() == 1);
  CHECK(j["laws"][0]["what"] == "law");
  CHECK(j["laws"][0]["unit"] == "N");
  CHECK(std::abs(j["laws"][0]["value"][0].get<double>() - 5 * s) < 1e-12);
  CHECK(std::abs(j["laws"][0]["rate"][0].get<double>() - 20 * c) < 1e-12);
  CHECK(std::abs(j["laws"][0]["second"][0].get<double>() + 80 * s) < 1e-11);
  CHECK(std::abs(j["on"][0]["force"][0].get<double>() - 5 * s) < 1e-12);
  const double v = 3 + 5.0 / 2 / 4 * (1 - c);  // m v' = 5 sin 4t
  CHECK(std::abs(j["supply"].get<double>() - 5 * s * v) < 1e-5);
  const Called words = call("explain " + scene + " push --at 0.3");
  CHECK(words.exit == 0);
  CHECK(value_of(words.text, "force") == "push");
  CHECK(value_of(words.text, "type") == "applied_force");
  CHECK(row_of(words.text, "law").starts_with("law N [4.66"));
  const std::string slide = scene_file("explained_slide", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "block", "mass": 2, "inertia": [1, 1, 1], "velocity": [3, 0, 0]}],
    "links": [{"name": "rail", "type": "prismatic", "p": "block", "s": "ground", "at": [0, 0, 0], "axis": "x",
               "friction": {"mu": 0.1}}])");
  const Json rubs = json_of("explain '" + slide + "' rail.friction --json");
  CHECK(rubs["dissipation"].get<double>() == Approx(0.1 * 2 * 9.81 * 3).epsilon(1e-6));
  const Called rail = call("explain '" + slide + "' rail");
  CHECK(row_of(rail.text, "rail.friction.friction_force").starts_with("rail.friction.friction_force -1.96"));
  CHECK_FALSE(contains(rail.text, "force of the drives"));
}

TEST_CASE("runner: explain shows the gap of a stop, and the length of a spring", "[plugin][runner]") {
  const std::string arm = "'" + scene_file("explained_stop", R"(
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0],
               "stops": [{"axis": "rz", "low": -0.5, "restitution": 0.25}]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "arm", "s": "ground", "at_p": [1, 0, 0],
                "at_s": [1, 2, 0], "stiffness": 5, "free_length": 1}])") +
                          "'";
  const Called stop = call("explain " + arm + " A.stop_rz_low");
  INFO(stop.text);
  CHECK(value_of(stop.text, "active") == "yes");
  CHECK(value_of(stop.text, "restitution") == "0.25");
  CHECK(value_of(stop.text, "state") == "open");
  CHECK(row_of(stop.text, "A.stop_rz_low.gap") == "A.stop_rz_low.gap 0.5 rad");
  const Called spring = call("explain " + arm + " k");
  INFO(spring.text);
  CHECK(row_of(spring.text, "k.length") == "k.length 2 m");
  CHECK(row_of(spring.text, "k.force") == "k.force 5 N");
}

TEST_CASE("runner: statics reports what friction holds, and what it does not", "[plugin][runner]") {
  const auto block = [](double mu) {
    return scene_file("slope_" + std::to_string(static_cast<int>(1000 * mu)),
                      R"("gravity": [0, 0, -9.81], "bodies": [{"name": "block", "mass": 3, "inertia": [1, 1, 1]}],
      "links": [{"name": "guide", "type": "prismatic", "p": "block", "s": "ground", "at": [0, 0, 0], "axis": [4, 0, -3]}],
      "forces": [{"name": "rub", "type": "joint_friction", "link": "guide", "mu": )" +
                          std::to_string(mu) + "}]");
  };
  const Called held = call("statics '" + block(0.8) + "'");
  INFO(held.text);
  CHECK(held.exit == 0);
  CHECK(value_of(held.text, "found by") == "the start, held by friction");
  CHECK(value_of(held.text, "stability") == "sticking");
  CHECK(row_of(held.text, "of") == "of motion load limit unit");
  CHECK(row_of(held.text, "rub") == "rub sliding 17.658 18.8352 N");
  const Json j = json_of("statics '" + block(0.8) + "' --json");
  CHECK(j["stability"] == "sticking");
  CHECK(j["by_friction"] == true);
  CHECK(j["friction"][0]["force"] == "rub");
  CHECK(j["friction"][0]["carries"].get<double>() == Approx(3 * 9.81 * 0.6).epsilon(1e-12));
  CHECK(j["friction"][0]["most"].get<double>() == Approx(0.8 * 3 * 9.81 * 0.8).epsilon(1e-6));
  CHECK(j["friction"][0]["unit"] == "N");
  const Called slides = call("statics '" + block(0.7) + "'");
  INFO(slides.text);
  CHECK(slides.exit != 0);
  CHECK(contains(slides.text, "'rub' (sliding) needs 17.658 N (limit 16.4808)"));
  const Called path = call("statics '" + block(0.8) + "' --set gravity.0=-7.3575 --vary bodies.block.mass=1,2");
  CHECK(path.exit == 0);
  CHECK(contains(path.text, "static friction is not considered"));
  // A short crank is not singular, whatever the masses are.
  const Called small = call("statics '" + scene_file("short_crank", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "crank", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.1, 0, 0]}},
               {"name": "coupler", "rod": {"mass": 1, "from": [0.1, 0, 0], "to": [4, 3, 0]}},
               {"name": "rocker", "rod": {"mass": 1, "from": [5, 0, 0], "to": [4, 3, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at": [0.1, 0, 0]},
              {"name": "C", "type": "revolute", "p": "coupler", "s": "rocker", "at": [4, 3, 0]},
              {"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": [5, 0, 0]}])") +
                            "'");
  INFO(small.text);
  CHECK(small.exit == 0);
  CHECK_FALSE(contains(small.text, "singular"));
  // In line with its rod a crank takes no load from the slider, whose friction then holds nothing.
  const Called centre = call("statics '" + scene_file("dead_centre", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "crank", "rod": {"mass": 2, "from": [0, 0, 0], "to": [0.08, 0, 0]}},
               {"name": "conrod", "rod": {"mass": 1, "from": [0.08, 0, 0], "to": [0.33, 0, 0]}},
               {"name": "piston", "sphere": {"mass": 1.5, "radius": 0.03}, "position": [0.33, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "conrod", "s": "crank", "at": [0.08, 0, 0]},
              {"name": "C", "type": "revolute", "p": "piston", "s": "conrod", "at": [0.33, 0, 0]},
              {"name": "D", "type": "prismatic", "p": "piston", "s": "ground", "at": [0.33, 0, 0], "axis": "x",
               "friction": {"mu": 0.1}}])") +
                             "'");
  INFO(centre.text);
  CHECK(centre.exit == 0);
  CHECK(contains(centre.text, "friction does not hold the start: no finite friction force balances the loads"));
  CHECK(row_of(centre.text, "piston").ends_with("[1, 0, 0, 0]"));
}

TEST_CASE("runner: assemble --branches finds elbow up and elbow down", "[plugin][runner]") {
  const Json j = json_of("assemble " + sample("four_bar") + " --branches 100 --json");
  CHECK(j["branches"].size() == 2);
  check_refused(call("assemble " + sample("four_bar") + " --branches none"), 2,
                {"--branches: \"none\" is not a whole number"});
  check_refused(call("assemble " + sample("double_pendulum") + " --branches 10"), 3,
                {"2 free motions are not driven", "Drive J1.rz and J2.rz"});
}

}  // namespace runner_analyses_test
