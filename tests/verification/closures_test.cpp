// SPDX-License-Identifier: BSD-3-Clause
// Loops in joint coordinates: links beside the tree stay rows. Accelerations against omega, the choice of the tree,
// projections.
#include <algorithm>
#include <filesystem>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "tests/support/catch.h"
#include "tests/support/loops.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/random_bodies.h"
#include "tests/support/run_scene.h"

namespace closures_test {

using namespace lockstep;
using loops::joint_dynamics, loops::ladder, loops::Loops, loops::random_loops, loops::row_of_four_bars;
using testing::accelerations, testing::Draw, testing::largest, testing::random_inertia, testing::random_pose;

namespace {

/// The scenes of a folder of the sources, by file name.
std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> all;
  for (const auto& file : std::filesystem::directory_iterator(std::string(paths::kSource) + "/" + folder))
    if (file.path().extension() == ".json") all.push_back(file.path().string());
  std::ranges::sort(all);
  return all;
}

std::vector<std::pair<std::string, bool>> scenes_in_space_and_plane(const std::string& folder) {
  std::vector<std::pair<std::string, bool>> all;
  for (const std::string& path : scenes_in(folder)) all.push_back({path, false}), all.push_back({path, true});
  return all;
}

/// Largest difference of accelerations at a state, relative to the largest; `report`: of the joint coordinates. With laws
/// in the tree of the coordinates' own, which alone do not make up the slots' accelerations.
double difference(Dynamics& dynamics, const State& state, SolveReport& report) {
  StateRate rate;
  report = dynamics.rates_with_report(state, rate);
  if (!state.coordinates->followed().empty()) {
    State slots = state;
    dynamics.to_slots(slots);
    StateRate of_slots;
    dynamics.rates(slots, of_slots);
    const VecX omega = loops::along_joints(dynamics.system(), state, of_slots.v);
    return largest(rate.v - omega) / std::max(1.0, largest(omega));
  }
  const VecX a = accelerations(dynamics, state, rate), omega = accelerations(dynamics, state);
  return largest(a - omega) / std::max(1.0, largest(omega));
}

/// Whether a rank-revealing decomposition finds another motion than omega: a singular position, or next to one.
bool is_singular(System& system, Dynamics& dynamics, const State& state) {
  if (system.n_slots() > 30) return false;
  Dynamics dense(system, std::make_unique<DenseSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  const VecX a = accelerations(dense, state), b = accelerations(dynamics, state);
  return largest(a - b) > 1e-3 * std::max(1.0, largest(b));
}

/// The most closures whose paths pass through one body, of a mechanism with links between two bodies.
int most_open(System& system) {
  system.setup();
  std::string why_not;
  const auto tree = JointTree::of(system, system.start().modes, why_not);
  REQUIRE(tree);
  std::vector<int> parent(system.n_slots(), kGround), depth = parent, open = parent;
  for (const TreeNode& n : tree->nodes()) {
    const auto slot = static_cast<std::size_t>(n.slot);
    parent[slot] = n.parent < 0 ? kGround : tree->nodes()[n.parent].slot;
    depth[slot] = n.parent < 0 ? 0 : 1 + depth[parent[slot]];
    open[slot] = 0;
  }
  const auto depth_of = [&](int slot) { return slot == kGround ? -1 : depth[slot]; };
  for (const int link : tree->closures()) {
    const auto [p, s] = system.links()[link]->pairs().front();
    int a = p->body->slot, b = s->body->slot;
    while (a != b) {
      int& deeper = depth_of(a) >= depth_of(b) ? a : b;
      ++open[deeper];
      deeper = parent[deeper];
    }
  }
  return *std::ranges::max_element(open);
}

}  // namespace

TEST_CASE("scenes with loops accelerate in joint coordinates as in omega", "[verification][joint]") {
  int checked = 0, checked_flat = 0;
  for (const char* folder : {"samples/scenes", "samples/scenes/overconstrained"})
    for (const auto& [path, flat] : scenes_in_space_and_plane(folder)) {
      CAPTURE(path, flat);
      Scene scene = read_scene(path);
      if (!flat) scene = in_space(std::move(scene));
      scene.run.formulation = Formulation::joint;
      Mechanism m = build_mechanism(scene, builtin_registry());
      Dynamics dynamics = joint_dynamics(system_of(m));
      if (!dynamics.why_not_joint(m.system.start().modes).empty()) continue;
      State start = m.system.start();
      if (m.run.assemble) assemble(dynamics, start, m.start_speeds, m.assembly);
      dynamics.to_formulation(start);
      REQUIRE(start.coordinates);
      if (!start.coordinates->has_rows() || !start.coordinates->followed().empty() || flat != bool(m.system.plane()))
        continue;
      Draw draw(7);
      for (int n = 0; n < 4; ++n) {
        CAPTURE(n);
        State state = start;
        if (n > 0) {  // other velocities, another position
          for (double& v : state.v) v += 0.3 * draw.number(-1, 1);
          dynamics.project_velocity(state);
          dynamics.advance(state, 0.05 * n, state.v);
        }
        if (!dynamics.project(state, 0).converged) continue;
        dynamics.project(state, 0);
        CHECK(dynamics.violation(state) < 1e-12 * std::max(1.0, dynamics.system().length()));
        SolveReport report;
        const double error = difference(dynamics, state, report);
        // An error of the position on the constraints grows as the indicator falls, and where velocities are left that
        // redundant rows do not allow.
        const double left = dynamics.violation_v(state);
        CAPTURE(report.residual, report.detector, left);
        if (report.detector < 1e-6 || is_singular(system_of(m), dynamics, state)) continue;
        CHECK(error < 1e-10 + 10 * left + 1e-13 / report.detector);
        ++(flat ? checked_flat : checked);
      }
    }
  CHECK(checked > 100);
  CHECK(checked_flat > 15);
}

TEST_CASE("random loops accelerate in joint coordinates as in omega, whichever tree is chosen",
          "[verification][joint]") {
  int moving = 0, driven_flat = 0, others = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Plane plane = seed % 2 == 0 ? Plane{} : Plane{static_cast<int>(seed % 3)};
    const bool driven = seed > 120;
    CAPTURE(seed, plane.n, driven);
    Loops loops{.more = 1 + static_cast<int>(seed % (driven ? 2 : 4)), .plane = plane, .driven = driven};
    System system = random_loops(seed, loops);
    loops.backward = true;
    System other = random_loops(seed, loops);
    Dynamics dynamics = joint_dynamics(system), turned = joint_dynamics(other);
    if (!dynamics.why_not_joint(system.start().modes).empty()) continue;
    State state = system.start();
    Draw draw(seed);
    dynamics.to_formulation(state);
    REQUIRE(state.coordinates);
    for (double& v : state.v) v = draw.number(-1, 1);
    const double left = dynamics.project_velocity(state);
    CAPTURE(left, state.v.size());
    if (driven && left > 1e-9) continue;  // the law moves what the loops hold
    CHECK(dynamics.violation_v(state) < 1e-11);
    SolveReport report;
    CHECK(difference(dynamics, state, report) < 1e-10);
    if (driven && plane) ++(state.coordinates->followed().empty() ? others : driven_flat);
    if (largest(state.v) > 1e-3) ++moving;

    State there = state;
    dynamics.to_slots(there);
    const VecX a = dynamics.evaluate(there).a;
    turned.to_formulation(there);
    REQUIRE(there.coordinates);
    StateRate rate;
    turned.rates(there, rate);
    CHECK(difference(turned, there, report) < 1e-10);
    if (driven) continue;
    const VecX b = accelerations(turned, there, rate), expected = accelerations(dynamics, state);
    CHECK(largest(b - expected) < 1e-9 * std::max(1.0, largest(expected)));
  }
  CHECK(moving > 90);
  CHECK(driven_flat > 10);
}

TEST_CASE("projections in joint coordinates are those of omega", "[verification][joint]") {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Plane plane = seed <= 20 ? Plane{} : Plane{static_cast<int>(seed % 3)};
    CAPTURE(seed, plane.n);
    System system = random_loops(seed, {.bodies = 6, .more = 2, .plane = plane});
    Dynamics dynamics = joint_dynamics(system);
    if (!dynamics.why_not_joint(system.start().modes).empty()) continue;
    State state = system.start();
    Draw draw(seed);
    dynamics.to_formulation(state);
    for (double& v : state.v) v = draw.number(-1, 1);
    State slots = state;
    dynamics.to_slots(slots);
    State of_joint = state, of_slots = slots;
    dynamics.project_velocity(of_joint), dynamics.project_velocity(of_slots);
    dynamics.to_slots(of_joint);
    CHECK(largest(of_joint.v - of_slots.v) < 1e-9 * std::max(1.0, largest(of_slots.v)));  // least in the mass metric

    // Off the constraints by about d: both moves are the least ones, but for the square of d.
    const double d = 1e-5;
    of_joint = state;
    dynamics.advance(of_joint, d, state.v);
    of_slots = of_joint;
    dynamics.to_slots(of_slots);
    const State off = of_slots;
    CHECK(dynamics.project(of_joint, 0).converged);
    CHECK(dynamics.project(of_slots, 0).converged);
    dynamics.to_slots(of_joint);
    CHECK(largest(of_joint.q - of_slots.q) < 100 * d * d);
    if (largest(of_slots.q - off.q) > 0.01 * d) ++checked;
  }
  CHECK(checked > 20);
}

TEST_CASE("redundant constraints that differ off the manifold are kept so, contradictions are named",
          "[verification][joint]") {
  // Sarrus' linkage: three of ten rows are redundant where hinges are parallel, which a step along the rates is off by 1e-7.
  Scene scene = read_scene(std::string(paths::kSource) + "/samples/scenes/overconstrained/sarrus_three.json");
  scene.run.formulation = Formulation::joint;
  Mechanism m = build_mechanism(scene, builtin_registry());
  Dynamics dynamics = joint_dynamics(system_of(m));
  State state = m.system.start();
  assemble(dynamics, state, m.start_speeds, m.assembly);
  dynamics.to_formulation(state);
  REQUIRE(state.coordinates);
  dynamics.project(state, 0);
  StateRate rate;
  CHECK(dynamics.rates_with_report(state, rate).residual <= 1e-12);
  const VecX on = rate.v;
  Draw draw(3);
  for (double& q : state.q) q += 1e-7 * draw.number(-1, 1);
  const SolveReport off = dynamics.rates_with_report(state, rate);
  CHECK(off.residual > 1e-10);
  CHECK(off.residual < 1e-4);
  CHECK(largest(rate.v - on) < 1e-3 * std::max(1.0, largest(on)));

  // A door on two hinges whose laws differ by a factor of two, with a knob that is free.
  System s({.gravity = Vec3(0, 0, -9.81)});
  Body &door = s.add_body("door", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0})),
       &knob = s.add_body("knob", shapes::rod(0.1, {1, 0, 0}, {1.1, 0, 0}));
  auto& low = s.add<Revolute>("low", door, s.ground(), pose_at(Vec3(0, 0, 0)));
  auto& high = s.add<Revolute>("high", door, s.ground(), pose_at(Vec3(0, 0, 1)));
  s.add<Revolute>("axle", knob, door, pose_at(Vec3(1, 0, 0)));
  low.drive(Axis::rz, laws::polynomial({0.0, 0.0, 1.0}));
  high.drive(Axis::rz, laws::polynomial({0.0, 0.0, 2.0}));
  Dynamics two = joint_dynamics(s);
  State shut = s.start();
  two.to_formulation(shut);
  REQUIRE(shut.coordinates);
  testing::check_words(testing::message_of<SolveError>([&] { two.rates(shut, rate); }), {"contradicts the others"});
}

TEST_CASE("auto uses joint coordinates in loops if operation counts are lower", "[verification][joint]") {
  const auto why = [](const std::string& file, bool reads) {
    Mechanism m = build_mechanism(in_space(read_scene(file)), builtin_registry());
    struct Reader final : Auxiliary {
      Reader() : Auxiliary("reader") {}
      int size() const override { return 1; }
      void rates(const Evaluated&, std::span<double> sd) const override { sd[0] = 0; }
    };
    if (reads) system_of(m).add(std::make_unique<Reader>());
    Dynamics automatic(system_of(m), std::make_unique<SchurSolver>(), {});
    return automatic.why_not_joint(m.system.start().modes);
  };
  const std::string delta = std::string(paths::kSource) + "/samples/scenes/overconstrained/delta.json";
  CHECK(why(scene_path("four_bar"), false).empty());
  CHECK(why(scene_path("nfourbar_40"), false).empty());
  testing::check_words(why(scene_path("stewart"), false), {"joint coordinates need ", " operations, omega "});
  testing::check_words(why(delta, false), {"joint coordinates need ", " operations, omega "});
  testing::check_words(why(scene_path("four_bar"), true), {"reader", "read accelerations or reactions"});
}

namespace {

/// A four-bar of hinges about z at four heights, lying, whose bodies are turned any way; the last hinge may be another link.
template <class Last>
System lying_four_bar(Last&& last) {
  System s({.gravity = Vec3(0.2, 0.1, -9.81)});
  Draw draw(11);
  const auto bar = [&](const char* name, const Vec3& a, const Vec3& b) -> Body& {
    return s.add_body(name, {draw.number(0.5, 2), Vec3::Zero(), random_inertia(draw)},
                      {Vec3(0.5 * (a + b)), random_pose(draw).q});
  };
  const Vec3 A(0, 0, 0.1), B(0.2, 0.4, -0.3), C(1.3, 0.7, 0.2), D(1, 0, 0);
  Body &crank = bar("crank", A, B), &coupler = bar("coupler", B, C), &rocker = bar("rocker", C, D);
  s.add<Revolute>("A", crank, s.ground(), pose_at(A));
  s.add<Revolute>("B", s.body("coupler"), crank, pose_at(B));
  s.add<Revolute>("D", rocker, s.ground(), pose_at(D));
  last(s, coupler, rocker, C);
  return s;
}

}  // namespace

TEST_CASE("constraints normal to the plane of a tree are removed from its loop closures", "[verification][joint]") {
  const auto rows = [](System& s) {
    s.setup();
    return lay_out_tree(s, s.start().modes, Taken::all).closures.n_rows;
  };
  const auto hinge = [](const Vec3& axis) {
    return [axis](System& s, Body& a, Body& b, const Vec3& at) { s.add<Revolute>("C", a, b, pose_at(at, axis)); };
  };
  System flat = lying_four_bar(hinge(Vec3::UnitZ()));
  CHECK(rows(flat) == 2);
  Dynamics dynamics = joint_dynamics(flat);
  State state = flat.start();
  dynamics.to_formulation(state);
  REQUIRE(state.coordinates);
  Draw draw(5);
  for (int n = 0; n < 5; ++n) {
    for (double& v : state.v) v = draw.number(-2, 2);
    dynamics.project_velocity(state);
    dynamics.advance(state, 0.1, state.v);
    REQUIRE(dynamics.project(state, 0).converged);
    CHECK(dynamics.violation(state) < 1e-12);
    SolveReport report;
    CHECK(difference(dynamics, state, report) < 1e-11);
  }
  // An axis that is tilted, a slide along the normal by a law, and a hinge that is too high: nothing is left out.
  System tilted = lying_four_bar(hinge(Vec3(1e-5, 0, 1)));
  CHECK(rows(tilted) == 5);
  System lifted = lying_four_bar([](System& s, Body& a, Body& b, const Vec3& at) {
    s.add<GenericLock>("C", a, b, pose_at(at), Mask::x | Mask::y).drive(Axis::z, laws::polynomial({0.0, 1.0}));
  });
  CHECK(rows(lifted) == 3);
  System high = lying_four_bar([](System& s, Body& a, Body& b, const Vec3& at) {
    Marker &p = s.add_marker("p", a, {Vec3(rotation(a.home.q).transpose() * (at - a.home.x)), conjugate(a.home.q)}),
           &q = s.add_marker(
               "q", b,
               {Vec3(rotation(b.home.q).transpose() * (at - b.home.x + Vec3(0, 0, 1e-3))), conjugate(b.home.q)});
    s.add<GenericLock>("C", p, q, Mask::xyz | Mask::e1 | Mask::e2);
  });
  CHECK(rows(high) == 5);
}

TEST_CASE("few closures are open at a time in ladders and in chains of four-bars", "[verification][joint]") {
  for (const auto& [n, plane] : {std::pair(5, -1), {60, -1}, {5, 2}, {60, 2}}) {
    CAPTURE(n, plane);
    System row = row_of_four_bars(n), up = ladder(n);
    row.set_planar(Plane{plane}), up.set_planar(Plane{plane});
    CHECK(most_open(row) <= 2);
    CHECK(most_open(up) <= 3);
    for (System* system : {&row, &up}) {
      Dynamics dynamics = joint_dynamics(*system);
      State state = system->start();
      dynamics.to_formulation(state);
      REQUIRE(state.coordinates);
      for (double& v : state.v) v = 0.3;
      dynamics.project_velocity(state);
      SolveReport report;
      CHECK(difference(dynamics, state, report) < 1e-10);
    }
  }
}

}  // namespace closures_test
