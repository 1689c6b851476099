// SPDX-License-Identifier: BSD-3-Clause
// Scenes that were found wrong from outside, each by its name there: what is asked of a mechanism beside its motion is
// answered as the motion would.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <lockstep/equilibrium.h>
#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include <lockstep/modes.h>
#include <lockstep/sweep.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/system_of.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/run_scene.h"

namespace defects_dynamics_test {

using namespace lockstep;
using namespace lockstep::testing;
using Kind = Stability::Kind;

namespace {

constexpr double kMass = 2, kLength = 1.5, kStiffness = 200, kReach = 1, kG = 9.81;

/// A mast on a ball joint that stands along y, held by two springs along x at its top: in the plane alone.
const std::string kMast = R"("gravity": [0, -9.81, 0],
  "bodies": [{"name": "mast", "mass": 2, "inertia": [0.375, 0.001, 0.375], "position": [0, 0.75, 0]}],
  "links": [{"name": "foot", "type": "spherical", "p": "mast", "s": "ground", "at": [0, 0, 0]}],
  "forces": [
    {"name": "left", "type": "spring_damper", "p": "mast", "s": "ground", "at_p": [0, 1.5, 0], "at_s": [-1, 1.5, 0],
     "stiffness": 200, "free_length": 1},
    {"name": "right", "type": "spring_damper", "p": "mast", "s": "ground", "at_p": [0, 1.5, 0], "at_s": [1, 1.5, 0],
     "stiffness": 200, "free_length": 1}],
  "run": {"until": 1, "output": 0.1, "record": ["mast.y"]})";

const double kInertia = kMass * kLength * kLength / 3;  // about the foot
const double kFalls = kMass * kG * kLength / 2 / kInertia;
const double kSways = (2 * kStiffness * kLength * kLength - kMass * kG * kLength / 2) / kInertia;

Mechanism mast() { return build_mechanism(read_scene(scene_file("mast", kMast)), builtin_registry()); }

/// The largest force that rows and loads leave unbalanced, of those along the unknown velocities, N and N m.
double unbalanced(Dynamics& dynamics, const State& state, const VecX& lambda) {
  const Evaluation& e = dynamics.gather(state);
  REQUIRE(lambda.size() == e.rows().n_rows);
  VecX left = e.force();
  for (const RowEntry& entry : e.rows().entries)
    for (int i = 0; i < entry.slots.n; ++i)
      for (int k = 0; k < entry.m; ++k) {
        const auto J = e.rows().block(entry).J(i, k);
        for (int c = 0; c < 6; ++c) left[6 * entry.slots[i] + c] -= J[c] * lambda[entry.first_row + k];
      }
  return left.lpNorm<Eigen::Infinity>();
}

}  // namespace

TEST_CASE("a mast that falls out of its plane is unstable, and the system is planar again", "[verification][defects]") {
  Mechanism m = mast();
  REQUIRE(m.system.plane().n == 2);
  Dynamics dynamics = make_dynamics(m, builtin_registry());
  State state = m.system.start();
  const EquilibriumReport report = find_equilibrium(dynamics, state, {.nearest = true});
  CHECK(report.stability.kind == Kind::unstable);
  REQUIRE(report.stability.unstable.size() == 1);
  CHECK(report.stability.unstable[0].stiffness == Approx(-kFalls).epsilon(1e-9));
  CHECK(report.stability.freedoms == 3);
  CHECK(report.stability.softest == Approx(-kFalls).epsilon(1e-9));
  CHECK(m.system.plane().n == 2);
  CHECK(m.system.n_velocities() == 3);
  CHECK(unbalanced(dynamics, state, report.lambda) < 1e-9);

  const Modes modes = find_modes(dynamics, m.system.start());
  CHECK(m.system.plane().n == 2);
  double grows = 0, sways = 0;
  for (const Mode& mode : modes.modes)
    grows = std::max(grows, mode.value.real()), sways = std::max(sways, mode.value.imag());
  CHECK(grows == Approx(std::sqrt(kFalls)).epsilon(1e-9));
  CHECK(sways == Approx(std::sqrt(kSways)).epsilon(1e-9));
}

TEST_CASE("a plane that was asked for is that of the verdict", "[verification][defects]") {
  Mechanism m = mast();
  system_of(m).set_planar(Plane{2});
  Dynamics dynamics = make_dynamics(m, builtin_registry());
  State state = m.system.start();
  const EquilibriumReport report = find_equilibrium(dynamics, state);
  CHECK(report.stability.kind == Kind::stable);
  CHECK(report.stability.softest == Approx(kSways).epsilon(1e-9));
  CHECK(m.system.plane().n == 2);
}

// 2 k (l - d) L^2 sin / l = m g (L/2) sin: l = d / (1 - m g / (4 k L)), and l^2 = d^2 + 2 L^2 (1 - cos).
TEST_CASE("downhill the mast leaves its plane, and the system with it", "[verification][defects]") {
  Mechanism m = mast();
  Dynamics dynamics = make_dynamics(m, builtin_registry());
  State state = m.system.start();
  const EquilibriumReport report = find_equilibrium(dynamics, state);
  CHECK(report.left.size() == 1);
  CHECK(report.stability.unstable.empty());
  CHECK_FALSE(m.system.plane());
  const double l = kReach / (1 - kMass * kG / (4 * kStiffness * kLength)),
               cosine = 1 - (l * l - kReach * kReach) / (2 * kLength * kLength);
  const Vec3 x = body_pose(m.system.body("mast"), state).x;
  CHECK(x[1] == Approx(0.5 * kLength * cosine).epsilon(1e-8));
  CHECK(std::abs(x[2]) == Approx(0.5 * kLength * std::sqrt(1 - cosine * cosine)).epsilon(1e-8));
  CHECK(unbalanced(dynamics, state, report.lambda) < 1e-6);
  system_of(m).changed();  // states stay valid over a setup
  dynamics.set_up();
  CHECK(body_pose(m.system.body("mast"), state).x == x);
}

namespace {

/// Leaves everything where it is, and steps `aside` m to the side in its sixth step.
class Sidestep final : public Integrator {
 public:
  explicit Sidestep(double aside) : aside_(aside) {}
  IntegratorInfo info() const override { return {"sidestep", 1, false, false, 1}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics&, State& state, double h) override {
    state.t += h;
    if (++steps_ == 6) state.q[0] += aside_;
    StepReport report;
    report.h = h;
    return report;
  }

 private:
  double aside_;
  int steps_ = 0;
};

SimulationReport sidesteps(double aside, AuditLimits limits) {
  System sys;
  Body& block = sys.add_body("block", MassProperties{1, Vec3::Zero(), 0.01 * Mat3::Identity()});
  sys.add<Spherical>("pin", block, sys.ground(), pose_at(Vec3(0.5, 0, 0)));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  StepLoop loop(dynamics, std::make_unique<Sidestep>(aside), {.step = 0.1, .limits = limits});
  return loop.run_until(1);
}

}  // namespace

TEST_CASE("a host receives the finding of a custom integrator that leaves the constraints", "[verification][defects]") {
  const SimulationReport off = sidesteps(1, {});
  CHECK(off.largest_violation == Approx(1).epsilon(1e-12));
  REQUIRE(off.findings.size() == 1);  // once, though it stays there for four steps more
  CHECK(
      off.findings[0].text().starts_with("sidestep: the constraint violation is 1 m after the step to t = 0.6 s "));
  CHECK(contains(off.findings[0].text(),
                 "(limit 0.0005 m)"));  // a thousandth of the mechanism's length, the arm of 0.5 m
  CHECK(sidesteps(1, {.violation = 2}).findings.empty());
  CHECK(sidesteps(1e-4, {}).findings.empty());
  CHECK(sidesteps(1e-4, {.violation = 1e-5}).findings.size() == 1);
}

TEST_CASE("not_conserved: lost energy is wrong, with every method", "[verification][defects]") {
  const std::string file = scene_file("not_conserved", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
               {"name": "b", "rod": {"mass": 1, "from": [1, 0, 0], "to": [2, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [1, 0, 0]}],
    "run": {"until": 2, "output": 0.1, "record": ["b.x"]})");
  Scene scene = read_scene(file);
  scene.run.step = 0.01;
  for (const auto& [method, wrong] : {std::pair{"semi_implicit_euler", true}, {"rk4", false}}) {
    INFO(method);
    scene.run.integrator = {.type = method};
    const SweepRun run = sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()));
    CHECK(run.steps == 200);
    CHECK(run.wrong == wrong);
    CHECK(run.wrong == (run.imbalance > scene.run.limits.energy));
    CHECK(run.outcome() == (wrong ? "wrong" : "ok"));
    const Called r = call("run " + file + " --no-picture --step 0.01 --integrator " + method);
    INFO(r.text);
    CHECK(r.exit == (wrong ? 9 : 0));
    CHECK(contains(r.text, "energy-not-conserved: ") == wrong);
  }
}

// 7 N for 2e-5 s on 2 kg: 7e-5 m/s, by constant rates between the jumps.
TEST_CASE("pulse: a force by a formula of time ends steps at its jumps", "[verification][defects]") {
  const std::string file = scene_file("pulse", R"x("bodies": [{"name": "b", "particle": 2}],
    "links": [{"name": "G", "type": "point_on_line", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x"}],
    "forces": [{"name": "f", "type": "function_force", "link": "G", "coordinate": "z",
                "force": "=7*(t>0.25)-7*(t>0.25002)"}],
    "run": {"integrator": "rk4", "step": 0.001, "until": 1, "output": 0.1, "record": ["b.x", "b.vx"]})x");
  for (const char* method : {"rk4", "semi_implicit_euler", "rattle2", "generalized_alpha", "dopri5", "radau5"}) {
    INFO(method);
    const SceneRun run = run_scene(file, [&](RunSettings& r) { r.integrator = {.type = method}; });
    CHECK(run.table.last("b.vx") == Approx(7e-5).epsilon(1e-5));
    CHECK(run.table.last("b.x") == Approx(7e-5 * (0.75 - 1e-5)).margin(7e-5 * 2e-5));
    CHECK(run.report.steps <= 1006);
  }
}

TEST_CASE("a comparison of a force's formula that meets equality holds as just afterwards", "[verification][defects]") {
  const double after = 3 * (0.999 - 0.5);  // 3 N on 1 kg from 0.5 s to the end
  for (const auto& [formula, v] : {std::pair{"=3*(t>=0.5)", after},
                                   {"=3*(t>0.5)", after},
                                   {"=3*floor(2*t)", after},
                                   {"=3*max(0,sign(t-0.5))", after},
                                   {"=3*(t<=0.5)", 1.5},
                                   {"=3*(t<0.5)", 1.5},
                                   {"=3*(t>0)", 3 * 0.999}}) {
    INFO(formula);
    const std::string file = scene_file("equality", R"("bodies": [{"name": "b", "particle": 1}],
      "links": [{"name": "G", "type": "point_on_line", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x"}],
      "forces": [{"name": "f", "type": "function_force", "link": "G", "coordinate": "z", "force": ")" +
                                                        std::string(formula) + R"("}],
      "run": {"integrator": "rk4", "step": 0.1, "until": 0.999, "output": 0.1, "record": ["b.vx"]})");
    CHECK(run_scene(file).table.last("b.vx") == Approx(v).epsilon(1e-9));
  }
}

// v^2/2 = 2 ln(q/0.5).
TEST_CASE("force_before_assembly: no force is asked at poses that are not assembled", "[verification][defects]") {
  const std::string file = scene_file("force_before_assembly", R"(
    "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "G", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x",
               "start": {"position": {"z": 0.5}}}],
    "forces": [{"name": "f", "type": "function_force", "link": "G", "coordinate": "z", "force": "=2/q"}],
    "run": {"until": 1, "output": 0.1, "record": ["b.x", "b.vx"]})");
  for (const char* formulation : {"auto", "omega", "quaternion"}) {
    INFO(formulation);
    const SceneRun run = run_scene(
        file, [&](RunSettings& r) { r.formulation = formulation_from(formulation), r.solver = {.type = "dense"}; });
    CHECK(run.table["b.x"][0] == Approx(0.5).epsilon(1e-12));
    REQUIRE(run.table.n_rows() == 11);
    for (std::size_t i = 0; i < run.table.n_rows(); ++i) {
      const double q = run.table["b.x"][i], v = run.table["b.vx"][i];
      CHECK(0.5 * v * v == Approx(2 * std::log(q / 0.5)).margin(1e-6));
    }
    CHECK(run.report.steps < 60);
  }
  CHECK(call("run " + file + " --no-picture").exit == 0);
  CHECK(call("check " + file).exit == 0);
  const Called loop = call("run --no-picture " + scene_file("force_before_closing", R"(
    "bodies": [{"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
               {"name": "b", "rod": {"mass": 1, "from": [1, 0, 0], "to": [2, 0, 0]}},
               {"name": "c", "rod": {"mass": 1, "from": [2, 0, 0], "to": [3, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0],
               "start": {"position": {"rz": 0.5}}},
              {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [1, 0, 0]},
              {"name": "C", "type": "revolute", "p": "c", "s": "b", "at": [2, 0, 0]},
              {"name": "D", "type": "revolute", "p": "c", "s": "ground", "at_p": [3, 0, 0], "at_s": [1.5, 0, 0]}],
    "forces": [{"name": "f", "type": "function_force", "link": "A", "coordinate": "rz", "torque": "=0.1/q"}],
    "run": {"until": 0.1, "output": 0.1, "record": ["a.x"]})"));
  INFO(loop.text);
  CHECK(loop.exit == 0);
}

namespace {

constexpr std::array kQuaternion{"qw", "qx", "qy", "qz"};

/// The smallest product of a body's quaternions in rows that follow one another: below zero where the sign jumps.
double least_product(const Table& table, const std::string& body, const Quat& first) {
  const auto at = [&](std::size_t i) {
    std::array<double, 4> e{};
    for (std::size_t k = 0; k < 4; ++k) e[k] = table[body + "." + kQuaternion[k]][i];
    return Quat{e[0], e[1], e[2], e[3]};
  };
  double least = at(0).coefficients().dot(first.coefficients());
  for (std::size_t i = 1; i < table.n_rows(); ++i)
    least = std::min(least, at(i - 1).coefficients().dot(at(i).coefficients()));
  return least;
}

const std::string kSlide = R"("gravity": [0, 0, -9.81],
  "bodies": [{"name": "a", "box": {"mass": 1, "size": [0.1, 0.1, 0.1]}, "orientation": {"axis": "z", "angle": "120 deg"}}],
  "markers": [{"name": "P", "body": "a", "at": [0, 0, 0], "orientation": {"axis": "z", "angle": "120 deg"}},
              {"name": "S", "body": "ground", "at": [0, 0, 0], "orientation": {"axis": "z", "angle": "-120 deg"}}],
  "links": [{"name": "slide", "type": "prismatic", "p": "P", "s": "S"}],
  "run": {"until": 0.2, "output": 0.1, "record": ["a.qw", "a.qx", "a.qy", "a.qz"]})";

}  // namespace

TEST_CASE("quaternion_sign: the sign is that of the pose given", "[verification][defects]") {
  const Quat given = axis_angle(Vec3::UnitZ(), 2 * std::numbers::pi / 3);
  const SceneRun run = run_scene(scene_file("quaternion_sign", kSlide));
  CHECK(run.report.steps < 20);
  CHECK(least_product(run.table, "a", given) == Approx(1).epsilon(1e-12));
}

// Chains of all joints that a tree has, at markers turned by any angle, their poses with either sign.
TEST_CASE("a body's quaternion has one sign in every formulation", "[verification][defects]") {
  unsigned seed = 1;
  const auto number = [&] {
    seed = seed * 1664525U + 1013904223U;
    return static_cast<double>(seed >> 8) / double(1U << 24);
  };
  for (int trial = 0; trial < 40; ++trial) {
    INFO(trial);
    for (const Formulation formulation : {Formulation::joint, Formulation::omega}) {
      const unsigned before = seed;
      System sys;
      Body* last = &sys.ground();
      std::vector<Quat> homes;
      for (int k = 0; k < 4; ++k) {
        const auto turn = [&] {
          const Vec3 axis = Vec3(number() - 0.5, number() - 0.5, number() - 0.5).normalized();
          return axis_angle(axis, 4 * std::numbers::pi * number());
        };
        const std::string n = std::to_string(k);
        homes.push_back(turn());
        Body& body =
            sys.add_body("b" + n, {1, Vec3::Zero(), Vec3(1, 2, 2.5).asDiagonal()}, {Vec3(k, 0, 0), homes.back()});
        const Quat q = turn();
        Marker& P = sys.add_marker_at("P" + n, body, {Vec3(k, 0, 0), q});
        Marker& S = sys.add_marker_at("S" + n, *last, {Vec3(k, 0, 0), number() < 0.5 ? q : -q});
        switch ((trial + k) % 5) {
          case 0:
            sys.add<Prismatic>("L" + n, P, S);
            break;
          case 1:
            sys.add<Revolute>("L" + n, P, S);
            break;
          case 2:
            sys.add<Spherical>("L" + n, S, P);
            break;
          case 3:
            sys.add<Prismatic>("L" + n, S, P);
            break;
          default:
            sys.add<Cylindrical>("L" + n, S, P);
        }
        body.start.w = Vec3(0, 0, 0);
        last = &body;
      }
      sys.set_gravity(Vec3(0.3, -9.81, 1));
      Simulation run(sys, {.output = 0.01, .dynamics = {.formulation = formulation, .stabilization = {}}});
      for (int k = 0; k < 4; ++k)
        for (const char* c : kQuaternion) run.record({"b" + std::to_string(k) + "." + c});
      run.run_until(0.03);
      for (int k = 0; k < 4; ++k) {
        INFO("body " << k);
        CHECK(least_product(run.table(), "b" + std::to_string(k), homes[k]) > 0.9);
      }
      if (formulation == Formulation::joint) seed = before;
    }
  }
}

TEST_CASE("no_gradient: check ends as run does", "[verification][defects]") {
  const std::string file = scene_file("no_gradient", R"("gravity": [0, -9.81, 0],
    "parameters": {"a": "0.4 m", "b": "0.15 m"}, "bodies": [{"name": "bead", "particle": 0.7}],
    "links": [{"name": "wire", "type": "function", "p": "bead", "s": "ground", "at_s": [0, 0, 0],
               "phi": "=(x/a)^2 + (y/b)^2 - 1", "mask": "z"}],
    "run": {"until": 1, "output": 0.1, "record": ["bead.x"]})");
  const std::string word = "constraint phi of joint 'wire' has no gradient at the start";
  for (const char* verb : {"run", "check", "check --json"}) {
    INFO(verb);
    const Called r = call(std::string(verb) + " " + file);
    INFO(r.text);
    CHECK(r.exit == 5);
    CHECK(contains(r.text, word));
  }
  CHECK(call("check " + scene_file("mast", kMast)).exit == 0);
}

TEST_CASE("kinematics_energy: an integrated column is rejected if nothing is integrated", "[verification][defects]") {
  const std::string file = scene_file("kinematics_energy", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}}}],
    "run": {"until": 1, "output": 0.1, "record": ["rod.x", "energy.balance"]})");
  for (const char* verb : {"kinematics", "inverse"})
    check_refused(call(std::string(verb) + " " + file), 3,
                  {"\"energy.balance\" needs 'energy.drives'", "lockstep run"});
  CHECK(call("run --no-picture " + file).exit == 0);
}

// One of the recorded instants lies in a singular position.
TEST_CASE("a sweep reports the same doubts as a single run", "[verification][defects]") {
  const std::string file = paths::kSource + std::string("/tests/verification/defects/start_in_change_point.json");
  Scene scene = read_scene(file);
  scene.run.record = {{"A.force_on_p_link_x", "pull"}};
  scene.run.times = {0, 0.01, 0.1};
  const Registry& registry = builtin_registry();
  const Table columns = recorded_columns(scene, registry);
  const SweepRun run = sweep_run(scene, registry, columns);
  INFO(run.outcome());
  REQUIRE(run.findings.size() == 1);
  CHECK(run.outcome() == "ok; doubtful: " + run.findings[0].text());
  CHECK(run.findings[0].text().starts_with("the reactions at t = 0 s are uncertain"));
  scene.run.times.erase(scene.run.times.begin());
  CHECK(sweep_run(scene, registry, columns).outcome() == "ok");
}

// At this tolerance rounding leaves more beside the flat position.
TEST_CASE("a run of a sweep reports the tolerance that it did not reach", "[verification][defects]") {
  Scene scene = read_scene(paths::kSource + std::string("/tests/verification/scenes/parallelogram.json"));
  scene.run.tolerance.relative = 3e-16, scene.run.tolerance.atol_x = 1e-18, scene.run.until = 2.7;
  const Registry& registry = builtin_registry();
  const SweepRun run = sweep_run(scene, registry, recorded_columns(scene, registry));
  REQUIRE(run.findings.size() == 1);
  CHECK(contains(run.findings[0].text(), "the tolerance of 3e-16 was not reached in "));
}

// A rod that turns about one end at 1.5 rad/s is caught by the other: its angular momentum about that end stays,
// (1/12 - 1/4) m L^2 w = 1/3 m L^2 w'.
TEST_CASE("changes of joints within a rounding of one another are one change", "[verification][defects]") {
  const std::string text = R"("bodies": [{"name": "rod", "rod": {"mass": 3, "from": [0, 0, 0], "to": [0.8, 0, 0],
      "axial_inertia": 0.0001}, "omega_world": [0, 0, 1.5], "velocity": [0, 0.6, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]},
      {"name": "B", "type": "lock", "mask": "x y", "p": "rod", "s": "ground", "at_p": [0.8, 0, 0],
       "at_s": [0.4972879746165315, 0.6266615277019868, 0], "active": false}],)";
  const double after = 1.5 * (1.0 / 12 - 0.25) * 3, inertia = 3 * 0.8 * 0.8 / 3;
  const auto [opens, closes] =
      GENERATE(std::pair{"0.6", "0.5999999999999"}, std::pair{"0.5999999999999", "0.6"}, std::pair{"0.6", "0.6"});
  const auto method = GENERATE(as<std::string>(), "rk4", "dopri5", "dop853", "radau5");
  CAPTURE(method, opens, closes);
  const std::string events = R"("events": [{"name": "opens", "deactivate": ["A"], "at": )" + std::string(opens) +
                             R"(}, {"name": "closes", "activate": ["B"], "at": )" + closes + "}],";
  const SceneRun run = run_scene(
      scene_file(
          "swap",
          text + events + R"("run": {"until": 1, "output": 0.1, "record": ["rod.omega_world_z", "energy.kinetic"]})"),
      [&](RunSettings& settings) {
        settings.integrator = {method};
        if (method == "rk4") settings.step = 0.01;
      });
  CHECK(run.table["rod.omega_world_z"][5] == Approx(1.5).epsilon(1e-6));
  CHECK(run.table["rod.omega_world_z"].back() == Approx(after).epsilon(1e-6));
  CHECK(run.table["energy.kinetic"].back() == Approx(0.5 * inertia * after * after).epsilon(1e-6));
}

}  // namespace defects_dynamics_test
