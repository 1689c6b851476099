// SPDX-License-Identifier: BSD-3-Clause
// Angles whose axis is met by what turns: the count of turns is in doubt, and a warning says so.
#include <cmath>
#include <sstream>
#include <string>

#include <lockstep/body.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/log.h>
#include <lockstep/recorder.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include "tests/support/catch.h"

namespace doubtful_turns_test {

using namespace lockstep;

namespace {

struct Told {
  std::string warnings;
  double last = 0;
};

// What the library warns of while this lives.
struct Heard {
  std::ostringstream words;
  Heard() {
    set_logger(std::make_shared<spdlog::logger>("host", std::make_shared<spdlog::sinks::ostream_sink_mt>(words)));
  }
  ~Heard() { spdlog::drop("lockstep"); }  // the next call makes the library's own again
};

// A body turns by 4 rad about an axis that is `tilt` from x, in 100 steps; one channel is recorded.
Told turn(double tilt, const std::string& channel) {
  System s;
  Body& b = s.add_body("b", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  s.add<Revolute>("A", b, s.ground(), pose_at(Vec3::Zero(), Vec3(std::cos(tilt), std::sin(tilt), 0)));
  Recorder recorder(s);
  recorder.add(make_channel(s, channel));
  Dynamics dynamics(s, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 0.01});
  State start = s.start();
  start.set_slot_twist(0, {Vec3::Zero(), 4 * Vec3(std::cos(tilt), std::sin(tilt), 0)});
  loop.set_state(start);
  loop.add_observer(recorder);
  const Heard heard;
  loop.run_until(1);
  return {heard.words.str(), recorder.table().last(channel)};
}

}  // namespace

TEST_CASE("revolutions of an angle with an undefined axis are uncertain, which is reported once and by name",
          "[unit][record]") {
  const Told met = turn(0, "b.angle_y");  // z of the body passes y of the world
  CHECK(met.warnings.find("channel \"b.angle_y\": by t = 0.4 s") != std::string::npos);
  CHECK(met.warnings.find("revolutions are uncertain") != std::string::npos);
  CHECK(met.warnings.find("channel", met.warnings.find("channel") + 1) == std::string::npos);
  CHECK(std::abs(met.last) < kTwoPi);
  const Told about = turn(0, "b.angle_x");
  CHECK(about.warnings.empty());
  CHECK(std::abs(about.last - 4) < 1e-9);
}

TEST_CASE("an angle whose axis is passed at a distance is counted without a word", "[unit][record]") {
  for (const double tilt : {0.3, 0.1}) {
    const Told passed = turn(tilt, "b.angle_y");
    CAPTURE(tilt, passed.warnings);
    CHECK(passed.warnings.empty());
    // The z axis of the body after a turn by a: (sin(tilt) sin(a), -cos(tilt) sin(a), cos(a)), by Rodrigues' formula.
    CHECK(passed.last == Approx(kPi + std::atan2(-std::sin(tilt) * std::sin(4.0), -std::cos(4.0))).margin(1e-6));
  }
}

TEST_CASE("a joint's rotation about an axis across its axis is zero on both sides of half a revolution",
          "[unit][record]") {
  const Told across = turn(0, "A.angle_y");  // 2 atan2(e2, e0), which is 0/0 at half a turn about z
  CHECK(across.warnings.empty());
  CHECK(across.last == Approx(0).margin(1e-9));
}

// A crank that turns around, between a rocker that does not: the coupler turns back against the crank as often.
TEST_CASE("recorded angles of a loop begin in the revolution of its drive", "[unit][record]") {
  for (const double turns : {0.0, 1.0, -5.0}) {
    CAPTURE(turns);
    System s;
    const double crank_length = 0.5, coupler_length = 1.8, rocker_length = 1.5;
    const Vec3 D(2, 0, 0), B = crank_length * Vec3(std::cos(0.8), std::sin(0.8), 0), to_D = D - B;
    const double d = to_D.norm(),
                 along = (d * d + coupler_length * coupler_length - rocker_length * rocker_length) / (2 * d),
                 aside = std::sqrt(coupler_length * coupler_length - along * along);
    const Vec3 C = B + (along * to_D + aside * Vec3(-to_D[1], to_D[0], 0)) / d;
    Body& crank = s.add_body("crank", shapes::rod(1.0, Vec3::Zero(), B));
    Body& coupler = s.add_body("coupler", shapes::rod(1.0, B, C));
    Body& rocker = s.add_body("rocker", shapes::rod(1.0, D, C));
    s.add<Revolute>("A", crank, s.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::law([turns](auto t) {
                                                                           return kTwoPi * turns + 0.1 * t;
                                                                         }));
    s.add<Revolute>("B", coupler, crank, pose_at(B));
    s.add<Revolute>("C", coupler, rocker, pose_at(C));
    s.add<Revolute>("D", rocker, s.ground(), pose_at(D));
    const Heard heard;
    Simulation run(s, {});
    run.record({"A.rz", "B.rz", "C.rz", "D.rz"});
    run.run_until(0.01);
    CHECK(heard.words.str().find("warning") == std::string::npos);
    CHECK(run.table().first("A.rz") == Approx(kTwoPi * turns).margin(1e-9));
    CHECK(run.table().first("B.rz") == Approx(-kTwoPi * turns).margin(1e-9));
    CHECK(run.table().first("C.rz") == Approx(0).margin(1e-9));
    CHECK(run.table().first("D.rz") == Approx(0).margin(1e-9));
  }
}

}  // namespace doubtful_turns_test
