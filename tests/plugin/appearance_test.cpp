// SPDX-License-Identifier: BSD-3-Clause
// What a plugin registers looks, in every command, like what is built in, and says where it comes from.
#include <nlohmann/json.hpp>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include "framework/description/scene/describe.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace appearance_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const std::string kNaughty = " --plugin '" + kModules + "/naughty.so'";

// An arm whose hinge follows the law of a plugin.
std::string scene_with(const std::string& name, const std::string& law) {
  return scene_file(name, R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0],
               "drive": {"axis": "rz", "law": )" +
                              law + R"(}}],
    "run": {"until": 0.1, "output": 0.05, "record": ["A.rz"]})");
}

}  // namespace

TEST_CASE("list and describe show what a plugin brings", "[plugin][appearance]") {
  const Called list = call("list" + kNaughty);
  INFO(list.text);
  CHECK(list.exit == 0);
  CHECK(row_of(list.text, "name") == "name what it is of plugin");
  for (const char* name : {"naughty_law", "naughty_link", "naughty_force", "naughty_integrator"}) {
    CHECK(row_of(list.text, name) == std::string(name) + " does what it must not naughty");
    const Called described = call(std::string("describe ") + name + kNaughty);
    INFO(described.text);
    CHECK(described.exit == 0);
    CHECK(contains(described.text, "from plugin naughty"));
    CHECK(contains(described.text, "what it does wrong"));
  }
  CHECK_FALSE(contains(call("list").text, "naughty"));
  check_refused(call("describe naughty_law"), 2, {"describe: unknown name \"naughty_law\""});
  CHECK(contains(call("describe naughty_lau" + kNaughty).text, "did you mean \"naughty_law\""));
  const auto json = nlohmann::json::parse(call("list laws --json" + kNaughty).text);
  bool found = false;
  for (const auto& law : json["laws"])
    if (law["name"] == "naughty_law") found = law["origin"] == "naughty" && law["keys"][0]["name"] == "does";
  CHECK(found);
}

TEST_CASE("the schema knows a plugin's types and their keys", "[plugin][appearance]") {
  const std::string with = call("schema" + kNaughty).text, without = call("schema").text;
  CHECK_NOTHROW(nlohmann::json::parse(with));
  for (const char* name : {"naughty_law", "naughty_link", "naughty_force", "naughty_integrator"}) {
    CHECK(contains(with, name));
    CHECK_FALSE(contains(without, name));
  }
  CHECK(contains(with, "what it does wrong"));
}

TEST_CASE("errors of scenes speak of a plugin's types as of all others", "[plugin][appearance]") {
  const std::string unknown = scene_with("unknown_type", R"({"type": "naughty_lau"})");
  const Called a = call("check '" + unknown + "'" + kNaughty);
  CHECK(a.exit == 3);
  CHECK(contains(a.text, "unknown law \"naughty_lau\"; did you mean \"naughty_law\""));
  const Called b =
      call("check '" + scene_with("unknown_key", R"({"type": "naughty_law", "dose": "x"})") + "'" + kNaughty);
  INFO(b.text);
  CHECK(b.exit == 3);
  CHECK(contains(b.text, "unknown_key.json:5:"));
  CHECK(contains(b.text, "did you mean \"does\""));
  const Called c = call("check '" + scene_with("wrong_form", R"({"type": "naughty_law", "does": 3})") + "'" + kNaughty);
  INFO(c.text);
  CHECK(c.exit == 3);
  CHECK(contains(c.text, "wrong_form.json:5:"));
  const Called d = call("run '" + scene_with("throws", R"({"type": "naughty_law", "does": "std"})") + "'" + kNaughty);
  INFO(d.text);
  CHECK(d.exit == 4);
  CHECK(contains(d.text, "('naughty_law' of plugin naughty) threw: no more"));
  const Called e =
      call("run '" + scene_with("throws_times", R"({"type": "naughty_law", "does": "no times"})") + "'" + kNaughty);
  INFO(e.text);
  CHECK(e.exit == 4);
  CHECK(contains(e.text, "threw: no times"));
}

TEST_CASE("every command that reads a scene accepts --plugin", "[plugin][appearance]") {
  const std::string scene = scene_with("with_plugin", R"({"type": "naughty_law"})");
  for (const char* verb : {"run", "check", "assemble", "sweep --vary bodies.arm.rod.mass=1,2",
                           "chart --integrators naughty_integrator,rk4 --budget 2s --separately --out appearance",
                           "advise --integrators rk4 --budget 2s"}) {
    const Called without = call(std::string(verb) + " '" + scene + "'");
    INFO(without.text);
    CHECK(without.exit != 0);
    const Called with = call(std::string(verb) + " '" + scene + "'" + kNaughty);
    INFO(with.text);
    CHECK((with.exit == 0 || std::string(verb).rfind("advise", 0) == 0));
    CHECK_FALSE(contains(with.text, "unknown law"));
  }
  const Called named = call("run '" + scene + "' --plugin naughty --integrator naughty_integrator --step 0.01",
                            "LOCKSTEP_PLUGIN_PATH='" + kModules + "'");
  INFO(named.text);
  CHECK(named.exit == 0);
}

TEST_CASE("the chart measures a plugin's integrator among the others", "[plugin][appearance]") {
  const std::string scene = scene_with("charted", R"({"type": "naughty_law"})");
  const Called r = call("chart '" + scene + "' --integrators naughty_integrator,rk4 --stabilizations project " +
                        "--formulations omega --solvers dense --budget 3s --out charted" + kNaughty);
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, "naughty_integrator"));
}

}  // namespace appearance_test
