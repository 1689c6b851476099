// SPDX-License-Identifier: BSD-3-Clause
// Whatever code of the host's throws, of whichever kind it is: the error tells kind, name and time, in its data and at
// the beginning of its sentence, and nests what was thrown.
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/couplings.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace user_code_kinds_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

constexpr double kFrom = 0.3;

/// Code of the host's, of every kind, that throws from t = 0.3 s on.
struct Code {
  std::string kind;
  std::function<void()> thrown;
  void at(const char* here, double t) const {
    if (kind == here && t >= kFrom) thrown();
  }
};

struct OwnLaw final : MotionLaw {
  const Code& code;
  explicit OwnLaw(const Code& c) : code(c) {}
  LawValue at(double t) const override {
    code.at("law", t);
    return {t, 1, 0};
  }
};

/// x of P in S is zero.
struct OwnRow {
  const Code* code;
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    code->at("link", value_of(y.t));
    return y.x;
  }
  static double value_of(double t) { return t; }
  template <class T>
  static double value_of(const T& t) {
    return value_of(t.v);
  }
};
struct OwnLink final : PhiLock<OwnRow> {
  using PhiLock::PhiLock;
  std::string_view type() const override { return "own_link"; }
};

struct OwnState final : Auxiliary {
  const Code& code;
  explicit OwnState(const Code& c) : Auxiliary("controller"), code(c) {}
  int size() const override { return 1; }
  void rates(const Evaluated& at, std::span<double> sd) const override {
    code.at("integrated state", at.in.t);
    sd[0] = 1;
  }
};

struct OwnMethod final : Integrator {
  const Code& code;
  explicit OwnMethod(const Code& c) : code(c) {}
  IntegratorInfo info() const override { return {.name = "euler"}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& y, double h) override {
    code.at("integrator", y.t);
    StateRate rate;
    dynamics.rate(y, rate);
    dynamics.advance(y, h, y.v);
    y.v += h * rate.v, y.s += h * rate.s, y.t += h;
    dynamics.project(y);
    return {.h = h};
  }
};

struct OwnObserver final : Observer {
  const Code& code;
  explicit OwnObserver(const Code& c) : code(c) {}
  void step(const Sample& s) override { code.at("observer", s.state.t); }
};

/// A rod on a hinge, another that glides, and all kinds of code.
void run(const Code& code) {
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  Body& other = system.add_body("other", shapes::rod(1.0, {0, 1, 0}, {1, 1, 0}));
  auto& hinge = system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  hinge.drive(Axis::rz, std::make_shared<OwnLaw>(code));
  Marker &p = system.add_marker("p", other), &s = system.add_marker_at("s", system.ground(), pose_at({0.5, 1, 0}));
  system.add(std::make_unique<OwnLink>("rail", p, s, Mask::none, OwnRow{&code}));
  system.add(function_force("pull", {&p}, [&](const Inputs& in, WrenchSum& out) {
    code.at("force", in.t);
    out.force(other.slot, {0, 1, 0}, in.slot(other.slot).x);
  }));
  system.add(std::make_unique<OwnState>(code));
  Recorder recorder(system);
  recorder.add("price", "EUR", [&](const Sample& at) {
    code.at("channel", at.state.t);
    return 1.0;
  });
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  State start = system.start();
  assemble(dynamics, start);
  std::unique_ptr<Integrator> method = std::make_unique<Rk4>();
  if (code.kind == "integrator") method = std::make_unique<OwnMethod>(code);
  StepLoop loop(dynamics, std::move(method), {.step = 0.0625});
  loop.set_state(start);
  OwnObserver observer(code);
  loop.add_observer(recorder), loop.add_observer(observer);
  Event asks{.name = "asks"}, acts{.name = "acts", .at = kFrom};
  asks.value = [&](const Sample& at) {
    code.at("condition", at.state.t);
    return 1.0;
  };
  acts.change = [&](State& state) { code.at("change", state.t); };
  loop.add_event(asks), loop.add_event(acts);
  loop.progress = [&](const State& state) {
    code.at("progress", state.t);
    return true;
  };
  loop.between_steps = [&] { code.at("between_steps", loop.state().t); };
  loop.run_until(1);
}

struct Told {
  const char *where, *kind, *name, *words;  // `words`: how the sentence names it
};
const Told kTold[] = {
    {"law", "joint", "hinge", "joint 'hinge' (revolute): the law of drive rz"},
    {"link", "joint", "rail", "joint 'rail' (own_link)"},
    {"force", "force", "pull", "force 'pull' (function_force)"},
    {"integrated state", "integrated state", "controller", "integrated state 'controller'"},
    {"integrator", "integrator", "euler", "integrator 'euler'"},
    {"channel", "channel", "price", "channel 'price'"},
    {"observer", "observer", "2", "observer 2 (user_code_kinds_test::(anonymous namespace)::OwnObserver)"},
    {"condition", "event", "asks", "event 'asks'"},
    {"change", "event", "acts", "event 'acts'"},
    {"progress", "progress", "", "progress"},
    {"between_steps", "between_steps", "", "between_steps"},
};

/// What to throw, the class that it arrives as, and what is nested in it.
struct Thrown {
  const char* what;
  std::function<void()> act;
  Error::Kind arrives;
  std::function<bool(const std::exception_ptr&)> is_it;
};

template <class T>
std::function<bool(const std::exception_ptr&)> is(const std::string& words) {
  return [words](const std::exception_ptr& nested) {
    try {
      if (nested) std::rethrow_exception(nested);
    } catch (const T& thrown) {
      if constexpr (std::is_base_of_v<std::exception, T>)
        return std::string(thrown.what()) == words;
      else
        return words.empty();
    } catch (...) {
    }
    return false;
  };
}

const std::vector<Thrown>& all_thrown() {
  using Kind = Error::Kind;
  static const std::vector<Thrown> all{
      {"int", [] { throw 7; }, Kind::user_code, is<int>("")},
      {"runtime_error", [] { throw std::runtime_error("mine"); }, Kind::user_code, is<std::runtime_error>("mine")},
      {"ModelError", [] { throw ModelError("mine"); }, Kind::model, is<ModelError>("mine")},
      {"StepError", [] { throw StepError("mine"); }, Kind::step, is<StepError>("mine")},
      {"StepError with a time", [] { throw StepError("mine", kFrom); }, Kind::step, is<StepError>("mine")},
      {"NonFiniteError", [] { throw NonFiniteError("mine"); }, Kind::non_finite, is<NonFiniteError>("mine")},
      {"UserCodeError", [] { throw UserCodeError("mine"); }, Kind::user_code, is<UserCodeError>("mine")},
      {"FileError", [] { throw FileError("mine"); }, Kind::file, is<FileError>("mine")},
  };
  return all;
}

std::exception_ptr nested_in(const Error& error) {
  const auto* outer = dynamic_cast<const std::nested_exception*>(&error);
  return outer == nullptr ? nullptr : outer->nested_ptr();
}

}  // namespace

TEST_CASE("exceptions of code of any kind have kind, name and time, and are nested", "[unit][dynamics]") {
  for (const Told& told : kTold)
    for (const Thrown& thrown : all_thrown()) {
      CAPTURE(told.where, thrown.what);
      bool caught = false;
      try {
        run({told.where, thrown.act});
      } catch (const Error& error) {
        caught = true;
        const std::string said = error.what();
        CAPTURE(said);
        // of a law the link speaks, which asks it again to find out that it is at fault
        const bool of_law = std::string_view(told.where) == "law";
        const Error::Kind arrives =
            of_law && thrown.arrives != Error::Kind::non_finite ? Error::Kind::user_code : thrown.arrives;
        CHECK(error.kind() == arrives);
        CHECK(error.thing.kind == told.kind);
        CHECK(error.thing.name == told.name);
        CHECK(error.thing.origin.empty());
        CHECK(error.t >= kFrom);
        CHECK(error.t < kFrom + 0.13);
        CHECK(said.starts_with(at_time(error.t) + told.words));
        CHECK(thrown.is_it(nested_in(error)));
      }
      CHECK(caught);
    }
}

TEST_CASE("a lack of memory in code of any kind is reported as it is", "[unit][dynamics]") {
  for (const Told& told : kTold) {
    CAPTURE(told.where);
    CHECK_THROWS_AS(run({told.where, [] { throw std::bad_alloc(); }}), std::bad_alloc);
  }
}

TEST_CASE("an error class of the host's own keeps its type, with name and time", "[unit][dynamics]") {
  struct Stall final : ModelError {
    using ModelError::ModelError;
  };
  for (const Told& told : kTold) {
    if (std::string_view(told.where) == "law") continue;
    CAPTURE(told.where);
    try {
      run({told.where, [] { throw Stall("stalled"); }});
      FAIL("nothing was thrown");
    } catch (const Stall& stall) {
      CHECK(stall.thing.kind == told.kind);
      CHECK(stall.thing.name == told.name);
      CHECK(std::string(stall.what()) == at_time(stall.t) + told.words + ": stalled");
    }
  }
}

TEST_CASE("an exception of a force during an observer's request has the force's name alone", "[unit][dynamics]") {
  System system;
  Body& bob = system.add_particle("bob", 1, Vec3::Zero());
  Marker& p = system.add_marker("p", bob);
  bool armed = false;
  system.add(function_force("pull", {&p}, [&](const Inputs&, WrenchSum&) {
    if (armed) throw ModelError("mine");
  }));
  struct Asker final : Observer {
    bool& armed;
    explicit Asker(bool& a) : armed(a) {}
    void step(const Sample& s) override {
      armed = s.state.t > 0.2;
      s.dynamics().evaluate(s.state);
    }
  } asker(armed);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 0.125});
  loop.add_observer(asker);
  CHECK(message_of<ModelError>([&] { loop.run_until(1); }) == "t = 0.25 s: force 'pull' (function_force): mine");
}

}  // namespace user_code_kinds_test
