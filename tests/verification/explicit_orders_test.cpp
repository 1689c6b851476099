// SPDX-License-Identifier: BSD-3-Clause
// Error against step has the slope of every explicit and symplectic method: on the heavy top (150 rad/s of spin, a
// spherical joint), on a four-bar mechanism in space, whose joints are redundant, and on a chain of ten rods;
// projection every step.
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace explicit_orders_test {

using namespace lockstep;

namespace {

struct Course {
  std::string scene;
  double end;  ///< s; a row of the csv
  std::vector<std::string> columns;
};

const Course kTop{"heavy_top", 0.2, {"xc", "yc", "zc", "qw", "qx", "qy", "qz", "Wx", "Wz"}};
const Course kFourBar{"nfourbar_2", 0.7, {"theta", "theta_d", "B0x", "B0y", "B0x_d", "B0y_d"}};
const Course kChain{"chain_10", 0.7, {"q1",   "q2",   "q3",   "q4",   "q5",   "q6",   "q7",   "q8",   "q9",   "q10",
                                      "q1_d", "q2_d", "q3_d", "q4_d", "q5_d", "q6_d", "q7_d", "q8_d", "q9_d", "q10_d"}};

/// Length of all columns' errors at the end, after n equal steps. One number alone may pass through zero.
double error_of(const Course& m, const std::string& method, const std::string& stages, int n, Formulation formulation) {
  const SceneRun run = run_scene(scene_path(m.scene), [&](RunSettings& s) {
    s.integrator = {method};
    if (!stages.empty()) s.integrator.keys = Value::object({{"fixed", true}, {"stages", stages.c_str()}});
    s.step = m.end / n;
    s.output = 0, s.times = {m.end}, s.until = m.end;
    s.stabilization.tolerance = 1e-13;
    s.formulation = formulation;
  });
  const Table truth = trusted(m.scene);
  std::size_t row = 0;
  while (std::abs(truth["t"][row] - m.end) > 1e-9) ++row;
  double error = 0;
  for (const std::string& c : m.columns) error = std::hypot(error, run.table[c].back() - truth[c][row]);
  return error;
}

/// Numbers of steps: enough that the leading term rules, few enough that round-off does not (3e-13 of the four-bar).
/// None for the top by dopri5 with its stages on the constraints: its leading term nearly vanishes there, and order 6 is
/// seen.
struct Steps {
  std::string method, stages;
  double order;
  int top[2], four_bar[2], chain[2];
};

double slope(const Course& m, const Steps& s, const int (&n)[2], Formulation formulation = Formulation::omega) {
  const double coarse = error_of(m, s.method, s.stages, n[0], formulation),
               fine = error_of(m, s.method, s.stages, n[1], formulation);
  return std::log(coarse / fine) / std::log(static_cast<double>(n[1]) / n[0]);
}

}  // namespace

TEST_CASE("the error follows the step with the order of the method on three mechanisms",
          "[verification][integrators]") {
  const auto s = GENERATE(Steps{"semi_implicit_euler", "", 1, {2000, 4000}, {700, 1400}, {700, 1400}},
                          Steps{"rk4", "", 4, {200, 400}, {28, 56}, {112, 224}},
                          Steps{"dopri5", "plain", 5, {400, 800}, {140, 200}, {280, 400}},
                          Steps{"dopri5", "manifold", 5, {}, {100, 140}, {280, 400}},
                          Steps{"dop853", "plain", 8, {40, 80}, {12, 18}, {20, 40}},
                          Steps{"dop853", "manifold", 8, {40, 80}, {12, 18}, {20, 40}},
                          Steps{"rattle2", "", 2, {200, 400}, {70, 140}, {140, 280}},
                          Steps{"rattle4", "", 4, {200, 400}, {35, 70}, {70, 140}});
  const double top = s.top[0] > 0 ? slope(kTop, s, s.top) : s.order, four_bar = slope(kFourBar, s, s.four_bar),
               chain = slope(kChain, s, s.chain);
  CAPTURE(s.method, s.stages, top, four_bar, chain);
  CHECK(std::abs(top - s.order) <= 0.15);
  CHECK(std::abs(four_bar - s.order) <= 0.15);
  CHECK(std::abs(chain - s.order) <= 0.15);
}

// Of the whole history, a decade a step.
// On the chain: on the top, whose angles are a quaternion, the round-off is nearer.
TEST_CASE("the error in joint coordinates follows the step with the order of the method",
          "[verification][integrators][joint]") {
  const auto s =
      GENERATE(Steps{"semi_implicit_euler", "", 1, {}, {}, {700, 1400}}, Steps{"rk4", "", 4, {}, {}, {112, 224}},
               Steps{"dopri5", "plain", 5, {}, {}, {280, 400}}, Steps{"dop853", "plain", 8, {}, {}, {20, 40}});
  const double chain = slope(kChain, s, s.chain, Formulation::joint);
  CAPTURE(s.method, chain);
  CHECK(std::abs(chain - s.order) <= 0.15);
}

TEST_CASE("the error of explicit methods follows the tolerance to 1e-9 with slope one", "[verification][integrators]") {
  const std::string method = GENERATE("dopri5", "dop853");
  const Formulation formulation = GENERATE(Formulation::omega, Formulation::automatic);
  const Course m = GENERATE(kTop, kChain);
  const Table truth = trusted(m.scene);
  const auto error_at = [&](double tolerance) {
    const SceneRun run = run_scene(scene_path(m.scene), [&](RunSettings& s) {
      s.integrator = {method};
      s.tolerance = {tolerance, 1e-2 * tolerance};
      s.until = m.end;
      s.formulation = formulation;
    });
    double worst = 0;
    for (const std::string& c : m.columns)
      for (std::size_t i = 0; i < run.table.n_rows(); ++i) keep_worst(worst, std::abs(run.table[c][i] - truth[c][i]));
    return worst;
  };
  std::vector<double> x, y;
  for (int k = 4; k <= 11; ++k) x.push_back(-k), y.push_back(std::log10(error_at(std::pow(10.0, -k))));
  CAPTURE(method, m.scene, to_string(formulation), y);
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mx += x[i] / 8, my += y[i] / 8;
  for (std::size_t i = 0; i < x.size(); ++i) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
  // the weights are increments, which shrink with the step: up to tolerance^(p/(p - 1)) for order p
  CHECK(xy / xx > 0.9);
  CHECK(xy / xx < 1.3);
  CHECK(y.back() < -9);
}

}  // namespace explicit_orders_test
