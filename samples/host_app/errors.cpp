// SPDX-License-Identifier: BSD-3-Clause
// Every type of error of <lockstep/error.h>: how to catch it, what it carries, and what provokes it.
#include "errors.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>

using namespace lockstep;

namespace {

const char* name_of(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::scene:
      return "SceneError";  // a scene or a parameter that cannot be understood
    case Error::Kind::non_finite:
      return "NonFiniteError";  // a law, force or link gave a NaN
    case Error::Kind::step:
      return "StepError";  // the integrator cannot go on: smaller steps, another method
    case Error::Kind::model:
      return "ModelError";
    case Error::Kind::assembly:
      return "AssemblyError";
    case Error::Kind::solve:
      return "SolveError";
    case Error::Kind::plugin:
      return "PluginError";
    case Error::Kind::user_code:
      return "UserCodeError";  // a class of yours or of a plugin threw: that is nested in it
    case Error::Kind::file:
      return "FileError";
    default:
      return "Error";  // types that come later
  }
}

}  // namespace

// All derive from Error, Error from std::runtime_error; each may be caught by its own type too. Nobody has to read the
// sentence: what it says is there as data.
std::string handled(const std::function<void()>& work, std::string& words) {
  try {
    work();
    return "";
  } catch (const Error& e) {
    words = e.what();
    if (!e.file.empty())
      words += " [file '" + e.file + "', line " + std::to_string(e.line) + ", column " + std::to_string(e.column) + "]";
    if (!std::isnan(e.t)) words += " [t = " + text::brief(e.t) + " s]";
    if (e.thing.known()) words += " [about " + e.thing.label() + "]";
    return name_of(e.kind());
  }
}

namespace {

/// A slider whose height follows each of the laws.
struct Slider {
  explicit Slider(std::initializer_list<LawPtr<MotionLaw>> laws) {
    Body& body = system.add_body("slider", shapes::box(1.0, {0.1, 0.1, 0.1}));
    for (const auto& law : laws)
      system.add<Prismatic>("guide" + std::to_string(system.links().size()), body, system.ground(), pose_at({0, 0, 0}))
          .drive(Axis::z, law);
  }
  void run(const char* method, double step, const Registry& registry) {
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop simulation(dynamics, registry.integrators.make(method, Params{}, &registry, "host_app"), {.step = step});
    simulation.run_until(1.0);
  }
  System system;
};

template <class F>
LawPtr<MotionLaw> function(F f) {
  return laws::law(f);
}

}  // namespace

int provoke_them_all(const Registry& registry) {
  struct Provoked {
    const char* type;
    std::function<void()> work;
  };
  const LawPtr<MotionLaw> still = function([](auto t) { return 0.0 * t; });
  const Provoked table[] = {
      {"ModelError",
       [] {
         System().add_body("feather", shapes::rod(-1.0, {0, 0, 0}, {1, 0, 0}));
       }},
      {"AssemblyError",  // the start is not on the constraints, and nobody called assemble()
       [&] { Slider({function([](auto t) { return 0.1 + 0.0 * t; })}).run("dopri5", 0, registry); }},
      {"SolveError",  // two drives that agree in position and speed, but not in acceleration
       [&] {
         Slider({still, function([](auto t) { return t * t; })}).run("dopri5", 0, registry);
       }},
      {"StepError",  // a speed that has no bound
       [&] { Slider({function([](auto t) { return 0.1 * t * t / (0.5 - t); })}).run("dopri5", 0, registry); }},
      {"NonFiniteError",
       [&] { Slider({function([](auto t) { return 0.0 * sqrt(0.5 - t); })}).run("rk4", 0.01, registry); }},
      {"PluginError",
       [] {
         Registry mine = builtin_registry();
         load_plugin(mine, "no_such_plugin");
       }},
      {"UserCodeError",
       [&] {
         const auto broken = [](auto t) {
           if (t <= 1.0) throw std::runtime_error("the table is empty");
           return t;
         };
         Slider({function(broken)}).run("rk4", 0.01, registry);
       }},
      {"SceneError",
       [&] {
         build_mechanism(
             scene_from_text("{\"lockstep\": 1,\n \"bodies\": [{\"name\": \"rod\", \"mass\": \"1 m\"}]}", "typed.json"),
             registry);
       }},
      {"FileError", [] { read_scene("no_such_folder/scene.json"); }}};

  int wrong = 0;
  for (const Provoked& provoked : table) {
    std::string words;
    const std::string type = handled(provoked.work, words);
    std::printf("%-15s %s\n", type.c_str(), words.c_str());
    if (type != provoked.type) {
      std::printf("  but a %s was expected\n", provoked.type);
      ++wrong;
    }
  }
  return wrong;
}
