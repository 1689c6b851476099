// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/batch.h>

#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/author/stepping.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/step_loop.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace copies_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::testing::check_words;
using lockstep::testing::largest;
using lockstep::testing::message_of;

namespace {

struct Told {
  std::vector<std::vector<State>> states;  // of each copy, time after time
  std::vector<CopyReport> reports;
};
Told told(Family& family, const std::vector<State>& starts, const std::vector<double>& times, CopiesOptions options) {
  Copies copies(family.pointers(), options);
  Told out;
  out.states.resize(starts.size());
  out.reports = copies.run(starts, times, [&](int copy, std::size_t time, const State& state) {
    auto& mine = out.states[copy];
    CHECK(time == mine.size());
    CHECK(state.t == times[time]);
    mine.push_back(state);
  });
  return out;
}

}  // namespace

TEST_CASE("a vectorised run equals the run of each instance", "[unit][copies]") {
  const std::vector<double> times{0.0, 0.1, 0.25, 0.5};
  for (const char* method : {"rk4", "dopri5", "dop853"}) {
    Family family(11, [](int k) { return chain(3, k, 0.3); });  // more than one batch, the second one not full
    const std::vector<State> starts = family.assembled();
    CopiesOptions options;
    options.integrator = method;
    options.tolerance = {1e-9, 1e-11};
    options.step = std::string(method) == "rk4" ? 1e-3 : 0.0;
    const Told lanes = told(family, starts, times, options);
    options.lanes = false;
    const Told alone = told(family, starts, times, options);
    for (std::size_t k = 0; k < starts.size(); ++k) {
      INFO(method << ", copy " << k);
      REQUIRE(lanes.states[k].size() == times.size());
      CHECK(lanes.reports[k].finished);
      CHECK_FALSE(lanes.reports[k].alone);
      CHECK(alone.reports[k].alone);
      const long differ = std::abs(lanes.reports[k].steps - alone.reports[k].steps);  // steps cut at outputs
      CHECK(differ <= (method == std::string("rk4") ? 0 : 2));
      for (std::size_t i = 0; i < times.size(); ++i) {
        CHECK(largest(lanes.states[k][i].q - alone.states[k][i].q) < 1e-9);
        CHECK(largest(lanes.states[k][i].v - alone.states[k][i].v) < 1e-8);
      }
    }
    CHECK(largest(lanes.states[0].back().q - lanes.states[7].back().q) > 1e-3);  // they are not all the same
  }
}

// Parallelograms that stand on their heads and fall through their flat position; the last hangs.
TEST_CASE("an instance near a singular configuration finishes alone", "[unit][copies]") {
  const std::vector<double> times{0.5, 2.0};
  const std::string method = GENERATE("dopri5", "dop853");
  Family family(3, [](int k) { return ladder(1, k == 2 ? 28 : k); });
  const std::vector<State> starts = family.assembled();
  CopiesOptions options;
  options.integrator = method;
  options.tolerance = {1e-9, 1e-11};
  const Told lanes = told(family, starts, times, options);
  options.lanes = false;
  const Told alone = told(family, starts, times, options);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    CAPTURE(method, k, lanes.reports[k].error);
    REQUIRE(lanes.reports[k].finished);
    CHECK(lanes.reports[k].alone == (k < 2));
    for (std::size_t i = 0; i < times.size(); ++i) CHECK(largest(lanes.states[k][i].q - alone.states[k][i].q) < 1e-7);
    const State& end = lanes.states[k].back();  // a parallelogram still: its uprights turn alike
    CHECK(largest(end.v.segment<3>(3) - end.v.segment<3>(9)) < 1e-7);
  }
}

TEST_CASE("an instance that left the batch is ended by its number of steps", "[unit][copies]") {
  Family family(1, [](int k) { return ladder(1, k); });  // falls through its flat position
  CopiesOptions options;
  options.integrator = "dopri5", options.tolerance = {1e-9, 1e-11};
  const CopyReport free = told(family, family.assembled(), {0.5, 2.0}, options).reports[0];
  REQUIRE(free.alone);
  REQUIRE(free.finished);
  options.max_steps = free.steps - 5;
  const CopyReport ended = told(family, family.assembled(), {0.5, 2.0}, options).reports[0];
  CHECK(ended.alone);
  CHECK_FALSE(ended.finished);
  CHECK(ended.steps == options.max_steps);
  check_words(ended.error, {std::to_string(options.max_steps) + " steps"});
}

TEST_CASE("forces in a vectorised batch count their revolutions", "[unit][copies]") {
  Family family(3, [](int k) {
    auto sys = chain(1, k);
    const Marker &p = *sys->links()[0]->pairs()[0].first, &s = *sys->links()[0]->pairs()[0].second;
    sys->add<TorsionSpringDamper>("spring", const_cast<Marker&>(p), const_cast<Marker&>(s),
                                  {.stiffness = 0.1 + 0.1 * k});
    return sys;
  });
  std::vector<State> starts = family.assembled();
  for (std::size_t k = 0; k < starts.size(); ++k) {  // fast enough to pass half a turn
    starts[k].v[4] = 20;
    Dynamics(*family.systems[k], std::make_unique<SchurSolver>()).project(starts[k]);
  }
  CopiesOptions options;
  options.tolerance = {1e-9, 1e-11};
  const Told lanes = told(family, starts, {1.0}, options);
  options.lanes = false;
  const Told alone = told(family, starts, {1.0}, options);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const CountedAngle& angle = *family.systems[k]->counted_angles().front();
    const auto turned = [&](const State& s) {
      return angle.expected({s.s.data(), static_cast<std::size_t>(s.s.size())});
    };
    CHECK(std::abs(turned(lanes.states[k][0]) - turned(alone.states[k][0])) < 1e-8);
    CHECK(std::abs(turned(lanes.states[k][0])) > kPi);
    CHECK(largest(lanes.states[k][0].q - alone.states[k][0].q) < 1e-8);
  }
}

TEST_CASE("an instance with a failing law is named, the others continue", "[unit][copies]") {
  Family family(8, [](int k) {
    auto sys = chain(2, k, 0.2);
    const double end = k == 3 ? 0.2 : 10.0;
    static_cast<MarkerLock&>(*sys->links()[0]).drive(Axis::rz, laws::law([end](auto t) {
                                                       return 0.1 * t + 0.0 * sqrt(end - t);
                                                     }));
    return sys;
  });
  const Told run = told(family, family.assembled(), {0.1, 0.5}, {});
  for (std::size_t k = 0; k < 8; ++k) {
    CHECK(run.reports[k].finished == (k != 3));
    CHECK(run.states[k].size() == (k == 3 ? 1u : 2u));
  }
  check_words(run.reports[3].error, {"hinge 0"});
  CHECK(run.reports[3].t < 0.2);
}

namespace {

// A pendulum with a particle beside it, which a force of copy 2 turns from 0.2 s on.
std::unique_ptr<System> with_turned_particle(int k) {
  auto sys = chain(1, k);
  Body& bead = sys->add_particle("bead", 1, {0, 0, -2});
  Marker& at = sys->add_marker("at", bead);
  const double from = k == 2 ? 0.2 : HUGE_VAL;
  sys->add(function_force("twist", {&at}, [&bead, from](const Inputs& in, WrenchSum& out) {
    out.force(bead.slot, {1, 0, 0}, in.slot(bead.slot).x);
    if (in.t > from) out.torque(bead.slot, {0, 0, 0.5});
  }));
  return sys;
}

}  // namespace

TEST_CASE("a moment on a particle of an instance is rejected in the words of a single run", "[unit][copies]") {
  const std::vector<std::string> words{"force 'twist' exerts a moment of 0.5 N m on body 'bead'", "cannot rotate"};
  Family family(4, with_turned_particle);
  const Told lanes = told(family, family.starts(), {0.1, 0.5}, {});
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k, lanes.reports[k].error);
    CHECK(lanes.reports[k].finished == (k != 2));
    CHECK(lanes.reports[k].alone == (k == 2));
  }
  check_words(lanes.reports[2].error, words);
  Dynamics dynamics(*family.systems[2], std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  check_words(message_of<ModelError>([&] { loop.run_until(0.5); }), words);
}

TEST_CASE("copies land on the jumps of their laws", "[unit][copies]") {
  const auto kink = [](int k) {
    auto sys = chain(2, k);
    const double t1 = 0.21 + 0.01 * k;
    static_cast<MarkerLock&>(*sys->links()[0])
        .drive(Axis::rz, laws::law([t1](auto t) { return t < t1 ? 0.0 * t : 5.0 * (t - t1) * (t - t1); }, {t1}));
    return sys;
  };
  Family family(4, kink);
  CopiesOptions options;
  options.tolerance = {1e-8, 1e-10};
  const Told run = told(family, family.assembled(), {1.0}, options);
  for (std::size_t k = 0; k < 4; ++k) {
    const double turned = 5.0 * (0.79 - 0.01 * double(k)) * (0.79 - 0.01 * double(k));
    CHECK(run.reports[k].rejected <= 2);
    CHECK(std::abs(run.states[k][0].q[3]) == Approx(std::abs(std::cos(0.5 * turned))).margin(1e-9));
  }
}

TEST_CASE("vectorised steps allocate nothing", "[unit][copies]") {
  if (!allocations_are_counted()) return;
  const bool loops = GENERATE(true, false);
  Family family(8, [&](int k) { return loops ? ladder(2, 25 + k) : chain(3, k, 0.3); });  // they hang, far from flat
  const std::vector<State> starts = family.assembled();
  CopiesOptions options;
  options.integrator = "dopri5";
  Copies copies(family.pointers(), options);
  const auto run_to = [&](double t) {
    const std::vector<double> times{t};
    return allocations_of([&] { copies.run(starts, times, [](int, std::size_t, const State&) {}); });
  };
  run_to(0.1);
  const long once = run_to(0.1);
  CHECK(once > 0);  // the library's are counted
  CHECK(run_to(1.0) == once);
}

namespace {

// Ralston's method of order 2, which nobody but this test has.
constexpr double kRalstonC[2] = {0, 2.0 / 3};
constexpr double kRalstonA[2][1] = {{}, {2.0 / 3}};
constexpr double kRalstonB[2] = {0.25, 0.75};
constexpr EmbeddedScheme kRalston{"ralston", {2, 2, 2, 1, kRalstonA[0], kRalstonB, kRalstonC}};

struct Ralston final : Integrator {
  explicit Ralston(bool takes_joint_coordinates = true) : joint(takes_joint_coordinates) {}
  IntegratorInfo info() const override { return {"ralston", 2, false, false, 2, joint}; }
  const EmbeddedScheme* scheme() const override { return &kRalston; }
  void begin(Dynamics&, const State& state) override { stages.begin(kRalston.tableau, state), end = state; }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    stages.evaluate(dynamics, state, h, 0, 2);
    stages.end(state, h, end);
    if (!project_end(dynamics, end).converged) throw StepError("ralston: the end is not projected", state.t);
    take_motion(end, state);
    return {h};
  }
  Stages stages;
  State end;
  bool joint;
};

}  // namespace

TEST_CASE("an explicit method of a custom registry runs vectorised as it runs alone", "[unit][copies]") {
  Registry registry = builtin_registry();
  registry.integrators.add({"ralston", "order 2", {}}, [](const Params&) { return std::make_unique<Ralston>(); });
  const std::vector<double> times = {0.25, 0.5};
  std::vector<State> ends[2];
  for (const bool lanes : {false, true}) {
    Family family(3, [](int k) { return chain(2, k, 0.5); });
    CopiesOptions options;
    options.integrator = "ralston", options.step = 0.01, options.lanes = lanes, options.registry = &registry;
    Copies copies(family.pointers(), options);
    ends[lanes].resize(3);
    for (const CopyReport& report :
         copies.run(family.assembled(), times, [&](int copy, std::size_t, const State&s) { ends[lanes][copy] = s; })) {
      CHECK(report.finished);
      CHECK(report.steps == 50);
      CHECK(report.alone == !lanes);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(ends[1][k].t == 0.5);
    CHECK(largest(ends[1][k].q - ends[0][k].q) < 1e-11);
    CHECK(largest(ends[1][k].v - ends[0][k].v) < 1e-10);
  }
  Family family(1, [](int k) { return chain(2, k); });
  CopiesOptions unknown;
  unknown.integrator = "ralston";
  check_words(message_of<ModelError>([&] { Copies(family.pointers(), unknown); }), {"ralston", "is not vectorised"});
  Registry others = builtin_registry();
  others.integrators.add({"ralston", "order 2", {}}, [](const Params&) { return std::make_unique<Ralston>(false); });
  unknown.step = 0.01, unknown.registry = &others;
  check_words(message_of<ModelError>([&] { Copies(family.pointers(), unknown); }),
              {"ralston", "does not support joint coordinates"});
}

TEST_CASE("instances reject by name types that cannot be vectorised", "[unit][copies]") {
  const auto message = [](auto&& act) { return message_of<ModelError>(act); };
  CHECK(Copies::unsuited(*chain(2, 0)).empty());
  {
    auto planar = chain(2, 0);
    planar->set_planar(Plane{1});
    CHECK(Copies::unsuited(*planar) == "");
    check_words(Copies::unsuited(*planar, Formulation::omega), {"joint coordinates"});
  }
  {
    auto planar = chain(2, 0);
    static_cast<MarkerLock&>(*planar->links()[0]).drive(Axis::rz, laws::law([](auto t) { return t; }));
    static_cast<MarkerLock&>(*planar->links()[1]).drive(Axis::rz, laws::law([](auto t) { return t; }));
    planar->set_planar(Plane{1});
    check_words(Copies::unsuited(*planar), {"moved by laws alone"});  // not that it is planar
  }
  {
    inputs::RandomMechanism m(1);
    m.add_body();
    m.link(0, -1, Mask::xyz, oracle::kUP);
    CHECK(Copies::unsuited(m.system) == "");  // markers may move
  }
  {
    Family family(2, [](int k) { return chain(2 + k, 0); });
    check_words(message([&] { Copies c(family.pointers()); }), {"instance 1 differs from instance 0", "moving bodies"});
  }
  {
    Family family = Family(2, [](int k) {
      auto sys = chain(2, 0);
      if (k == 1) static_cast<MarkerLock&>(*sys->links()[1]).drive(Axis::rz, laws::law([](auto t) { return t; }));
      return sys;
    });
    check_words(message([&] { Copies c(family.pointers()); }), {"hinge 1"});
  }
  {
    struct Own final : Auxiliary {
      explicit Own(std::string name) : Auxiliary(std::move(name)) {}
      int size() const override { return 1; }
      bool reads_solution() const override { return false; }
      void rates(const Evaluated&, std::span<double> sd) const override { sd[0] = 1; }
    };
    Family swapped(2, [](int k) {
      auto sys = chain(2, 0);
      sys->add(std::make_unique<Own>(k == 0 ? "one" : "other"));
      sys->add(std::make_unique<Own>(k == 0 ? "other" : "one"));
      return sys;
    });
    check_words(message([&] { Copies c(swapped.pointers()); }), {"instance 1", "'other' instead of 'one'"});
  }
  {
    Family off(2, [](int k) { return chain(2, k); });
    std::vector<State> starts = off.starts();
    starts[1].q[0] += 0.1;
    Copies copies(off.pointers());
    const std::vector<double> times{0.1};
    const auto reports = copies.run(starts, times, [](int, std::size_t, const State&) {});
    CHECK(reports[0].finished);
    CHECK_FALSE(reports[1].finished);
    check_words(reports[1].error, {"the start", "violates the constraints by 0.1"});
  }
  Family family(2, [](int k) { return chain(2, k); });
  CopiesOptions options;
  options.integrator = "radau5";
  check_words(message([&] { Copies c(family.pointers(), options); }), {"radau5"});
  Copies copies(family.pointers());
  const std::vector<State> one{family.starts()[0]};
  check_words(message([&] { copies.run(one, std::vector<double>{0.5}, {}); }), {"1 states for 2 instances"});
  check_words(message([&] { copies.run(family.starts(), std::vector<double>{1.0, 0.5}, {}); }), {"ascending"});
  check_words(message([&] { Copies c({}); }), {"at least one"});
}

}  // namespace copies_test
