// SPDX-License-Identifier: BSD-3-Clause
// Orientations that are none: quaternions far from length 1 and directions that are not at right angles, wherever one is given.
#include <cmath>
#include <sstream>
#include <string>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/scene_folder.h"

namespace scene_orientations_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

/// Scenes that give an orientation, at "~"; by the words with which messages name it.
struct Place {
  const char *owner, *scene;
};
const Place kPlaces[] = {
    {"body 'a', orientation", R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "orientation": ~}])"},
    {"inertia_axes", R"("bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1], "inertia_axes": ~}])"},
    {"compound[0].orientation",
     R"("bodies": [{"name": "a", "compound": [{"sphere": {"mass": 1, "radius": 1}, "orientation": ~}]}])"},
    {"marker 'm', orientation", R"("markers": [{"name": "m", "body": "ground", "at": [0, 0, 0], "orientation": ~}])"},
    {"marker 'm', world_orientation", R"("markers": [{"name": "m", "body": "ground", "world_orientation": ~}])"},
    {"joint 'A', orientation",
     R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}}],
        "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0], "orientation": ~}])"},
    {"rotation", R"("markers": [{"name": "m", "body": "ground", "rotation": {"type": "constant", "orientation": ~}}])"},
    {"points[1]",
     R"("markers": [{"name": "m", "body": "ground", "rotation": {"type": "spline_rotation",
        "points": [[0, {"axis": "x", "angle": 1}], [1, ~]], "outside": "hold"}}])"}};

struct Answer {
  std::string refused, said;
};
Answer answer(const Place& place, const std::string& orientation) {
  builtin();
  std::string text = std::string("{\"lockstep\": 1,\n ") + place.scene + "}";
  text.replace(text.find('~'), 1, orientation);
  std::ostringstream words;
  set_logger(std::make_shared<spdlog::logger>("host", std::make_shared<spdlog::sinks::ostream_sink_mt>(words)));
  const std::string refused =
      message_of<SceneError>([&] { build_mechanism(scene_from_text(text, "turned.json"), builtin()); });
  spdlog::drop("lockstep");
  return {refused, words.str()};
}

std::string times(double factor, double w, double x) {
  std::ostringstream text;
  text.precision(17);
  text << "[" << factor * w << ", " << factor * x << ", 0, 0]";
  return text.str();
}

}  // namespace

TEST_CASE("a quaternion more than a tenth off length 1 is rejected with its length and the right one",
          "[unit][scene]") {
  for (const Place& place : kPlaces) {
    CAPTURE(place.owner);
    for (const double length : {std::sqrt(2.0), 2.0, 0.5, 0.89, 1.11, 1e-200, 1e200}) {
      const std::string given = times(length, 0.6, 0.8), refused = answer(place, given).refused;
      CAPTURE(given);
      check_words(refused, {"turned.json:", place.owner, "the quaternion has length ", "write [0.6, 0.8, 0, 0]"});
    }
    check_words(answer(place, "[1, 1, 0, 0]").refused, {"length 1.41", "[0.707106781, 0.707106781, 0, 0]"});
    check_words(answer(place, "[0, 0, 0, 0]").refused, {place.owner, "[0, 0, 0, 0] is not an orientation"});
  }
}

TEST_CASE("a quaternion off length 1 by more than rounding is reported, and normalised", "[unit][scene]") {
  const Place& body = kPlaces[0];
  for (const double length : {0.91, 0.998, 1.002, 1.09}) {
    CAPTURE(length);
    const Answer near = answer(body, times(length, 0.6, 0.8));
    CHECK(near.refused == "no error");
    std::ostringstream shown;
    shown << length;
    check_words(near.said, {"body 'a', orientation: the quaternion has length " + shown.str(), "[0.6, 0.8, 0, 0]"});
  }
  for (const Place& place : kPlaces) {
    CAPTURE(place.owner);
    check_words(answer(place, "[0.642, 0.856, 0, 0]").said, {place.owner, "has length 1.07", "[0.6, 0.8, 0, 0]"});
  }
  for (const char* rounded :
       {"[0.707, 0.707, 0, 0]", "[0.577, 0.577, 0.577, 0]", "[0.6, 0.8, 0, 0]", "[-1, 0, 0, 0]"}) {
    CAPTURE(rounded);
    CHECK(answer(body, rounded).said.empty());
    CHECK(answer(body, rounded).refused == "no error");
  }
}

TEST_CASE("directions of axes that are not at right angles are rejected with their angle", "[unit][scene]") {
  for (const Place& place : kPlaces) {
    CAPTURE(place.owner);
    // acos(0.5 / sqrt(1.25)) = 63.4 deg
    check_words(answer(place, R"({"x": [1, 0, 0], "y": [0.5, 1, 0]})").refused,
                {"turned.json:", place.owner, "\"x\" and \"y\" are 63.4 deg apart", "change one of them"});
    check_words(answer(place, R"({"x": [1, 0, 0], "z": [-2, 0, 0]})").refused, {place.owner, "are parallel"});
    check_words(answer(place, R"({"matrix": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]})").refused,
                {"turned.json:", "the columns are not orthonormal"});
    CHECK(answer(place, R"({"x": [1, 0, 0], "y": [0.0005, 1, 0]})").refused == "no error");  // of three digits
  }
}

}  // namespace scene_orientations_test
