// SPDX-License-Identifier: BSD-3-Clause
// Scenes: a mechanism as data.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/mask.h>
#include <lockstep/author/params.h>
#include <lockstep/dynamics_options.h>
#include <lockstep/solid.h>
#include <lockstep/step_loop.h>
#include <lockstep/system.h>

namespace lockstep {

class LinearSolver;
class Registry;

// Scene: a mechanism as data, and the way from a file to a System. A System is not converted back.

/// A channel to record.
struct ChannelRequest {
  std::string channel,  ///< name of the channel
      name;             ///< name of its column; "": the channel's
  SourceLocation where{};  ///< its place in the file

  const std::string& column() const { return name.empty() ? channel : name; }  ///< the name that its column has
};

/// The object "run" of a scene. 0 in step and output, and a negative number in until, mean that none is given.
struct RunSettings {
  MethodSpec integrator{"dopri5"},               ///< integrator with its keys
      solver{"schur"};                           ///< linear solver with its keys
  double step = 0,                               ///< fixed or largest step, s
      until = -1,                                ///< end of the run, s; 0: its start, one row
      output = 0;                                ///< interval of output times, s
  std::vector<double> times{};                   ///< output times in place of an interval, s, rising
  bool at_jumps = false;                         ///< rows also just before and after jumps
  AuditLimits limits;                            ///< of the energy balance and the constraint violation
  long max_steps = 0;                            ///< limit of the number of steps, beyond it an error; 0: no limit
  Tolerance tolerance;                           ///< error of a step, for adaptive integrators
  Formulation formulation = Formulation::automatic;  ///< unknowns of the equations of motion
  Stabilization stabilization;                       ///< correction of the constraint violation
  bool assemble = true;                          ///< the start is assembled
  NearlyRedundant nearly_redundant = NearlyRedundant::automatic;  ///< treatment of nearly dependent constraints
  std::vector<ChannelRequest> record{};          ///< channels to record
  std::vector<ChannelRequest> require{};         ///< "require" of the scene: conditions, formulas of channels
  /// Panels of the picture: the recorded names in each. Empty: one panel per unit.
  std::vector<std::vector<std::string>> draw{};
  SourceLocation where{};  ///< place of the object in the file
};

/// Reads "auto", "report", "free" or "held". Throws ModelError for another word.
LOCKSTEP_API NearlyRedundant nearly_redundant_from(std::string_view word);

/// A parameter of a scene, or one of its points.
struct SceneParameter {
  std::string name;       ///< as formulas read it
  bool is_point = false;  ///< whether it is one of "points"
  Value value;            ///< a number, or a text with its SI unit; of a vector or a point a list of three
  Value written;          ///< as the scene gives it
};

/// A mechanism as data.
struct Scene {
  Value root;                          ///< the whole object, with the values of formulas and points in their places
  Value written;                       ///< the same with formulas and names as written; null if there are none
  std::string file;                    ///< path as given; "" for a scene made in C++
  std::string title,                   ///< "title", or ""
      description;                     ///< "description", or ""
  std::vector<std::string> plugins{};  ///< names of the plugins that it "requires"
  RunSettings run;                     ///< "run"; may be changed before build_mechanism()
  std::vector<SceneParameter> parameters{};  ///< "parameters", then "points", in their order
  /// Places of formulas in the file with their texts, for messages.
  std::vector<std::pair<SourceLocation, std::string>> formulas{};
  MeshFiles meshes{};  ///< that bodies show; shared with copies and with scenes that differ in values
};

/// Changes the scene as written and the one with the values of its formulas: `change` is called with each.
template <class Change>
void change_root(Scene& scene, Change&& change) {
  change(scene.root);
  if (!scene.written.is_null()) change(scene.written);
}

/// Reads a scene from a JSON file. Throws FileError, and SceneError with file, line, column, owner, value and advice.
LOCKSTEP_API Scene read_scene(const std::string& path);
/// Reads a scene from a JSON text. `file`: its name in messages. Throws SceneError.
LOCKSTEP_API Scene scene_from_text(const std::string& text, const std::string& file);
/// Reads a scene from data made in C++. `file`: its name in messages. Throws SceneError.
LOCKSTEP_API Scene scene_from(Value root, std::string file = {});

/// An event of a scene. If it names a channel, its condition is the channel's value minus `crosses`.
struct EventRequest {
  Event event;            ///< without the condition
  std::string channel{};  ///< name of the channel; "": the event has no condition
  double crosses = 0;     ///< value that the channel crosses, in its unit
  SourceLocation where{};  ///< the channel's place in the file
  std::string given{};    ///< `crosses` as it was written, if it has a unit
  SourceLocation given_where{};  ///< its place in the file
};

/// A system that is read here, and changed by the Simulation that takes it over.
class HeldSystem {
 public:
  HeldSystem() = default;
  /// Bodies, markers, joints and forces keep their addresses.
  HeldSystem(HeldSystem&& other) noexcept : own_(std::move(other.own_)) {}
  /// The same.
  HeldSystem& operator=(HeldSystem&& other) noexcept {
    own_ = std::move(other.own_);
    return *this;
  }

 private:
  System own_;
  friend System& system_of(HeldSystem&);

 public:
  const System& system = own_;  ///< set up
};

/// The mechanism of a scene, ready to run: `Simulation run(std::move(mechanism));`. Its settings, events and targets
/// may be changed before, its system by Simulation::system().
struct LOCKSTEP_API Mechanism : HeldSystem {
  Mechanism();                                 ///< without a body, and with no methods
  RunSettings run;                             ///< of the scene
  std::vector<VelocityTarget> start_speeds{};  ///< initial velocities
  std::vector<EventRequest> events{};          ///< of the scene
  std::vector<Solid> solids{};                 ///< of the bodies, as far as the scene gives their shapes
  std::vector<Look> looks{};                   ///< of the bodies with a key "visual"
  AssemblyOptions assembly{};                  ///< initial coordinates, weights of the bodies' poses
  std::shared_ptr<Registry> methods;           ///< integrators and solvers that `run` may name, and laws
};

/// The same scene, computed in space unless it has a key "planar".
LOCKSTEP_API Scene in_space(Scene);
/// Makes the mechanism of a scene and sets its system up. Throws SceneError, with the place in the file, for all
/// errors, also those of makers and of the System.
LOCKSTEP_API Mechanism build_mechanism(const Scene&, const Registry&);
/// If nothing is recorded: records x, y and z of every body that is not fixed.
LOCKSTEP_API void record_places(Mechanism&);
/// Reads a scene from a file, gives its parameters and other plain values the texts of `set` ({"crank", "0.12 m"},
/// {"run.until", "2 s"}), and makes its mechanism. Plugins that the scene requires and the registry lacks are loaded.
/// If the scene records nothing, record_places() is called. Throws as read_scene(), load_plugin(), set_in_scene() and
/// build_mechanism() do.
LOCKSTEP_API Mechanism read_mechanism(const std::string& file, const Registry&,
                                      const std::vector<std::pair<std::string, std::string>>& set = {});
/// The same of a scene that was read before, or made in C++.
LOCKSTEP_API Mechanism read_mechanism(Scene, const Registry&,
                                      const std::vector<std::pair<std::string, std::string>>& set = {});
/// The same by the built-in registry.
LOCKSTEP_API Mechanism read_mechanism(const std::string& file,
                                      const std::vector<std::pair<std::string, std::string>>& set = {});

/// Makes the integrator that the settings name, with their tolerance. Throws SceneError: an unknown name, invalid keys,
/// or a method with fixed steps if no step is given.
LOCKSTEP_API std::unique_ptr<Integrator> make_integrator(const RunSettings&, const Registry&);
/// Makes the solver that the settings name. Throws SceneError.
LOCKSTEP_API std::unique_ptr<LinearSolver> make_solver(const RunSettings&, const Registry&);

// Variables: one value of a scene each, and the values it takes from run to run.

/// A plain value of a scene (a number, a word, true or false) and the values it takes from run to run.
struct Variable {
  std::string path;           ///< as given, renamed keys by their present name: "bodies.rod.mass"
  std::string place;          ///< the same in one spelling: items of a list by their names if they have one
  std::string unit;           ///< SI unit of the numbers, "kg"; "" when they have none or it is not known
  std::vector<Value> values;  ///< numbers in SI, words, true or false; at least one
  std::string given_unit{};   ///< the unit behind the numbers in the scene; "" for SI numbers
  std::string near{};         ///< the closest path of a number in the scene, if the scene does not give this value
};

/// Reads a variable: "NAME=a:b:n" are n evenly spaced numbers from a to b, "NAME=a:b:n:log" evenly in the logarithm,
/// "NAME=v1,v2,..." these values. NAME is the path of a plain value in the scene, as in "bodies.rod.mass", or the name of
/// a parameter. Numbers are SI, or have units. Throws ModelError or SceneError with the path: no such value (with the
/// nearest), values of another form, or a key that determines the columns, which are the same in all runs.
LOCKSTEP_API Variable read_variable(const std::string& text, const Scene&, const Registry&);

/// Reads several variables; throws ModelError if two of them are the same value.
LOCKSTEP_API std::vector<Variable> read_variables(const std::vector<std::string>& texts, const Scene&, const Registry&);

/// The scene in which variable k has its value number choice[k]; the run settings are read again. Throws SceneError for
/// invalid settings; the rest is checked by build_mechanism().
LOCKSTEP_API Scene vary_scene(const Scene&, const std::vector<Variable>&, const std::vector<std::size_t>& choice,
                              const Registry&);

/// The scene with other values: each text is "NAME=VALUE", NAME a parameter or the path of a plain value, VALUE a number,
/// a quantity, a word or a formula. Throws as read_variable() and vary_scene() do.
LOCKSTEP_API Scene set_in_scene(const Scene&, const std::vector<std::string>& texts, const Registry&);

/// For a length that varies: the places of equal lengths that do not vary with it; empty for anything else.
LOCKSTEP_API std::vector<std::string> left_behind(const Variable&, const Scene&, const Registry&);

/// A choice of values as text: "bodies.rod.mass = 2 kg, gravity.1 = -9.81".
LOCKSTEP_API std::string setting_text(const std::vector<Variable>&, const std::vector<std::size_t>& choice);

/// A value as tables show it: a number in shortest form, a word, true or false; "" for a list or an object.
LOCKSTEP_API std::string plain_text(const Value&);

}  // namespace lockstep
