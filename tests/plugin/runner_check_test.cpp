// SPDX-License-Identifier: BSD-3-Clause
// What `lockstep check` finds in a scene before it runs: freedoms, formulation, coordinates of joints, what is taken and
// left out.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_check_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const std::string& kFolder = kRunnerFolder;

}  // namespace

TEST_CASE("check prints the degrees of freedom, what drives them, and how they are solved", "[runner]") {
  const Called driven = call("check '" + kFourBar + "'");
  INFO(driven.text);
  CHECK(driven.exit == 0);
  for (const char* line : {"OK: the mechanism assembles; its motion is fully prescribed", "4 revolute: A, B, C and D",
                           "degrees of freedom  1, driven by A.rz", "redundant           none in the plane"})
    CHECK(contains(driven.text, line));
  const auto as_json = nlohmann::json::parse(call("check '" + kFourBar + "' --json").text);
  CHECK(as_json["freedoms"] == 0);
  CHECK(as_json["driven"] == 1);
  CHECK(as_json["drives"] == nlohmann::json::array({"A.rz"}));
  const Called free = call("check '" + std::string(paths::kScenes) + "/double_pendulum.json'");
  CHECK(contains(free.text, "2 degrees of freedom are free"));
}

TEST_CASE("check counts a singular start as such, and nothing of a loop that cannot close", "[runner]") {
  const std::string flat = scene_file("flat_parallelogram", R"("bodies": [
    {"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
    {"name": "b", "rod": {"mass": 1, "from": [1, 0, 0], "to": [3, 0, 0]}},
    {"name": "c", "rod": {"mass": 1, "from": [2, 0, 0], "to": [3, 0, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
               {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [1, 0, 0]},
               {"name": "C", "type": "revolute", "p": "c", "s": "b", "at": [3, 0, 0]},
               {"name": "D", "type": "revolute", "p": "c", "s": "ground", "at": [2, 0, 0]}])");
  const Called singular = call("check '" + flat + "'");
  INFO(singular.text);
  CHECK(contains(singular.text,
                 "  The mechanism assembles in a singular configuration; 2 instantaneous degrees of freedom.\n"));
  CHECK_FALSE(contains(singular.text, "OK:"));
  const std::string far = scene_file("too_far_apart", R"("bodies": [
    {"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
               {"name": "B", "type": "revolute", "p": "a", "s": "ground", "at_p": [1, 0, 0], "at_s": [3, 0, 0]}])");
  for (const std::string verbose : {"", " --verbose"}) {
    const Called open = call("check '" + far + "'" + verbose);
    INFO(open.text);
    CHECK(open.exit != 0);
    CHECK(value_of(open.text, "degrees of freedom") == "not computed");
    CHECK_FALSE(contains(open.text, "all are unique"));
    CHECK_FALSE(contains(open.text, "redundant constraints"));
  }
}

TEST_CASE("check reports unintended settings, and that the run has no end", "[runner]") {
  const Called r = call("check '" + scene_file("settings", R"("bodies": [{"name": "bob", "particle": 1}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [0, 0, 0], "at_s": [0, 1, 0],
                "stiffness": -5, "free_length": 1}],
    "run": {"integrator": "rk4", "step": 0.01, "tolerance": 1e-6})") +
                        "'");
  INFO(r.text);
  CHECK(r.exit == 0);
  for (const char* line :
       {"negative-stiffness: force 'k'", "setting-unused: tolerance", "note      the scene has no end"})
    CHECK(contains(r.text, line));
}

TEST_CASE("degrees of freedom are counted in space, although a run is solved in a plane", "[runner]") {
  const std::string ball = scene_file("ball", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "joints": [{"name": "A", "type": "spherical", "p": "arm", "s": "ground", "at": [0, 0, 0]}])");
  const Called checked = call("check '" + ball + "'"), counted = call("check '" + ball + "' --verbose");
  INFO(checked.text << counted.text);
  CHECK(contains(checked.text, "3 degrees of freedom are free"));
  CHECK(contains(checked.text, "in the plane with normal z: 1 unknown velocity"));
  CHECK(value_of(counted.text, "degrees of freedom") == "3");
  CHECK(contains(counted.text, "'arm' rotates about x"));
  CHECK(value_of(call("check '" + ball + "' --verbose --set joints.A.type=revolute").text, "degrees of freedom") ==
        "1");
  // but in a plane that the scene asks for
  CHECK(value_of(call("check '" + ball + "' --verbose --planar z").text, "degrees of freedom") == "1");
  // A door that moves out of its plane alone is counted in space altogether.
  const std::string door = scene_file("light_door", R"("gravity": [0, 0, -9.81],
    "bodies": [{"name": "door", "box": {"mass": 30, "size": [0.9, 0.04, 2]}, "position": [0.45, 0, 1]}],
    "joints": [{"name": "low", "type": "point_on_plane", "p": "door", "s": "ground", "at": [0, 0, 0.2], "axis": "z"},
               {"name": "mid", "type": "point_on_line", "p": "door", "s": "ground", "at": [0, 0, 1], "axis": "z"},
               {"name": "high", "type": "point_on_line", "p": "door", "s": "ground", "at": [0, 0, 2], "axis": "z"}])");
  const Called held = call("check '" + door + "' --verbose");
  INFO(held.text);
  CHECK(value_of(held.text, "velocity components") == "6");
  CHECK(value_of(held.text, "constraints") == "5");
  CHECK(value_of(held.text, "degrees of freedom") == "1");
  CHECK(contains(held.text, "normal y (the start and all loads lie in it; counts are in space)"));
}

TEST_CASE("a door at rest is solved in space by check, run and statics, not in a plane that locks it", "[runner]") {
  const std::string door = "'" + scene_file("near_door", R"("gravity": [0, 0, -9.81],
    "bodies": [{"name": "door", "box": {"mass": 30, "size": [0.9, 0.04, 2]}, "position": [0.45, 0, 1]}],
    "joints": [{"name": "low",  "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0.2]},
               {"name": "mid",  "type": "revolute", "p": "door", "s": "ground", "at": [1e-5, 0, 1]},
               {"name": "high", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 1.8]}],
    "run": {"until": 0.1, "record": ["low.force_on_p_world_z"]})") +
                           "'";
  for (const std::string command : {"check ", "run --no-picture --record near_door.csv ", "statics "}) {
    const Called free = call(command + door);
    CAPTURE(command, free.text);
    CHECK(free.exit == 0);
    CHECK(contains(free.text, "It is released"));
    CHECK_FALSE(contains(free.text, "no degree of freedom"));
  }
}

TEST_CASE("check names what keeps a scene in space that moves in a plane", "[runner]") {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(kFourBar));
  scene["markers"] = nlohmann::json::parse(
      R"([{"name": "tip", "body": "crank"}, {"name": "post", "body": "ground", "at": [1, 0, 0]}])");
  scene["forces"] =
      nlohmann::json::parse(R"([{"name": "pull", "type": "template_force", "p": "tip", "s": "post", "strength": 1}])");
  const std::string file = kFolder + "/pulled.json", plugin = " --plugin '" + test_plugin("template_force") + "'";
  std::ofstream(file) << scene;
  const auto checked = [&](const char* options) {
    std::ofstream(file) << scene;
    const Called r = call("check pulled.json --verbose " + std::string(options) + plugin);
    CAPTURE(r.text);
    CHECK(r.exit == 0);
    return r.text;
  };
  const std::string proposal =
      "\"planar\": \"z\" gives 9 unknown velocities instead of 18, if nothing leaves that plane: force 'pull': "
      "'template_force' does not declare that it stays in the plane with normal z; add to its "
      "class: \"bool stays_in_plane(lockstep::Plane) const override { return true; }\"";
  const std::string in_space = "joint: 2 unknown velocities, and the loop-closure constraints of D";
  CHECK(value_of(checked(""), "solved as") == in_space);
  CHECK(contains(checked(""), proposal));
  CHECK(contains(checked("--planar auto"), proposal));
  CHECK(contains(checked("--planar z"), "in the plane with normal z"));
  scene["run"]["formulation"] = "quaternion";  // it takes no plane
  CHECK_FALSE(contains(checked(""), "gives 9"));
  scene["run"].erase("formulation");
  scene["joints"][3]["at"] = {0.28, 0, 0.1};  // a lever arm along the normal
  CHECK_FALSE(contains(checked(""), "gives 9"));
  scene["joints"][3]["at"] = {0.28, 0, 0}, scene["markers"][1]["at"] = {1, 0, 1};  // now it pulls out of the plane
  CHECK(value_of(checked(""), "solved as") == in_space);
  CHECK_FALSE(contains(checked(""), "gives 9"));
}

TEST_CASE("check reports the joint coordinates of a scene, and why there are none", "[runner]") {
  const std::string chain = std::string(paths::kScenes) + "/chain_10.json";
  const auto says = [](const std::string& scene, const std::string& options, const std::string& words) {
    const Called checked = call("check '" + scene + "' --verbose " + options);
    INFO(checked.text);
    return checked.exit == 0 && contains(checked.text, words);
  };
  const auto formulation = [](const std::string& scene, const std::string& options) {
    const Called checked = call("check '" + scene + "' --verbose " + options);
    INFO(checked.text);
    CHECK(checked.exit == 0);
    return value_of(checked.text, "solved as");
  };
  const auto branch = [](const std::string& scene, const std::string& options, const std::string& body) {
    const std::string text = call("check '" + scene + "' --verbose " + options).text;
    return row_of(text.substr(std::min(text.find("  joint coordinates:"), text.size())), body);
  };
  CHECK(formulation(chain, "") == "joint: 10 unknown velocities, no constraints");
  CHECK(branch(chain, "", "body") == "body on by joint coordinates");
  CHECK(branch(chain, "", "rod_1") == "rod_1 ground J1 rz");
  CHECK(branch(chain, "", "rod_2") == "rod_2 rod_1 J2 rz");
  CHECK(says(chain, "--json", R"("body": "rod_2")"));
  CHECK(formulation(chain, "--full") == "omega");
  CHECK(formulation(kFourBar, "") ==
        "joint, in the plane with normal z: 2 unknown velocities, and the loop-closure constraints of D");
  CHECK(formulation(kFourBar, "--planar off").starts_with("joint: 2 unknown velocities, and the loop-closure constraints of"));
  CHECK(formulation(kFourBar, "--full") == "omega");
  const std::string stewart = std::string(paths::kScenes) + "/stewart.json";
  CHECK(says(stewart, "", " operations, omega "));
  const std::string pendulum = kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 0.2, "integrator": ")";
  CHECK(formulation(scene_file("explicit", pendulum + "dopri5\"}"), "").starts_with("joint: 1 unknown"));
  CHECK(formulation(scene_file("implicit", pendulum + "radau5\"}"), "--planar off") ==
        "omega: integrator radau5 does not support joint coordinates");
  CHECK(formulation(scene_file("driven_tree", R"("bodies": [{"name": "cart", "box": {"mass": 1, "size": [1, 1, 1]}},
    {"name": "free", "sphere": {"mass": 1, "radius": 1}}, {"name": "rod", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "S", "type": "prismatic", "p": "cart", "s": "ground", "at": [0,0,0], "axis": "x",
               "drive": {"axis": "z", "law": {"type": "ramp", "slope": 1}}},
              {"name": "A", "type": "spherical", "p": "rod", "s": "cart", "at": [0,0,0]}], "run": {"until": 1})"),
                    "--planar off") == "joint: 9 unknown velocities, no constraints");
  const std::string tree = kRunnerFolder + "/driven_tree.json";
  CHECK(branch(tree, "--planar off", "body") == "body on by joint coordinates prescribed");
  CHECK(branch(tree, "--planar off", "cart") == "cart ground S yes");
  CHECK(branch(tree, "--planar off", "rod") == "rod cart A rx, ry and rz");
  CHECK(branch(tree, "--planar off", "free") == "free x, y, z, rx, ry and rz");  // on no link, and no body
  CHECK(formulation(tree, "") == "joint, in the plane with normal z: 4 unknown velocities, no constraints");
  CHECK(formulation(scene_file("solved", pendulum + "dopri5\", \"solver\": \"sparse\"}"), "")
            .starts_with("omega, in the plane"));
  const Called r = call("run '" + chain + "' --formulation joint --until 0.2 --record joint.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "energy ok"));
}

TEST_CASE("the formulation of a run is reported, and check reports how stages are evaluated, and why", "[runner]") {
  const std::string chain = std::string(paths::kScenes) + "/chain_10.json";
  const auto used = [&](const std::string& words) {
    const std::string line = "run " + words + " --until 0.05 --no-picture --record used.csv";
    const nlohmann::json j = nlohmann::json::parse(call(line + " --json").text);
    const std::string name = j["method"]["formulation_used"];
    INFO(words);
    CHECK(value_of(call(line + " --verbose").text, "method").ends_with(", formulation " + name));
    return name;
  };
  CHECK(used("'" + chain + "'") == "joint");
  CHECK(used("'" + chain + "' --formulation omega") == "omega");
  CHECK(used("'" + chain + "' --planar off --formulation quaternion") == "quaternion");
  CHECK(used("'" + chain + "' --integrator radau5") == "omega");  // "auto" is what is asked for
  const auto stages = [](const std::string& scene, const std::string& settings) {
    nlohmann::json own = nlohmann::json::parse(std::ifstream(scene));
    own["run"].update(nlohmann::json::parse("{" + settings + "}"));
    std::ofstream(kRunnerFolder + "/stages.json") << own;
    const Called r = call("check '" + kRunnerFolder + "/stages.json' --json");
    INFO(r.text);
    return nlohmann::json::parse(r.text)["stages"].get<std::string>();
  };
  CHECK(stages(chain, "") == "unprojected: no constraints are left");
  CHECK(stages(chain, R"("formulation": "omega")") == "unprojected: without loops no configuration is singular");
  CHECK(contains(stages(kFourBar, ""), "projected near singular configurations"));
  CHECK(stages(kFourBar, R"("stabilization": "baumgarte")") == "unprojected: the run has no projection");
  CHECK(stages(kFourBar, R"("integrator": {"type": "dopri5", "stages": "plain"})") == "unprojected, as requested");
  CHECK(stages(kFourBar, R"("integrator": "radau5")").empty());
  const std::string verbose = call("check '" + kFourBar + "' --verbose").text;
  CHECK(contains(verbose, "OK: the mechanism assembles; its motion is fully prescribed."));
  CHECK(value_of(verbose, "joints") == "4 revolute: A, B, C and D");
  CHECK_FALSE(contains(verbose, "violation"));
  const std::string arm = scene_file("one", kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 0.2})");
  CHECK(contains(call("check '" + arm + "'").text, ": 1 unknown velocity, no constraints"));
}

// Constraints are moved by markers whose laws end, or have the period of a second; an error of assembly moves nothing.
TEST_CASE("check names constraints that laws move, and only these", "[runner]") {
  const auto check = [](const std::string& law, const std::string& more, const std::string& until) {
    const std::string marker = law.empty() ? "" : R"(, "translation": {"type": "components", "x": )" + law + "}";
    const std::string scene = scene_file(
        "moved", R"("gravity": [0,0,0], "bodies": [{"name": "b", "sphere": {"mass": 1, "radius": "5 mm"})" + more +
                     R"(}], "markers": [{"name": "M", "body": "ground")" + marker + R"(}, {"name": "B", "body": "b"}],
      "links": [{"name": "G", "type": "fixed", "p": "B", "s": "M"}], "events": [{"name": "end", "at": 0.9, "stop": true}],
      "run": {"output": 0.5, "until": )" +
                     until + "}");
    return call("check '" + scene + "'").text;
  };
  const std::string spline = R"({"type": "spline", "points": [[0,0],[0.5,0.1],[1,0]]})",
                    waves = R"({"type": "fourier", "frequency": "1 Hz", "offset": -0.1, "cosines": [0.1]})",
                    turned = R"(, "orientation": {"axis": "z", "angle": 2e-5})";
  for (const std::string& text : {check(spline, "", "2"), check(waves, "", "127"), check(waves, "", "128")}) {
    INFO(text);
    CHECK(contains(text, "its motion is fully prescribed"));
  }
  const std::string held = check("", turned, R"(1, "assemble": false)");
  INFO(held);
  CHECK(contains(held, "it cannot move"));
}

TEST_CASE("impossible joint coordinates are rejected before a file is opened", "[runner]") {
  const std::string table = kRunnerFolder + "/door_joint.csv";
  const Called r = call("run '" + std::string(paths::kSource) +
                        "/tests/stability/scenes/door.json' --formulation joint --no-picture --record door_joint.csv");
  INFO(r.text);
  CHECK(r.exit != 0);
  CHECK(contains(r.text, "joint coordinates (formulation joint) are not possible: redundant constraints of joint 'high'"));
  CHECK_FALSE(contains(r.text, "the run ended"));
  CHECK_FALSE(std::filesystem::exists(table));
  CHECK_FALSE(std::filesystem::exists(table + ".partial"));
}

TEST_CASE("check counts the mechanism, assemble reports the bodies that it moved", "[runner]") {
  const auto check = nlohmann::json::parse(call("check '" + kFourBar + "' --planar off --json").text);
  CHECK(check["bodies"] == 3);
  CHECK(check["unknowns"] == 18);
  CHECK(check["rows"] == 21);
  CHECK(check["redundant"] == 3);
  CHECK(check["freedoms"] == 0);
  const auto plane = nlohmann::json::parse(call("check '" + kFourBar + "' --json").text);
  CHECK(plane["unknowns"] == 9);
  CHECK(plane["rows"] == 9);
  CHECK(plane["redundant"] == 0);

  const std::string off = scene_file("off", R"("bodies": [{"name": "bob", "particle": 1, "position": [1.1, 0, 0]}],
    "links": [{"name": "L", "type": "distance", "p": "bob", "s": "ground", "at_s": [0,0,0], "length": 1}], "run": {"until": 0.1})");
  const std::string told = call("assemble '" + off + "' --json").text;
  CHECK(contains(told, "start-moved"));
  const auto report = nlohmann::json::parse(told.substr(told.find('{')));
  CHECK(report["largest_move"].get<double>() == Approx(0.1));
  CHECK(report["moved_most"] == "bob");
  CHECK(report["bodies"]["bob"]["position"][0].get<double>() == Approx(1.0));
  CHECK(report["bodies"]["bob"]["moved"].get<double>() == Approx(0.1));
  CHECK(report["bodies"]["bob"]["ends"].empty());

  // The ends of rods, with which the same scene is not moved again.
  const std::string rod = scene_file("off_rod", R"("bodies": [
    {"name": "arm", "rod": {"mass": 1, "from": ["100 mm", 0, 0], "to": [1.1, 0, 0]}},
    {"name": "box", "box": {"mass": 1, "size": [1, 1, 1]}, "position": [9, 0, 0]}],
    "joints": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at_p": [0.1, 0, 0], "at_s": [0, 0.1, 0]}])");
  const Called moved = call("assemble '" + rod + "'");
  INFO(moved.text);
  CHECK(contains(row_of(moved.text, "name"), "moved [m]"));
  CHECK(row_of(moved.text, "box").starts_with("box 0 0 [9, 0, 0]"));
  const auto arm = [&](const std::string& options) {
    const std::string text = call("assemble '" + rod + "' --json" + options).text;
    return nlohmann::json::parse(text.substr(std::min(text.find('{'), text.size())))["bodies"]["arm"];
  };
  const auto first = arm("");
  CHECK(first["moved"].get<double>() > 0.1);
  CHECK(first["rotated"].get<double>() > 0.1);
  std::string again;
  for (int k = 0; k < 3; ++k)
    for (const auto& [key, end] :
         {std::pair("bodies.arm.rod.from.", 0), std::pair("bodies.arm.rod.to.", 1), std::pair("joints.A.at_p.", 0)})
      again += " --set " + std::string(key) + std::to_string(k) + "=" + first["ends"][end][k].dump();
  CHECK(arm(again)["moved"].get<double>() < 1e-9);
  const Called run = call("run '" + off + "' --record off.csv");
  CHECK(run.exit == 0);
  CHECK(contains(run.text, "moved 'bob' by 0.1 m"));
}

TEST_CASE("check lists the channels, describe explains a key", "[runner]") {
  const auto channels = nlohmann::json::parse(call("check '" + kFourBar + "' --channels --json").text)["channels"];
  std::size_t n_found = 0;
  for (const auto& c : channels) {
    if (c["name"] == "crank.x" && c["unit"] == "m" && c["of"] == "body 'crank'") ++n_found;
    if (c["name"] == "energy.total" && c["unit"] == "J" && c["of"] == "the whole mechanism") ++n_found;
  }
  CHECK(n_found == 2);
  CHECK(std::ranges::none_of(channels, [](const auto& c) { return c["of"] == "marker 'A.P'"; }));
  CHECK(contains(call("check '" + kFourBar + "' --channels --of A.P").text, "A.P.{x,y,z}"));
  const auto first_of = [&](const char* owner) {
    return std::ranges::find_if(channels, [=](const auto& c) { return c["of"] == owner; });
  };
  REQUIRE(first_of("the whole mechanism") != channels.end());
  CHECK(first_of("body 'crank'") < first_of("the whole mechanism"));
  CHECK(row_of(call("check '" + kFourBar + "' --channels").text, "crank.v{x,y,z}") ==
        "crank.v{x,y,z} m/s velocity of the origin, world");
  CHECK(contains(call("check '" + kFourBar + "' --channels").text, "A.force_on_p_world_{x,y,z}"));
  for (const char* name : {"link", "joint"})
    CHECK(contains(call("describe " + std::string(name)).text, "see `lockstep describe drive`"));
  CHECK(contains(call("describe revolute").text, "see `lockstep describe drive`"));
  CHECK(contains(call("describe run").text, "list of channel names"));
  CHECK(contains(call("describe event").text, "list of texts"));
  const std::string all = call("list").text;
  CHECK(contains(all, "dopri5 (default)"));
  CHECK(contains(all, "schur (default)"));
  CHECK_FALSE(contains(all, "dense (default)"));
}

TEST_CASE("a gear between a rotation and a joint that holds it is reported", "[runner]") {
  const auto check = [](const std::string& joint) {
    return call("check '" + scene_file("held_gear", R"("bodies": [{"name": "one", "sphere": {"mass": 1, "radius": 0.1}},
      {"name": "two", "sphere": {"mass": 1, "radius": 0.1}, "position": [1, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "one", "s": "ground", "at": [0, 0, 0]},
      {"name": "B", "type": ")" + joint + R"(", "p": "two", "s": "ground", "at": [1, 0, 0]},
      {"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"]}], "run": {"until": 1})") +
                "'")
        .text;
  };
  const std::string held = check("prismatic");
  INFO(held);
  CHECK(contains(held, "pairs[1]: joint 'B' (prismatic) does not rotate about its z axis, so the gear locks the other pair too"));
  CHECK_FALSE(contains(held, "joint 'A' (revolute) does not rotate"));
  for (const char* joint : {"revolute", "cylindrical"}) CHECK_FALSE(contains(check(joint), "does not rotate"));
}

TEST_CASE("check ends as run does if a start that is not assembled violates the constraints", "[runner]") {
  const std::string off = scene_file("unassembled", R"("bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "L", "type": "revolute", "p": "a", "s": "ground", "at_p": [0.3, 0, 0], "at_s": [0, 0, 0]}],
    "run": {"until": 1, "assemble": false, "record": ["a.x"]})");
  for (const char* verb : {"run", "check"}) {
    const Called r = call(std::string(verb) + " '" + off + "'");
    INFO(r.text);
    CHECK(r.exit == 5);
    CHECK(contains(r.text, "the start at t = 0 s violates the constraints by 0.3 m"));
    CHECK_FALSE(contains(r.text, "a run assembles it first"));
  }
}

}  // namespace runner_check_test
