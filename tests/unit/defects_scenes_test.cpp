// SPDX-License-Identifier: BSD-3-Clause
// Scenes that once showed a defect, each as it was, under its name; and what hosts in C++ get of the same.
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/simulation.h>
#include <lockstep/sweep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace defects_scenes_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of, lockstep::testing::says;

namespace {

struct Ran {
  Table table;
  State end;
  std::vector<EventCourse> events;
};

/// Runs a scene as the program does, to `until` or its own end.
Ran run_text(const std::string& text, const std::string& integrator = "dopri5", double step = 0) {
  const Registry registry = builtin_registry();
  Scene scene = scene_from_text(text, "scene.json");
  scene.run.integrator.type = integrator, scene.run.step = step, scene.run.tolerance = {1e-10, 1e-12};
  Mechanism m = build_mechanism(scene, registry);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  Dynamics dynamics = make_dynamics(m, registry);
  StepLoop loop(dynamics, make_integrator(m.run, registry),
                {.step = step, .tolerance = m.run.tolerance, .output = m.run.output, .max_steps = 5000});
  loop.add_observer(*recorder);
  for (Event& event : events) loop.add_event(std::move(event));
  loop.set_state(assembled_start(dynamics, m));
  loop.run_until(m.run.until);
  return {recorder->table(), loop.state(), loop.event_courses()};
}

std::size_t row_at(const Table& table, double t) {
  const std::vector<double>& times = table["t"];
  return static_cast<std::size_t>(std::ranges::find_if(times, [&](double x) { return x > t - 1e-9; }) - times.begin());
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

}  // namespace

// law_jump
TEST_CASE("a law that jumps in position is reported with existing types of laws", "[unit][scene]") {
  const std::string message = message_of<AssemblyError>([] {
    run_text(R"({"lockstep": 1, "bodies": [{"name": "b", "particle": 1}],
      "links": [{"name": "S", "type": "lock", "mask": "y z", "p": "b", "s": "ground", "at": [0, 0, 0],
                 "drive": {"axis": "x", "law": {"type": "formula", "y": "=t < 0.1 ? 0 : 0.02"}}}],
      "run": {"until": 0.2}})");
  });
  const std::string before = "use a continuous law (";
  const std::size_t found = message.find(before), begin = found + before.size();
  REQUIRE(found != std::string::npos);
  std::istringstream types(message.substr(begin, message.find(')', begin) - begin));
  const Registry registry = builtin_registry();
  int n = 0;
  for (std::string type; std::getline(types >> std::ws, type, ','); ++n) {
    INFO(type);
    CHECK(registry.laws.find(type) != nullptr);
  }
  CHECK(n >= 2);
}

// unit_slip
TEST_CASE("a parameter that lacks its unit is named, with the unit that would do", "[unit][scene]") {
  const auto refusal = [](const std::string& parameters, const std::string& x) {
    return message_of<SceneError>([&] {
      build_mechanism(
          scene_from_text(R"({"lockstep": 1, "parameters": {)" + parameters +
                              R"(}, "bodies": [{"name": "b", "particle": 1, "position": [")" + x + R"(", 0, 0]}]})",
                          "slip.json"),
          builtin_registry());
    });
  };
  check_words(refusal(R"("a": 0.45, "tilt": "20 deg")", "=a*cos(tilt)"),
              {"slip.json:1:", "is a pure number", "a length is expected", "a = 0.45 has no unit: \"0.45 m\"?"});
  // Of two, that which its unit mends; what has a unit is not named.
  const std::string two = refusal(R"("v": "2 m/s", "k": 3, "b": "1 kg")", "=k*v");
  check_words(two, {"is a speed", "a length is expected", "k = 3 has no unit: \"3 s\"?"});
  CHECK_FALSE(says(two, {"v ="}));
  // Twice the same factor: no unit of it alone is meant.
  const std::string square = refusal(R"("a": 2, "tilt": "20 deg")", "=a*a*cos(tilt)");
  check_words(square, {"a = 2 has no unit"});
  CHECK_FALSE(says(square, {"\"?"}));
}

// event_never
TEST_CASE("how near an event came is there as data", "[unit][events]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  Simulation run(system, {.tolerance = 1e-10});
  const double depth = 0.75;  // the centre falls to -0.5 m and no further
  run.add_event({.name = "deep", .value = [&](const Sample& s) { return s.inputs().slot(rod.slot).x[1] + depth; }});
  run.add_event({.name = "half", .value = [&](const Sample& s) { return s.inputs().slot(rod.slot).x[1] + 0.25; }});
  run.add_event({.name = "late", .at = 9, .stop = true});
  CHECK(run.loop().event_courses().size() == 3);
  run.run_until(0.8);
  const std::vector<EventCourse> courses = run.loop().event_courses();
  REQUIRE(courses.size() == 3);
  CHECK(courses[0].name == "deep");
  CHECK(courses[0].last < 0);
  // Level to hanging: K(sin(pi/4)) / omega_0, omega_0^2 = 3 g / (2 L); there y = -L/2, and no less anywhere.
  const double lowest = 1.85407467730137 / std::sqrt(1.5 * 9.81);
  CHECK(courses[0].nearest == Approx(depth - 0.5).margin(2e-3));
  CHECK(courses[0].nearest >= depth - 0.5 - 1e-9);
  CHECK(courses[0].at == Approx(lowest).margin(0.02));
  // sin(angle) = -1/2 is passed on the way down, at an instant of its own.
  CHECK(courses[1].last > 0.2);
  CHECK(courses[1].last < lowest);
  CHECK(courses[2].last < 0);
  CHECK(std::isnan(courses[2].nearest));
}

TEST_CASE("a tolerance below rounding is rejected in C++, of a simulation and of a loop", "[unit][simulation]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  const auto simulation = [&](double tolerance, double absolute = 0) {
    return message_of<ModelError>(
        [&] { Simulation run(system, {.tolerance = tolerance, .absolute_tolerance = absolute}); });
  };
  check_words(simulation(1e-20), {"1e-20 is below the round-off", "take 1e-13 or more"});
  CHECK(simulation(std::numeric_limits<double>::epsilon()) == "no error");
  check_words(simulation(1e-8, -1), {"absolute tolerance is -1"});
  Dynamics dynamics(system, make_solver(MethodSpec{"schur"}, builtin_registry(), "solver"));
  const auto loop = [&](Tolerance tolerance) {
    return message_of<ModelError>([&] { StepLoop(dynamics, std::make_unique<Dopri5>(), {.tolerance = tolerance}); });
  };
  check_words(loop({1e-20, 1e-22}), {"1e-20 is below the round-off"});
  CHECK(loop({0, 1e-12}) == "no error");
}

// latch
TEST_CASE("a quantity that is a moment in other words is suggested as the torque", "[unit][scene]") {
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  check_words(message_of<ModelError>([&] { make_channel(system, "A.moment_on_p_world_z"); }),
              {"did you mean \"torque_on_p_world_z\"?"});
  CHECK_NOTHROW(make_channel(system, "A.rz"));
}

namespace {

/// A rod that falls about its end, braked by `link` from 0.3 s to 0.6 s and again from 0.8 s on.
std::string braked(const std::string& link, const std::string& more) {
  return R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]},
              {"name": "brake", "type": "lock", )" +
         link + R"(, "p": "rod", "s": "ground", "at": [0, 0, 0], "active": false, "hold": true}],
    "events": [{"name": "stop", "at": 0.3, "activate": ["brake"]}, {"name": "go", "at": 0.6, "deactivate": ["brake"]},
               {"name": "stop again", "at": 0.8, "activate": ["brake"]}],
    "run": {"until": 1, "output": 0.05, "record": ["rod.angle_z", "brake.torque_on_p_world_z", "energy.kinetic"])" +
         more + "}}";
}

}  // namespace

// Held at an angle the brake carries the weight's moment, m g (L/2) cos(angle), at once and each time it closes.
TEST_CASE("a brake that holds closes where its rod stands, as often as it closes", "[unit][events]") {
  const std::string more =
      GENERATE(std::string(), std::string(R"(, "formulation": "omega")"),
               std::string(R"(, "formulation": "quaternion")"), std::string(R"(, "formulation": "joint")"));
  const std::string method = GENERATE(std::string("dopri5"), std::string("rk4"), std::string("radau5"));
  CAPTURE(more, method);
  if (method == "radau5" && more.find("joint") != std::string::npos) return;  // it takes no joint coordinates
  const Ran ran = run_text(braked(R"("mask": "e3")", more), method, method == "rk4" ? 1e-3 : 0);
  const Table& t = ran.table;
  const std::vector<double>&angle = t["rod.angle_z"], &torque = t["brake.torque_on_p_world_z"],
        &kinetic = t["energy.kinetic"];
  const auto held = [&](double from, double to) {
    const std::size_t first = row_at(t, from);
    for (std::size_t k = row_at(t, from) + 1; k <= row_at(t, to); ++k) {
      CAPTURE(t["t"][k]);
      CHECK(angle[k] == Approx(angle[first]).margin(1e-9));
      CHECK(kinetic[k] < 1e-15);
      CHECK(torque[k] == Approx(9.81 * 0.5 * std::cos(angle[first])).epsilon(1e-8));
    }
  };
  held(0.3, 0.55);
  held(0.8, 1.0);
  CHECK(angle[row_at(t, 0.3)] < -0.3);
  CHECK(angle[row_at(t, 0.8)] < angle[row_at(t, 0.3)] - 0.2);
  // From rest at the first angle it falls as one that is released there: energy between 0.6 s and 0.8 s.
  const std::size_t go = row_at(t, 0.6), before = row_at(t, 0.75);
  CHECK(kinetic[before] == Approx(9.81 * 0.5 * (std::sin(angle[go]) - std::sin(angle[before]))).epsilon(1e-6));
}

TEST_CASE("a lock that holds all its coordinates catches a body in flight, and momentum is conserved",
          "[unit][events]") {
  const char* planar = GENERATE("off", "auto");
  CAPTURE(planar);
  // Two free bodies that fly past each other become one: momentum of both is that of the pair, and their poses against
  // one another stay what they were at closing.
  const Ran ran = run_text(std::string(R"({"lockstep": 1, "planar": ")") + planar + R"(",
    "bodies": [{"name": "a", "box": {"mass": 1, "size": [0.2, 0.1, 0.1]}, "velocity": [1, 0, 0], "omega_world": [0, 0, 2]},
               {"name": "b", "box": {"mass": 3, "size": [0.1, 0.2, 0.1]}, "position": [0.5, 0.4, 0],
                "orientation": {"axis": "z", "angle": "30 deg"}, "velocity": [-0.2, 0.1, 0]}],
    "links": [{"name": "catch", "type": "lock", "mask": "x y z e1 e2 e3", "p": "a", "s": "b", "at": [0, 0, 0],
               "active": false, "hold": true}],
    "events": [{"name": "touch", "at": 0.25, "activate": ["catch"]}],
    "run": {"until": 1, "output": 0.25, "record": ["a.x@b", "a.y@b", "a.qw@b", "momentum.x", "momentum.y",
            "angular_momentum.z", "a.vx", "b.vx", "catch.x"]}})");
  const Table& t = ran.table;
  REQUIRE(t.n_rows() == 5);
  for (const char* still : {"a.x@b", "a.y@b", "a.qw@b"})
    for (std::size_t k = 2; k < 5; ++k) CHECK(t[still][k] == Approx(t[still][1]).margin(1e-9));
  CHECK(std::abs(t["a.x@b"][1]) > 0.05);
  for (const char* kept : {"momentum.x", "momentum.y", "angular_momentum.z"})
    for (std::size_t k = 1; k < 5; ++k) CHECK(t[kept][k] == Approx(t[kept][0]).margin(1e-9));
}

TEST_CASE("a run that was saved while a joint holds continues to the last bit", "[unit][events]") {
  const auto make = [](System& system) {
    Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
    GenericLock& brake = system.add<GenericLock>("brake", rod, system.ground(), pose_at({0, 0, 0}), Mask::e3);
    brake.hold();
    brake.set_active_at_start(false);
  };
  const auto prepare = [](StepLoop& loop) {
    loop.add_event({.name = "stop", .at = 0.3, .activate = {"brake"}});
    loop.add_event({.name = "go", .at = 0.6, .deactivate = {"brake"}});
  };
  const System::Options gravity{.gravity = {0, -9.81, 0}};
  System one(gravity), other(gravity);
  make(one), make(other);
  Dynamics d1(one, make_solver(MethodSpec{"schur"}, builtin_registry(), "solver")),
      d2(other, make_solver(MethodSpec{"schur"}, builtin_registry(), "solver"));
  const StepLoopOptions options{.tolerance = {1e-8, 1e-10}, .max_steps = 2000};
  StepLoop first(d1, std::make_unique<Dopri5>(), options), second(d2, std::make_unique<Dopri5>(), options);
  prepare(first), prepare(second);
  first.run_until(0.45);
  Snapshot kept;
  first.save(kept);
  first.run_until(1);
  second.load(kept);
  second.run_until(1);
  CHECK(first.state().q == second.state().q);
  CHECK(first.state().v == second.state().v);
  CHECK(first.state().s == second.state().s);
  CHECK(first.state().v.cwiseAbs().maxCoeff() > 1);
}

TEST_CASE("a joint that holds and has a law, or nothing to hold, is rejected", "[unit][scene]") {
  const auto refusal = [](const std::string& link) {
    return message_of<SceneError>([&] {
      build_mechanism(
          scene_from_text(
              R"({"lockstep": 1, "bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
            "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0]}, )" +
                  link + "]}",
              "hold.json"),
          builtin_registry());
    });
  };
  check_words(refusal(R"({"name": "L", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "hold": true,
                         "drive": {"axis": "z", "law": 0}})"),
              {"hold.json:", "'L'", "\"hold\" excludes laws and one-sided joints", "remove one of the two"});
  check_words(
      refusal(R"({"name": "L", "type": "distance", "p": "b", "s": "ground", "at_p": [1, 0, 0], "at_s": [2, 0, 0],
                         "hold": true})"),
      {"hold.json:", "its mask is empty"});
}

// errors_in_rounds
TEST_CASE("all errors of a scene are reported in one round", "[unit][scene]") {
  const std::string message = message_of<SceneError>([] {
    build_observed(scene_from_text(R"({ "lockstep": 1, "gravity": [0,-9.81,0],
  "bodies": [ {"name":"r","rod":{"mass":-1,"from":[0,0,0],"to":[1,0,0]}}, {"name":"r","mass":1,"inertia":[1,1,3]}, {"name":"","mass":1}, {"name":"ground","mass":1,"inertia":[1,1,1]} ],
  "links":[{"name":"A","type":"revolut","p":"r","s":"ground","at":[0,0,0],"driv":{"axis":"rz"}},
           {"name":"B","type":"revolute","p":"rr","s":"ground","at":"Q"},
           {"name":"C","type":"lock","mask":"x y q","p":"r","s":"r","at":[0,0,0]}],
  "forces":[{"name":"F","type":"spring","k":"3 kg"}],
  "run":{"until":2,"output":0.1,"integrator":"rk5","record":["r.anglez","rr.x","qq.x","energy.totl"]}})",
                                   "rounds.json"),
                   builtin_registry());
  });
  INFO(message);
  const std::vector<std::vector<std::string>> wanted = {
      {":2:", "body 'r'", "the mass is -1"},
      {":2:", "already taken by body 'r'"},
      {":2:", "body 'r'", "inertia"},
      {":2:", "the name is empty"},
      {":2:", "needs an inertia"},
      {":2:", "\"ground\" is reserved"},
      {":3:", "joint 'A'", "\"revolut\"", "did you mean \"revolute\"?"},
      {":3:", "joint 'A'", "unknown key \"driv\"", "did you mean \"drive\"?"},
      {":4:", "joint 'B', p", "\"rr\"", "did you mean \"r\"?"},
      {":4:", "joint 'B', at", "\"Q\""},
      {":5:", "joint 'C', s", "both sides are on body 'r'"},
      {":5:", "joint 'C', mask", "q"},
      {":6:", "force 'F'", "\"spring\"", "did you mean \"spring_damper\"?"},
      {":6:", "force 'F'", "unknown key \"k\"", "did you mean \"stiffness\"?"},
      {":7:", "run.integrator", "did you mean \"rk4\"?"},
      {":7:", "r.anglez", "did you mean \"angle_z\"?"},
      {":7:", "rr.x", "did you mean \"r\"?"},  // qq may be one of the bodies with a wrong name
      {":7:", "energy.totl", "did you mean \"energy.total\"?"}};
  const std::vector<std::string> lines = lines_of(message);
  for (const std::vector<std::string>& words : wanted) {
    CAPTURE(words);
    CHECK(std::ranges::count_if(lines, [&](const std::string& line) {
            return std::ranges::all_of(words, [&](const std::string& w) { return line.find(w) != std::string::npos; });
          }) == 1);
  }
  CHECK(lines.size() == wanted.size());
}

TEST_CASE("a consequence of another error is not reported with it", "[unit][scene]") {
  // Of what names the bodies that fail, the geometry, and channels of a link that fails.
  const std::string message = message_of<SceneError>([] {
    build_observed(scene_from_text(R"({"lockstep": 1,
  "bodies": [{"name": "disc", "cylinder": {"mass": 0, "radius": 1, "length": 1}, "position": [1, 0, 0]},
             {"name": "bead", "particle": "1 m"}],
  "links": [{"name": "A", "type": "spherical", "p": "bead", "s": "ground"},
            {"name": "B", "type": "revolute", "p": "disc", "s": "ground", "at": [0, 0, 0], "axs": "z"}],
  "events": [{"name": "e", "when": {"channel": "B.rz"}, "stop": true}],
  "run": {"until": 1, "record": ["A.x", "B.rz", "disc.angle_z", "bead.x", "B.x@ground"]}})",
                                   "follow.json"),
                   builtin_registry());
  });
  const std::vector<std::string> lines = lines_of(message);
  INFO(message);
  REQUIRE(lines.size() == 3);
  check_words(lines[0], {"body 'disc'", "mass is 0"});
  check_words(lines[1], {"body 'bead'", "a mass is expected"});
  check_words(lines[2], {"joint 'B'", "\"axs\""});
}

}  // namespace defects_scenes_test
