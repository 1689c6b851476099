// SPDX-License-Identifier: BSD-3-Clause
// Whether a run conserved energy: the audit against motions whose energy is known.
#include <lockstep/recorder.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace energy_audit_test {

using namespace lockstep;

namespace {

/// A spring of 4 N/m from the origin to a particle of 1 kg, with what it says of its energy.
class Spring final : public Force {
 public:
  Spring(double stored, bool says) : Force("spring"), stored_(stored), says_(says) {}
  std::string_view type() const override { return "test_spring"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { out.force(0, Vec3(-4.0 * in.slot(0).x), in.slot(0).x); }
  double potential(const Inputs& in) const override { return says_ ? 0.5 * stored_ * in.slot(0).x.squaredNorm() : 0.0; }

 private:
  double stored_;
  bool says_;
};

Audit audit_of(double stored, bool says, AuditLimits limits = {}) {
  System system;
  system.add_particle("bob", 1, {0.5, 0, 0});
  system.add(std::make_unique<Spring>(stored, says));
  EnergyAudit audit(system, limits);
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}, .output = 0.01});
  run.add_observer(audit);
  run.run_until(3);
  return audit.result();
}

}  // namespace

TEST_CASE("a power of laws that is not a number is no reason to read multipliers", "[unit][record]") {
  System system;
  Body& arm = system.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("hinge", arm, system.ground(), pose_at({0, 0, 0})).drive(Axis::rz, laws::ramp(1.0));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega});
  const Evaluation& e = dynamics.gather(system.start());
  REQUIRE(e.rows().n_rows > 0);
  CHECK(std::isnan(power_of_laws(e.rows(), VecX())));
  CHECK(power_of_laws(e.rows(), VecX::Zero(e.rows().n_rows)) == 0);
}

TEST_CASE("an audit distinguishes a sound run from one whose forces and energies differ", "[unit][record]") {
  const Audit sound = audit_of(4, true);
  CHECK(sound.energy == Audit::Energy::conserved);
  CHECK(sound.scale == Approx(0.5).epsilon(1e-3));  // all of 4 0.5^2 / 2 J to and fro
  CHECK(sound.imbalance < 1e-9);
  CHECK_FALSE(sound.drifted);

  const Audit wrong = audit_of(3.9, true);
  CHECK(wrong.energy == Audit::Energy::not_conserved);
  CHECK(wrong.imbalance == Approx(0.1 / 4 * 0.5).epsilon(1e-2));
  CHECK(wrong.imbalance_share() == Approx(0.1 / 4).epsilon(1e-2));
  CHECK(audit_of(3.9, true, {.energy = 0.1}).energy == Audit::Energy::conserved);

  const Audit silent = audit_of(4, false);
  CHECK(silent.energy == Audit::Energy::not_judged);
  CHECK(silent.unbooked_forces == std::vector<std::string>{"spring"});
}

namespace {

/// A moment on the only body, which no energy answers for.
class Twister final : public Force {
 public:
  Twister() : Force("twister") {}
  std::string_view type() const override { return "test_twister"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs&, WrenchSum& out) const override { out.torque(0, Vec3(0, 0, 3)); }
};

}  // namespace

// 3 N m bring 2 kg m^2 from rest to 1.5 rad/s in 1 s: 2.25 J.
TEST_CASE("a moment without a force that no energy answers for is named", "[unit][record]") {
  System system;
  system.add_body("wheel", MassProperties{1, Vec3::Zero(), Vec3(2, 2, 2).asDiagonal()});
  system.add(std::make_unique<Twister>());
  EnergyAudit audit(system);
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dop853>(), {.output = 0.1});
  run.add_observer(audit);
  run.run_until(1);
  const Audit found = audit.result();
  CHECK(found.unbooked_forces == std::vector<std::string>{"twister"});
  CHECK(found.energy == Audit::Energy::not_judged);
  CHECK(found.imbalance == Approx(0.5 * 2 * 1.5 * 1.5).epsilon(1e-9));
}

TEST_CASE("the energy exchanged is that of the run, however few its outputs", "[unit][record]") {
  System system;
  system.add_particle("bob", 1, {0.5, 0, 0});
  system.add(std::make_unique<Spring>(4, true));
  EnergyAudit audit(system);
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(),
               {.tolerance = {1e-8, 1e-10}, .output = kPi});  // a period: both outputs are of one phase
  run.add_observer(audit);
  run.run_until(kPi);
  CHECK(audit.result().energy == Audit::Energy::conserved);
  CHECK(audit.result().scale == Approx(0.5).epsilon(0.1));
}

TEST_CASE("a very small mechanism that leaves its constraints has drifted", "[unit][record]") {
  constexpr double kSize = 1e-6;
  System system(System::Options{{0, 0, -9.81}});
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, 0}, {kSize, 0, 0}));
  system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
  EnergyAudit audit(system);
  DynamicsOptions options;
  options.formulation = Formulation::omega;
  options.stabilization.kind = Stabilization::Kind::none;
  Dynamics dynamics = dynamics_of(system, options);
  CHECK(system.length() == Approx(0.5 * kSize).epsilon(0.3));
  StepLoop run(dynamics, std::make_unique<SemiImplicitEuler>(), {.step = 1e-5});
  run.add_observer(audit);
  run.run_until(1e-2);
  CHECK(audit.result().violation < 100 * kSize);
  CHECK(audit.result().drifted);
}

TEST_CASE("energy lost when a joint becomes active is recorded under its cause", "[unit][record]") {
  System system(System::Options{{0, 0, -10}});
  Body& stone = system.add_body("stone", shapes::sphere(2, 0.1));
  Lock& hook = system.add<Spherical>("hook", stone, system.ground(), pose_at({0, 0, 0}));
  hook.set_active_at_start(false);
  EnergyAudit audit(system);
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.output = 0.01});
  run.add_observer(audit);
  State start = run.state();
  start.v[2] = 5;  // back at the hook after 1 s, with 5 m/s: 25 J
  run.set_state(start);
  Event event{.name = "grab", .at = 1, .activate = {"hook"}};
  run.add_event(event);
  run.run_until(1.5);
  const Audit found = audit.result();
  CHECK(found.energy == Audit::Energy::conserved);
  REQUIRE(found.instants.size() == 1);
  CHECK(found.instants[0].cause == "event 'grab'");
  CHECK(found.instants[0].first == 1);
  CHECK(found.instants[0].count == 1);
  CHECK(found.instants[0].energy == Approx(-25).epsilon(1e-9));
  CHECK(found.end - found.start == Approx(-25).epsilon(1e-9));
}

TEST_CASE("a run that leaves its constraints has drifted", "[unit][record]") {
  RodPendulum pendulum;
  EnergyAudit audit(pendulum.system, {.violation = 1e-4});
  DynamicsOptions options;
  options.formulation = Formulation::omega;
  options.stabilization.kind = Stabilization::Kind::none;
  Dynamics dynamics = dynamics_of(pendulum.system, options);
  StepLoop run(dynamics, std::make_unique<SemiImplicitEuler>(), {.step = 0.01});
  run.add_observer(audit);
  run.run_until(1);
  CHECK(audit.result().drifted);
  CHECK(audit.result().violation > 1e-4);
  CHECK(audit.result().limits.violation == 1e-4);
}

TEST_CASE("a violation that is no number is a drift, also if later ones are small", "[unit][record]") {
  RodPendulum pendulum;
  EnergyAudit audit(pendulum.system);
  Dynamics dynamics = dynamics_of(pendulum.system);
  const State state = pendulum.system.start();
  StepReport report;
  const auto after = [&](double violation) {
    report.violation_after = violation;
    audit.step(Sample(dynamics, state, report));
  };
  audit.start(Sample(dynamics, state, report));
  after(1e-12);
  CHECK(audit.result().violation == 1e-12);
  CHECK_FALSE(audit.result().drifted);
  after(std::numeric_limits<double>::quiet_NaN());
  after(1e-12);
  CHECK(std::isnan(audit.result().violation));
  CHECK(audit.result().drifted);
}

TEST_CASE("a mechanism at rest, and one that rotates for ever, are conserved", "[unit][record]") {
  const bool turns = GENERATE(false, true);
  System system(System::Options{{0, 0, turns ? 0.0 : -9.81}});
  Body& rod = system.add_body("rod", shapes::rod(1, {0, 0, -1}, {0, 0, 0}));
  system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
  if (turns) rod.start.w = rotation(rod.home.q).transpose() * Vec3(0, 3, 0), rod.start.v = {-1.5, 0, 0};
  EnergyAudit audit(system);
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Dopri5>(), {.output = 0.1});
  run.add_observer(audit);
  run.run_until(10);
  CHECK(audit.result().energy == Audit::Energy::conserved);
}

}  // namespace energy_audit_test
