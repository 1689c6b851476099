// SPDX-License-Identifier: BSD-3-Clause
// The reference of scenes covers every object, type, key and unit.

#include <algorithm>
#include <map>
#include <sstream>

#include <lockstep/author/registry.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/tables.h"
#include "framework/mechanism/params/units.h"
#include "tests/support/catch.h"

namespace reference_test {

using namespace lockstep;

namespace {

// Its sections by heading; those of one heading (the same name on two shelves) together.
std::map<std::string, std::string> sections_of(const std::string& page) {
  std::map<std::string, std::string> sections;
  std::istringstream lines(page);
  std::string heading;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("### ")) heading = line.substr(4);
    if (line.starts_with("## ")) heading = line.substr(3);
    sections[heading] += line + "\n";
  }
  return sections;
}

}  // namespace

TEST_CASE("the reference of scenes has every object, every type and each of their keys", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const std::string page = scene_reference(registry);
  const std::map<std::string, std::string> sections = sections_of(page);
  const auto covers = [&](const std::string& heading, const TypeInfo& info) {
    INFO(heading);
    const auto section = sections.find(heading);
    REQUIRE(section != sections.end());
    std::string anchor = heading;
    std::ranges::replace(anchor, ' ', '-');
    CHECK(page.find(" [" + heading + "](#" + anchor + ")") < page.find("\n## Objects\n"));  // in the index
    CHECK(section->second.find(info.help.substr(0, info.help.find('|'))) != std::string::npos);
    for (const Key& key : info.keys) {
      INFO(key.name);
      CHECK(section->second.find("| `" + key.name + "` | ") != std::string::npos);
    }
  };
  for (const SceneTable& table : scene_tables()) covers(table.info.name == "link" ? "joint" : table.info.name, table.info);
  for (const char* shelf : {"links", "forces", "laws", "integrators", "solvers"})
    for (const Description& d : shelf_contents(registry, shelf))
      covers(d.info.name + (d.shelf == "translation_laws" ? " translation law"
                            : d.shelf == "rotation_laws"  ? " rotation law"
                            : d.shelf == "laws"           ? " law"
                                                          : ""),
             d.info);
  for (int k = static_cast<int>(Unit::length); k < static_cast<int>(Unit::any); ++k)
    CHECK(page.find("| " + name_of(static_cast<Unit>(k)) + " | ") != std::string::npos);
}

TEST_CASE("every key of every object and type has help", "[unit][scene]") {
  const Registry registry = builtin_registry();
  for (const SceneTable& table : scene_tables())
    for (const Key& key : table.info.keys) {
      INFO(table.info.name << "." << key.name);
      CHECK_FALSE(key.help.empty());
    }
  for (const char* shelf : {"links", "forces", "laws", "integrators", "solvers"})
    for (const Description& d : shelf_contents(registry, shelf))
      for (const Key& key : d.info.keys) {
        INFO(d.info.name << "." << key.name);
        CHECK_FALSE(key.help.empty());
      }
}

}  // namespace reference_test
