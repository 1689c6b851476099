// SPDX-License-Identifier: BSD-3-Clause
// Results of commands: each document of --json fits the schema that `lockstep schema --results` prints, over all samples.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "framework/tools/program/result.h"
#include "tests/support/catch.h"
#include "tests/support/json_schema.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace results_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const Json& schemas() {
  static const Json kAll = Json::parse(call("schema --results").text);
  return kAll;
}

// The document of a line; null if the command refused the scene, which prints none.
Json document(const std::string& line) {
  const Called called = call(line + " --json 2> /dev/null");
  CAPTURE(line, called.exit, called.text);
  if (called.text.empty()) {
    CHECK(called.exit != 0);
    return nullptr;
  }
  const Json result = Json::parse(called.text, nullptr, false);
  REQUIRE_FALSE(result.is_discarded());
  return result;
}

void check_document(const std::string& command, const std::string& line, long& n) {
  const Json result = document(line);
  if (result.is_null()) return;
  ++n;
  CAPTURE(command, line, result.dump(1));
  REQUIRE(schemas().contains(command));
  CHECK(JsonSchema(schemas().at(command)).takes(result));
}

std::vector<std::string> scenes() {
  std::vector<std::string> all;
  for (const auto& file : std::filesystem::directory_iterator(paths::kScenes))
    if (file.path().extension() == ".json") all.push_back("'" + file.path().string() + "'");
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

TEST_CASE("results of all samples fit their schemas", "[runner]") {
  const std::vector<std::pair<std::string, std::string>> commands = {
      {"run", "run {} --until 0.05 --no-picture"},
      {"check", "check {}"},
      {"check", "check {} --channels"},
      {"describe", "describe --scene {}"},
      {"check", "check {} --full"},
      {"assemble", "assemble {}"},
      {"statics", "statics {}"},
      {"kinematics", "kinematics {} --until 0.05"},
      {"inverse", "inverse {} --until 0.05"},
      {"explain", "explain {} --at 0.01"},
      {"modes", "modes {} --frozen"},
      {"linearize", "linearize {} --frozen"},
      {"matrices", "matrices {} --at 0.01"},
      {"sweep", "sweep {} --until 0.02 --vary run.tolerance=1e-5,1e-6"}};
  const std::vector<std::string> all = scenes();
  REQUIRE(all.size() > 30);
  for (const auto& [command, words] : commands) {
    long n = 0;
    for (const std::string& scene : all)
      check_document(command, std::string(words).replace(words.find("{}"), 2, scene), n);
    CAPTURE(command);
    CHECK(n >= 4);  // the others are refused: what is not fully driven, what has no rest
  }
}

TEST_CASE("results of other commands fit their schemas", "[runner]") {
  long n = 0;
  const std::string four_bar = "'" + kFourBar + "'";
  check_document("list", "list", n);
  check_document("list", "list findings", n);
  check_document("describe", "describe revolute", n);
  check_document("describe", "describe stiff", n);
  check_document("plugins list", "plugins list", n);
  check_document("check", "check " + four_bar + " " + four_bar, n);
  check_document("explain", "explain " + four_bar + " A", n);
  check_document("assemble", "assemble " + four_bar + " --branches 20", n);
  check_document("statics", "statics '" + std::string(paths::kScenes) + "/double_pendulum.json' --all 5", n);
  check_document("report", "report " + four_bar + " --until 0.05", n);
  check_document("chart", "chart " + four_bar + " --budget 1s --until 0.05 --integrators rk4,dopri5", n);
  check_document("advise", "advise " + four_bar + " --budget 1s --until 0.05 --integrators rk4,dopri5", n);
  check_document("atlas",
                 "atlas " + four_bar + " --budget 1s --until 0.05 --vary run.step=1e-3,1e-2 --vary gravity.1=-9,-1 "
                 "--integrators rk4",
                 n);
  check_document("find", "find " + four_bar + " --vary base=280mm:300mm --reach \"base = 290 mm\"", n);
  check_document("optimize", "optimize " + four_bar + " --vary base=280mm:300mm --maximize base --runs 9", n);
  check_document("sensitivity", "sensitivity " + four_bar + " --of base --to base", n);
  CHECK(n == 16);
}

TEST_CASE("text has a label a line, tables of lists, and nothing of what is empty", "[runner]") {
  struct Wheel {
    std::string name;
    double radius;
    Vec3 at;
  };
  struct Cart {
    double mass = 2.5, speed = NAN;
    int seats = 0;
    std::string note;
    bool broken = false;
    std::vector<std::string> words{"a", "b", "c"};
    std::vector<Wheel> wheels{{"left", 0.25, {1, 1e-17, 0}}, {"right", 12.5, {-1, 0, 0}}};
    std::map<std::string, Wheel> spare{{"old", {"x", 0.5, {0, 0, 0}}}};
  };
  static const Fields<Wheel> kWheel{
      {"name", "", "name", &Wheel::name}, {"radius", "m", "radius", &Wheel::radius}, {"at", "m", "", &Wheel::at}};
  const Fields<Cart> fields{{"mass", "kg", "mass", &Cart::mass},         {"speed", "m/s", "speed", &Cart::speed},
                            {"seats", "", "seats", &Cart::seats},        {"note", "", "note", &Cart::note},
                            {"broken", "", "broken", &Cart::broken},     {"words", "", "words", &Cart::words},
                            {"wheels", "wheels", &Cart::wheels, kWheel}, {"spare", "spare", &Cart::spare, kWheel}};
  const Json cart = fields(Cart());
  CHECK(cart["speed"].is_null());
  CHECK(cart["wheels"][0]["at"] == Json({1, 1e-17, 0}));
  CHECK(cart["spare"]["old"]["radius"] == 0.5);
  CHECK(text_of(fields.schema(), cart) ==
        "  mass   2.5 kg\n"
        "  seats  0\n"
        "  words  a, b and c\n"
        "  wheels:\n"
        "    name   radius [m]\n"
        "    left   0.25\n"
        "    right  12.5\n"
        "  spare:\n"
        "    name  name  radius [m]\n"
        "    old   x     0.5\n");
  CHECK(vector_text(cart["wheels"][0]["at"]) == "[1, 0, 0]");
  const Schema* const of_cart[] = {&fields.schema()};
  const JsonSchema schema(schema_of(of_cart, false));
  Json document = cart;
  document["findings"] = Json::array();
  CHECK(schema.takes(document));
  document["spare"]["old"]["radius"] = "wide";
  CHECK_FALSE(schema.takes(document));

  Cart many;
  many.wheels.assign(41, {"w", 1, {}});
  CHECK(contains(text_of(fields.schema(), fields(many)), "    and 1 more (--json)\n"));
  const Fields<Cart> whole{{"wheels", "wheels", &Cart::wheels, kWheel, kWhole}};
  CHECK_FALSE(contains(text_of(whole.schema(), whole(many)), "more"));
}

TEST_CASE("the check of documents sees what a schema does not have", "[runner]") {
  Json result = document("check '" + kFourBar + "'");
  const JsonSchema schema(schemas().at("check"));
  REQUIRE(schema.takes(result));
  result["surplus"] = 1;
  CHECK_FALSE(schema.takes(result));
  result.erase("surplus"), result.erase("rank");
  CHECK_FALSE(schema.takes(result));
  result["rank"] = "nine";
  CHECK_FALSE(schema.takes(result));
}

}  // namespace results_test
