// SPDX-License-Identifier: BSD-3-Clause
// Runs of copies in lanes: jumps of laws, who follows them, what callers and forces throw.
#include <cmath>
#include <utility>

#include <lockstep/author/registry.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"

namespace tree_lanes_runs_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::testing::check_words;
using lockstep::testing::largest;

namespace {

/// A cart that is driven along x, at a speed that jumps from 0 to 2 m/s, and a rod that hangs on it.
std::unique_ptr<System> cart(int k, const LawPtr<MotionLaw>& law = nullptr) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0, 0, -9.81)});
  Body& car = sys->add_body("car", {1.0 + k, Vec3::Zero(), Vec3(1, 1, 1).asDiagonal()}, {Vec3(0, 0, 0), Quat{}});
  Body& rod = sys->add_body("rod", {1.0 + 0.1 * k, Vec3::Zero(), Vec3(0.1, 0.1, 0.01).asDiagonal()},
                            {Vec3(0, 0, -0.5), Quat{}});
  auto& rail = sys->add<Prismatic>("rail", car, sys->ground(), pose_at(Vec3(0, 0, 0), Vec3(1, 0, 0)));
  sys->add<Revolute>("pin", rod, car, pose_at(Vec3(0, 0, 0), Vec3(0, 1, 0)));
  rail.drive(Axis::z, law ? law : laws::law([](auto t) { return t < 0.3 ? 0.0 * t : 2.0 * t - 0.6; }, {0.3}));
  return sys;
}

RunEnds ends_of(Family& family, const std::vector<State>& starts, double t, const std::string& method, bool lanes,
                double step = 0) {
  CopiesOptions options;
  options.integrator = method, options.tolerance = {1e-10, 1e-12}, options.step = step, options.lanes = lanes;
  return ends_of(family, starts, t, options);
}

RunEnds ends_of(Family& family, double t, const std::string& method, bool lanes, double step = 0) {
  return ends_of(family, family.starts(), t, method, lanes, step);
}

/// A push on one body that throws, or is no number, from a time on.
struct Broken final : Force {
  Broken(int slot, double from, bool throws) : Force("broken"), slot_(slot), from_(from), throws_(throws) {}
  std::string_view type() const override { return "broken"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    if (in.t < from_) return;
    if (throws_) throw 42;
    out.torque(slot_, Vec3(0, std::nan(""), 0));
  }
  int slot_;
  double from_;
  bool throws_;
};

/// Two pendulums on the ground; the force of copy 2 acts on the first.
std::unique_ptr<System> two_pendulums(int k, double from, bool throws) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0, 0, -9.81)});
  for (int i = 0; i < 2; ++i) {
    Body& rod = sys->add_body("rod " + std::to_string(i), {1.0 + k, Vec3::Zero(), Vec3(0.1, 0.1, 0.01).asDiagonal()},
                              {Vec3(2.0 * i + 0.5, 0, 0), Quat{}});
    sys->add<Revolute>("pin " + std::to_string(i), rod, sys->ground(), pose_at(Vec3(2.0 * i, 0, 0), Vec3(0, 1, 0)));
  }
  sys->add(std::make_unique<Broken>(0, k == 2 ? from : 1e9, throws));
  return sys;
}

}  // namespace

// Energy is conserved: what the damper takes is missing in the end.
TEST_CASE("works are integrated in vectorised instances", "[unit][copies]") {
  std::vector<Mechanism> all;
  std::vector<System*> systems;
  std::vector<State> starts, ends(3);
  std::vector<Channel> lost, total;
  for (const char* const speed : {"4", "6", "8"}) {
    all.push_back(build_mechanism(
        scene_from_text(R"({"lockstep": 1, "planar": "off", "gravity": [0, 0, 0], "parameters": {"w": )" +
                            std::string(speed) + R"(},
          "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]},
                      "velocity": [0, "=w/2", 0], "omega_world": [0, 0, "=w"]}],
          "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]}],
          "forces": [{"name": "brake", "type": "torsion_spring_damper", "p": "arm", "s": "ground", "at": [0, 0, 0],
                      "stiffness": 3, "damping": 0.5}]})",
                        "arm.json"),
        builtin_registry()));
  }
  for (Mechanism& m : all) {
    System& system = system_of(m);
    lost.push_back(make_channel(system, "energy.dissipated")), total.push_back(make_channel(system, "energy.total"));
    system.setup();
    systems.push_back(&system), starts.push_back(system.start());
  }
  CopiesOptions options;
  options.tolerance = {1e-10, 1e-12};
  Copies(systems, options).run(starts, std::vector<double>{2.0}, [&](int copy, std::size_t, const State& end) {
    ends[copy] = end;
  });
  for (std::size_t k = 0; k < 3; ++k) {
    Dynamics dynamics(*systems[k], std::make_unique<SchurSolver>());
    const StepReport none{};
    const double first = total[k].value(Sample(dynamics, starts[k], none));
    const Sample last(dynamics, ends[k], none);
    CHECK(lost[k].value(last) > 0.1 * first);
    CHECK(lost[k].value(last) + total[k].value(last) == Approx(first).epsilon(1e-8));
  }
}

TEST_CASE("vectorised instances cross a jump of velocity as a single run does", "[unit][copies]") {
  const auto method = GENERATE(as<std::string>{}, "dop853", "dopri5", "rk4");
  CAPTURE(method);
  const double step = method == "rk4" ? 1e-3 : 0;
  Family family(5, [](int k) { return cart(k); });
  const RunEnds lanes = ends_of(family, 0.8, method, true, step), alone = ends_of(family, 0.8, method, false, step);
  for (std::size_t k = 0; k < 5; ++k) {
    INFO(k << ": " << lanes.reports[k].error);
    REQUIRE(lanes.reports[k].finished);
    CHECK_FALSE(lanes.reports[k].alone);
    System& system = *family.systems[k];
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}});
    loop.run_until(0.8);
    State truth = loop.state();
    dynamics.to_slots(truth);
    CHECK(largest(lanes.states[k].q - alone.states[k].q) < 1e-8);
    CHECK(largest(lanes.states[k].q - truth.q) < (step > 0 ? 1e-6 : 1e-8));
    CHECK(largest(lanes.states[k].v - truth.v) < (step > 0 ? 1e-5 : 1e-7));
  }
  // The jump itself: the pin moves at 2 m/s at once, and the rod, which hung still, by w = m l 2 m/s / (J + m l^2).
  const RunEnds just = ends_of(family, 0.3 + 1e-9, "dop853", true);
  CHECK(std::abs(just.states[0].v[10]) == Approx(0.5 * 2.0 / (0.1 + 0.25)).epsilon(1e-6));
}

// Laws of pieces count an instant as the jump that is within a rounding of it: the step before has to end earlier.
TEST_CASE("vectorised instances cross the jumps of piecewise laws", "[unit][copies]") {
  const double at = GENERATE(0.3, 0.25, 0.7);
  const LawPtr<MotionLaw> law = laws::sequence({{at, laws::constant(0)}, {2, laws::ramp(2)}});
  Family family(5, [&](int k) { return cart(k, law); });
  for (const bool lanes : {true, false}) {
    const RunEnds just = ends_of(family, at + 1e-9, "dop853", lanes), on = ends_of(family, at, "dop853", lanes);
    CAPTURE(at, lanes);
    for (std::size_t k = 0; k < 5; ++k) {
      INFO(k << ": " << just.reports[k].error << on.reports[k].error);
      REQUIRE(just.reports[k].finished);
      REQUIRE(on.reports[k].finished);
      CHECK(just.reports[k].alone != lanes);
      const double m = 1.0 + 0.1 * static_cast<double>(k), w = m * 0.5 * 2.0 / (0.1 + 0.25 * m);
      CHECK(std::abs(just.states[k].v[10]) == Approx(w).epsilon(1e-6));
      CHECK(std::abs(on.states[k].v[10]) == Approx(w).epsilon(1e-6));  // an output at the jump is of its far side
    }
  }
}

TEST_CASE("an observer of instances sees every step of theirs, and jumps", "[unit][copies]") {
  for (const bool in_lanes : {true, false}) {
    Family family(5, [](int k) { return cart(k); });
    CopiesOptions options;
    options.tolerance = {1e-8, 1e-10}, options.lanes = in_lanes;
    Copies copies(family.pointers(), options);
    struct Seen {
      long steps = 0, jumps = 0;
      State last;
    };
    std::vector<Seen> seen(5);
    const std::vector<double> times{0, 0.2, 0.8};
    const auto output = [&](int k, std::size_t i, const State& s) {  // of the same instant, and told later
      const Seen& the = seen[k];
      if (i == 0) {
        CHECK(the.steps == 0);
        return;
      }
      CHECK(the.last.t == s.t);
      CHECK(largest(the.last.q - s.q) == 0);
    };
    const auto reports = copies.run(family.starts(), times, output, [&](int k, const State& s, bool jumped) {
      Seen& the = seen[k];
      const State before = std::exchange(the.last, s);
      ++(jumped ? the.jumps : the.steps);
      if (!jumped) {
        CHECK((the.steps == 1 || s.t > before.t));
        return;
      }
      CHECK(s.t == 0.3);
      CHECK(before.t == Approx(0.3));
      CHECK(s.v[0] - before.v[0] == Approx(2));  // m/s, of the cart
    });
    for (std::size_t k = 0; k < 5; ++k) {
      INFO((in_lanes ? "in lanes, copy " : "alone, copy ") << k << ": " << reports[k].error);
      CHECK(reports[k].finished);
      CHECK(seen[k].steps == reports[k].steps);
      CHECK(seen[k].jumps == 1);
    }
  }
}

TEST_CASE("exceptions of the caller's functions leave a run of instances unchanged, vectorised and alone",
          "[unit][copies]") {
  for (const bool in_lanes : {true, false}) {
    Family family(3, [](int k) { return cart(k); });
    CopiesOptions options;
    options.lanes = in_lanes;
    Copies copies(family.pointers(), options);
    const std::vector<double> times{0.2, 0.8};
    const auto nothing = [](int, std::size_t, const State&) {};
    const auto thrown = [&](auto&& act) {
      try {
        act();
      } catch (const ModelError& error) {
        return std::string(error.what());
      }
      return std::string("nothing");
    };
    CHECK(thrown([&] {
            copies.run(family.starts(), times, nothing, [](int, const State&, bool) { throw ModelError("a step"); });
          }) == "a step");
    CHECK(thrown([&] {
            copies.run(family.starts(), times, [](int, std::size_t, const State&) { throw ModelError("an output"); });
          }) == "an output");
    long asked = 0;
    const auto reports = copies.run(family.starts(), times, nothing, {}, [&](double t) { return ++asked, t < 0.5; });
    CHECK(asked > 2);
    for (const CopyReport& r : reports) {
      CHECK_FALSE(r.finished);
      CHECK(r.t >= 0.2);
      CHECK(r.t < 0.8);
      CHECK(r.error == "stopped by the caller");
    }
  }
}

namespace {

/// A load on a ball, at the end of a boom that turns and whose point runs in and out: a crane, by laws of its markers. And
/// a link that slides on an axis that is turned on the load.
std::unique_ptr<System> crane(int k) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0, 0.1 * k, -9.81)});
  Body& load = sys->add_body("load", {2.0 + k, Vec3::Zero(), Vec3(0.3, 0.2, 0.1).asDiagonal()}, {Vec3(2, 0, -1), {}});
  Body& ring = sys->add_body("ring", {0.5, Vec3::Zero(), Vec3(0.02, 0.03, 0.04).asDiagonal()}, {Vec3(2, 0, -2), {}});
  Marker& hook = sys->add_marker("hook", load, {Vec3(0, 0, 1), {}});
  Marker& trolley = sys->add_marker("trolley", sys->ground());
  trolley.translation_law = laws::translation([k](auto t) {
    const auto reach = 2.0 + 0.3 * sin((1.0 + 0.1 * k) * t);
    return std::array{reach * cos(0.5 * t), reach * sin(0.5 * t), 0.0 * t};
  });
  sys->add<Spherical>("rope", hook, trolley);
  Marker& on_ring = sys->add_marker("on_ring", ring);
  Marker& spindle = sys->add_marker("spindle", load, {Vec3(0, 0, -1), {}});
  spindle.rotation_law =
      laws::axis_rotation({0, 1, 0}, laws::law([k](auto t) { return 0.4 * sin((2.0 + 0.1 * k) * t); }));
  sys->add<Cylindrical>("slide", on_ring, spindle);
  return sys;
}

}  // namespace

TEST_CASE("instances with markers moved by laws run vectorised as they run alone", "[unit][copies]") {
  const auto method = GENERATE(as<std::string>{}, "dop853", "dopri5", "rk4");
  CAPTURE(method);
  const double step = method == "rk4" ? 1e-3 : 0;
  Family family(5, [](int k) { return crane(k); });
  const std::vector<State> starts = family.assembled();
  const RunEnds lanes = ends_of(family, starts, 0.7, method, true, step),
                alone = ends_of(family, starts, 0.7, method, false, step);
  for (std::size_t k = 0; k < 5; ++k) {
    INFO(k << ": " << lanes.reports[k].error);
    REQUIRE(lanes.reports[k].finished);
    CHECK_FALSE(lanes.reports[k].alone);
    CHECK(lanes.reports[k].steps == alone.reports[k].steps);
    CHECK(largest(lanes.states[k].q - alone.states[k].q) < 1e-10);
    CHECK(largest(lanes.states[k].v - alone.states[k].v) < 1e-9);
    Dynamics dynamics(*family.systems[k], std::make_unique<SchurSolver>(), {Formulation::omega, {}});
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}});
    loop.set_state(starts[k]);
    loop.run_until(0.7);
    CHECK(largest(lanes.states[k].q - loop.state().q) < (step > 0 ? 1e-7 : 1e-8));
  }
  CHECK(largest(lanes.states[0].q - lanes.states[4].q) > 1e-2);  // they are not all the same
}

TEST_CASE("an instance with a force that throws or is no number is reported by name, the others continue",
          "[unit][copies]") {
  const bool throws = GENERATE(false, true);
  const auto method = GENERATE(as<std::string>{}, "dop853", "rk4");
  CAPTURE(throws, method);
  Family family(8, [&](int k) { return two_pendulums(k, 0.2, throws); });
  const RunEnds ends = ends_of(family, 0.5, method, true, method == "rk4" ? 1e-3 : 0);
  for (std::size_t k = 0; k < 8; ++k) {
    CAPTURE(k, ends.reports[k].error);
    CHECK(ends.reports[k].finished == (k != 2));
    CHECK(ends.reports[k].alone == (k == 2));
    if (k != 2) CHECK(ends.states[k].q.allFinite());
  }
  check_words(ends.reports[2].error, {"broken"});
  CHECK(ends.reports[2].t < 0.2 + 1e-9);
}

}  // namespace tree_lanes_runs_test
