// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "framework/description/scene/json.h"
#include "framework/mechanism/params/read.h"
#include "tests/support/messages.h"

namespace params_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

const TypeInfo kRamp{"ramp",
                     "a ramp",
                     {{"slope", Form::number, Unit::speed, kRequired, "rise a second"},
                      {"start", Form::number, Unit::time, 0, "when it begins"},
                      {"limit", Form::number, Unit::length, kOptional, "where it ends"}}};

// One key of every form.
const TypeInfo kAll{"all",
                    "",
                    {{"number", Form::number, Unit::length, "5 mm", ""},
                     {"integer", Form::integer, Unit::none, 3, ""},
                     {"boolean", Form::boolean, Unit::none, true, ""},
                     {"text", Form::text, Unit::none, "words", ""},
                     {"choice", Form::choice, Unit::none, "red", "", {"red", "green"}},
                     {"vector", Form::vector3, Unit::length, Value::List{1, 2, "3 mm"}, ""},
                     {"axis", Form::axis, Unit::none, "z", ""},
                     {"turn", Form::orientation, Unit::none, Value::List{1, 0, 0, 0}, ""},
                     {"numbers", Form::numbers, Unit::none, Value::List{1, 2}, ""},
                     {"points", Form::points, Unit::none, Value::List{Value::List{0, 1}, Value::List{2, 3}}, ""},
                     {"law", Form::law, Unit::none, 2, ""},
                     {"slide", Form::translation_law, Unit::none, Value::List{1, 2, 3}, ""},
                     {"spin", Form::rotation_law, Unit::none, Value::List{1, 0, 0, 0}, ""},
                     {"laws", Form::laws, Unit::none, Value::List{1, 2}, ""},
                     {"any", Form::any, Unit::none, kOptional, ""}}};

// A registry whose laws remember for whom they were made.
struct Laws {
  struct Scalar final : MotionLaw {
    explicit Scalar(double y0) : y(y0) {}
    LawValue at(double) const override { return {y, 0, 0}; }
    double y;
  };
  struct Slide final : TranslationLaw {
    TranslationValue at(double) const override { return {}; }
  };
  struct Spin final : RotationLaw {
    RotationValue at(double) const override { return {}; }
  };
  Laws() {
    registry.laws.add({"constant", "", {{"value", Form::number, Unit::any, kRequired, ""}}},
                      [this](const Params& p) -> LawPtr<MotionLaw> {
                        places.push_back(p.owner());
                        return std::make_shared<Scalar>(p.number("value"));
                      });
    registry.laws.add({"x", "", {}}, [](const Params&) -> LawPtr<MotionLaw> { return std::make_shared<Scalar>(-1); });
    registry.translation_laws.add({"constant", "", {{"value", Form::vector3, Unit::any, kRequired, ""}}},
                                  [this](const Params& p) -> LawPtr<TranslationLaw> {
                                    places.push_back(p.owner());
                                    return std::make_shared<Slide>();
                                  });
    registry.rotation_laws.add({"constant", "", {{"value", Form::orientation, Unit::none, kRequired, ""}}},
                               [this](const Params& p) -> LawPtr<RotationLaw> {
                                 places.push_back(p.owner());
                                 return std::make_shared<Spin>();
                               });
  }
  Params all(const Value& v) const { return checked_params(Params::unchecked(v), kAll, "body 'B'", &registry); }

  Registry registry;
  std::vector<std::string> places;
};

Params ramp(const std::string& json) { return {read_json(json, "four_bar.json"), kRamp, "joint 'A', drive.law"}; }

std::string ramp_problem(const std::string& json) {
  return message_of<SceneError>([&] { ramp(json); });
}

// The message for {"<key>": <json>} of the type that has all forms.
std::string problem_of(const std::string& key, const std::string& json) {
  Laws laws;
  return message_of<SceneError>([&] { laws.all(read_json("{\"" + key + "\": " + json + "}", "a.json")); });
}

Vec3 axis_of(const std::string& json) { return read_axis(read_json(json, ""), "axis"); }
Mat3 turn_of(const std::string& json) { return rotation(read_orientation(read_json(json, ""), "turn")); }

Mat3 matrix(const Vec3& x, const Vec3& y, const Vec3& z) {
  Mat3 A;
  A << x, y, z;
  return A;
}
double distance(const Mat3& A, const Mat3& B) { return (A - B).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("given and defaulted numbers are handed out in SI", "[unit][model]") {
  const Params p = ramp(R"({"slope": "20 mm/s"})");
  CHECK(p.number("slope") == 0.02);
  CHECK(p.number("start") == 0);
  CHECK(p.has("slope"));
  CHECK_FALSE(p.has("start"));
  CHECK_FALSE(p.has("limit"));
  CHECK(p.value("limit").is_null());
  CHECK(*p.value("slope").text() == "20 mm/s");
  CHECK(p.owner() == "joint 'A', drive.law");
  CHECK(p.where().text() == "four_bar.json:1:1");
}

TEST_CASE("every form has its default and its getter", "[unit][model]") {
  Laws laws;
  const Params p = laws.all({});
  CHECK(p.number("number") == 0.005);
  CHECK(p.integer("integer") == 3);
  CHECK(p.boolean("boolean"));
  CHECK(p.text("text") == "words");
  CHECK(p.text("choice") == "red");
  CHECK(p.vector3("vector") == Vec3(1, 2, 0.003));
  CHECK(p.vector3("axis") == Vec3::UnitZ());
  CHECK(p.orientation("turn").w == 1);
  CHECK(p.numbers("numbers") == std::vector<double>{1, 2});
  CHECK(p.points("points") == std::vector<std::vector<double>>{{0, 1}, {2, 3}});
  CHECK(p.law("law")->at(0).y == 2);
  CHECK(p.translation_law("slide") != nullptr);
  CHECK(p.rotation_law("spin") != nullptr);
  CHECK(p.laws("laws").at(1)->at(0).y == 2);
  CHECK(laws.places == std::vector<std::string>{"body 'B', law", "body 'B', slide", "body 'B', spin",
                                                "body 'B', laws[0]", "body 'B', laws[1]"});
}

TEST_CASE("given values stand before defaults in every form", "[unit][model]") {
  Laws laws;
  const Params p = laws.all(read_json(
      R"({"number": 7, "integer": -2, "boolean": false, "text": "t", "choice": "green", "vector": [0, "1 cm", 2],
      "axis": [0, 3, 4], "turn": {"axis": "x", "angle": "180 deg"}, "numbers": [], "points": [[1]], "law": 9, "laws": [4, {"type": "x"}],
      "any": {"a": 1}})",
      "a.json"));
  CHECK(p.number("number") == 7);
  CHECK(p.integer("integer") == -2);
  CHECK_FALSE(p.boolean("boolean"));
  CHECK(p.text("text") == "t");
  CHECK(p.text("choice") == "green");
  CHECK(p.vector3("vector") == Vec3(0, 0.01, 2));
  CHECK((p.vector3("axis") - Vec3(0, 0.6, 0.8)).norm() < 1e-15);
  CHECK(std::abs(p.orientation("turn").x - 1) < 1e-15);
  CHECK(p.numbers("numbers").empty());
  CHECK(p.points("points").size() == 1);
  CHECK(p.law("law")->at(0).y == 9);
  CHECK(p.laws("laws").size() == 2);
  CHECK(*p.value("any").find("a")->number() == 1);
}

TEST_CASE("parameters given in C++ are checked by the same table", "[unit][model]") {
  const Params raw{{"slope", 2.0}, {"start", "5 ms"}};
  const Params p = raw.checked(kRamp, "law 'ramp'");
  CHECK(p.number("slope") == 2);
  CHECK(p.number("start") == 0.005);
  const std::string problem = message_of<SceneError>([] { Params{{"slop", 2}}.checked(kRamp, "law 'ramp'"); });
  CHECK(problem == "law 'ramp': unknown key \"slop\"; did you mean \"slope\"?");
  check_words(message_of<SceneError>([] {
                Params{{"slope", 2}, {"slope", 3}}.checked(kRamp, "law 'ramp'");
              }),
              {"\"slope\" is given twice"});
  check_words(message_of<SceneError>([] {
                Params{{"slope", std::nan("")}}.checked(kRamp, "law 'ramp'");
              }),
              {"law 'ramp', slope: ", "nan", "finite"});
  check_words(message_of<SceneError>([] {
                Params{{"slope", INFINITY}}.checked(kRamp, "law 'ramp'");
              }),
              {"inf", "finite"});
  check_words(message_of<SceneError>([] { Params{{"slope", 1}}.number("slope"); }), {"\"slope\"", "checked"});
}

TEST_CASE("an unknown key is rejected with its place and the closest one", "[unit][model]") {
  CHECK(ramp_problem("{\"start\": 1,\n  \"slop\": 2}") ==
        "four_bar.json:2:3: joint 'A', drive.law: unknown key \"slop\"; did you mean \"slope\"?");
  check_words(ramp_problem(R"({"radius": 2})"), {"unknown key \"radius\"", "known: slope, start, limit"});
  check_words(message_of<SceneError>([] {
                Params(read_json(R"({"a": 1})", "a.json"), {"gravity", "", {}}, "force 'g'");
              }),
              {"force 'g'", "unknown key \"a\"", "takes no keys"});
}

TEST_CASE("a missing key is rejected with its expected content", "[unit][model]") {
  check_words(ramp_problem("{}"), {"four_bar.json:1:1: joint 'A', drive.law: missing key \"slope\"", "a speed in m/s",
                                   "rise a second", "add it"});
  const Params p = ramp(R"({"slope": 1})");
  check_words(message_of<SceneError>([&] { p.number("limit"); }), {"missing key \"limit\"", "a length in m"});
}

// std::variant of libstdc++ 12 destroys what it has not made where a copy throws.
static_assert([]<std::size_t... k>(std::index_sequence<k...>) {
  return (std::is_nothrow_copy_constructible_v<std::variant_alternative_t<k, MadeLaw>> && ...);
}(std::make_index_sequence<std::variant_size_v<MadeLaw>>{}));

TEST_CASE("a parameter in a unit of another dimension is rejected by both names", "[unit][model]") {
  check_words(ramp_problem(R"({"slope": "30 deg"})"),
              {"four_bar.json:1:11: joint 'A', drive.law.slope: \"30 deg\" is an angle", "a speed is expected"});
}

TEST_CASE("a wrong form is rejected with the expected and the given one", "[unit][model]") {
  check_words(problem_of("number", "[1, 2]"),
              {"a.json:1:12: body 'B', number: expected a length", "12 mm", "got a list of 2"});
  check_words(problem_of("number", "true"), {"got true"});
  check_words(problem_of("number", "null"), {"got null"});
  check_words(problem_of("number", "\"far\""), {"a length", "\"far\""});
  check_words(problem_of("integer", "2.5"), {"a whole number", "2.5"});
  check_words(problem_of("integer", "\"2\""), {"a whole number", "a text"});
  check_words(problem_of("integer", "3e10"), {"3e+10", "limit is 2147483647"});
  check_words(problem_of("boolean", "1"), {"true or false", "a number (1)"});
  check_words(problem_of("text", "7"), {"a text in quotes", "a number (7)"});
  check_words(problem_of("choice", "\"gren\""),
              {"\"red\" or \"green\"", "a text (\"gren\")", "did you mean \"green\""});
  check_words(problem_of("choice", "3"), {"\"red\" or \"green\"", "a number (3)"});
  check_words(problem_of("vector", "\"x\""), {"a list of 3 numbers", "got a text"});
  check_words(problem_of("vector", "[1, 2]"), {"a list of 3 numbers", "got a list of 2"});
  check_words(problem_of("vector", "[1, 2, \"3 s\"]"), {"a.json:1:19: ", "vector[2]", "\"3 s\" is a time", "a length"});
  check_words(problem_of("axis", "\"w\""), {"a direction", "\"-y\"", "a text (\"w\")"});
  check_words(problem_of("axis", "\"\""), {"a direction"});
  check_words(problem_of("axis", "[0, 0, 0]"), {"no direction", "not zero"});
  check_words(problem_of("axis", "2"), {"a direction", "a number (2)"});
  check_words(problem_of("numbers", "3"), {"a list of numbers", "a number (3)"});
  check_words(problem_of("numbers", "[1, \"a\"]"), {"numbers[1]", "\"a\""});
  check_words(problem_of("points", "[1, 2]"), {"points[0]", "a list of numbers"});
  check_words(problem_of("points", "{}"), {"a list of lists of numbers", "an object"});
  check_words(problem_of("law", "true"), {"a law", "\"type\"", "got true"});
  check_words(problem_of("law", "\"fast\""), {"a law", "a text (\"fast\")"});
  check_words(problem_of("law", "{\"slope\": 1}"), {"no \"type\""});
  check_words(problem_of("slide", "3"), {"a law", "a number (3)"});
  check_words(problem_of("laws", "3"), {"a list of laws", "a number (3)"});
  check_words(problem_of("laws", "[3, true]"), {"laws[1]", "got true"});
}

TEST_CASE("a value that is no object is rejected", "[unit][model]") {
  check_words(message_of<SceneError>([] { Params(read_json("[1]", "a.json"), kRamp, "joint 'A'"); }),
              {"a.json:1:1: joint 'A': expected an object", "'ramp'", "a list of 1"});
}

TEST_CASE("a law without a law registry is rejected", "[unit][model]") {
  check_words(message_of<SceneError>([] {
                checked_params(Params::unchecked(read_json(R"({"law": 1})", "a.json")), kAll, "body 'B'", nullptr);
              }),
              {"a.json:1:9: body 'B', law: ", "registry"});
}

TEST_CASE("a maker rejects a value with its place, owner and key", "[unit][model]") {
  const Params p = ramp("{\n\"slope\": -1}");
  try {
    p.refuse("slope", "the slope is -1, it must be greater than zero");
    FAIL("no error");
  } catch (const SceneError& error) {
    CHECK(std::string(error.what()) ==
          "four_bar.json:2:10: joint 'A', drive.law.slope: the slope is -1, it must be greater than zero");
    CHECK(error.file == "four_bar.json");
    CHECK(error.line == 2);
    CHECK(error.column == 10);
  }
  check_words(message_of<SceneError>([&] { p.refuse("start", "too early"); }),
              {"four_bar.json:1:1: ", "start: too early"});
  check_words(message_of<SceneError>([&] { p.number("speed"); }), {"\"speed\"", "its table does not list"});
}

TEST_CASE("parts are named within their owner", "[unit][model]") {
  CHECK(part_of("joint 'A'", "law") == "joint 'A', law");
  CHECK(part_of("joint 'A', law", "slope") == "joint 'A', law.slope");
  CHECK(part_of("", "law") == "law");
}

TEST_CASE("axes", "[unit][model]") {
  CHECK(axis_of("\"x\"") == Vec3::UnitX());
  CHECK(axis_of("\"-y\"") == -Vec3::UnitY());
  CHECK(axis_of("\"+z\"") == Vec3::UnitZ());
  CHECK((axis_of("[0, -3, 4]") - Vec3(0, -0.6, 0.8)).norm() < 1e-15);
  CHECK((axis_of("[1e-300, 0, 0]") - Vec3::UnitX()).norm() < 1e-15);  // short, but not zero
  CHECK((axis_of("[1e200, 1e200, 0]") - Vec3(1, 1, 0).normalized()).norm() < 1e-15);
}

TEST_CASE("orientations in all their forms", "[unit][model]") {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const Mat3 quarter = matrix(y, -x, z);  // about z
  CHECK(distance(turn_of("[0.70710678118654757, 0, 0, 0.70710678118654757]"), quarter) < 1e-15);
  CHECK(distance(turn_of("[0.75, 0, 0, 0.75]"), quarter) < 1e-15);  // of length 1.06
  CHECK(distance(turn_of(R"({"axis": "z", "angle": "90 deg"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"axis": [0, 0, 5], "angle": 1.5707963267948966})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"angles": [0, 0, "90 deg"], "sequence": "xyz"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"angles": ["90 deg", 0, 0], "sequence": "euler"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"angles": ["90 deg", 0, 0], "sequence": "hpb"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"angles": [0, 0, "90 deg"], "sequence": "cardan"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"matrix": [[0, -1, 0], [1, 0, 0], [0, 0, 1]]})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"x": "y", "z": "z"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"x": "y", "y": "-x"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"z": "z", "y": "-x"})"), quarter) < 1e-15);
  CHECK(distance(turn_of(R"({"x": [0, 2, 0], "z": [0, 0.0009, 1]})"), quarter) <
        1e-15);  // x is kept, z turned upright to it
}

TEST_CASE("impossible orientations are rejected", "[unit][model]") {
  check_words(problem_of("turn", "[0, 0, 0, 0]"), {"a.json:1:10: body 'B', turn: ", "[0, 0, 0, 0]", "[1, 0, 0, 0]"});
  check_words(problem_of("turn", "[1, 0, 0, 1]"), {"turn: ", "has length 1.41", "[0.707106781, 0, 0, 0.707106781]"});
  check_words(problem_of("turn", "[1e-200, 0, 0, 1e-200]"), {"has length 1.41e-200", "[0.707106781, 0, 0, 0.7"});
  check_words(problem_of("turn", "[1, 0, 0]"), {"an orientation", "a list of 3"});
  check_words(problem_of("turn", "\"x\""), {"an orientation", "a text (\"x\")"});
  check_words(problem_of("turn", "{}"), {"an orientation", "an object"});
  check_words(problem_of("turn", R"({"axis": "x"})"), {"\"axis\" needs \"angle\""});
  check_words(problem_of("turn", R"({"angle": 1})"), {"\"angle\" needs \"axis\""});
  check_words(problem_of("turn", R"({"axis": [0, 0, 0], "angle": 1})"), {"turn.axis", "not zero"});
  check_words(problem_of("turn", R"({"axis": "x", "angle": "1 m"})"), {"turn.angle", "is a length", "an angle"});
  check_words(problem_of("turn", R"({"axis": "x", "angle": 1, "angel": 1})"), {"unknown key \"angel\"", "angle"});
  check_words(problem_of("turn", R"({"angles": [1, 2, 3]})"), {"\"angles\" needs \"sequence\""});
  check_words(problem_of("turn", R"({"angles": [1, 2, 3], "sequence": "xxy"})"), {"turn.sequence", "\"xxy\""});
  check_words(problem_of("turn", R"({"matrix": [[1, 0, 0], [0, 2, 0], [0, 0, 1]]})"),
              {"turn.matrix", "off by 3", "1e-06"});
  check_words(problem_of("turn", R"({"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]})"), {"reflection"});
  check_words(problem_of("turn", R"({"matrix": [1, 0, 0]})"), {"3 numbers"});
  check_words(problem_of("turn", R"({"x": "y"})"), {"two of"});
  check_words(problem_of("turn", R"({"x": "y", "z": "-y"})"), {"parallel"});
  check_words(problem_of("turn", R"({"x": [0, 2, 0], "z": [0, 1, 1]})"), {"\"x\" and \"z\"", "45 deg", "perpendicular"});
  check_words(problem_of("turn", R"({"x": "x", "y": [-0.0011, 1, 0]})"), {"90.1 deg"});
  check_words(problem_of("turn", R"({"x": "y", "y": "z", "z": "x"})"), {"two of"});
}

TEST_CASE("an inconsistent table of keys is rejected", "[unit][model]") {
  const auto problem = [](Keys keys) {
    return message_of<ModelError>([&] { check_type_info(TypeInfo{"cam", "", std::move(keys)}); });
  };
  CHECK(message_of<ModelError>([] { check_type_info(kRamp); }) == "no error");
  CHECK(message_of<ModelError>([] { check_type_info(kAll); }) == "no error");
  check_words(problem({{"", Form::number, Unit::none, 0, ""}}), {"'cam'", "no name"});
  check_words(problem({{"a", Form::number, Unit::none, 0, ""}, {"a", Form::text, Unit::none, kRequired, ""}}),
              {"'a'", "twice"});
  check_words(problem({{"a", Form::choice, Unit::none, kRequired, ""}}), {"'a'", "without choices"});
  check_words(problem({{"a", Form::text, Unit::none, 3, ""}}), {"'a'", "a number (3)", "a text in quotes"});
  check_words(problem({{"a", Form::number, Unit::length, "3 s", ""}}), {"'a'", "is a time"});
  check_words(message_of<ModelError>([] { check_type_info(TypeInfo{}); }), {"without a name"});
}

}  // namespace params_test
