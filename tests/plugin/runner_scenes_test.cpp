// SPDX-License-Identifier: BSD-3-Clause
// What the program says and refuses of the scenes it is given: included files, places that are taken, tables of laws.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/program.h"

namespace runner_scenes_test {

using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string kHere = kRunnerFolder + "/scenes";

void write(const std::string& name, const std::string& text) {
  const fs::path path = fs::path(kHere) / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::string including(const std::string& file) {
  return R"({"lockstep": 1, "include": [{"scene": ")" + file + R"("}], "run": {"until": 0.1, "output": 0.1}})";
}

}  // namespace

TEST_CASE("an included file outside of the scene's folder is rejected before it is read", "[runner]") {
  const std::string secret = "hunter";
  write("outside/words.json", secret + "2 is no JSON");
  write("outside/keys.json", R"({"lockstep": 1, "password": "hunter2"})");
  write("outside/empty.json", "");
  write("outside/part.json", R"({"lockstep": 1, "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}]})");
  write("within/below/deep.json", including("../../outside/words.json"));
  std::error_code none;
  fs::remove(kHere + "/within/link.json", none);
  fs::create_symlink(kHere + "/outside/words.json", kHere + "/within/link.json");
  const std::vector<std::string> outside = {"../outside/words.json",
                                            "../outside/keys.json",
                                            "../outside/empty.json",
                                            "../outside/part.json",
                                            "../outside/gone.json",
                                            "../outside",
                                            "/etc/passwd",
                                            "/etc/no_such_file",
                                            "/dev/zero",
                                            "link.json",
                                            "below/../../outside/part.json"};
  for (const std::string& file : outside) {
    write("within/whole.json", including(file));
    for (const char* verb : {"check", "run"}) {
      const Called r = call(std::string(verb) + " scenes/within/whole.json");
      CAPTURE(verb, file, r.text);
      CHECK(r.exit == 2);
      // nothing but the place and the text of the scene itself: alike whatever is there
      CHECK(
          contains(r.text, "whole.json:1:39: the file \"" + file +
                               "\" is outside the scene's folder; put it there, or allow it with --allow-files\n"));
      CHECK_FALSE(contains(r.text, secret));
      CHECK_FALSE(contains(r.text, "JSON"));
    }
    const Called piped = shell("cd scenes/within && lockstep check - < whole.json");
    CAPTURE(piped.text);
    CHECK(piped.exit == 2);
    CHECK(contains(piped.text, "\"" + file + "\" is outside the scene's folder"));
  }
  write("within/whole.json", including("below/deep.json"));
  const Called deep = call("check scenes/within/whole.json");
  INFO(deep.text);
  CHECK(deep.exit == 2);
  CHECK(contains(deep.text, "deep.json:1:39: the file \"../../outside/words.json\" is outside the scene's folder"));

  write("within/whole.json", including("../outside/part.json"));
  CHECK(call("check scenes/within/whole.json --allow-files").exit == 0);
  write("within/whole.json", including("../outside/keys.json"));
  const Called keys = call("check scenes/within/whole.json --allow-files");
  CHECK(keys.exit == 3);
  CHECK(contains(keys.text, "keys.json:1:17: scene: unknown key \"password\""));
}

TEST_CASE("a run reports assumed places of joints", "[runner]") {
  const std::string run = R"("run": {"until": 0.01, "output": 0.01})";
  const auto told = [&](const std::string& members) {
    const Called r = call("run '" + scene_file("taken", members + run) + "' --verbose --record taken.csv");
    INFO(r.text);
    CHECK(r.exit == 0);
    const std::size_t at = r.text.find("  places assumed ");
    if (at == std::string::npos) return std::string();
    const std::size_t begin = r.text.find_first_not_of(' ', at + 17);
    return r.text.substr(begin, r.text.find('\n', at) - begin);
  };
  const std::string a = R"({"name": "a", "mass": 1, "inertia": [1, 1, 1]})",
                    bead = R"({"name": "bead", "particle": 1})";
  CHECK(
      told("\"bodies\": [" + a + ", " + bead +
           R"(], "markers": [{"name": "M", "body": "a"}, {"name": "N", "body": "bead"}],
    "links": [{"name": "L", "type": "distance", "p": "M", "s": "ground", "at_s": [0, 1, 0]}], )") ==
      "body 'a' starts at the world's origin; body 'bead' starts at the world's origin; marker 'M' is at the origin of "
      "'a' (no place given)");
  CHECK(told("\"bodies\": [" + a + R"(], "markers": [{"name": "M", "body": "a"}, {"name": "N", "body": "ground"},
    {"name": "O", "body": "a", "world_orientation": [1, 0, 0, 0]}, {"name": "P", "body": "a"}], )") ==
        "body 'a' starts at the world's origin; marker 'M' is at the origin of 'a'; marker 'N' is at the origin of the "
        "world (no place given); and 2 more (lockstep check)");
  CHECK(told(kArm + R"("markers": [{"name": "M", "body": "arm"}], )") ==
        "marker 'M' is at the origin of 'arm', the centre of its rod (no place given)");
  CHECK(told(kArm + R"("markers": [{"name": "M", "body": "arm", "at": [0, 0, 0]}], )").empty());
  CHECK(told(R"("bodies": [{"name": "bead", "particle": 1, "position": [0, 0, 0]}],
    "markers": [{"name": "M", "body": "bead"}], )")
            .empty());  // a point has no other place

  const std::string scene =
      scene_file("taken", "\"bodies\": [" + bead + R"(], "markers": [{"name": "M", "body": "bead"}], )" + run);
  const Called checked = call("check '" + scene + "' --verbose");
  INFO(checked.text);
  CHECK(value_of(checked.text, "places assumed") == "body 'bead' starts at the world's origin");
  CHECK_FALSE(contains(checked.text, "marker 'M'"));  // a point has no other place
  const nlohmann::json j =
      nlohmann::json::parse(call("run '" + scene + "' --json --record taken.csv 2>/dev/null").text);
  CHECK(j["frames_taken"] == nlohmann::json::parse(call("check --json '" + scene + "'").text)["frames_taken"]);
  CHECK(j["frames_taken"].size() == 1);
}

TEST_CASE("the table of a law is rejected with line and column", "[runner]") {
  write("driven.json", R"({"lockstep": 1, )" + kArm + R"("links": [{)" + kHinge +
                           R"(, "drive": {"axis": "rz", "law": {"type": "spline", "file": "law.csv"}}}],
    "run": {"until": 1, "output": 0.1}})");
  const auto refused = [&](const std::string& table, const std::string& words) {
    write("law.csv", table);
    const Called r = call("run scenes/driven.json --record driven.csv");
    CAPTURE(table, r.text);
    CHECK(r.exit == 8);
    CHECK(contains(r.text, "law.csv:" + words));
  };
  refused("t,y\n0,\"0\n0.5,1\n1,2\n", "2:3: a quote is not closed on its line");
  refused("t,y\n0,0\n0.5,1,7\n1,2\n", "3:7: has 3 cells, the first line has 2");
  refused("t,y\n0,0\n0.5\n1,2\n", "3:4: has 1 cell, the first line has 2");
  write("law.csv", "t [ms],y [deg]\n0,0\n1000,90\n");
  CHECK(value_of(call("check scenes/driven.json --verbose").text, "tables") ==
        "law.csv: 2 points; t 0 to 1000 ms; y 0 to 90 deg");
}

}  // namespace runner_scenes_test
