// SPDX-License-Identifier: BSD-3-Clause
// What slips that were planted in the sources once got past: each test fails with one of tests/mutants/*.patch.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/passes.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include <lockstep/sweep.h>
#include "framework/mechanism/params/units.h"
#include "framework/tools/precision/history.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace planted_test {

using namespace lockstep;
using lockstep::testing::message_of, lockstep::testing::says;

namespace {

const Registry& registry() {
  static const Registry all = builtin_registry();
  return all;
}

Mechanism made(const std::string& members) {
  return build_mechanism(scene_from_text("{\"lockstep\": 1, " + members + "}", "planted.json"), registry());
}

Dynamics dynamics_of(Mechanism& m) {
  return Dynamics(system_of(m), make_solver(m.run, registry()), {m.run.formulation, m.run.stabilization});
}

// The scene from its assembled start to its end.
Table run(const std::string& members) {
  Mechanism m = made(members);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  Dynamics dynamics = dynamics_of(m);
  State start = m.system.start();
  assemble(dynamics, start, m.start_speeds);
  StepLoop loop(dynamics, make_integrator(m.run, registry()),
                {.step = m.run.step, .tolerance = m.run.tolerance, .output = m.run.output});
  loop.set_state(start);
  loop.add_observer(*recorder);
  loop.run_until(m.run.until);
  return recorder->table();
}

bool has(const std::vector<double>& instants, double t) {
  return std::any_of(instants.begin(), instants.end(), [t](double x) { return std::abs(x - t) < 1e-12; });
}

const std::string kArm = R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}], )";
// Rises from t = 0.3 s to t = 0.7 s.
const std::string kRise = R"({"type": "harmonic_rise", "rise": 0.1, "t0": 0.3, "duration": 0.4})";

}  // namespace

TEST_CASE("a rope bounces at its end as a floor does, with the restitution's share", "[mutants]") {
  const auto bob = [](const std::string& link, const std::string& z) {
    return run(R"("gravity": [0, 0, -10], "bodies": [{"name": "bob", "particle": 1, "position": [0, 0, )" + z + R"(]}],
      "links": [)" +
               link + R"(], "run": {"until": 0.4, "output": 0.4, "record": ["bob.vz", "bob.z"]})");
  };
  // 0.5 m down: at t = sqrt(0.1) s with sqrt(10) m/s, of which half comes back.
  const double hit = std::sqrt(0.1), v = 0.5 * std::sqrt(10.0) - 10 * (0.4 - hit);
  const Table rope = bob(
      R"({"name": "rope", "type": "distance", "p": "bob", "s": "ground", "at_p": [0,0,-0.5], "at_s": [0,0,0], "length": 1,
    "unilateral": {"restitution": 0.5, "side": "below"}})",
      "-0.5");
  CHECK(rope.last("bob.vz") == Approx(v).epsilon(1e-6));
  const Table floor =
      bob(R"({"name": "floor", "type": "point_on_plane", "p": "bob", "s": "ground", "at_p": [0,0,0.5], "at_s": [0,0,0],
    "unilateral": {"restitution": 0.5}})",
          "0.5");
  CHECK(floor.last("bob.vz") == Approx(v).epsilon(1e-6));
  CHECK(floor.last("bob.z") == Approx(rope.last("bob.z") + 1).epsilon(1e-6));
}

TEST_CASE("each row of a lock that contradicts another is found, the last one too", "[mutants]") {
  // Two locks of one mask, of which the second moves its last row away.
  struct Row {
    const char *mask, *law;
  };
  const std::string push = R"({"type": "polynomial", "coefficients": [0, 0, 2]})";
  const auto move = [&](const std::string& axis) {
    return R"("move": {"type": "along", "axis": )" + axis + R"(, "law": )" + push + "}";
  };
  const auto turn = [&](const std::string& axis) {
    return R"("turn": {"type": "axis_rotation", "axis": )" + axis + R"(, "law": )" + push + "}";
  };
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"x y", move("[0,1,0]")},        {"x y", move("[1,0,0]")},       {"x z", move("[0,0,1]")},
      {"x y z", move("[0,0,1]")},      {"x y e1 e2", turn("[0,1,0]")}, {"x y z e3", turn("[0,0,1]")},
      {"x e1 e2 e3", turn("[0,0,1]")}, {"y z e1 e3", turn("[0,0,1]")}, {"e1 e2", turn("[0,1,0]")},
      {"x y z e1 e2", turn("[0,1,0]")}};
  for (const std::string solver : {"schur", "block", "sparse", "dense"})
    for (const auto& [mask, law] : rows) {
      const std::string lock = R"("type": "lock", "mask": ")" + mask + R"(", "p": "arm", "s": "ground", "at": [0,0,0])";
      Mechanism m = made(kArm + R"("links": [{"name": "still", )" + lock + R"(}, {"name": "moved", )" + lock + ", " +
                         law + R"(}], "run": {"until": 1, "solver": ")" + solver + "\"}");
      Dynamics dynamics = dynamics_of(m);
      INFO(solver << ", " << mask << ", " << law);
      const std::string refusal = message_of<SolveError>([&] { dynamics.evaluate(m.system.start()); });
      CHECK((says(refusal, {"'still'"}) || says(refusal, {"'moved'"})));
    }
}

TEST_CASE("the jumps of all laws are requested: of markers, rotations, offsets and of forces' markers", "[mutants]") {
  const std::string translation = R"({"type": "along", "axis": [1,0,0], "law": )" + kRise + "}";
  const std::string moved =
      R"("markers": [{"name": "M", "body": "ground", "at": [0,0,0], "translation": )" + translation + R"(},
    {"name": "N", "body": "arm", "at": [0,0,0]}, {"name": "Z", "body": "ground", "at": [1,2,3]}], )";
  const std::vector<std::pair<const char*, std::string>> scenes = {
      {"marker S of a link", moved + R"("links": [{"name": "A", "type": "point_on_plane", "p": "N", "s": "M"}])"},
      {"marker P of a link", moved + R"("links": [{"name": "A", "type": "point_on_plane", "p": "M", "s": "N"}])"},
      {"turn of a link", R"("links": [{"name": "A", "type": "fixed", "p": "arm", "s": "ground", "at": [0,0,0],
         "turn": {"type": "axis_rotation", "axis": [0,0,1], "law": )" +
                             kRise + "}}]"},
      {"move of a link",
       R"("links": [{"name": "A", "type": "spherical", "p": "arm", "s": "ground", "at": [0,0,0], "move": )" +
           translation + "}]"},
      {"offset of a screw",
       R"("links": [{"name": "A", "type": "screw", "lead": 0.01, "p": "arm", "s": "ground", "at": [0, 0, 0], "offset": )" +
           kRise + "}]"},
      {"drive",
       R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", "law": )" +
           kRise + "}}]"},
      {"marker S of a force",
       moved + R"("forces": [{"name": "F", "type": "spring_damper", "p": "N", "s": "M", "stiffness": 1}])"},
      {"marker P of a force",
       moved + R"("forces": [{"name": "F", "type": "spring_damper", "p": "M", "s": "N", "stiffness": 1}])"},
      {"law of a force", R"("forces": [{"name": "F", "type": "applied_force", "p": "arm", "at": [0,0,0], "law": )" +
                             kRise + R"(, "direction": "x"}])"},
  };
  for (const auto& [what, scene] : scenes) {
    INFO(what);
    const Mechanism m = made(kArm + scene);
    const std::vector<double> instants = passes::breakpoints(m.system, 0, 1);
    CHECK(has(instants, 0.3));
    CHECK(has(instants, 0.7));
  }
}

TEST_CASE("axes given with a marker are those of the other one", "[mutants]") {
  const Mechanism m = made(
      kArm + R"("markers": [{"name": "M", "body": "arm", "at": [0,0,0], "orientation": {"y": [0,0,1], "x": [1,0,0]}}],
    "links": [{"name": "A", "type": "cylindrical", "p": "M", "s": "ground", "at_s": [0,0,0], "orientation": {"z": [0,1,0], "x": [1,0,0]}}])");
  const Vec3 z = rotation(m.system.marker("A.S").local.q).col(2);
  CHECK((z - Vec3(0, 1, 0)).norm() < 1e-12);
}

TEST_CASE("a NaN anywhere in a history is its error", "[mutants]") {
  History sound;
  for (int i = 0; i < 3; ++i) {
    VecX q = VecX::Zero(7);
    q[3] = 1;
    sound.push_back({1.0 * i, 1, 1, q, VecX::Zero(6), VecX::Zero(6)});
  }
  CHECK(difference(sound, sound, 1).position == 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < 3; ++i) {
    INFO("row " << i);
    const auto spoiled = [&](auto&& spoil) {
      History h = sound;
      spoil(h);
      return h;
    };
    const History place = spoiled([&](History&h) { h[i].poses[0] = nan; }),
                  turn = spoiled([&](History&h) { h[i].poses[4] = nan; });
    const History speed = spoiled([&](History&h) { h[i].v[1] = nan; }),
                  rate = spoiled([&](History&h) { h[i].v[4] = nan; });
    const History force = spoiled([&](History&h) { h[i].load[2] = nan; }),
                  moment = spoiled([&](History&h) { h[i].load[5] = nan; });
    const History energy = spoiled([&](History& h) { h[i].energy = nan; });
    for (const History* h : {&place, &turn}) CHECK(std::isinf(difference(sound, *h, 1).position));
    for (const History* h : {&speed, &rate}) CHECK(std::isinf(difference(sound, *h, 1).velocity));
    for (const History* h : {&force, &moment}) CHECK(std::isinf(difference(sound, *h, 1).reaction));
    CHECK(std::isinf(difference(sound, energy, 1).energy));
  }
}

TEST_CASE("both letters for micro are a millionth", "[mutants]") {
  for (const char* prefix : {"u", "\u00b5", "\u03bc"}) {
    const Measured m = in_si(3, std::string(prefix) + "m");
    INFO(prefix << ": " << m.problem);
    CHECK(m.problem.empty());
    CHECK(m.value == Approx(3e-6).epsilon(1e-15));
  }
}

TEST_CASE("off the constraints an imposed rotation is as far off in the plane as in space", "[mutants]") {
  for (const char* mask : {"e3", "x e3", "x y e3"})
    for (const double off : {-0.4, 0.05, 0.9}) {
      double violation[2], angle[2];
      for (const bool plane : {false, true}) {
        Mechanism m =
            made(std::string(R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
          "links": [{"name": "A", "type": "lock", "mask": ")") +
                 (plane ? mask : std::string(mask) + " z e1 e2") + R"(", "p": "arm", "s": "ground", "at": [0,0,0],
            "turn": {"type": "axis_rotation", "axis": [0,0,1], "law": 0.3}}], "planar": ")" +
                 (plane ? "z" : "off") + "\"");
        Dynamics dynamics = dynamics_of(m);
        State s = m.system.start();
        StateEditor editor(s);
        const Body& arm = m.system.body("arm");
        editor.set_pose(arm, {editor.pose(arm).x, exponential(Vec3(0, 0, off))});
        violation[plane] = dynamics.violation(s);
        assemble(dynamics, s);
        const Quat q = editor.pose(arm).q;
        angle[plane] = 2 * std::atan2(q.z, q.w);
      }
      INFO(mask << ", " << off);
      CHECK(violation[1] == Approx(violation[0]).epsilon(1e-12));
      CHECK(angle[1] == Approx(0.3).epsilon(1e-9));
      CHECK(angle[0] == Approx(0.3).epsilon(1e-9));
    }
}

TEST_CASE("a condition that is zero at first is met when it comes back to zero, not before", "[mutants]") {
  for (const double up : {5.0, -5.0}) {  // from z = 0, and back there after 1 s
    System system(System::Options{{0, 0, up > 0 ? -10.0 : 10.0}});
    system.add_particle("stone", 1, {0, 0, 0});
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop run(dynamics, std::make_unique<Dopri5>(), {.output = 0.05});
    std::vector<double> met;
    run.add_event({.name = "level",
                   .value = [](const Sample& s) { return s.state.q[2]; },
                   .change = [&](State& s) { met.push_back(s.t); }});
    State start = run.state();
    start.v[2] = up;
    run.set_state(start);
    run.run_until(1.5);
    INFO(up << " m/s, met " << met.size() << " times");
    REQUIRE(met.size() == 1);
    CHECK(met[0] == Approx(1.0).epsilon(1e-9));
  }
}

TEST_CASE("a Fourier series by its frequency is the one by its circular frequency", "[mutants]") {
  const auto turned = [](const std::string& key, const std::string& value) {
    return run(kArm + R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0],
      "drive": {"axis": "rz", "law": {"type": "fourier", ")" +
               key + "\": " + value + R"(, "sines": [0.1, 0.05]}}}],
      "run": {"until": 0.5, "output": 0.5, "record": ["A.rz", "A.rz_d"]})");
  };
  const Table cycles = turned("frequency", "0.5"), circular = turned("omega", std::to_string(kPi));
  CHECK(cycles.last("A.rz") == Approx(0.1).epsilon(1e-9));           // sin(pi/2), sin(pi)
  CHECK(cycles.last("A.rz_d") == Approx(-0.1 * kPi).epsilon(1e-6));  // 2 pi 0.05 cos(pi)
  CHECK(circular.last("A.rz") == Approx(cycles.last("A.rz")).epsilon(1e-5));
}

TEST_CASE("an angular velocity in world axes is transformed to body axes", "[mutants]") {
  const Mechanism m = made(R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "omega_world": [1, 2, 3],
    "orientation": {"axis": "z", "angle": "90 deg"}}])");
  CHECK((m.system.body("a").start.w - Vec3(2, -1, 3)).norm() < 1e-12);
}

TEST_CASE("a negative index of a repeated part is one number in its formulas", "[mutants]") {
  const Mechanism m = made(R"("repeat": [{"times": 3, "from": -2, "index": "i",
    "bodies": [{"name": "b{i+3}", "particle": 1, "position": ["=i^2", "=2 - i", "=3*i"]}]}])");
  for (int i = -2; i <= 0; ++i) {
    const Vec3 x = m.system.body("b" + std::to_string(i + 3)).home.x;
    CHECK((x - Vec3(i * i, 2 - i, 3 * i)).norm() < 1e-12);
  }
}

TEST_CASE("names switched by an event of an included scene have the prefix", "[mutants]") {
  const std::string folder = std::string(paths::kBuild) + "/output/planted";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/part.json") << R"({"lockstep": 1, "bodies": [{"name": "b", "particle": 1}],
    "links": [{"name": "L", "type": "spherical", "p": "b", "s": "ground", "at": [0,0,0]},
              {"name": "M", "type": "point_on_plane", "p": "b", "s": "ground", "at": [0,0,0], "active": false}],
    "events": [{"name": "e", "at": 1, "deactivate": ["L"], "activate": ["M"]}]})";
  const Scene scene = scene_from_text(R"({"lockstep": 1, "include": [{"scene": "part.json", "prefix": "left_"}]})",
                                      folder + "/whole.json");
  const Mechanism m = build_mechanism(scene, registry());
  REQUIRE(m.events.size() == 1);
  CHECK(m.events[0].event.deactivate == std::vector<std::string>{"left_L"});
  CHECK(m.events[0].event.activate == std::vector<std::string>{"left_M"});
}

}  // namespace planted_test
