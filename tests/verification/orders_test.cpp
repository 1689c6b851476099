// SPDX-License-Identifier: BSD-3-Clause
// Error against step has the method's slope: on the heavy top (150 rad/s of spin, a spherical joint, projection every
// step), and for implicit methods on a chain and on a closed loop with redundant rows as well.
#include <algorithm>
#include <cmath>
#include <string>

#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace orders_test {

using namespace lockstep;

namespace {

/// Largest error of the top's centre over the first 0.2 s, m.
double error_of(const std::string& method, double h, Formulation formulation, const Table& truth) {
  const SceneRun run = run_scene(scene_path("heavy_top"), [&](RunSettings& s) {
    s.integrator = {method};
    if (method.starts_with("dop") || method == "radau5") s.integrator.keys = Value::object({{"fixed", true}});
    s.step = h;
    s.until = 0.2;
    s.formulation = formulation;
  });
  double worst = 0;
  for (const char* c : {"xc", "yc", "zc"})
    for (std::size_t i = 0; i < run.table.n_rows(); ++i) keep_worst(worst, std::abs(run.table[c][i] - truth[c][i]));
  return worst;
}

/// Three bars and the ground, four hinges in space: two rows of each loop are redundant. It falls from rest.
System four_bar() {
  System system({.gravity = {0, -9.81, 0}});
  const Vec3 B(0.09553364891256061, 0.029552020666133955, 0), C(0.2998630855218144, 0.24920966641274792, 0),
      D(0.28, 0, 0), z = Vec3::UnitZ();
  Body& crank = system.add_body("crank", shapes::rod(0.5, Vec3::Zero(), B));
  Body& coupler = system.add_body("coupler", shapes::rod(1.2, B, C));
  Body& rocker = system.add_body("rocker", shapes::rod(0.9, C, D));
  system.add<Revolute>("A", crank, system.ground(), pose_at(Vec3::Zero(), z));
  system.add<Revolute>("B", coupler, crank, pose_at(B, z));
  system.add<Revolute>("C", rocker, coupler, pose_at(C, z));
  system.add<Revolute>("D", rocker, system.ground(), pose_at(D, z));
  system.setup();
  return system;
}

/// Four rods with hinge axes z and y in turn, let go from the horizontal, the last one turning out of the plane.
System chain() {
  System system({.gravity = {0, -9.81, 0}});
  Body* last = &system.ground();
  for (int i = 0; i < 4; ++i) {
    const Vec3 from(0.4 * i, 0, 0), to(0.4 * (i + 1), 0, 0);
    const std::string n = std::to_string(i);
    Body& b = system.add_body("rod " + n, shapes::rod(1 + 0.2 * i, from, to));
    system.add<Revolute>("hinge " + n, b, *last, pose_at(from, i % 2 == 0 ? Vec3::UnitZ() : Vec3::UnitY()));
    last = &b;
  }
  last->start = {Vec3(0, 0, -0.2), Vec3(0, 1, 0)};  // about the fourth hinge
  system.setup();
  return system;
}

State end_of(System& system, Integrator& method, double T, int n) {
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State s = system.start();
  dynamics.project(s);
  method.begin(dynamics, s);
  for (int i = 0; i < n; ++i) method.step(dynamics, s, T / n);
  return s;
}

}  // namespace

TEST_CASE("measured orders on the heavy top are 1, 2, 4, 5 and 8", "[verification][integrators]") {
  struct Method {
    std::string name;
    double order, h;  // h: the coarser step, small enough that the leading term rules, large enough for round-off
  };
  const auto m = GENERATE(Method{"semi_implicit_euler", 1, 1e-4}, Method{"rk4", 4, 1e-3}, Method{"dopri5", 5, 5e-4},
                          Method{"dop853", 8, 5e-3}, Method{"generalized_alpha", 2, 2e-4}, Method{"radau5", 5, 1e-3});
  const Formulation formulation = GENERATE(Formulation::omega, Formulation::automatic);
  const Table truth = trusted("heavy_top");
  const double coarse = error_of(m.name, m.h, formulation, truth), fine = error_of(m.name, m.h / 2, formulation, truth);
  const double order = std::log2(coarse / fine);
  CAPTURE(m.name, to_string(formulation), coarse, fine, order);
  CHECK(std::abs(order - m.order) <= 0.15);
}

// Steps from one half of the first column to the other; the truth is dop853's at steps so small that its error is
// round-off.
TEST_CASE("implicit methods keep their orders on a chain and on a redundant loop", "[verification][integrators]") {
  const bool loop = GENERATE(false, true), radau = GENERATE(false, true);
  System system = loop ? four_bar() : chain();
  const double T = loop ? 0.5 : 0.4;
  const int n = radau ? (loop ? 100 : 20) : 400;
  Dop853 reference(true);
  const State truth = end_of(system, reference, T, 1000);
  double e_q[2], e_v[2];
  for (int i = 0; i < 2; ++i) {
    const std::unique_ptr<Integrator> method =
        radau ? std::unique_ptr<Integrator>(std::make_unique<Radau5>(true)) : std::make_unique<GeneralizedAlpha>(0.8);
    const State s = end_of(system, *method, T, n << i);
    e_q[i] = (s.q - truth.q).norm(), e_v[i] = (s.v - truth.v).norm();
  }
  CAPTURE(loop, radau, e_q[0], e_q[1], e_v[0], e_v[1]);
  CHECK(std::log2(e_q[0] / e_q[1]) == Approx(radau ? 5 : 2).margin(0.15));
  CHECK(std::log2(e_v[0] / e_v[1]) == Approx(radau ? 5 : 2).margin(0.15));
}

TEST_CASE("the error of radau5 follows the tolerance down to 1e-9 with slope one", "[verification][integrators]") {
  const std::string scene = GENERATE("chain_10", "double_pendulum");
  const Table truth = trusted(scene);
  const auto error_at = [&](double tolerance) {
    const SceneRun run = run_scene(scene_path(scene), [&](RunSettings& s) {
      s.integrator = {"radau5"};
      s.tolerance = {tolerance, 1e-2 * tolerance};
    });
    double worst = 0;  // angles of all rods; a rod's end is off by as much, times its length of 1 m
    for (const ColumnError& e : compare(run.table, truth))
      if (e.name.starts_with("q") && e.name.find('_') == std::string::npos) keep_worst(worst, e.error);
    return worst;
  };
  const double loose = error_at(1e-5), tight = error_at(1e-9), slope = std::log10(loose / tight) / 4;
  CAPTURE(scene, loose, tight, slope);
  CHECK(slope == Approx(1).margin(0.15));
  CHECK(tight < 1e-9);
}

}  // namespace orders_test
