// SPDX-License-Identifier: BSD-3-Clause
// Facts that pages, messages and help texts state, each against what the program does.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include <lockstep/simulation.h>
#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace facts_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

std::string page(const std::string& name) {
  std::ifstream in(std::string(paths::kSource) + "/framework/" + name);
  REQUIRE(in.good());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A bar on a hinge, with these keys of the hinge and these further members of the scene.
std::string bar(const std::string& of_hinge, const std::string& members, const std::string& run) {
  return scene_file("fact", R"("bodies": [{"name": "bar", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "bar", "s": "ground", "at": [0,0,0])" +
                                of_hinge + R"(}], )" + members + R"("run": {"until": 1, "output": 0.1)" + run + "}");
}

}  // namespace

TEST_CASE("the channels that help texts name exist, and the usual names lead to them", "[facts]") {
  const std::string drive = R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}})";
  const std::string help = call("describe channel").text;
  const std::regex of_joint(R"("(A\.[a-z_.]+)\")");
  std::smatch named;
  REQUIRE(std::regex_search(help, named, of_joint));
  for (std::string rest = help; std::regex_search(rest, named, of_joint); rest = named.suffix()) {
    const Called ran = run_named(bar(drive, "", R"(, "record": [")" + named[1].str() + R"("])"), "fact");
    INFO(ran.text);
    CHECK(ran.exit == 0);
  }
  check_refused(call("run " + bar(drive, "", R"(, "record": ["A.reaction_x", "A.drive_torque"])")), 3,
                {R"(did you mean "force_on_p_world_x")", R"(did you mean "drive.torque_on_p_link_z")"});
}

TEST_CASE("nearly redundant constraints are released by default, as pages and help state", "[facts]") {
  CHECK(contains(call("describe run").text, "auto: removed, but kept if joints would open"));
  const Called checked = call("check '" + std::string(paths::kSource) + "/tests/stability/scenes/door.json'");
  INFO(checked.text);
  CHECK(contains(checked.text, "It is released"));
  CHECK(value_of(checked.text, "degrees of freedom") == "1");
  CHECK(contains(page("docs/faq.md"), "By default these constraints are released"));
}

TEST_CASE("the laws that the message of a jump names are registered", "[facts]") {
  const std::string law = R"({"type": "formula", "y": "=t < 0.1 ? 0 : 0.02"})";
  const Called ran = run_named(bar(R"(, "drive": {"axis": "rz", "law": )" + law + "}", "", ""), "fact");
  INFO(ran.text);
  CHECK(ran.exit == 5);
  std::smatch words;
  const std::regex list(R"(continuous law \(([a-z, ]+)\))");
  REQUIRE(std::regex_search(ran.text, words, list));
  const std::regex word("[a-z]+");
  const std::string laws = words[1];
  for (auto w = std::sregex_iterator(laws.begin(), laws.end(), word); w != std::sregex_iterator(); ++w)
    CHECK(call("describe " + w->str()).exit == 0);
}

TEST_CASE("exit code 5 covers laws that jump in mid-run", "[facts]") {
  CHECK(contains(call("--help").text, "5  the start, or a jump of a law, does not fit the constraints"));
}

TEST_CASE("limits of joints are one-sided constraints, as the page for users of Chrono states", "[facts]") {
  const std::string scene = bar(R"(, "stops": [{"axis": "rz", "low": -1}])", "", "");
  CHECK(contains(call("check " + scene + " --channels").text, "A.stop_rz_low"));
  CHECK(contains(page("FROM_CHRONO.md"), "one-sided constraints with impacts"));
}

TEST_CASE("a plane that cannot be kept is reported at a joint, not at the first line", "[facts]") {
  const Called refused = call("run " + bar("", R"("planar": "x", )", ""));
  check_refused(refused, 3, {"joint 'A'", R"(set "planar" to "off")"});
  CHECK_FALSE(contains(refused.text, ":1:1:"));
}

TEST_CASE("the rates of Baumgarte's method are numbers in 1/s", "[facts]") {
  const auto with = [](const std::string& alpha) {
    return bar("", "", R"(, "stabilization": {"kind": "baumgarte", "alpha": )" + alpha + "}");
  };
  CHECK(run_named(with("5"), "fact").exit == 0);
  for (const char* text : {R"("5 Hz")", R"("5 rad/s")"})
    check_refused(call("run " + with(text)), 3, {"alpha", "a number"});
  CHECK(contains(page("docs/reference.md"), "damping rate of Baumgarte stabilisation, 1/s"));
}

TEST_CASE("the default tolerances of scenes and of C++ programs are those of the pages", "[facts]") {
  CHECK(SimulationOptions().tolerance == 1e-8);
  CHECK(contains(page("docs/hosts.md"),
                 "a system that was built in C++, as in the next program. Its default tolerance is 1e-8"));
  CHECK(contains(page("docs/hosts.md"), "both tolerances, as `--tolerance` does. The default is 1e-6"));
  CHECK(contains(run_named(bar("", "", ""), "fact").text, "tolerance 1e-06"));
}

TEST_CASE("a step limits an adaptive method on the command line as in a scene", "[facts]") {
  const Called by_words = run_named(bar("", "", ""), "words", "--step 0.01 --tolerance 1e-9 -v");
  const Called by_keys = run_named(bar("", "", R"(, "step": 0.01, "tolerance": 1e-9)"), "keys", "-v");
  INFO(by_words.text << by_keys.text);
  CHECK((by_words.exit == 0 && by_keys.exit == 0));
  const auto steps = [](const Called& run) { return std::stoi(run.text.substr(run.text.find(" s in ") + 6)); };
  CHECK(steps(by_words) == steps(by_keys));
  CHECK(steps(by_words) >= 100);
}

TEST_CASE("errors known before the first step leave no file", "[facts]") {
  const auto damped = [] {
    return bar("", R"("forces": [{"name": "d", "type": "torsion_spring_damper", "p": "bar",
    "s": "ground", "at_p": [0,0,0], "at_s": [0,0,0], "damping": 1}], )",
               "");
  };
  const std::string left = kRunnerFolder + "/unstarted.csv.partial";
  std::filesystem::remove(left);
  check_refused(run_named(damped(), "unstarted", "--integrator rattle2 --step 0.01"), 3, {"depends on velocities"});
  CHECK_FALSE(std::filesystem::exists(left));
  check_refused(run_named(bar(R"(, "stops": [{"axis": "rz", "low": 0.5}])", "", ""), "unstarted"), 5,
                {"beyond the stop"});
  CHECK_FALSE(std::filesystem::exists(left));
}

TEST_CASE("kinematics that cannot begin leaves no file", "[facts]") {
  const std::string left = kRunnerFolder + "/undriven.csv.partial";
  check_refused(call("kinematics " + bar("", "", "") + " --record undriven.csv"), 3, {"not fully prescribed"});
  CHECK_FALSE(std::filesystem::exists(left));
}

TEST_CASE("joints are listed by both of their names", "[facts]") {
  const Called joints = call("list joints");
  CHECK(joints.exit == 0);
  CHECK(contains(joints.text, "revolute"));
  CHECK(joints.text == call("list links").text);
}

TEST_CASE("no message gives a rotation that is not finite", "[facts]") {
  const std::string fast = bar(R"(, "start": {"velocity": {"rz": 1}})",
                               R"("forces": [{"name": "s", "type": "torsion_spring_damper", "p": "bar",
    "s": "ground", "at_p": [0,0,0], "at_s": [0,0,0], "stiffness": 1e12}], )",
                               "");
  const Called ran = run_named(fast, "unstable", "--integrator semi_implicit_euler --step 0.1 --formulation omega");
  INFO(ran.text);
  CHECK(ran.exit != 0);
  CHECK(contains(ran.text, "is too long"));
  CHECK_FALSE(contains(ran.text, "inf rad"));
}

}  // namespace facts_test
