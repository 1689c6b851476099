// SPDX-License-Identifier: BSD-3-Clause
// The verb atlas, called as a person calls it.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_atlas_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::json;

namespace {

// A mass of 1 kg on a spring, let go 0.1 m off its rest.
std::string spring() {
  return scene_file("atlas_spring", R"("bodies": [{"name": "m", "particle": 1, "position": [0.1, 0, 0]}],
    "markers": [{"name": "wall", "body": "ground", "at": [-3, 0, 0]}, {"name": "hook", "body": "m"}],
    "forces": [{"name": "spring", "type": "spring_damper", "p": "hook", "s": "wall", "stiffness": 100, "free_length": 3}],
    "run": {"integrator": "dop853", "tolerance": 1e-8, "step": 0.01, "until": 20})");
}

std::size_t lines_of(const std::string& file) {
  std::ifstream in(kRunnerFolder + "/" + file);
  std::size_t n = 0;
  for (std::string line; std::getline(in, line);) ++n;
  return n;
}

// The JSON that the verb prints for a scene.
Json atlas_of(const std::string& scene, const std::string& words) {
  const Called called = call("atlas '" + scene + "' " + words + " --json");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  return Json::parse(called.text);
}

std::string picture(const std::string& file) { return bytes_of(kRunnerFolder + "/" + file); }

}  // namespace

TEST_CASE("atlas: a method works below the limit of its theory and fails above it", "[runner][atlas]") {
  const Json j = atlas_of(spring(),
                          "--vary run.step=0.02:0.8:8:log --vary forces.spring.stiffness=25,100,400 "
                          "--integrators semi_implicit_euler,generalized_alpha,dop853 --error 0.5");
  INFO(j);
  REQUIRE(j["maps"].size() == 3);
  const Json &euler = j["maps"][0], &steps = j["axes"][0]["values"], &stiffness = j["axes"][1]["values"];
  REQUIRE(euler["limit"]["x"].size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double limit = 2 / std::sqrt(stiffness[k].get<double>());
    CHECK(euler["limit"]["x"][k].get<double>() == Approx(limit).epsilon(0.01));
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const double h = steps[i];
      const std::string outcome = euler["outcomes"][i][k];
      CAPTURE(h, limit, outcome);
      if (h > 1.05 * limit) CHECK(outcome != "accurate");
      if (h > 1.05 * limit) CHECK(outcome != "wrong (not flagged)");
      if (h < 0.02 * limit) CHECK(outcome == "accurate");
    }
  }
  CHECK_FALSE(j["maps"][1].contains("limit"));  // unconditionally stable
  CHECK(j["maps"][1]["counts"].value("failed", 0) == 0);
  CHECK(j["maps"][2]["counts"]["accurate"] == 24);  // it chooses its steps
  CHECK(j["not_tried"] == 0);
  CHECK(lines_of("atlas_spring_atlas.csv") == 1 + 3 * 24);
  for (const char* file : {"atlas_spring_atlas.png", "atlas_spring_atlas.svg"})
    CHECK(std::filesystem::exists(kRunnerFolder + "/" + file));
  CHECK(contains(picture("atlas_spring_atlas.svg"), "largest stable step by linear theory"));
  CHECK_FALSE(contains(picture("atlas_spring_atlas.svg"), "singular configurations passed"));
}

// The reference is in the plane, where rigid groups have the world's axes at the start, and implicit runs are in space.
TEST_CASE("atlas: a body that starts rotated is compared in its own axes", "[runner][atlas]") {
  const std::string crane = scene_file("atlas_crane", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "bar", "rod": {"mass": 20, "from": [0, 0, 0], "to": [3, -4, 0]}},
               {"name": "load", "rod": {"mass": 100, "from": [3, -4, 0], "to": [3.6, -4.8, 0]}}],
    "joints": [{"name": "A", "type": "revolute", "p": "bar", "s": "ground", "at": [0, 0, 0]},
               {"name": "B", "type": "revolute", "p": "load", "s": "bar", "at": [3, -4, 0]}],
    "run": {"until": 0.1})");
  const Json j = atlas_of(crane,
                          "--vary run.step=0.01,0.02 --vary bodies.load.rod.mass=100,101 "
                          "--integrators radau5,rattle4,rk4 --error 1e-5");
  INFO(j);
  for (const Json& map : j["maps"]) CHECK(map["counts"]["accurate"] == 4);
}

// Its whole run fits in one step: the displacement is that from the start.
TEST_CASE("atlas: a run of a single step has an error", "[runner][atlas]") {
  const Json j = atlas_of(spring(),
                          "--vary run.step=1,2 --vary forces.spring.stiffness=100,101 --until 1 "
                          "--integrators semi_implicit_euler");
  INFO(j);
  CHECK(j["maps"][0]["counts"].value("accurate", 0) == 0);
}

TEST_CASE("atlas: the Baumgarte gain has the limit of (2.16)", "[runner][atlas]") {
  const std::string rod = scene_file("atlas_rod", R"("gravity": [0, -9.81, 0], "planar": "off",
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "parameters": {"gain": 100},
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "rk4", "step": 0.01, "formulation": "omega", "until": 0.5,
            "stabilization": {"kind": "baumgarte", "alpha": "=gain", "beta": "=gain"}})");
  const Json j = atlas_of(rod,
                          "--vary run.step=1e-3:0.1:5:log --vary gain=50,100,200 "
                          "--integrators rk4,semi_implicit_euler --stabilizations baumgarte");
  INFO(j);
  for (std::size_t k = 0; k < 3; ++k) {
    const double gain = j["axes"][1]["values"][k];
    CHECK(j["maps"][0]["limit"]["x"][k].get<double>() * gain == Approx(2.785).epsilon(0.04));
    CHECK(j["maps"][1]["limit"]["x"][k].get<double>() * gain == Approx(2 * std::sqrt(2.0) - 2).epsilon(0.01));
  }
}

namespace {

std::string scene_of_map(const char* name) {
  return std::string(paths::kSource) + "/tests/stability/scenes/" + name + ".json";
}

// The outcomes of all runs of a map, and the positions that they passed.
void each_run(const Json& map, const std::function<void(const std::string& outcome, long passed)>& check) {
  const Json &outcomes = map["outcomes"], &passed = map["passed_singular_positions"];
  REQUIRE(!outcomes.empty());
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    for (std::size_t k = 0; k < outcomes[i].size(); ++k) check(outcomes[i][k], passed[i][k]);
}

}  // namespace

// Points of the committed maps (framework/docs/stability.md).
TEST_CASE("atlas: singular configurations that were passed with unprojected stages are reported", "[runner][atlas]") {
  const Json j = atlas_of(scene_of_map("flat_cranks"),
                          "--vary before=1e-6,1e-3,0.1 --vary run.tolerance=1e-10,1e-6 "
                          "--integrators dop853,dop853:stages=plain,rk4,rattle4 --out atlas_flat");
  INFO(j);
  each_run(j["maps"][0], [](const std::string& outcome, long passed) {
    CHECK(outcome == "accurate");
    CHECK(passed == 0);
  });
  for (const std::size_t plain : {1, 2})
    each_run(j["maps"][plain], [](const std::string& outcome, long passed) {
      CHECK(outcome == "accurate");
      CHECK(passed > 0);
    });
  each_run(j["maps"][3], [](const std::string& outcome, long) { CHECK(outcome == "failed"); });
  std::ifstream csv(kRunnerFolder + "/atlas_flat/flat_cranks_atlas.csv");
  std::string header;
  std::getline(csv, header);
  CHECK(contains(header, ",drift [m],singular positions,steps,"));
  const Called words = call("atlas '" + scene_of_map("flat_cranks") +
                            "' --vary before=1e-3,0.1 --vary run.tolerance=1e-10,1e-6 --integrators dop853,rk4 "
                            "--out atlas_flat");
  INFO(words.text);
  CHECK(row_of(words.text, "integrator") ==
        "integrator stabilisation runs singular configurations passed");
  CHECK(row_of(words.text, "dop853") == "dop853 project 4 accurate 0");
  CHECK(row_of(words.text, "rk4") == "rk4 project 4 accurate 4");
  CHECK(contains(picture("atlas_flat/flat_cranks_atlas.svg"), "singular configurations passed without projected stages"));
  CHECK_FALSE(contains(picture("atlas_flat/flat_cranks_atlas.svg"), "largest stable step"));
}

TEST_CASE("atlas: where Newton's method of implicit methods ends", "[runner][atlas]") {
  const Json j = atlas_of(scene_of_map("turning_rod"),
                          "--vary run.step=1e-3,0.01,0.1,1 --vary forces.s.stiffness=1,100 "
                          "--integrators generalized_alpha,radau5:fixed=true,radau5 --out atlas_newton");
  INFO(j);
  const Json &alpha = j["maps"][0]["outcomes"], &fixed = j["maps"][1]["outcomes"];
  for (const std::size_t k : {0, 1}) {
    CHECK(alpha[0][k] == "accurate");  // 0.01 rad a step
    CHECK(alpha[1][k] != "failed");
    CHECK(fixed[0][k] == "accurate");
    for (const std::size_t step : {1, 2, 3}) CHECK(fixed[step][k] == "failed");
  }
  for (const std::size_t map : {0, 1})
    each_run(j["maps"][map], [](const std::string& outcome, long) { CHECK(outcome != "wrong (not flagged)"); });
  each_run(j["maps"][2], [](const std::string& outcome, long) { CHECK(outcome == "accurate"); });  // it chooses its steps
}

TEST_CASE("atlas: damping and spin against the step", "[runner][atlas]") {
  const Json damped =
      atlas_of(scene_of_map("spring"),
               "--vary run.step=0.002,0.02 --vary forces.spring.damping=50,1000 "
               "--integrators rk4,semi_implicit_euler,radau5:fixed=true --error 0.1 --out atlas_damping");
  INFO(damped);
  const Json& maps = damped["maps"];
  for (const std::size_t explicit_one : {0, 1}) {  // c h/m: 0.1, 2, 1, 20; the limits are 2.79 and 2
    const Json& outcomes = maps[explicit_one]["outcomes"];
    CHECK(outcomes[0][0] == (explicit_one == 0 ? "accurate" : "inaccurate"));
    CHECK(outcomes[1][0] ==
          "inaccurate");  // an energy balance that a run calls WRONG, at an error of 2e-5 m and 3e-3 m
    CHECK((outcomes[1][1] == "failed" || outcomes[1][1] == "wrong (flagged)"));
  }
  CHECK(maps[0]["outcomes"][0][1] == "accurate");
  CHECK(maps[2]["counts"]["accurate"] == 4);

  const Json spun = atlas_of(scene_of_map("spinning_body"),
                             "--vary run.step=1e-6,1e-5,1e-4 --vary spin=1e3,1e5 "
                             "--integrators rk4,rattle4,radau5:fixed=true --out atlas_spin");
  INFO(spun);
  for (const Json& map : spun["maps"]) {
    const Json& outcomes = map["outcomes"];
    for (const std::size_t step : {0, 1, 2}) CHECK(outcomes[step][0] == "accurate");                // to 0.1 rad a step
    CHECK(outcomes[0][1] == "accurate");                                                            // 0.1 rad at 1e5 rad/s
    CHECK((outcomes[2][1] == "failed" || outcomes[2][1] == "wrong (flagged)"));  // 10 rad
  }
}

TEST_CASE("atlas: drift over a long time, and what stabilisation keeps of the motion", "[runner][atlas]") {
  const Json j = atlas_of(scene_of_map("slow_rod"),
                          "--vary run.step=0.1,0.2 --vary run.until=60,1200 --integrators rk4 "
                          "--stabilizations project,baumgarte,none --error 1e-6 --out atlas_drift");
  INFO(j);
  const auto outcome = [&](std::size_t map, std::size_t until) { return j["maps"][map]["outcomes"][1][until]; };
  CHECK(outcome(0, 0) == "accurate");
  CHECK(outcome(0, 1) == "accurate");
  CHECK(outcome(1, 1) != "accurate");
  CHECK(outcome(2, 1) != "accurate");
  const Json euler = atlas_of(scene_of_map("slow_rod"),
                              "--vary run.step=0.1,0.2 --vary run.until=2400,3600 --integrators semi_implicit_euler "
                              "--stabilizations project,baumgarte,none --out atlas_drift");
  INFO(euler);
  for (const Json& map : euler["maps"])
    each_run(map, [](const std::string& end, long) {
      CHECK((end == "failed" || end == "wrong (flagged)"));
    });
}

TEST_CASE("atlas: mass ratios to 1e9, steps to 1e-7 s", "[runner][atlas]") {
  const Json heavy = atlas_of(scene_of_map("heavy_swing"),
                              "--vary run.tolerance=1e-10,1e-6 --vary ratio=1,1e6,1e9 --integrators dopri5,dop853 "
                              "--error 1e-10 --out atlas_heavy");
  INFO(heavy);
  for (const Json& map : heavy["maps"]) {
    for (const std::size_t ratio : {0, 1, 2}) {
      CHECK(map["outcomes"][0][ratio] == "accurate");
      CHECK(map["outcomes"][1][ratio] == "inaccurate");
    }
  }
  const Json shorter = atlas_of(scene_of_map("short_steps"),
                                "--vary run.step=1e-7,1e-5,1e-3 --vary m=1e-3,1e3 --integrators generalized_alpha "
                                "--error 1e-7 --out atlas_short");
  INFO(shorter);
  for (const std::size_t mass : {0, 1}) {
    CHECK(shorter["maps"][0]["outcomes"][0][mass] == "accurate");
    CHECK(shorter["maps"][0]["outcomes"][2][mass] == "inaccurate");  // of second order
  }
}

TEST_CASE("atlas: a large rotation per step counts as reported, and shapes from a cube to a leaf", "[runner][atlas]") {
  const Json j =
      atlas_of(scene_of_map("plate"),
               "--vary run.step=0.01,1 --vary thickness=1e-6,1e-2,1 --integrators rk4,rattle2 --out atlas_plate");
  INFO(j);
  for (const Json& map : j["maps"])
    for (const std::size_t shape : {0, 1, 2}) {
      CHECK(map["outcomes"][0][shape] == "accurate");
      CHECK(map["outcomes"][1][shape] == "wrong (flagged)");  // 5 rad a step
    }
}

TEST_CASE("atlas: near its middle axis a racket tumbles alike at any tolerance", "[runner][atlas]") {
  const Json j = atlas_of(scene_of_map("racket"),
                          "--vary run.tolerance=1e-12,1e-9 --vary tilt=1e-8,0.1 --integrators dopri5 --error 1e-7 "
                          "--out atlas_racket");
  INFO(j);
  const Json& outcomes = j["maps"][0]["outcomes"];
  for (const std::size_t tolerance : {0, 1}) {
    CHECK(outcomes[tolerance][0] == "inaccurate");
    CHECK(outcomes[tolerance][1] == "accurate");
  }
}

TEST_CASE("atlas: a scene that cannot be built is an invalid scene, reported by its own error", "[runner][atlas]") {
  const std::string rest = " --vary forces.spring.stiffness=1,2 --integrators rk4,dop853 --step 0.1";
  const Json j = atlas_of(spring(), "--vary bodies.m.particle=-1,1" + rest);
  INFO(j);
  for (const Json& map : j["maps"]) CHECK(map["counts"]["invalid scene"] == 2);
  CHECK(contains(j["missing"].get<std::string>(), "body 'm'"));
  CHECK_FALSE(contains(j["missing"].get<std::string>(), "dop853"));
  const Called none = call("atlas '" + spring() + "' --vary bodies.m.particle=-2,-1" + rest);
  INFO(none.text);
  CHECK(none.exit == 3);
  CHECK(contains(none.text, "error: "));
  CHECK(contains(none.text, "body 'm'"));
}

TEST_CASE("atlas: invalid settings of a map are rejected by name", "[runner][atlas]") {
  const std::string scene = spring();
  const auto refused = [&](const std::string& words, const std::string& part) {
    const Called called = call("atlas '" + scene + "' " + words);
    INFO(called.text);
    CHECK(called.exit == 2);
    CHECK(contains(called.text, part));
  };
  refused("--vary run.step=1e-3:1e-1:4:log", "two axes");
  refused("--vary run.step=1e-3:1e-1:4:log --vary forces.spring.stifness=1,2", "stifness");
  refused("--vary run.step=0:1e-1:4:log --vary forces.spring.stiffness=1,2", "above 0");
  refused("--vary run.step=0.1,0.01 --vary forces.spring.stiffness=1,2", "two increasing values");
  refused("--vary run.integrator=rk4,dop853 --vary forces.spring.stiffness=1,2", "numbers");
  refused("--vary run.step=0.01,0.1 --vary forces.spring.stiffness=1,2 --integrators rk5", "rk5");
  refused("--vary run.step=0.01,0.1 --vary forces.spring.stiffness=1,2 --step 0.1", "run.step");
}

}  // namespace runner_atlas_test
