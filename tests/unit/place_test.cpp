// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/place.h"

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/reading.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace place_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const char* const kText = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "rod", "rod": {"mass": "500 g", "from": [0, 0, 0], "to": [1, 0, 0]}},
             {"name": "bob", "particle": 2, "position": [3, 0, 0]}],
  "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
             "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 7}}},
            {"name": "L", "type": "distance", "p": "bob", "s": "ground", "length": 3}],
  "run": {"until": 1}})";

struct Searched {
  Registry registry = builtin_registry();
  Value root = read_json(kText, "scene.json");
  ScenePlace operator()(const std::string& path) { return find_place(root, path, registry); }
  std::string refusal(const std::string& path) {
    return message_of<ModelError>([&] { (*this)(path); });
  }
};

}  // namespace

TEST_CASE("paths lead through keys, names and numbers", "[unit][scene]") {
  Searched find;
  CHECK(*find("bodies.bob.particle").value->number() == 2);
  CHECK(*find("bodies.1.particle").value->number() == 2);
  CHECK(find("bodies.1.particle").path == "bodies.bob.particle");
  CHECK(*find("gravity.1").value->number() == -9.81);
  CHECK(*find("bodies.rod.rod.mass").value->text() == "500 g");
  CHECK(*find("links.A.drive.law.slope").value->number() == 7);
  *find("gravity.0").value = Value(1.5);
  CHECK(*find.root.find("gravity")->list()->front().number() == 1.5);
}

TEST_CASE("the tables know unit and form of a place", "[unit][scene]") {
  Searched find;
  CHECK(find("bodies.rod.rod.mass").key.unit == Unit::mass);
  CHECK(find("bodies.rod.rod.to.0").key.unit == Unit::length);
  CHECK(find("gravity.2").key.unit == Unit::acceleration);
  CHECK(find("links.L.length").key.unit == Unit::length);  // of the type
  CHECK(find("links.A.drive.law.slope").key.form == Form::number);
  CHECK(find("run.assemble").key.form == Form::boolean);
  CHECK(find("gravity").whole);
  CHECK(find("gravity").value == find.root.find("gravity"));
  CHECK(find("bodies.bob.omega_body").whole);
  CHECK_FALSE(find("gravity.1").whole);
}

TEST_CASE("keys that the scene leaves out are put in", "[unit][scene]") {
  Searched find;
  const ScenePlace tolerance = find("run.tolerance");
  CHECK(tolerance.value->is_null());
  CHECK_FALSE(tolerance.near == "run.tolerance");
  CHECK(find("bodies.rod.velocity.1").value->number() != nullptr);  // its default is a list
  CHECK(find.root.find("bodies")->list()->front().find("velocity")->list()->size() == 3);
  CHECK(find("bodies.rod.mass").near == "bodies.rod.rod.mass");
  CHECK(find("links.A.drive.law.slope").near.empty());
  Value bare = read_json(R"({"lockstep": 1})", "bare.json");
  CHECK(find_place(bare, "run.until", find.registry).key.unit == Unit::time);
  CHECK(find_place(bare, "gravity.1", find.registry).value->number() != nullptr);
}

TEST_CASE("a wrong path is rejected with the nearest right one", "[unit][scene]") {
  Searched find;
  check_words(find.refusal("bodies.rod.rod.mas"),
              {"\"bodies.rod.rod\" has no \"mas\"", "did you mean \"bodies.rod.rod.mass\"?"});
  check_words(find.refusal("boddies.rodd.rod.mass"), {"the scene has no \"boddies\"", "\"bodies.rod.rod.mass\"?"});
  for (const char* joints : {"links", "joints"}) {
    std::string path = std::string(joints) + ".A.drive.slope";
    rename_joints(path);
    check_words(find.refusal(path), {"\"joints.A.drive\" has no \"slope\"", "\"joints.A.drive.law.slope\"?"});
  }
  CHECK_FALSE(says(find.refusal("links.A.zz"), {"did you mean"}));  // no number of another name
  check_words(find.refusal("gravity.3"), {"\"gravity\" has no \"3\"", "\"gravity."});
  check_words(find.refusal("gravity.w"), {"\"gravity\" has no \"w\""});
  check_words(find.refusal("gravity.1.2"), {"\"gravity.1\" is a single value without parts", "\"gravity.1\"?"});
  check_words(find.refusal("run.tolerence"), {"did you mean \"run.tolerance\"?"});
  check_words(find.refusal(""), {"the scene has no \"\""});
  check_words(find.refusal("links"), {"\"joints\" has several values", "known: A, L"});
  check_words(find.refusal("bodies.rod.orientation"), {"is not in the scene and has several values"});
  check_words(find.refusal("bodies..mass"), {"\"bodies\" has no \"\""});
}

}  // namespace place_test
