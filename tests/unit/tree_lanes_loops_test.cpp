// SPDX-License-Identifier: BSD-3-Clause
// Copies of mechanisms with loops in joint coordinates, one per lane, against each mechanism alone in joint coordinates
// and in omega.
#include <cmath>
#include <functional>
#include <memory>

#include <lockstep/author/stepping.h>
#include <lockstep/batch.h>
#include <lockstep/error.h>
#include <lockstep/laws.h>
#include "framework/tools/batch/batch.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/lane_loops.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace tree_lanes_loops_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::loops::joint_dynamics;
using lockstep::testing::check_words;
using lockstep::testing::largest;
using lockstep::testing::message_of;

namespace {

/// A row of four-bars whose plane lies askew: in space, with redundant rows.
std::unique_ptr<System> askew_ladder(int bays, int k) {
  return ladder(bays, k, axis_angle(Vec3(1, 2, 3).normalized(), 0.7));
}

/// A four-bar with a pendulum on its coupler. Its cranks are driven: the first, and all `driven`, to this amplitude, rad.
std::unique_ptr<System> driven_four_bar(int k, int driven, double other = 0.3) {
  auto sys = ladder(1, 25 + k);
  Body& bob = sys->add_body("bob", {0.4 + 0.1 * k, Vec3::Zero(), Vec3(0.02, 0.03, 0.04).asDiagonal()},
                            {sys->body("bar 0").home.x + Vec3(0, 0, -0.5), {}});
  sys->add<Revolute>("pivot", bob, sys->body("bar 0"), pose_at(sys->body("bar 0").home.x, Vec3(0, 1, 0)));
  for (int i = 0; i < driven; ++i)
    static_cast<MarkerLock&>(*sys->links()[i]).drive(Axis::rz, laws::law([k, a = i == 0 ? 0.3 : other](auto t) {
                                                       return a * sin((1.0 + 0.1 * k) * t);
                                                     }));
  return sys;
}

}  // namespace

// A ring of six bodies and the ground, all of whose joints hold the same: as many rows as they have freedoms, or less. Where
// they hold all turns, one of them leaves the turns.
TEST_CASE("vectorised loops accelerate as alone: every mask, in both directions", "[unit][copies]") {
  int taken = 0, compared = 0;
  for (int mask = 1; mask < 63; ++mask)
    for (const bool reversed : {false, true}) {
      const auto all = static_cast<Mask>(mask);
      Family family = random_family(6, [&](inputs::RandomMechanism& m) {
        for (int i = 0; i <= 6; ++i) {
          const Mask rows = i == 3 && includes(all, Mask::e123) ? Mask::x | Mask::y : all;
          const unsigned laws = i != 2 && i != 6 ? 0U
                                                 : (overlaps(rows, Mask::xyz) ? oracle::kP : 0U) |
                                                       (overlaps(rows, Mask::e123) ? oracle::kQD : 0U);
          const int a = i - 1, b = i < 6 ? i : -1;
          reversed ? m.link(b, a, rows, laws) : m.link(a, b, rows, laws);
        }
      });
      ++taken;
      INFO("mask " << mask << ", reversed " << reversed);
      const RateDifferences worst = differences(family, 1e-4, anywhere);
      CHECK(worst.joint < 1e-10);
      CHECK(worst.omega < 1e-10);
      compared += worst.n;
    }
  CHECK(taken == 2 * 62);
  CHECK(compared > 7 * taken);
}

TEST_CASE("vectorised loops accelerate as alone: in a plane, askew, driven, crossing", "[unit][copies]") {
  const auto check = [](Family family) {
    const RateDifferences worst = differences(family, 1e-4, consistent);
    CHECK(worst.n == static_cast<int>(family.systems.size()));
    CHECK(worst.joint < 1e-10);
    CHECK(worst.omega < 1e-10);
  };
  SECTION("a row of four-bars") {
    check(Family(8, [](int k) { return ladder(3, k); }));
  }
  SECTION("in a mechanism that is planar") {
    check(Family(5, [](int k) {
      auto sys = ladder(2, k);
      sys->set_planar(Plane{1});
      return sys;
    }));
  }
  SECTION("askew: in space, with redundant rows") {
    check(Family(8, [](int k) { return askew_ladder(2, k); }));
  }
  SECTION("both cranks driven: rows that laws hold twice") {
    check(Family(8, [](int k) { return driven_four_bar(k, 2); }));
  }
  SECTION("loops that cross, branches, a particle") {
    Family family = random_family(
        6,
        [](inputs::RandomMechanism& m) {
          m.link(0, -1, Mask::xyz);
          m.link(1, 0, Mask::xyz);
          m.link(1, 2, Mask::xyz | Mask::e1 | Mask::e2);
          m.link(3, 1, Mask::xyz);
          m.link(4, 3, Mask::x | Mask::y | Mask::e123);
          m.link(5, 2, Mask::xyz);
          m.link(5, 4, Mask::x | Mask::e3);  // a loop
          m.link(-1, 5, Mask::y | Mask::z);  // over the ground, by the other's side
          m.link(3, 0, Mask::e1);            // inside of it
          m.link(6, 4, Mask::x | Mask::y);   // the particle: no joint of the tree
        },
        1);
    const RateDifferences worst = differences(family, 1e-4, anywhere);
    CHECK(worst.n >= 7);
    CHECK(worst.joint < 1e-10);
    CHECK(worst.omega < 1e-10);
  }
}

TEST_CASE("loops by plain x86-64, FMA and AVX-512 agree", "[unit][copies]") {
  int compared = 0;
  for (const Instructions set : {Instructions::plain, Instructions::fma, Instructions::avx512}) try {
      Family family(8, [](int k) { return ladder(2, k); });
      const RateDifferences worst = differences(family, 1e-4, consistent, set);
      CHECK(worst.n == 8);
      CHECK(worst.joint < 1e-10);
      ++compared;
    } catch (const ModelError& absent) {
      check_words(absent.what(), {"this processor has no"});
    }
  CHECK(compared >= 1);
}

namespace {

// A bar of which one point slides on a line of the ground and another one on a line of a crank; both turn any way.
std::unique_ptr<System> bead(int k) {
  auto s = std::make_unique<System>(System::Options{Vec3(0.1 * k, -9.81, 0)});
  const MassProperties mass{1.0 + 0.1 * k, Vec3::Zero(), Vec3(0.08, 0.07, 0.06).asDiagonal()};
  Body &bar = s->add_body("bar", mass, {Vec3(0.5, 0, 0), {}}),
       &crank = s->add_body("crank", mass, {Vec3(1, 0.2, 0), {}});
  s->add<PointOnLine>("bead", bar, s->ground(), pose_at(Vec3::Zero(), Vec3::UnitX()));
  s->add<Revolute>("pivot", crank, s->ground(), pose_at(Vec3(1, 0.5, 0)));
  s->add<PointOnLine>("end", bar, crank, pose_at(Vec3(1, 0, 0), Vec3(1, 1, 0)));
  return s;
}

}  // namespace

TEST_CASE("vectorised loops are projected as alone", "[unit][copies]") {
  const auto make = GENERATE(
      as<std::function<std::unique_ptr<System>(int)>>{}, [](int k) { return ladder(2, k); },
      [](int k) { return askew_ladder(2, k); }, bead);
  constexpr double dq = 1e-5, dv = 1e-3;
  Family family(8, make);
  const std::unique_ptr<lanes::Batch> batch = batch_of(family);
  Aligned<double> y(batch->n_numbers());
  std::vector<State> states;
  lanes::Flags8 wanted{};
  for (std::size_t k = 0; k < 8; ++k) {
    Dynamics dynamics = joint_dynamics(*family.systems[k]);
    states.push_back(consistent(dynamics, 0));
    states[k].q += dq * VecX::Random(states[k].q.size());
    states[k].v += dv * VecX::Random(states[k].v.size());
    states[k].coordinates->normalize(states[k]);
    batch->put(static_cast<int>(k), states[k], y.data());
    wanted[k] = k != 5;
  }
  std::array<lanes::Landing, lanes::kLanes> landed;
  batch->project(y.data(), {}, wanted, landed);
  for (std::size_t k = 0; k < 8; ++k) {
    INFO(family.systems[k]->links().front()->name() << ", copy " << k);
    Dynamics dynamics = joint_dynamics(*family.systems[k]);
    State own = family.systems[k]->start(), lane = own;
    dynamics.to_formulation(own);
    own.q = states[k].q, own.v = states[k].v, lane = own;
    batch->get(static_cast<int>(k), y.data(), lane);
    if (!wanted[k]) {
      CHECK(largest(lane.q - own.q) < 1e-15);
      CHECK(largest(lane.v - own.v) == 0);
      continue;
    }
    CHECK(landed[k].converged);
    CHECK(landed[k].velocities_met);
    CHECK(landed[k].before == Approx(dynamics.project(own).before).epsilon(1e-9));
    CHECK(dynamics.violation(lane) < 1e-12);
    CHECK(dynamics.violation_v(lane) <= 1.1 * dynamics.violation_v(own) + 1e-12);
    CHECK(largest(lane.q - own.q) < dq * dq);
    CHECK(largest(lane.v - own.v) < 10 * dq * dv);  // in lanes the factor is that of the pose before
  }
}

TEST_CASE("instances with loops run vectorised as they run alone", "[unit][copies]") {
  const auto method = GENERATE(as<std::string>{}, "dop853", "dopri5", "rk4");
  const auto what = GENERATE(as<std::string>{}, "row", "askew", "driven");
  CAPTURE(method, what);
  Family family(10, [&](int k) {
    if (what == "driven") return driven_four_bar(k, 1);
    return what == "askew" ? askew_ladder(2, 25 + k) : ladder(2, 25 + k);  // they hang, far from flat
  });
  check_lanes_against_alone(family, method, 0.6, {.q = 1e-9, .v = 1e-8, .violation = 1e-10});
}

TEST_CASE("an instance with contradictory loops is reported by name, the others continue", "[unit][copies]") {
  Family family(8, [](int k) { return driven_four_bar(k, 2, k == 2 ? 0.2 : 0.3); });
  std::vector<State> starts = family.starts();
  for (std::size_t k = 0; k < 8; ++k)
    if (k != 2) Dynamics(*family.systems[k], std::make_unique<SchurSolver>()).project(starts[k]);
  CopiesOptions options;
  options.formulation = Formulation::joint;
  const RunEnds ends = ends_of(family, starts, 0.5, options, true);
  for (std::size_t k = 0; k < 8; ++k) {
    CAPTURE(k, ends.reports[k].error);
    CHECK(ends.reports[k].finished == (k != 2));
  }
  CHECK(ends.reports[2].t == 0);
  check_words(ends.reports[2].error, {"the start", "foot"});
}

TEST_CASE("pivots of vectorised loops are those of any plane", "[unit][copies]") {
  std::vector<double> smallest;
  for (const Vec3& axis : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)}) {  // the normal is y, z, x
    const Quat turn = axis.isZero() ? Quat() : axis_angle(axis, kPi / 2);
    Family family(8, [&](int k) { return ladder(2, k, turn); });
    const auto batch = batch_of(family);
    batch->watch_pivots();
    Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
    for (int k = 0; k < 8; ++k) {
      State state = family.assembled()[k];
      batch->to_batch(k, state);
      batch->put(k, state, y.data());
    }
    batch->evaluate(y.data(), {}, rate.data());
    for (std::size_t k = 0; k < 8; ++k) smallest.push_back(batch->smallest_pivot(k));
  }
  for (std::size_t k = 0; k < 8; ++k)
    for (const std::size_t other : {8 + k, 16 + k}) CHECK(smallest[other] == Approx(smallest[k]).epsilon(1e-9));
  CHECK(smallest[0] < 1);
}

TEST_CASE("loops of different layout are rejected", "[unit][copies]") {
  Family family(2, [](int k) { return k == 0 ? ladder(1, 0) : askew_ladder(1, 0); });
  CopiesOptions options;
  options.formulation = Formulation::joint;
  check_words(message_of<ModelError>([&] { Copies c(family.pointers(), options); }), {"ordered differently"});
}

}  // namespace tree_lanes_loops_test
