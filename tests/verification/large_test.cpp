// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms of many bodies: what a body takes of the memory, and that the setup's work for it does not grow.
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/dynamics.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"

namespace large_test {

using namespace lockstep;

namespace {

// Names of one length: those of some lengths take memory of their own.
std::string numbered(const char* name, int k) { return name + std::to_string(100000 + k); }

Body& add_rod(System& s, int k, const Vec3& middle, double angle = 0) {
  return s.add_body(numbered("rod", k), {1.0, Vec3::Zero(), Vec3(0.01, 1.0 / 12, 1.0 / 12).asDiagonal()},
                    {middle, axis_angle(Vec3(0, 0, 1), angle)});
}

// Each rod hangs on one before it by a hinge, whose axes are z and y in turn: on the last one, or two on each.
System hung(int n, bool in_a_row) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  std::vector<Body*> rods{&s.ground()};
  for (int i = 0; i < n; ++i) {
    const double level = in_a_row ? i : std::floor(std::log2(i + 1.0)), y = in_a_row ? 0 : i + 1 - std::exp2(level);
    Body& parent = *rods[in_a_row ? i : (i + 1) / 2];
    rods.push_back(&add_rod(s, i, Vec3(level + 0.5, y, 0)));
    s.add<Revolute>(numbered("hinge", i), *rods.back(), parent,
                    pose_at(Vec3(level, y, 0), i % 2 == 1 ? Vec3(0, 1, 0) : Vec3(0, 0, 1)));
  }
  return s;
}

// Uprights with bars between their tops: as many loops, whose rows in space are redundant.
System ladder_of_rods(int n) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  const Vec3 up(std::cos(1.2), std::sin(1.2), 0);
  Body* last = nullptr;
  for (int i = 0; i < n / 2; ++i) {
    const Vec3 foot(i, 0, 0);
    Body& upright = add_rod(s, 2 * i, foot + 0.5 * up, 1.2);
    s.add<Revolute>(numbered("foot", i), upright, s.ground(), pose_at(foot));
    if (last != nullptr) {
      Body& bar = add_rod(s, 2 * i + 1, foot + up - Vec3(0.5, 0, 0));
      s.add<Revolute>(numbered("left", i), bar, *last, pose_at(foot + up - Vec3(1, 0, 0)));
      s.add<Revolute>(numbered("right", i), bar, upright, pose_at(foot + up));
    }
    last = &upright;
  }
  return s;
}

// The same with one rod across: the mechanism lies in no plane, and all of its redundant rows are rows of closures.
System ladder_in_space(int n) {
  System s = ladder_of_rods(n);
  Body& across = add_rod(s, 2 * n, Vec3(-0.5, 0, 0));
  s.add<Revolute>(numbered("across", 0), across, s.body(numbered("rod", 0)), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
  return s;
}

System large(const std::string& kind, int n) {
  if (kind == "ladder in space") return ladder_in_space(n);
  return kind == "ladder" ? ladder_of_rods(n) : hung(n, kind == "chain");
}

struct Taken {
  double bytes,       // in use after some steps of dopri5, a body
      allocations,    // of the setup, up to joint coordinates, a body
      built;          // of the description, a body
};

Taken taken_by(const std::string& kind, int n) {
  const double before = bytes_in_use();
  Taken taken{};
  const long built = allocations();
  System system = large(kind, n);
  const double bodies = static_cast<double>(system.bodies().size()) - 1;
  taken.built = static_cast<double>(allocations() - built) / bodies;
  const auto dynamics = [&] {
    auto made = std::make_unique<Dynamics>(system, std::make_unique<SchurSolver>());
    State start = system.start();
    made->to_formulation(start);
    CHECK(start.coordinates);
    return made;
  };
  std::unique_ptr<Dynamics> made;
  taken.allocations = static_cast<double>(allocations_of([&] { made = dynamics(); })) / bodies;
  StepLoop loop(*made, std::make_unique<Dopri5>());
  for (int k = 0; k < 3; ++k) loop.step(1e-3);
  CHECK(loop.report().steps == 3);
  CHECK_FALSE(made->holds_rows());
  taken.bytes = (bytes_in_use() - before) / bodies;
  return taken;
}

// Three steps of dopri5 after what it begins with.
struct Stepped {
  double bytes;  // in use at the end, a body
  double t;
  VecX q, v;  // along the joints
};

Stepped stepped(const std::string& kind, int n, const std::function<void(StepLoop&)>& begin) {
  const double before = bytes_in_use();
  System system = large(kind, n);
  const double bodies = static_cast<double>(system.bodies().size()) - 1;
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  begin(loop);
  CHECK(loop.state().coordinates);
  CHECK_FALSE(dynamics.holds_rows());
  for (int k = 0; k < 3; ++k) loop.step(1e-3);
  CHECK_FALSE(dynamics.holds_rows());
  const double bytes = (bytes_in_use() - before) / bodies;
  return {bytes, loop.state().t, loop.state().q, loop.state().v};
}

}  // namespace

TEST_CASE("a mechanism of many bodies takes few bytes a body, with its names, joints and dopri5", "[large]") {
  if (!allocations_are_counted()) return;  // a sanitizer owns the heap
  const auto [kind, most] = GENERATE(
      table<std::string, double>({{"chain", 3280}, {"tree", 3280}, {"ladder", 5060}, {"ladder in space", 7610}}));
  CAPTURE(kind);
  CHECK(taken_by(kind, 4000).bytes <= most);
}

TEST_CASE("the setup of a mechanism of many bodies asks for as much memory a body as that of few", "[large]") {
  if (!allocations_are_counted()) return;  // a sanitizer owns the heap
  const std::string kind = GENERATE("chain", "tree", "ladder");
  CAPTURE(kind);
  const Taken few = taken_by(kind, 400), many = taken_by(kind, 4000);
  CHECK(many.built <= 1.1 * few.built);
  CHECK(many.allocations <= 1.1 * few.allocations);
}

TEST_CASE("a run of many bodies that writes a checkpoint, or resumes one, takes no more memory than others",
          "[large]") {
  const std::string kind = GENERATE("chain", "ladder", "ladder in space");
  CAPTURE(kind);
  constexpr int kBodies = 1000;
  const auto three_steps = [](StepLoop& loop) {
    for (int k = 0; k < 3; ++k) loop.step(1e-3);
  };
  Snapshot saved;
  stepped(kind, kBodies, [&](StepLoop& loop) { three_steps(loop), loop.save(saved); });
  const Stepped plain = stepped(kind, kBodies, three_steps);
  const Stepped saving = stepped(kind, kBodies, [&](StepLoop& loop) {
    Snapshot own;
    three_steps(loop), loop.save(own);
  });
  const Stepped resumed = stepped(kind, kBodies, [&](StepLoop& loop) { loop.load(saved); });
  for (const Stepped* other : {&saving, &resumed}) {
    CHECK(other->t == plain.t);
    CHECK(other->q == plain.q);
    CHECK(other->v == plain.v);
    if (allocations_are_counted()) CHECK(other->bytes <= 1.05 * plain.bytes);
  }
}

}  // namespace large_test
