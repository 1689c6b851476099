// The program, called as a person calls it.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string& kFolder = kRunnerFolder;

}  // namespace

TEST_CASE("run writes the columns and says what moved", "[runner]") {
  const std::string csv = kFolder + "/bar.csv";
  fs::remove(csv);
  const Called r = call("run '" + kFourBar + "' --record bar.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  for (const char* word : {"crank", "work of drives", "energy balance", "bar.csv"}) CHECK(contains(r.text, word));
  const Table table = read_csv(csv);
  CHECK(table.n_rows() == 71);
  CHECK(table.last("theta") == Approx(7.3).epsilon(1e-12));
  std::ifstream file(csv);
  std::string header;
  std::getline(file, header);
  CHECK(contains(header, "t [s],theta [rad]"));
  CHECK(contains(header, "Bx [N]"));
}

TEST_CASE("options of the command line stand over the scene", "[runner]") {
  const Called r = call("run '" + kFourBar +
                        "' --integrator rk4 --step 1ms --until '50 ms' --solver dense --formulation quaternion"
                        " --stabilization baumgarte --record short.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "50 steps of rk4"));
  CHECK(read_csv(kFolder + "/short.csv").last("t") == Approx(0.05));
  const Called quiet = call("run '" + kFourBar + "' --quiet --until 0.02");
  CHECK(quiet.exit == 0);
  CHECK(quiet.text.empty());
  CHECK(fs::exists(kFolder + "/four_bar.csv"));
}

TEST_CASE("check lists what a scene does without", "[runner]") {
  const auto checked = [](const std::string& scene) {
    return call("check '" + std::string(paths::kScenes) + "/" + scene + ".json'").text;
  };
  CHECK(contains(checked("pendulum"), "motion of markers: they stand still on their bodies (hinge)"));
  CHECK_FALSE(contains(checked("moving_marker_free"), "motion of markers"));  // S of its link moves, P does not
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
    const Called r = call("check pulled.json " + std::string(options) + plugin);
    CAPTURE(r.text);
    CHECK(r.exit == 0);
    return r.text;
  };
  const std::string proposal =
      "\"planar\": \"z\" gives 9 unknown velocities instead of 18, if nothing leaves that plane: force 'pull': "
      "'template_force' does not say that it stays in the plane with normal z; let its stays_in_plane()";
  const std::string in_space = "formulation         joint: 2 unknown velocities, and the rows of what closes loops: D";
  CHECK(contains(checked(""), in_space));
  CHECK(contains(checked(""), proposal));
  CHECK(contains(checked("--planar auto"), proposal));
  CHECK(contains(checked("--planar z"), "in the plane with normal z"));
  scene["run"]["formulation"] = "quaternion";  // it takes no plane
  CHECK_FALSE(contains(checked(""), "gives 9"));
  scene["run"].erase("formulation");
  scene["links"][3]["at"] = {0.28, 0, 0.1};  // a lever arm along the normal
  CHECK_FALSE(contains(checked(""), "gives 9"));
  scene["links"][3]["at"] = {0.28, 0, 0}, scene["markers"][1]["at"] = {1, 0, 1};  // now it pulls out of the plane
  CHECK(contains(checked(""), in_space));
  CHECK_FALSE(contains(checked(""), "gives 9"));
}

TEST_CASE("joint coordinates: proposed where scene and method take them, run with the summary", "[runner]") {
  const std::string chain = std::string(paths::kScenes) + "/chain_10.json";
  const auto says = [](const std::string& scene, const std::string& options, const std::string& words) {
    const Called checked = call("check '" + scene + "' " + options);
    INFO(checked.text);
    return checked.exit == 0 && contains(checked.text, words);
  };
  CHECK(says(chain, "", "formulation         joint: 10 unknown velocities, no rows"));
  CHECK(says(chain, "", "  rod_1 on ground by 'J1': rz\n    rod_2 on rod_1 by 'J2': rz\n"));
  CHECK(says(chain, "--json", R"("body": "rod_2")"));
  CHECK(says(chain, "--full", "formulation         omega\n"));
  CHECK(!says(chain, "", "\"formulation\": \"auto\""));
  CHECK(says(kFourBar, "",
             "formulation         joint, in the plane with normal z: 2 unknown velocities, and the rows "
             "of what closes loops: D\n"));
  CHECK(says(kFourBar, "--planar off", "formulation         joint: 2 unknown velocities, and the rows of"));
  CHECK(says(kFourBar, "--full", "formulation         omega\n"));
  const std::string stewart = std::string(paths::kScenes) + "/stewart.json";
  CHECK(says(stewart, "", "formulation         omega: the rows of what closes loops, 6 of 6, cost more"));
  const std::string pendulum = kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 0.2, "integrator": ")";
  CHECK(says(scene_file("explicit", pendulum + "dopri5\"}"), "", "formulation         joint: 1 unknown"));
  CHECK(says(scene_file("implicit", pendulum + "radau5\"}"), "--planar off",
             "formulation         omega: integrator radau5 does not take joint coordinates"));
  CHECK(says(scene_file("driven_tree", R"("bodies": [{"name": "cart", "box": {"mass": 1, "size": [1, 1, 1]}},
    {"name": "free", "sphere": {"mass": 1, "radius": 1}}, {"name": "rod", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "S", "type": "prismatic", "p": "cart", "s": "ground", "at": [0,0,0], "axis": "x",
               "drive": {"axis": "z", "law": {"type": "ramp", "slope": 1}}},
              {"name": "A", "type": "spherical", "p": "rod", "s": "cart", "at": [0,0,0]}], "run": {"until": 1})"),
             "--planar off", "formulation         joint: 9 unknown velocities, no rows\n"));
  CHECK(says(kRunnerFolder + "/driven_tree.json", "--planar off",
             "  cart on ground by 'S': driven throughout, or held\n    rod on cart by 'A': rx, ry and rz\n"
             "  free on no link: x, y, z, rx, ry and rz\n"));
  CHECK(says(kRunnerFolder + "/driven_tree.json", "",
             "joint, in the plane with normal z: 4 unknown velocities, no rows\n"));
  const std::string omega = "\", \"formulation\": \"omega\"}",
                    proposal = "\"formulation\": \"auto\" integrates the joints'";
  CHECK(says(scene_file("asked", pendulum + "dopri5" + omega), "", proposal));
  nlohmann::json loop = nlohmann::json::parse(std::ifstream(kFourBar));
  loop["run"]["formulation"] = "omega";
  std::ofstream(kRunnerFolder + "/asked_loop.json") << loop;
  CHECK(says(kRunnerFolder + "/asked_loop.json", "", proposal));
  CHECK(!says(scene_file("named", pendulum + "radau5" + omega), "", proposal));
  CHECK(says(scene_file("solved", pendulum + "dopri5\", \"solver\": \"sparse\"}"), "",
             "formulation         omega, in the plane"));
  const Called r = call("run '" + chain + "' --formulation joint --until 0.2 --record joint.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "conserved"));
}

TEST_CASE("the formulation that a run takes is said, and check says where stages are evaluated, and why", "[runner]") {
  const std::string chain = std::string(paths::kScenes) + "/chain_10.json";
  const auto used = [&](const std::string& words) {
    const std::string line = "run " + words + " --until 0.05 --no-picture --record used.csv";
    const nlohmann::json j = nlohmann::json::parse(call(line + " --json").text);
    const std::string name = j["method"]["formulation_used"];
    INFO(words);
    CHECK(contains(call(line).text, ", formulation " + name + ", "));
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
  CHECK(stages(chain, "") == "plain: no rows are left");
  CHECK(stages(chain, R"("formulation": "omega")") == "plain: no loop is closed, so that no position is singular");
  CHECK(contains(stages(kFourBar, ""), "on the constraints near singular positions"));
  CHECK(stages(kFourBar, R"("stabilization": "baumgarte")") == "plain: nothing is projected onto the constraints");
  CHECK(stages(kFourBar, R"("integrator": {"type": "dopri5", "stages": "plain"})") == "plain, as asked for");
  CHECK(stages(kFourBar, R"("integrator": "radau5")").empty());
  CHECK(contains(call("check '" + kFourBar + "'").text, "  stages              plain, and on the constraints"));
  const std::string arm = scene_file("one", kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 0.2})");
  CHECK(contains(call("check '" + arm + "'").text, ": 1 unknown velocity, no rows"));
}

TEST_CASE("joint coordinates that are not possible are refused before a file is opened", "[runner]") {
  const std::string table = kRunnerFolder + "/door_joint.csv";
  const Called r = call("run '" + std::string(paths::kSource) +
                        "/tests/stability/scenes/door.json' --formulation joint --no-picture --record door_joint.csv");
  INFO(r.text);
  CHECK(r.exit != 0);
  CHECK(contains(r.text, "joint coordinates (formulation joint) are not possible: rows of link 'high'"));
  CHECK_FALSE(contains(r.text, "the run ended"));
  CHECK_FALSE(std::filesystem::exists(table));
  CHECK_FALSE(std::filesystem::exists(table + ".partial"));
}

TEST_CASE("every verb has help with an example", "[runner]") {
  for (const char* verb :
       {"",        "run",     "check",  "list",      "describe",   "schema", "assemble", "statics", "kinematics",
        "inverse", "explain", "modes",  "linearize", "matrices",   "chart",  "advise",   "sweep",   "atlas",
        "demo",    "import",  "report", "reference", "completion", "man",    "resume"}) {
    const Called r = call(std::string(verb) + " --help");
    INFO(verb);
    CHECK(r.exit == 0);
    CHECK(contains(r.text, "Example:\n  lockstep "));
  }
}

TEST_CASE("the examples of the help texts run as they stand", "[runner]") {
  const fs::path samples = fs::path(paths::kScenes).parent_path();
  fs::remove(fs::path(kFolder) / "samples");
  fs::create_directory_symlink(samples, fs::path(kFolder) / "samples");
  int n = 0;
  for (const std::string verb : {"run", "check", "assemble", "statics", "kinematics", "inverse", "explain", "modes",
                                 "linearize", "matrices", "atlas", "list", "describe", "schema", "reference"}) {
    const std::string help = call(verb + " --help").text;
    const std::size_t begin = help.find("  lockstep ", help.find("Example:")) + 2;
    const std::string line = help.substr(begin, help.find('\n', begin) - begin);
    const Called r = shell(line + (verb == "atlas" ? " --budget 1s" : ""));
    INFO(line << "\n" << r.text);
    CHECK(r.exit == 0);
    ++n;
  }
  CHECK(n == 15);
}

TEST_CASE("wrong words are a usage error", "[runner]") {
  const std::string run = "run '" + kFourBar + "' ";
  for (const auto& [words, said] : std::vector<std::pair<std::string, std::string>>{
           {"", "a verb is missing; known: run, "},
           {"fly", "unknown verb \"fly\"; known: run, "},
           {"run", "scene is required"},
           {run + "--fast", "unknown option \"--fast\"; known: "},
           {run + "--step 0", "--step: the value is 0; it must be greater than 0 and finite"},
           {run + "--step x", "--step: \"x\" is not a time; write it as in --step 0.001"},
           {run + "--integrator rk5", "--integrator: unknown name \"rk5\"; did you mean \"rk4\"?"},
           {"list wheels", "wheels not in {links,"},
           {"describe revolut", "describe: unknown name \"revolut\"; did you mean \"revolute\"?"},
           {run + "--step 1 --tolerance 1", "--step excludes --tolerance"}}) {
    INFO(words);
    check_refused(call(words), 2, {"lockstep: ", said});
  }
}

TEST_CASE("each kind of failure has its number", "[runner]") {
  const auto exit_of = [](const std::string& words, const std::string& part) {
    const Called r = call(words);
    INFO(words << "\n" << r.text);
    CHECK(contains(r.text, part));
    return r.exit;
  };
  CHECK(exit_of("run '" + scene_file("bad", R"("boddies": [])") + "'",
                "bad.json:2:1: scene: unknown key \"boddies\"; did you mean \"bodies\"?") == 3);
  CHECK(exit_of("run '" + scene_file("endless", kArm + R"("run": {})") + "'", "--until") == 3);
  CHECK(exit_of("run '" + kFourBar + "' --plugin no_such_plugin", "not found") == 4);
  CHECK(exit_of("run no_such_scene.json", "no_such_scene.json") == 8);
  CHECK(exit_of("run '" + kFourBar + "' --record /dev/null/out.csv", "/dev/null") == 8);
  const std::string apart = scene_file("apart", kArm + R"("links": [{)" + kHinge + R"(},
    {"name": "L", "type": "distance", "p": "arm", "s": "ground", "at_p": [1,0,0], "at_s": [0,0,0], "length": 3}], "run": {"until": 1})");
  CHECK(exit_of("run '" + apart + "'", "link 'L'") == 5);
  // Two laws for one angle that agree in value and speed at the start, not in acceleration.
  const std::string torn =
      scene_file("torn", kArm + R"("links": [{)" + kHinge +
                             R"(, "drive": {"axis": "rz", "law": {"type": "polynomial", "coefficients": [0, 0, 1]}}},
    {"name": "B", "type": "lock", "mask": "e1 e2", "p": "arm", "s": "ground", "at": [0,0,0],
     "drive": {"axis": "rz", "law": {"type": "polynomial", "coefficients": [0, 0, 2]}}}], "run": {"integrator": "rk4", "step": 0.01, "until": 1})");
  CHECK(exit_of("run '" + torn + "'", "cannot hold together") == 6);
}

TEST_CASE("a run beyond the end of a spline is a scene that is wrong, and says which", "[runner]") {
  const std::string spline = R"({"type": "spline", "points": [[0, 1], [0.2, 1.1], [0.5, 1.3]]})";
  const std::string path = R"({"type": "path", "points": [[0, 0,0,0], [0.2, 0.1,0,-0.1], [0.5, 0.3,0,-0.2]]})";
  const std::string end = "is outside of its range [0, 0.5] s; give points up to there, or set outside to \"hold\"";
  const auto driven = [&](const std::string& law) {
    return R"("links": [{)" + kHinge + R"(, "drive": {"axis": "rz", "law": )" + law + "}}], ";
  };
  const auto check = [&](const std::string& members, const std::string& whose, const std::string& record = "arm.x") {
    const std::string scene =
        scene_file("ends", members + R"("run": {"until": 1, "output": 0.1, "record": [")" + record + "\"]}");
    const Called r = call("run '" + scene + "'");
    INFO(r.text);
    CHECK(r.exit == 3);
    CHECK(contains(r.text, whose));
    CHECK(contains(r.text, end));
    CHECK(contains(r.text, "lockstep: t = 0."));
  };
  check(kArm + driven(spline), "s: link 'A' (revolute): the law of drive rz ('spline') threw: law 'spline': t = 0.5");
  check(kArm + driven(R"({"type": "sum", "laws": [)" + spline + "]}"),
        "s: link 'A' (revolute): the law of drive rz ('sum') threw: law 'spline': t = 0.5");
  check(kArm + R"("links": [{)" + kHinge +
            R"(}], "forces": [{"name": "M", "type": "torque_motor", "p": "arm", "s": "ground",
    "at": [0,0,0], "torque": )" +
            spline + "}], ",
        "s: force 'M' (torque_motor): its law ('spline') threw: law 'spline': t = 0.5");
  check(kArm + R"("markers": [{"name": "K", "body": "ground", "translation": )" + path + R"(}],
    "links": [{"name": "A", "type": "spherical", "p": "arm", "s": "K", "at_p": [0,0,0]}], )",
        "s: link 'A' (spherical): the translation law of marker 'K' ('path') threw: law 'path': t = 0.5");
  check(R"("gravity": [0,0,-9.81], "bodies": [{"name": "bead", "particle": 0.1}],
    "links": [{"name": "wire", "type": "point_on_curve", "p": "bead", "s": "ground", "at_s": [0,0,0], "path": )" +
            path + "}], ",
        "s: link 'wire' (point_on_curve): law 'path': t = 0.5", "bead.x");
  check(kArm + R"("markers": [{"name": "K", "body": "ground", "translation": )" + path + R"(}], "links": [{)" + kHinge +
            "}], ",
        "s: channel 'K.x': law 'path': t = 0.6", "K.x");
}

TEST_CASE("a run whose energy is not conserved ends with its own status", "[runner]") {
  const std::string scene = scene_file("coarse", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1})");
  const Called r = call("run '" + scene + "'");
  INFO(r.text);
  CHECK(r.exit == 9);
  CHECK(contains(r.text, "NOT CONSERVED"));
  CHECK(contains(r.text, "--tolerance"));
  const std::string wide = scene_file("wide", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1, "energy_limit": 100})");
  CHECK(call("run '" + wide + "'").exit == 0);
  const std::string drifts = scene_file("drifts", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega", "stabilization": "none", "violation_limit": "1 um"})");
  const Called d = call("run '" + drifts + "'");
  INFO(d.text);
  CHECK(d.exit == 9);
  CHECK(contains(d.text, "DRIFTED"));
}

// `timeout --foreground` signals the program once; without it the group is signalled too, and a second signal ends the
// program at once.
TEST_CASE("check counts the mechanism, assemble says what it moved", "[runner]") {
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
  CHECK_FALSE(check["left_out"].empty());
  CHECK(contains(call("check '" + kFourBar + "'").text, "degrees of freedom  0"));

  const std::string off = scene_file("off", R"("bodies": [{"name": "bob", "particle": 1, "position": [1.1, 0, 0]}],
    "links": [{"name": "L", "type": "distance", "p": "bob", "s": "ground", "at_s": [0,0,0], "length": 1}], "run": {"until": 0.1})");
  const auto report = nlohmann::json::parse(call("assemble '" + off + "' --json").text);
  CHECK(report["largest_move"].get<double>() == Approx(0.1));
  CHECK(report["moved_most"] == "bob");
  CHECK(report["bodies"]["bob"]["position"][0].get<double>() == Approx(1.0));
  const Called run = call("run '" + off + "' --record off.csv");
  CHECK(run.exit == 0);
  CHECK(contains(run.text, "moved 'bob' by 0.1 m"));
}

TEST_CASE("list, describe and schema speak of the same things", "[runner]") {
  const auto all = nlohmann::json::parse(call("list --json").text);
  for (const char* shelf : {"links", "laws", "forces", "integrators", "solvers"}) CHECK_FALSE(all[shelf].empty());
  CHECK(contains(call("list links").text, "revolute"));
  CHECK(contains(call("describe ramp").text, "slope"));
  CHECK(contains(call("describe body").text, "omega_world"));
  CHECK(contains(call("list laws --plugin '" + std::string(paths::kBuild) + "/test_plugins/probe.so'").text,
                 "probe_law"));
  CHECK(nlohmann::json::parse(call("schema").text).contains("$defs"));
}

TEST_CASE("several plugins stand before, between and after the other words", "[runner]") {
  const std::string plugins = std::string(paths::kPlugins);
  const std::string one = "--plugin '" + plugins + "/bump.so'", two = "--plugin '" + plugins + "/cam_follower.so'";
  const Called both = call("list " + one + " " + two);
  INFO(both.text);
  CHECK(both.exit == 0);
  CHECK(contains(both.text, "[plugin bump]"));
  CHECK(contains(both.text, "[plugin cam_follower]"));
  const Called before = call("check " + one + " '" + kFourBar + "' " + two);
  INFO(before.text);
  CHECK(before.exit == 0);
  CHECK(call("list " + one + " laws").exit == 0);
  const Called twice = call("list laws " + one + " --plugin bump --plugin '" + plugins + "/../plugins/bump.so'");
  INFO(twice.text);
  CHECK(twice.exit == 0);
}

TEST_CASE("wrong words are answered with the nearest right ones", "[runner]") {
  const auto text_of = [](const std::string& words) {
    const Called r = call(words);
    CHECK(r.exit == 2);
    CHECK(r.text.rfind("lockstep: ", 0) == 0);
    return r.text;
  };
  CHECK(contains(text_of("chek"), "unknown verb \"chek\"; did you mean \"check\"?"));
  CHECK(contains(text_of("--plugin bump describe bump"),
                 "option --plugin stands before the verb; write it behind: lockstep describe ... --plugin"));
  CHECK(contains(text_of("run '" + kFourBar + "' --untill 3"), "did you mean \"--until\"?"));
  CHECK(contains(text_of("run '" + kFourBar + "' more"), "one word too many"));
  const std::string free = scene_file("free", kArm + R"("run": {"until": 1})");
  CHECK(contains(text_of("run '" + free + "' --integrator rk4"), "--step"));
}

TEST_CASE("check lists the channels, describe says what stands under a key", "[runner]") {
  const auto channels = nlohmann::json::parse(call("check '" + kFourBar + "' --channels --json").text);
  std::size_t n_found = 0;
  for (const auto& c : channels) {
    if (c["name"] == "crank.x" && c["unit"] == "m" && c["of"] == "body 'crank'") ++n_found;
    if (c["name"] == "energy.total" && c["unit"] == "J" && c["of"] == "the whole mechanism") ++n_found;
  }
  CHECK(n_found == 2);
  const std::string text = call("check '" + kFourBar + "' --channels").text;
  CHECK(text.find("body 'crank':\n") < text.find("the whole mechanism:\n"));
  CHECK(contains(call("check '" + kFourBar + "'").text, "integrated for the summary only"));
  CHECK(contains(call("describe link").text, "see `lockstep describe drive`"));
  CHECK(contains(call("describe revolute").text, "see `lockstep describe drive`"));
  CHECK(contains(call("describe run").text, "list of channel names"));
  CHECK(contains(call("describe event").text, "list of texts"));
  const std::string all = call("list").text;
  CHECK(contains(all, "dopri5 (default)"));
  CHECK(contains(all, "schur (default)"));
  CHECK_FALSE(contains(all, "dense (default)"));
}

TEST_CASE("what is said without effect gives a warning, what is nothing is not said", "[runner]") {
  const std::string idle = scene_file("idle", kArm + R"("events": [{"name": "late", "at": 5, "stop": true}],
    "run": {"until": 1, "integrator": "rk4", "step": 0.5, "tolerance": 1e-6, "times": [1, 3], "record": ["arm.x"]})");
  const Called r = call("run '" + idle + "' --record idle.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "run.times: 3 s lies beyond"));
  CHECK(contains(r.text, "event 'late': its instant, 5 s, did not come"));
  CHECK(contains(r.text, "\"rk4\" takes fixed steps"));
  CHECK(contains(r.text, "(1 row)"));
  CHECK(contains(r.text, "nothing moved"));
  CHECK(contains(r.text, "no picture: nothing to draw"));
  for (const char* noise : {"rejected", "of the largest energy", "drift"}) CHECK_FALSE(contains(r.text, noise));
  CHECK(call("run '" + idle + "' --record idle.csv --quiet").text.empty());
}

TEST_CASE("a gear between a turn and a joint that holds its own is told", "[runner]") {
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
  CHECK(contains(held, "pairs[1]: link 'B' (prismatic) holds the turn about its z, so that the gear holds"));
  CHECK_FALSE(contains(held, "link 'A' (revolute) holds"));
  for (const char* joint : {"revolute", "cylindrical"}) CHECK_FALSE(contains(check(joint), "holds the turn"));
}

TEST_CASE("settings that cannot be meant are refused or said", "[runner]") {
  const std::string links = kArm + R"("links": [{)" + kHinge + "}], ";
  const auto run = [&](const std::string& settings, const std::string& more = "", const std::string& options = "") {
    return call("run '" +
                scene_file("odd", links + more + R"("run": {"until": 1, "record": ["arm.x"], )" + settings + "}") +
                "' --record odd.csv " + options);
  };
  check_refused(run(R"("output": 1e-12)"), 3, {"1e+12 rows; at most 1e+08"});
  check_refused(run(R"("output": 0.1)", "", "--tolerance 700"), 2,
                {"--tolerance", "700 allows errors", "take 1 or less"});
  const Called turned =
      call("run '" + scene_file("turned", R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1},
    "orientation": [0.74, 0.74, 0, 0]}], "run": {"until": 1})") +
           "' --record turned.csv");
  CHECK(turned.exit == 0);
  const std::string length = "body 'a', orientation: the quaternion has length 1.0465; its direction is taken, [0.707";
  CHECK(contains(turned.text, length));
  const std::string checked = call("check '" + kRunnerFolder + "/turned.json'").text;  // builds it several times
  CHECK(contains(checked, length));
  CHECK(checked.find(length) == checked.rfind(length));
  CHECK(contains(run(R"("output": 5)").text, "run.output: 5 s is longer than the run of 1 s"));
  CHECK(contains(run(R"("output": 0.5)", R"("forces": [{"name": "k", "type": "spring_damper", "p": "arm", "s": "ground",
    "at_p": [1,0,0], "at_s": [1,1,0], "stiffness": "-5 N/mm", "free_length": 1}], )")
                     .text,
                 "force 'k', stiffness: -5 N/mm is negative"));
}

TEST_CASE("events of a scene switch its forces", "[runner]") {
  const std::string scene = scene_file("switched", R"("bodies": [{"name": "stone", "particle": 2}],
    "forces": [{"name": "push", "type": "applied_force", "p": "stone", "force": [8, 0, 0], "active": false}],
    "events": [{"name": "on", "at": 1, "activate": ["push"]}, {"name": "off", "at": 2, "deactivate": ["push"]}],
    "run": {"until": 3, "output": 0.5, "record": ["stone.x", "push.power"]})");
  const Called r = call("run '" + scene + "' --record switched.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  const Table table = read_csv(kFolder + "/switched.csv");
  CHECK(table.last("stone.x") == Approx(2 + 4).epsilon(1e-9));
  CHECK(table["push.power"][1] == 0);
  CHECK(table["push.power"][3] == Approx(8 * 2).epsilon(1e-9));
  CHECK(table.last("push.power") == 0);
  const Called checked = call("check '" + scene + "'");
  CHECK(contains(checked.text, "body 'stone' starts at the world's origin"));
}

TEST_CASE("check ends as run does where a start that is not assembled violates the constraints", "[runner]") {
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

}  // namespace runner_test
