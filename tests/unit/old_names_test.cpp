// SPDX-License-Identifier: BSD-3-Clause
// Keys of scenes that were renamed: the old names are read for one more release, and the logger says so.
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace old_names_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

// A marker moved by laws and a link that bounces, under the given names of the three keys.
std::string bounce(const std::string& translation, const std::string& rotation, const std::string& unilateral) {
  return R"({"lockstep": 1, "bodies": [{"name": "ball", "particle": 1, "position": [0, 0, 2]}],
"markers": [{"name": "floor", "body": "ground", "world_at": [0, 0, 0],
")" + rotation +
         R"(": {"type": "axis_rotation", "axis": "z", "law": 0.5},
")" + translation +
         R"(": [0, 0, 1]}],
"links": [{"name": "fall", "type": "lock", "mask": "z", "p": "ball", "s": "floor",
")" + unilateral +
         R"(": {"restitution": 0.5}}]})";
}

struct Read {
  double height, turn;  // of the marker, m, rad
  double restitution;
  std::string said;
};
Read read(const std::string& text) {
  const Registry registry = builtin_registry();  // which may speak of the plugins that it loads
  std::ostringstream words;
  auto own = std::make_shared<spdlog::logger>("host", std::make_shared<spdlog::sinks::ostream_sink_mt>(words));
  own->set_pattern("%l: %v");
  set_logger(own);
  const Mechanism m = build_mechanism(scene_from_text(text, "ball.json"), registry);
  spdlog::drop("lockstep");
  const Marker& floor = m.system.marker("floor");
  return {floor.translation_law->at(0).x.z(), 2 * std::acos(floor.rotation_law->at(0).q.w),
          m.system.link("fall").unilateral()->restitution, words.str()};
}

}  // namespace

TEST_CASE("scene: renamed keys are read by their old names, with a warning", "[unit][scene]") {
  const Read now = read(bounce("translation", "rotation", "unilateral")),
             old = read(bounce("slide", "spin", "one_sided"));
  CHECK(now.said.empty());
  for (const Read* r : {&now, &old}) {
    CHECK(r->height == 1.0);
    CHECK(r->turn == Approx(0.5));
    CHECK(r->restitution == 0.5);
  }
  check_words(old.said, {"warning: renamed-key: ball.json:4:1: \"slide\" is now called \"translation\"",
                         "ball.json:3:1: \"spin\"", "\"rotation\"",
                         "ball.json:6:1:", "\"one_sided\" is now called \"unilateral\"", "next release"});
}

TEST_CASE("scene: the old value of nearly_redundant is read as the new one, with a warning", "[unit][scene]") {
  std::string scene = bounce("translation", "rotation", "unilateral");
  scene.insert(scene.size() - 1, R"(, "run": {"nearly_redundant": "told", "until": 1})");
  check_words(read(scene).said, {"\"told\" is now called \"report\"", "next release"});
}

TEST_CASE("scene: the old and the new name of a key together are an error", "[unit][scene]") {
  std::string both = bounce("slide", "spin", "one_sided");
  both.insert(both.find("\"slide\""), "\"translation\": [0, 0, 2], ");
  check_words(message_of<SceneError>([&] { scene_from_text(both, "ball.json"); }),
              {"ball.json:4:", "\"slide\" is the old name of \"translation\"", "remove \"slide\""});
}

TEST_CASE("vary: a path may have the old name of a key", "[unit][scene]") {
  const Registry registry = builtin_registry();
  Scene scene = scene_from_text(bounce("translation", "rotation", "unilateral"), "ball.json");
  const auto path_of = [&](const std::string& text) { return read_variable(text, scene, registry).path; };
  CHECK(path_of("links.fall.one_sided.restitution=0.1,0.2") == path_of("links.fall.unilateral.restitution=0.1,0.2"));
}

}  // namespace old_names_test
