// SPDX-License-Identifier: BSD-3-Clause
// meet(...) in formulas: the points that circles and lines have in common.
#include <cmath>
#include <random>
#include <span>

#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/function.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/scene_folder.h"

namespace meet_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

// A particle at the point C that a formula gives.
Scene scene_of(const std::string& formula) {
  return scene_from_text(R"~({"lockstep": 1,
    "parameters": {"three": "300 mm", "four": "40 cm", "side": -1, "m": "2 kg", "n": 0.3},
    "points": {"A": [0, 0, 0], "B": [0.5, 0, 0], "up": [0, 0.5, 0], "high": [0.5, 0, 0.1], "far": [2, 1, 0],
               "C": "=)~" + formula +
                             R"~("},
    "bodies": [{"name": "c", "particle": 1, "position": "C"}]})~",
                         "s.json");
}
Vec3 met(const std::string& formula, const std::vector<std::string>& set = {}) {
  return build_mechanism(set_in_scene(scene_of(formula), set, builtin()), builtin()).system.body("c").home.x;
}
std::string refusal(const std::string& formula) {
  return message_of<SceneError>([&] { scene_of(formula); });
}

}  // namespace

TEST_CASE("two circles meet to the left and to the right of the line of their centres", "[unit][scene]") {
  const auto is = [](const Vec3& point, const Vec3& expected) {
    CAPTURE(point[0], point[1], point[2]);
    CHECK((point - expected).norm() < 1e-15);
  };
  // the triangle of 3, 4 and 5: its height is 12/5, and divides the 5 into 9/5 and 16/5
  is(met("meet(A, three, B, four, left)"), {0.18, 0.24, 0});
  is(met("meet(A, three, B, four, right)"), {0.18, -0.24, 0});
  is(met("meet(B, four, A, three, right)"), {0.18, 0.24, 0});
  is(met("meet(A, three, up, four, left)"), {-0.24, 0.18, 0});
  is(met("meet(A + [0, 0, 1 m], 0.3 m, B + [0, 0, 1 m], 2*20 cm, left)"), {0.18, 0.24, 1});
  // in the plane xz: y points to the viewer, so that x points up if z points to the right
  is(met("meet(A, three, [0, 0, 0.5 m], four, left, [0, 1, 0])"), {0.24, 0, 0.18});
  is(met("meet(A, three, [0, 0, 0.5 m], four, right, [0, 1 m, 0])"), {-0.24, 0, 0.18});
  is(met("meet(A, three, high - [0, 0, 0.1 m], four, left, [0, -3, 0])"), {0.18, 0, 0.24});
  // plain numbers are in SI
  is(met("meet(A, 0.3, B, 0.4, left)"), {0.18, 0.24, 0});
  is(met("meet(A, n, B, four, left)"), {0.18, 0.24, 0});
  // the side as a number
  is(met("meet(A, three, B, four, side)"), {0.18, -0.24, 0});
  is(met("meet(A, three, B, four, side)", {"side=2"}), {0.18, 0.24, 0});
  // a change of a radius: 0.25 is half of the distance, so that both triangles are one of 0.4, 0.4 and 0.5
  is(met("meet(A, three, B, four, left)", {"three=400 mm"}), {0.25, std::sqrt(0.4 * 0.4 - 0.25 * 0.25), 0});
  // one within another
  is(met("meet(A, norm(meet(A, three, B, four, left) - A), B, four, right)"), {0.18, -0.24, 0});
}

TEST_CASE("a formula of variables reads a point where circles of constants meet", "[unit][scene]") {
  const expression::FormulaFunction f("=t*meet([0, 0, 0], 0.3, [0.5, 0, 0], 0.4, left).y", {"t"});
  const Time t(2);
  CHECK(f(std::span<const Time>(&t, 1)).v == Approx(0.48).epsilon(1e-14));
}

TEST_CASE("circles that touch meet in one point", "[unit][scene]") {
  // across the line of the centres round-off leaves its square root
  CHECK((met("meet(A, 0.1 m, B, 0.4 m, left)") - Vec3(0.1, 0, 0)).norm() < 1e-9);  // outside
  CHECK((met("meet(A, 0.8 m, B, 0.3 m, left)") - Vec3(0.8, 0, 0)).norm() < 1e-9);  // inside
  CHECK((met("meet(A, 0, B, 0.5 m, right)") - Vec3(0, 0, 0)).norm() < 1e-9);       // a point
  CHECK((met("meet(A, 0.1 m, far, sqrt(5)*1 m - 0.1 m, left)") - 0.1 / std::sqrt(5) * Vec3(2, 1, 0)).norm() < 1e-7);
}

TEST_CASE("the point where circles meet has their radii as its distances, on the given side", "[unit][scene]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int k = 0; k < 50; ++k) {
    const Vec3 a(number(random), number(random), 0.3), b(number(random), number(random), 0.3);
    const double d = (b - a).norm(), r = d * (1 + number(random) / 2), s = d * (0.9 + number(random) / 3);
    if (r + s < 1.01 * d || std::abs(r - s) > 0.99 * d) continue;
    const auto of = [](double x) { return text::number(x) + " m"; };
    const auto point = [&](const Vec3& p) { return "[" + of(p[0]) + ", " + of(p[1]) + ", " + of(p[2]) + "]"; };
    const bool left = k % 2 == 0;
    const Vec3 c =
        met("meet(" + point(a) + ", " + of(r) + ", " + point(b) + ", " + of(s) + (left ? ", left)" : ", right)"));
    CAPTURE(k, r, s, d);
    CHECK(std::abs((c - a).norm() - r) < 1e-14);
    CHECK(std::abs((c - b).norm() - s) < 1e-14);
    CHECK(c[2] == 0.3);
    CHECK((cross(b - a, c - a)[2] > 0) == left);
  }
}

TEST_CASE("two lines meet in any plane", "[unit][scene]") {
  CHECK((met("meet(A, [1 m, 1 m, 0], [0, 1 m, 0], [1 m, 0, 0])") - Vec3(0.5, 0.5, 0)).norm() < 1e-15);
  CHECK((met("meet(B, A, up, up + [1 m, 1 m, 0])") - Vec3(-0.5, 0, 0)).norm() < 1e-15);  // beyond their points
  // P + 2 (1, 2, 3) = Q - 3 (1, -1, 1), with P = (1, 1, 1): Q = (6, 2, 10)
  CHECK((met("meet([1 m, 1 m, 1 m], [2 m, 3 m, 4 m], [6 m, 2 m, 10 m], [7 m, 1 m, 11 m])") - Vec3(3, 5, 7)).norm() <
        1e-14);
}

TEST_CASE("a point that does not exist is an error with its name, the sizes and the next move", "[unit][scene]") {
  struct Bad {
    const char* formula;
    std::vector<std::string> words;
  };
  for (const Bad& bad : {
           Bad{"meet(A, 0.1 m, B, 0.2 m, left)",
               {"s.json:4:21: scene.points.C", "the circles do not meet: the centres are 0.5 m apart",
                "radii 0.1 m and 0.2 m need 0.1 m to 0.3 m", "change a radius, or move a centre"}},
           Bad{"meet(A, 0.9 m, B, three, left)", {"0.5 m apart", "need 0.6 m to 1.2 m"}},
           Bad{"meet(A, three, A, three, left)", {"both centres are at the same point", "move one"}},
           Bad{"meet(A, -three, B, four, left)", {"a radius is negative: -0.3 m"}},
           Bad{"meet(A, three, high, four, left)",
               {"the centres differ by 0.1 m along the axis", "which is z if no other is given"}},
           Bad{"meet(A, three, B, four, left, [1, 0, 0])", {"the centres differ by 0.5 m along the axis"}},
           Bad{"meet(A, three, B, four, left, [0, 0, 0])", {"the axis has no direction"}},
           Bad{"meet(A, three, B, four, left, 1)", {"argument 6 of meet is a pure number"}},
           Bad{"meet(A, three, B, four, 0)", {"the side is 0; give left, right, 1 or -1"}},
           Bad{"meet(A, three, B, four, middle)", {"unknown name \"middle\""}},
           Bad{"meet(A, three, B, four)", {"argument 2 of meet is a length", "meet(A, r, B, s, left) of circles"}},
           Bad{"meet(A, three, B, four, three)", {"argument 5 of meet is a length"}},
           Bad{"meet(A, B, A, B, left)", {"argument 2 of meet is a vector (a length)"}},
           Bad{"meet(A, m, B, four, left)", {"a length and a mass"}},
           Bad{"meet(A, three, B)", {"meet takes 4 or more arguments, and 3 are given"}},
           Bad{"meet(A, B, up, up + B)", {"the lines are parallel"}},
           Bad{"meet(A, A, up, B)", {"the lines are parallel, or two points of a line coincide"}},
           Bad{"meet(A, B, [0, 0, 0.1 m], [0, 1 m, 0.1 m])",
               {"the lines do not meet: their least distance is 0.1 m", "move a point"}},
           Bad{"left*meet(A, three, B, four, left)", {"unknown name \"left\""}},
       }) {
    INFO(bad.formula);
    check_words(refusal(bad.formula), bad.words);
  }
  check_words(
      message_of<ModelError>([] { expression::FormulaFunction("=meet([0, 0, 0], t, [1, 0, 0], 1, left).x", {"t"}); }),
      {"meet(...) is of points of the scene", "\"points\""});
}

}  // namespace meet_test
