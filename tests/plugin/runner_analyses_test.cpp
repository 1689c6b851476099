// SPDX-License-Identifier: BSD-3-Clause
// The commands kinematics, inverse and explain, and assemble --branches, as a person calls them.
#include <cmath>
#include <fstream>
#include <string>

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
                         "1 of the constraints low and high (each y e1) is nearly redundant (relative singular value "
                         "5.4e-08"}));
  CHECK(row_of(door.text, "low and high (each y e1)") == "low and high (each y e1) 1 1");  // one redundant, one nearly
  CHECK(value_of(door.text, "reactions").empty());
  const Called flat = call("check --verbose " + sample("slider_crank"));
  CHECK(value_of(flat.text, "plane") ==
        "normal z; out-of-plane constraints and reactions are left out (--full counts them)");
}

// What a run integrates, the laws alone give.
TEST_CASE("runner: kinematics and inverse write what a run writes", "[plugin][runner]") {
  REQUIRE(call("run " + sample("four_bar") + " --quiet --record by_run.csv").exit == 0);
  REQUIRE(call("kinematics " + sample("four_bar") + " --record by_kinematics.csv").exit == 0);
  const Called by_inverse = call("inverse " + sample("four_bar") + " --record by_inverse.csv");
  REQUIRE(by_inverse.exit == 0);
  CHECK(contains(by_inverse.text, "Ax "));
  CHECK_FALSE(contains(by_inverse.text, "A.force_on_p_world_x"));  // Ax, under its own name
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

// Its legs carry no moments: what remains of them is round-off of the forces.
TEST_CASE("runner: inverse lists no moments that are round-off", "[plugin][runner]") {
  const Called r = call("inverse " + sample("stewart") + " --record stewart_inverse.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "leg_6.force_on_p_world_z"));
  CHECK_FALSE(contains(r.text, "torque_on_p_world"));
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
  CHECK(contains(r.text, "; see the table \"reactions not unique\" of lockstep check --verbose"));
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

TEST_CASE("runner: a drive that jumps ends kinematics and inverse as it ends a run", "[plugin][runner]") {
  const std::string scene = scene_file("jumping", R"("bodies": [
      {"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
                "drive": {"axis": "rz", "law": {"type": "formula", "y": "=t < 0.2 ? 0 : 0.05"}}}],
    "run": {"until": 1, "output": 0.1, "record": ["A.rz"]})");
  for (const char* command : {"run", "kinematics", "inverse"}) {
    const Called r = call(std::string(command) + " '" + scene + "'");
    INFO(r.text);
    CHECK(r.exit == 5);
    CHECK(contains(r.text, "error: drive A.rz jumps in position at t = 0.2 s by 0.05 rad"));
  }
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
  CHECK(row_of(link.text, "drive rz") == "drive rz rad 0 10 0");
  CHECK(row_of(link.text, "axes of S, world") == "axes of S, world x = [1, 0, 0], y = [0, 1, 0], z = [0, 0, 1]");
  CHECK(row_of(link.text, "constraint") == "constraint force [N] moment [N m] violation its rate units driven");
  CHECK(row_of(link.text, "x").starts_with("x ["));
  CHECK(row_of(link.text, "x").ends_with(" m, m/s"));
  CHECK(row_of(link.text, "e1").ends_with(" 1, 1/s"));
  CHECK(row_of(link.text, "constraints") == "constraints redundant nearly redundant");
  CHECK(contains(link.text, "D (each z e1 e2)  3 "));
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
  CHECK(row_of(words.text, "law").starts_with("law N 4.66"));
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
                "at_s": [1, 2, 0], "stiffness": 5, "free_length": 1},
               {"name": "off", "type": "applied_torque", "p": "arm", "torque": [1, 0, 0], "at": [0, 0, 0], "active": false}])") +
                          "'";
  CHECK(value_of(call("explain " + arm + " off").text, "active") == "no");
  const Called stop = call("explain " + arm + " A.stop_rz_low");
  INFO(stop.text);
  CHECK(value_of(stop.text, "active") == "yes");
  CHECK(value_of(stop.text, "restitution") == "0.25");
  CHECK(value_of(stop.text, "state") == "open");
  CHECK(row_of(stop.text, "A.stop_rz_low.gap") == "A.stop_rz_low.gap 0.5 rad");
  CHECK(row_of(stop.text, "A.rz") == "A.rz 0 rad");
  const Called joint = call("explain " + arm + " A");
  CHECK(row_of(joint.text, "A.stop_rz_low.gap") == "A.stop_rz_low.gap 0.5 rad");
  CHECK(row_of(joint.text, "A.rz_d") == "A.rz_d 0 rad/s");
  const Called spring = call("explain " + arm + " k");
  INFO(spring.text);
  CHECK(row_of(spring.text, "k.length") == "k.length 2 m");
  CHECK(row_of(spring.text, "k.force") == "k.force 5 N");
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
