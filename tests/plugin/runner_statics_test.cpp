// SPDX-License-Identifier: BSD-3-Clause
// The command statics, as a person calls it.
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

namespace runner_statics_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::json;

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
  const Called free = call(door);
  INFO(free.text);
  CHECK(free.exit == 0);
  CHECK(row_of(free.text, "high").ends_with("left out"));
  CHECK(row_of(free.text, "low").ends_with("not unique"));
  CHECK(says(free.text, {"reactions-not-unique: ", "nearly-redundant: "}));
  CHECK_FALSE(contains(free.text, "grows"));  // it is neutral
}

// A rod of 2 kg hangs with 20 N. Held level by a drive it takes 10 N m, whatever the acceleration of its law is.
TEST_CASE("runner: statics computes columns, and judges requirements", "[plugin][runner]") {
  const auto rod = [](const std::string& to, const std::string& more) {
    return scene_file("rod_at_rest.json", R"("gravity": [0, -10, 0], "parameters": {"m": 2},
    "bodies": [{"name": "rod", "rod": {"mass": "=m", "from": [0, 0, 0], "to": )" +
                                              to + R"(}}],
    "joints": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0])" +
                                              more);
  };
  const std::string hanging = "statics " + rod("[0, -1, 0]", R"json(}],
    "require": [{"hinge": "=norm(A.force_on_p_world) < 5 N"}, "=max(A.rz) < 1 rad"], "run": {"until": 1, "draw": [["F"],
    ["A.rz_d"]], "record": [{"F": "=norm(A.force_on_p_world)"},
    {"share": "=F/(50 N)"}, {"mean": "=mean(F)"}, "A.rz_d"]})json");
  const Called one = call(hanging);
  INFO(one.text);
  CHECK(one.exit == 9);
  CHECK(row_of(one.text, "F") == "F 20 N");
  CHECK(row_of(one.text, "share") == "share 0.4");
  CHECK(says(one.text, {"column \"mean\" has no value at rest: it is a function of the motion",
                        "requirement-broken: requirement \"hinge\" (norm(A.force_on_p_world) < 5 N) does not hold "
                        "by 15 N; change the mechanism"}));
  CHECK(call(hanging + " --set m=0.4").exit == 0);
  const Called path = call(hanging + " --vary m=0.4,2 --record loads.csv");
  CHECK(path.exit == 9);
  CHECK(contains(path.text, "note: not drawn: \"A.rz_d\" is no column at rest"));
  const auto& [table, statuses] = varied("loads.csv");
  CHECK(table["F"][0] == Approx(4));
  CHECK(table["share"][1] == Approx(0.4));
  CHECK(statuses[0] == "ok");
  CHECK(contains(statuses[1], "does not hold by 15 N"));
  CHECK(call(hanging + " --all 5").exit == 9);
  const Called held =
      call("statics " + rod("[1, 0, 0]", R"json(, "drive": {"axis": "rz", "law": {"type": "polynomial", "coefficients":
    [0, 0, 50]}}}], "run": {"until": 1, "record": [{"M": "=A.drive.torque_on_p_link_z"}, {"a": "=norm(rod.a)"}]})json"));
  INFO(held.text);
  CHECK(row_of(held.text, "M") == "M 10 N m");
  CHECK(row_of(held.text, "a") == "a 0 m/s^2");
  }

TEST_CASE("runner: statics names what nothing holds", "[plugin][runner]") {
  const std::string scene = scene_file("falls.json", R"("gravity": [0, -10, 0],
    "bodies": [{"name": "crate", "mass": 1, "inertia": [0.1, 0.1, 0.1]}], "run": {"until": 1})");
  const Called called = call("statics " + scene);
  CHECK(called.exit == 6);
  CHECK(contains(called.text, "'crate' moves along -y, and nothing holds it"));
}

TEST_CASE("runner: statics rejects --nearest with --all", "[plugin][runner]") {
  const Called called = call("statics " + sample("rod_pendulum") + " --all 3 --nearest");
  CHECK(called.exit == 2);
  CHECK(contains(called.text, "--nearest"));
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
  CHECK(row_of(held.text, "of") == "of against load limit unit");
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

}  // namespace runner_statics_test
