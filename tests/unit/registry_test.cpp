// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/registry.h>

#include "framework/description/scene/json.h"
#include <lockstep/error.h>
#include "tests/support/messages.h"

namespace registry_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

struct OwnConstant final : MotionLaw {
  explicit OwnConstant(double y0) : y(y0) {}
  static TypeInfo info() { return {"constant", "a number", {{"value", Form::number, Unit::any, kRequired, "the number"}}}; }
  static LawPtr<MotionLaw> make(const Params& p) { return std::make_shared<OwnConstant>(p.number("value")); }
  LawValue at(double) const override { return {y, 0, 0}; }
  double y;
};

struct Scaled final : MotionLaw {
  static TypeInfo info() {
    return {"scale",
            "a law times a number",
            {{"factor", Form::number, Unit::none, 2, ""}, {"base", Form::law, Unit::none, kRequired, "scaled"}}};
  }
  static LawPtr<MotionLaw> make(const Params& p) {
    auto law = std::make_shared<Scaled>();
    law->factor = p.number("factor");
    law->base = p.law("base");
    return law;
  }
  LawValue at(double t) const override { return {factor * base->at(t).y, 0, 0}; }
  double factor = 1;
  LawPtr<MotionLaw> base;
};

struct Still final : TranslationLaw {
  static TypeInfo info() { return {"constant", "", {{"value", Form::vector3, Unit::length, kRequired, "the place"}}}; }
  static LawPtr<TranslationLaw> make(const Params& p) {
    auto law = std::make_shared<Still>();
    law->x = p.vector3("value");
    return law;
  }
  TranslationValue at(double) const override { return {x, Vec3::Zero(), Vec3::Zero()}; }
  Vec3 x;
};

struct Turned final : RotationLaw {
  static TypeInfo info() { return {"constant", "", {{"value", Form::orientation, Unit::none, kRequired, "the turn"}}}; }
  static LawPtr<RotationLaw> make(const Params& p) {
    auto law = std::make_shared<Turned>();
    law->q = p.orientation("value");
    return law;
  }
  RotationValue at(double) const override { return {q, Vec3::Zero(), Vec3::Zero()}; }
  Quat q;
};

Registry some_registry() {
  Registry registry;
  registry.laws.add<OwnConstant>();
  registry.laws.add<Scaled>();
  registry.translation_laws.add<Still>();
  registry.rotation_laws.add<Turned>();
  return registry;
}

std::unique_ptr<Force> no_force(const Attachment&, const Params&) { return nullptr; }

std::string law_problem(const std::string& json) {
  return message_of<SceneError>([&] { some_registry().scalar_law(read_json(json, "a.json"), "joint 'A', drive.law"); });
}

}  // namespace

TEST_CASE("a law is made by its name", "[unit][plugin]") {
  const Registry registry = some_registry();
  CHECK(registry.laws.make("constant", Params{{"value", 3}}, &registry, "law 'c'")->at(0).y == 3);
  CHECK(registry.laws.make("scale", Params{{"base", 3}}, &registry, "law 's'")->at(0).y == 6);
  CHECK(registry.laws.names() == std::vector<std::string>{"constant", "scale"});
  CHECK(registry.laws.find("scale")->info.help == "a law times a number");
  CHECK(registry.laws.find("ramp") == nullptr);
}

TEST_CASE("an unknown name is rejected with the closest one", "[unit][plugin]") {
  const Registry registry = some_registry();
  const auto problem = [&](const std::string& name) {
    return message_of<SceneError>([&] { registry.laws.make(name, Params{}, &registry, "joint 'A'"); });
  };
  CHECK(problem("scal") == "joint 'A': unknown law \"scal\"; did you mean \"scale\"?");
  CHECK(problem("polynomial") == "joint 'A': unknown law \"polynomial\"; known: constant, scale");
  check_words(
      message_of<SceneError>([&] { registry.links.make("gear", Attachment{}, Params{}, &registry, "joint 'A'"); }),
      {"unknown joint \"gear\""});
}

TEST_CASE("laws inside laws are made, bare values are constants", "[unit][plugin]") {
  const Registry registry = some_registry();
  const auto y = [&](const std::string& json) { return registry.scalar_law(read_json(json, "a.json"))->at(0).y; };
  CHECK(y("3") == 3);
  CHECK(y("\"3 mm\"") == 0.003);
  CHECK(y(R"({"type": "scale", "factor": 5, "base": {"type": "scale", "base": {"type": "constant", "value": 7}}})") ==
        70);
  CHECK(registry.translation_law(read_json("[1, 2, \"3 mm\"]", "a.json"))->at(0).x == Vec3(1, 2, 0.003));
  CHECK(registry.translation_law(read_json(R"({"type": "constant", "value": [1, 2, 3]})", "a.json"))->at(0).x ==
        Vec3(1, 2, 3));
  CHECK(registry.rotation_law(read_json("[0, 1, 0, 0]", "a.json"))->at(0).q.x == 1);
}

TEST_CASE("a fault inside a law names the whole way to it", "[unit][plugin]") {
  CHECK(law_problem(R"({"type": "scale", "base": {"type": "constant", "valeu": 1}})") ==
        "a.json:1:48: joint 'A', drive.law.base: unknown key \"valeu\"; did you mean \"value\"?");
  check_words(law_problem(R"({"type": "scale", "base": {"type": "constant", "value": []}})"),
              {"a.json:1:57: joint 'A', drive.law.base.value: expected", "an empty list"});
  CHECK(law_problem(R"({"type": "scal", "base": 1})") ==
        "a.json:1:10: joint 'A', drive.law: unknown law \"scal\"; did you mean \"scale\"?");
  check_words(law_problem(R"({"base": 1})"),
              {"a.json:1:1: joint 'A', drive.law: missing key \"type\"", "constant or scale"});
  check_words(law_problem(R"({"type": 3})"),
              {"a.json:1:10: joint 'A', drive.law.type: expected a text", "a number (3)"});
  check_words(law_problem("true"), {"expected an object", "got true"});
  check_words(law_problem("null"), {"expected an object", "got null"});
  check_words(law_problem("[1, 2]"), {"expected a quantity", "a list of 2"});
  check_words(law_problem(R"({"type": "scale", "factor": 2})"), {"missing key \"base\"", "scaled"});
  check_words(message_of<SceneError>([] { Registry{}.scalar_law(Value(3), "joint 'A', law"); }),
              {"joint 'A', law: expected an object", "a number (3)"});
}

TEST_CASE("impossible entries of a registry are rejected", "[unit][plugin]") {
  Registry registry = some_registry();
  registry.laws.set_origin("built in");
  const auto problem = [](const auto& act) { return message_of<PluginError>(act); };
  check_words(problem([&] { registry.laws.add<OwnConstant>(); }),
              {"law 'constant' is already registered (built in)", "another name"});
  check_words(problem([&] { registry.laws.add({}, &OwnConstant::make); }), {"a law has no name"});
  check_words(problem([&] { registry.forces.add({"wind", "", {}}, nullptr); }), {"force 'wind' has no maker"});
  check_words(problem([&] {
                registry.laws.add({"bad", "", {{"a", Form::text, Unit::none, 3, ""}}}, &OwnConstant::make);
              }),
              {"law 'bad' cannot be registered", "a number (3)"});
  CHECK(registry.laws.entries().size() == 2);
}

TEST_CASE("a maker that returns nothing is rejected", "[unit][plugin]") {
  Registry registry;
  registry.forces.add({"wind", "", {}}, &no_force);
  registry.forces.set_origin("storm");
  check_words(
      message_of<PluginError>([&] { registry.forces.make("wind", Attachment{}, Params{}, nullptr, "force 'w'"); }),
      {"force 'w' (wind of plugin storm): its maker returned null"});
}

TEST_CASE("errors of parameters have object, type and key as data", "[unit][plugin]") {
  Registry registry;
  registry.forces.add({"wind", "", {{"speed", Form::number, Unit::speed, kRequired, ""}}}, &no_force);
  registry.forces.set_origin("storm");
  for (const auto& [params, key] : {std::pair{Params{}, "speed"}, std::pair{Params{{"speed", "3 kg"}}, "speed"},
                                    std::pair{Params{{"speed", 3}, {"sped", 3}}, "sped"}}) {
    try {
      registry.forces.make("wind", Attachment{"w", {}}, params, nullptr, "force 'w'");
      FAIL("no error");
    } catch (const SceneError& error) {
      check_words(error.what(), {"force 'w' (wind of plugin storm)"});
      CHECK(error.thing.label() == "force 'w' (wind of plugin storm)");
      CHECK(error.key == key);
    }
  }
  try {
    registry.forces.make("wnd", Attachment{"w", {}}, Params{}, nullptr, "force 'w'");
    FAIL("no error");
  } catch (const SceneError& error) {
    CHECK(error.thing.name == "w");
    CHECK(error.problem == "unknown force \"wnd\"");
    CHECK(error.advice == "did you mean \"wind\"?");
  }
}

TEST_CASE("entries keep their origin", "[unit][plugin]") {
  Registry registry;
  registry.laws.add<OwnConstant>();
  registry.laws.set_origin("built in");
  registry.laws.add<Scaled>();
  registry.laws.set_origin("plugin");
  CHECK(registry.laws.find("constant")->origin == "built in");
  CHECK(registry.laws.find("scale")->origin == "plugin");
}

TEST_CASE("registries are merged whole or not at all", "[unit][plugin]") {
  Registry base;
  base.translation_laws.add<Still>();
  base.translation_laws.set_origin("built in");
  Registry more;
  more.laws.add<OwnConstant>();
  more.forces.add({"wind", "", {}}, &no_force);
  base.merge(more);
  CHECK(base.laws.names() == std::vector<std::string>{"constant"});
  CHECK(base.forces.find("wind") != nullptr);

  Registry clash;  // its laws are fresh, its translation law is taken
  clash.laws.add<Scaled>();
  clash.translation_laws.add<Still>();
  clash.translation_laws.set_origin("storm");
  check_words(message_of<PluginError>([&] { base.merge(clash); }),
              {"translation law 'constant' (plugin storm)", "(built in)", "another name"});
  CHECK(base.laws.names() == std::vector<std::string>{"constant"});
  CHECK(base.translation_laws.find("constant")->origin == "built in");
  check_words(message_of<PluginError>([&] { base.merge(base); }), {"already registered", "another name"});
}

TEST_CASE("two registries know nothing of each other", "[unit][plugin]") {
  const Registry one = some_registry(), other;
  CHECK(one.laws.find("constant") != nullptr);
  CHECK(other.laws.find("constant") == nullptr);
}

}  // namespace registry_test
