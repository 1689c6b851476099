// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace runge_kutta_test {

using namespace lockstep;

namespace {

constexpr double kC[4] = {0, 0.5, 0.25, 1};
constexpr double kA[4][3] = {{}, {0.5}, {0, 0.25}, {0.7, 0, 0.3}};
constexpr double kB[4] = {0.1, 0, 0.4, 0.5};
constexpr Tableau kTableau{1, 4, 4, 3, kA[0], kB, kC};

/// Bodies thrown side by side, each with its own spin.
System thrown(int n_bodies) {
  System system(System::Options{{0.3, 0, -9.81}});
  for (int i = 0; i < n_bodies; ++i) {
    MassProperties m;
    m.mass = 1 + i;
    m.J = Vec3(0.4, 0.5, 0.7).asDiagonal();
    system.add_body("body " + std::to_string(i), m, {{0.1 * i, 0.2, 0.3}, {}}).start = {{1, -2, 3},
                                                                                        {1.0 + i, 0.4, 2.5}};
  }
  system.setup();
  return system;
}

}  // namespace

TEST_CASE("weights that are zero are left out", "[unit][integrators]") {
  const Weights w(kB, 4);
  REQUIRE(w.n == 3);
  CHECK((w.stage[0] == 0 && w.stage[1] == 2 && w.stage[2] == 3));
  CHECK((w.w[0] == 0.1 && w.w[1] == 0.4 && w.w[2] == 0.5));
}

// 7 and 6 numbers a body: blocks of eight and every length of the rest come by.
TEST_CASE("stages are combined as in the formula, for any number of values", "[unit][integrators]") {
  const int n_bodies = GENERATE(1, 2, 3, 4, 5, 6, 7, 8);
  CAPTURE(n_bodies);
  System system = thrown(n_bodies);
  Dynamics dynamics = dynamics_of(system);
  const State y = system.start();
  Stages stages;
  stages.begin(kTableau, y);
  const double h = 0.3;
  REQUIRE(stages.evaluate(dynamics, y, h, 0, 4));
  State end = y, expected = y;
  stages.end(y, h, end);
  StateRate sum = sized_like(y), expected_sum = sized_like(y);
  stages.sum(h, Weights(kB, 4), sum);
  for (int i = 0; i < 4; ++i) {
    expected_sum.q += h * kB[i] * stages.k(i).q;
    expected_sum.v += h * kB[i] * stages.k(i).v;
  }
  expected.q += expected_sum.q, expected.v += expected_sum.v;
  CHECK((end.q - expected.q).lpNorm<Eigen::Infinity>() <= 1e-15 * expected.q.lpNorm<Eigen::Infinity>());
  CHECK((end.v - expected.v).lpNorm<Eigen::Infinity>() <= 1e-15 * expected.v.lpNorm<Eigen::Infinity>());
  CHECK((sum.q - expected_sum.q).lpNorm<Eigen::Infinity>() <= 1e-15 * expected_sum.q.lpNorm<Eigen::Infinity>());
  CHECK((sum.v - expected_sum.v).lpNorm<Eigen::Infinity>() <= 1e-15 * expected_sum.v.lpNorm<Eigen::Infinity>());
  CHECK(end.t == y.t + h);
}

TEST_CASE("projected stages are those of the projected states", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  State y = pendulum.system.start();
  y.v << 0.3, -0.2, 0.1, 0.5, -1.0, 0.2;  // off the constraints
  y.q[1] += 1e-3;
  Stages plain, manifold;
  plain.begin(kTableau, y);
  manifold.begin(kTableau, y);
  REQUIRE(plain.evaluate(dynamics, y, 0, 0, 1));
  REQUIRE(manifold.evaluate(dynamics, y, 0, 0, 1, StagesOn::manifold));
  State on = y;
  REQUIRE(dynamics.project(on, 0).after < 1e-13);
  StateRate k = sized_like(y);
  dynamics.rate(on, k);
  CHECK((manifold.k(0).v - k.v).norm() <= 1e-12 * k.v.norm());
  CHECK((plain.k(0).v - k.v).norm() > 1e-3 * k.v.norm());
}

TEST_CASE("rates of another size are rejected as those of a stage", "[unit][integrators]") {
  const System system = thrown(2), other = thrown(3);
  Stages stages;
  stages.begin(kTableau, system.start());
  StateRate k = sized_like(system.start());
  k.v[3] = 7;
  stages.put(2, k);
  CHECK(stages.k(2).v[3] == 7);
  testing::check_words(testing::message_of<ModelError>([&] { stages.put(2, sized_like(other.start())); }),
                       {"Stages::put", "another size", "sized_like()"});
  CHECK(stages.k(2).v == k.v);
}

}  // namespace runge_kutta_test
