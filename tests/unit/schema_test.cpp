// SPDX-License-Identifier: BSD-3-Clause
// The schema: as the build writes it one with the tables and the registry, and right about scenes.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/tables.h"
#include "tests/support/catch.h"
#include "tests/support/json_schema.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace schema_test {

using namespace lockstep;

TEST_CASE("the schema that the build writes is the one that the tables make", "[unit][scene]") {
  std::ifstream file(std::string(paths::kBuild) + "/scene.schema.json");
  REQUIRE(file);
  std::ostringstream text;
  text << file.rdbuf();
  CHECK(text.str() == scene_schema(builtin_registry()));
}

TEST_CASE("the schema takes every sample scene, and none that is misspelt", "[unit][scene]") {
  const lockstep::testing::JsonSchema schema(nlohmann::json::parse(scene_schema(builtin_registry())));
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(paths::kScenes)) {
    if (entry.path().extension() != ".json") continue;
    nlohmann::json scene = nlohmann::json::parse(std::ifstream(entry.path()));
    if (scene.contains("requires")) continue;  // types of plugins, which this schema does not know
    INFO(entry.path());
    CHECK(schema.takes(scene));
    scene["gravitie"] = 1;
    CHECK_FALSE(schema.takes(scene));
    scene.erase("gravitie");
    if (!scene.contains("bodies")) continue;  // repeated
    scene["bodies"][0].erase("name");
    CHECK_FALSE(schema.takes(scene));
    ++n;
  }
  CHECK(n > 20);
  const auto takes = [&](const std::string& link) {
    return schema.takes(nlohmann::json::parse(R"({"lockstep": 1, "bodies": [], "links": [)" + link + "]}"));
  };
  const std::string hinge = R"({"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, "2 mm"])";
  CHECK(takes(hinge + "}"));
  CHECK(takes(hinge + R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "3 rpm"}}})"));
  CHECK_FALSE(takes(hinge + R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slop": 3}}})"));
  CHECK_FALSE(takes(hinge + R"(, "drive": {"axis": "rw", "law": 1}})"));
  CHECK_FALSE(takes(hinge + R"(, "at_p": [0, 0]})"));
  const std::string place = R"({"name": "A", "type": "revolute", "p": "a", "s": "ground", )";
  CHECK(takes(place + R"("at": "B", "axis": "=B - A"})"));
  CHECK(takes(place + R"("at": ["=2*L", 0, "1 mm"], "axis": ["=n", 0, 0]})"));
  CHECK_FALSE(takes(place + R"("axis": "B"})"));
  CHECK(takes(place + R"("drive": {"axis": "rz", "law": "=2*pi"}})"));
  CHECK_FALSE(takes(R"({"name": "A", "type": "revolut", "p": "a", "s": "ground"})"));
}

TEST_CASE("the schema knows parameters, points and formulas", "[unit][scene]") {
  const lockstep::testing::JsonSchema schema(nlohmann::json::parse(scene_schema(builtin_registry())));
  const auto takes = [&](const std::string& members) {
    return schema.takes(nlohmann::json::parse("{\"lockstep\": 1, " + members + "}"));
  };
  CHECK(takes(R"("$schema": "scene.schema.json", "parameters": {"L": "1 m", "n": 2, "d": "=L/n", "v": [1, 2, 3]})"));
  CHECK_FALSE(takes(R"("parameters": {"L": true})"));
  CHECK_FALSE(takes(R"("parameters": [1])"));
  CHECK(takes(R"("points": {"A": [0, "=L", "1 mm"], "B": "=A"})"));
  CHECK_FALSE(takes(R"("points": {"A": [0, 1]})"));
  CHECK_FALSE(takes(R"("points": {"A": 3})"));
  CHECK(takes(R"("gravity": "=g*[0, -1, 0]", "run": {"max_steps": "=10*n", "tolerance": "=1e-6/n"})"));
  CHECK_FALSE(takes(R"("gravity": "down")"));
  CHECK_FALSE(takes(R"("run": {"tolerance": "1e-6"})"));
}

TEST_CASE("every reference of the schema leads somewhere", "[unit][scene]") {
  const std::string text = scene_schema(builtin_registry());
  const auto schema = nlohmann::json::parse(text);
  int n = 0;
  const std::string mark = "\"$ref\": \"#/$defs/";
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1), ++n) {
    const std::size_t begin = at + mark.size();
    const std::string name = text.substr(begin, text.find('"', begin) - begin);
    INFO(name);
    CHECK(schema["$defs"].contains(name));
  }
  CHECK(n > 100);
  for (const SceneTable& table : scene_tables())
    for (const Part& part : table.parts) {
      INFO(table.info.name + "." + part.key);
      CHECK(std::any_of(table.info.keys.begin(), table.info.keys.end(),
                        [&](const Key& k) { return k.name == part.key && k.form == Form::any; }));
    }
}

TEST_CASE("the schema, list and describe name every type of the registry", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const std::string text = scene_schema(registry);
  for (const std::string& shelf : shelf_names())
    for (const Description& d : shelf_contents(registry, shelf)) {
      INFO(d.info.name);
      CHECK(d.origin == "built in");  // also of a library that loads its own laws as a plugin (LOCKSTEP_BUILTINS=OFF)
      CHECK(text.find("\"const\": \"" + d.info.name + "\"") != std::string::npos);
      const Description found = find_descriptions(registry, d.info.name).front();
      const std::string described = describe(found);
      for (const Key& key : found.info.keys) CHECK(described.find("\n  " + key.name + " ") != std::string::npos);
    }
  testing::check_words(testing::message_of<SceneError>([&] { shelf_contents(registry, "linkz"); }),
                       {"unknown shelf \"linkz\"", "did you mean \"links\""});
  CHECK(find_descriptions(registry, "revolut").empty());
}

}  // namespace schema_test
