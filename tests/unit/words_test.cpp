// SPDX-License-Identifier: BSD-3-Clause
// What `describe` says of words that are no types.

#include <sstream>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include "framework/description/scene/describe.h"
#include "tests/support/catch.h"

namespace words_test {

using namespace lockstep;

namespace {

// The examples stand in lines that begin with two blanks, four blanks apart.
std::vector<std::string> examples_of(const std::string& form, const Registry& registry) {
  std::vector<std::string> all;
  std::istringstream lines(describe_word(registry, form));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ") || line.starts_with("  of ")) continue;
    for (std::size_t begin = 2; begin < line.size();) {
      const std::size_t end = std::min(line.find("    ", begin), line.size());
      all.push_back(line.substr(begin, end - begin));
      begin = end + 4;
    }
  }
  return all;
}

}  // namespace

TEST_CASE("every key, form and unit of a scene is described", "[unit][scene]") {
  const Registry registry = builtin_registry();
  CHECK(known_words(registry).size() > 200);
  for (const std::string& word : known_words(registry)) {
    INFO(word);
    const std::string text = describe_word(registry, word);
    CHECK((text.starts_with(word + ": ") || (text.empty() && !find_descriptions(registry, word).empty())));
  }
  CHECK(describe_word(registry, "stops").find("of link: limits of the free coordinates") != std::string::npos);
  CHECK(describe_word(registry, "stiffness").find("in N/m") != std::string::npos);
  CHECK(describe_word(registry, "stifness").empty());
  for (const char* function : {"table", "meet", "mean", "rms", "rate", "last"})
    CHECK(describe_word(registry, function).find(std::string(function) + "(") != std::string::npos);
}

TEST_CASE("the examples in the description of a form are readable", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const std::string body = R"({"name": "b", "mass": 1, "inertia": [1, 1, 1])",
                    hinge = R"({"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0])";
  const std::string with_body = R"("bodies": [)" + body + R"(}], "links": [)";
  const std::pair<std::string, std::string> places[] = {
      {"number", R"("bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [@, 0, 0]}}])"},
      {"vector3", R"("bodies": [)" + body + R"(, "position": @}])"},
      {"orientation", R"("bodies": [)" + body + R"(, "orientation": @}])"},
      {"axis", with_body + hinge + R"(, "axis": @}])"},
      {"law", with_body + R"({"name": "A", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0],
                             "drive": {"axis": "z", "law": @}}])"},
      {"translation law", with_body + R"({"name": "A", "type": "spherical", "p": "b", "s": "ground", "at": [0, 0, 0],
                                         "move": @}])"},
      {"rotation law", with_body + R"({"name": "A", "type": "fixed", "p": "b", "s": "ground", "at": [0, 0, 0],
                                      "turn": @}])"}};
  for (const auto& [form, place] : places) {
    const std::vector<std::string> examples = examples_of(form, registry);
    CHECK_FALSE(examples.empty());
    for (const std::string& example : examples) {
      if (example.find_first_of("[{\"0123456789") != 0) continue;  // a remark on the example before it
      std::string members = place;
      members.replace(members.find('@'), 1, example);
      const std::string text =
          R"({"lockstep": 1, "parameters": {"crank": "100 mm"}, "points": {"A": [0, 0, 0]}, )" + members + "}";
      INFO(text);
      CHECK_NOTHROW(build_mechanism(scene_from_text(text, "example.json"), registry));
    }
  }
}

TEST_CASE("the example of every type can be built", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const std::string
      bodies =
          R"({"lockstep": 1, "bodies": [{"name": "arm", "mass": 1, "inertia": [1, 1, 1]}, {"name": "b", "mass": 1, "inertia": [1, 1, 1]},
                   {"name": "c", "mass": 1, "inertia": [1, 1, 1]}], )",
      hinges = R"({"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]},
                  {"name": "B", "type": "revolute", "p": "b", "s": "ground", "at": [1, 0, 0]},
                  {"name": "C", "type": "revolute", "p": "c", "s": "ground", "at": [2, 0, 0]})";
  const std::pair<std::string, std::string> places[] = {
      {"links", bodies + R"("links": [@]})"},
      {"forces", bodies + R"("links": [)" + hinges + R"(], "forces": [@]})"},
      {"laws",
       bodies +
           R"("links": [{"name": "L", "type": "lock", "mask": "x y z e1 e2", "p": "arm", "s": "ground", "at": [0, 0, 0], "drive": {"axis": "rz", "law": @}}]})"},
      {"translation_laws",
       bodies +
           R"("links": [{"name": "L", "type": "spherical", "p": "arm", "s": "ground", "at": [0, 0, 0], "move": @}]})"},
      {"rotation_laws",
       bodies + R"("links": [{"name": "L", "type": "fixed", "p": "arm", "s": "ground", "at": [0, 0, 0], "turn": @}]})"},
      {"integrators", bodies + R"("run": {"integrator": @, "step": 0.01}})"},
      {"solvers", bodies + R"("run": {"solver": @}})"}};
  int n = 0;
  for (const auto& [shelf, place] : places)
    for (const Description& d : shelf_contents(registry, shelf)) {
      if (d.shelf != shelf) continue;  // laws are listed with those of translations and rotations
      std::string text = place;
      const std::string example = example_of(d);
      const bool couples = shelf == "links" && example_pairs(d.info.name) > 1;
      text.replace(text.find('@'), 1, couples ? hinges + ", " + example : example);
      INFO(text);
      CHECK_FALSE(example.empty());
      CHECK_NOTHROW(build_mechanism(scene_from_text(text, "example.json"), registry));
      CHECK(describe(d).find(example) != std::string::npos);
      ++n;
    }
  CHECK(n > 60);
}

}  // namespace words_test
