// SPDX-License-Identifier: BSD-3-Clause
// Errors as data, and the one way in which an exception gets the name of its culprit.
#include <lockstep/error.h>

#include <cmath>
#include <new>
#include <stdexcept>

#include <lockstep/body.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace error_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const Thing kOurs{.kind = "joint", .name = "A", .type = "revolute", .origin = "built in"};
const Thing kHosts{.kind = "force", .name = "F", .type = "wind"};
const Thing kPlugins{.kind = "force", .name = "F", .type = "wind", .origin = "weather"};

// Throws `thrown` in this context.
template <class T>
void throw_in(const ErrorContext& context, const T& thrown) {
  in_context([&] { return context; }, [&] { throw thrown; });
}

// The E that comes of it.
template <class E, class T>
E error_of(const ErrorContext& context, const T& thrown) {
  try {
    throw_in(context, thrown);
  } catch (const E& error) {
    return error;
  }
  throw std::logic_error("nothing was thrown");
}

}  // namespace

TEST_CASE("an error's sentence is made of its data", "[unit][errors]") {
  CHECK(std::string(ModelError(ErrorData{.problem = "no mass"}).what()) == "no mass");
  const SceneError error(ErrorData{.thing = {.kind = "body", .name = "rod"},
                          .key = "mass",
                          .problem = "is -1 kg",
                          .advice = "give one above zero",
                          .file = "four_bar.json",
                          .line = 4,
                          .column = 12});
  CHECK(std::string(error.what()) == "four_bar.json:4:12: body 'rod': mass is -1 kg; give one above zero");
  CHECK(std::isnan(error.t));
  CHECK(std::string(StepError(ErrorData{.problem = "too short", .t = 0.5}).what()) == "t = 0.5 s: too short");
  CHECK(std::string(ParameterError({.kind = "law", .name = "sine"}, "omega", "is -1; must be above 0").what()) ==
        "law 'sine': omega is -1; must be above 0");
}

TEST_CASE("problem, advice and fact of an error are parts of its sentence", "[unit][errors]") {
  ParameterError refused({.kind = "law", .name = "sine"}, "omega", "is -1; must be above 0");
  CHECK(refused.problem == "is -1");
  CHECK(refused.advice == "must be above 0");
  CHECK(refused.fact() == "law 'sine': omega is -1");
  refused.attribute({.kind = "joint", .name = "A"}, "joint 'A' (revolute)");
  CHECK(refused.fact() == "joint 'A' (revolute): law 'sine': omega is -1");
  const StepError stopped("t = 1 s: the step is too short (by far; by half); use another method; or a smaller step",
                          1.0);
  CHECK(stopped.problem == "t = 1 s: the step is too short (by far; by half)");
  CHECK(stopped.advice == "use another method; or a smaller step");
  CHECK(stopped.fact() == stopped.problem);
  const StepError named("a pivot is zero; in the last step; give masses", {.advice = "give masses"});
  CHECK(named.problem == "a pivot is zero; in the last step");
  CHECK(SolveError("no solution").fact() == "no solution");
}

TEST_CASE("every class reports its kind", "[unit][errors]") {
  using Kind = Error::Kind;
  CHECK(ModelError("x").kind() == Kind::model);
  CHECK(ParameterError({}, "k", "x").kind() == Kind::model);
  CHECK(AssemblyError("x").kind() == Kind::assembly);
  CHECK(SolveError("x").kind() == Kind::solve);
  CHECK(StepError("x", 1.0).kind() == Kind::step);
  CHECK(StepError("x", 1.0).t == 1.0);
  CHECK(NonFiniteError("x", 2.0).kind() == Kind::non_finite);
  CHECK(PluginError("x").kind() == Kind::plugin);
  CHECK(SceneError("x").kind() == Kind::scene);
  CHECK(FileError("x").kind() == Kind::file);
  CHECK(UserCodeError("x").kind() == Kind::user_code);
  CHECK(InterruptedError("x").kind() == Kind::interrupted);
  CHECK(std::string(to_string(Kind::non_finite)) == "not finite");
}

TEST_CASE("a label is put behind the place, once", "[unit][errors]") {
  SceneError error("a.json:2:3: law.slope: is of no use", "a.json", 2, 3);
  error.attribute(kPlugins, kPlugins.label());
  error.attribute(kOurs, kOurs.label());
  CHECK(std::string(error.what()) == "a.json:2:3: force 'F' (wind of plugin weather): law.slope: is of no use");
  CHECK(error.thing.name == "F");
  SceneError named("a.json:2:3: force 'F': is of no use", "a.json", 2, 3);
  named.attribute(kPlugins, kPlugins.label());
  CHECK(std::string(named.what()) == "a.json:2:3: force 'F' (wind of plugin weather): is of no use");
  SceneError made("a.json:2:3: force 'F', speed: is 0", "a.json", 2, 3);
  made.attribute({.kind = "force", .type = "wind", .origin = "weather"}, "force 'F' (wind of plugin weather)");
  CHECK(std::string(made.what()) == "a.json:2:3: force 'F' (wind of plugin weather), speed: is 0");
}

TEST_CASE("an exception that is no Error becomes UserCodeError with its object, its time and the original",
          "[unit][errors]") {
  const ErrorContext context{.thing = kPlugins, .t = 0.25};
  const auto error = error_of<UserCodeError>(context, 7);
  CHECK(std::string(error.what()) ==
        "t = 0.25 s: force 'F' (wind of plugin weather) threw: an object of type int, which is not a std::exception");
  CHECK(error.thing.origin == "weather");
  CHECK(error.t == 0.25);
  CHECK(message_of<UserCodeError>([&] { throw_in({.thing = kHosts}, std::length_error("too long")); }) ==
        "force 'F' (wind) threw: too long");
  try {
    throw_in(context, std::length_error("too long"));
  } catch (const UserCodeError& thrown) {
    CHECK_THROWS_AS(std::rethrow_if_nested(thrown), std::length_error);
  }
}

TEST_CASE("built-in code without a law at fault passes what is no Error, with one it names the law", "[unit][errors]") {
  CHECK_THROWS_AS(throw_in({.thing = kOurs}, std::bad_alloc()), std::bad_alloc);
  CHECK(message_of<UserCodeError>([] {
          throw_in({.thing = kOurs, .t = 1, .fault = "the law of drive rz threw: no more"},
                   std::runtime_error("no more"));
        }) == "t = 1 s: joint 'A' (revolute): the law of drive rz threw: no more");
}

TEST_CASE("an error of a built-in law stays a ModelError, with joint, law and time", "[unit][errors]") {
  const ModelError end("law 'spline': the end", {.thing = {.kind = "law", .type = "spline", .origin = "built in"}});
  for (const Thing& whose : {kOurs, Thing{.kind = "joint", .name = "A", .type = "revolute"}}) {
    const auto refused = error_of<ModelError>(
        {.thing = whose, .t = 1, .fault = "the law of drive rz threw: law 'spline': the end"}, end);
    CHECK(std::string(refused.what()) ==
          "t = 1 s: joint 'A' (revolute): the law of drive rz threw: law 'spline': the end");
    CHECK(refused.thing.name == "A");
    CHECK(refused.t == 1);
    CHECK(refused.kind() == Error::Kind::model);
  }
  // the law is none of those that the link names: a curve asked at another argument than the time
  CHECK(message_of<ModelError>([&] { throw_in({.thing = kOurs, .t = 1}, end); }) ==
        "t = 1 s: joint 'A' (revolute): law 'spline': the end");
  // what asks on the way to the host adds nothing
  CHECK(message_of<ModelError>([&] {
          in_context([] { return ErrorContext{.thing = {.kind = "observer"}, .t = 2}; },
                     [&] { throw_in({.thing = kOurs, .t = 1}, end); });
        }) == "t = 1 s: joint 'A' (revolute): law 'spline': the end");
  // of a plugin, and of a law of the host
  CHECK(error_of<UserCodeError>({.thing = kPlugins, .t = 1}, end).thing.origin == "weather");
  CHECK(message_of<UserCodeError>([&] {
          throw_in({.thing = kOurs, .t = 1, .fault = "the law of drive rz threw: the end"}, ModelError("the end"));
        }) == "t = 1 s: joint 'A' (revolute): the law of drive rz threw: the end");
}

TEST_CASE("an Error of a plugin is its own in use and keeps its type at construction", "[unit][errors]") {
  CHECK(message_of<UserCodeError>([] { throw_in({.thing = kPlugins, .t = 1}, ModelError("no speed")); }) ==
        "t = 1 s: force 'F' (wind of plugin weather) threw: no speed");
  const auto refused = error_of<ModelError>({.thing = kPlugins, .refuses = true}, ModelError("no speed"));
  CHECK(std::string(refused.what()) == "force 'F' (wind of plugin weather): no speed");
  CHECK(refused.thing.name == "F");
  CHECK(message_of<SolveError>([] { throw_in({.thing = kPlugins, .refuses = true}, SolveError("no solution")); }) ==
        "no solution");
}

TEST_CASE("an Error of the host is named in front of its words, one of the library notes its thing alone",
          "[unit][errors]") {
  const auto noted = error_of<ModelError>({.thing = kOurs, .t = 1}, ModelError("no speed"));
  CHECK(std::string(noted.what()) == "no speed");
  CHECK(noted.thing.words() == "joint 'A'");
  const auto named = error_of<ModelError>({.thing = kHosts, .t = 1}, ModelError("no speed"));
  CHECK(std::string(named.what()) == "t = 1 s: force 'F' (wind): no speed");
  CHECK(named.thing.words() == "force 'F'");
  CHECK(named.t == 1);
  const auto of_itself = error_of<ModelError>({.thing = kHosts, .t = 1}, ModelError("force 'F': no speed"));
  CHECK(std::string(of_itself.what()) == "t = 1 s: force 'F': no speed");
  const auto about_another =
      error_of<ModelError>({.thing = kHosts}, ModelError("no mass", {.thing = {.kind = "body", .name = "rod"}}));
  CHECK(about_another.thing.name == "rod");
  CHECK(message_of<NonFiniteError>([] { throw_in({.thing = kPlugins}, NonFiniteError("nan", 1)); }) ==
        "t = 1 s: force 'F' (wind of plugin weather): nan");
  const NonFiniteError told("t = 1 s: body 'rod' is lost", {.thing = {.kind = "body", .name = "rod"}, .t = 1});
  for (const Thing& whose : {kOurs, kHosts, kPlugins})
    CHECK(message_of<NonFiniteError>([&] { throw_in({.thing = whose, .t = 2}, told); }) == told.what());
}

TEST_CASE("a law's label belongs to the pointer that was labelled", "[unit][errors]") {
  struct Nothing final : MotionLaw {
    LawValue at(double) const override { return {std::nan(""), 0, 0}; }
  };
  LawPtr<MotionLaw> bare = std::make_shared<const Nothing>();
  LawPtr<MotionLaw> named = labelled(bare, {"bump", "bumps"});
  const LawPtr<MotionLaw> other = labelled(named, {"hump", "built in"});
  CHECK(label_of(bare) == nullptr);
  CHECK(named.get() == bare.get());
  REQUIRE(label_of(named) != nullptr);
  CHECK(label_of(named)->type == "bump");
  CHECK(label_of(other)->origin == "built in");
  CHECK(law_fault("its law", bare, 0) == "its law gives y = nan, yd = 0, ydd = 0");
  CHECK(law_fault("its law", named, 0) == "its law ('bump' of plugin bumps) gives y = nan, yd = 0, ydd = 0");
  CHECK(law_fault("its law", other, 0) == "its law ('hump') gives y = nan, yd = 0, ydd = 0");
  CHECK(law_fault("its law", LawPtr<MotionLaw>(), 0).empty());
  const std::weak_ptr<const MotionLaw> watched = bare;
  bare.reset(), named.reset();
  CHECK(other->at(0).yd == 0);
  CHECK_FALSE(watched.expired());
}

}  // namespace error_test
