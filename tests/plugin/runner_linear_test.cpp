// SPDX-License-Identifier: BSD-3-Clause
// The verbs modes, linearize and matrices, called as a person calls them.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_linear_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// A bob of mass m on an arm d, hanging; a motor in its hinge, a spring that is free.
const std::string kBob = R"("gravity": [0,-9.81,0],
  "bodies": [{"name": "bob", "mass": 2, "inertia": [0.2, 0.25, 0.3], "position": [0, -0.7, 0]}],
  "links": [{"name": "pivot", "type": "revolute", "p": "bob", "s": "ground", "at": [0,0,0]}],
  "forces": [{"name": "motor", "type": "torque_motor", "p": "bob", "s": "ground", "at": [0,0,0], "torque": 0},
             {"name": "push", "type": "applied_force", "p": "bob", "at": [0,-0.7,0], "force": [0, -3, 0]}],
  "run": {"until": 1, "output": 0.1, "record": ["pivot.rz"]})";
const double kSwing = std::sqrt(2 * 9.81 * 0.7 / (0.3 + 2 * 0.49));  // sqrt(m g d/(I + m d^2))

std::string without_push() {
  const std::size_t at = kBob.find(",\n             {\"name\": \"push\"");
  return kBob.substr(0, at) + "]" + kBob.substr(kBob.find(",\n  \"run\""));
}

}  // namespace

TEST_CASE("modes of a scene: a pendulum's frequency", "[runner][modes]") {
  const std::string scene = scene_file("bob", without_push());
  const Called called = call("modes '" + scene + "' --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const json j = json::parse(called.text);
  REQUIRE(j["modes"].size() == 1);
  CHECK(j["freedoms"] == 1);
  CHECK(j["modes"][0]["omega"].get<double>() == Approx(kSwing).epsilon(1e-12));
  CHECK(j["modes"][0]["frequency"].get<double>() == Approx(kSwing / 6.283185307179586).epsilon(1e-12));
  CHECK(j["modes"][0]["shape"][0]["turn"][2][0].get<double>() == Approx(1));
  CHECK(j["state"]["still"] == true);
  const Called words = call("modes '" + scene + "' --csv modes.csv");
  INFO(words.text);
  CHECK(words.exit == 0);
  for (const char* word : {"at rest", "'bob' rotates 1 rad about z", "undamped", "modes.csv"})
    CHECK(contains(words.text, word));
  std::ifstream file(kRunnerFolder + "/modes.csv");
  std::string header, row;
  std::getline(file, header), std::getline(file, row);
  CHECK(contains(header, "frequency [Hz]"));
  CHECK(contains(header, "bob.turn_z.re [rad]"));
  CHECK(row.starts_with("1,oscillation,"));
}

TEST_CASE("modes rejects a state that is no equilibrium, with the next move", "[runner][modes]") {
  const std::string scene = std::string(paths::kScenes) + "/pendulum.json";
  const Called refused = call("modes '" + scene + "'");
  INFO(refused.text);
  CHECK(refused.exit == 3);
  for (const char* word : {"'arm' accelerates at", "m/s^2", "--frozen", "--at"}) CHECK(contains(refused.text, word));
  const Called driven = call("modes '" + std::string(paths::kScenes) + "/four_bar.json' --equilibrium");
  CHECK(driven.exit == 0);
  CHECK(contains(driven.text, "no modes: joints and drives leave no degree of freedom"));
  const Called frozen = call("modes '" + scene + "' --frozen");
  CHECK(frozen.exit == 0);
  CHECK(contains(frozen.text, "frozen coefficients"));
  CHECK(call("modes '" + scene + "' --set gravity.0=9.81 --set gravity.1=0").exit == 0);
  CHECK_FALSE(contains(refused.text, "find_equilibrium"));
  CHECK(contains(refused.text, "hint: --equilibrium takes the static equilibrium"));
  const auto first = [&](const std::string& options) {
    const Called called = call("modes '" + scene + "' --json " + options);
    INFO(called.text);
    REQUIRE(called.exit == 0);
    return json::parse(called.text)["modes"][0]["omega"].get<double>();
  };
  CHECK(first("--equilibrium") == Approx(first("--set gravity.0=9.81 --set gravity.1=0")).epsilon(1e-8));
  const Called alone = call("linearize '" + scene + "' --equilibrium");
  INFO(alone.text);
  CHECK(alone.exit == 0);
  CHECK_FALSE(value_of(alone.text, "A").empty());
  CHECK(value_of(alone.text, "B").empty());
  check_refused(call("modes '" + scene + "' --frozen --spin 1,2"), 2,
                {"--spin: \"1,2\" is not a vector; write three finite numbers"});
  for (const char* spin : {"nan,0,0", "0,inf,0"}) {
    const Called endless = call("modes '" + scene + "' --frozen --spin " + spin);
    INFO(endless.text);
    CHECK(endless.exit == 2);
    for (const char* word : {"--spin", spin, "write three finite numbers"}) CHECK(contains(endless.text, word));
  }
  check_refused(call("modes '" + scene + "' --frozen --count none"), 2, {"--count: \"none\" is not a number of modes"});
  check_refused(call("modes '" + scene + "' --frozen --at yesterday"), 2, {"--at: \"yesterday\" is not a time"});
}

TEST_CASE("modes rejects a slender rod that falls about a hinge near it", "[runner][modes]") {
  const std::string scene = scene_file("falling", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "rod": {"mass": 2, "from": [0, 0, 0.5], "to": [1, 0, 0.5], "radius": 0.0004}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]}],
    "run": {"until": 1})");
  for (const char* verb : {"modes", "linearize"}) {
    const Called refused = call(std::string(verb) + " '" + scene + "'");
    INFO(refused.text);
    CHECK(refused.exit == 3);
    CHECK(contains(refused.text, "'arm' accelerates at"));
  }
}

TEST_CASE("modes of a scene at an instant to which it is run", "[runner][modes]") {
  const std::string scene = scene_file("settling", R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "mass", "mass": 2, "inertia": [0.1, 0.1, 0.1]}],
    "links": [{"name": "rail", "type": "prismatic", "p": "mass", "s": "ground", "at": [0,0,0], "axis": "y"}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "mass", "s": "ground", "at_p": [0,0,0], "at_s": [0,-1,0],
                "stiffness": 200, "damping": 20, "free_length": 1}],
    "run": {"until": 1, "tolerance": 1e-10})");
  check_refused(call("modes '" + scene + "'"), 3, {"'mass' accelerates at", "--at"});
  const Called settled = call("modes '" + scene + "' --at 10 --json");
  INFO(settled.text);
  REQUIRE(settled.exit == 0);
  const json mode = json::parse(settled.text)["modes"][0];
  CHECK(mode["eigenvalue"][0].get<double>() == Approx(-5).epsilon(1e-9));
  CHECK(mode["eigenvalue"][1].get<double>() == Approx(std::sqrt(75.0)).epsilon(1e-9));
  CHECK(mode["damping"].get<double>() == Approx(0.5).epsilon(1e-9));
  const Called slow = call("modes '" + scene + "' --equilibrium --set forces.spring.damping=100");
  INFO(slow.text);
  CHECK(row_of(slow.text, "1").starts_with("1 decay 2.08712 aperiodic 'mass' moves "));  // 25 - sqrt(525)
  CHECK(contains(slow.text, "decay rate [1/s]"));
}

TEST_CASE("linearize: a motor, a push and a drive of a pendulum", "[runner][linear]") {
  const std::string scene = scene_file("pushed", kBob);
  const Called called =
      call("linearize '" + scene + "' --inputs motor,push --outputs pivot.rz,bob.ax,pivot.omega_z --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const json j = json::parse(called.text);
  const double inertia = 0.3 + 2 * 0.49, pull = 2 * 9.81 + 3;  // the push pulls as the weight does
  CHECK(j["states"].size() == 2);
  CHECK(j["inputs"].size() == 2);
  CHECK(j["A"][1][0].get<double>() == Approx(-(2 * 9.81 + 3) * 0.7 / inertia).epsilon(1e-11));
  // what the state is, the outputs say: angle = c x
  const double c = j["C"][0][0].get<double>();
  CHECK(j["B"][1][0].get<double>() * c == Approx(1 / inertia).epsilon(1e-8));
  CHECK(std::abs(j["B"][1][1].get<double>()) < 1e-9);  // along the arm
  CHECK(j["D"][1][0].get<double>() == Approx(0.7 / inertia).epsilon(1e-8));
  CHECK(j["C"][1][0].get<double>() == Approx(-0.7 * pull * 0.7 / inertia * c).epsilon(1e-8));
  CHECK(j["accuracy"].get<double>() < 1e-8);

  CHECK(call("linearize '" + scene + "' --inputs motor --csv linear.csv").exit == 0);
  std::ifstream file(kRunnerFolder + "/linear.csv");
  std::string header;
  std::getline(file, header);
  CHECK(contains(header, "motor [N m]"));

  const Called unknown = call("linearize '" + scene + "' --inputs moter");
  CHECK(unknown.exit == 2);
  CHECK(contains(unknown.text, "did you mean \"motor\""));
  std::string named = kBob;
  named.replace(named.find("\"pivot.rz\""), 10, R"({"angle": "pivot.rz"})");
  const Called angle = call("linearize '" + scene_file("pushed_angle", named) + "' --outputs angle --json");
  CHECK(json::parse(angle.text)["outputs"][0]["name"] == "angle");
  check_refused(call("linearize '" + scene + "' --outputs bob.speed"), 3, {"channel \"bob.speed\""});
  CHECK(contains(call("linearize '" + scene + "' --outputs energy.dissipated").text, "integrated state"));
}

TEST_CASE("linearize: the law of a drive has three columns", "[runner][linear]") {
  const std::string scene = scene_file("driven", R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "cart", "mass": 1, "inertia": [0.1, 0.1, 0.1]},
               {"name": "bob", "mass": 2, "inertia": [0.2, 0.25, 0.3], "position": [0, -0.7, 0]}],
    "links": [{"name": "rail", "type": "prismatic", "p": "cart", "s": "ground", "at": [0,0,0], "axis": "x",
               "drive": {"axis": "z", "law": 0}},
              {"name": "pivot", "type": "revolute", "p": "bob", "s": "cart", "at": [0,0,0]}],
    "run": {"until": 1})");
  const Called called = call("linearize '" + scene + "' --inputs rail --outputs pivot.rz,cart.x,bob.x --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const json j = json::parse(called.text);
  REQUIRE(j["inputs"].size() == 3);
  CHECK(j["inputs"][2]["name"] == "rail_dd");
  CHECK(j["inputs"][2]["unit"] == "m/s^2");
  CHECK(j["D"][1][0].get<double>() == Approx(1).epsilon(1e-9));
  // (I + m d^2) th'' = -m g d th - m d u''
  CHECK(j["A"][1][0].get<double>() == Approx(-kSwing * kSwing).epsilon(1e-11));
}

namespace {

// The entry of one of the matrices of `linearize --json` by the names of its row and its column.
double entry(const json& j, const char* matrix, const std::string& row, const std::string& column) {
  const auto place = [](const json& signals, const std::string& name) {
    for (std::size_t k = 0; k < signals.size(); ++k)
      if (signals[k]["name"] == name) return k;
    FAIL(name << " is none of " << signals.dump());
    return std::size_t{0};
  };
  const bool of_states = std::string(matrix) == "A" || std::string(matrix) == "B",
             by_states = std::string(matrix) == "A" || std::string(matrix) == "C";
  return j[matrix][place(j[of_states ? "states" : "outputs"], row)][place(j[by_states ? "states" : "inputs"], column)];
}

json linearized(const std::string& scene, const std::string& options) {
  const Called called = call("linearize '" + scene + "' " + options + " --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  return json::parse(called.text);
}

// Four things beside one another, and what may be an input of each: a bob on a rope with a law, a cart on a rail
// with a spring to a marker that a law moves, an arm held by laws, a wheel with a brake by a formula.
const std::string kFour = R"("gravity": [0, -10, 0],
  "bodies": [{"name": "bob", "mass": 2, "inertia": [0.2, 0.25, 0.3], "position": [0, -0.5, 0]},
             {"name": "cart", "mass": 3, "inertia": [1, 1, 1], "position": [2, 0, 0]},
             {"name": "arm", "mass": 1, "inertia": [1, 1, 1], "position": [5, 0, 0]},
             {"name": "wheel", "mass": 1, "inertia": [1, 1, 0.5], "position": [8, 0, 0]}],
  "markers": [{"name": "table", "body": "ground", "at": [1, 0, 0], "translation": [0, 0, 0], "rotation": [1, 0, 0, 0]},
              {"name": "eye", "body": "bob"}],
  "links": [{"name": "rope", "type": "distance", "p": "bob", "s": "ground", "at_p": [0, -0.5, 0], "at_s": [0, 0, 0], "length": 0.5},
            {"name": "rail", "type": "prismatic", "p": "cart", "s": "ground", "at": [2, 0, 0], "axis": "x"},
            {"name": "held", "type": "fixed", "p": "arm", "s": "ground", "at": [4, 0, 0], "move": [0, 0, 0],
             "turn": {"type": "axis_rotation", "axis": "z", "law": 0}},
            {"name": "hinge", "type": "revolute", "p": "wheel", "s": "ground", "at": [8, 0, 0]}],
  "forces": [{"name": "spring", "type": "spring_damper", "p": "cart", "s": "table", "at_p": [2, 0, 0], "stiffness": 50,
              "damping": 4, "free_length": 1},
             {"name": "brake", "type": "function_force", "link": "hinge", "torque": "=-3*q - 0.5*qd"},
             {"name": "gust", "type": "applied_force", "p": "cart", "at": [2, 0, 0], "laws": [0, 0, 0]}],
  "run": {"until": 1})";

}  // namespace

TEST_CASE("linearize: a force along an axis of a bushing and a torque about it", "[runner][linear]") {
  const std::string scene = scene_file("pad", R"("bodies": [{"name": "block", "mass": 2, "inertia": [0.2, 0.2, 0.3]}],
    "forces": [{"name": "pad", "type": "bushing", "p": "block", "s": "ground", "at": [0, 0, 0],
                "orientation": {"axis": "z", "angle": "30 deg"}, "stiffness": [300, 400, 500], "damping": [1, 2, 3],
                "torsion_stiffness": [20, 30, 40], "torsion_damping": [0.1, 0.2, 0.3]}],
    "run": {"until": 1})");
  const json j = linearized(scene, "--inputs pad.x,pad.rz,pad.ry --outputs block.ax,pad.force_on_p_link_x");
  // along x of S: m x'' = u; about z: J th'' = u
  CHECK(entry(j, "B", "block.move_x_d", "pad.x") == Approx(std::cos(kPi / 6) / 2).epsilon(1e-12));
  CHECK(entry(j, "B", "block.move_y_d", "pad.x") == Approx(std::sin(kPi / 6) / 2).epsilon(1e-12));
  CHECK(entry(j, "B", "block.turn_z_d", "pad.rz") == Approx(1 / 0.3).epsilon(1e-12));
  CHECK(entry(j, "B", "block.turn_x_d", "pad.ry") == Approx(-std::sin(kPi / 6) / 0.2).epsilon(1e-12));
  CHECK(entry(j, "B", "block.turn_y_d", "pad.ry") == Approx(std::cos(kPi / 6) / 0.2).epsilon(1e-12));
  CHECK(entry(j, "D", "block.ax", "pad.x") == Approx(std::cos(kPi / 6) / 2).epsilon(1e-12));
  CHECK(std::abs(entry(j, "D", "pad.force_on_p_link_x", "pad.x")) < 1e-9);  // beside the force, not in it
  CHECK(j["inputs"][0]["unit"] == "N");
  CHECK(j["inputs"][1]["unit"] == "N m");
}

TEST_CASE("linearize: laws of joints and markers, and a brake by a formula", "[runner][linear]") {
  const std::string scene = scene_file("four", kFour);
  const json j =
      linearized(scene,
                 "--inputs rope.length,table.translation.x,held.move.y,held.turn.z,brake,gust.x,spring.force "
                 "--outputs bob.ay,cart.ax,arm.ax,arm.ay,wheel.alpha_world_z");
  CHECK(j["inputs"].size() == 15);                                               // four laws, three columns each
  CHECK(entry(j, "D", "bob.ay", "rope.length_dd") == Approx(-1).epsilon(1e-9));  // it hangs
  CHECK(entry(j, "B", "cart.move_x_d", "table.translation.x") == Approx(50. / 3).epsilon(1e-8));   // m x'' = k (u - x)
  CHECK(entry(j, "B", "cart.move_x_d", "table.translation.x_d") == Approx(4. / 3).epsilon(1e-8));  // + c (u' - x')
  CHECK(entry(j, "B", "cart.move_x_d", "table.translation.x_dd") == 0);
  CHECK(entry(j, "D", "arm.ay", "held.move.y_dd") == Approx(1).epsilon(1e-9));
  CHECK(entry(j, "D", "arm.ay", "held.turn.z_dd") == Approx(1).epsilon(1e-9));  // 1 m from its axis
  CHECK(std::abs(entry(j, "D", "arm.ax", "held.turn.z_dd")) < 1e-9);
  CHECK(entry(j, "B", "wheel.turn_z_d", "brake") == Approx(1 / 0.5).epsilon(1e-12));
  CHECK(entry(j, "A", "wheel.turn_z_d", "wheel.turn_z") == Approx(-3 / 0.5).epsilon(1e-7));
  CHECK(entry(j, "B", "cart.move_x_d", "gust.x") == Approx(1. / 3).epsilon(1e-12));
  CHECK(entry(j, "B", "cart.move_x_d", "spring.force") == Approx(-1. / 3).epsilon(1e-12));  // it pulls to the left
  CHECK(j["accuracy"].get<double>() < 1e-7);
}

TEST_CASE("linearize rejects impossible inputs, with the next move", "[runner][linear]") {
  const std::string scene =
      scene_file("no_input", kFour.substr(0, kFour.find("\n             {\"name\": \"brake\"")) +
                                 R"({"name": "pad", "type": "bushing", "p": "bob", "s": "ground", "at": [0, -0.5, 0]},
                         {"name": "rub", "type": "joint_friction", "link": "rail", "mu": 0},
                         {"name": "tide", "type": "applied_force", "p": "bob", "at": [0, -0.5, 0], "laws": [0, 0, 0]}],
                       "run": {"until": 1})");
  const auto refusal = [&](const std::string& input) {
    const Called called = call("linearize '" + scene + "' --inputs " + input);
    INFO(input << ": " << called.text);
    CHECK(called.exit == 2);
    return called.text;
  };
  for (const auto& [input, next] :
       std::vector<std::pair<std::string, std::string>>{{"pad", "as \"pad.x\""},
                                                        {"rub", "as \"rub.x\""},
                                                        {"tide", "\"tide.x\""},
                                                        {"bob", "add an applied_force or a motor on it"},
                                                        {"eye", "give it a \"translation\""},
                                                        {"table", "as \"table.translation.x\""},
                                                        {"table.translation", "name one axis of it"},
                                                        {"held.turn", "\"held.turn.x\""},
                                                        {"held", "as \"held.move.x\""},
                                                        {"hinge", "give it one, or add a motor"},
                                                        {"rope.lenght", "did you mean \"rope.length\""},
                                                        {"pad.x,pad.x", "given twice"}})
    CHECK(contains(refusal(input), next));
  // nothing that hangs on the marker asks for its axes
  const Called nothing = call("linearize '" + scene + "' --inputs table.rotation.z");
  CHECK(nothing.exit == 3);
  CHECK(contains(nothing.text, "'table.rotation.z' has no effect at this state"));
}

TEST_CASE("linearize: a particle that cannot rotate, and the law of a cam", "[runner][linear]") {
  const std::string particle = scene_file("no_turn", R"("bodies": [{"name": "bead", "particle": 1}],
    "forces": [{"name": "pad", "type": "bushing", "p": "bead", "s": "ground", "at": [0, 0, 0], "stiffness": [9, 9, 9]}],
    "run": {"until": 1})");
  CHECK(entry(linearized(particle, "--inputs pad.y"), "B", "bead.move_y_d", "pad.y") == Approx(1).epsilon(1e-12));
  const Called turn = call("linearize '" + particle + "' --inputs pad.rz");
  CHECK(turn.exit == 3);
  CHECK(contains(turn.text, "'bead', which is a particle and cannot rotate; name a force along x, y or z"));
  const Called cam = call("linearize '" + std::string(paths::kScenes) + "/cam.json' --inputs contact_1.radius");
  CHECK(cam.exit == 2);
  CHECK(contains(cam.text, "not on time"));
  const Called link = call("linearize '" + std::string(paths::kScenes) + "/cam.json' --inputs contact_1");
  CHECK(link.exit == 2);
  CHECK(contains(link.text, "give it one, or add a motor or a force"));  // its law can be no input
}

TEST_CASE("linearize: an input on a drive of a speed that is switched off acts on nothing", "[runner][linear]") {
  const std::string scene =
      scene_file("idle_speed", R"("bodies": [{"name": "wheel", "mass": 1, "inertia": [1, 1, 0.5]}],
    "links": [{"name": "hinge", "type": "revolute", "p": "wheel", "s": "ground", "at": [0, 0, 0]},
              {"name": "gear", "type": "revolute", "p": "wheel", "s": "ground", "at": [0, 0, 0],
               "drive": {"axis": "rz", "speed": 0}, "active": false}],
    "run": {"until": 1})");
  const Called called = call("linearize '" + scene + "' --inputs gear");
  INFO(called.text);
  CHECK(called.exit == 3);
  CHECK(contains(called.text,
                 "'gear' has no effect at this state; put its law in an active drive or force"));
}

TEST_CASE("matrices as files that agree with one another", "[runner][linear]") {
  const std::string scene = std::string(paths::kScenes) + "/four_bar.json",
                    folder = kRunnerFolder + "/four_bar_matrices";
  fs::remove_all(folder);
  const Called called = call("matrices '" + scene + "' --at 0.1 --out four_bar_matrices");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const auto size_of = [&](const std::string& name) {
    std::ifstream file(folder + "/" + name);
    std::string line;
    std::getline(file, line);
    CHECK(line == "%%MatrixMarket matrix coordinate real general");
    std::getline(file, line), std::getline(file, line);
    long rows = 0, columns = 0, entries = 0, found = 0;
    std::istringstream(line) >> rows >> columns >> entries;
    while (std::getline(file, line)) ++found;
    CHECK(found == entries);
    return std::pair(rows, columns);
  };
  const auto lines_of = [&](const std::string& name) {
    std::ifstream file(folder + "/" + name);
    long n = -1;  // the header
    for (std::string line; std::getline(file, line);) ++n;
    return n;
  };
  const auto [rows, unknowns] = size_of("J.mtx");
  CHECK(unknowns == 18);
  CHECK(rows == 21);
  for (const char* name : {"M.mtx", "D.mtx", "K.mtx"}) CHECK(size_of(name) == std::pair(unknowns, unknowns));
  CHECK(lines_of("unknowns.csv") == unknowns);
  CHECK(lines_of("rows.csv") == rows);
  // J v + Ct = 0 of the printed numbers
  const json j = json::parse(call("matrices '" + scene + "' --at 0.1 --json").text);
  std::vector<double> left = j["Ct"].get<std::vector<double>>();
  for (const auto& e : j["J"]["entries"])
    left[e[0].get<std::size_t>() - 1] += e[2].get<double>() * j["v"][e[1].get<std::size_t>() - 1].get<double>();
  for (const double x : left) CHECK(std::abs(x) < 1e-8);
}

TEST_CASE("matrices of a scene in which nothing moves have all keys", "[runner][linear]") {
  const std::string scene = scene_file("still", R"("bodies": [{"name": "frame", "fixed": true}], "run": {"until": 1})");
  const Called called = call("matrices '" + scene + "' --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const json j = json::parse(called.text);
  for (const char* key : {"unknowns", "rows", "v", "lambda"}) {
    CAPTURE(key);
    REQUIRE(j.contains(key));
    CHECK(j[key] == json::array());
  }
}

TEST_CASE("matrices do not replace the scene that they are of", "[runner][linear]") {
  for (const char* name : {"M.mtx", "D.mtx", "K.mtx", "J.mtx", "rows.csv"}) {
    const std::string folder = kRunnerFolder + "/matrices_of_itself", scene = folder + "/" + name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::copy_file(scene_file("bob", without_push()), scene);
    const auto size = fs::file_size(scene);
    const Called called = call("matrices '" + scene + "' --out matrices_of_itself");
    INFO(called.text);
    CHECK(called.exit == 2);
    CHECK(contains(called.text, "would replace"));
    CHECK(fs::file_size(scene) == size);
  }
}

}  // namespace runner_linear_test
