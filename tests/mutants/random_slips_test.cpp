// SPDX-License-Identifier: BSD-3-Clause
// What random slips (tests/mutants/random) got past.
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/author/registry.h>
#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/frame_laws.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/linearization.h>
#include <lockstep/math.h>
#include <lockstep/modes.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/units.h"
#include "framework/tools/rank/motion_words.h"
#include "tests/support/catch.h"
#include "tests/support/dimension_check.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace lockstep {

// A class of the library's namespace with a function of const objects.
struct WithLambda {
  auto lambda() const {
    return [] {};
  }
};

}  // namespace lockstep

namespace random_slips_test {

using namespace lockstep;
using lockstep::testing::message_of, lockstep::testing::says;

// -- foundation

TEST_CASE("two letters that are exchanged count as one change, also the first two", "[mutants][text]") {
  const auto near = [](const std::string& word, const std::string& name) {
    return text::closest_name(word, std::vector<std::string>{name}) == name;
  };
  CHECK(near("ba", "ab"));  // one exchange, or two changes
  CHECK(near("acb", "abc"));
  CHECK(!near("xb", "ax"));  // the letter after it is another one: two changes
  CHECK(!near("cb", "bd"));
}

TEST_CASE("a list of names is cut after twelve", "[mutants][text]") {
  std::vector<std::string> names;
  for (int k = 0; k < 13; ++k) names.push_back("name_" + std::to_string(k));
  CHECK(text::suggestion("zzz", names).ends_with("name_11, ..."));
  names.pop_back();
  CHECK(text::suggestion("zzz", names).ends_with("name_11"));
}

TEST_CASE("a snapshot rejects numbers that are no letters, and counts that no double has", "[mutants][snapshot]") {
  for (const double letter : {-1.0, 256.0}) {
    Snapshot saved;
    saved.put(1), saved.put(letter);
    SnapshotReader in(saved);
    CHECK_THROWS_AS(in.get_text(), ModelError);
  }
  const double most = std::ldexp(1.0, 53);
  for (const double count : {most, -most}) {
    Snapshot saved;
    saved.put(count), saved.put(1.5 * count);
    SnapshotReader in(saved);
    CHECK(in.get_count() == static_cast<long>(count));
    CHECK_THROWS_AS(in.get_count(), ModelError);
  }
}

TEST_CASE("tables in UTF-16 are rejected by name, in both byte orders", "[mutants][csv]") {
  for (const std::string mark : {"\xFF\xFE", "\xFE\xFF"}) {
    std::istringstream file(mark + "t [s]\n1\n");
    CHECK(says(message_of<FileError>([&] { read_csv(file, "wide.csv"); }), {"UTF-16"}));
  }
}

TEST_CASE("half a revolution is positive about the vector part of its quaternion", "[mutants][math]") {
  CHECK((rotation_vector(Quat{0, 1, 0, 0}) - Vec3(std::numbers::pi, 0, 0)).norm() < 1e-15);
}

TEST_CASE("functions within the library's own are its own, also of const objects", "[mutants][errors]") {
  CHECK(is_of_lockstep(typeid(WithLambda().lambda())));
  CHECK(!is_of_lockstep(typeid([] {})));
}

namespace {

struct Told {
  std::string words;
  bool nested;  // what was thrown is in it
};

// What becomes of an error that leaves code of this thing.
Told told(const ModelError& thrown, const ErrorContext& context) {
  try {
    try {
      throw ModelError(thrown);
    } catch (...) {
      rethrow_in(context);
    }
  } catch (const ModelError& error) {
    return {error.what(), dynamic_cast<const std::nested_exception*>(&error) != nullptr};
  }
}

}  // namespace

TEST_CASE("an error of a host's maker gets a label unless it names the object itself", "[mutants][errors]") {
  const ErrorContext making{.thing = {.kind = "force", .name = "wind"}, .refuses = true};
  CHECK(told(ModelError("force 'wind': no speed"), making).words == "force 'wind': no speed");
  CHECK(told(ModelError("no speed"), making).words == "force 'wind': no speed");
}

TEST_CASE("an error that names the thing gets its type and origin too", "[mutants][errors]") {
  ModelError error("no speed", {.thing = {.kind = "force", .name = "wind"}});
  error.attribute({.kind = "force", .name = "wind", .type = "drag", .origin = "air"}, "");
  CHECK(error.thing.type == "drag");
  error.attribute({.kind = "body", .name = "rod", .type = "other"}, "");
  CHECK(error.thing.type == "drag");
}

TEST_CASE("a parameter that a built-in law rejects is not a law evaluated outside its range", "[mutants][errors]") {
  const ErrorContext force{.thing = {.kind = "force", .name = "wind", .type = "drag", .origin = "built in"}, .t = 2};
  ErrorData of_law{.thing = {.kind = "law", .name = "ramp", .origin = "built in"}};
  CHECK(told(ModelError("beyond its end", of_law), force).nested);
  of_law.key = "duration";
  CHECK(!told(ModelError("below 0", of_law), force).nested);
}

// -- mechanism

namespace {

Mechanism made(const std::string& members) {
  return build_mechanism(scene_from_text("{\"lockstep\": 1, " + members + "}", "slips.json"), builtin_registry());
}

/// Remembers the end of the last step, and counts the evaluations that see it or another one.
class Memorial final : public Force, public Remembering {
 public:
  Memorial(const Marker& at, const Marker& home) : Force("memorial"), at_(at), home_(home) {}
  std::string_view type() const override { return "memorial"; }
  std::vector<const Marker*> markers() const override { return {&at_, &home_}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum&) const override { ++(in.z[first_memory()] == last_ ? right : wrong); }
  const Remembering* remembering() const override { return this; }
  int n_memory() const override { return 1; }
  void start_memory(std::span<double> z) const override { z[0] = 0; }
  void accept_step(const Inputs& in, std::span<double> z) const override { last_ = z[0] = in.t; }

  mutable int right = 0, wrong = 0;

 private:
  const Marker &at_, &home_;
  mutable double last_ = 0;
};

}  // namespace

TEST_CASE("units have powers up to the sixth", "[mutants][units]") {
  CHECK(dimension_of("m^6") == Dimension{.m = 6});
  CHECK(!dimension_of("m^7"));
  CHECK(dimension_of("m^-6") == Dimension{.m = -6});
}

TEST_CASE("a constant that a formula names brings its unit", "[mutants][expression]") {
  const std::vector<NamedNumbers> length = {{"L", {2}, "m"}};
  const auto check = [&](Dimension of_x, std::optional<Dimension> value = {}) {
    lockstep::testing::check_dimensions("x + L", {{"x", of_x}}, length, value);
  };
  CHECK_NOTHROW(check({.m = 1}));
  CHECK_THROWS_AS(check({.kg = 1}), ModelError);
  CHECK_THROWS_AS(check({.m = 1}, Dimension{.kg = 1}), ModelError);  // the sum has the unit of one of its parts
  CHECK_THROWS_AS(lockstep::testing::check_dimensions("2*L", {}, length, Dimension{.kg = 1}), ModelError);
}

TEST_CASE("a marker that a law rotates about the normal stays in the plane", "[mutants][plane]") {
  MarkerFrame frame;
  frame.rotation_law = laws::axis_rotation(Vec3(0, 0, 1), laws::law([](auto t) { return t; }));
  CHECK(frame.stays_in_plane({2}));
  CHECK(!frame.stays_in_plane({0}));
}

TEST_CASE("rounding of a large force does not take a mechanism out of its plane", "[mutants][plane]") {
  const auto pushed = [](const std::string& force) {
    return made(R"~("planar": "z", "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
                    "forces": [{"name": "push", "type": "applied_force", "p": "b", "at": [0, 0, 0], "force": )~" +
                force + "}]");
  };
  CHECK_NOTHROW(pushed("[1e8, 0, 1e-6]"));
  CHECK_THROWS_AS(pushed("[1, 0, 1e-3]"), SceneError);
}

// -- dynamics

// The rod is S of its joint, and hangs on it alone: it turns the other way.
TEST_CASE("a start rotates the body that is on the S side of a joint", "[mutants][start]") {
  for (const double turn : {0.4, 3.0, 4.0, -5.0}) {
    CAPTURE(turn);
    Simulation run(made(R"~("bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
      "links": [{"name": "A", "type": "revolute", "p": "ground", "s": "rod", "at": [0, 0, 0], "start": {"position": {"rz": )~" +
                        std::to_string(turn) + R"~(}}}], "run": {"until": 0, "record": ["A.rz"]})~"));
    run.run();
    CHECK(std::abs(run.table().first("A.rz") - turn) < 1e-9);
    const Body& rod = run.system().body("rod");
    const Pose pose = body_pose(rod, run.state());
    CHECK((pose.x - Vec3(0.5 * std::cos(turn), -0.5 * std::sin(turn), 0)).norm() < 1e-9);
  }
}

TEST_CASE("the one state of a driven speed continues from step to step", "[mutants][integrators]") {
  for (const char* method : {"radau5", "dopri5", "dop853"}) {
    CAPTURE(method);
    System system;
    Body& wheel = system.add_body("wheel", shapes::sphere(1.0, 0.1));
    Revolute& hinge = system.add<Revolute>("hinge", wheel, system.ground(), pose_at({0, 0, 0}));
    hinge.drive_speed(Axis::rz, laws::law([](auto t) { return 1.0 + t; }));
    SimulationOptions options{.integrator = method, .tolerance = 1e-10, .step = 0.1};
    options.dynamics.formulation = Formulation::omega;  // joint coordinates take such a speed without a state
    Simulation run(system, options);
    run.run_until(2);
    CHECK(run.state().s.size() == 1);
    CHECK(run.loop().report().steps >= 20);
    const Quat q = body_pose(wheel, run.state()).q;  // turned by 2 + 2^2/2 rad
    CHECK(std::abs(std::abs(q.w * std::cos(2.0) + q.z * std::sin(2.0)) - 1) < 1e-9);
  }
}

TEST_CASE("the one number that a force remembers continues from step to step", "[mutants][integrators]") {
  for (const char* method : {"rk4", "radau5", "dopri5", "dop853"}) {
    CAPTURE(method);
    System system;
    Body& mass = system.add_body("mass", shapes::sphere(1.0, 0.1));
    const Memorial& force = static_cast<Memorial&>(system.add(
        std::make_unique<Memorial>(system.add_marker("at", mass), system.add_marker("home", system.ground()))));
    system.add<Prismatic>("rail", mass, system.ground(), pose_at({0, 0, 0}));
    Simulation run(system, {.integrator = method, .step = 0.1});
    run.run_until(2);
    CHECK(run.state().z.size() == 1);
    CHECK(run.state().z[0] == Approx(2).epsilon(1e-12));
    CHECK(force.right > 0);
    CHECK(force.wrong == 0);
  }
}

// -- description

TEST_CASE("a text that ends with a word that is no number is reported", "[mutants][json]") {
  for (const char* text : {"nan", "-inf"})
    CHECK(says(message_of<SceneError>([&] { read_json(text, "word.json"); }), {"NaN and infinity"}));
}

TEST_CASE("a key with its colon does not lack one", "[mutants][json]") {
  const auto said = [](const char* text) { return message_of<SceneError>([&] { read_json(text, "colon.json"); }); };
  CHECK(says(said("{\"a\" 1}"), {"a colon is missing"}));
  CHECK(!says(said("{\"a\": }"), {"a colon is missing"}));
}

TEST_CASE("a method's key may be an empty text", "[mutants][methods]") {
  const std::vector<TypeInfo> types = {{"mine", "", {{"label", Form::text, Unit::none, "x", "a text"}}}};
  const MethodSpec method = read_method_spec("mine:label=\"\"", types);
  REQUIRE(method.keys.find("label") != nullptr);
  CHECK(*method.keys.find("label")->text() == "");
}

// -- tools

namespace {

// n bodies without links and forces.
void add_free(System& system, int n) {
  for (int k = 0; k < n; ++k)
    system.add_body("body_" + std::to_string(k), shapes::sphere(1.0, 0.1), {Vec3(k, 0, 0), {}});
}

}  // namespace

TEST_CASE("without loads the lowest modes are zero", "[mutants][modes]") {
  System system;
  add_free(system, 3);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  const Modes modes = find_modes(dynamics, system.start(), {.count = 4, .dense_limit = 0});
  CHECK(modes.modes.size() >= 4);
  for (const Mode& mode : modes.modes) CHECK(mode.kind == Mode::Kind::rigid);
}

TEST_CASE("a motion names the four bodies that move most", "[mutants][words]") {
  for (const int n : {4, 5, 7}) {
    System system;
    add_free(system, n);
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    const State state = system.start();
    const Inputs& in = dynamics.gather(state).inputs();
    VecX motion = VecX::Zero(6 * n);
    for (int k = 0; k < n; ++k) motion[6 * k] = n - k;
    const std::string words = motion_words(system, in, motion);
    CAPTURE(words);
    CHECK(says(words, {"'body_0'", "'body_3'"}));
    CHECK(!says(words, {"'body_4'"}));
    CHECK(says(words, {"more bod"}) == (n > 4));
    if (n == 5) CHECK(says(words, {" and 1 more body with them"}));
    if (n == 7) CHECK(says(words, {" and 3 more bodies with them"}));
  }
}

TEST_CASE("linear equations have a note on each one-sided joint, and on no other", "[mutants][linearize]") {
  const auto notes_of = [](const std::string& scene) {
    std::string file = paths::kScenes;
    Simulation run(read_mechanism(file.append("/").append(scene).append(".json")));
    std::string all;
    LinearMotionOptions options;
    options.frozen = true;
    for (const Finding& note : linear_motion(run.dynamics(), run.state(), options).notes) all += note.text() + "\n";
    return all;
  };
  CHECK(says(notes_of("bouncing_pendulum"), {"one-sided joint 'hinge", "is open and left out"}));
  CHECK(!says(notes_of("pendulum"), {"one-sided"}));
}

TEST_CASE("linear equations have a note on friction, and on no other force", "[mutants][linearize]") {
  Simulation run(made(R"~("gravity": [0, -9.81, 0], "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "rail", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x",
               "friction": {"mu": 0.3}}],
    "forces": [{"name": "push", "type": "applied_force", "p": "b", "at": [0, 0, 0], "force": [0, 1, 0]}])~"));
  const std::vector<std::string> notes = texts_of(linear_motion(run.dynamics(), run.state()).notes);
  CHECK(notes ==
        std::vector<std::string>{"friction of 'rail.friction' at rest acts as a damper (mu N/smoothing_speed); "
                                 "set its mu to 0 for modes without friction"});
}

}  // namespace random_slips_test
