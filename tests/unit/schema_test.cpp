// The schema: up to date as committed, and one with the tables and the registry.
#include "framework/description/scene/schema.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "framework/description/registry/builtins.h"
#include "framework/description/scene/describe.h"
#include "framework/description/scene/tables.h"
#include "framework/foundation/support/error.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace lockstep;

TEST_CASE("the committed schema is the one that the tables make", "[unit][scene]") {
  std::ifstream file(std::string(paths::kSource) + "/framework/scene/scene.schema.json");
  REQUIRE(file);
  std::ostringstream text;
  text << file.rdbuf();
  // When this fails: build/release/bin/lockstep schema > framework/description/scene/scene.schema.json
  CHECK(text.str() == scene_schema(builtin_registry()));
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
      // Laws and integrators may be plugins of these names (LOCKSTEP_BUILTINS=OFF).
      const std::string folder = shelf == "integrators" ? "integrators" : "motionlaws";
      const bool may_be_plugin = shelf == "integrators" || shelf == "laws" || shelf.ends_with("_laws");
      CHECK((d.origin == "built in" || (may_be_plugin && d.origin == folder)));
      CHECK(text.find("\"const\": \"" + d.info.name + "\"") != std::string::npos);
      const Description found = find_descriptions(registry, d.info.name).front();
      const std::string described = describe(found);
      for (const Key& key : found.info.keys) CHECK(described.find("\n  " + key.name + " ") != std::string::npos);
    }
  CHECK_THROWS_AS(shelf_contents(registry, "linkz"), SceneError);
  CHECK_THROWS_WITH(find_descriptions(registry, "revolut"), Catch::Matchers::Contains("did you mean \"revolute\""));
}
