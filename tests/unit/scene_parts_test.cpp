// SPDX-License-Identifier: BSD-3-Clause
// Parts of scenes: included ones somewhere else, their values by path, places of bodies in formulas.
#include <unistd.h>

#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/scene_folder.h"

namespace scene_parts_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

/// Parts of a scene, written without what all scenes begin with.
struct Folder : lockstep::testing::SceneFolder {
  Folder() : SceneFolder("parts") {}
  void write(const char* name, const std::string& members) const {
    SceneFolder::write(name, "{\"lockstep\": 1, " + members + "}");
  }
  Scene read(const std::string& members) const {
    return scene_from_text("{\"lockstep\": 1, " + members + "}", path("whole.json"));
  }
  std::string refusal(const std::string& members) const {
    return message_of<Error>([&] { build_mechanism(read(members), builtin()); });
  }
};

// Every way to place something: rods level, tilted, upright and rolled, boxes, a particle, a fixed frame, markers in body axes,
// on a particle and in the world, links by point, axis, orientation, by neither, between markers, a coupling of two pairs, forces in three axes.
const std::string kPart = R"~("parameters": {"L": "1 m"},
  "points": {"O": [0, 0, 0], "E": "=O + [L, 0, 0]"},
  "bodies": [
    {"name": "level", "rod": {"mass": 1, "from": "O", "to": "E"}, "velocity": [0.1, 0.2, 0], "omega_world": [0, 0, 0.3]},
    {"name": "tilted", "rod": {"mass": 2, "from": "E", "to": [2, 0.5, 0.7], "axial_inertia": 0.01}, "omega_body": [0, 1, 0]},
    {"name": "upright", "rod": {"mass": 2, "from": [3, 0, 0], "to": [3, 0, 1], "radius": 0.1}},
    {"name": "rolled", "rod": {"mass": 1, "from": [0, 0, 2], "to": [1, 1, 3], "roll": "40 deg"}},
    {"name": "block", "box": {"mass": 3, "size": [0.1, 0.2, 0.3]}, "position": [1, 2, 3],
     "orientation": {"axis": "y", "angle": 0.4}},
    {"name": "plain", "mass": 2, "inertia": [0.1, 0.2, 0.25], "center": [0.1, 0, 0.05]},
    {"name": "bead", "particle": 0.5, "position": [0, 1, 0], "velocity": [1, 0, 2]},
    {"name": "post", "fixed": true, "position": [4, 0, 0]}],
  "markers": [
    {"name": "on_tilted", "body": "tilted", "at": [0.2, 0.1, -0.1], "orientation": {"axis": "x", "angle": 0.3}},
    {"name": "on_ground", "body": "ground", "at": [0, 1, 1]},
    {"name": "in_world", "body": "block", "world_at": [1, 2, 3.5]},
    {"name": "turned", "body": "block", "world_orientation": {"x": [1, 1, 0], "y": [-1, 1, 0]}},
    {"name": "bare", "body": "ground"},
    {"name": "on_bead", "body": "bead"},
    {"name": "beside_bead", "body": "bead", "at": [0.1, 0.2, 0.3], "orientation": {"axis": "x", "angle": 0.5}}],
  "links": [
    {"name": "hinge", "type": "revolute", "p": "level", "s": "ground", "at": "O", "axis": "y"},
    {"name": "default_axes", "type": "revolute", "p": "tilted", "s": "level", "at": "E"},
    {"name": "ball", "type": "spherical", "p": "on_tilted", "s": "block", "at": [1.5, 0.4, 0.3], "active": false},
    {"name": "slide", "type": "prismatic", "p": "block", "s": "ground", "at": [1, 2, 3], "orientation": {"x": [0, 1, 0], "z": [1, 0, 0]}},
    {"name": "axle", "type": "revolute", "p": "upright", "s": "post", "at": [3, 0, 0], "axis": [0, 0, 1]},
    {"name": "gears", "type": "gear", "ratio": 2, "pairs": ["hinge", {"p": "plain", "s": "ground", "at": [0, 0, 0], "axis": "x"}]}],
  "forces": [
    {"name": "push", "type": "applied_force", "p": "bead", "force": [1, 2, 3]},
    {"name": "in_marker_axes", "type": "applied_force", "p": "on_bead", "axes": "marker", "force": [0.5, 0.2, 0.1]},
    {"name": "in_body_axes", "type": "applied_force", "p": "bead", "axes": "body", "force": [0.1, 0.7, 0.3]},
    {"name": "in_carrier_axes", "type": "applied_force", "p": "on_bead", "axes": "body", "direction": "y",
     "law": {"type": "constant", "value": 2}},
    {"name": "along", "type": "applied_force", "p": "block", "at": [1, 2, 3.1], "direction": "x", "law": {"type": "constant", "value": 2}},
    {"name": "own", "type": "applied_torque", "p": "plain", "at": [0, 0, 0], "torque": [0.1, 0.2, 0.3], "axes": "body"},
    {"name": "spring", "type": "spring_damper", "p": "bead", "s": "on_ground", "stiffness": 10, "free_length": 0.5}],
  "planar": "off")~";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}
const std::string kGears = replaced(kPart, R"("ratio": 2, )", R"("teeth_1": 20, "teeth_2": 10, )");

std::string words(const Vec3& v) {
  std::ostringstream text;
  text.precision(17);
  text << "[" << v[0] << ", " << v[1] << ", " << v[2] << "]";
  return text.str();
}

double apart(const Quat& a, const Quat& b) { return rotation_vector(conjugate(a) * b).norm(); }

}  // namespace

TEST_CASE("an included scene stands somewhere else and moves there as it would at home", "[unit][scene]") {
  const Folder folder;
  folder.write("part.json", kGears);
  const Vec3 g(1, -9, 2);
  const Pose by{Vec3(1, 2, -3), axis_angle(Vec3(1, 2, 2) / 3, 0.7)};
  const Mat3 A = rotation(by.q);
  Mechanism home = build_mechanism(folder.read(kGears + ", \"gravity\": " + words(g)), builtin());
  Mechanism away =
      build_mechanism(folder.read(R"("planar": "off", "gravity": )" + words(A * g) +
                                  R"(, "include": [{"scene": "part.json", "prefix": "my_", "at": [1, 2, -3],
                       "orientation": {"axis": [1, 2, 2], "angle": "=0.7"}}])"),
                      builtin());
  for (const Body& body : home.system.bodies()) {
    if (body.name == "ground") continue;
    INFO(body.name);
    const Body& moved = away.system.body("my_" + body.name);
    CHECK((moved.home.x - (by.x + A * body.home.x)).norm() < 1e-14);
    if (body.freedoms != Freedoms::particle) CHECK(apart(moved.home.q, by.q * body.home.q) < 1e-14);
    CHECK((moved.start.v - A * body.start.v).norm() < 1e-14);
    CHECK((moved.start.w - body.start.w).norm() < 1e-14);  // body axes
  }
  for (const Marker& marker : home.system.markers()) {
    INFO(marker.name);
    const Marker& moved = away.system.marker("my_" + marker.name);
    const Pose from = by * (marker.body->home * marker.local), to = moved.body->home * moved.local;
    CHECK((to.x - from.x).norm() < 1e-14);
    CHECK(apart(to.q, from.q) < 1e-14);
  }
  // The laws of mechanics hold in both places: a' = A a, alpha' = alpha in body axes, for the whole under turned gravity.
  Dynamics at_home(system_of(home), make_solver(home.run, builtin())),
      elsewhere(system_of(away), make_solver(away.run, builtin()));
  const VecX a = at_home.evaluate(home.system.start()).a, b = elsewhere.evaluate(away.system.start()).a;
  REQUIRE(a.size() == b.size());
  for (const Body& body : home.system.bodies()) {
    if (body.fixed) continue;
    INFO(body.name);
    const int i = 6 * body.slot, k = 6 * away.system.body("my_" + body.name).slot;
    CHECK((b.segment<3>(k) - A * a.segment<3>(i)).norm() < 1e-10 * (1 + a.norm()));
    if (body.freedoms != Freedoms::particle)
      CHECK((b.segment<3>(k + 3) - a.segment<3>(i + 3)).norm() < 1e-10 * (1 + a.norm()));
  }
}

TEST_CASE("the place of an included scene depends on earlier parameters, points and parts", "[unit][scene]") {
  const Folder folder;
  folder.write("leg.json", R"~("parameters": {"L": "1 m"}, "points": {"hip": [0, 0, 0], "foot": "=[L, 0, 0]"},
    "bodies": [{"name": "leg", "rod": {"mass": 1, "from": "hip", "to": "foot"}}],
    "links": [{"name": "H", "type": "revolute", "p": "leg", "s": "ground", "at": "hip"}])~");
  const std::string chain = R"~("parameters": {"start": "2 m", "bend": "90 deg"}, "points": {"S": "=[start, 0, 0]"},
    "include": [{"scene": "leg.json", "prefix": "a_", "at": "S"},
                {"scene": "leg.json", "prefix": "b_", "at": "=a_foot", "orientation": {"axis": "z", "angle": "=bend"}},
                {"scene": "leg.json", "prefix": "c_", "at": "=b_leg.to + [0, 1 m, 0]"}])~";
  const Mechanism m = build_mechanism(folder.read(chain), builtin());
  CHECK((m.system.body("a_leg").home.x - Vec3(2.5, 0, 0)).norm() < 1e-15);
  CHECK((m.system.body("b_leg").home.x - Vec3(3, 0.5, 0)).norm() < 1e-15);
  CHECK((m.system.body("c_leg").home.x - Vec3(3.5, 2, 0)).norm() < 1e-15);
  const Mechanism moved = build_mechanism(set_in_scene(folder.read(chain), {"start=5 m"}, builtin()), builtin());
  CHECK((moved.system.body("b_leg").home.x - Vec3(6, 0.5, 0)).norm() < 1e-15);

  check_words(folder.refusal(R"("include": [{"scene": "leg.json", "at": "Q"}])"), {"include[0]", "at"});
  check_words(folder.refusal(R"("include": [{"scene": "leg.json", "at": "=1 kg*[1, 0, 0]"}])"),
              {"include[0]", "at", "mass"});
  check_words(folder.refusal(R"("include": [{"scene": "leg.json", "orientation": {"axis": "w"}}])"),
              {"include[0]", "orientation"});
  folder.write("laws.json", R"("bodies": [{"name": "b", "particle": 1}],
    "forces": [{"name": "F", "type": "applied_force", "p": "b", "laws": [1, 2, 3]}])");
  CHECK_NOTHROW(build_mechanism(folder.read(R"("include": [{"scene": "laws.json", "at": [1, 0, 0]}])"), builtin()));
  check_words(folder.refusal(R"("include": [{"scene": "laws.json", "orientation": {"axis": "z", "angle": 1}}])"),
              {"laws.json:", "force 'F', laws", "\"axes\": \"marker\""});
}

TEST_CASE("a formula that fails inside an included scene is named with its file", "[unit][scene]") {
  const Folder folder;
  folder.write("leg.json", R"~("parameters": {"L": "1 m", "m": "1 kg"}, "points": {"foot": "=[L, 0, 0]"},
    "bodies": [{"name": "leg", "rod": {"mass": "=m - 2 kg", "from": [0, 0, 0], "to": "=foot*2"}}])~");
  check_words(folder.refusal(R"("include": [{"scene": "leg.json"}])"),
              {"leg.json:", "body 'leg', rod", "must be greater than 0", "the value is from the formula \"=m - 2 kg\""});
  check_words(folder.refusal(R"("include": [{"scene": "leg.json", "parameters": {"m": "3 kg", "L": "1 s"}}])"),
              {"leg.json:", "points"});
  check_words(
      folder.refusal(R"("parameters": {"q": 1}, "include": [{"scene": "leg.json", "parameters": {"L": "=q*1 kg"}}])"),
      {"leg.json:", "points.foot"});
}

TEST_CASE("contents of parts are varied by path", "[unit][scene]") {
  const Folder folder;
  folder.write("leg.json", R"~("parameters": {"L": "1 m"}, "points": {"hip": [0, 0, 0]},
    "bodies": [{"name": "leg", "rod": {"mass": 1, "from": "hip", "to": "=[L, 0, 0]"}}],
    "links": [{"name": "H", "type": "revolute", "p": "leg", "s": "ground", "at": "hip"}])~");
  const std::string whole = R"~("include": [{"scene": "leg.json", "prefix": "left_"}],
    "repeat": [{"times": 3, "bodies": [{"name": "ball_{i}", "sphere": {"mass": "=1 kg*(i + 1)", "radius": 0.1}}]}],
    "run": {"until": 1, "record": ["left_leg.x"]})~";
  const auto mass = [](const Scene& scene, const char* body) {
    return build_mechanism(scene, builtin()).system.body(body).mass.mass;
  };
  const Scene plain = folder.read(whole);
  const Scene set = set_in_scene(plain, {"bodies.left_leg.rod.mass=2 kg", "bodies.ball_1.sphere.mass=7"}, builtin());
  CHECK(mass(plain, "left_leg") == 1);
  CHECK(mass(set, "left_leg") == 2);
  CHECK(mass(set, "ball_1") == 7);
  CHECK(mass(set, "ball_2") == 3);
  // kept when more is varied, and in the scene as data
  const Variable v = read_variable("bodies.ball_2.sphere.mass=200g:400g:3", set, builtin());
  CHECK(v.unit == "kg");
  REQUIRE(v.values.size() == 3);
  const Scene varied = vary_scene(set, {v}, {1}, builtin());
  CHECK(mass(varied, "ball_2") == Approx(0.3).epsilon(1e-15));
  CHECK(mass(varied, "left_leg") == 2);
  CHECK(setting_text({v}, {2}) == "bodies.ball_2.sphere.mass = 0.4 kg");
  CHECK(mass(folder.read(whole + R"~(, "parameters": {"m": "5 kg"}, "set": {"bodies.left_leg.rod.mass": "=m"})~"),
             "left_leg") == 5);
  CHECK(build_mechanism(set_in_scene(plain, {"bodies.left_leg.rod.to.y=1"}, builtin()), builtin())
            .system.body("left_leg")
            .home.x[1] == 0.5);

  const auto refused = [&](const char* setting) {
    return message_of<Error>([&] { build_mechanism(set_in_scene(plain, {setting}, builtin()), builtin()); });
  };
  check_words(refused("bodies.left_lge.rod.mass=2"), {"left_lge", "did you mean \"bodies.left_leg.rod.mass\""});
  check_words(refused("include.0.scen=a.json"), {"did you mean \"include.0.scene\""});
  CHECK_FALSE(build_mechanism(set_in_scene(plain, {"links.left_H.active=false"}, builtin()), builtin())
                  .system.link("left_H")
                  .active_at_start());  // left to its default there
  check_words(refused("bodies.left_leg.rod.mass=-2"), {"body 'left_leg', rod", "must be greater than 0"});
  check_words(folder.refusal(whole + R"(, "set": {"bodies.leg.rod.mass": 2})"),
              {"scene.set", "\"bodies\" has no \"leg\""});
  check_words(folder.refusal(whole + R"(, "set": {"bodies.left_leg.rod.mass": [2]})"), {"scene.set", "set a single value"});
  check_words(folder.refusal(whole + R"(, "set": [1])"), {"scene.set", "an object of values by path"});
}

TEST_CASE("values set by path reach the parts that read them", "[unit][scene]") {
  const Folder folder;
  folder.write("leg.json", R"~("parameters": {"L": "1 m"}, "points": {"hip": [0, 0, 0]},
    "bodies": [{"name": "leg", "rod": {"mass": 1, "from": "hip", "to": "=[L, 0, 0]"}}])~");
  const std::string whole = R"~("parameters": {"L": "1 m", "n": 2}, "points": {"S": [0, 0, 0]},
    "include": [{"scene": "leg.json", "prefix": "a_", "parameters": {"L": "=L"}, "at": "S"}],
    "repeat": [{"times": "=n", "bodies": [{"name": "ball_{i}", "particle": 1}]}],
    "bodies": [{"name": "own", "particle": 1, "position": "=[L, 0, 0]"}, {"name": "at_hip", "particle": 1, "position": "a_hip"}],
    "set": )~";
  const auto built = [&](const std::string& set) { return build_mechanism(folder.read(whole + set), builtin()); };
  const Mechanism longer = built(R"({"parameters.L": "3 m", "bodies.a_leg.rod.mass": 5})");
  CHECK((longer.system.body("own").home.x - Vec3(3, 0, 0)).norm() < 1e-15);
  CHECK((longer.system.body("a_leg").home.x - Vec3(1.5, 0, 0)).norm() < 1e-15);
  CHECK(longer.system.body("a_leg").mass.mass == 5);
  CHECK((built(R"({"points.S.y": 2})").system.body("a_leg").home.x - Vec3(0.5, 2, 0)).norm() < 1e-15);
  CHECK(built("{}").system.bodies().size() == 6);  // with ground
  CHECK(built(R"({"parameters.n": 4})").system.bodies().size() == 8);
  CHECK((built(R"({"points.a_hip.y": 2})").system.body("at_hip").home.x - Vec3(0, 2, 0)).norm() < 1e-15);
  const Scene scene = folder.read(whole + "{}");
  for (const char* setting : {"a_hip.y=2", "points.a_hip.y=2 m"})
    CHECK((build_mechanism(set_in_scene(scene, {setting}, builtin()), builtin()).system.body("at_hip").home.x -
           Vec3(0, 2, 0))
              .norm() < 1e-15);
  CHECK(read_variable("a_hip.y=1:3:3", scene, builtin()).unit == "m");
  check_words(message_of<Error>([&] { set_in_scene(scene, {"S=1"}, builtin()); }), {"\"S\" is a vector", "S.x"});
  check_words(folder.refusal(whole + R"({"parameters.M": 1})"), {"scene.set", "\"parameters\" has no \"M\""});
}

TEST_CASE("keys of plugins' types are set in parts before the plugins are known", "[unit][scene]") {
  const Folder folder;
  folder.write("part.json", R"~("bodies": [{"name": "b", "particle": 1}],
    "forces": [{"name": "d", "type": "gust", "p": "b"}])~");
  Registry with_gust = builtin_registry();
  double speed = 0;
  with_gust.forces.add({"gust",
                        "",
                        {{"speed", Form::number, Unit::speed, 1, "of the air"},
                         {"toward", Form::vector3, Unit::none, Value::List{1, 0, 0}, "its direction"}}},
                       [&](const Attachment& at, const Params& p) {
                         speed = p.number("speed");
                         throw ModelError("no air at " + at.name);  // nothing more is asked of it
                         return std::unique_ptr<Force>();
                       });
  const Scene plain = folder.read(R"("include": [{"scene": "part.json", "prefix": "left_"}])");
  const auto build = [&](const char* setting) {
    return message_of<Error>([&] { build_mechanism(set_in_scene(plain, {setting}, with_gust), with_gust); });
  };
  check_words(build("forces.left_d.speed=3 km/h"), {"no air at left_d"});
  CHECK(speed == Approx(3 / 3.6).epsilon(1e-15));
  check_words(build("forces.left_d.sped=3"), {"sped", "did you mean \"forces.left_d.speed\""});
  check_words(build("forces.left_d.toward.x=3"), {"plugin", "\"toward\"", "in its definition"});
  check_words(message_of<Error>([&] {
                build_mechanism(folder.read(R"("include": [{"scene": "part.json"}], "set": {"forces.d.sped": 3})"),
                                with_gust);
              }),
              {"force 'd'", "unknown key \"sped\"", "speed"});
  check_words(folder.refusal(R"("include": [{"scene": "part.json"}], "set": {"bodies.b.sped": 3})"),
              {"scene.set", "has no \"sped\""});
}

TEST_CASE("a rotated rod remains a rod", "[unit][scene]") {
  const Folder folder;
  folder.write("leg.json", R"~("parameters": {"L": "2 m"},
    "bodies": [{"name": "leg", "rod": {"mass": 1, "from": [0, 0, 0], "to": "=[L, 0, 0]"}}],
    "markers": [{"name": "knee", "body": "leg", "at": [0.5, 0.2, 0.3]}])~");
  const std::string whole = R"~("points": {"hip": [0, 0, 5]},
    "include": [{"scene": "leg.json", "prefix": "left_", "at": "hip", "orientation": {"axis": "y", "angle": "90 deg"}},
                {"scene": "leg.json", "prefix": "next_", "at": "=left_leg.to", "orientation": {"axis": "x", "angle": "30 deg"}}],
    "bodies": [{"name": "on_knee", "particle": 1, "position": "=left_knee.at"}])~";
  const Mechanism m = build_mechanism(folder.read(whole), builtin());
  const Quat by = axis_angle(Vec3::UnitY(), kPi / 2);
  CHECK((m.system.body("left_leg").home.x - Vec3(0, 0, 4)).norm() < 1e-15);
  CHECK(apart(m.system.body("left_leg").home.q, by) < 1e-14);
  CHECK((m.system.body("on_knee").home.x - Vec3(0.3, 0.2, 3.5)).norm() < 1e-14);
  CHECK((m.system.body("next_leg").home.x - Vec3(1, 0, 3)).norm() < 1e-15);
  CHECK(apart(m.system.body("next_leg").home.q, axis_angle(Vec3::UnitX(), kPi / 6)) < 1e-14);
  for (const Scene& scene : {folder.read(whole + R"~(, "set": {"bodies.left_leg.rod.mass": 2})~"),
                             set_in_scene(folder.read(whole), {"bodies.left_leg.rod.mass=2"}, builtin())}) {
    const Mechanism heavy = build_mechanism(scene, builtin());
    CHECK(heavy.system.body("left_leg").mass.mass == 2);
    CHECK(apart(heavy.system.body("left_leg").home.q, by) < 1e-14);
  }
  const std::string rod =
      R"~("bodies": [{"name": "r", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0], "roll": ROLL}VISUAL}])~";
  const auto with = [&](const char* roll, const char* visual) {
    return replaced(replaced(rod, "ROLL", roll), "VISUAL", visual);
  };
  CHECK(apart(build_mechanism(folder.read(with("\"=2*15 deg\"", "")), builtin()).system.body("r").home.q,
              axis_angle(Vec3::UnitX(), kPi / 6)) < 1e-15);
  check_words(folder.refusal(with("\"1 m\"", "")), {"body 'r', rod", "roll", "angle"});
  check_words(folder.refusal(
                  with("0", R"(, "visual": {"shapes": [{"rod": {"from": [0, 0, 0], "to": [1, 0, 0], "roll": 1}}]})")),
              {"visual", "roll", "a drawn rod is round"});
}

TEST_CASE("contents of an included scene are not lost with keys of another form", "[unit][scene]") {
  const Folder folder;
  folder.write("ball.json", R"("bodies": [{"name": "b", "particle": 1}], "points": {"P": [1, 0, 0]})");
  folder.write("odd.json", R"("bodies": {"name": "b", "particle": 1})");
  const std::string ball = R"("include": [{"scene": "ball.json", "prefix": "a_"}], )";
  check_words(folder.refusal(ball + R"("bodies": null)"), {"bodies", "expected a list of objects, got null"});
  check_words(folder.refusal(ball + R"("bodies": {})"), {"bodies", "expected a list"});
  check_words(folder.refusal(ball + R"("points": [])"), {"points", "expected an object of points"});
  check_words(folder.refusal(R"("include": [{"scene": "odd.json"}])"), {"odd.json:", "bodies", "expected a list"});
  check_words(folder.refusal(R"("include": [{"scene": "ball.json"}, {"scene": "odd.json"}])"),
              {"odd.json:", "bodies", "expected a list"});
}

TEST_CASE("a long chain of included scenes hangs each on the one before", "[unit][scene]") {
  const Folder folder;
  folder.write("link.json", R"~("points": {"end": [0.5, 0, 0]},
    "bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": "end"}}])~");
  const auto chain = [&](int n) {
    std::string whole = R"("include": [{"scene": "link.json", "prefix": "p0_"})";
    for (int i = 1; i < n; ++i)
      whole += R"(, {"scene": "link.json", "prefix": "p)" + std::to_string(i) + R"(_", "at": "=p)" +
               std::to_string(i - 1) + (i % 2 == 0 ? "_b.to" : "_end") + "\"}";
    return whole + "]";
  };
  const Mechanism m = build_mechanism(folder.read(chain(300)), builtin());
  CHECK((m.system.body("p299_b").home.x - Vec3(0.5 * 299 + 0.25, 0, 0)).norm() < 1e-12);
  // Four times the files cost four times the work.
  const auto asked = [&](int n) { return allocations_of([&] { (void)folder.read(chain(n)); }); };
  const long few = asked(100), many = asked(400);
  if (allocations_are_counted()) CHECK(few > 0);
  CHECK(double(many) <= 4.5 * double(few));
}

TEST_CASE("vectors are varied by component", "[unit][scene]") {
  const Folder folder;
  const Scene scene = folder.read(R"~("parameters": {"at": ["1 m", "2 m", "0 m"], "whole": "=2*at", "n": [1, 0, 0]},
    "points": {"A": [0, "500 mm", 0], "B": "=A + at"}, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "b", "particle": 1, "position": "B"}])~");
  const auto position = [&](const std::string& setting) {
    return build_mechanism(set_in_scene(scene, {setting}, builtin()), builtin()).system.body("b").home.x;
  };
  CHECK((position("at.y=20 cm") - Vec3(1, 0.7, 0)).norm() < 1e-15);
  CHECK((position("at.2=3 m") - Vec3(1, 2.5, 3)).norm() < 1e-15);
  CHECK((position("A.z=4") - Vec3(1, 2.5, 4)).norm() < 1e-15);
  CHECK((position("at==[3 m, 0, 0]") - Vec3(3, 0.5, 0)).norm() < 1e-15);
  CHECK(build_mechanism(set_in_scene(scene, {"gravity.y=-1.62"}, builtin()), builtin()).system.gravity()[1] == -1.62);
  const Variable v = read_variable("A.x=0:1:3", scene, builtin());
  CHECK(v.unit == "m");
  CHECK(build_mechanism(vary_scene(scene, {v}, {2}, builtin()), builtin()).system.body("b").home.x[0] == 2);
  const auto refused = [&](const char* setting) {
    return message_of<Error>([&] { set_in_scene(scene, {setting}, builtin()); });
  };
  check_words(refused("at=1"), {"\"at\" is a vector", "at.x"});
  check_words(refused("at.y=1 kg"), {"at.y", "m is expected"});
  check_words(refused("whole.x=1"), {"given as a whole by the formula \"=2*at\""});
  check_words(refused("at.w=1"), {"at", "\"w\""});
}

TEST_CASE("formulas read places of bodies and markers", "[unit][scene]") {
  const Folder folder;
  const std::string bodies = R"~("points": {"Q": "=box.at + [0, 0, 1 m]", "T": "=tip.at"},
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0, 2, 0]}},
               {"name": "box", "box": {"mass": 1, "size": [1, 1, 1]}, "position": "=rod.to + [norm(rod.to - rod.from), 0, 0]",
                "orientation": {"axis": "z", "angle": "=90 deg"}},
               {"name": "on_rod", "particle": 1, "position": "=eye.at"},
               {"name": "on_box", "particle": 1, "position": "T"},
               {"name": "middle", "particle": 1, "position": "=rod.at"},
               {"name": "above", "particle": 1, "position": "Q"}],
    "markers": [{"name": "eye", "body": "rod", "at": [0.5, 0.25, 0]}, {"name": "tip", "body": "box", "at": ["=1 m", 0, 0]}])~";
  const Mechanism m = build_mechanism(folder.read(bodies), builtin());
  const auto at = [&](const char* body) { return m.system.body(body).home.x; };
  CHECK((at("box") - Vec3(2, 2, 0)).norm() < 1e-15);
  CHECK((at("middle") - Vec3(0, 1, 0)).norm() < 1e-15);
  CHECK((at("above") - Vec3(2, 2, 1)).norm() < 1e-15);
  for (const auto& [body, marker] : {std::pair{"on_rod", "eye"}, {"on_box", "tip"}}) {  // as the mechanism places it
    const Marker& there = m.system.marker(marker);
    CHECK((at(body) - (there.body->home * there.local).x).norm() < 1e-15);
  }
  CHECK((at("on_box") - Vec3(2, 3, 0)).norm() < 1e-15);

  const auto refused = [&](const std::string& position) {
    return folder.refusal(R"("bodies": [{"name": "box", "box": {"mass": 1, "size": [1, 1, 1]}, "position": ")" +
                          position + R"("}, {"name": "ball", "particle": 1, "position": "=box.at"}])");
  };
  check_words(refused("=ball.at"), {"depends on itself", "ball.at -> box.at -> ball.at"});
  check_words(refused("=bal.at"), {"unknown name \"bal.at\"", "did you mean \"ball.at\""});
  check_words(refused("=ball.from"), {"body 'ball'", "not a rod", ".at"});
  check_words(refused("=box.mass"), {"column", "expected \".x\"", "\".from\""});
}

}  // namespace scene_parts_test
