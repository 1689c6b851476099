// SPDX-License-Identifier: BSD-3-Clause
// Which scenes move in a plane: all of them are listed, and stay so.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/law.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace planar_scenes_test {

using namespace lockstep;
using lockstep::testing::check_words;

namespace {

char letter(Plane plane) { return plane ? "xyz"[plane.n] : '-'; }

/// The plane of a scene as it is written, that which is found for body coordinates, and those that may be asked for.
std::string planes_of(const std::string& path, const Registry& registry) {
  const Scene written = read_scene(path);
  Scene in_bodies = written;
  in_bodies.run.formulation = Formulation::omega;
  in_bodies.root = written.root.without({"planar"});
  const auto plane_of = [&](const Scene& scene) { return letter(build_mechanism(scene, registry).system.plane()); };
  std::string asked;
  for (const char* normal : {"x", "y", "z"}) {
    Scene scene = in_bodies;
    scene.root.object()->push_back({"planar", Value(normal), scene.root.where});
    scene.run.formulation = Formulation::automatic;
    try {
      asked += plane_of(scene);
    } catch (const SceneError&) {  // it is not in this plane
    }
  }
  return std::string{plane_of(written), ' ', plane_of(in_bodies), ' '} + (asked.empty() ? "-" : asked);
}

std::vector<std::string> lines_of(const std::string& path) {
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// The plane of a crank and rod with this link or force, in words of a scene. Markers: at both mass centres, and on the
/// ground 0.4 m from that of the rod, level with it, higher and tilted.
std::string planes_with(const Registry& registry, const std::string& key, const std::string& thing) {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "crank", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.1, 0, 0]}},
               {"name": "rod", "rod": {"mass": 1, "from": [0.1, 0, 0], "to": [0.4, 0.2, 0]}}],
    "markers": [{"name": "knee", "body": "crank"}, {"name": "tip", "body": "rod"},
                {"name": "post", "body": "ground", "at": [0.25, 0.5, 0]},
                {"name": "high", "body": "ground", "at": [0.25, 0.5, 0.1]},
                {"name": "tilted", "body": "ground", "at": [0.25, 0.1, 0],
                 "orientation": [0.98877107793604229, 0.14943813247359922, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "rod", "s": "crank", "at": [0.1, 0, 0]})" +
                           (key == "links" ? ", " + thing + "]" : "], \"" + key + "\": [" + thing + "]") +
                           R"(, "run": {"formulation": "omega", "until": 1}})";
  return {letter(build_mechanism(scene_from_text(text, "crank.json"), registry).system.plane())};
}

}  // namespace

TEST_CASE("every scene that is planar is in the list, and stays planar", "[verification][plane]") {
  const std::string root = paths::kSource;
  const Registry registry = builtin_registry();
  std::vector<std::string> found;
  for (const char* folder : {"samples/scenes", "tests/benchmark/scenes", "tests/fuzz/corpus/scene",
                             "tests/stability/scenes", "tests/verification/defects", "tests/verification/scenes"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root + "/" + folder)) {
      if (entry.path().extension() != ".json") continue;
      const std::string path = entry.path().string();
      if (path.ends_with("/fuzz/corpus/scene/stops.json")) continue;  // it is refused
      const std::string planes = planes_of(path, registry);
      if (planes != "- - -") found.push_back(path.substr(root.size() + 1) + " " + planes);
    }
  std::ranges::sort(found);
  CHECK(found == lines_of(root + "/tests/verification/data/planar_scenes.txt"));
}

TEST_CASE("forces and formulas report components out of the plane, also those that are zero at the start",
          "[verification][plane]") {
  struct Example {
    const char *key, *thing;
    bool planar;
  };
  const auto example = GENERATE(
      Example{"forces", R"("type": "spring_damper", "p": "tip", "s": "post", "stiffness": 9, "free_length": 0.4)",
              true},
      Example{"forces", R"("type": "spring_damper", "p": "tip", "s": "high", "stiffness": 9,
              "free_length": 0.41231056256176607)",
              false},
      Example{"forces", R"("type": "spring_damper", "p": "tip", "s": "knee", "force": 0)", true},
      Example{"forces", R"("type": "bushing", "p": "tip", "s": "post", "stiffness": [1, 2, 3])", true},
      Example{"forces", R"("type": "bushing", "p": "tip", "s": "tilted", "stiffness": [1, 2, 3])", false},
      Example{"forces", R"("type": "bushing", "p": "tip", "s": "tilted", "stiffness": [1, 2, 2])", true},
      Example{"forces", R"("type": "bushing", "p": "tip", "s": "tilted", "torsion_stiffness": [2, 2, 2])", false},
      Example{"forces", R"("type": "applied_force", "p": "tip", "s": "knee", "force": [1, 2, 0])", true},
      Example{"forces", R"("type": "applied_force", "p": "tip", "s": "high", "force": [1, 2, 0])", true},
      Example{"forces", R"("type": "applied_torque", "p": "tip", "torque": [0, 1e-10, 1])", true},
      Example{"forces", R"("type": "applied_torque", "p": "tip", "torque": [0, 2e-9, 1])", false},
      Example{"forces", R"("type": "torque_motor", "p": "tip", "s": "knee", "torque": 0)", true},
      Example{"forces", R"("type": "torque_motor", "p": "tip", "s": "tilted", "torque": 0)", false},
      Example{"forces", R"("type": "force_motor", "p": "tip", "s": "post", "force": 0)", false},
      Example{"forces", R"("type": "function_force", "p": "tip", "s": "post", "coordinate": "x", "force": "=-8*q")",
              true},
      Example{"forces", R"("type": "function_force", "p": "tip", "s": "post", "coordinate": "z", "force": "=-8*q")",
              false},
      Example{"forces", R"("type": "function_force", "p": "tip", "s": "post", "coordinate": "rz", "torque": "=-8*q")",
              true},
      Example{"forces", R"("type": "function_force", "p": "tip", "s": "post", "coordinate": "rx", "torque": "=-8*q")",
              false},
      Example{"links", R"("type": "function", "p": "tip", "s": "post", "phi": "=x + 2*y + 0.8 m")", true},
      Example{"links", R"("type": "function", "p": "tip", "s": "post", "phi": "=rz")", true},
      Example{"links", R"("type": "function", "p": "tip", "s": "post", "phi": "=x + z")", false},
      Example{"links", R"("type": "function", "p": "tip", "s": "tilted", "phi": "=rz")", false});
  CAPTURE(example.thing);
  const std::string thing = std::string(R"({"name": "F", )") + example.thing + "}";
  CHECK(planes_with(builtin_registry(), example.key, thing) == (example.planar ? "z" : "-"));
}

TEST_CASE("plugins that declare to stay in the plane leave mechanisms there", "[verification][plane]") {
  Registry registry = builtin_registry();
  for (const char* plugin : {"drag", "cam_follower", "bump"}) load_plugin(registry, plugin, {paths::kPlugins});
  CHECK(planes_with(registry, "forces", R"({"name": "F", "type": "drag", "p": "rod", "at": [0.4, 0.2, 0],
    "coefficient": 1})") == "z");
  CHECK(planes_with(registry, "forces", R"({"name": "F", "type": "drag", "p": "rod", "at": [0.4, 0.2, 0.1],
    "coefficient": 1})") == "-");
  CHECK(planes_with(registry, "links", R"({"name": "C", "type": "cam_follower", "p": "rod", "s": "ground",
    "at": [0.4, 0.2, 0], "base": 0.4, "lift": 0.1})") == "z");
  CHECK(planes_with(registry, "links", R"({"name": "C", "type": "prismatic", "p": "rod", "s": "ground", "axis": "x",
    "at": [0.4, 0.2, 0], "drive": {"axis": "z", "law": {"type": "bump", "height": 0.1, "at": 1, "width": 0.4}}})") ==
        "z");
}

TEST_CASE("a type that does not declare to stay in the plane is named with the line to add", "[verification][plane]") {
  struct Mute final : TranslationLaw {
    TranslationValue at(double) const override { return {}; }
  };
  struct Still final : RotationLaw {
    RotationValue at(double) const override { return {}; }
  };
  const auto answer = [](auto&& add) {
    System system;
    Body& rod = system.add_body("rod", {1.0, Vec3::Zero(), Vec3(0.01, 0.1, 0.1).asDiagonal()}, Pose{});
    add(system, rod);
    system.set_planar(Plane{2}, true);
    const std::optional<ModelError> refusal = system.try_setup();
    return refusal ? std::string(refusal->what()) : "planar";
  };
  const auto held = [&](auto&& change) {
    return answer([&](System& system, Body& rod) {
      Fixed& link = system.add<Fixed>("held", rod, system.ground(), pose_at(Vec3(0, 0, 0)));
      change(system, link);
    });
  };
  const auto force = [](const Inputs&, WrenchSum&) {};
  CHECK(held([](System&, Fixed&) {}) == "planar");
  check_words(
      held([](System&, Fixed& link) { link.move(std::make_shared<Mute>()); }),
      {"joint 'held': its law does not declare", "\"bool stays_in_plane(const lockstep::Vec3& normal) const override\""});
  check_words(held([](System&, Fixed& link) { link.turn(std::make_shared<Still>()); }),
              {"joint 'held': its law does not declare", "\"bool turns_about(const lockstep::Vec3& axis) const override\""});
  check_words(held([](System& system, Fixed&) { system.marker("held.P").rotation_law = std::make_shared<Still>(); }),
              {"joint 'held': its law does not declare", "turns_about"});
  check_words(answer([&](System& system, Body& rod) {
                system.add(function_force("own", {&system.add_marker("tip", rod)}, force));
              }),
              {"force 'own': 'function_force' does not declare", "\"bool stays_in_plane(lockstep::Plane) const override"});
}

}  // namespace planar_scenes_test
