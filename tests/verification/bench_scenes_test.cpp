// SPDX-License-Identifier: BSD-3-Clause
// The scenes of the comparison with other engines: as their generator writes them, where the mechanisms say, and good
// for a short run that keeps its constraints.
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "tests/benchmark/peers/scenes.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace bench_scenes_test {

using namespace lockstep;

namespace {

std::string path_of(const peers::Mechanism& m) {
  return fmt::format("{}/tests/benchmark/scenes/{}.json", paths::kSource, peers::scene_name(m));
}

Scene scene_of(const peers::Mechanism& m) {
  if (std::filesystem::exists(path_of(m))) return read_scene(path_of(m));
  return scene_from_text(peers::scene_text(m), peers::scene_name(m));
}

}  // namespace

TEST_CASE("bench scenes on file are what their generator writes", "[verification][bench]") {
  int n_files = 0;
  for (const peers::Mechanism& m : peers::all_mechanisms()) {
    CAPTURE(m.name);
    CHECK((peers::is_generated(m) || std::filesystem::exists(path_of(m))));
    if (!peers::is_generated(m) || !std::filesystem::exists(path_of(m))) continue;
    std::ostringstream text;
    text << std::ifstream(path_of(m)).rdbuf();
    CHECK(text.str() == peers::scene_text(m));  // else: bin/peers/scenes tests/benchmark/scenes 10
    ++n_files;
  }
  CHECK(n_files == 7);
}

TEST_CASE("benchmark scenes start in the same poses as the mechanisms", "[verification][bench]") {
  const Registry registry = builtin_registry();
  for (const peers::Mechanism& m : peers::all_mechanisms()) {
    if (peers::n_bodies(m) > 100) continue;
    CAPTURE(m.name);
    const Mechanism mechanism = build_mechanism(scene_of(m), registry);
    CHECK(mechanism.system.gravity() == m.gravity);
    CHECK(mechanism.run.until == m.until);
    REQUIRE(mechanism.system.bodies().size() == std::size_t(peers::n_bodies(m) + 1));  // and the ground
    if (!peers::is_generated(m)) continue;
    const peers::Motions start = peers::start_of(m);
    CHECK(peers::largest_gap(m, start) < 1e-15);
    for (std::size_t k = 0; k < start.size(); ++k) {
      const Body& body = mechanism.system.bodies()[k + 1];
      const peers::Mass mass = peers::mass_of(m, static_cast<int>(k));
      CAPTURE(body.name);
      const Mat3 R = rotation(body.home.q);
      CHECK((body.home.x + R * body.mass.center - start[k].x).norm() < 1e-15);
      CHECK((R - start[k].R).norm() < 1e-15);
      CHECK(body.mass.mass == mass.mass);
      CHECK((body.mass.J.diagonal() - mass.J).norm() < 1e-15);
      if (m.kind == peers::Kind::slider_crank) continue;  // its velocities are left to the assembly
      CHECK((R * body.start.w - start[k].w).norm() < 1e-13);
      CHECK((body.start.v + R * cross(body.start.w, body.mass.center) - start[k].v).norm() < 1e-13);
    }
  }
}

TEST_CASE("bench scenes run and keep their constraints", "[verification][bench]") {
  const Registry registry = builtin_registry();
  for (const peers::Mechanism& m : peers::all_mechanisms()) {
    CAPTURE(m.name);
    Mechanism mechanism = build_mechanism(scene_of(m), registry);
    const RunSettings& run = mechanism.run;
    Dynamics dynamics(system_of(mechanism), make_solver(run, registry), {Formulation::omega, run.stabilization});
    State start = mechanism.system.start();
    const AssemblyReport assembled = assemble(dynamics, start, mechanism.start_speeds);
    CHECK(assembled.largest_move < 1e-12);
    StepLoop simulation(dynamics, make_integrator(run, registry), {.step = run.step, .tolerance = run.tolerance});
    simulation.set_state(start);
    const int n_steps = peers::n_bodies(m) > 100 ? 1 : 5;
    for (int i = 0; i < n_steps; ++i) simulation.step(m.until / 1e4);
    CHECK(simulation.state().t > 0);
    CHECK(simulation.report().largest_violation < 1e-9);
    CHECK(dynamics.violation_v(simulation.state()) < 1e-6);
  }
}

}  // namespace bench_scenes_test
