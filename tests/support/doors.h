// SPDX-License-Identifier: BSD-3-Clause
// A door on two hinges whose axes nearly agree, the model that decides its rows and runs it, the distance of motions.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include "tests/support/worst.h"

namespace lockstep::doors {

using Names = std::vector<std::string>;

/// Turned and moved in the world.
struct Frame {
  Vec3 x = Vec3::Zero();
  Quat q{};
};

inline std::vector<Frame> frames(int n) {
  std::minstd_rand random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Frame> all(1);
  for (int k = 1; k < n; ++k) {
    const Vec3 x(number(random), number(random), number(random));
    const Quat q{number(random), number(random), number(random), number(random)};
    all.push_back({x, normalized(q)});
  }
  return all;
}

/// A mechanism in a frame, and all that runs it.
struct Model {
  System system;
  std::unique_ptr<Dynamics> dynamics;
  std::vector<NearDependency> near;
  State start;
  Frame frame;

  Pose at(const Vec3& x, const Vec3& z = Vec3::UnitZ()) const {
    const Pose here = pose_at(x, z);
    return Pose{frame.x, frame.q} * here;
  }
  Vec3 turned(const Vec3& v) const { return rotation(frame.q) * v; }

  void begin(NearlyRedundant choice, const std::string& solver) {
    RunSettings settings;
    settings.solver = {solver};
    dynamics = std::make_unique<Dynamics>(system, make_solver(settings, builtin_registry()),
                                          DynamicsOptions{Formulation::omega, {}});
    start = system.start();
    near = decide_nearly_redundant(system, *dynamics, start, choice);
    start = system.start();
    assemble(*dynamics, start);
  }
  SimulationReport run(double until, State& end, const std::string& method = "dop853", double step = 0,
                       const std::vector<Event>& events = {}) {
    RunSettings settings;
    settings.integrator = {method};
    settings.step = step;
    settings.tolerance = {1e-10, 1e-12};
    StepLoop loop(*dynamics, make_integrator(settings, builtin_registry()),
                  {.step = step, .tolerance = settings.tolerance, .max_steps = 3000});
    for (const Event& event : events) loop.add_event(event);
    loop.set_state(start);
    const SimulationReport report = loop.run_until(until);
    end = loop.state();
    dynamics->to_slots(end);
    return report;
  }
};

inline constexpr double kApart = 1e-7;  // m, of the hinges' axes
inline constexpr double kMass = 20, kSideways = 2;

/// A door on two hinges, or on the lower one alone; it falls to the side.
inline std::unique_ptr<Model> door(const Frame& frame, bool both) {
  auto out = std::make_unique<Model>();
  Model& m = *out;
  m.frame = frame;
  m.system.set_gravity(m.turned({0, kSideways, -9.81}));
  const Vec3 J = kMass / 12 * Vec3(0.04 * 0.04 + 4, 0.9 * 0.9 + 4, 0.9 * 0.9 + 0.04 * 0.04);
  const MassProperties mass{kMass, Vec3::Zero(), J.asDiagonal()};
  Body& body = m.system.add_body("door", mass, m.at({0.45, 0, 1}));
  body.start.v = m.turned({0, 0.45, 0}), body.start.w = {0, 0, 1};
  m.system.add<Revolute>("low", body, m.system.ground(), m.at({0, 0, 0.2}));
  if (both) m.system.add<Revolute>("high", body, m.system.ground(), m.at({kApart, 0, 1.8}));
  return out;
}

/// How far two motions are apart, m and in turns since their starts, seen from their frames.
inline double distance(const System& a, const State& at, const Frame& frame, const System& b, const State& other) {
  double most = 0;
  const Mat3 F = rotation(frame.q);
  for (const Body& body : a.bodies()) {
    if (body.fixed) continue;
    const Body& same = b.body(body.name);
    const Pose ours = body_pose(body, at), theirs = body_pose(same, other);
    const Mat3 turn = rotation(ours.q) * rotation(body.home.q).transpose(),
               other_turn = rotation(theirs.q) * rotation(same.home.q).transpose();
    keep_worst(most, (F.transpose() * (ours.x - frame.x) - theirs.x).norm());
    keep_worst(most, (F.transpose() * turn * F - other_turn).norm());
  }
  return most;
}

inline const Names kSolvers = {"schur", "block", "sparse", "dense"};

}  // namespace lockstep::doors
