// SPDX-License-Identifier: BSD-3-Clause
// What laws, links, forces and integrators of a plugin do wrong while they are used reaches the host by name.
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/system.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/cause.h"
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/run_with_registry.h"
#include "tests/support/thrown.h"

namespace user_code_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const std::string kModules = std::string(paths::kBuild) + "/test_plugins";

const Registry& naughty() {
  static const Registry registry = [] {
    Registry r = builtin_registry();
    load_plugin(r, "naughty", {kModules});
    return r;
  }();
  return registry;
}

// An arm on a hinge, and whatever else; run for a while.
std::string run(const std::string& links, const std::string& forces = "",
                const std::string& settings = R"("integrator": "rk4", "step": 0.01)") {
  const std::string path = scene_file("naughty", R"("gravity": [0,-9.81,0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}},
               {"name": "other", "rod": {"mass": 1, "from": [2,0,0], "to": [3,0,0]}}],
    "links": [)" + links + "], \"forces\": [" + forces +
                                                     R"(], "run": {)" + settings + R"(, "until": 0.2})");
  return thrown_by([&] { run_with_registry(naughty(), path); });
}

std::string hinge(const std::string& more) {
  return R"({"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0])" + more + "}";
}
std::string driven_by(const std::string& does) {
  return hinge(R"(, "drive": {"axis": "rz", "law": {"type": "naughty_law", "does": ")" + does + "\"}}");
}
std::string bad_link(const std::string& does, const std::string& name = "B", const std::string& body = "arm") {
  return R"({"name": ")" + name + R"(", "type": "naughty_link", "p": ")" + body +
         R"(", "s": "ground", "at": [0,0,0], "does": ")" + does + "\"}";
}
std::string bad_force(const std::string& does) {
  return R"({"name": "F", "type": "naughty_force", "p": "arm", "at": [0,0,0], "does": ")" + does + "\"}";
}
std::string by_method(const std::string& does) {
  return R"("integrator": {"type": "naughty_integrator", "does": ")" + does + R"("}, "step": 0.01)";
}

#define SAYS(text, ...)                                                              \
  do {                                                                               \
    const std::string answer = text;                                                 \
    for (const std::string& part : std::initializer_list<std::string> __VA_ARGS__) { \
      INFO(answer);                                                                  \
      INFO(part);                                                                    \
      CHECK(contains(answer, part));                                                 \
    }                                                                                \
  } while (false)

}  // namespace

TEST_CASE("a valid type of the plugin causes no finding", "[plugin][user_code]") {
  CHECK(run(driven_by("")) == "nothing");
  CHECK(run(bad_link("")) == "nothing");
  CHECK(run(bad_link("") + ", " + bad_link("", "C", "other")) == "nothing");
  CHECK(run(hinge(""), bad_force("")) == "nothing");
  CHECK(run(hinge(""), "", by_method("")) == "nothing");
}

TEST_CASE("an exception of a law reaches the host with the joint, the law, the plugin and the time",
          "[plugin][user_code]") {
  const std::string whose = "joint 'A' (revolute): the law of drive rz ('naughty_law' of plugin naughty) threw: ";
  SAYS(run(driven_by("std")), {"UserCodeError: t = 0.05", whose, "no more"});
  SAYS(run(driven_by("int")),
       {"UserCodeError: t = 0.05", whose, "an object of type int, which is not a std::exception"});
  SAYS(run(driven_by("error")), {"UserCodeError: t = 0.05", whose, "the profile has no point: the table is empty"});
  SAYS(run(hinge(""), R"({"name": "M", "type": "torque_motor", "p": "arm", "s": "ground", "at": [0,0,0],
                         "torque": {"type": "naughty_law", "does": "std"}})"),
       {"UserCodeError: t = 0.05",
        "force 'M' (torque_motor): its law ('naughty_law' of plugin naughty) threw: no more"});
}

TEST_CASE("a law that is no number is named at its first evaluation", "[plugin][user_code]") {
  SAYS(run(driven_by("nan")), {"NonFiniteError: t = 0.05", "joint 'A' (revolute)",
                               "the law of drive rz ('naughty_law' of plugin naughty) gives y = nan, yd = 0, ydd = 0"});
  SAYS(run(driven_by("nan at once")), {"NonFiniteError: t = 0 s", "'naughty_law' of plugin naughty"});
  SAYS(run(hinge(""), R"({"name": "M", "type": "torque_motor", "p": "arm", "s": "ground", "at": [0,0,0],
                         "torque": {"type": "naughty_law", "does": "nan"}})"),
       {"NonFiniteError: t = 0.05", "force 'M' (torque_motor)", "'naughty_law' of plugin naughty"});
}

TEST_CASE("an exception of a joint reaches the host with the joint, the plugin and the time", "[plugin][user_code]") {
  const std::string whose = "joint 'B' (naughty_link of plugin naughty) threw: ";
  SAYS(run(bad_link("std")), {"UserCodeError: t = 0.05", whose, "no more"});
  SAYS(run(bad_link("int")), {"UserCodeError: t = 0.05", whose, "an object of type int"});
  SAYS(run(bad_link("error")), {"UserCodeError: t = 0.05", whose, "the profile has no point: the table is empty"});
  SAYS(run(bad_link("accept")), {"UserCodeError: t = 0.0", whose, "cannot remember"});
  SAYS(run(bad_link("tangent"), "", R"("integrator": "radau5", "tolerance": 1e-6)"),
       {"UserCodeError: t = 0", whose, "no tangent"});
  SAYS(run(bad_link("nan")), {"NonFiniteError: t = 0.06", "joint 'B' (naughty_link of plugin naughty)",
                              "; test naughty_link by check_lock, or "});
  SAYS(run(bad_link("setup")), {"joint 'B' (naughty_link of plugin naughty)", "its rod has no length"});
  SAYS(run(bad_link("setup int")), {"UserCodeError: ", whose, "an object of type int"});
  // the one of two that throws
  SAYS(run(bad_link("") + ", " + bad_link("std", "C", "other")), {"joint 'C' (naughty_link of plugin naughty) threw"});
}

TEST_CASE("an exception of a force or an integrator reaches the host by name", "[plugin][user_code]") {
  const std::string force = "force 'F' (naughty_force of plugin naughty)";
  SAYS(run(hinge(""), bad_force("std")), {"UserCodeError: t = 0.05", force + " threw: no more"});
  SAYS(run(hinge(""), bad_force("int")), {"UserCodeError: t = 0.05", force + " threw: an object of type int"});
  SAYS(run(hinge(""), bad_force("nan")), {"NonFiniteError: t = 0.05", force});
  const std::string method = "integrator 'naughty_integrator' of plugin naughty";
  SAYS(run(hinge(""), "", by_method("begin")), {"UserCodeError: t = 0 s", method + " threw: no beginning"});
  SAYS(run(hinge(""), "", by_method("std")), {"UserCodeError: t = 0.06", method + " threw: no more"});
  SAYS(run(hinge(""), "", by_method("int")), {"UserCodeError: t = 0.06", method + " threw: an object of type int"});
  SAYS(run(hinge(""), "", by_method("error")), {"ModelError: t = 0.06", method, "the table is empty"});
  SAYS(run(hinge(""), "", by_method("step")), {"StepError: ", method, "the step is too long"});
}

TEST_CASE("a joint that writes outside of its constraints is rejected before the first step", "[plugin][user_code]") {
  const std::string whose = "UserCodeError: joint 'B' (naughty_link of plugin naughty) ";
  SAYS(run(bad_link("row")), {whose + "writes outside of its rows"});
  SAYS(run(bad_link("next row")), {whose + "writes outside of its rows, beyond row 2"});
  SAYS(run(bad_link("before")), {whose + "writes outside of its rows"});
  SAYS(run(bad_link("side")), {whose + "writes outside of its rows"});
  SAYS(run(bad_link("unwritten")), {whose + "leaves Ct of constraint z unwritten"});
  SAYS(run(bad_link("states")), {whose + "writes outside of its 1 numbers in start_states()"});
  SAYS(run(bad_link("bad slot")), {whose + "uses slot 77 of 2"});
  SAYS(run(bad_link("first lane") + ", " + bad_link("first lane", "C", "other")),
       {"UserCodeError: joint 'C' (naughty_link of plugin naughty) leaves C of constraint x unwritten"});
  SAYS(run(hinge(""), bad_force("slot")), {"UserCodeError: force 'F' (naughty_force of plugin naughty)", "slot"});
}

TEST_CASE("a maker that fails is named with its plugin", "[plugin][user_code]") {
  const std::string law = "joint 'A', drive.law (naughty_law of plugin naughty)";
  SAYS(run(driven_by("null maker")), {law + ": its maker returned null"});
  SAYS(run(driven_by("maker throws")), {law + " threw: no making"});
  SAYS(run(driven_by("maker throws int")), {law + " threw: an object of type int"});
  SAYS(run(driven_by("maker refuses")), {"SceneError: ", "naughty.json:", "is of no use", law});
}

TEST_CASE("an exception of custom code is nested in the error", "[plugin][user_code]") {
  struct Wind final : Force {
    using Force::Force;
    std::string_view type() const override { return "wind"; }
    std::vector<const Marker*> markers() const override { return {}; }
    void setup() override {}
    void apply(const Inputs&, WrenchSum&) const override { throw std::length_error("too long"); }
  };
  System system;
  system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add(std::make_unique<Wind>("F"));
  Dynamics dynamics(system, std::make_unique<SparseSolver>());
  const State start = system.start();
  bool caught = false;
  try {
    dynamics.evaluate(start);
  } catch (const UserCodeError& error) {
    caught = true;
    CHECK(std::string(error.what()) == "t = 0 s: force 'F' (wind) threw: too long");
    CHECK(error.t == 0);
    CHECK(error.thing.origin.empty());
    CHECK(error.thing.kind == "force");
    CHECK(error.thing.name == "F");
    CHECK(error.thing.type == "wind");
    CHECK_THROWS_AS(std::rethrow_if_nested(error), std::length_error);
  }
  CHECK(caught);
}

TEST_CASE("an exception from a plugin has the plugin's name, for every class", "[plugin][user_code]") {
  struct Wind final : Force {
    std::function<void()> thrown;
    explicit Wind(std::function<void()> what) : Force("F"), thrown(std::move(what)) { set_origin("weather"); }
    std::string_view type() const override { return "wind"; }
    std::vector<const Marker*> markers() const override { return {}; }
    void setup() override {}
    void apply(const Inputs&, WrenchSum&) const override { thrown(); }
  };
  struct Thrown {
    std::function<void()> act;
    Error::Kind arrives;
    std::string says;
  };
  const Thing rod{.kind = "body", .name = "rod"};
  const std::vector<Thrown> all{
      {[] { throw 7; }, Error::Kind::user_code, " threw: an object of type int, which is not a std::exception"},
      {[] { throw ModelError("calm"); }, Error::Kind::user_code, " threw: calm"},
      {[] { throw StepError("calm", 0.0); }, Error::Kind::user_code, " threw: calm"},
      {[&] { throw ModelError("calm", {.thing = rod, .t = 0}); }, Error::Kind::user_code, " threw: calm"},
      {[] { throw NonFiniteError("calm"); }, Error::Kind::non_finite, ": calm"},
      {[] { throw UserCodeError("calm"); }, Error::Kind::user_code, ": calm"},
  };
  for (const Thrown& thrown : all) {
    System system;
    system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    system.add(std::make_unique<Wind>(thrown.act));
    Dynamics dynamics(system, std::make_unique<SparseSolver>());
    const State start = system.start();
    bool caught = false;
    try {
      dynamics.evaluate(start);
    } catch (const Error& error) {
      caught = true;
      CHECK(error.what() == "t = 0 s: force 'F' (wind of plugin weather)" + thrown.says);
      CHECK(error.kind() == thrown.arrives);
      CHECK(error.thing.origin == "weather");
      CHECK(error.t == 0);
      CHECK(dynamic_cast<const std::nested_exception*>(&error) != nullptr);
    }
    CHECK(caught);
  }
}

namespace {

/// The ellipse x^2/0.09 + y^2/0.04 = 1, with x hidden: at (0.3, 0) it has no gradient.
struct Blind {
  static constexpr PhiSpec spec{.reads = Reads::translation, .kind = RowKind::function};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const double x = value_of(y.x);
    return x * x / 0.09 + y.y * y.y / 0.04 - 1.0;
  }
};
struct BlindRail final : PhiLock<Blind> {
  BlindRail(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::z, Blind{}) {}
  std::string_view type() const override { return "blind"; }
};

}  // namespace

TEST_CASE("the cause of a stop names the check of a plugin's joint, and gives the time", "[plugin][user_code]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& bead = system.add_particle("bead", 0.2, {0.3, 0, 0});
  bead.start.v = {0, 3, 0};
  auto& rail = system.add<BlindRail>("rail", system.add_marker("p", bead), system.add_marker("s", system.ground()));
  rail.set_origin("rails");
  Dynamics dynamics(system, std::make_unique<SparseSolver>());
  const Cause cause = cause_of_stop(dynamics, system.start());
  CAPTURE(cause.fact, cause.hint);
  CHECK(contains(cause.fact, "joint rail "));
  CHECK_FALSE(contains(cause.fact, "loop of joints"));
  CHECK(cause.hint.starts_with("first test blind by check_lock; otherwise "));
  CHECK(cause.t == 0);
  try {
    rethrow_with(cause, SolveError("no solution; take another"));
  } catch (const StepError& error) {
    CHECK(std::string(error.what()) == cause.fact + "; " + cause.hint + "; solver: no solution");
    CHECK(error.problem == cause.fact);
    CHECK(error.advice == cause.hint);
    CHECK(error.t == 0);
  }
  CHECK(tests_first(system, {"other"}).empty());
  rail.set_origin("");
  CHECK(tests_first(system).empty());
  for (const char* origin : {"built in", "cams"}) {
    System driven;
    auto& hinge = driven.add<Revolute>("A", driven.add_marker("p", driven.add_particle("b", 1, {0, 0, 0})),
                                       driven.add_marker("s", driven.ground()));
    hinge.drive(Axis::rz, labelled(oracle::value_law([](double t) { return t; }), {"bump", origin}));
    CHECK(tests_first(driven) == (of_plugin(origin).empty() ? "" : "first test bump by check_law; otherwise "));
  }
}

TEST_CASE("an error class of a plugin's own passes setup as it is, a plain one gets the name", "[plugin][user_code]") {
  struct KeyError final : ModelError {
    using ModelError::ModelError;
  };
  struct Wind final : Force {
    bool own;
    explicit Wind(bool own_class) : Force("F"), own(own_class) { set_origin("weather"); }
    std::string_view type() const override { return "wind"; }
    std::vector<const Marker*> markers() const override { return {}; }
    void setup() override {
      if (own) throw KeyError("no speed");
      throw ModelError("no speed");
    }
    void apply(const Inputs&, WrenchSum&) const override {}
  };
  const auto set_up_with = [](bool own) {
    System system;
    system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    system.add(std::make_unique<Wind>(own));
    system.setup();
  };
  CHECK_THROWS_AS(set_up_with(true), KeyError);
  CHECK(thrown_by([&] { set_up_with(false); }) == "ModelError: force 'F' (wind of plugin weather): no speed");
}

}  // namespace user_code_test
