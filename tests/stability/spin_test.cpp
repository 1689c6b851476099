// SPDX-License-Identifier: BSD-3-Clause
// Fast rotors and long runs of turns: the turn in a step, and the length of quaternions.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <lockstep/author/passes.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/outcome.h"
#include "tests/support/worst.h"

namespace spin_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// A rotor in a hinge, for ten steps of `turn` radians each.
Outcome spin(const std::string& method, double rate, double turn) {
  const std::string text = R"({"lockstep": 1, "planar": "off",
    "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 2], "omega_body": [0, 0, $w]}],
    "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": $method, "step": $h, "formulation": "omega", "until": $until, "output": $h,
            "record": ["b.qw", "b.qz"]}})";
  return outcome_of(filled(filled(filled(filled(text, "$method", method), "$w", rate), "$h", turn / rate), "$until",
                           10 * turn / rate));
}

double angle_error(const Outcome& o, double angle) {
  const double a = 2 * std::atan2(o.table.last("b.qz"), o.table.last("b.qw"));
  return std::abs(std::remainder(a - angle, 2 * 3.14159265358979323846));
}

}  // namespace

TEST_CASE("up to 1e5 rad/s the error depends on the rotation per step alone, and beyond a radian it is reported",
          "[stability][spin]") {
  for (const char* method : {R"("rk4")", R"("semi_implicit_euler")", R"({"type": "dopri5", "fixed": true})"}) {
    for (const double turn : {0.01, 0.1, 0.5, 1.5, 3.0}) {
      const Outcome slow = spin(method, 1, turn), fast = spin(method, 1e5, turn);
      CAPTURE(method, turn, slow.error, fast.error);
      CHECK(slow.ended() == fast.ended());
      if (!slow.ended() || !fast.ended()) continue;
      CHECK(angle_error(fast, 10 * turn) == Approx(angle_error(slow, 10 * turn)).epsilon(1e-3).margin(1e-9));
      if (turn > 1) CHECK(fast.told());
      if (turn < 0.2) CHECK(angle_error(fast, 10 * turn) < 1e-3);
    }
  }
}

// 10 N m on 1 kg m^2 for 10 s: 500 rad, by up to 10 rad a step. Along a joint or by an exponential a body turns right however
// far; what does not come to it is told.
TEST_CASE("a rotor with ten radians per step reaches its angle, or is reported", "[stability][spin]") {
  const std::string text = R"({"lockstep": 1, "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "forces": [{"name": "T", "type": "applied_torque", "p": "b", "at": [0, 0, 0], "torque": [0, 0, 10]}],
    "run": {"integrator": "rk4", "step": 0.1, "until": 10, "output": 10, "formulation": $f, "record": ["b.angle_z"]}})";
  for (const char* formulation : {R"("joint")", R"("omega")", R"("quaternion")"}) {
    const Outcome o = outcome_of(filled(text, "$f", formulation));
    CAPTURE(formulation, o.error);
    const bool right = o.ended() && std::abs(o.table.last("b.angle_z") - 500) < 1e-9;
    const bool told = std::ranges::any_of(o.report.findings, [](const Finding& finding) {
      const std::string warning = finding.text();
      return warning.find("body 'b' rotates by up to 10 rad in one step") != std::string::npos;
    });
    CHECK((right || told));
    if (formulation == std::string(R"("joint")")) CHECK(right);
  }
}

TEST_CASE("removed full revolutions leave the motions and the signs of quaternions", "[stability][spin][joint]") {
  const double many = 2e5;
  System sys;
  Body* last = &sys.ground();
  for (int k = 0; k < 3; ++k) {
    Body& b = sys.add_body("b" + std::to_string(k), MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()},
                           {Vec3(k + 0.5, 0, 0), Quat()});
    sys.add<Revolute>("A" + std::to_string(k), b, *last,
                      pose_at(Vec3(k, 0, 0), k == 1 ? Vec3(0, 1, 0) : Vec3(0, 0, 1)));
    last = &b;
  }
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {Formulation::joint, {}});
  State state = sys.start();
  dynamics.to_formulation(state);
  REQUIRE(state.q.size() == 3);
  state.q << 0.3, 7001.2, -many;
  std::vector<Motion> before, after;
  passes::motions(sys, state, before);
  CHECK(state.coordinates->take_off_turns(state));
  passes::motions(sys, state, after);
  CHECK(state.q[0] == 0.3);
  CHECK(std::abs(state.q[1]) <= kTwoPi);
  CHECK(std::abs(state.q[2]) <= kTwoPi);
  const double rounding = 4 * many * std::numeric_limits<double>::epsilon();
  for (std::size_t k = 1; k < after.size(); ++k) {
    CHECK((after[k].x - before[k].x).norm() <= 3 * rounding);
    CHECK((after[k].e.coefficients() - before[k].e.coefficients()).norm() <= rounding);
  }
  CHECK_FALSE(state.coordinates->take_off_turns(state));
}

namespace {

// y <- y + h y', which loses nothing where h v is exact but what the sum does.
class Sums final : public Integrator {
 public:
  IntegratorInfo info() const override { return {.name = "sums", .order = 1, .joint = true}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& y, double h) override {
    dynamics.rates(y, rate_);
    y.t += h, y.q += h * rate_.q, y.v += h * rate_.v;
    return {.h = h};
  }

 private:
  StateRate rate_;
};

}  // namespace

// Along joints the angle is integrated itself. Of 7e5 rad a double knows 1e-10, of 1000 turns 1e-12. Steps
// of 1/128 s and h v are exact, so that nothing else is lost.
TEST_CASE("an angle of 100000 revolutions keeps its digits in joint coordinates", "[stability][spin][joint]") {
  System sys;
  Body& b = sys.add_body("b", MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()});
  sys.add<Revolute>("A", b, sys.ground(), pose_at(Vec3::Zero()));
  const double rate = 1e5 / 3;
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {Formulation::joint, {}});
  StepLoop loop(dynamics, std::make_unique<Sums>(), {.step = 1.0 / 128, .output = 1e9});
  State start = sys.start();
  start.v[5] = rate;
  loop.set_state(start);
  loop.run_until(20);
  const State& end = loop.state();
  REQUIRE(end.coordinates);
  const Quat e = end.slot_pose(b.slot).q;
  const auto angle =
      static_cast<double>(std::remainder(20.0L * static_cast<long double>(rate), 2 * std::numbers::pi_v<long double>));
  const double error = std::abs(std::remainder(2 * std::atan2(e.vec()[2], e.w) - angle, kTwoPi));
  double sum = 0;  // as it is where no turns are taken off
  for (int k = 0; k < 2560; ++k) sum += rate / 128;
  CAPTURE(error);
  CHECK(error < 2560 * 1000 * kTwoPi * std::numeric_limits<double>::epsilon() / 4);
  CHECK(std::abs(std::remainder(sum - angle, kTwoPi)) > 20 * error);
  CHECK(std::abs(end.q[0]) < 4000 * kTwoPi);
}

namespace {

// Steps of a body that tumbles by 0.1 rad in each; the largest distance of its quaternion's length from one.
double length_error(long steps) {
  System sys;
  Body& b = sys.add_body("b", MassProperties{1.0, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()});
  b.start.w = Vec3(3, 9, 1);
  Simulation run(sys, {.integrator = "rk4", .step = 0.01, .output = 1e9});
  double worst = 0;
  for (long k = 0; k < steps; ++k) {
    run.loop().step();
    if (k % 1000 == 999) keep_worst(worst, std::abs(run.state().q.segment<4>(3).norm() - 1));
  }
  return worst;
}

}  // namespace

TEST_CASE("quaternions keep their length over 1e5 steps", "[stability][spin]") { CHECK(length_error(100000) < 1e-14); }

TEST_CASE("quaternions keep their length over 1e7 steps", "[stability][spin][long]") {
  CHECK(length_error(10000000) < 1e-14);
}

}  // namespace spin_test
