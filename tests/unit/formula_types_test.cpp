// SPDX-License-Identifier: BSD-3-Clause
// The law, the link and the force by a formula: derivatives and jumps as they say, motions in closed form.
#include <cmath>

#include <lockstep/author/check.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/scene/json.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/run_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/worst.h"

namespace formula_types_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

Params params(const std::string& text) { return Params::unchecked(read_json(text, "params")); }

Table run(const std::string& members) {
  return run_scene(scene_path("screw"), {},
                   [&](Scene& scene) { scene = scene_from_text("{\"lockstep\": 1, " + members + "}", "s.json"); })
      .table;
}

double worst(const Table& table, const std::string& column, const std::function<double(double)>& by_hand) {
  double most = 0;
  const std::vector<double>&t = table["t"], &x = table[column];
  REQUIRE(t.size() > 10);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double off = std::abs(x[i] - by_hand(t[i]));
    most = off <= most ? most : off;  // a NaN stays
  }
  return most;
}

}  // namespace

TEST_CASE("laws by formula pass check_law", "[unit][law]") {
  for (const char* y : {"0.1*sin(3*t) + (t > 1 ? 2*(t-1)^2 : 0)", "=abs(sin(4*t))*exp(-t)", "=mod(3*t, 0.7)",
                        "=max(t, 1.2 - t)*floor(2*t)", "=t < 0.5 || t >= 1.5 ? 0 : hypot(t, 1)", "=5"}) {
    CAPTURE(y);
    const auto law = builtin().laws.make("formula", Params{{"y", y}}, &builtin(), "law");
    const CheckReport report = check_law(*law, {.seed = 3});
    INFO(report.text());
    CHECK(report.ok());
  }
  CHECK(builtin().laws.make("formula", Params{{"y", "=2*pi"}}, &builtin(), "law")->is_constant());
  check_words(message_of<SceneError>([] {
                builtin().laws.make("formula", Params{{"y", "=sin(t"}}, &builtin(), "law 'L'");
              }),
              {"law 'L', y", "\"=sin(t\", column 7", "expected \")\""});
}

TEST_CASE("links by formula pass check_lock", "[unit][link]") {
  const char* const links[] = {R"~({"phi": "=z - (x^2 + y^2)/(2*R)", "parameters": {"R": "500 mm"}})~",
                               R"~({"phi": "=hypot(x, y, z) - 1 - 0.1*sin(3*t)"})~",
                               R"~({"phi": "=e1*e2 + 0.2*x*e0*e3"})~",
                               R"~({"phi": "=z - 0.05*rz + (t > 1 ? 0.3*(t - 1)^3 : 0)", "mask": "x y e1 e2"})~",
                               R"~({"phi": ["=x - 0.1*t", "=y*z + e1*e0"]})~",
                               R"~({"phi": ["=x + y", "=y + z^2", "=z - sin(x)"]})~",
                               R"~({"phi": ["=rz", "=x*y", "=e1*e0 - 0.1*z"]})~"};
  for (const char* link : links) {
    CAPTURE(link);
    const CheckReport report = check_lock(builtin(), "function", params(link), {.seed = 4});
    INFO(report.text());
    CHECK(report.ok());
  }
}

TEST_CASE("forces by formula pass check_force", "[unit][force]") {
  const char* const forces[] = {
      R"~({"force": "=-800*q - 20*qd + 5*sin(t)"})~",
      R"~({"force": "=-k*max(0, q - 0.1)^1.5", "coordinate": "x", "parameters": {"k": 300}})~",
      R"~({"torque": "=-3*sin(q) - 0.1*qd^3"})~", R"~({"torque": "=t > 0.4 && t < 1 ? 2 : -q", "coordinate": "ry"})~"};
  for (const char* force : forces) {
    CAPTURE(force);
    const CheckReport report = check_force(builtin(), "function_force", params(force), {.seed = 5});
    INFO(report.text());
    CHECK(report.ok());
  }
}

TEST_CASE("a bead circles in a paraboloid at any height with one speed", "[unit][link]") {
  // at radius r and w^2 = g/R the pull to the axis is met: x = r cos(w t), z stays
  const double R = 0.5, r = 0.3, w = std::sqrt(9.81 / R);
  const Table table = run(R"~("gravity": [0, 0, -9.81], "parameters": {"R": "0.5 m", "r": "0.3 m", "g": "9.81 m/s^2"},
    "bodies": [{"name": "bead", "particle": 2, "position": ["=r", 0, "=r^2/(2*R)"], "velocity": [0, "=r*sqrt(g/R)", 0]
}],
    "links": [{"name": "bowl", "type": "function", "p": "bead", "s": "ground", "at_s": [0, 0, 0],
               "phi": "=z - (x^2+y^2)/(2*R)"}],
    "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 3, "output": 0.05, "record": ["bead.x", "bead.z"]})~");
  CHECK(worst(table, "bead.x", [&](double t) {
  return r * std::cos(w * t); }) < 1e-8);
CHECK(worst(table, "bead.z", [&](double) { return r * r / (2 * R); }) < 1e-9);
}

TEST_CASE("a law by formula drives, and the run lands on its jump", "[unit][law]") {
  const Table table = run(R"~("parameters": {"a": "100 mm", "T": "530 ms"}, "bodies": [{"name": "b", "particle": 2}],
    "links": [{"name": "A", "type": "lock", "mask": "y z", "p": "b", "s": "ground",
               "drive": {"axis": "x", "law": {"type": "formula", "y": "=a*sin(3*t) + (t > T ? 2*(t-T)^2 : 0)"
}
}
}],
    "run": {"until": 2, "output": 0.01, "record": ["b.x", "b.ax", {"F": "A.drive.force_on_p_link_x"}]})~");
  const double T = 0.53;
CHECK(worst(table, "b.x", [&](double t) { return 0.1 * std::sin(3 * t) + (t > T ? 2 * (t - T) * (t - T) : 0); }) <
      1e-9);
const auto acceleration = [&](double t) { return -0.9 * std::sin(3 * t) + (t > T ? 4 : 0); };
double most = 0;
for (std::size_t i = 0; i < table["t"].size(); ++i) {
  const double t = table["t"][i];
  if (std::abs(t - T) > 1e-9) keep_worst(most, std::abs(table["F"][i] - 2 * acceleration(t)));
}
CHECK(most < 1e-9);
}

TEST_CASE("a force by formula gives the damped oscillation in closed form", "[unit][force]") {
  const double m = 2, k = 50, c = 4, w0 = k / m, b = c / (2 * m), w = std::sqrt(w0 - b * b);
  const Table table = run(R"("parameters": {"k": 50, "c": 4},
    "bodies": [{"name": "b", "particle": 2, "position": [0, 0, 0.1]}],
    "links": [{"name": "A", "type": "lock", "mask": "x y", "p": "b", "s": "ground", "at_s": [0, 0, 0]}],
    "forces": [{"name": "F", "type": "function_force", "link": "A", "force": "=-k*q - c*qd"}],
    "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 3, "output": 0.05,
            "record": ["b.z", "F.force", "F.coordinate", "energy.balance"]})");
  CHECK(worst(table, "b.z",
              [&](double t) { return 0.1 * std::exp(-b * t) * (std::cos(w * t) + b / w * std::sin(w * t)); }) < 1e-9);
  CHECK(worst(table, "energy.balance", [](double) { return 0.0; }) < 1e-8);  // its work is booked
}

TEST_CASE("a pulse is not lost near equal values", "[unit][force]") {
  for (const char* still : {"(max(0,t-8) > 0 ? 0 : 0)", "(min(t,1) < 1 ? 20 : 0)*0", "max(min(t,1),1)*0"}) {
    CAPTURE(still);
    const Table table = run(R"~("bodies": [{"name": "b", "particle": 1}],
      "links": [{"name": "A", "type": "lock", "mask": "x y", "p": "b", "s": "ground", "at_s": [0, 0, 0]}],
      "forces": [{"name": "F", "type": "function_force", "link": "A", "force": "=)~" +
                            std::string(still) + R"~( + (t>7.003 && t<7.004 ? 1000 : 0)"}],
      "run": {"until": 10, "output": 0.5, "record": ["b.vz"]})~");
    CHECK(worst(table, "b.vz", [](double t) { return t > 7.2 ? 1.0 : 0.0; }) < 1e-6);
  }
}

TEST_CASE("a torque by formula is the torsion spring of the same numbers", "[unit][force]") {
  const auto scene = [](const std::string& force) {
    return R"("gravity": [0, -9.81, 0], "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
      "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0],
                 "start": {"velocity": {"rz": 12}}}],
      "forces": [{"name": "F", )" +
           force + R"(}], "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 2, "output": 0.05,
      "record": ["A.rz", {"T": "F.torque"}]})";
  };
  const Table ours = run(scene(R"("type": "function_force", "link": "A", "torque": "=-0.4*(q - 0.3) - 0.02*qd")")),
              spring = run(scene(
                  R"("type": "torsion_spring_damper", "p": "arm", "s": "ground", "at": [0, 0, 0], "stiffness": 0.4,
                     "damping": 0.02, "free_angle": 0.3)"));
  double most = 0, largest = 0;
  for (std::size_t i = 0; i < ours["t"].size(); ++i) {
    keep_worst(most, std::abs(ours["A.rz"][i] - spring["A.rz"][i]));
    keep_worst(largest, std::abs(spring["A.rz"][i]));
  }
  CHECK(most < 1e-8);
  CHECK(largest > 7);  // more than a turn: it is counted
}

TEST_CASE("a torque by formula counts the revolutions of long steps", "[unit][force]") {
  const Table table = run(R"("bodies": [{"name": "wheel", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "A", "type": "revolute", "p": "wheel", "s": "ground", "at": [0, 0, 0]}],
    "forces": [{"name": "F", "type": "function_force", "link": "A", "torque": "=0.5 + 0*q"}],
    "run": {"integrator": "dop853", "tolerance": 1e-6, "until": 40, "output": 4, "record": ["F.coordinate", "A.rz_d"]})");
  CHECK(worst(table, "A.rz_d", [](double t) { return 0.5 * t; }) < 1e-9);
  CHECK(worst(table, "F.coordinate", [](double t) { return 0.25 * t * t; }) < 1e-6);
}

TEST_CASE("formulas of types are rejected in words", "[unit][scene]") {
  const auto refused = [](const std::string& members) {
    return message_of<SceneError>([&] {
      build_mechanism(
          scene_from_text("{\"lockstep\": 1, \"bodies\": [{\"name\": \"b\", \"particle\": 1}], " + members + "}",
                          "s.json"),
          builtin());
    });
  };
  const auto link = [&](const std::string& keys) {
    return refused(R"("links": [{"name": "A", "type": "function", "p": "b", "s": "ground", "at_s": [0, 0, 0], )" +
                   keys + "}]");
  };
  check_words(link(R"("phi": "=z - x^")"), {"s.json:1:", "joint 'A', phi", "column 8"});
  check_words(link(R"("phi": "=z - www")"), {"unknown name \"www\"", "known: x, y, z, rz, e0"});
  check_words(link(R"("phi": "=t")"), {"uses no coordinate"});
  check_words(link(R"("phi": 3)"), {"joint 'A', phi", "expected a text"});
  check_words(link(R"("phi": [])"), {"0 formulas", "give 1, 2 or 3"});
  check_words(link(R"("phi": ["=x", "=y", "=q"])"), {"phi[2]", "unknown name \"q\""});
  check_words(link(R"("phi": "=e1*e2")"), {"particle"});
  check_words(link(R"("phi": "=x", "parameters": {"x y": 1})"), {"parameters.x y", "is not a valid name"});
  const auto force = [&](const std::string& keys) {
    return refused(R"("forces": [{"name": "F", "type": "function_force", "p": "b", "s": "ground", "at": [0, 0, 0], )" +
                   keys + "}]");
  };
  check_words(force(R"("force": "=q", "torque": "=q")"), {"remove one of the two"});
  check_words(force(R"("coordinate": "x")"), {"give \"force\" or \"torque\""});
  check_words(force(R"("force": "=q", "coordinate": "rx")"), {"a force is along x, y, z or distance"});
  check_words(force(R"("force": "=qdd")"), {"force 'F', force", "unknown name \"qdd\"", "did you mean \"qd\""});
  check_words(force(R"("force": "=q", "link": "A")"), {"unknown joint"});
  check_words(force(R"("force": "=-3 m/s*q")"), {"force 'F', force", "m^2/s", "a force is expected", "q is a length"});
  check_words(force(R"("force": "=-k*q", "parameters": {"k": "3 N m"})"), {"force 'F', force", "a force is expected"});
  check_words(link(R"("phi": ["=x", "=z - 2 kg*y"])"), {"joint 'A', phi[1]", "a length", "subtracted"});
}

}  // namespace formula_types_test
