// Scenes: a mechanism as data.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/kernel.h>
#include <lockstep/registry.h>
#include <lockstep/step_loop.h>
#include <lockstep/system.h>

namespace lockstep {

// Scene: a mechanism as data, and the way from a file to a System. One direction: systems are not reverse-engineered.


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

/// A mechanism as data.
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


// Variables: one quantity of a scene each, and the values it takes from run to run.


/// A number of a scene and the values it takes.
struct Variable {
  std::string path;           ///< as it was asked for: "bodies.rod.mass"
  std::string place;          ///< the same, however it was asked for: things of a list by their name
  std::string unit;           ///< of the numbers, "kg"; "" when they have none or it is not known
  std::vector<Value> values;  ///< numbers in SI, words, true or false; one at least
  std::string near{};         ///< the closest number of the scene, when this is none of it yet
};

/// "NAME=a:b:n": n numbers evenly from a to b; "NAME=v1,v2,...": these values. NAME is a path (find_place); numbers
/// are SI, or carry units as in scenes. Throws ModelError or SceneError naming the path: no such place (with the
/// nearest), values that cannot stand there, and what decides on the columns, which are the same in all runs.
LOCKSTEP_API Variable read_variable(const std::string& text, const Scene&, const Registry&);

/// Of several; refuses the same place twice.
LOCKSTEP_API std::vector<Variable> read_variables(const std::vector<std::string>& texts, const Scene&, const Registry&);

/// The scene with value choice[k] of variable k in its place; its run settings are read anew. Throws SceneError for
/// settings that cannot be; the rest is checked by build().
LOCKSTEP_API Scene varied(const Scene&, const std::vector<Variable>&, const std::vector<std::size_t>& choice,
                          const Registry&);

/// "bodies.rod.mass = 2 kg, gravity.1 = -9.81".
LOCKSTEP_API std::string setting_text(const std::vector<Variable>&, const std::vector<std::size_t>& choice);

/// A value as it stands in a table: number in shortest form, word, true or false.
LOCKSTEP_API std::string plain_text(const Value&);

}  // namespace lockstep
