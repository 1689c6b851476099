// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms with loops that hold as they are drawn: random ones, rows of four-bars, ladders; their joint coordinates.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/dynamics/tree/tree_recursion.h"
#include "tests/support/random_bodies.h"

namespace lockstep::loops {

using testing::Draw, testing::random_inertia, testing::random_pose;

/// The accelerations of joint coordinates at a state, of those of its slots, 6 per slot: what joints do not allow is lost.
inline VecX along_joints(const System& system, const State& state, const VecX& of_slots) {
  TreeLayout layout = lay_out_tree(system, state.modes, Taken::all);
  const auto recursion = TreeRecursion::of(layout.tree, system, std::move(layout.fronts));
  std::vector<Motion> motions;
  VecX along;
  recursion->outward(state, motions);
  recursion->read_off(motions, of_slots, along);
  return along;
}

/// A pair of markers at one place of the world, on two bodies as they are drawn.
inline std::pair<Marker*, Marker*> markers_at(System& system, const std::string& name, Body& a, Body& b,
                                              const Pose& world) {
  const auto on = [&](Body& body) {
    const Pose& at = body.home;
    return Pose{rotation(at.q).transpose() * (world.x - at.x), conjugate(at.q) * world.q};
  };
  return {&system.add_marker(name + "_a", a, on(a)), &system.add_marker(name + "_b", b, on(b))};
}

struct Loops {
  int bodies = 8, more = 1;
  bool backward = false;  ///< the links in the reverse order
  Plane plane{};          ///< without one in space
  bool driven = false;    ///< one joint of the tree has a law, and a bead that is free otherwise hangs on a body
};

/// Bodies at random places, each on the ground or on an earlier one by a lock of a random mask, and links between
/// random ones beside them, of any mask; all hold as the bodies are drawn.
inline System random_loops(std::uint64_t seed, const Loops& o) {
  Draw draw(seed);
  const auto flat = [&](Vec3 x) {
    if (o.plane) x[o.plane.n] = 0;
    return x;
  };
  const auto pose = [&] {
    Pose at = random_pose(draw);
    at.x = flat(at.x);
    if (o.plane) at.q = axis_angle(Vec3(Vec3::Unit(o.plane.n)), draw.number(-3, 3));
    return at;
  };
  const auto inertia = [&] {
    return o.plane ? Mat3(random_inertia(draw).diagonal().asDiagonal()) : random_inertia(draw);
  };
  System system({.gravity = flat({0.3, -9.81, 1.2})});
  system.set_planar(o.plane);
  std::vector<Body*> bodies{&system.ground()};
  const auto any = [&](std::size_t among) { return static_cast<std::size_t>(draw.number(0, 0.999) * double(among)); };
  struct Between {
    std::string name;
    Body *a, *b;
    Pose at;
    Mask mask;
  };
  std::vector<Between> links;
  for (int k = 0; k < o.bodies; ++k) {
    const std::string name = std::to_string(k);
    const double mass = draw.number(0.5, 2);
    const Mat3 J = inertia();
    bodies.push_back(&system.add_body("body" + name, {mass, Vec3::Zero(), J}, pose()));
    static constexpr Mask kJoints[] = {Mask::xyz, Mask::xyz | Mask::e1 | Mask::e2, Mask::x | Mask::y | Mask::e123,
                                       Mask::x | Mask::y | Mask::z | Mask::e2 | Mask::e3};
    links.push_back({"joint" + name, bodies.back(), bodies[any(bodies.size() - 1)], pose(), kJoints[any(4)]});
  }
  for (int k = 0; k < o.more; ++k) {
    const std::size_t a = any(bodies.size()), b = (a + 1 + any(bodies.size() - 1)) % bodies.size();
    const auto mask = Mask(1 + static_cast<unsigned>(any(63)));
    links.push_back({"closure" + std::to_string(k), bodies[a], bodies[b], pose(), mask});
  }
  if (o.driven) {
    Body& bead = system.add_particle("bead", 0.3, flat(random_pose(draw).x));
    links.push_back({"thread", &bead, bodies[3], {bead.home.x, {}}, Mask::x | Mask::y | Mask::z});
  }
  // The first joint with one freedom that stays in the plane.
  const auto turns = [](const Between& l) { return l.mask == (Mask::xyz | Mask::e1 | Mask::e2); };
  const auto slides = [](const Between& l) { return l.mask == (Mask::x | Mask::y | Mask::e123); };
  const auto stays = [&](const Between& l) {
    return (turns(l) && (!o.plane || o.plane.n == 2)) || (slides(l) && o.plane.n != 2);
  };
  const auto first = std::ranges::find_if(links, stays);
  const std::string driven = o.driven && first != links.end() ? first->name : "";
  if (o.backward) std::ranges::reverse(links);
  for (const Between& l : links) {
    const auto [p, s] = markers_at(system, l.name, *l.a, *l.b, l.at);
    auto& lock = system.add<GenericLock>(l.name, *p, *s, l.mask);
    if (l.name == driven) lock.drive(turns(l) ? Axis::rz : Axis::z, laws::polynomial({0.0, 0.7, -0.4}));
  }
  return system;
}

/// n bays of parallel four-bars on the ground.
inline System row_of_four_bars(int n) {
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
      s.add<Revolute>((end ? "right" : "left") + name, s.body("bar" + name), *uprights[i + end],
                      pose_at(Vec3(i + end, 0, 0) + up));
    }
  return s;
}

/// Two uprights of n rods each, and n rungs between them.
inline System ladder(int n) {
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

/// The system in joint coordinates.
inline Dynamics joint_dynamics(System& system) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
}

}  // namespace lockstep::loops
