// SPDX-License-Identifier: BSD-3-Clause
// `lockstep new-plugin`: what it writes, and what it refuses. That what it writes builds and passes is tested from the
// installed package (tests/install/new_plugin.sh) and of the templates themselves (tests template.*).
#include "framework/tools/program/new_plugin.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "framework/tools/program/commands.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace new_plugin_test {

using namespace lockstep;
using lockstep::testing::call;
using lockstep::testing::contains;
namespace fs = std::filesystem;

namespace {

const std::string kPlace = std::string(paths::kBuild) + "/new_plugins";

std::string text_of(const std::string& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string refusal(const std::string& kind, const std::string& name) {
  try {
    write_plugin(kind, name, kPlace, builtin_registry());
  } catch (const UsageError& e) {
    return e.what();
  }
  return "not refused";
}

}  // namespace

TEST_CASE("new-plugin writes a folder of each kind under its own name", "[plugin][new_plugin]") {
  fs::remove_all(kPlace);
  const std::string kind = GENERATE("joint", "coupling", "law", "force", "integrator");
  const std::string name = "my_" + kind, folder = kPlace + "/" + name;
  const testing::Called r = call("new-plugin " + kind + " " + name + " --into '" + kPlace + "'");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  CHECK(contains(r.text, folder + "/" + name + ".cpp\n"));
  CHECK(contains(r.text, "ctest --test-dir " + folder + "/build"));
  for (const std::string& file : {name + ".cpp", "test_" + name + ".cpp", std::string("CMakeLists.txt"),
                                  std::string("scene.json"), std::string("README.md")}) {
    const std::string text = text_of(folder + "/" + file);
    CHECK(contains(text, name));
    CHECK_FALSE(contains(text, "template_"));
  }
  CHECK(contains(text_of(folder + "/" + name + ".cpp"),
                 "class My" + std::string(1, char(std::toupper(kind[0]))) + kind.substr(1)));
  CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 5);
}

TEST_CASE("new-plugin touches nothing that exists", "[plugin][new_plugin]") {
  fs::remove_all(kPlace);
  fs::create_directories(kPlace + "/mine");
  std::ofstream(kPlace + "/file") << "kept";
  fs::create_symlink("nowhere", kPlace + "/dangling");
  for (const char* name : {"mine", "file", "dangling"}) {
    const testing::Called r = call("new-plugin law " + std::string(name) + " --into '" + kPlace + "'");
    INFO(r.text);
    CHECK(r.exit == kExitFile);
    CHECK(contains(r.text, "exists and is left unchanged"));
  }
  CHECK(fs::is_empty(kPlace + "/mine"));
  CHECK(text_of(kPlace + "/file") == "kept");
  CHECK_FALSE(fs::exists(kPlace + "/nowhere"));
  const testing::Called r = call("new-plugin law mine2 --into '" + kPlace + "/file'");
  CHECK(r.exit == kExitFile);
  CHECK(contains(r.text, "cannot be created"));
}

TEST_CASE("new-plugin rejects impossible names", "[plugin][new_plugin]") {
  fs::remove_all(kPlace);
  for (const char* name : {"", "Rail", "2rails", "a-b", "../up", "a/b", "rail_", "a__b", "r\xc3\xa4", "a b"})
    CHECK(contains(refusal("joint", name), "small letters, digits and single _"));
  CHECK(contains(refusal("joint", "revolute"), "\"revolute\" is already a joint of lockstep"));
  CHECK(contains(refusal("law", "dopri5"), "is already an integrator of lockstep"));
  CHECK(contains(refusal("law", "motion"), "would be MotionLaw, which lockstep has"));
  CHECK(contains(refusal("force", "test"), "a target of every CMake project"));
  for (const char* target : {"edit_cache", "rebuild_cache", "preinstall"})
    CHECK(contains(refusal("force", target), "a target of every CMake project"));
  CHECK(contains(refusal("joint", std::string(61, 'a')), "at most 60"));
  CHECK(contains(refusal("joint", "libra"), "begins with \"lib\", which lockstep removes"));
  CHECK_FALSE(fs::exists(kPlace));
  const testing::Called r = call("new-plugin gear mine");
  CHECK(r.exit == kExitUsage);
}

TEST_CASE("new-plugin reads link as joint", "[plugin][new_plugin]") {
  fs::remove_all(kPlace);
  CHECK(call("new-plugin link rail --into '" + kPlace + "'").exit == 0);
  CHECK(contains(text_of(kPlace + "/rail/rail.cpp"), "class RailJoint"));
}

TEST_CASE("the class of a new plugin is named after both", "[plugin][new_plugin]") {
  CHECK(class_name("joint", "wavy_rail") == "WavyRailJoint");
  CHECK(class_name("joint", "my_joint") == "MyJoint");
  CHECK(class_name("law", "x2") == "X2Law");
  CHECK(class_name("integrator", "integrator") == "IntegratorIntegrator");
}

}  // namespace new_plugin_test
