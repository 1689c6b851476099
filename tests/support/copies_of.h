// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Families of mechanisms of one topology and different numbers, for the copies.

#include <memory>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/batch.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/mechanism.h"

namespace lockstep::test {

/// Every member is made by `make(k)`, k = 0, 1, ...
struct Family {
  std::vector<std::unique_ptr<System>> systems;
  template <class Make>
  Family(int n, Make&& make) {
    for (int k = 0; k < n; ++k) systems.push_back(make(k));
  }
  std::vector<System*> pointers() const {
    std::vector<System*> out;
    for (const auto& s : systems) out.push_back(s.get());
    return out;
  }
  std::vector<State> starts() const {
    std::vector<State> out;
    for (const auto& s : systems) s->setup(), out.push_back(s->start());
    return out;
  }
  std::vector<State> assembled() const {
    std::vector<State> out = starts();
    for (std::size_t k = 0; k < out.size(); ++k) {
      Dynamics dynamics(*systems[k], std::make_unique<SchurSolver>());
      assemble(dynamics, out[k]);
    }
    return out;
  }
};

/// How runs of a family end.
struct RunEnds {
  std::vector<State> states;
  std::vector<CopyReport> reports;
};
/// Runs that go along joints, to the time t.
inline RunEnds ends_of(Family& family, const std::vector<State>& starts, double t, const CopiesOptions& options) {
  Copies copies(family.pointers(), options);
  RunEnds out;
  out.states.resize(starts.size());
  const std::vector<double> times{t};
  out.reports = copies.run(starts, times, [&](int k, std::size_t, const State& s) { out.states[k] = s; });
  return out;
}

/// Eight random mechanisms by their links; alike but for all numbers.
template <class Links>
Family random_family(int bodies, Links&& links, int particles = 0) {
  return Family(8, [&](int k) {
    inputs::RandomMechanism m(static_cast<std::uint64_t>(100 + k), Vec3(0.1 * k, -1, -9));
    for (int i = 0; i < bodies; ++i) m.add_body();
    for (int i = 0; i < particles; ++i) m.add_particle();
    links(m);
    return std::make_unique<System>(std::move(m.system));
  });
}

/// Chain of n rods that hang on hinges, each about an axis that is turned against the one before by `twist`, rad.
inline std::unique_ptr<System> chain(int n, int k, double twist = 0.0) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0.1 * k, 0, -9.81)});
  Body* before = &sys->ground();
  for (int i = 0; i < n; ++i) {
    const double x = i, mass = 1.0 + 0.1 * k + 0.05 * i;
    Body& rod = sys->add_body("rod " + std::to_string(i),
                              {mass, Vec3::Zero(), (mass * Vec3(0.02 + 0.01 * k, 0.09, 0.1 + 0.01 * k)).asDiagonal()},
                              {Vec3(x + 0.5, 0, 0), Quat{}});
    const double angle = twist * i;
    sys->add<Revolute>("hinge " + std::to_string(i), rod, *before,
                       pose_at(Vec3(x, 0, 0), Vec3(std::sin(angle), std::cos(angle), 0)));
    before = &rod;
  }
  return sys;
}

/// Row of four-bars, `bays` of them, in the plane of x and z; in space its rows are redundant. All of it is turned by
/// `turn`: it then lies askew.
inline std::unique_ptr<System> ladder(int bays, int k, const Quat& turn = {}) {
  const Mat3 A = rotation(turn);
  auto sys = std::make_unique<System>(System::Options{A * Vec3(0, 0, -9.81)});
  const Vec3 axis = A * Vec3(0, 1, 0);
  const double tilt = 0.3 + 0.1 * k, c = std::cos(tilt), s = std::sin(tilt);
  std::vector<Body*> uprights;
  const auto rod = [&](const std::string& name, const Vec3& middle) -> Body& {
    const double m = 1.0 + 0.1 * k;
    return sys->add_body(name, {m, Vec3::Zero(), (m * Vec3(0.08, 0.09, 0.1)).asDiagonal()}, {A * middle, turn});
  };
  const auto hinge = [&](const std::string& name, Body& p, Body& on, const Vec3& at) {
    sys->add<Revolute>(name, p, on, pose_at(A * at, axis));
  };
  for (int i = 0; i <= bays; ++i) {
    uprights.push_back(&rod("upright " + std::to_string(i), Vec3(i + 0.5 * s, 0, 0.5 * c)));
    hinge("foot " + std::to_string(i), *uprights.back(), sys->ground(), Vec3(i, 0, 0));
  }
  for (int i = 0; i < bays; ++i) {
    Body& bar = rod("bar " + std::to_string(i), Vec3(i + 0.5 + s, 0, c));
    hinge("left " + std::to_string(i), bar, *uprights[i], Vec3(i + s, 0, c));
    hinge("right " + std::to_string(i), bar, *uprights[i + 1], Vec3(i + 1 + s, 0, c));
  }
  return sys;
}

}  // namespace lockstep::test
