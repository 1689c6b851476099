// Copies in joint coordinates, one per lane, against the recursion of each mechanism alone.
#include "framework/tools/batch/tree_batch.h"

#include <cmath>
#include <utility>

#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/laws.h>
#include <lockstep/step_loop.h>
#include <lockstep/stepping.h>
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace tree_lanes_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::testing::check_words;
using lockstep::testing::largest;

namespace {

// Largest difference of the rates in lanes from those of the recursion at the same coordinates, which are away from the
// start by `away`, relative to the largest rate of their kind. The motions of the slots too.
double difference(Family& family, double away, Instructions set = Instructions::best) {
  CopiesOptions options;
  options.instructions = set, options.formulation = Formulation::joint;
  const std::vector<System*> systems = family.pointers();
  for (System* system : systems) system->setup();
  const std::unique_ptr<lanes::Batch> batch = lanes::Batch::of(systems, 0, options);
  REQUIRE(dynamic_cast<lanes::TreeBatch*>(batch.get()) != nullptr);
  Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
  std::vector<State> states;
  lanes::Numbers8 t{};
  for (std::size_t k = 0; k < systems.size(); ++k) {
    State s = systems[k]->start();
    s.t = t[k] = 0.1 * static_cast<double>(k);
    batch->to_batch(static_cast<int>(k), s);
    s.q += away * VecX::Random(s.q.size()), s.v.setRandom();
    batch->put(static_cast<int>(k), s, y.data());
    states.push_back(s);
  }
  for (const bool failed : batch->evaluate(y.data(), t, rate.data())) CHECK_FALSE(failed);
  double worst = 0;
  for (std::size_t k = 0; k < systems.size(); ++k) {
    Dynamics dynamics(*systems[k], std::make_unique<SchurSolver>(), {Formulation::joint, {}});
    State own = systems[k]->start();
    dynamics.to_formulation(own);
    own.t = t[k], own.q = states[k].q, own.v = states[k].v;
    StateRate truth, found = sized_like(own);
    dynamics.rates(own, truth);
    batch->get(static_cast<int>(k), rate.data(), found);
    for (const auto part : {&StateRate::q, &StateRate::v, &StateRate::s})
      keep_worst(worst, largest(found.*part - truth.*part) / std::max(1.0, largest(truth.*part)));
    keep_worst(worst, std::abs(batch->largest_a(k) - truth.largest_a) / std::max(1.0, truth.largest_a));
    keep_worst(worst, std::abs(batch->largest_alpha(k) - truth.largest_alpha) / std::max(1.0, truth.largest_alpha));
  }
  return worst;
}

}  // namespace

TEST_CASE("in lanes a tree accelerates as alone: every mask, either way round", "[unit][copies]") {
  int taken = 0;
  for (int mask = 1; mask < 64; ++mask)
    for (const bool reversed : {false, true}) {
      Family family = random_family(2, [&](inputs::RandomMechanism& m) {
        reversed ? m.link(-1, 0, Mask(mask)) : m.link(0, -1, Mask(mask));
        reversed ? m.link(0, 1, Mask(mask)) : m.link(1, 0, Mask(mask));
      });
      std::string why = Copies::unsuited(*family.systems[0], Formulation::joint);
      if (mask == 63) {
        check_words(why, {"no coordinate is free"});
        continue;
      }
      INFO("mask " << mask << ", reversed " << reversed << ": " << why);
      REQUIRE(why.empty());
      ++taken;
      CHECK(difference(family, 0.4) < 1e-12);
    }
  CHECK(taken == 2 * 62);
}

TEST_CASE("in lanes markers that move on their bodies carry as alone: every mask, either way round", "[unit][copies]") {
  constexpr unsigned kMarkers = oracle::kUP | oracle::kQP | oracle::kUS | oracle::kQS;
  int taken = 0;
  for (int mask = 1; mask < 63; ++mask) {
    const auto rows = static_cast<Mask>(mask);
    if (count_rows(rows & Mask::e123) == 1) continue;
    for (const unsigned markers : {kMarkers, unsigned(oracle::kUP | oracle::kQS), unsigned(oracle::kQP)})
      for (const bool reversed : {false, true}) {
        const unsigned held =
            (overlaps(rows, Mask::xyz) ? oracle::kP : 0U) | (overlaps(rows, Mask::e123) ? oracle::kQD : 0U);
        Family family = random_family(2, [&](inputs::RandomMechanism& m) {
          reversed ? m.link(-1, 0, rows, markers | held) : m.link(0, -1, rows, markers | held);
          reversed ? m.link(0, 1, rows, markers) : m.link(1, 0, rows, markers);
        });
        ++taken;
        INFO("mask " << mask << ", laws " << markers << ", reversed " << reversed);
        CHECK(difference(family, 0.4) < 1e-12);
      }
  }
  CHECK(taken == 38 * 3 * 2);
}

TEST_CASE("in lanes markers that move on their bodies carry as alone: branches, drives, forces", "[unit][copies]") {
  Family family = random_family(6, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz, oracle::kQS);
    m.link(0, 1, Mask::xyz | Mask::e1 | Mask::e2, oracle::kUP | oracle::kUS);
    m.link(2, 0, Mask::all, oracle::kQP | oracle::kUS | oracle::kQD);  // carries, and leaves nothing free
    m.link(3, 2, Mask::x | Mask::y | Mask::e123);
    m.driven(4, 0, Mask::xyz | Mask::e1 | Mask::e2, Axis::rz, oracle::kUP | oracle::kQP);
    m.link(4, 5, Mask::y, oracle::kQP | oracle::kP);
    Marker &a = m.system.add_marker("a", *m.bodies[3], {Vec3(0.5, 0.1, 0.2), {}}),
           &b = m.system.add_marker("b", *m.bodies[5], {Vec3(0, 1, 0.2), {}});
    m.system.add<SpringDamper>("spring", a, b, {.stiffness = 40.0, .damping = 1.0, .free_length = 0.5});
  });
  CHECK(difference(family, 0.4) < 1e-12);
}

TEST_CASE("in lanes a tree accelerates as alone: branches, free bodies, particles", "[unit][copies]") {
  Family family = random_family(
      6,
      [](inputs::RandomMechanism& m) {
        m.link(0, -1, Mask::xyz);
        m.link(0, 1, Mask::xyz | Mask::e1 | Mask::e2);
        m.link(2, 0, Mask::x | Mask::y | Mask::e123);
        m.link(3, 2, Mask::xyz | Mask::e2 | Mask::e3);
        m.link(4, 0, Mask::x);
        m.link(6, -1, Mask::x | Mask::z);
      },
      1);
  CHECK(difference(family, 0.4) < 1e-12);
  for (const double twist : {0.0, 0.7}) {
    Family chains(5, [&](int k) { return chain(12, k, twist); });
    CHECK(difference(chains, 0.4) < 1e-12);
  }
}

TEST_CASE("in lanes a tree accelerates as alone: in a planar mechanism", "[unit][copies]") {
  Family family(4, [](int k) {
    auto sys = chain(4, k);
    sys->set_gravity(Vec3(0.1 * k, 0, -9.81));
    Body& loose = sys->add_body("loose", {1.0 + k, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()}, {Vec3(0, 0, 2), Quat{}});
    sys->add<Spherical>(
        "ball", sys->add_body("end", {2.0, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()}, {Vec3(0.5, 0, 2), Quat{}}), loose,
        pose_at(Vec3(0.2, 0, 2)));
    sys->set_planar(Plane{1});
    return sys;
  });
  CHECK(difference(family, 0.4) < 1e-12);
}

TEST_CASE("in lanes a tree accelerates as alone: laws, drives, forces", "[unit][copies]") {
  SECTION("imposed laws and drives, either way round") {
    Family family = random_family(5, [](inputs::RandomMechanism& m) {
      m.link(0, -1, Mask::all, oracle::kP | oracle::kQD);
      m.link(1, 0, Mask::x | Mask::z | Mask::e123, oracle::kP | oracle::kQD);
      m.link(1, 2, Mask::xyz | Mask::e1 | Mask::e2, oracle::kP | oracle::kQD);
      m.link(3, 2, Mask::x | Mask::y, oracle::kP);
      m.driven(4, 1, Mask::xyz | Mask::e1 | Mask::e2, Axis::rz);
    });
    CHECK(difference(family, 0.4) < 1e-12);
  }
  SECTION("driven speeds, a spring with a moment on either side") {
    Family family(5, [&](int k) {
      auto sys = chain(3, k, 0.4);
      static_cast<MarkerLock&>(*sys->links()[1]).drive_speed(Axis::rz, laws::law([k](auto t) {
                                                               return 0.1 * k + sin(t);
                                                             }));
      Marker& p = sys->add_marker("p", sys->body("rod 2"), {Vec3(0.5, 0.1, 0.2), {}});
      Marker& s = sys->add_marker("s", sys->body("rod 0"), {Vec3(0, 1, 2), {}});
      sys->add<SpringDamper>("spring", p, s, {.stiffness = 40.0 + k, .damping = 1.0, .free_length = 0.5});
      return sys;
    });
    CHECK(difference(family, 0.3) < 1e-12);
  }
}

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

TEST_CASE("copies in lanes cross a jump of velocity as a single run does", "[unit][copies]") {
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
TEST_CASE("copies in lanes cross the jumps of laws of pieces", "[unit][copies]") {
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

TEST_CASE("who follows copies sees every step of theirs, and jumps", "[unit][copies]") {
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
      const Seen& the = seen[static_cast<std::size_t>(k)];
      if (i == 0) {
        CHECK(the.steps == 0);
        return;
      }
      CHECK(the.last.t == s.t);
      CHECK(largest(the.last.q - s.q) == 0);
    };
    const auto reports = copies.run(family.starts(), times, output, [&](int k, const State& s, bool jumped) {
      Seen& the = seen[static_cast<std::size_t>(k)];
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

TEST_CASE("what the caller's functions throw leaves a run of copies as it is, in lanes and alone", "[unit][copies]") {
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
      CHECK(r.error == "broken off");
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

TEST_CASE("copies whose markers move by laws run in lanes as they run alone", "[unit][copies]") {
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

TEST_CASE("a copy whose force throws or is no number is told by name, the others go on", "[unit][copies]") {
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

TEST_CASE("errors of steps in lanes are those of ErrorNorm", "[unit][copies]") {
  Family family = random_family(8, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz);
    m.link(1, 0, Mask::xyz | Mask::e1 | Mask::e2);
    m.link(1, 2, Mask::x | Mask::y | Mask::e123);
    m.link(3, 1, Mask::x | Mask::z | Mask::e2 | Mask::e3, oracle::kP | oracle::kQD);
    m.link(3, 4, Mask::xyz | Mask::e1 | Mask::e2, oracle::kP | oracle::kQD);
    m.link(0, 5, Mask::y, oracle::kP);
    m.link(6, 5, Mask::x | Mask::e2 | Mask::e3, oracle::kAllLaws);
    m.link(6, 7, Mask::z, oracle::kUP | oracle::kQP | oracle::kUS | oracle::kQS);
  });
  const std::vector<System*> systems = family.pointers();
  for (System* system : systems) system->setup();
  CopiesOptions options;
  options.formulation = Formulation::joint;
  const std::unique_ptr<lanes::Batch> batch = lanes::Batch::of(systems, 0, options);
  REQUIRE(batch->weighs_errors());
  Aligned<double> y0(batch->n_numbers()), y1 = y0, error = y0;
  lanes::Numbers8 t{}, t1{}, h{};
  std::vector<State> from, to;
  std::vector<StateRate> errors;
  for (std::size_t k = 0; k < systems.size(); ++k) {
    State s = systems[k]->start();
    batch->to_batch(static_cast<int>(k), s);
    s.t = t[k] = 0.1 * static_cast<double>(k), h[k] = 0.05 + 0.01 * static_cast<double>(k);
    s.v.setRandom();
    from.push_back(s);
    s.t = t1[k] = t[k] + h[k];
    s.q += 0.1 * VecX::Random(s.q.size()), s.v += 0.1 * VecX::Random(s.v.size());
    to.push_back(s);
    StateRate e = sized_like(s);
    e.q.setRandom(), e.v.setRandom(), e.q *= 1e-3, e.v *= 1e-3;
    errors.push_back(e);
    batch->put(static_cast<int>(k), from[k], y0.data()), batch->put(static_cast<int>(k), to[k], y1.data());
    State packed = s;
    packed.q = e.q, packed.v = e.v;
    batch->put(static_cast<int>(k), packed, error.data());
  }
  std::array<Change, lanes::kLanes> change, by;
  batch->start_from(y0.data(), t);
  batch->change_to(y1.data(), t1, h, change);
  batch->weigh(error.data(), by);
  for (std::size_t k = 0; k < systems.size(); ++k) {
    const Tolerance tolerance{1e-4 * static_cast<double>(k), 1e-6};
    StateRate still = sized_like(from[k]);
    still.v.setZero(), still.q.setZero();
    ErrorNorm norm;
    norm.set(tolerance);
    norm.scale(from[k], still, h[k], to[k]);
    const double truth = norm.of(errors[k], to[k]);
    CHECK(in_tolerances(by[k], weights_of(tolerance, change[k])) == Approx(truth).epsilon(1e-10));
  }
}

TEST_CASE("trees by plain x86-64, FMA and AVX-512 agree", "[unit][copies]") {
  Family family = random_family(4, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz | Mask::e1 | Mask::e2);
    m.link(1, 0, Mask::x | Mask::y | Mask::e123, oracle::kP);
    m.link(2, 1, Mask::xyz);
    m.link(2, 3, Mask::x | Mask::e1 | Mask::e2, oracle::kAllLaws);
  });
  int compared = 0;
  for (const Instructions set : {Instructions::plain, Instructions::fma, Instructions::avx512}) try {
      CHECK(difference(family, 0.4, set) < 1e-12);
      ++compared;
    } catch (const ModelError& absent) {
      check_words(absent.what(), {"this machine has no"});
    }
  CHECK(compared >= 1);
}

TEST_CASE("copies of trees run in joint coordinates", "[unit][copies]") {
  const auto taken = [](Family family, Formulation formulation) {
    CopiesOptions options;
    options.formulation = formulation;
    return Copies(family.pointers(), options).formulation();
  };
  const auto chains = [] { return Family(3, [](int k) { return chain(2, k); }); };
  CHECK(taken(chains(), Formulation::automatic) == Formulation::joint);
  CHECK(taken(chains(), Formulation::omega) == Formulation::omega);
  check_words(testing::message_of<ModelError>([&] { taken(chains(), Formulation::quaternion); }), {"quaternion"});
}

}  // namespace tree_lanes_test
