// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <spdlog/spdlog.h>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/log.h>
#include <lockstep/recorder.h>
#include <lockstep/simulation.h>
#include <lockstep/step_loop.h>
#include "tests/fuzz/answered.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

namespace {

constexpr std::size_t kMostBodies = 6, kMostLinks = 10, kMostCalls = 60;
constexpr long kMostSteps = 40;

// Numbers and choices from the input; zeros after its end.
class Choices {
 public:
  explicit Choices(Bytes bytes) : bytes_(bytes) {}
  bool left() const { return at_ < bytes_.size(); }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : next() % n; }
  double number() {
    static constexpr double kNumbers[] = {0, 1, -1, 0.5, 2, 1e-3, 9.81, 1e6, 1e-9, -0.25, 3, 0.1, 1e308, -1e-308};
    const std::size_t k = next();
    if (k == 255) return std::numeric_limits<double>::quiet_NaN();
    if (k == 254) return std::numeric_limits<double>::infinity();
    return k < 128 ? kNumbers[k % 14] : (static_cast<double>(k) - 190) / 64;
  }
  double mild() { return (static_cast<double>(next()) - 128) / 128; }
  Vec3 vector() { return next() % 16 == 0 ? Vec3(number(), number(), number()) : Vec3(mild(), mild(), mild()); }
  Quat turn() {
    return next() % 8 == 0 ? Quat{number(), number(), number(), number()} : exponential(Vec3(mild(), mild(), mild()));
  }
  Pose pose() {
    const Vec3 x = vector();
    return {x, turn()};
  }

 private:
  std::size_t next() { return at_ < bytes_.size() ? bytes_[at_++] : 0; }
  Bytes bytes_;
  std::size_t at_ = 0;
};

// 0 of finite numbers, whose sum may be beyond all numbers, else NaN.
double none_of(const VecX& x) { return x.allFinite() ? 0 : std::numeric_limits<double>::quiet_NaN(); }

// What code of users may throw.
void throw_something(std::size_t kind) {
  switch (kind) {
    case 1:
      throw 7;
    case 2:
      throw std::runtime_error("from a user");
    case 3:
      throw ModelError("a user's own model error");
    case 4:
      throw "a text";
    default:
      return;
  }
}

class Watcher : public Observer {
 public:
  Watcher(std::size_t where, std::size_t kind) : where_(where), kind_(kind) {}
  void start(const Sample&) override { at(0); }
  void step(const Sample& s) override {
    must_be_finite(none_of(s.state.q) + none_of(s.state.v), "a state that an observer sees");
    at(1);
  }
  void jumped(const Sample&) override { at(2); }
  void output(const Sample&) override { at(3); }
  void finish(const Sample&) override { at(4); }

 private:
  void at(std::size_t here) {
    if (where_ == here && !thrown_) thrown_ = true, throw_something(kind_);
  }
  std::size_t where_, kind_;
  bool thrown_ = false;
};

// A system and what works on it, all of which the input calls in any order.
class Player {
 public:
  Player(Choices& choices, const Registry& registry)
      : c_(choices),
        registry_(registry),
        other_(std::make_unique<System>()),
        system_(std::make_unique<System>(System::Options{{0, -9.81, 0}})) {}

  void play() {
    for (std::size_t n = 0; c_.left() && n < kMostCalls; ++n) {
      answered([&] { call(c_.below(24)); });
      if (loop_) check(loop_->state());
    }
  }

 private:
  static void check(const State& s) {
    must_be_finite(s.t, "the time");
    must_be_finite(none_of(s.q), "a position");
    must_be_finite(none_of(s.v), "a velocity");
  }
  std::string name(const char* kind, std::size_t n) {
    return c_.below(32) == 31 ? "" : kind + std::to_string(c_.below(16) == 15 ? 0 : n);
  }

  Body& body() {
    const std::size_t n = system_->bodies().size(), k = c_.below(n + 1);
    if (k == n) return other_->ground();
    return system_->body(system_->bodies()[k].name);
  }
  Marker& marker() {
    const std::size_t n = system_->markers().size();
    if (n == 0 || c_.below(16) == 15) return foreign();
    return system_->marker(system_->markers()[c_.below(n)].name);
  }
  Marker& foreign() {
    if (other_->markers().empty()) other_->add_marker("foreign", other_->ground());
    return other_->marker("foreign");
  }
  bool full() const { return system_->links().size() + system_->forces().size() >= kMostLinks; }

  void add_body() {
    if (system_->bodies().size() > kMostBodies) return;
    MassProperties mass;
    mass.mass = c_.below(8) == 0 ? c_.number() : 1 + c_.mild();
    mass.J = Vec3(1 + c_.mild() / 4, 1, 1).asDiagonal();
    if (c_.below(8) == 0) mass.J(0, 1) = mass.J(1, 0) = c_.number();
    mass.center = c_.below(4) == 0 ? c_.vector() : Vec3::Zero();
    Body& b = system_->add_body(name("b", system_->bodies().size()), mass, c_.pose());
    b.start = {c_.vector(), c_.vector()};
  }
  void add_link() {
    if (full()) return;
    Body &p = body(), &s = body();
    const Pose at = c_.pose();
    const std::string n = name("l", system_->links().size());
    switch (c_.below(10)) {
      case 0:
        system_->add<Revolute>(n, p, s, at);
        break;
      case 1:
        system_->add<Spherical>(n, p, s, at);
        break;
      case 2:
        system_->add<Prismatic>(n, p, s, at);
        break;
      case 3:
        system_->add<Fixed>(n, p, s, at);
        break;
      case 4:
        system_->add<Universal>(n, p, s, at);
        break;
      case 5:
        system_->add<PointOnPlane>(n, p, s, at);
        break;
      case 6:
        system_->add<Cylindrical>(n, p, s, at);
        break;
      case 7:
        system_->add<Distance>(n, marker(), marker());
        break;
      case 8:
        system_->add<Oldham>(n, marker(), marker());
        break;
      default:
        system_->add<Revolute>(n, marker(), marker());
    }
  }
  void add_force() {
    if (full()) return;
    const std::string n = name("f", system_->forces().size());
    switch (c_.below(4)) {
      case 0:
        system_->add<SpringDamper>(n, marker(), marker(),
                                   {.stiffness = c_.number(), .damping = c_.number(), .free_length = c_.number()});
        break;
      case 1:
        system_->add<TorsionSpringDamper>(n, marker(), marker(), {.stiffness = c_.number(), .damping = c_.number()});
        break;
      default: {
        Marker& at = marker();
        const double push = c_.number();
        const std::size_t kind = c_.below(6), calls = c_.below(40);
        auto count = std::make_shared<std::size_t>(0);
        system_->add(function_force(n, {&at}, [=, &at](const Inputs& in, WrenchSum& out) {
          if (++*count == calls) throw_something(kind);
          out.force(at.body->slot, Vec3(push, 0, 0), in_world(MarkerFrame(at), in).x);
        }));
      }
    }
  }
  void make_dynamics() {
    static const char* const kSolvers[] = {"schur", "dense", "block", "sparse"};
    static const Formulation kFormulations[] = {Formulation::omega, Formulation::quaternion, Formulation::joint,
                                                Formulation::automatic};
    simulation_.reset(), loop_.reset(), observers_.clear(), dynamics_.reset();
    DynamicsOptions options;
    options.formulation = kFormulations[c_.below(4)];
    options.stabilization.kind = static_cast<Stabilization::Kind>(c_.below(3));
    dynamics_ = std::make_unique<Dynamics>(
        *system_, make_solver(MethodSpec{kSolvers[c_.below(4)]}, registry_, "solver"), options);
    state_ = system_->start();
  }
  std::unique_ptr<Integrator> integrator() {
    const std::vector<std::string> names = registry_.integrators.names();
    return make_integrator(MethodSpec{names[c_.below(names.size())]}, registry_, "integrator");
  }
  void make_loop() {
    if (!dynamics_) make_dynamics();
    simulation_.reset(), loop_.reset(), observers_.clear();
    loop_ = std::make_unique<StepLoop>(*dynamics_, integrator(),
                                       StepLoopOptions{.step = c_.below(8) == 0 ? c_.number() : 0.002,
                                                       .tolerance = {1e-4, 1e-6},
                                                       .output = 0.005,
                                                       .max_steps = kMostSteps});
  }
  void simulate() {
    dynamics_.reset(), loop_.reset(), observers_.clear();
    const std::vector<std::string> names = registry_.integrators.names();
    simulation_ = std::make_unique<Simulation>(*system_,
                                               SimulationOptions{.integrator = names[c_.below(names.size())],
                                                                 .tolerance = 1e-4,
                                                                 .step = 0.002,
                                                                 .output = 0.005,
                                                                 .max_steps = kMostSteps},
                                               registry_);
    const Table& table = simulation_->record({"energy.total"});
    try {
      simulation_->run_until(0.02);
    } catch (...) {
      check(table);
      throw;
    }
    check(table);
  }
  static void check(const Table& table) {
    for (const Column& column : table.columns())
      for (const double x : column.values) must_be_finite(x, column.name);
  }
  void add_event() {
    Event event;
    event.name = "e";
    const std::size_t what = c_.below(6), kind = c_.below(5);
    if (what == 0)
      event.at = c_.number();
    else
      event.at = 0.001 + 0.003 * static_cast<double>(what);
    if (c_.below(4) == 0)
      event.at = -1, event.value = [kind](const Sample& s) { return throw_something(kind), s.state.t - 0.004; };
    if (c_.below(3) == 0)
      event.change = [kind, what](State& s) {
        if (what == 1) s.t = 0;
        if (what == 2) s.v *= 2;
        if (what == 3 && s.q.size() > 0) s.q[0] = std::numeric_limits<double>::quiet_NaN();
        if (what == 4) s.q.resize(1);
        throw_something(kind);
      };
    if (c_.below(3) == 0 && !system_->links().empty())
      event.deactivate = {system_->links()[c_.below(system_->links().size())]->name()};
    event.stop = c_.below(4) == 0;
    loop_->add_event(event);
  }

  void call(std::size_t which) {
    switch (which) {
      case 0:
      case 1:
        add_body();
        break;
      case 2:
        system_->add_particle(name("b", system_->bodies().size()), c_.number(), c_.vector());
        break;
      case 3:
        system_->add_marker(name("m", system_->markers().size()), body(), c_.pose());
        break;
      case 4:
      case 5:
      case 6:
        add_link();
        break;
      case 7:
        add_force();
        break;
      case 8:
        system_->set_planar(Plane{static_cast<int>(c_.below(4)) - 1});
        break;
      case 9:
        system_->set_gravity(c_.vector());
        break;
      case 10:
        system_->setup();
        break;
      case 11:
        make_dynamics();
        break;
      case 12:
        make_loop();
        break;
      case 13:
        if (loop_) loop_->step(c_.below(4) == 0 ? c_.number() : 0);
        break;
      case 14:
      case 15:
        if (loop_) loop_->run_until(loop_->state().t + (c_.below(8) == 0 ? c_.number() : 0.01));
        break;
      case 16:
        if (loop_) add_event();
        break;
      case 17:
        if (loop_) {
          observers_.push_back(std::make_unique<Watcher>(c_.below(6), c_.below(5)));
          loop_->add_observer(*observers_.back());
        }
        break;
      case 18:
        evaluate();
        break;
      case 19:
        if (dynamics_) assemble(*dynamics_, state_);
        break;
      case 20:
        if (loop_) loop_->set_state(damaged(loop_->state()));
        break;
      case 21:
        simulate();
        break;
      case 22:
        system_->set_merge(c_.below(2) == 0);
        break;
      default:
        system_->changed();
    }
  }
  State damaged(State s) {
    switch (c_.below(6)) {
      case 0:
        s.q.resize(0);
        break;
      case 1:
        s.v.setConstant(c_.number());
        break;
      case 2:
        s.modes.push_back(true);
        break;
      case 3:
        s.t = c_.number();
        break;
      default:
        break;
    }
    return s;
  }
  void evaluate() {
    if (!dynamics_) return;
    const State s = damaged(state_);
    StateRate rate;
    switch (c_.below(6)) {
      case 0:
        dynamics_->rates(s, rate);
        break;
      case 1:
        dynamics_->evaluate(s);
        break;
      case 2:
        dynamics_->gather(s);
        break;
      case 3:
        must_be_finite(dynamics_->violation(s), "a violation");
        break;
      case 4:
        dynamics_->project(state_), check(state_);
        break;
      default:
        dynamics_->project_velocity(state_), check(state_);
    }
  }

  Choices& c_;
  const Registry& registry_;
  std::unique_ptr<System> other_, system_;
  std::unique_ptr<Dynamics> dynamics_;
  std::vector<std::unique_ptr<Watcher>> observers_;
  std::unique_ptr<StepLoop> loop_;
  std::unique_ptr<Simulation> simulation_;
  State state_;
};

}  // namespace

void api(Bytes bytes) {
  static const Registry registry = [] {
    logger()->set_level(spdlog::level::off);
    return builtin_registry();
  }();
  Choices choices(bytes);
  Player(choices, registry).play();
}

}  // namespace lockstep::fuzz
