// SPDX-License-Identifier: BSD-3-Clause
// One-sided links, stops and friction as scenes say them.
#include <lockstep/joints.h>

#include <lockstep/author/registry.h>
#include <lockstep/detail/phi_function.h>
#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "framework/mechanism/links/joint_functions.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace stops_test {

using namespace lockstep;
using lockstep::testing::check_words;

namespace {

/// A scene of one arm on a hinge along the axis, with more keys on the link and more after the links.
std::string arm(const std::string& on_link, const std::string& more = "", const std::string& axis = "z",
                const std::string& type = "revolute") {
  return R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "mass": 1, "inertia": [0.1, 0.1, 0.1], "center": [0.5, 0, 0]}],
    "links": [{"name": "A", "type": ")" +
         type + R"(", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": ")" + axis + "\"" +
         (on_link.empty() ? "" : ", " + on_link) + "}]" + (more.empty() ? "" : ", " + more) + "}";
}

Mechanism made(const std::string& text) {
  return build_mechanism(scene_from_text(text, "arm.json"), builtin_registry());
}

std::string refusal(const std::string& text) {
  return testing::message_of<SceneError>([&] { (void)made(text); });
}

}  // namespace

TEST_CASE("scene: stops of every coordinate are separate joints", "[unit][scene]") {
  const Mechanism m = made(arm(R"("stops": [{"axis": "rz", "low": "-60 deg", "high": 1, "restitution": 0.8},
                                            {"axis": "x", "high": "20 mm"}, {"axis": "rx", "low": -0.5},
                                            {"axis": "ry", "low": -0.5}])",
                               "", "z", "point_on_plane"));
  const auto stop = [&](const char* name) -> const Lock& { return m.system.link(name); };
  for (const char* name : {"A.stop_rz_low", "A.stop_rz_high", "A.stop_x_high", "A.stop_rx_low", "A.stop_ry_low"}) {
    CAPTURE(name);
    CHECK(stop(name).type() == "stop");
    CHECK(stop(name).row_count() == 1);
    CHECK(stop(name).unilateral() != nullptr);
  }
  CHECK(stop("A.stop_rz_low").unilateral()->restitution == 0.8);
  CHECK(stop("A.stop_x_high").unilateral()->restitution == 0);
  CHECK(phi_of<StopAbout>(static_cast<const TurnStop&>(stop("A.stop_rz_low")).function()).limit == Approx(-kPi / 3));
  const State start = m.system.start();
  CHECK(start.modes[0]);
  CHECK_FALSE(start.modes[1]);  // out of force until it is touched
}

// A stop about x (or y) of a link counts the turn about that axis: the arm comes to the same angle whichever axis of
// the link the hinge has.
TEST_CASE("scene: a stop about x, y or z stops the same swing at the same angle", "[unit][scene]") {
  for (const std::string axis : {"rx", "ry", "rz"}) {
    CAPTURE(axis);
    const std::string mask = axis == "rx" ? "x y z e2 e3" : axis == "ry" ? "x y z e1 e3" : "x y z e1 e2";
    const std::string frame = axis == "rx"   ? R"({"x": "z", "y": "x"})"
                              : axis == "ry" ? R"({"y": "z", "z": "x"})"
                                             : R"({"z": "z", "x": "x"})";
    Mechanism m = made(R"({"lockstep": 1, "gravity": [0, -9.81, 0],
      "bodies": [{"name": "arm", "mass": 1, "inertia": [0.1, 0.1, 0.1], "center": [0.5, 0, 0]}],
      "links": [{"name": "A", "type": "lock", "mask": ")" +
                       mask + R"(", "p": "arm", "s": "ground", "at": [0, 0, 0], "orientation": )" + frame +
                       R"(, "stops": [{"axis": ")" + axis + R"(", "low": -0.4}]}]})");
    const Channel angle = make_channel(system_of(m), "arm.angle_z");
    Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
    const Registry registry = builtin_registry();
    StepLoop simulation(dynamics, registry.integrators.make("dop853", {}, &registry, "method"));
    simulation.run_until(1);
    CHECK(simulation.report().impacts == 1);
    CHECK(angle.value(Sample(dynamics, simulation.state(), {})) == Approx(-0.4).epsilon(1e-10));
  }
}

TEST_CASE("scene: one-sided joints and their side", "[unit][scene]") {
  const Mechanism m = made(R"({"lockstep": 1, "bodies": [{"name": "bob", "particle": 1, "position": [0, 0, -0.5]}],
      "links": [{"name": "rope", "type": "distance", "p": "bob", "s": "ground", "at_s": [0, 0, 0], "length": 1,
                 "unilateral": {"restitution": 0.5, "rest_speed": "2 mm/s", "side": "below"}}]})");
  const Unilateral& o = *m.system.link("rope").unilateral();
  CHECK(o.restitution == 0.5);
  CHECK(o.rest_speed == Approx(0.002));
  CHECK(o.below);
}

TEST_CASE("scene: friction of a joint, by its own key and by a force that names it", "[unit][scene]") {
  const Mechanism own = made(arm(R"("friction": {"mu": 0.1, "radius": "20 mm"})"));
  CHECK(own.system.force("A.friction").type() == "joint_friction");
  CHECK(own.system.force("A.friction").reacting()->reads().front() == &own.system.link("A"));
  const Mechanism named =
      made(arm("", R"("forces": [{"name": "rub", "type": "joint_friction", "link": "A", "mu": 0.1, "radius": 0.02}])"));
  CHECK(named.system.force("rub").reacting()->reads().front() == &named.system.link("A"));
}

TEST_CASE("scene: impossible stops are rejected at their place", "[unit][scene]") {
  check_words(refusal(arm(R"("unilateral": {})")), {"arm.json", "joint 'A'", "5 constraints", "exactly one"});
  check_words(refusal(arm(R"("unilateral": {"restitution": 2})")), {"joint 'A', unilateral", "restitution", "0", "1"});
  check_words(refusal(arm(R"("stops": [{"axis": "rz"}])")), {"joint 'A', stops[0]", "low", "high"});
  check_words(refusal(arm(R"("stops": [{"axis": "rz", "low": 1, "high": 0}])")), {"stops[0]", "high", "above"});
  check_words(refusal(arm(R"("stops": [{"axis": "rw", "low": 1}])")), {"stops[0]", "axis"});
  check_words(refusal(arm(R"("stops": [{"axis": "rz", "low": 1, "restitution": -1}])")), {"restitution"});
  check_words(refusal(arm(R"("friction": {"radius": 1})")), {"joint 'A', friction", "mu"});
  check_words(refusal(arm(R"("friction": {"mu": 0.1})")), {"joint 'A', friction.radius", "missing"});
  check_words(refusal(arm(R"("friction": {"mu": 0.1, "raduis": 1})")), {"joint 'A', friction", "raduis", "radius"});
  check_words(refusal(arm(R"("friction": {"mu": 0.1})", "", "z", "spherical")), {"A.friction", "spherical"});
  check_words(refusal(arm("", R"("forces": [{"name": "rub", "type": "joint_friction", "mu": 0.1}])")), {"rub", "link"});
  check_words(refusal(arm("", R"("forces": [{"name": "rub", "type": "joint_friction", "link": "B", "mu": 0.1}])")),
              {"rub", "unknown joint \"B\""});
}

TEST_CASE("scene: stops without effect are rejected", "[unit][scene]") {
  check_words(refusal(arm(R"("stops": [{"axis": "x", "high": 1}])")),
              {"joint 'A', stops[0].axis", "constrains x", "free"});
  check_words(refusal(arm(R"("stops": [{"axis": "rx", "high": 1}])")), {"stops[0].axis", "constrains rx"});
  check_words(refusal(arm("", R"("forces": [{"name": "F", "type": "spring_damper", "p": "arm", "s": "ground",
                                             "at_p": [1, 0, 0], "at_s": [2, 0, 0], "stiffness": 1, "link": "A"}])")),
              {"force 'F', link", "does not act in a joint"});
}

// Their reaction has a part by the function, which is not the load on a surface that slides.
TEST_CASE("scene: friction of a joint that also holds a function is rejected", "[unit][scene]") {
  const std::string friction = R"("friction": {"mu": 0.3, "radius": 0.02})";
  const std::vector<std::pair<std::string, std::string>> types = {
      {"screw", R"("lead": 0.1)"},
      {"rack_and_pinion", R"("radius": -0.1)"},
      {"function", R"("mask": "y e1 e2 e3", "phi": "=z - x")"},
      {"function", R"~("mask": "x y z e1 e2", "phi": "=rz - sin(t)")~"}};
  const std::string by_force =
      R"("forces": [{"name": "rub", "type": "joint_friction", "link": "A", "mu": 0.3, "radius": 0.02}])";
  for (const auto& [type, keys] : types) {
    std::string joint = "joint 'A' (";
    joint += type + ")";
    check_words(refusal(arm(keys + ", " + friction, "", "z", type)),
                {"arm.json:", "force 'A.friction'", joint, "use joints such as revolute, prismatic"});
    check_words(refusal(arm(keys, by_force, "z", type)), {"arm.json:", "force 'rub'", joint, "revolute, prismatic"});
  }
  CHECK(made(arm(R"("mask": "x y z e1 e2", )" + friction, "", "z", "lock")).system.forces().size() == 1);
  CHECK(made(arm(friction + R"(, "drive": {"axis": "rz", "law": 1})")).system.forces().size() == 1);
}

TEST_CASE("scene: friction is rejected if a law rotates the axis away", "[unit][scene]") {
  check_words(refusal(arm(R"("turn": {"type": "constant", "orientation": {"axis": "x", "angle": 1}},
                             "friction": {"mu": 0.1, "radius": 0.01})")),
              {"'A.friction'", "a law \"turn\"", "free axis"});
}

// A body that begins on its stop and moves into it begins with an impact.
TEST_CASE("scene: who starts on a stop and moves into it bounces", "[unit][scene]") {
  Mechanism m = made(R"({"lockstep": 1, "bodies": [{"name": "arm", "mass": 1, "inertia": [0.1, 0.1, 0.1],
      "center": [0.5, 0, 0], "omega_world": [0, 0, -1]}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0],
               "stops": [{"axis": "rz", "low": 0, "restitution": 1}]}]})");
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  const Registry registry = builtin_registry();
  StepLoop simulation(dynamics, registry.integrators.make("dop853", {}, &registry, "method"));
  simulation.run_until(0.5);
  CHECK(simulation.report().impacts == 1);
  CHECK(simulation.state().slot_twist(0).w[2] == Approx(1));
}

// The gears are fast before the stop and slow after it: neither the coupling nor the channel may count on at the speed
// of before.
TEST_CASE("scene: counted revolutions survive an impact", "[unit][scene]") {
  for (const double restitution : {0.0, 0.01}) {
    CAPTURE(restitution);
    Mechanism m = made(R"({"lockstep": 1,
      "bodies": [{"name": "a", "cylinder": {"mass": 1, "radius": 0.1, "length": 0.05}, "omega_world": [0, 0, 300]},
                 {"name": "b", "cylinder": {"mass": 1, "radius": 0.1, "length": 0.05}, "position": [0.3, 0, 0],
                  "omega_world": [0, 0, -150]}],
      "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0],
                 "stops": [{"axis": "rz", "high": 10.3, "restitution": )" +
                       std::to_string(restitution) + R"(}]},
                {"name": "B", "type": "revolute", "p": "b", "s": "ground", "at": [0.3, 0, 0]},
                {"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": 2}]})");
    Recorder recorder(system_of(m), {"a.angle_z", "b.angle_z"});
    Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
    const Registry registry = builtin_registry();
    StepLoop simulation(dynamics, registry.integrators.make("dop853", {}, &registry, "method"));
    simulation.add_observer(recorder);
    simulation.run_until(2);
    const auto last = [&](std::size_t k) { return recorder.table().columns()[k].values.back(); };
    CHECK(simulation.report().impacts == 1);
    CHECK(last(1) + 2 * last(2) == Approx(0).margin(1e-9));
    const double t_hit = 10.3 / 300, expected = 10.3 - 300 * restitution * (2 - t_hit);
    CHECK(last(1) == Approx(expected).margin(1e-6));
  }
}

namespace {

/// How the run of an assembled mechanism to time t ends.
std::string ending(Mechanism& m, const std::string& method, double step, double t, SimulationReport& report) {
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  State start = m.system.start();
  assemble(dynamics, start);
  const Registry registry = builtin_registry();
  StepLoop run(dynamics, registry.integrators.make(method, {}, &registry, "method"), {.step = step});
  run.set_state(start);
  const std::string said = testing::message_of<StepError>([&] { run.run_until(t); });
  report = run.report();
  return said;
}

}  // namespace

TEST_CASE("scene: a law that drives a joint on against its stop ends the run by counts, and the stop is named",
          "[unit][scene]") {
  const auto [method, step] =
      GENERATE(std::pair<std::string, double>{"dopri5", 0}, std::pair<std::string, double>{"rk4", 0.01});
  Mechanism m = made(arm(R"("stops": [{"axis": "rz", "low": -1, "high": 0.5}],
                            "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}})"));
  SimulationReport report;
  const std::string said = ending(m, method, step, 1, report);
  check_words(said, {"t = 0.5", "the rest of the run would take",
                     "one-sided joint 'A.stop_rz_high' made or lost contact", "a law may drive bodies against it"});
  CHECK_FALSE(testing::says(said, {"check its laws"}));
  CHECK_FALSE(testing::says(said, {"A.stop_rz_low"}));
  CHECK(report.steps < 30000);
}

TEST_CASE("scene: a ball in a gap that closes ends the run by counts, and what closes it is named", "[unit][scene]") {
  Mechanism m = made(R"({"lockstep": 1, "gravity": [0, 0, 0],
    "bodies": [{"name": "ball", "particle": 1, "position": [0, 0, 0], "velocity": [0, 1, 0]},
               {"name": "floor", "box": {"mass": 1, "size": [0.1, 0.1, 0.1]}, "position": [0, -1, 0]}],
    "links": [{"name": "lift", "type": "lock", "mask": "x y z e1 e2 e3", "p": "floor", "s": "ground", "at": [0, -1, 0],
               "move": {"type": "along", "axis": "y", "law": {"type": "ramp", "slope": 1}}},
              {"name": "below", "type": "point_on_plane", "p": "ball", "s": "floor", "at_p": [0, 0, 0],
               "at_s": [0, -1, 0], "axis": "y", "unilateral": {"restitution": 0.5}},
              {"name": "above", "type": "point_on_plane", "p": "ball", "s": "ground", "at_p": [0, 0, 0],
               "at_s": [0, 1, 0], "axis": "-y", "unilateral": {"restitution": 0.5}}]})");
  SimulationReport report;
  const std::string said = ending(m, "dopri5", 0, 3, report);
  check_words(said, {"the rest of the run would take", "one-sided joints 'below', 'above' made or lost contact",
                     "they are clamped"});
  CHECK(report.steps < 100000);
}

TEST_CASE("scene: a law that begins against a stop is rejected with both names", "[unit][scene]") {
  Mechanism m = made(arm(R"("stops": [{"axis": "rz", "low": 0, "high": 1}],
                            "drive": {"axis": "rz", "law": {"type": "ramp", "slope": -1}})"));
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  State start = m.system.start();
  assemble(dynamics, start);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  run.set_state(start);
  check_words(testing::message_of<Error>([&] { run.run_until(1); }),
              {"two laws may drive one coordinate, or a law of joint 'A' drives against the closed one-sided joint "
               "'A.stop_rz_low'"});
}

}  // namespace stops_test
