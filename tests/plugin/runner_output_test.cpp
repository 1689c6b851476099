// SPDX-License-Identifier: BSD-3-Clause
// The program, as other programs use it: JSON, standard streams, completion, the manual.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/progress.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/run_scene.h"

namespace runner_output_test {

using namespace lockstep;
using namespace lockstep::testing;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string kPendulum = std::string(paths::kScenes) + "/pendulum.json";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

std::vector<std::string> completed(const std::string& words) { return lines_of(call("complete " + words).text); }

bool has(const std::vector<std::string>& all, const std::string& word) {
  return std::find(all.begin(), all.end(), word) != all.end();
}

}  // namespace

TEST_CASE("a loose tolerance does not round results to zero", "[runner]") {
  const Called r = call("run " + sample("double_pendulum") + " --tolerance 1 --until 2 --no-picture --summary");
  INFO(r.text);
  CHECK(contains(r.text, "q1"));
  CHECK_FALSE(row_of(r.text, "q1").starts_with("q1 0 "));
}

TEST_CASE("a pole of a column rounds no other to zero, and hides no extreme", "[runner]") {
  std::ofstream(kRunnerFolder + "/pole.json") << R"~({"lockstep": 1, "gravity": [0, -10, 0],
    "bodies": [{"name": "b", "particle": 2, "velocity": [1, 5, 0]}],
    "require": ["=abs(b.y - 0.7 m) > 0.01 m"],
    "run": {"until": 1, "output": 0.1, "record": ["b.y", {"q": "=b.y/b.vy*(1 m/(1 s))"}]}})~";
  const Called r = call("run '" + kRunnerFolder + "/pole.json' --no-picture");
  INFO(r.text);
  CHECK(contains(r.text, "b.y  0 ... 1.25 m"));
  CHECK(contains(r.text, "at least m"));
  CHECK(contains(r.text, "first at t = 0.165336 s, and worst at t = 0.168338 s by 0.01 m"));
  CHECK(r.exit == 9);
}

TEST_CASE("a channel in place of the name of a CSV file is rejected", "[runner]") {
  const std::string run = "run " + scene_path("four_bar") + " --quiet --record ";
  check_refused(call(run + "A.force_x"), 2, {"--record names the CSV file", "\"A.force_x\"", "\"record\" of \"run\""});
  check_refused(call("inverse " + scene_path("four_bar") + " --record A.force_x"), 2, {"--record names the CSV file"});
  for (const char* file : {"A.csv", "A.txt", "A_force"}) CHECK(call(run + file).exit == 0);
}

TEST_CASE("run --json prints its result, and nothing else", "[runner]") {
  const Called r = call("run '" + kFourBar + "' --json --no-picture --record as_json.csv");
  CHECK(r.exit == 0);
  const json j = json::parse(r.text);
  CHECK(j["status"] == "ok");
  CHECK(j["t"] == Approx(0.7));
  CHECK(j["rows"] == 71);
  CHECK(j["energy"]["verdict"] == "conserved");
  CHECK_FALSE(j["drift"]["drifted"].get<bool>());
  CHECK(j["method"]["integrator"] == "dop853");
  CHECK(j["columns"][0]["name"] == "theta");
  CHECK(j["columns"][0]["unit"] == "rad");
  CHECK(j["columns"][0]["final"] == Approx(read_csv(kRunnerFolder + "/as_json.csv").last("theta")));
  CHECK(j["files"].size() == 1);
  CHECK_FALSE(fs::exists(kRunnerFolder + "/as_json.png"));
}

TEST_CASE("run --json reports a run that failed, and one that is wrong", "[runner]") {
  const Called failed =
      call("run '" + kFourBar + "' --json --set run.max_steps=3 --no-picture --record cut.csv 2>/dev/null");
  CHECK(failed.exit == 6);
  const json f = json::parse(failed.text);
  CHECK(f["status"] == "failed");
  CHECK(contains(f["error"].get<std::string>(), "max_steps"));
  CHECK(f["t"].get<double>() < 0.7);

  const Called off = call("run '" + kPendulum +
                          "' --json --set run.violation_limit=1e-6 --integrator rk4 --step 0.2 --formulation omega "
                          "--stabilization none --no-picture "
                          "--record drifts.csv 2>/dev/null");
  CHECK(off.exit == 9);
  const json w = json::parse(off.text);
  CHECK(w["status"] == "wrong");
  CHECK(w["drift"]["drifted"].get<bool>());
  CHECK(w["drift"]["violation"].get<double>() > w["drift"]["limit"].get<double>());
}

TEST_CASE("a dash is standard input, and standard output", "[runner]") {
  const Called r = shell("lockstep run - --record - 2>words.txt <'" + kFourBar + "'");
  CHECK(r.exit == 0);
  const std::vector<std::string> lines = lines_of(r.text);
  REQUIRE(lines.size() == 72);
  CHECK(lines.front().starts_with("t [s],theta [rad]"));
  std::ofstream(kRunnerFolder + "/piped.csv") << r.text;
  CHECK(read_csv(kRunnerFolder + "/piped.csv").last("theta") == Approx(7.3).epsilon(1e-12));
  std::stringstream words;
  words << std::ifstream(kRunnerFolder + "/words.txt").rdbuf();
  CHECK(contains(words.str(), "energy ok"));
  const Called broken = shell("echo '{' | lockstep check -");
  CHECK(broken.exit == 3);
  CHECK(contains(broken.text, "standard input"));
  check_refused(call("run '" + kFourBar + "' --record - --json"), 2, {"--json: standard output takes the table"});
  check_refused(call("run '" + kFourBar + "' --certify --json"), 2, {"--certify excludes --json"});
  check_refused(call("run '" + kFourBar + "' --report -"), 2, {"--report: the report needs a file"});
  const std::string sweep = "sweep '" + kFourBar + "' --vary crank='80 mm,100 mm' --until 0.1 --record - ";
  const std::vector<std::string> rows = lines_of(call(sweep + "2>/dev/null").text);
  REQUIRE(rows.size() == 3);
  CHECK(rows.front().starts_with("run,crank [m]"));
  check_refused(call(sweep + "--json"), 2, {"--json: standard output takes the table"});
  check_refused(call(sweep + "--report r.html"), 2,
                {"--report: the table goes to standard output"});
}

TEST_CASE("check accepts several scenes, and continues after a wrong one", "[runner]") {
  const Called r = call("check --json '" + kFourBar + "' missing.json '" + kPendulum + "' 2>/dev/null");
  CHECK(r.exit == 8);
  const json j = json::parse(r.text)["scenes"];
  REQUIRE(j.size() == 3);
  CHECK(j[0]["freedoms"] == 0);
  CHECK(contains(j[1]["error"].get<std::string>(), "missing.json"));
  CHECK(j[2]["freedoms"] == 1);
}

TEST_CASE("the channels of several scenes are one document", "[runner]") {
  const json j = json::parse(
      call("check '" + kFourBar + "' missing.json '" + kPendulum + "' --channels --json 2>/dev/null").text)["scenes"];
  REQUIRE(j.size() == 3);
  CHECK(j[0]["channels"].size() > 100);
  CHECK(j[1].contains("error"));
  CHECK(j[2]["channels"].size() > 30);
}

TEST_CASE("check --channels --of lists those of one thing", "[runner]") {
  const Called r = call("check '" + kFourBar + "' --channels --of crank --json");
  CHECK(r.exit == 0);
  const json j = json::parse(r.text)["channels"];
  CHECK(j.size() > 30);
  for (const json& channel : j) CHECK(channel["of"] == "body 'crank'");
  const Called wrong = call("check '" + kFourBar + "' --channels --of crnk");
  CHECK(wrong.exit == 2);
  CHECK(contains(wrong.text, "did you mean \"crank\""));
}

TEST_CASE("sweep, chart, advise and describe print JSON", "[runner]") {
  const json s =
      json::parse(call("sweep '" + kFourBar + "' --vary crank='80 mm,100 mm' --json --record sweep_json.csv").text);
  REQUIRE(s["runs"].size() == 2);
  CHECK(s["runs"][1]["values"]["crank"] == Approx(0.1));
  CHECK(s["runs"][1]["columns"]["theta"]["final"] == Approx(7.3));
  CHECK(s["runs"][0]["status"] == "ok");

  const json c =
      json::parse(call("chart '" + kPendulum +
                       "' --until 0.2 --integrators rk4,dopri5 --formulations omega --stabilizations project "
                       "--solvers schur --tolerances 1e-3:1e-6 --steps 2ms:1ms --budget 20 --json --quiet --out charts")
                      .text);
  CHECK(c["runs"].size() >= 4);
  CHECK(c["runs"][0]["error"]["position"].is_number());
  CHECK(c["cheapest"].size() >= 1);

  const json a = json::parse(call("advise '" + kPendulum +
                                  "' --until 0.2 --integrators dopri5 --formulations omega --stabilizations project "
                                  "--solvers schur --error 1e-4 --budget 20 --json --quiet")
                                 .text);
  CHECK(a["cheapest"]["error"]["position"].get<double>() <= 1e-4);
  CHECK(contains(a["cheapest"]["command"].get<std::string>(), "--tolerance"));

  const json d = json::parse(call("describe revolute --json").text);
  CHECK(d["types"][0]["shelf"] == "links");
  const json w = json::parse(call("describe stops --json").text);
  CHECK(contains(w["help"].get<std::string>(), "limits of the free coordinates"));
  CHECK(contains(call("describe 6").text, "exit code 6  a step"));
  CHECK(json::parse(call("list findings --json").text)["codes"].size() > 30);
  // only the keys that the type accepts, the required ones marked, and its channels
  const std::string motor = call("describe torque_motor").text, friction = call("describe joint_friction").text;
  CHECK_FALSE(contains(motor, "\n  link "));
  CHECK(row_of(motor, "s") ==
        "s text required marker S, from which P is measured, or the body on which a new marker S is placed");
  CHECK(contains(motor, "F.torque              N m     torque on P's body about +z of S"));
  CHECK_FALSE(contains(friction, "\n  at_p "));
  CHECK(contains(row_of(friction, "link"), "link text required"));
}

TEST_CASE("demo writes a scene and its report, and keeps a scene that is there", "[runner]") {
  const fs::path folder = fs::path(kRunnerFolder) / "demo";
  fs::remove_all(folder);
  const Called r = call("demo --no-open --into demo");
  CHECK(r.exit == 0);
  for (const char* file : {"four_bar.json", "four_bar.csv", "four_bar.html"}) {
    CHECK(fs::exists(folder / file));
    CHECK(contains(value_of(r.text, "written"), std::string("demo/") + file));
  }
  CHECK(contains(r.text, "simulated  0.7 s in"));  // the end of the scene that is written
  CHECK(r.text.find("simulated") < r.text.find("Next:\n  change the crank   lockstep report demo/four_bar.json"));
  std::stringstream sample, written;
  sample << std::ifstream(kFourBar).rdbuf(), written << std::ifstream(folder / "four_bar.json").rdbuf();
  CHECK(written.str() == sample.str());
  std::ofstream(folder / "four_bar.json", std::ios::app) << "\n";
  const Called again = call("demo --no-open --into demo");
  CHECK(again.exit == 0);
  CHECK(contains(again.text, "shown unchanged"));
  std::stringstream kept;
  kept << std::ifstream(folder / "four_bar.json").rdbuf();
  CHECK(kept.str() == sample.str() + "\n");
  CHECK(read_csv((folder / "four_bar.csv").string()).last("t") == Approx(0.7));  // what it says, not some turns
}

TEST_CASE("import writes a robot as a scene that runs", "[runner]") {
  std::ofstream(kRunnerFolder + "/bot.urdf") << R"(<robot name="bot"><link name="base"/>
    <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="1"/><inertia ixx="1e-3" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
      <visual><geometry><mesh filename="a.stl"/></geometry></visual></link>
    <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint></robot>)";
  fs::remove(kRunnerFolder + "/bot.json");
  const Called r = call("import bot.urdf --out bot.json");
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "left out: meshes: 'arm'"));
  const Called checked = call("check bot.json");
  INFO(checked.text);
  CHECK(value_of(checked.text, "bodies").starts_with("arm (+ "));
  CHECK(value_of(checked.text, "degrees of freedom") == "1");
  const Called run = call("run bot.json --no-picture --verbose");
  INFO(run.text);
  CHECK(run.exit == 0);
  CHECK(contains(run.text, "energy ok"));
  CHECK_FALSE(value_of(run.text, "exchanged").empty());
  CHECK(value_of(run.text, "exchanged") != "0 J");  // it falls
  check_refused(call("import bot.urdf --out bot.json"), 2, {"--out: 'bot.json' exists"});
  check_refused(call("import missing.urdf"), 8, {"cannot read 'missing.urdf': there is no such file"});

  // The mesh is there: damaged, whole, and seen from a folder beside.
  const auto import_to = [](const std::string& out) {
    fs::remove(kRunnerFolder + "/" + out);
    return call("import bot.urdf --out " + out);
  };
  std::ofstream(kRunnerFolder + "/a.stl") << "solid a\n facet\n";
  CHECK(contains(import_to("bot.json").text, "a.stl:2: the file ends"));
  fs::copy_file(std::string(paths::kSource) + "/tests/fuzz/corpus/mesh/cube_text.stl", kRunnerFolder + "/a.stl",
                fs::copy_options::overwrite_existing);
  const Called whole = import_to("bot.json");
  CHECK_FALSE(contains(whole.text, "left out"));
  CHECK_FALSE(contains(whole.text, "--allow-files"));
  CHECK(call("run bot.json --no-picture --report bot.html").exit == 0);
  std::stringstream page;
  page << std::ifstream(kRunnerFolder + "/bot.html").rdbuf();
  CHECK(contains(page.str(), "\"kind\":\"mesh\""));
  fs::create_directories(kRunnerFolder + "/beside");
  CHECK(contains(import_to("beside/bot.json").text, "--allow-files"));
  check_refused(call("check beside/bot.json"), 2, {"is outside the scene's folder", "--allow-files"});
  CHECK(call("check beside/bot.json --allow-files").exit == 0);
  fs::remove(kRunnerFolder + "/a.stl");
}

TEST_CASE("import leaves a joint that it cannot convert out only if --without names it", "[runner]") {
  const auto write = [](const std::string& more) {
    std::ofstream(kRunnerFolder + "/loop.urdf")
        << "<robot name='loop'><link name='base'/><link name='arm'><inertial>"
           "<mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
           "<joint name='hinge' type='continuous'><parent link='base'/><child link='arm'/></joint>" +
               more + "</robot>";
  };
  write("<loop_joint name='close'><link1 link='arm'/><link2 link='base'/></loop_joint><jont name='typo'/><gazebo/>");
  fs::remove(kRunnerFolder + "/loop.json");
  check_refused(call("import loop.urdf --out loop.json"), 3,
                {"loop.urdf: <loop_joint> 'close'", "--without loop_joint", "<jont> 'typo'"});
  CHECK_FALSE(fs::exists(kRunnerFolder + "/loop.json"));
  check_refused(call("import loop.urdf --without jont"), 3, {"<loop_joint> 'close'"});
  const std::string both = "import loop.urdf --out loop.json --without loop_joint --without jont";
  const Called r = call(both);
  INFO(r.text);
  CHECK(r.exit == 0);
  for (const char* line : {"left out: <loop_joint>: 'close'", "left out: <jont>: 'typo'", "left out: <gazebo>: 'loop'"})
    CHECK(contains(r.text, line));
  fs::remove(kRunnerFolder + "/loop.json");
  check_refused(call(both + " --without loop_jont"), 2,
                {"--without: no <loop_jont> is left out", "remove it, or correct its name"});
  check_refused(call(both + " --without link"), 2, {"--without: no <link> is left out"});
  CHECK_FALSE(fs::exists(kRunnerFolder + "/loop.json"));
  // Joints of other blocks by their own name, or with the block.
  write("<gazebo><joint name='back'><parent>arm</parent><child>base</child></joint></gazebo>");
  check_refused(call("import loop.urdf"), 3, {"<joint> 'back' in <gazebo>"});
  CHECK(contains(call("import loop.urdf --without joint").text, "left out: <joint>: 'back'"));
  const Called block = call("import loop.urdf --without gazebo");
  CHECK(block.exit == 0);
  CHECK(contains(block.text, "left out: <gazebo>: 'loop'"));
  CHECK(contains(block.text, "\"hinge\""));
}

TEST_CASE("describe reports a scene's parameters: value, place, dependent values", "[runner]") {
  const Called crank = call("describe crank --scene '" + kFourBar + "'");
  CHECK(crank.exit == 0);
  for (const char* word : {"crank  parameter  0.1 m  100 mm", "four_bar.json:", "points.B"})
    CHECK(contains(crank.text, word));
  CHECK_FALSE(contains(crank.text, "points.C"));  // it hangs on B
  const json D = json::parse(call("describe D --scene '" + kFourBar + "' --json").text)["parameters"].at(0);
  CHECK(D["kind"] == "point");
  CHECK(D["value"] == "[0.28, 0, 0] m");
  CHECK(D["written"] == "=A + [base, 0, 0]");
  CHECK(contains(call("describe A --scene '" + kFourBar + "'").text,
                 "another value: --set A.x=..., --set A=\"=[1, 2, 3]\", a range: --vary A.x=..."));
  const std::string of_D = call("describe D --scene '" + kFourBar + "'").text;  // a formula: it has no parts
  CHECK(contains(of_D, "another value: --set D=\"=[1, 2, 3]\"\n"));
  CHECK(contains(of_D, "parameters.BD, bodies.rocker.rod.from and joints.D.at"));
  CHECK(contains(crank.text, "another value: --set crank=..., a range: --vary crank=..."));
  for (const char* setting : {"--set A.x=0.001", "--set A=\"=[0.001, 0, 0]\"", "--set D=\"=[0.28, 0.001, 0]\""})
    CHECK(call("check '" + kFourBar + "' " + setting).exit == 0);
  CHECK(D["read_by"] == json({"parameters.BD", "bodies.rocker.rod.from", "joints.D.at"}));
  CHECK(json::parse(call("describe --scene '" + kFourBar + "' --json").text)["parameters"].size() == 11);
  const Called wrong = call("describe crnk --scene '" + kFourBar + "'");
  CHECK(wrong.exit == 2);
  CHECK(contains(wrong.text, "did you mean \"crank\""));
  check_refused(call("describe"), 2, {"describe: a name is missing, as in `lockstep describe revolute`"});
  const std::string scene = kRunnerFolder + "/readers.json";
  std::ofstream(scene) << R"~({"lockstep": 1, "parameters": {"rod": "1 m", "n": 2, "s": "2 m"},
    "bodies": [{"name": "rod", "rod": {"mass": "=1 kg*(3 s/(2 s))", "from": [0, 0, 0], "to": "=[rod, 2*s, 0]"}},
               {"name": "tip", "particle": 1, "position": "=rod.to"}],
    "repeat": [{"times": "=n", "points": {"P{i}": "=[{i+n}*s, 0, 0]"},
                "bodies": [{"name": "b_{i+n}", "particle": 1, "position": "P{i}"}]}]})~";
  const auto readers = [&](const std::string& name) {
    const Called of = call("describe " + name + " --scene '" + scene + "' --json");
    INFO(of.text);
    REQUIRE(of.exit == 0);
    return json::parse(of.text)["parameters"].at(0)["read_by"];
  };
  CHECK(contains(call("describe P0 --scene '" + scene + "'").text, "change the values of the part"));
  CHECK(readers("rod") == json({"bodies.rod.rod.to"}));  // "rod.to" is of the body
  CHECK(readers("n") == json({"repeat.0.times", "repeat.0.points.P{i}", "repeat.0.bodies.b_{i+n}.name"}));
  CHECK(readers("s") == json({"bodies.rod.rod.to", "repeat.0.points.P{i}"}));
}

TEST_CASE("completion offers commands, options, choices, types and names of the scene", "[runner]") {
  CHECK(has(completed("''"), "run"));
  CHECK_FALSE(has(completed("''"), "complete"));
  CHECK(completed("run --tol") == std::vector<std::string>{"--tolerance"});
  CHECK(has(completed("run --planar ''"), "auto"));
  CHECK(completed("run --integrator=rada") == std::vector<std::string>{"--integrator=radau5"});
  CHECK(completed("run --integrator rada") == std::vector<std::string>{"radau5"});
  CHECK(completed("run ''").front() == ":files");
  CHECK(has(completed("describe revo"), "revolute"));
  CHECK(has(completed("describe orie"), "orientation"));
  CHECK(has(completed("list ''"), "solvers"));
  CHECK(has(completed("plugins ''"), "list"));
  CHECK(completed("run '" + kFourBar + "' --set cran") == std::vector<std::string>{"crank="});
  CHECK(completed("check '" + kFourBar + "' --channels --of cr") == std::vector<std::string>{"crank"});
  CHECK(completed("run missing.json --set ''").empty());
  CHECK(completed("nonsense --what ''").empty());
}

TEST_CASE("the script for bash completes words as bash cuts them", "[runner]") {
  const auto replies = [](const std::string& line, const std::string& words, int at) {
    std::ofstream(kRunnerFolder + "/complete.sh")
        << "source <(lockstep completion bash)\n"
        << "COMP_LINE='" << line << "' COMP_POINT=${#COMP_LINE} COMP_WORDS=(" << words << ") COMP_CWORD=" << at << "\n"
        << "_lockstep\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
    return lines_of(shell("bash complete.sh").text);
  };
  CHECK(replies("lockstep advi", "lockstep advi", 1) == std::vector<std::string>{"advise"});
  CHECK(replies("lockstep run --integrator=rada", "lockstep run --integrator = rada", 4) ==
        std::vector<std::string>{"radau5"});
  CHECK(replies("lockstep run --planar ", "lockstep run --planar ''", 3).size() == 5);
  std::ofstream(kRunnerFolder + "/only_this.json") << "{}";
  CHECK(replies("lockstep run only_th", "lockstep run only_th", 2) == std::vector<std::string>{"only_this.json"});
  std::ofstream(kRunnerFolder + "/two words.json") << "{}";
  CHECK(replies("lockstep run two\\ wo", "lockstep run 'two\\ wo'", 2) == std::vector<std::string>{"two words.json"});
  CHECK(replies("lockstep import only_th", "lockstep import only_th", 2) == std::vector<std::string>{"only_this.json"});
  CHECK(replies("lockstep run --report=only_th", "lockstep run --report = only_th", 4) ==
        std::vector<std::string>{"only_this.json"});
}

// A line as zsh leaves it when the tabulator is pressed at its end: zsh runs on a terminal of its own (zsh/zpty).
TEST_CASE("the script for zsh completes lines in a zsh", "[runner]") {
  if (shell("command -v zsh").exit != 0) {
    WARN("skipped: zsh is not installed (tests/run installs it where it may)");
    return;
  }
  std::ofstream(kRunnerFolder + "/complete.zsh") << R"zsh(zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1='> '; unsetopt prompt_sp; unset zle_bracketed_paste; autoload -Uz compinit; compinit -u -D"
zpty -w shell "source <(lockstep completion zsh); show() { print -r -- \$'\n'\"[[\$BUFFER]]\"; BUFFER=; }; zle -N show"
zpty -w shell "bindkey '^T' show; print -r -- REA''DY"
zpty -r -m shell all '*READY*'
zpty -w -n shell "$1"$'\t'$'\x14'
zpty -r -m shell all '*\[\[*\]\]*'
print -r -- "${${all##*\[\[}%%\]\]*}"
zpty -d shell
)zsh";
  std::ofstream(kRunnerFolder + "/only_this.json") << "{}";
  const auto completed_line = [](const std::string& line) {
    const std::vector<std::string> lines = lines_of(shell("timeout 20 zsh -f complete.zsh '" + line + "'").text);
    return lines.empty() ? "" : lines.back();
  };
  CHECK(completed_line("lockstep advi") == "lockstep advise ");
  CHECK(completed_line("lockstep run --integrator=rada") == "lockstep run --integrator=radau5 ");
  CHECK(completed_line("lockstep run only_th") == "lockstep run only_this.json ");
  CHECK(completed_line("lockstep run --report=only_th") == "lockstep run --report=only_this.json ");
  CHECK(completed_line("lockstep run " + kFourBar + " --set cran") == "lockstep run " + kFourBar + " --set crank=");
}

TEST_CASE("the manual has every command and every option", "[runner]") {
  const std::string page = call("man").text;
  CHECK(page.starts_with(".TH LOCKSTEP 1"));
  for (const std::string& verb : completed("''")) {
    INFO(verb);
    if (verb == "plugins") continue;  // its own verbs are named
    std::string name = verb;
    if (const std::size_t dash = name.find('-'); dash != std::string::npos) name.insert(dash, "\\");
    CHECK(contains(page, ".SS \"lockstep " + name));
    for (std::string option : completed(verb + " --")) {
      if (option == "--help") continue;
      std::string escaped;
      for (const char c : option) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
      CHECK(contains(page, "\\fB" + escaped + "\\fR"));
    }
  }
}

TEST_CASE("groff accepts the manual without a warning", "[runner]") {
  if (shell("command -v groff").exit != 0) {
    WARN("skipped: groff is not installed (tests/run installs it where it may)");
    return;
  }
  const std::string said = shell("lockstep man | groff -man -ww -Tutf8 2>&1 >/dev/null").text;
  CHECK(said.empty());
}

TEST_CASE("a line of progress fits its terminal", "[runner]") {
  for (const std::size_t width : {79u, 60u, 50u})
    for (const Counts counts : {Counts::seconds, Counts::runs, Counts::budget})
      for (const double t : {0.0, 1.23456789e-5, 3.3, 999999.0}) {
        const std::string line = progress_line(t, 1e6, 12345.6, width, counts);
        INFO(line);
        if (line.front() == '[') CHECK(line.size() <= width);
      }
  const std::string usual = progress_line(1.2, 2.4, 3, 79);
  CHECK(usual.size() <= 79);
  CHECK(usual.starts_with("[####"));
  CHECK(progress_line(1.2, 2.4, 3, 0).front() != '[');
}

TEST_CASE("a message common to many runs is not printed for each", "[runner]") {
  const Called r = call("chart '" + kPendulum +
                        "' --integrators semi_implicit_euler --formulations omega --stabilizations "
                        "project --solvers schur --steps 0.1:0.05 --budget 5 --quiet --out charts");
  CHECK_FALSE(contains(r.text, "warning"));
  const Called s = call("sweep '" + kPendulum +
                        "' --vary gravity.1=-9:-10:12 --integrator semi_implicit_euler --step 0.2 "
                        "--record many.csv");
  const std::size_t first = s.text.find("warning");
  REQUIRE(first != std::string::npos);
  CHECK(s.text.find("warning", first + 1) == std::string::npos);
  CHECK(contains(s.text, "(in 12 runs)"));
}

}  // namespace runner_output_test
