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
const std::string kFourBar = std::string(paths::kScenes) + "/four_bar.json";

const std::string kArm = R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}], )";
const std::string kHinge = R"("name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0])";

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

TEST_CASE("run, report, sweep and chart write pages", "[runner]") {
  const auto page = [](const std::string& name) {
    std::ifstream in(kFolder + "/" + name, std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::size_t begin = text.find(" id=\"data\">") + 11;
    return nlohmann::json::parse(text.substr(begin, text.find("</script>", begin) - begin));
  };
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
  for (const nlohmann::json& fact : bar["text"]["facts"]) conserved = conserved || fact[0] == "conserved";
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

  CHECK(call("run '" + kFourBar + "' --until 0.1 --record bar.csv --report bar.csv").exit == 2);
  CHECK(call("run '" + kFourBar + "' --until 0.1 --record bar.csv --report bar.png").exit == 2);
  const std::string own = scene_file("own", kArm + R"("run": {"until": 0.1})");
  const Called over = call("run '" + own + "' --record bar.csv --report '" + own + "'");
  CHECK(over.exit == 2);
  CHECK(contains(over.text, "from which the scene is read"));
}

TEST_CASE("a run that fails leaves a report of what it computed", "[runner]") {
  const std::string page = kFolder + "/broken.html";
  fs::remove(page);
  const std::string few = scene_file(
      "few", kArm + R"("run": {"until": 1, "integrator": "rk4", "step": 0.01, "max_steps": 20, "output": 0.05})");
  const Called r = call("run '" + few + "' --record broken.csv --report broken.html");
  INFO(r.text);
  CHECK(r.exit == 6);
  CHECK(contains(r.text, "its report up to there is"));
  std::ifstream in(page);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  CHECK(contains(text, "the run ended at t = 0.2 s"));
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
  const std::string in_space = "formulation         omega: link 'D' closes a loop";
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
  CHECK(!says(kFourBar, "", "coordinates of the joints"));
  CHECK(says(chain, "--full", "formulation         omega\n"));
  CHECK(!says(chain, "", "\"formulation\": \"auto\""));
  CHECK(says(kFourBar, "", "formulation         omega, in the plane with normal z\n"));
  CHECK(says(kFourBar, "--planar off", "formulation         omega: link '"));
  const std::string pendulum = kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 0.2, "integrator": ")";
  CHECK(says(scene_file("explicit", pendulum + "dopri5\"}"), "", "formulation         joint: 1 unknown"));
  CHECK(says(scene_file("implicit", pendulum + "radau5\"}"), "--planar off",
             "formulation         omega: integrator radau5 does not take joint coordinates"));
  CHECK(says(scene_file("driven_tree", R"("bodies": [{"name": "cart", "box": {"mass": 1, "size": [1, 1, 1]}},
    {"name": "free", "sphere": {"mass": 1, "radius": 1}}, {"name": "rod", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "S", "type": "prismatic", "p": "cart", "s": "ground", "at": [0,0,0], "axis": "x",
               "drive": {"axis": "z", "law": {"type": "ramp", "slope": 1}}},
              {"name": "A", "type": "spherical", "p": "rod", "s": "cart", "at": [0,0,0]}], "run": {"until": 1})"),
             "", "formulation         joint: 9 unknown velocities, no rows\n"));
  CHECK(says(kRunnerFolder + "/driven_tree.json", "",
             "  cart on ground by 'S': driven throughout, or held\n    rod on cart by 'A': rx, ry and rz\n"
             "  free on no link: x, y, z, rx, ry and rz\n"));
  const std::string omega = "\", \"formulation\": \"omega\"}",
                    proposal = "\"formulation\": \"auto\" integrates the joints'";
  CHECK(says(scene_file("asked", pendulum + "dopri5" + omega), "", proposal));
  CHECK(!says(scene_file("named", pendulum + "radau5" + omega), "", proposal));
  CHECK(says(scene_file("solved", pendulum + "dopri5\", \"solver\": \"sparse\"}"), "",
             "formulation         omega, in the plane"));
  const Called r = call("run '" + chain + "' --formulation joint --until 0.2 --record joint.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "conserved"));
}

TEST_CASE("every verb has help with an example", "[runner]") {
  for (const char* verb : {"", "run", "check", "list", "describe", "schema", "assemble", "chart", "advise", "sweep"}) {
    const Called r = call(std::string(verb) + " --help");
    INFO(verb);
    CHECK(r.exit == 0);
    CHECK(contains(r.text, "Example:\n  lockstep "));
  }
}

TEST_CASE("wrong words are a usage error", "[runner]") {
  for (const std::string& words :
       std::vector<std::string>{"", "fly", "run", "run '" + kFourBar + "' --fast", "run '" + kFourBar + "' --step 0",
                                "run '" + kFourBar + "' --step x", "run '" + kFourBar + "' --integrator rk5",
                                "list wheels", "describe revolut", "run '" + kFourBar + "' --step 1 --tolerance 1"}) {
    const Called r = call(words);
    INFO(words << "\n" << r.text);
    CHECK(r.exit == 2);
    CHECK_FALSE(r.text.empty());
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

TEST_CASE("a number that is none stops the run, what was computed is kept", "[runner]") {
  const std::string blow = scene_file("blow", kArm + R"("links": [{)" + kHinge + R"(,
    "drive": {"axis": "rz", "law": {"type": "sequence", "laws": [{"type": "constant", "value": 0}, {"type": "polynomial", "coefficients": [0, 1e308, 1e308]}],
    "durations": [0.5, 9]}}}], "run": {"integrator": "rk4", "step": 0.1, "until": 2, "record": ["arm.x"]})");
  fs::remove(kFolder + "/blow.csv");  // of an earlier run
  const Called r = call("run '" + blow + "' --record blow.csv");
  INFO(r.text);
  CHECK(r.exit == 7);
  CHECK(contains(r.text, "link 'A'"));
  CHECK(contains(r.text, "t = 0.5 s"));
  CHECK(contains(r.text, "rows up to there are in"));
  CHECK(read_csv(kFolder + "/blow.csv.partial").n_rows() >= 5);
  CHECK_FALSE(fs::exists(kFolder + "/blow.csv"));
  const Called full = call("run '" + blow + "' --record /dev/full");
  INFO(full.text);
  CHECK(full.exit == 7);  // the run's own error, not the disk's
  CHECK(contains(full.text, "could not be written"));
  CHECK(contains(full.text, "link 'A'"));
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
TEST_CASE("an interrupted run ends after its step with everything written", "[runner]") {
  const std::string swing = scene_file("swing", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "rk4", "step": 1e-3, "until": 1e6, "output": 1, "record": ["arm.x"]})");
  const Called r = call("run '" + swing + "' --record swing.csv", "timeout --foreground --preserve-status -s INT 3");
  INFO(r.text);
  CHECK(r.exit == 130);
  CHECK(contains(r.text, "interrupted at t = "));
  CHECK_FALSE(contains(r.text, "the caller"));
  CHECK(read_csv(kFolder + "/swing.csv").n_rows() >= 1);
  CHECK(call("run '" + swing + "' --record swing.csv", "timeout --foreground --preserve-status -s TERM 2").exit == 130);
}

TEST_CASE("an interrupted chart writes the runs that are done", "[runner]") {
  fs::remove(kFolder + "/charts/four_bar_chart.csv");
  // The first runs, the references, take longer on a busy machine: wait longer until one run is done before the signal.
  Called r;
  for (const char* seconds : {"3", "8", "20"}) {
    r = call("chart '" + kFourBar + "' --until 0.05 --budget 60 --out charts --quiet",
             std::string("timeout --foreground --preserve-status -s INT ") + seconds);
    if (contains(r.text, "the runs up to there are written")) break;
  }
  INFO(r.text);
  CHECK(r.exit == 130);
  CHECK(contains(r.text, "the runs up to there are written"));
  std::ifstream file(kFolder + "/charts/four_bar_chart.csv");
  std::string line;
  int n_lines = 0;
  while (std::getline(file, line)) {
    CHECK_FALSE(contains(line, "interrupted"));
    ++n_lines;
  }
  CHECK(n_lines > 1);
}

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
  CHECK(contains(broken.text, "inkless.csv (71 rows)"));
  CHECK(broken.text.find("inkless.csv (71 rows)") < broken.text.find("no picture: gnuplot could not draw"));
  CHECK(contains(broken.text, "out of ink"));
  const Called none = call("run '" + kFourBar + "' --record bare.csv", "PATH=/nowhere");
  CHECK(none.exit == 0);
  CHECK(contains(none.text, "no picture: gnuplot is not installed"));
  const Called torn = call("run '" + kFourBar + "' --record /dev/full");
  INFO(torn.text);
  CHECK(torn.exit == 8);
  CHECK(contains(torn.text, "energy balance"));
  CHECK(fs::is_character_file("/dev/full"));  // a device is written to, and never replaced
}

TEST_CASE("wrong words are answered with the nearest right ones", "[runner]") {
  const auto text_of = [](const std::string& words) {
    const Called r = call(words);
    CHECK(r.exit == 2);
    CHECK(r.text.rfind("lockstep: ", 0) == 0);
    return r.text;
  };
  CHECK(contains(text_of("chek"), "unknown verb \"chek\"; did you mean \"check\"?"));
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
  CHECK(contains(r.text, "event 'late': 5 s lies beyond"));
  CHECK(contains(r.text, "\"rk4\" takes fixed steps"));
  CHECK(contains(r.text, "(1 row)"));
  CHECK(contains(r.text, "nothing moved"));
  CHECK(contains(r.text, "no picture: nothing to draw"));
  for (const char* noise : {"rejected", "of the largest energy", "drift"}) CHECK_FALSE(contains(r.text, noise));
  CHECK(call("run '" + idle + "' --record idle.csv --quiet").text.empty());
}

TEST_CASE("a picture of some columns says how many", "[runner]") {
  const std::string wide = scene_file("wide", kArm + R"("gravity": [0, -9.81, 0], "run": {"until": 0.1, "record":
    ["arm.x", "arm.y", "arm.z", "arm.vx", "arm.vy", "arm.vz", "arm.qw", "arm.qx", "arm.qy", "arm.qz",
     "arm.ax", "arm.ay", "arm.az", {"x2": "arm.x"}, {"x3": "arm.x"}, {"x4": "arm.x"}, {"x5": "arm.x"}]})");
  const Called r = call("run '" + wide + "' --record wide.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  if (contains(r.text, "wide.png")) CHECK(contains(r.text, "drawn: 16 of 17 columns; choose with run.draw"));
}

TEST_CASE("a scene reads files of its own folder only, unless it may", "[runner]") {
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
    CHECK(contains(r.text, "\"" + file + "\" is outside of the scene's folder"));
    CHECK(contains(r.text, "--allow-files"));
  }
  CHECK(run("../outside.csv", "--allow-files").exit == 0);

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
  CHECK(contains(outside.text, "part.json\" is outside of the scene's folder"));
  CHECK(include("../part.json", "--allow-files").exit == 0);
}

TEST_CASE("settings that cannot be meant are refused or said", "[runner]") {
  const std::string links = kArm + R"("links": [{)" + kHinge + "}], ";
  const auto run = [&](const std::string& settings, const std::string& more = "", const std::string& options = "") {
    return call("run '" +
                scene_file("odd", links + more + R"("run": {"until": 1, "record": ["arm.x"], )" + settings + "}") +
                "' --record odd.csv " + options);
  };
  CHECK(contains(run(R"("output": 1e-12)").text, "1e+12 rows; at most 1e+08"));
  CHECK(run(R"("output": 1e-12)").exit == 3);
  CHECK(run(R"("output": 0.1)", "", "--tolerance 700").exit == 2);
  const Called turned =
      call("run '" + scene_file("turned", R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1},
    "orientation": [1, 1, 0, 0]}], "run": {"until": 1})") +
           "' --record turned.csv");
  CHECK(turned.exit == 0);
  CHECK(contains(turned.text, "body 'a', orientation: the quaternion has length 1.41; its direction is taken, [0.707"));
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

TEST_CASE("what a full standard output swallows is told", "[runner]") {
  CHECK(shell("lockstep check '" + kFourBar + "' --json > /dev/full").exit == 8);
}

}  // namespace runner_test
