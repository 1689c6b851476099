// SPDX-License-Identifier: BSD-3-Clause
// The program, called as a person calls it.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace runner_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string& kFolder = kRunnerFolder;

}  // namespace

TEST_CASE("run writes the columns and reports the moved bodies", "[runner]") {
  const std::string csv = kFolder + "/bar.csv";
  fs::remove(csv);
  const Called r = call("run '" + kFourBar + "' --record bar.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  for (const char* word : {"results    theta  0.3 ... 7.3 rad", "energy ok", "constraints ok", "bar.csv"})
    CHECK(contains(r.text, word));
  const Called full = call("run '" + kFourBar + "' --record bar.csv --verbose");
  INFO(full.text);
  for (const char* word : {"results    theta  0.3 ... 7.3 rad", "energy ok",
                           "start      velocities follow from joints and drives; positions unchanged"})
    CHECK(contains(full.text, word));
  CHECK_FALSE(value_of(full.text, "work of drives").empty());
  const Called table_of_all = call("run '" + kFourBar + "' --record bar.csv --summary --verbose");
  INFO(table_of_all.text);
  CHECK(contains(table_of_all.text, "extremes of the motion:\n"));
  CHECK(row_of(table_of_all.text, "column") == "column unit least at t [s] greatest at t [s]");
  CHECK(row_of(table_of_all.text, "theta") == "theta rad 0.3 0 7.3 0.7");
  CHECK(row_of(table_of_all.text, "theta_d").starts_with("theta_d rad/s 10 "));
  CHECK_FALSE(contains(row_of(table_of_all.text, "theta_d"), "0."));  // constant: no times
  CHECK_FALSE(value_of(table_of_all.text, "drive_torque").empty());
  CHECK_FALSE(value_of(table_of_all.text, "work of drives").empty());
  const Table table = read_csv(csv);
  CHECK(table.n_rows() == 71);
  CHECK(table.last("theta") == Approx(7.3).epsilon(1e-12));
  std::ifstream file(csv);
  std::string header;
  std::getline(file, header);
  CHECK(contains(header, "t [s],theta [rad]"));
  CHECK(contains(header, "Bx [N]"));
}

TEST_CASE("runner: a run at rest exchanges no energy", "[runner]") {
  const std::string rest = scene_file("rest", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0, -1, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"until": 1, "output": 0.5, "record": ["rod.x"]})");
  const Called r = call("run '" + rest + "' --output 0.1 --record rest.csv");
  INFO(r.text);
  CHECK(contains(r.text, "energy ok (nothing exchanged)"));
  CHECK(read_csv(kRunnerFolder + "/rest.csv").n_rows() == 11);
}

TEST_CASE("options of the command line stand over the scene", "[runner]") {
  const Called r = call("run '" + kFourBar +
                        "' --integrator rk4 --step 1ms --until '50 ms' --solver dense --formulation quaternion"
                        " --stabilization baumgarte --record short.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "0.05 s in 50 steps"));
  CHECK(contains(r.text, "(rk4, step 0.001 s)"));
  CHECK(read_csv(kFolder + "/short.csv").last("t") == Approx(0.05));
  const Called quiet = call("run '" + kFourBar + "' --quiet --until 0.02");
  CHECK(quiet.exit == 0);
  CHECK(quiet.text.empty());
  CHECK(fs::exists(kFolder + "/four_bar.csv"));
}

TEST_CASE("every command has help with an example", "[runner]") {
  for (const char* verb : {"",          "run",        "check",   "list",    "describe", "schema",    "assemble",
                           "statics",   "kinematics", "inverse", "explain", "modes",    "linearize", "matrices",
                           "chart",     "advise",     "sweep",   "atlas",   "demo",     "import",    "report",
                           "reference", "completion", "man",     "resume",  "find",     "optimize",  "sensitivity"}) {
    const Called r = call(std::string(verb) + " --help");
    INFO(verb);
    CHECK(r.exit == 0);
    CHECK(contains(r.text, "Example:\n  lockstep "));
  }
}

TEST_CASE("help has names of values, not the notation of the parser", "[runner]") {
  const std::string run = call("run --help").text;
  INFO(run);
  for (const char* noise : {":BOOL", "Excludes", "Needs", "REQUIRED", ":{"}) CHECK_FALSE(contains(run, noise));
  for (const char* word : {"\nScene:\n", "\nMethod (defaults if the scene has none):\n", "\nResults:\n", "\nCheckpoints:\n", "--until TIME", "\"50 ms\"",
                           "x, y or z; off: motion in space", "(not with --picture)", "(with --certify)"})
    CHECK(contains(run, word));
  CHECK(contains(call("sweep --help").text, " (required)"));
}

TEST_CASE("the examples of the help texts run as they stand", "[runner]") {
  const fs::path samples = fs::path(paths::kScenes).parent_path();
  fs::remove(fs::path(kFolder) / "samples");
  fs::create_directory_symlink(samples, fs::path(kFolder) / "samples");
  int n = 0;
  for (const std::string verb :
       {"run", "check", "assemble", "statics", "kinematics", "inverse", "explain", "modes", "linearize", "matrices",
        "atlas", "list", "describe", "schema", "reference", "find", "optimize", "sensitivity"}) {
    const std::string help = call(verb + " --help").text;
    const std::size_t begin = help.find("  lockstep ", help.find("Example:")) + 2;
    const std::string line = help.substr(begin, help.find('\n', begin) - begin);
    const Called r = shell(line + (verb == "atlas" ? " --budget 1s" : ""));
    INFO(line << "\n" << r.text);
    CHECK(r.exit == 0);
    ++n;
  }
  CHECK(n == 18);
}

TEST_CASE("wrong words are a usage error", "[runner]") {
  const std::string run = "run '" + kFourBar + "' ";
  for (const auto& [words, said] : std::vector<std::pair<std::string, std::string>>{
           {"", "a command is missing; known: run, "},
           {"fly", "unknown command \"fly\"; known: run, "},
           {"run", "scene is required"},
           {run + "--fast", "unknown option \"--fast\"; known: "},
           {run + "--dt 1e-3", "unknown option \"--dt\"; did you mean \"--step\"?"},
           {run + "--step 0", "--step: the value is 0; it must be greater than 0 and finite"},
           {run + "--step x", "--step: \"x\" is not a time; write it as in --step 0.001"},
           {run + "--step =1",
            "--step: \"=1\" is not a time (formulas are for scenes only); write it as in --step 0.001"},
           {run + "--integrator rk5", "--integrator: unknown integrator \"rk5\"; did you mean \"rk4\"?"},
           {"list wheels", "kind: unknown \"wheels\"; known: joints, links,"},
           {"describe revolut", "describe: unknown name \"revolut\"; did you mean \"revolute\"?"}}) {
    INFO(words);
    check_refused(call(words), 2, {"error: ", said});
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
  CHECK(exit_of("run '" + apart + "'", "joint 'L'") == 5);
  // Two laws for one angle that agree in value and speed at the start, not in acceleration.
  const std::string torn =
      scene_file("torn", kArm + R"("links": [{)" + kHinge +
                             R"(, "drive": {"axis": "rz", "law": {"type": "polynomial", "coefficients": [0, 0, 1]}}},
    {"name": "B", "type": "lock", "mask": "e1 e2", "p": "arm", "s": "ground", "at": [0,0,0],
     "drive": {"axis": "rz", "law": {"type": "polynomial", "coefficients": [0, 0, 2]}}}], "run": {"integrator": "rk4", "step": 0.01, "until": 1})");
  CHECK(exit_of("run '" + torn + "'", "contradicts the others") == 6);
}

TEST_CASE("a run beyond the end of a spline is an error of the scene, which is named", "[runner]") {
  const std::string spline = R"({"type": "spline", "points": [[0, 1], [0.2, 1.1], [0.5, 1.3]]})";
  const std::string path = R"({"type": "path", "points": [[0, 0,0,0], [0.2, 0.1,0,-0.1], [0.5, 0.3,0,-0.2]]})";
  const std::string end = "has points from 0 to 0.5 and no value at ";
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
    CHECK(contains(r.text, "add points, or set \"outside\" to \"hold\""));
  };
  check(kArm + driven(spline), "error: t = 1 s: joint 'A' (revolute): the law of drive rz ('spline'): law 'spline'");
  check(kArm + driven(R"({"type": "sum", "laws": [)" + spline + "]}"),
        "error: t = 1 s: joint 'A' (revolute): the law of drive rz ('sum'): law 'spline'");
  check(kArm + R"("links": [{)" + kHinge +
            R"(}], "forces": [{"name": "M", "type": "torque_motor", "p": "arm", "s": "ground",
    "at": [0,0,0], "torque": )" +
            spline + "}], ",
        "error: t = 1 s: force 'M' (torque_motor): its law ('spline'): law 'spline'");
  check(kArm + R"("markers": [{"name": "K", "body": "ground", "translation": )" + path + R"(}],
    "links": [{"name": "A", "type": "spherical", "p": "arm", "s": "K", "at_p": [0,0,0]}], )",
        "error: t = 1 s: joint 'A' (spherical): the translation law of marker 'K' ('path'): law 'path'");
  check(R"("gravity": [0,0,-9.81], "bodies": [{"name": "bead", "particle": 0.1}],
    "links": [{"name": "wire", "type": "point_on_curve", "p": "bead", "s": "ground", "at_s": [0,0,0], "path": )" +
            path + "}], ",
        "s: joint 'wire' (point_on_curve): law 'path' has points", "bead.x");
  check(kArm + R"("markers": [{"name": "K", "body": "ground", "translation": )" + path + R"(}], "links": [{)" + kHinge +
            "}], ",
        "error: t = 0.6 s: channel 'K.x': law 'path' has points", "K.x");
  const std::string whole = kArm + driven(spline) + R"("run": {"until": 1})";
  check_refused(call("check '" + scene_file("ends", whole) + "'"), 3, {"t = 1 s", "drive rz", end});
  const std::string stopped = kArm + driven(spline) + R"("events": [{"name": "enough", "at": 0.3, "stop": true}],
    "run": {"until": 1})";
  CHECK(call("run '" + scene_file("ends", stopped) + "'").exit == 0);
  const std::string held = R"({"type": "spline", "points": [[0, 0], [0.5, 0.5]], "outside": "hold"})";
  const Called jumped = call("run '" + scene_file("ends", kArm + driven(held) + R"("run": {"until": 1})") + "'");
  INFO(jumped.text);
  CHECK(contains(jumped.text,
                 "energy     -0.167 J at the jump of drive A.rz in speed, an impact whose load is not recorded, "
                 "t = 0.5 s\n"));
}

TEST_CASE("a run whose energy is not conserved ends with its own status", "[runner]") {
  const std::string scene = scene_file("coarse", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1})");
  const Called r = call("run '" + scene + "'");
  INFO(r.text);
  CHECK(r.exit == 9);
  CHECK(contains(r.text, "WRONG     energy-not-conserved: "));
  CHECK(contains(r.text, "--tolerance"));
  const Called quiet = call("run '" + scene + "' --quiet");
  CHECK(quiet.exit == 9);
  CHECK(quiet.text.starts_with("error: the energy balance is off by "));
  const std::string wide = scene_file("wide", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1, "energy_limit": 100})");
  CHECK(call("run '" + wide + "'").exit == 0);
  const std::string drifts = scene_file("drifts", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega", "stabilization": "none", "violation_limit": "1 um"})");
  const Called d = call("run '" + drifts + "'");
  INFO(d.text);
  CHECK(d.exit == 9);
  CHECK(contains(d.text, "WRONG     constraints-drifted: "));
}

TEST_CASE("list, describe and schema speak of the same things", "[runner]") {
  CHECK(call("list joints").text.starts_with("  joints:\n"));
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
  const auto line_of = [&](const std::string& name) {
    const std::size_t at = both.text.find("\n    " + name + " ");
    REQUIRE(at != std::string::npos);
    return both.text.substr(at + 1, both.text.find('\n', at + 1) - at - 1);
  };
  CHECK(line_of("bump").ends_with("  bump"));
  CHECK(line_of("cam_follower").ends_with("  cam_follower"));
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
    CHECK(r.text.rfind("error: ", 0) == 0);
    return r.text;
  };
  CHECK(contains(text_of("chek"), "unknown command \"chek\"; did you mean \"check\"?"));
  CHECK(contains(text_of("--plugin bump describe bump"),
                 "option --plugin must follow the command: lockstep describe ... --plugin"));
  CHECK(contains(text_of("run '" + kFourBar + "' --untill 3"), "did you mean \"--until\"?"));
  CHECK(contains(text_of("run '" + kFourBar + "' more"), "unexpected word"));
  const std::string free = scene_file("free", kArm + R"("run": {"until": 1})");
  CHECK(contains(text_of("run '" + free + "' --integrator rk4"), "--step"));
}

TEST_CASE("a column that has no number at an instant is reported with it", "[runner]") {
  const std::string scene = scene_file("quotient", kArm + R"("run": {"until": 1, "integrator": "rk4", "step": 0.5,
    "record": [{"q": "=0/(t - 0.5) + 1"}]})");
  CHECK(contains(call("run '" + scene + "' --record quotient.csv").text, "results    q  no number at t = 0.5 s\n"));
  CHECK(std::isnan(read_csv(kFolder + "/quotient.csv").columns()[1].values[1]));
}

TEST_CASE("words without effect give a warning, empty values are not printed", "[runner]") {
  const std::string idle = scene_file("idle", kArm + R"("events": [{"name": "late", "at": 5, "stop": true}],
    "run": {"until": 1, "integrator": "rk4", "step": 0.5, "tolerance": 1e-6, "times": [1, 3], "record": ["arm.x"]})");
  const Called r = call("run '" + idle + "' --record idle.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "run.times: 3 s is after"));
  CHECK(contains(r.text, "event 'late': its time, 5 s, was not reached"));
  CHECK(contains(r.text, "\"rk4\" has fixed steps"));
  CHECK(contains(r.text, "results    arm.x  0.5 m\n"));  // it rests
  CHECK(contains(r.text, "no picture: nothing to draw"));
  const Called full = call("run '" + idle + "' --record idle.csv --verbose");
  INFO(full.text);
  CHECK(value_of(full.text, "rows") == "1");
  for (const char* noise : {"rejected", "of the largest energy", "violation of at most"})
    for (const Called& said : {r, full}) CHECK_FALSE(contains(said.text, noise));
  CHECK(call("run '" + idle + "' --record idle.csv --quiet").text.empty());
}

TEST_CASE("impossible settings are rejected or reported", "[runner]") {
  const std::string links = kArm + R"("links": [{)" + kHinge + "}], ";
  const auto run = [&](const std::string& settings, const std::string& more = "", const std::string& options = "") {
    return call("run '" +
                scene_file("odd", links + more + R"("run": {"until": 1, "record": ["arm.x"], )" + settings + "}") +
                "' --record odd.csv " + options);
  };
  check_refused(run(R"("output": 1e-12)"), 3, {"1e+12 rows (limit 1e+08)"});
  check_refused(run(R"("output": 0.1)", "", "--tolerance 700"), 2,
                {"--tolerance", "700 allows errors", "take 1 or less"});
  const Called turned =
      call("run '" + scene_file("turned", R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1},
    "orientation": [0.74, 0.74, 0, 0]}], "run": {"until": 1})") +
           "' --record turned.csv");
  CHECK(turned.exit == 0);
  const std::string length = "body 'a', orientation: the quaternion has length 1.0465; it is normalised to [0.707";
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
  const Called checked = call("check '" + scene + "' --verbose");
  CHECK(contains(checked.text, "body 'stone' starts at the world's origin"));
}

}  // namespace runner_test
