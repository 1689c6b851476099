// SPDX-License-Identifier: BSD-3-Clause
// Formulas that see the mechanism: tables as functions, and forces that read coordinates of others.
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/formula.h>
#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/splines.h>
#include "framework/description/scene/system_of.h"
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/function.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace mechanism_formula_test {

using namespace lockstep;
using namespace lockstep::testing;
using expression::FormulaFunction;
using std::numbers::pi;

namespace {

Mechanism built(const std::string& scene) {
  return build_mechanism(scene_from_text(R"({"lockstep": 1, )" + scene + "}", "formulas.json"), builtin_registry());
}

Table run_of(const std::string& scene) {
  Simulation run(built(scene));
  run.run();
  return run.table();
}

std::string refusal(const std::string& scene) {
  return message_of<SceneError>([&] { built(scene); });
}

// Two carriages on one line, and the forces and columns of a test.
std::string carriages(const std::string& forces, const std::string& run, const std::string& more = "") {
  return R"("parameters": {"k": "30 N/m", "c": "2 N s/m"}, "bodies": [
    {"name": "a", "sphere": {"mass": 1, "radius": 0.1}}, {"name": "b", "sphere": {"mass": 3, "radius": 0.1},
     "position": [1.3, 0, 0]}],
    "joints": [{"name": "A", "type": "prismatic", "p": "a", "s": "ground", "at": [0, 0, 0], "axis": "x"},
               {"name": "B", "type": "prismatic", "p": "b", "s": "ground", "at": [1.3, 0, 0], "axis": "x"}],
    "forces": [)" +
         forces + R"(], "run": {"until": 2, "output": 0.1, )" + run + "}" + more;
}

}  // namespace

TEST_CASE("a table is a function of anything, with its derivatives", "[unit][expression]") {
  // x^3 by a clamped cubic spline, which is exact
  NamedNumbers cubic;
  cubic.name = "f";
  cubic.table =
      laws::spline({{-1, -1}, {0.5, 0.125}, {2, 8}}, {.ends = SplineEnds::clamped}, {.start_rate = 3, .end_rate = 12});
  const FormulaFunction f("=2*table(f, x - t)", {"x", "t"}, {cubic});
  for (const double x : {-0.7, 0.1, 1.3}) {
    const std::array<Time, 2> v = {Time(x + 0.4, 3, 5), Time(0.4, 1, 0)};  // x - t has the rates 2 and 5
    const Time y = f(std::span<const Time>(v));
    CHECK(y.v == Approx(2 * x * x * x).margin(1e-14));
    CHECK(y.d == Approx(2 * 3 * x * x * 2).margin(1e-13));
    CHECK(y.h == Approx(2 * (6 * x * 2 * 2 + 3 * x * x * 5)).margin(1e-12));
  }
  CHECK(f.reads(0));
  CHECK_FALSE(f.has_switches());

  SplinePoints many;
  constexpr int kPoints = 100'000;
  for (int i = 0; i <= kPoints; ++i)
    many.emplace_back(2 * pi * i / kPoints, i == kPoints ? 0 : std::sin(2 * pi * i / kPoints));
  NamedNumbers sine;
  sine.name = "s";
  sine.table = laws::spline(many, {.ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
  const FormulaFunction g("=table(s, x)", {"x"}, {sine});
  for (const double x : {-100.3, 0.0, 1.0, 3e4}) {
    const Time at[] = {Time(x)};
    CHECK(g(std::span<const Time>(at)).v == Approx(std::sin(x)).margin(1e-11));  // 3e4: round-off of the argument
  }
}

TEST_CASE("a misused table is reported with the way to use it", "[unit][expression]") {
  NamedNumbers f;
  f.name = "f";
  f.table = laws::spline({{0, 0}, {1, 1}});
  const auto problem = [&](const char* text) {
    return message_of<ModelError>([&] { FormulaFunction(text, {"x"}, {f}); });
  };
  CHECK(problem("=2*f").find("write table(f, x)") != std::string::npos);
  CHECK(problem("=table(x, f)").find("the name of a table is expected") != std::string::npos);
  CHECK(problem("=table(f)").find("takes 2 arguments") != std::string::npos);
}

TEST_CASE("forces that read other coordinates are those of springs between them", "[unit][forces]") {
  const std::string record = R"~("tolerance": 1e-11, "record": ["A.z", "B.z", "A.z_d"])~";
  const Table spring = run_of(carriages(R"({"name": "s", "type": "spring_damper", "p": "b", "s": "a",
      "at_p": [1.3, 0, 0], "at_s": [0, 0, 0], "stiffness": 30, "damping": 2, "free_length": 1})",
                                        record));
  const std::string names[][4] = {{"B.z", "A.z", "B.z_d", "A.z_d"}, {"b.x - 1.3 m", "a.x", "b.vx", "a.vx"}};
  for (const auto& [xb, xa, vb, va] : names) {
    const std::string pull = "=k*(" + xb + " - " + xa + " + 0.3 m) + c*(" + vb + " - " + va + ")";
    const Table read = run_of(carriages(R"({"name": "on_a", "type": "function_force", "link": "A",
        "force": ")" + pull + R"("}, {"name": "on_b", "type": "function_force", "link": "B",
        "force": "=-1*()" + pull.substr(1) + ")\"}",
                                        record));
    for (std::size_t i = 0; i < read.n_rows(); ++i)
      for (const char* column : {"A.z", "B.z", "A.z_d"})
        CHECK(read[column][i] == Approx(spring[column][i]).margin(1e-9));
  }
  const Table pair = run_of(carriages(R"({"name": "f", "type": "function_force", "p": "b", "s": "a",
      "coordinate": "distance", "at_p": [1.3, 0, 0], "at_s": [0, 0, 0],
      "force": "=-k*(b.distance@a - 1 m) - c*b.distance_d@a"})",
                                      record));
  for (std::size_t i = 0; i < pair.n_rows(); ++i) CHECK(pair["B.z"][i] == Approx(spring["B.z"][i]).margin(1e-9));
}

// Oracle: central differences of the wrench.
TEST_CASE("the tangent of a force has the derivatives to all that its formula reads", "[unit][forces]") {
  Mechanism m = built(R"~("bodies": [
      {"name": "a", "sphere": {"mass": 1, "radius": 0.1}, "position": [0.1, 0.2, -0.3]},
      {"name": "b", "sphere": {"mass": 2, "radius": 0.2}, "position": [1, 0.4, 0.2]},
      {"name": "c", "sphere": {"mass": 2, "radius": 0.2}, "position": [0.7, -1, 0.5]},
      {"name": "d", "sphere": {"mass": 2, "radius": 0.2}, "position": [0.2, 1.2, 0.8]}],
    "joints": [{"name": "C", "type": "lock", "mask": "x", "p": "c", "s": "d", "at": [0, 0, 0]}],
    "forces": [{"name": "f", "type": "function_force", "p": "a", "s": "b", "at": [0.3, 0.1, 0], "coordinate": "y",
      "force": "=q*C.rz + 3*qd*c.distance@d - dot(c.v, d) + C.angle_x_d*c.distance_d@a + c.omega_x@d*max(C.y_d, q)"},
      {"name": "g", "type": "function_force", "p": "a", "s": "b", "at": [0.3, 0.1, 0], "coordinate": "rx",
      "torque": "=(q + a.omega_world_x - c.omega_body_y)*c.x@a + qd*C.vz^2 + c.angle_y*d.qz + c.angle_z@d*d.qw@c*c.center_vy"},
      {"name": "h", "type": "function_force", "p": "a", "s": "b", "at_p": [0.3, 0.1, 0], "at_s": [0, 0.5, 0],
      "coordinate": "distance", "force": "=q^2*C.z"}],
    "run": {"until": 1})~");
  System& system = system_of(m);
  system.setup();
  const State state = system.start();
  std::vector<Motion> motions(static_cast<std::size_t>(system.n_slots()) + 1);
  for (int k = 1; k <= system.n_slots(); ++k) {
    Motion& O = motions[static_cast<std::size_t>(k)];
    const double f = 0.3 + 0.4 * k;
    O.x = system.slot(k - 1).home.x + Vec3(0.1 * f, -0.2, f), O.v = Vec3(f, -0.7, 0.2 * f), O.w = Vec3(0.4, f, -0.5);
    O.e = normalized(Quat{1, 0.2 * f, -0.3, 0.1 + f}), O.A = rotation(O.e);
  }
  const int n = 6 * system.n_slots();
  const auto inputs = [&](const std::vector<Motion>& at) {
    return Inputs{.t = 0.2, .motions = at, .s = {state.s.data(), static_cast<std::size_t>(state.s.size())}, .z = {}};
  };
  // (9.13) x + h dx, q exp(h dth/2), v + h, w + h: number k of 12 of one slot
  const auto load = [&](const Force& force, int slot, int k, double h) {
    std::vector<Motion> at = motions;
    Motion& O = at[static_cast<std::size_t>(slot) + 1];
    const Vec3 step = h * Vec3::Unit(k % 3);
    if (k < 3) O.x += step;
    if (k / 3 == 1) O.e = O.e * exponential(step), O.A = rotation(O.e);
    if (k / 3 == 2) O.v += step;
    if (k / 3 == 3) O.w += step;
    VecX Q = VecX::Zero(n);
    WrenchSum sum(at, Q);
    force.apply(inputs(at), sum);
    return Q;
  };
  for (const auto& force : system.forces()) {
    CAPTURE(force->name());
    TangentSum sum;
    sum.lay_out(system.n_slots());
    force->tangent(inputs(motions), sum);
    MatX exact = MatX::Zero(n, 2 * n), differences = exact;
    for (std::size_t i = 0; i < sum.pairs().size(); ++i) {
      const auto [row, column] = sum.pairs()[i];
      exact.block<6, 6>(6 * row, 6 * column) += sum.K(i);
      exact.block<6, 6>(6 * row, n + 6 * column) += sum.D(i);
    }
    constexpr double h = 1e-5;
    for (int slot = 0; slot < system.n_slots(); ++slot)
      for (int k = 0; k < 12; ++k)
        differences.col((k < 6 ? 0 : n - 6) + 6 * slot + k) =
            -(load(*force, slot, k, h) - load(*force, slot, k, -h)) / (2 * h);
    CHECK((exact - differences).cwiseAbs().maxCoeff() < 1e-8 * (1 + exact.cwiseAbs().maxCoeff()));
    if (force->name() != "h") CHECK(exact.rightCols(n).cwiseAbs().maxCoeff() > 0.1);
  }
}

// Oracle: the channel of the same name.
TEST_CASE("a formula of a force reads the channels that it names", "[unit][forces]") {
  for (const std::string name :
       {"C.y",         "C.vx",         "C.z_d",           "C.angle_x",      "C.angle_z",   "C.angle_y_d", "C.omega_y",
        "a.x",         "a.vz",         "a.omega_world_x", "c.omega_body_y", "C.P.y",       "c.x@d",       "c.vy@C.P",
        "c.omega_z@d", "c.distance@d", "c.distance_d@a",  "c.angle_x",      "C.P.angle_z", "c.angle_y@d", "c.qw",
        "d.qz",        "c.qy@d",       "c.center_y",      "d.center_vx"}) {
    CAPTURE(name);
    const Table t =
        run_of(R"~("bodies": [
        {"name": "a", "sphere": {"mass": 1, "radius": 0.1}, "position": [0.1, 0.2, -0.3], "velocity": [1, 2, 3]},
        {"name": "c", "box": {"mass": 2, "size": [0.2, 0.4, 0.6]}, "position": [0.7, -1, 0.5], "velocity": [0, 1, 0],
         "omega_world": [1, 5, -2]},
        {"name": "d", "box": {"mass": 2, "size": [0.6, 0.2, 0.1]}, "position": [0.7, 1.2, 0.8], "omega_world": [0.3, 0.1, 3]}],
      "joints": [{"name": "C", "type": "lock", "mask": "x", "p": "c", "s": "d", "at_p": [0.7, -0.8, 0.5], "at_s": [0.7, 1, 0.9]}],
      "forces": [{"name": "f", "type": "function_force", "p": "a", "s": "ground", "at": [0.1, 0.2, -0.3], "coordinate": "y",
        "force": "=0.001*)~" +
               name + R"~("}], "run": {"until": 0.5, "output": 0.1, "record": ["f.force", ")~" + name + R"~("]})~");
    for (std::size_t i = 0; i < t.n_rows(); ++i) CHECK(t["f.force"][i] == Approx(0.001 * t[name][i]).margin(1e-14));
  }
}

TEST_CASE("two particles with a Lennard-Jones force keep their energy", "[unit][forces]") {
  const Table t = run_of(R"~("parameters": {"eps": "2 J", "sig": "0.5 m"}, "bodies": [
      {"name": "P", "particle": 1, "position": [0.9, 0, 0], "velocity": [0, 0.4, 0.1]}, {"name": "Q", "particle": 3}],
    "forces": [{"name": "lj", "type": "function_force", "p": "P", "s": "Q", "coordinate": "distance",
      "force": "=24*eps*(2*(sig/q)^12 - (sig/q)^6)/q"}],
    "run": {"until": 3, "output": 0.05, "tolerance": 1e-11, "record": ["P.distance@Q",
      {"E": "=energy.kinetic + 4*eps*((sig/P.distance@Q)^12 - (sig/P.distance@Q)^6)"}]})~");
  double nearest = 1;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    CHECK(t["E"][i] == Approx(t["E"][0]).epsilon(1e-8));
    nearest = std::min(nearest, t["P.distance@Q"][i]);
  }
  CHECK(nearest < 0.6);  // they have met
}

TEST_CASE("a magnet pulls by the distance, and the fall takes the time of its closed form", "[unit][forces]") {
  // r'' = -mu/r^2 from rest at r0: t = sqrt(r0^3/(2 mu)) (acos(sqrt(x)) + sqrt(x (1 - x))), x = r/r0
  const double mu = 3, r0 = 1, r = 0.3, x = r / r0;
  const double fall = std::sqrt(r0 * r0 * r0 / (2 * mu)) * (std::acos(std::sqrt(x)) + std::sqrt(x * (1 - x)));
  const Table t = run_of(R"~("bodies": [{"name": "nail", "particle": 2, "position": [0, 1, 0]}],
    "forces": [{"name": "magnet", "type": "function_force", "p": "nail", "s": "ground", "at_p": [0, 1, 0], "at_s": [0, 0, 0],
      "coordinate": "distance",
      "force": "=-6 N m^2/q^2"}],
    "events": [{"name": "near", "when": {"channel": "nail.y", "crosses": 0.3, "direction": "falling"}, "stop": true}],
    "run": {"until": 2, "output": 0.05, "tolerance": 1e-11, "record": ["nail.y"]})~");
  CHECK(t["t"].back() == Approx(fall).epsilon(1e-9));
}

// A needle in a field: q'' = -(m B/I) sin q. Oracle: its first integral.
TEST_CASE("a dipole swings in a field", "[unit][forces]") {
  const Table t = run_of(R"~("parameters": {"mB": "0.3 N m"}, "bodies": [{"name": "needle",
      "rod": {"mass": 0.5, "from": [-0.1, 0, 0], "to": [0.1, 0, 0]}}],
    "joints": [{"name": "pivot", "type": "revolute", "p": "needle", "s": "ground", "at": [0, 0, 0],
      "start": {"position": {"rz": "100 deg"}}}],
    "forces": [{"name": "field", "type": "function_force", "link": "pivot", "torque": "=-mB*sin(q)"}],
    "run": {"until": 3, "output": 0.1, "tolerance": 1e-11, "record": [
      {"E": "=energy.kinetic - mB*cos(pivot.rz)"}, "pivot.rz"]})~");
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    CHECK(t["E"][i] == Approx(-0.3 * std::cos(100 * pi / 180)).epsilon(1e-9));
}

// Gas in a cylinder: the piston's force is a table of the crank angle. Oracle: its work, 1/2 I w^2, by the same integral.
TEST_CASE("a gas force follows a table of the crank angle", "[unit][forces]") {
  const std::string table = R"("tables": {"gas": {"type": "spline", "points": [["0 deg", "8 bar"], ["90 deg", "3 bar"],
      ["180 deg", "1 bar"], ["270 deg", "1.5 bar"], ["360 deg", "8 bar"]], "ends": "periodic", "outside": "repeat"}},)";
  for (const char* integrator : {"dopri5", "radau5"}) {
    const Table t =
        run_of(table + R"~("parameters": {"area": "20 cm^2"}, "bodies": [
      {"name": "crank", "rod": {"mass": 2, "from": [0, 0, 0], "to": [0.05, 0, 0]}},
      {"name": "rod", "rod": {"mass": 1, "from": [0.05, 0, 0], "to": [0.25, 0, 0]}},
      {"name": "piston", "sphere": {"mass": 1, "radius": 0.03}, "position": [0.25, 0, 0]}],
    "joints": [{"name": "main", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0],
      "start": {"velocity": {"rz": "200 rad/s"}}},
      {"name": "pin", "type": "revolute", "p": "rod", "s": "crank", "at": [0.05, 0, 0]},
      {"name": "wrist", "type": "revolute", "p": "rod", "s": "piston", "at": [0.25, 0, 0]},
      {"name": "bore", "type": "prismatic", "p": "piston", "s": "ground", "at": [0.25, 0, 0], "axis": "x"}],
    "forces": [{"name": "pressure", "type": "function_force", "link": "bore",
      "force": "=-area*table(gas, main.rz)"}],
    "run": {"integrator": ")~" +
               std::string(integrator) + R"~(", "until": 0.05, "output": 0.001, "tolerance": 1e-10, "record": [
      "energy.kinetic", {"work": "=integral(-area*table(gas, main.rz)*piston.vx)"}, "main.rz",
      {"p": "=table(gas, main.rz)"}]})~");
    for (std::size_t i = 0; i < t.n_rows(); ++i)
      CHECK(t["energy.kinetic"][i] - t["energy.kinetic"][0] == Approx(t["work"][i]).margin(1e-5));
    CHECK(t["p"][0] == 8e5);
    CHECK(t["main.rz"].back() > 2 * pi);
  }
}

// A wheel, a pinion and a lift, coupled as the tests say. Oracles: the gear, and the sine that a table gives.
TEST_CASE("a formula couples the coordinates of joints", "[unit][links]") {
  const auto machine = [](const std::string& coupling) {
    return run_of(R"~("gravity": [0, -9.81, 0], "parameters": {"r": "50 mm"},
      "tables": {"profile": {"type": "spline", "points": [[0, 0], ["90 deg", "20 mm"], ["200 deg", "30 mm"],
        ["360 deg", 0]], "ends": "periodic", "outside": "repeat"}},
      "bodies": [{"name": "wheel", "rod": {"mass": 2, "from": [0, 0, 0], "to": [0.3, 0, 0]}},
                 {"name": "pinion", "rod": {"mass": 1, "from": [1, 0, 0], "to": [1.1, 0, 0]}},
                 {"name": "lift", "sphere": {"mass": 1, "radius": 0.1}, "position": [2, 0, 0]}],
      "joints": [{"name": "W", "type": "revolute", "p": "wheel", "s": "ground", "at": [0, 0, 0]},
                 {"name": "P", "type": "revolute", "p": "pinion", "s": "ground", "at": [1, 0, 0]},
                 {"name": "L", "type": "prismatic", "p": "lift", "s": "ground", "at": [2, 0, 0], "axis": "y"},
                 {"name": "fit", )~" +
                  coupling + R"~(}],
      "run": {"until": 3, "output": 0.1, "tolerance": 1e-10, "record": ["W.rz", "P.rz", "L.z",
        "energy.total", {"profile": "=table(profile, W.rz)"}]})~");
  };
  const Table gear = machine(R"("type": "gear", "pairs": ["W", "P"], "ratio": 0.5)");
  const Table rule = machine(R"("type": "function", "pairs": ["P", "W"], "phi": "=P.rz + 2*W.rz")");
  for (std::size_t i = 0; i < rule.n_rows(); ++i) CHECK(rule["P.rz"][i] == Approx(gear["P.rz"][i]).margin(1e-8));
  const Table cam = machine(R"~("type": "function", "pairs": ["L", "W"], "phi": "=L.z - table(profile, W.rz)")~");
  for (std::size_t i = 0; i < cam.n_rows(); ++i) {
    CHECK(cam["L.z"][i] == Approx(cam["profile"][i]).margin(1e-10));
    CHECK(cam["energy.total"][i] == Approx(cam["energy.total"][0]).margin(1e-7));
  }
  const Table three =
      machine(R"~("type": "function", "pairs": ["L", "W", "P"], "phi": "=L.z - r*sin(W.rz) - r*P.rz/2")~");
  for (std::size_t i = 0; i < three.n_rows(); ++i) {
    CHECK(three["L.z"][i] == Approx(0.05 * std::sin(three["W.rz"][i]) + 0.025 * three["P.rz"][i]).margin(1e-10));
    CHECK(three["energy.total"][i] == Approx(three["energy.total"][0]).margin(1e-7));
  }
}

TEST_CASE("a table has one unit per axis, by its points or its file", "[unit][expression]") {
  const auto scene = [](const std::string& points, const std::string& column) {
    return R"("tables": {"T": {"type": "spline", )" + points + R"(}}, "bodies": [{"name": "a", "particle": 1}],
      "run": {"until": 0, "record": [{"c": ")" +
           column + "\"}]}";
  };
  const auto points = [&](const std::string& list) { return "\"points\": [" + list + "]"; };
  check_words(refusal(scene(points(R"(["0 m", "1 bar"],
      ["0.5 m", "3 N"])"),
                            "=a.x")),
              {"formulas.json:2", "scene.tables.T.points[1][1]", "\"3 N\" is a force", "the points before are in Pa"});
  check_words(refusal(scene(points(R"([0, 1], ["1 m", "3 N"], ["2 s", 4])"), "=a.x")),
              {"scene.tables.T.points[2][0]", "\"2 s\" is a time", "in m there"});
  const std::string file = "formula_axis_units.csv";
  std::ofstream(file) << "t [mm],y [bar]\n0,1\n500,3\n1000,4\n";
  const auto problem = [&](const std::string& given, const std::string& column) {
    return message_of<Error>([&] { run_of(scene(given, column)); });
  };
  const std::string given = points(R"(["0 m", "1 bar"], ["50 cm", "3e5 Pa"], [1, "4 bar"])");
  for (const std::string& from : {given, "\"file\": \"" + file + "\""}) {
    const Table t = run_of(scene(from, "=table(T, a.x + 0.5 m)"));
    CHECK(t["c"][0] == 3e5);
    CHECK(t.column("c").unit == "Pa");
    check_words(problem(from, "=table(T, a.x) + 1 kg"), {"a quantity in Pa and a mass are added"});
    check_words(problem(from, "=table(T, a.vx)"), {"the argument of table \"T\" is a speed; a length is expected"});
    check_words(problem(from, "=table(T, t)"), {"is a time; a length is expected"});
    check_words(problem(from, "=table(U, a.x)"), {"the name of a table is expected, \"U\" is none"});
  }
  check_words(problem(given, "=at(a.y, 3 m)"), {"the second argument of at is a length; a time is expected"});
  check_words(problem(given, "=mean(last(a.y, 0.5 m))"), {"the second argument of last is a length"});
}

// Oracle: the rate of the table, which is a line.
TEST_CASE("the law of a drive reads a table with units", "[unit][expression]") {
  const auto driven = [](const std::string& y) {
    return R"("tables": {"T": {"type": "spline", "points": [["0 s", "0 m"], ["1 s", "300 mm"]]}},
      "bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 0.1}}],
      "joints": [{"name": "A", "type": "prismatic", "p": "a", "s": "ground", "at": [0, 0, 0], "axis": "z",
        "drive": {"axis": "z", "law": {"type": "formula", "y": ")" +
           y + R"("}}}],
      "run": {"until": 1, "output": 0.25, "record": ["A.z", "A.z_d"]})";
  };
  for (const auto& [y, factor] : {std::pair{"=table(T, t)", 1.0}, {"=2*table(T, t)", 2}, {"=table(T, t) + 0 m", 1}}) {
    const Table t = run_of(driven(y));
    for (std::size_t i = 0; i < t.n_rows(); ++i) {
      CHECK(t["A.z"][i] == Approx(0.3 * factor * t["t"][i]).margin(1e-12));
      CHECK(t["A.z_d"][i] == Approx(0.3 * factor).epsilon(1e-9));
    }
  }
  check_words(refusal(driven("=table(T, 0.5 m)")), {"the argument of table \"T\" is a length; a time is expected"});
  check_words(refusal(driven("=table(T, t)/(1 s)")), {"its value is a speed; a length is expected"});
  for (const char* channel : {"=0.1*A.z_d", "=0.1*a.x"})
    check_words(refusal(driven(channel)),
                {"a law is a function of t: forces of function_force and joints of formulas read channels"});
}

// Oracle: the momentum. 100 N for 10 ms, which the steps of a body at rest would pass over.
TEST_CASE("a run steps onto the breakpoints of a table that a formula reads at a time", "[unit][expression]") {
  const auto speed = [](const std::string& argument) {
    return run_of(R"~("tables": {"T": {"type": "sequence", "durations": [1.2, 0.01, 10], "laws": [0, 100, 0]}},
      "bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 0.1}}],
      "joints": [{"name": "A", "type": "prismatic", "p": "a", "s": "ground", "at": [0, 0, 0], "axis": "z"}],
      "forces": [{"name": "f", "type": "function_force", "link": "A", "force": "=table(T, )~" +
                  argument + R"~()"}], "run": {"until": 3, "output": 1, "record": ["A.z_d"]})~")
        .last("A.z_d");
  };
  CHECK(speed("t") == Approx(1).epsilon(1e-9));
  CHECK(speed("3 s - t") == Approx(1).epsilon(1e-9));
  CHECK(speed("4*t + 0.1 s") == Approx(0.25).epsilon(1e-9));
  CHECK(speed("mod(t, 1.5 s)") == Approx(2).epsilon(1e-9));
}

// Oracle: the components.
TEST_CASE("a formula reads vectors seen from another frame", "[unit][expression]") {
  const Table t = run_of(R"~("bodies": [{"name": "a", "particle": 1, "position": [1, 2, 2], "velocity": [3, 0, 4]},
      {"name": "o", "sphere": {"mass": 1, "radius": 0.1}, "omega_world": [0, 0, 2]}],
    "run": {"until": 0, "record": [{"v": "=norm(a.v@o)"}, {"vx": "=a.v@o.x"}, {"r": "=norm(a@o)"}, {"w": "=norm(o.omega@a)"}]})~");
  CHECK(t["r"][0] == Approx(3));
  CHECK(t["vx"][0] == Approx(3 + 2 * 2));  // v - w x d, d = (1, 2, 2)
  CHECK(t["v"][0] == Approx(std::hypot(7, -2, 4)));
  CHECK(t["w"][0] == Approx(2));
  check_words(message_of<Error>([] {
                run_of(R"("bodies": [{"name": "a", "particle": 1}, {"name": "o", "particle": 1}],
                  "run": {"until": 0, "record": ["a@o"]})");
              }),
              {"channel \"a@o\": add a quantity, such as \"a.x@o\""});
}

TEST_CASE("a formula of a force reports what it cannot read", "[unit][forces]") {
  const auto problem = [](const std::string& force) {
    return refusal(carriages(R"({"name": "f", "type": "function_force", "link": "A", "force": ")" + force + R"("})",
                             R"("record": [])"));
  };
  check_words(problem("=k*C.z"), {"\"C.z\" is no parameter or table", "no body, marker or joint is called \"C\""});
  check_words(problem("=k*Bb.z"), {"is called \"Bb\"; did you mean \"b\"?"});
  check_words(problem("=k*b.x@cc"), {"is called \"cc\""});
  check_words(problem("=k*B.zz"), {"\"B.zz\": there is no coordinate \"zz\"", "did you mean"});
  for (const char* solved : {"=B.force_on_p_world_x", "=B.z_dd*1 kg", "=b.ax*1 kg"})
    check_words(problem(solved), {"depends on what this formula gives", "coordinates and rates of joints"});
  check_words(problem("=3*sin(b.x)"), {"sin of a length", "an angle or a pure number is expected"});
  CHECK(problem("=k*B.z_d").find("a force is expected") != std::string::npos);
  CHECK(problem("=mean(B.z)*k").find("only a column can have it") != std::string::npos);
  CHECK(problem("=k*a").find("a number is expected; this is a vector") != std::string::npos);
  CHECK(problem("=table(gas, q)").find("the name of a table is expected, \"gas\" is none") != std::string::npos);
  CHECK(refusal(R"("parameters": {"f": 2}, "tables": {"f": {"type": "spline", "points": [[0, 1], [1, 2]]}})")
            .find("has this name") != std::string::npos);
  CHECK(refusal(R"("tables": {"sin": {"type": "spline", "points": [[0, 1], [1, 2]]}})").find("not a valid name") !=
        std::string::npos);
}

}  // namespace mechanism_formula_test
