// Loops in joint coordinates: links beside the tree stay rows. Accelerations against omega, the choice of the tree,
// projections, runs.
#include <cmath>
#include <filesystem>

#include <lockstep/assembly.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/registry.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include <lockstep/sweep.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/paths.h"
#include "tests/support/random_bodies.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace closures_test {

using namespace lockstep;
using testing::accelerations, testing::Draw, testing::largest, testing::random_inertia, testing::random_pose;

namespace {

Dynamics joint_dynamics(System& system) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
}

/// The scenes of a folder of the sources, by file name.
std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> all;
  for (const auto& file : std::filesystem::directory_iterator(std::string(paths::kSource) + "/" + folder))
    if (file.path().extension() == ".json") all.push_back(file.path().string());
  std::ranges::sort(all);
  return all;
}

/// Largest difference of accelerations at a state, relative to the largest; `report`: of the joint coordinates.
double difference(Dynamics& dynamics, const State& state, SolveReport& report) {
  StateRate rate;
  report = dynamics.rates_with_report(state, rate);
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

/// A pair of markers at one place of the world, on two bodies as they are drawn.
std::pair<Marker*, Marker*> markers_at(System& system, const std::string& name, Body& a, Body& b, const Pose& world) {
  const auto on = [&](Body& body) {
    const Pose& at = body.home;
    return Pose{rotation(at.q).transpose() * (world.x - at.x), conjugate(at.q) * world.q};
  };
  return {&system.add_marker(name + "_a", a, on(a)), &system.add_marker(name + "_b", b, on(b))};
}

/// n bodies at random places, each on the ground or on an earlier one by a lock of a random mask, and links between
/// random ones beside them, of any mask; all hold as the bodies are drawn. `backward`: the links in the reverse order.
System random_loops(std::uint64_t seed, int n, int more, bool backward = false) {
  Draw draw(seed);
  System system({.gravity = {0.3, -9.81, 1.2}});
  std::vector<Body*> bodies{&system.ground()};
  const auto any = [&](std::size_t among) { return static_cast<std::size_t>(draw.number(0, 0.999) * double(among)); };
  struct Between {
    std::string name;
    Body *a, *b;
    Pose at;
    Mask mask;
  };
  std::vector<Between> links;
  for (int k = 0; k < n; ++k) {
    const std::string name = std::to_string(k);
    bodies.push_back(
        &system.add_body("body" + name, {draw.number(0.5, 2), Vec3::Zero(), random_inertia(draw)}, random_pose(draw)));
    static constexpr Mask kJoints[] = {Mask::xyz, Mask::xyz | Mask::e1 | Mask::e2, Mask::x | Mask::y | Mask::e123,
                                       Mask::x | Mask::y | Mask::z | Mask::e2 | Mask::e3};
    links.push_back(
        {"joint" + name, bodies.back(), bodies[any(bodies.size() - 1)], random_pose(draw), kJoints[any(4)]});
  }
  for (int k = 0; k < more; ++k) {
    const std::size_t a = any(bodies.size()), b = (a + 1 + any(bodies.size() - 1)) % bodies.size();
    const auto mask = Mask(1 + static_cast<unsigned>(any(63)));
    links.push_back({"closure" + std::to_string(k), bodies[a], bodies[b], random_pose(draw), mask});
  }
  if (backward) std::ranges::reverse(links);
  for (const Between& l : links) {
    const auto [p, s] = markers_at(system, l.name, *l.a, *l.b, l.at);
    system.add<GenericLock>(l.name, *p, *s, l.mask);
  }
  return system;
}

/// n bays of parallel four-bars on the ground.
System row_of_four_bars(int n) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  const Vec3 up(std::cos(1.2), std::sin(1.2), 0);
  const auto rod = [&](const std::string& name, const Vec3& middle) -> Body& {
    return s.add_body(name, {1.0, Vec3::Zero(), Vec3(0.01, 0.08, 0.08).asDiagonal()}, {middle, {}});
  };
  std::vector<Body*> uprights;
  for (int i = 0; i <= n; ++i) {
    uprights.push_back(&rod("upright" + std::to_string(i), Vec3(i, 0, 0) + 0.5 * up));
    s.add<Revolute>("foot" + std::to_string(i), *uprights.back(), s.ground(), pose_at(Vec3(i, 0, 0)));
  }
  for (int i = 0; i < n; ++i)
    for (int end = 0; end < 2; ++end) {
      const std::string name = std::to_string(i);
      if (end == 0) rod("bar" + name, Vec3(i + 0.5, 0, 0) + up);
      s.add<Revolute>((end ? "right" : "left") + name, s.body("bar" + name),
                      *uprights[static_cast<std::size_t>(i + end)], pose_at(Vec3(i + end, 0, 0) + up));
    }
  return s;
}

/// Two uprights of n rods each, and n rungs between them.
System ladder(int n) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  const auto rod = [&](const std::string& name, const Vec3& middle) -> Body& {
    return s.add_body(name, {1.0, Vec3::Zero(), Vec3(0.08, 0.08, 0.08).asDiagonal()}, {middle, {}});
  };
  Body *left = &s.ground(), *right = &s.ground();
  for (int i = 0; i < n; ++i) {
    const std::string k = std::to_string(i);
    Body &l = rod("left" + k, Vec3(0, i + 0.5, 0)), &r = rod("right" + k, Vec3(1, i + 0.5, 0)),
         &rung = rod("rung" + k, Vec3(0.5, i + 1, 0));
    s.add<Revolute>("on_left" + k, l, *left, pose_at(Vec3(0, i, 0)));
    s.add<Revolute>("on_right" + k, r, *right, pose_at(Vec3(1, i, 0)));
    s.add<Revolute>("rung_left" + k, rung, l, pose_at(Vec3(0, i + 1, 0)));
    s.add<Revolute>("rung_right" + k, rung, r, pose_at(Vec3(1, i + 1, 0)));
    left = &l, right = &r;
  }
  return s;
}

/// The most closures whose paths pass through one body, of a mechanism with links between two bodies.
int most_open(System& system) {
  system.setup();
  std::string why_not;
  const auto tree = JointTree::of(system, system.start().modes, why_not, Closures::rows);
  REQUIRE(tree);
  std::vector<int> parent(static_cast<std::size_t>(system.n_slots()), kGround), depth = parent, open = parent;
  for (const TreeNode& n : tree->nodes()) {
    const auto slot = static_cast<std::size_t>(n.slot);
    parent[slot] = n.parent < 0 ? kGround : tree->nodes()[static_cast<std::size_t>(n.parent)].slot;
    depth[slot] = n.parent < 0 ? 0 : 1 + depth[static_cast<std::size_t>(parent[slot])];
    open[slot] = 0;
  }
  const auto depth_of = [&](int slot) { return slot == kGround ? -1 : depth[static_cast<std::size_t>(slot)]; };
  for (const int link : tree->closures()) {
    const auto [p, s] = system.links()[static_cast<std::size_t>(link)]->pairs().front();
    int a = p->body->slot, b = s->body->slot;
    while (a != b) {
      int& deeper = depth_of(a) >= depth_of(b) ? a : b;
      ++open[static_cast<std::size_t>(deeper)];
      deeper = parent[static_cast<std::size_t>(deeper)];
    }
  }
  return *std::ranges::max_element(open);
}

}  // namespace

TEST_CASE("scenes with loops accelerate in joint coordinates as in omega", "[verification][joint]") {
  int checked = 0;
  for (const char* folder : {"samples/scenes", "tests/verification/scenes/overconstrained"})
    for (const std::string& path : scenes_in(folder)) {
      CAPTURE(path);
      Scene scene = read_scene(path);
      scene.run.formulation = Formulation::joint;
      Mechanism m = build_mechanism(scene, builtin_registry());
      Dynamics dynamics = joint_dynamics(m.system);
      if (!dynamics.why_not_joint(m.system.start().modes).empty()) continue;
      State start = m.system.start();
      if (m.run.assemble) assemble(dynamics, start, m.start_speeds, m.assembly);
      dynamics.to_formulation(start);
      REQUIRE(start.coordinates);
      if (!start.coordinates->has_rows() || start.coordinates->has_laws()) continue;
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
        if (report.detector < 1e-6 || is_singular(m.system, dynamics, state)) continue;
        CHECK(error < 1e-10 + 10 * left + 1e-13 / report.detector);
        ++checked;
      }
    }
  CHECK(checked > 100);
}

TEST_CASE("random loops accelerate in joint coordinates as in omega, whichever tree is chosen",
          "[verification][joint]") {
  int moving = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    System system = random_loops(seed, 8, 1 + static_cast<int>(seed % 4)),
           other = random_loops(seed, 8, 1 + static_cast<int>(seed % 4), true);
    Dynamics dynamics = joint_dynamics(system), turned = joint_dynamics(other);
    if (!dynamics.why_not_joint(system.start().modes).empty()) continue;
    State state = system.start();
    Draw draw(seed);
    dynamics.to_formulation(state);
    REQUIRE(state.coordinates);
    for (double& v : state.v) v = draw.number(-1, 1);
    dynamics.project_velocity(state);
    CHECK(dynamics.violation_v(state) < 1e-11);
    SolveReport report;
    CHECK(difference(dynamics, state, report) < 1e-10);
    if (largest(state.v) > 1e-3) ++moving;

    State there = state;
    dynamics.to_slots(there);
    const VecX a = dynamics.evaluate(there).a;
    turned.to_formulation(there);
    REQUIRE(there.coordinates);
    StateRate rate;
    turned.rates(there, rate);
    const VecX b = accelerations(turned, there, rate), expected = accelerations(dynamics, state);
    CHECK(largest(b - expected) < 1e-9 * std::max(1.0, largest(expected)));
  }
  CHECK(moving > 30);
}

TEST_CASE("projections in joint coordinates are those of omega", "[verification][joint]") {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    System system = random_loops(seed, 6, 2);
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
  CHECK(checked > 10);
}

TEST_CASE("a loop that its closing link drives moves in joint coordinates as in omega, also by Baumgarte's terms",
          "[verification][joint]") {
  const auto run = [](Formulation formulation, Stabilization::Kind kind, double& work, double& drift) {
    System s({.gravity = Vec3(0, -9.81, 0)});
    const auto rod = [&](const std::string& name, const Vec3& from, const Vec3& to) -> Body& {
      return s.add_body(name, shapes::rod(1.0, from, to));
    };
    Body &crank = rod("crank", {0, 0, 0}, {0, 0.4, 0}), &coupler = rod("coupler", {0, 0.4, 0}, {1, 0.8, 0}),
         &rocker = rod("rocker", {1, 0.8, 0}, {1, 0, 0});
    s.add<Revolute>("A", crank, s.ground(), pose_at(Vec3(0, 0, 0)));
    s.add<Revolute>("B", coupler, crank, pose_at(Vec3(0, 0.4, 0)));
    auto& closing = s.add<Revolute>("D", rocker, s.ground(), pose_at(Vec3(1, 0, 0)));
    s.add<Spherical>("C", rocker, coupler, pose_at(Vec3(1, 0.8, 0)));
    closing.drive(Axis::rz, laws::polynomial({0.0, 0.0, 0.5}));
    Recorder recorder(s);
    recorder.add(make_channel(s, "D.drive.work"));
    Stabilization stabilization{kind};
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = stabilization});
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-11, 1e-11}});
    State start = s.start();
    assemble(dynamics, start);
    loop.set_state(start);
    loop.run_until(0.5);
    State end = loop.state();
    work = end.s[0], drift = dynamics.violation(end);
    CHECK((end.coordinates != nullptr) == (formulation == Formulation::joint));
    dynamics.to_slots(end);
    return end;
  };
  for (const Stabilization::Kind kind : {Stabilization::Kind::project, Stabilization::Kind::baumgarte}) {
    double work = 0, expected = 0, drift = 0, omega_drift = 0;
    const State joint = run(Formulation::joint, kind, work, drift),
                omega = run(Formulation::omega, kind, expected, omega_drift);
    CHECK(largest(joint.v - omega.v) < 1e-8);
    CHECK(std::abs(work - expected) < 1e-8);
    CHECK(std::abs(expected) > 0.01);
    CHECK(drift < 1e-9);
  }
}

TEST_CASE("a look aside leaves nothing behind in joint coordinates either", "[verification][joint]") {
  const auto run = [](bool looks) {
    Scene scene = read_scene(scene_path("nfourbar_2"));
    scene.run.formulation = Formulation::joint;
    Mechanism m = build_mechanism(scene, builtin_registry());
    Dynamics dynamics = joint_dynamics(m.system);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-8, 1e-8}});
    State start = m.system.start();
    assemble(dynamics, start, m.start_speeds, m.assembly);
    loop.set_state(start);
    long steps = 0;
    while (loop.state().t < 2) {
      loop.step(), ++steps;
      if (!looks) continue;
      const Dynamics::Aside aside(dynamics);
      State beside = loop.state();  // flat, where rows fade
      StateRate rate;
      for (double& q : beside.q) q = 0;
      dynamics.rates_with_report(beside, rate);
    }
    return std::pair(steps, loop.state().q);
  };
  const auto [steps, q] = run(false);
  const auto [watched_steps, watched_q] = run(true);
  CHECK(watched_steps == steps);
  CHECK(watched_q == q);
}

TEST_CASE("few closures are open at a time in ladders and in rows of four-bars", "[verification][joint]") {
  for (const int n : {5, 60}) {
    CAPTURE(n);
    System row = row_of_four_bars(n), up = ladder(n);
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

TEST_CASE("ten flat positions are passed in joint coordinates as in omega", "[verification][joint]") {
  const auto run = [&](Formulation formulation) {
    return run_scene(scene_path("nfourbar_2"), [&](RunSettings& s) {
      s.integrator = {"dop853"}, s.tolerance = {1e-9, 1e-9}, s.formulation = formulation;
    });
  };
  const SceneRun omega = run(Formulation::omega), joint = run(Formulation::joint);
  for (const ColumnError& e : compare(joint.table, omega.table)) {
    CAPTURE(e.name);
    if (e.name.find("_dd") == std::string::npos) CHECK(e.error < 1e-6 * std::max(1.0, e.size));
  }
}

TEST_CASE("a step with closures allocates nothing", "[verification][joint]") {
  System system = row_of_four_bars(4);
  system.setup();
  Dynamics dynamics = joint_dynamics(system);
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  State start = system.start();
  start.v[5] = 0.5;
  dynamics.project_velocity(start);
  loop.set_state(start);
  for (int i = 0; i < 20; ++i) loop.step();
  REQUIRE(loop.state().coordinates);
  const long before = allocations();
  for (int i = 0; i < 10; ++i) loop.step();
  CHECK(allocations() == before);
}

}  // namespace closures_test
