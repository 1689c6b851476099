// SPDX-License-Identifier: BSD-3-Clause
// A run watches itself: integrators that do not do what they report, runs without an end, events inside a step.
#include <lockstep/step_loop.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/integrate/culprit.h"
#include "tests/support/catch.h"
#include "tests/support/loops.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace run_watch_test {

using lockstep::testing::check_words, lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;

namespace {

/// A step of Euler's, and what is done to it.
class Misled final : public Integrator {
 public:
  using Act = std::function<void(Dynamics&, State&, StepReport&, double)>;
  explicit Misled(Act act) : act_(std::move(act)) {}
  IntegratorInfo info() const override { return {.name = "misled"}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& y, double h) override {
    StateRate rate;
    dynamics.rate(y, rate);
    dynamics.advance(y, h, y.v);
    y.v += h * rate.v;
    y.t += h;
    StepReport report{.h = h};
    dynamics.project(y);
    if (act_) act_(dynamics, y, report, h);
    return report;
  }

 private:
  Act act_;
};

std::string run_misled(Misled::Act act, double* violation = nullptr) {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, std::make_unique<Misled>(std::move(act)), {.step = 0.01});
  const State before = run.state();
  const std::string said = message_of<StepError>([&] { run.run_until(0.1); });
  if (said != "no error") {
    CHECK(run.state().t == before.t);
    CHECK(run.state().q == before.q);
    CHECK(run.state().modes == before.modes);
  }
  if (violation) *violation = run.report().largest_violation;
  return said;
}

}  // namespace

TEST_CASE("a step loop does not trust the report of an integrator", "[unit][dynamics]") {
  CHECK(run_misled({}) == "no error");
  const auto refused = [](Misled::Act act, std::initializer_list<std::string> words) {
    const std::string said = run_misled(std::move(act));
    check_words(said, {"misled", "from t = 0 s"});
    check_words(said, words);
  };
  refused([](Dynamics&, State& y, StepReport& r, double h) { y.t -= h, r.h = 0; }, {"did not advance"});
  refused([](Dynamics&, State& y, StepReport&, double h) { y.t -= 2 * h; }, {"did not advance"});
  refused([](Dynamics&, State& y, StepReport&, double) { y.t = std::nan(""); }, {"ended at t = nan s"});
  refused([](Dynamics&, State& y, StepReport& r, double h) { y.t += h, r.h = 2 * h; }, {"more than the 0.01 s"});
  refused([](Dynamics&, State&, StepReport& r, double h) { r.h = 0.5 * h; }, {"reports 0.005 s"});
  refused([](Dynamics&, State& y, StepReport&, double) { y.q.resize(70); }, {"sizes of the state"});
  refused([](Dynamics&, State& y, StepReport&, double) { y.modes.flip(); }, {"switched joints, which only events may do"});
  refused([](Dynamics&, State& y, StepReport&, double) { y.v[0] = HUGE_VAL; }, {"a velocity that is not finite"});
  refused([](Dynamics&, State& y, StepReport&, double) { y.q.segment<4>(3) *= 1.01; },
          {"the quaternion of body 'rod'", "Dynamics::normalize"});
}

TEST_CASE("the violation that a foreign integrator leaves is measured", "[unit][dynamics]") {
  double violation = 0;
  CHECK(run_misled([](Dynamics&, State& y, StepReport&, double) { y.q[0] += 1e-3; }, &violation) == "no error");
  CHECK(violation > 1e-3);
  CHECK(run_misled({}, &violation) == "no error");
  CHECK(violation < 1e-9);
}

// Methods of the library are believed from step to step, and measured again in some.
TEST_CASE("a built-in method that reports less than it leaves is found out", "[unit][dynamics]") {
  for (const bool lies : {true, false}) {
    RodPendulum pendulum;
    Dynamics dynamics = dynamics_of(pendulum.system);
    auto method =
        std::make_unique<Misled>([lies](Dynamics&, State& y, StepReport&, double) { y.q[0] += lies ? 1e-3 : 0; });
    method->set_origin("built in");
    StepLoop run(dynamics, std::move(method), {.step = 0.01});
    run.run_until(1);
    CHECK((run.report().largest_violation > 1e-3) == lies);
  }
}

namespace {

/// Turns one joint, and does not project.
class Bent final : public Integrator {
 public:
  IntegratorInfo info() const override { return {.name = "bent", .joint = true}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics&, State& y, double h) override {
    y.q[0] += 1e-3, y.t += h;
    return {.h = h};
  }
};

}  // namespace

TEST_CASE("the violation that a foreign integrator leaves in joint coordinates is that of all constraints",
          "[unit][dynamics]") {
  System system = loops::row_of_four_bars(2);
  Dynamics dynamics = loops::joint_dynamics(system);
  StepLoop run(dynamics, std::make_unique<Bent>(), {.step = 0.01});
  run.step();
  REQUIRE(run.state().coordinates);
  CHECK_FALSE(dynamics.holds_rows());  // those of the tree's joints are not asked for
  const double violation = run.report().largest_violation;
  CHECK(violation > 1e-4);
  CHECK(std::abs(violation - dynamics.violation(run.state())) < 1e-14);
}

TEST_CASE("a run without an end is ended by counts", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  SECTION("steps too small for the run") {
    const double step = GENERATE(1e-12, 1e-300);
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = step});
    check_words(message_of<StepError>([&] { run.run_until(1); }), {"rk4", "the rest of the run would take", "--step"});
    CHECK(run.report().steps < 2000);
  }
  SECTION("a limit of one's own") {
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 1e-3, .max_steps = 100});
    check_words(message_of<StepError>([&] { run.run_until(1); }), {"100 steps", "t = 0.1", "max_steps"});
    CHECK(run.state().t == Approx(0.1));
  }
  SECTION("a slow one says how many steps are left") {
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 1e-8, .max_steps = 30000});
    check_words(message_of<StepError>([&] { run.run_until(1); }),
                {"30000 steps", "last 1000 steps are 1e-08 s long", "the rest of the run would take 1e+08"});
    CHECK(run.report().findings.empty());
  }
}

TEST_CASE("a first guess of the step may be as short as it is: only steps that were tried count", "[unit][dynamics]") {
  System system;  // w = 1e6 rad/s: 16 million steps in a second, of 1e-7 s
  Marker& p = system.add_marker("p", system.add_particle("bob", 1, {0, 1.1, 0}));
  system.add<SpringDamper>("spring", p, system.add_marker("s", system.ground()),
                           SpringDamper::Options{.stiffness = 1e12, .free_length = 1});
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.max_steps = 900});
  check_words(message_of<StepError>([&] { run.run_until(1); }), {"has used its 900 steps"});
  CHECK(run.state().t > 1e-5);
}

// A rod of 0.8 m between two pins 0.9 m apart.
TEST_CASE("an end that cannot be projected names the most violated constraint", "[unit][dynamics]") {
  RodPendulum pendulum(kPi / 2);
  System& system = pendulum.system;
  Body& rod = system.body("rod");
  const Vec3 tip = rotation(rod.home.q).transpose() * Vec3(Vec3(RodPendulum::kLength, 0, 0) - rod.home.x);
  Marker& far = system.add_marker("far", system.ground(), pose_at(Vec3(0.9, 0, 0)));
  system.add<Spherical>("pin", system.add_marker("tip", rod, pose_at(tip)), far);
  Dynamics dynamics = dynamics_of(system);
  State y = system.start();
  const ProjectReport report = dynamics.project(y);
  REQUIRE_FALSE(report.converged);
  const std::string said = end_not_projected(dynamics, y, report, "rk4", 0.5, 0.1).what();
  INFO(said);
  check_words(said, {"rk4", "t = 0.5 s", "projection fails", "; worst: constraint "});
}

// Rows and forces change from one long step to the next whatever limits their number.
TEST_CASE("a limit of steps as long as the motion needs names no cause", "[unit][dynamics]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.max_steps = 60});
  const std::string said = message_of<StepError>([&] { run.run_until(100); });
  check_words(said, {"60 steps", "(max_steps)", "another tolerance"});
  CHECK_FALSE(says(said, {"changes"}));
  CHECK_FALSE(says(said, {"contradicts"}));
}

TEST_CASE("a run that is too long for its steps reports it, and names no constraint", "[unit][dynamics]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  const std::string said = message_of<StepError>([&] { run.run_until(1e10); });
  check_words(said, {"the last 1000 steps are", "the rest of the run would take", "end the run earlier"});
  CHECK_FALSE(says(said, {"check its laws"}));
  CHECK_FALSE(says(said, {"shrank"}));
  CHECK(run.report().steps < 2000);
}

TEST_CASE("an event is found if its condition crosses in both directions inside a step", "[unit][dynamics]") {
  // z = 10 t - 5 t^2 passes 4.95 m at 1 -+ 0.1 s; steps of dopri5 are exact here and have no limit
  const auto [crossing, when] = GENERATE(std::pair{Event::Crossing::any, 0.9}, std::pair{Event::Crossing::rising, 0.9},
                                         std::pair{Event::Crossing::falling, 1.1});
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  run.set_state(stone.thrown(10));
  Event event{.name = "high"};
  event.value = [](const Sample& s) { return s.state.q[2] - 4.95; };
  event.crossing = crossing, event.stop = true;
  run.add_event(event);
  run.run_until(3);
  CHECK(run.report().stopped_by == "high");
  CHECK(run.state().t == Approx(when).margin(2e-9));
}

TEST_CASE("a condition that is zero at the start and continues in its direction does not fire, which is reported",
          "[unit][dynamics]") {
  // z = 10 t - 5 t^2 from the level z = 0: rises from it at once, falls back onto it after 2 s
  const auto told = [](Event::Crossing crossing, double speed, double level, double& met) {
    Stone stone;
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, std::make_unique<Dopri5>(), {.output = 0.1});
    run.set_state(stone.thrown(speed));
    Event event{.name = "level", .stop = true};
    event.value = [=](const Sample& s) { return s.state.q[2] - level; };
    event.crossing = crossing;
    run.add_event(event);
    run.run_until(3);
    met = run.state().t;
    return texts_of(run.report().findings);
  };
  double met = 0;
  const auto up = told(Event::Crossing::rising, 10, 0, met);
  REQUIRE(up.size() == 1);  // once
  check_words(up[0], {"event 'level'", "zero at the start", "again"});
  CHECK(met == 3);
  const auto down = told(Event::Crossing::falling, -10, 0, met);
  REQUIRE(down.size() == 1);
  check_words(down[0], {"event 'level'", "zero at the start", "again"});
  CHECK(met == 3);
  const auto either = told(Event::Crossing::any, 10, 0, met);
  REQUIRE(either.size() == 1);
  check_words(either[0], {"event 'level'", "zero at the start", "again"});
  CHECK(met == Approx(2).margin(1e-8));
  CHECK(told(Event::Crossing::any, 10, 1e-9, met).empty());
  CHECK(met == Approx(1e-10).epsilon(0.1));
  CHECK(told(Event::Crossing::falling, 10, 0, met).empty());  // leaves zero on the other side: it does cross
  CHECK(met == Approx(2).margin(1e-8));
  CHECK(told(Event::Crossing::rising, 10, 1e-9, met).empty());
  CHECK(met == Approx(1e-10).epsilon(0.1));
}

TEST_CASE("a condition that is zero when its event is added to a run is reported with that time, from a checkpoint too",
          "[unit][dynamics]") {
  const bool beside = GENERATE(false, true);  // another event, watched from the start on
  Stone stone, same;
  Dynamics dynamics = dynamics_of(stone.system), dynamics_of_same = dynamics_of(same.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>()), again(dynamics_of_same, std::make_unique<Dopri5>());
  Event far{.name = "far"};
  far.value = [](const Sample&) { return 1.0; };
  if (beside) run.add_event(far), again.add_event(far);
  run.set_state(stone.thrown(10));
  run.run_until(1.5);  // on its way down
  REQUIRE(run.report().findings.empty());
  Event event{.name = "level", .stop = true};
  event.value = [level = run.state().q[2]](const Sample& s) { return s.state.q[2] - level; };
  event.crossing = Event::Crossing::falling;
  run.add_event(event), again.add_event(event);
  Snapshot saved;
  run.save(saved);
  again.load(saved);
  for (StepLoop* loop : {&run, &again}) {
    loop->run_until(3);
    REQUIRE(loop->report().findings.size() == 1);
    check_words(loop->report().findings[0].text(), {"event 'level'", "zero at t = 1.5 s", "added", "again"});
    CHECK_FALSE(says(loop->report().findings[0].text(), {"the start"}));
    CHECK(loop->state().t == 3);
  }
}

TEST_CASE("events report what they skip", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  run.set_state(stone.thrown(10));
  Event event{.name = "both", .at = 1};
  event.value = [](const Sample& s) { return s.state.q[2] + 1; };
  check_words(message_of<ModelError>([&] { run.add_event(event); }), {"event 'both'", "a time", "a condition"});

  event.at = -1, event.name = "up", event.crossing = Event::Crossing::rising;
  run.add_event(event);
  Event one{.name = "one", .at = 0.5, .stop = true}, two{.name = "two", .at = 0.5, .stop = true};
  run.add_event(one), run.add_event(two);
  run.run_until(1);
  CHECK(run.report().stopped_by == "one, two");
  REQUIRE(run.report().findings.size() == 1);
  check_words(run.report().findings[0].text(), {"event 'up'", "already passed zero at the start"});
}

// The steps end at multiples of 1/4 s exactly, so the condition is 0 to the last bit where the third begins.
TEST_CASE("a condition that a later step leaves from exactly zero has fired there, and is not reported as a start",
          "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.25});
  run.set_state(stone.thrown(10));
  int fired = 0;
  Event event{.name = "half", .once = false};
  event.value = [](const Sample& s) { return s.state.t - 0.5; };
  event.change = [&](State&) { ++fired; };
  run.add_event(event);
  run.run_until(1.5);
  CHECK(fired == 1);
  CHECK(run.report().findings.empty());
}

TEST_CASE("a law that jumps in position is rejected by name, with every stabilisation", "[unit][dynamics]") {
  const auto kind = GENERATE(Stabilization::Kind::project, Stabilization::Kind::baumgarte, Stabilization::Kind::none);
  const auto formulation = GENERATE(Formulation::omega, Formulation::automatic);
  System system;
  Body& slide = system.add_body("slide", shapes::box(1, {1, 1, 1}));
  auto& guide = system.add<Prismatic>("guide", slide, system.ground(), pose_at(Vec3::Zero()));
  guide.drive(Axis::z, laws::sequence({{0.5, laws::constant(0)}, {10, laws::constant(1)}}));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {formulation, {.kind = kind}});
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  try {
    run.run_until(1);
    FAIL("no error");
  } catch (const AssemblyError& error) {
    check_words(error.what(),
                {"drive guide.z jumps in position at t = 0.5 s by 1 m", "ramp", "\"continue\": true of a sequence"});
    CHECK(error.thing.label() == "joint 'guide' (prismatic)");
    CHECK(error.problem + "; " + error.advice == error.what());
    CHECK(error.t == Approx(0.5));
  }
  if (kind == Stabilization::Kind::project) CHECK(run.report().findings.empty());
  CHECK(run.state().t <= 0.5);
}

TEST_CASE("a law that ends is an error of its number, with joint and time", "[unit][dynamics]") {
  System system;
  Body& slide = system.add_body("slide", shapes::box(1, {1, 1, 1}));
  auto& guide = system.add<Prismatic>("guide", slide, system.ground(), pose_at(Vec3::Zero()));
  guide.drive(Axis::z, laws::law([](auto t) { return sqrt(0.25 - t * t) - 0.5; }));
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  try {
    run.run_until(1);
    FAIL("no error");
  } catch (const NonFiniteError& error) {
    CHECK(error.thing.name == "guide");
    CHECK(error.t == Approx(0.5));
  }
}

TEST_CASE("fixed steps with large rotations give one warning, with the angle", "[unit][dynamics]") {
  System system;
  system.add_body("rotor", MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 1).asDiagonal()}).start.w = {0, 0, 30};
  const auto warnings_of = [&](std::unique_ptr<Integrator> method, double step) {
    Dynamics dynamics = dynamics_of(system);
    StepLoop run(dynamics, std::move(method), {.step = step});
    run.run_until(0.5);
    run.run_until(1);
    CHECK((step == 0 || run.report().largest_turn == Approx(30 * step)));
    return texts_of(run.report().findings);
  };
  const std::vector<std::string> warnings = warnings_of(std::make_unique<Rk4>(), 0.1);
  REQUIRE(warnings.size() == 1);
  check_words(warnings.front(), {"body 'rotor'", "3 rad", "rk4", "smaller step"});
  CHECK(warnings_of(std::make_unique<Rk4>(), 0.01).empty());
  CHECK(warnings_of(std::make_unique<Dopri5>(), 0).empty());
}

TEST_CASE("a fixed step that is longer than the time between outputs reports that they cut it", "[unit][dynamics]") {
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.1, .output = 0.03});
  run.run_until(0.3);
  REQUIRE(run.report().findings.size() == 1);
  check_words(run.report().findings.front().text(), {"rk4", "0.1 s", "0.03 s apart"});
}

TEST_CASE("events switch forces on and off", "[unit][dynamics]") {
  const bool implicit = GENERATE(false, true);
  System system;
  Body& stone = system.add_particle("stone", 2, {0, 0, 0});
  Marker& p = system.add_marker("p", stone);
  Force& push = system.add(std::make_unique<AppliedForce>("push", p, AppliedForce::Options{{8, 0, 0}}));
  Force& coil = system.add<SpringDamper>("spring", p, system.add_marker("s", system.ground(), {{0, 5, 0}, {}}),
                                         SpringDamper::Options{.stiffness = 3, .free_length = 5});
  push.set_switched(false), coil.set_switched(true);
  EnergyAudit audit(system);
  Dynamics dynamics = dynamics_of(system);
  const auto method = [&]() -> std::unique_ptr<Integrator> {
    if (implicit) return std::make_unique<Radau5>();
    return std::make_unique<Dopri5>();
  };
  StepLoop run(dynamics, method(), {.tolerance = {1e-10, 1e-12}});
  run.add_observer(audit);
  run.add_event({.name = "on", .at = 1, .activate = {"push"}, .deactivate = {"spring"}});
  run.add_event({.name = "off", .at = 2, .deactivate = {"push"}});
  run.run_until(1.5);
  CHECK(run.state().v[0] == Approx(2).epsilon(1e-9));  // 4 m/s2 for half a second
  run.run_until(3);
  CHECK(run.state().slot_pose(0).x[0] == Approx(2 + 4).epsilon(1e-9));  // the second as thrown
  CHECK(run.state().slot_pose(0).x[1] == 0);
  CHECK(audit.result().energy == Audit::Energy::conserved);

  StepLoop other(dynamics, method());
  CHECK(
      says(message_of<ModelError>([&] { other.add_event({.name = "e", .at = 1, .activate = {"pusch"}}); }), {"pusch"}));
  system.add(std::make_unique<AppliedForce>("steady", p, AppliedForce::Options{{8, 0, 0}}));
  dynamics.set_up();
  check_words(message_of<ModelError>([&] { other.add_event({.name = "e", .at = 1, .deactivate = {"steady"}}); }),
              {"event 'e'", "force 'steady'", "set_switched"});
}

TEST_CASE("events that reverse each other at one time are rejected, in either order", "[unit][dynamics]") {
  for (const bool reversed : {false, true}) {
    System system;
    Marker& p = system.add_marker("p", system.add_particle("stone", 2, {0, 0, 0}));
    system.add(std::make_unique<AppliedForce>("push", p, AppliedForce::Options{{8, 0, 0}})).set_switched(true);
    Dynamics dynamics = dynamics_of(system);
    StepLoop run(dynamics, std::make_unique<Dopri5>());
    const Event on{.name = "on", .at = 1, .activate = {"push"}}, off{.name = "off", .at = 1, .deactivate = {"push"}};
    run.add_event(reversed ? off : on);
    run.add_event(reversed ? on : off);
    check_words(message_of<ModelError>([&] { run.run_until(2); }),
                {"event 'on'", "activates 'push' at t = 1 s", "event 'off'", "the same time"});
    CHECK(run.state().t == 1);
  }
}

TEST_CASE("the cause of short steps is named", "[unit][dynamics]") {
  SECTION("a force that is no function of the state") {
    const bool implicit = GENERATE(false, true);
    Stone stone;
    Body& body = stone.system.body("stone");
    Marker& p = stone.system.add_marker("p", body);
    stone.system.add(std::make_unique<AppliedForce>("steady", p, AppliedForce::Options{{0, 0, 3}}));
    int calls = 0;
    stone.system.add(function_force("noise", {&p}, [&](const Inputs& in, WrenchSum& out) {
      out.force(body.slot, {in.t > 0.1 ? 1e3 * std::sin(1e3 * ++calls) : 0.0, 0, 0}, in.slot(body.slot).x);
    }));
    Dynamics dynamics = dynamics_of(stone.system);
    const auto method = [&]() -> std::unique_ptr<Integrator> {
      if (implicit) return std::make_unique<Radau5>();
      return std::make_unique<Dopri5>();
    };
    StepLoop run(dynamics, method());
    const std::string said = message_of<StepError>([&] { run.run_until(1); });
    check_words(said, {"force 'noise'", "changes most", "body 'stone' at ["});
    CHECK_FALSE(says(said, {"'steady'"}));
  }
  SECTION("two laws that part") {
    System system(System::Options{{-9.81, 0, 0}});  // beside which the laws differ little at first
    Body& slide = system.add_body("slide", shapes::box(1, {1, 1, 1}));
    for (const auto& [name, law] :
         {std::pair{"straight", laws::polynomial({0, 1})}, {"bent", laws::polynomial({0, 1, 0, 0, 0.5})}})
      system.add<Prismatic>(name, slide, system.ground(), pose_at(Vec3::Zero())).drive(Axis::z, law);
    if (GENERATE(false, true)) system.set_planar(Plane{1});
    Dynamics dynamics(system, GENERATE(false, true) ? std::unique_ptr<LinearSolver>(std::make_unique<SchurSolver>())
                                                    : std::make_unique<DenseSolver>());
    State start = system.start();
    assemble(dynamics, start);
    StepLoop run(dynamics, std::make_unique<Dopri5>());
    run.set_state(start);
    const std::string said = message_of<Error>([&] { run.run_until(1); });
    check_words(said, {"contradicts the others", "of joint '"});
    CHECK((says(said, {"'bent'"}) || says(said, {"'straight'"})));
  }
}

}  // namespace run_watch_test
