// Scene: a mechanism as data, and the way from a file to a System. One direction: systems are not reverse-engineered.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/simulate/assembly.h"
#include "framework/dynamics/simulate/event.h"
#include "framework/dynamics/simulate/step_loop.h"
#include "framework/mechanism/lock/mask.h"
#include "framework/description/registry/method_spec.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

/// A channel to record, under a name of the user's own ("" : the channel's).
struct ChannelRequest {
  std::string channel, name;
  Where where{};
};

/// The object "run". Zero stands for "not given" in step, until and output.
struct RunSettings {
  MethodSpec integrator{"dopri5"}, solver{"schur"};
  double step = 0, until = 0, output = 0;  ///< s
  std::vector<double> times{};             ///< s, rising
  Tolerance tolerance;
  Formulation formulation = Formulation::omega;
  Stabilization stabilization;
  bool assemble = true;
  std::vector<ChannelRequest> record{};
  std::vector<std::vector<std::string>> draw{};  ///< panels of the picture, each recorded names; empty: by unit
  Where where{};
};

struct Scene {
  Value root;
  std::string file;  ///< as it was asked for; "" when given in C++
  std::string title, description;
  std::vector<std::string> plugins{};  ///< "requires"
  RunSettings run;                     ///< may be changed before build()
};

/// Reads a file. Throws FileError; SceneError with file, line, column, owner, value and next move.
LOCKSTEP_API Scene read_scene(const std::string& path);
/// The same from a text or from data made in C++; `file` stands in messages.
LOCKSTEP_API Scene scene_from_text(const std::string& text, const std::string& file);
LOCKSTEP_API Scene scene_from(Value root, std::string file = {});

/// An event whose condition names a channel ("" : it has none); the condition is value(channel) - crosses.
struct EventRequest {
  Event event;
  std::string channel{};
  double crosses = 0;
  Where where{};
};

/// What a scene describes, ready to run.
struct Mechanism {
  System system;
  RunSettings run;
  std::vector<VelocityTarget> start_speeds{};
  std::vector<EventRequest> events{};
};

/// Makes the mechanism and sets the system up. Throws SceneError with the place for everything that cannot be, also for
/// what makers and the System refuse.
LOCKSTEP_API Mechanism build(const Scene&, const Registry&);

/// The integrator that the settings name, its tolerance set. Throws SceneError: unknown, or a fixed step without a
/// step.
LOCKSTEP_API std::unique_ptr<Integrator> make_integrator(const RunSettings&, const Registry&);
LOCKSTEP_API std::unique_ptr<LinearSolver> make_solver(const RunSettings&, const Registry&);

}  // namespace lockstep
