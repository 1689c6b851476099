// SPDX-License-Identifier: BSD-3-Clause
// Copies of mechanisms with loops in joint coordinates, one per lane: their rates and runs beside those of each alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/stepping.h>
#include <lockstep/batch.h>
#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include "framework/tools/batch/batch.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/loops.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace lockstep::test {

using loops::joint_dynamics;
using testing::largest;

inline std::unique_ptr<lanes::Batch> batch_of(Family& family, Instructions set = Instructions::best) {
  CopiesOptions options;
  options.instructions = set, options.formulation = Formulation::joint;
  const std::vector<System*> systems = family.pointers();
  for (System* system : systems) system->setup();
  auto batch = std::make_unique<lanes::Batch>(systems, 0, options);
  return batch;
}

/// Largest differences of the rates in lanes from those of each mechanism alone at the same coordinates, relative to the
/// largest rate of their kind; and how many copies were compared.
struct RateDifferences {
  double joint = 0, omega = 0;
  int n = 0;
};
/// State k in joint coordinates: state_of(dynamics, k). Singular positions, where a pivot is below `least`, are left out.
template <class StateOf>
RateDifferences differences(Family& family, double least, StateOf&& state_of, Instructions set = Instructions::best) {
  const std::unique_ptr<lanes::Batch> batch = batch_of(family, set);
  batch->watch_pivots();
  Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
  std::vector<State> states;
  lanes::Numbers8 t{};
  for (std::size_t k = 0; k < family.systems.size(); ++k) {
    Dynamics dynamics = joint_dynamics(*family.systems[k]);
    states.push_back(state_of(dynamics, static_cast<int>(k)));
    t[k] = states[k].t;
    batch->put(static_cast<int>(k), states[k], y.data());
  }
  const lanes::Flags8 failed = batch->evaluate(y.data(), t, rate.data());
  RateDifferences worst;
  for (std::size_t k = 0; k < family.systems.size(); ++k) {
    if (!(batch->smallest_pivot(k) > least)) continue;
    CHECK_FALSE(failed[k]);
    ++worst.n;
    Dynamics dynamics = joint_dynamics(*family.systems[k]);
    State own = family.systems[k]->start();
    dynamics.to_formulation(own);
    own.t = states[k].t, own.q = states[k].q, own.v = states[k].v;
    StateRate truth, found = sized_like(own);
    dynamics.rates(own, truth);
    State as_state = own;
    batch->get(static_cast<int>(k), rate.data(), as_state);
    found.q = as_state.q, found.v = as_state.v, found.s = as_state.s;
    for (const auto part : {&StateRate::q, &StateRate::v, &StateRate::s})
      keep_worst(worst.joint, largest(found.*part - truth.*part) / std::max(1.0, largest(truth.*part)));
    keep_worst(worst.joint, std::abs(batch->largest_a(k) - truth.largest_a) / std::max(1.0, truth.largest_a));
    keep_worst(worst.joint,
               std::abs(batch->largest_alpha(k) - truth.largest_alpha) / std::max(1.0, truth.largest_alpha));
    State slots = own;
    dynamics.to_slots(slots);
    Dynamics omega(*family.systems[k], std::make_unique<SchurSolver>(), {Formulation::omega, {}});
    StateRate of_slots;
    omega.rates(slots, of_slots);
    const VecX by_omega = loops::along_joints(*family.systems[k], own, of_slots.v);
    keep_worst(worst.omega, largest(found.v - by_omega) / std::max(1.0, largest(by_omega)));
  }
  return worst;
}

/// Away from the start, with any velocities.
inline State anywhere(Dynamics& dynamics, int k) {
  State s = dynamics.system().start();
  dynamics.to_formulation(s);
  s.t = 0.1 * k;
  s.q += 0.4 * VecX::Random(s.q.size()), s.v.setRandom();
  s.coordinates->normalize(s);
  return s;
}
/// On the constraints.
inline State consistent(Dynamics& dynamics, int k) {
  State s = dynamics.system().start();
  s.t = 0.1 * k;
  assemble(dynamics, s);
  dynamics.to_formulation(s);
  s.q += 0.05 * VecX::Random(s.q.size()), s.v.setRandom();
  s.coordinates->normalize(s);
  dynamics.project(s);  // from 0.05 rad it needs more rounds than one projection has
  CHECK(dynamics.project(s, 1e-12).converged);
  return s;
}

inline RunEnds ends_of(Family& family, const std::vector<State>& starts, double t, CopiesOptions options, bool lanes) {
  options.lanes = lanes;
  return ends_of(family, starts, t, options);
}

/// How far runs in lanes may be from those of each copy alone.
struct RunMargins {
  double q, v, violation;
  long steps = 0;
};
/// Runs the copies by a method along joints, in lanes and alone, and compares them.
inline void check_lanes_against_alone(Family& family, const std::string& method, double until, const RunMargins& most) {
  const std::vector<State> starts = family.assembled();
  CopiesOptions options;
  options.formulation = Formulation::joint, options.integrator = method, options.tolerance = {1e-9, 1e-11};
  options.step = method == "rk4" ? 1e-3 : 0;
  const RunEnds lanes = ends_of(family, starts, until, options, true),
                alone = ends_of(family, starts, until, options, false);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    INFO(k << ": " << lanes.reports[k].error);
    REQUIRE(lanes.reports[k].finished);
    CHECK_FALSE(lanes.reports[k].alone);
    CHECK(std::abs(lanes.reports[k].steps - alone.reports[k].steps) <= most.steps);
    CHECK(largest(lanes.states[k].q - alone.states[k].q) < most.q);
    CHECK(largest(lanes.states[k].v - alone.states[k].v) < most.v);
    CHECK(largest(lanes.states[k].z - alone.states[k].z) < most.q);
    Dynamics dynamics(*family.systems[k], std::make_unique<SchurSolver>());
    CHECK(dynamics.violation(lanes.states[k]) < most.violation);
  }
  CHECK(largest(lanes.states[0].q - lanes.states[7].q) > 1e-3);  // they are not all the same
}

}  // namespace lockstep::test
