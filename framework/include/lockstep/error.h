// The errors of lockstep.
#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include <lockstep/export.h>

namespace lockstep {

// The errors of lockstep: a sentence for people, and what it says as data for programs. A sentence has three parts: what
// and where, the value, the next move.


/// A thing as errors name it.
struct LOCKSTEP_API Thing {
  std::string kind{}, name{};    ///< "link", "A"; no name: a type that makes nothing yet
  std::string type{}, origin{};  ///< "revolute"; "built in", a plugin's name, or "" for a class of the host's own

  bool known() const { return !kind.empty(); }
  bool of_a_plugin() const { return !origin.empty() && origin != "built in"; }
  std::string words() const;  ///< "link 'A'"
  std::string label() const;  ///< "link 'A' (revolute)", "force 'F' (wind of plugin weather)"
};

/// What an error says, as data. What does not apply is empty, 0 or NaN.
struct ErrorData {
  Thing thing{};                                        ///< what it is about, or whose code threw
  std::string key{};                                    ///< the parameter
  std::string value{};                                  ///< what was found there, with its unit
  std::string problem{};                                ///< what is wrong with it
  std::string advice{};                                 ///< the next move
  std::string file{};                                   ///< where it is written
  int line = 0, column = 0;                             ///< count from 1; 0: not from a file
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s; NaN: not during a run
};

/// Root of every error that lockstep throws on purpose. Programmer slips are assert, wrong input is an Error.
class LOCKSTEP_API Error : public std::runtime_error, public ErrorData {
 public:
  explicit Error(const std::string& sentence, ErrorData about = {});
  /// Makes the sentence of the data: "file:line:column: t = T s: link 'A': key problem; advice", without what is empty.
  explicit Error(ErrorData about);
  ~Error() override;
  /// For programs that store errors or choose by switch: one per class.
  enum class Kind {
    other,
    model,
    assembly,
    solve,
    step,
    non_finite,
    plugin,
    scene,
    file,
    user_code,
    usage,
    interrupted
  };
  virtual Kind kind() const noexcept { return Kind::other; }
  const char* what() const noexcept override { return sentence_.c_str(); }

  /// Notes whose error it is where it does not say so, and puts `label` in front of the sentence, behind the place in a
  /// file. Only the first label is taken; an empty one changes no words.
  void attribute(const Thing& whose, const std::string& label);

 private:
  std::string sentence_;
  bool labelled_ = false;
};

/// A mechanism that cannot be: a body without mass, a drive on a locked axis, a link between a body and itself.
class LOCKSTEP_API ModelError : public Error {
 public:
  using Error::Error;
  ~ModelError() override;
  Kind kind() const noexcept override { return Kind::model; }
};

/// A parameter that cannot be, of a law, force, link or integrator: `key` is its name in the type's table of keys,
/// `problem` what is wrong with it. In a maker the registry refuses it at the key's place (SceneError).
class LOCKSTEP_API ParameterError : public ModelError {
 public:
  /// The sentence is "law 'sine': omega is -1; must be above 0"; `its_problem` may contain the next move.
  ParameterError(Thing whose, std::string its_key, std::string its_problem);
  ~ParameterError() override;
};

/// The start could not be brought onto the constraints.
class LOCKSTEP_API AssemblyError : public Error {
 public:
  using Error::Error;
  ~AssemblyError() override;
  Kind kind() const noexcept override { return Kind::assembly; }
};

/// The equations of motion have no solution at this state: contradictory rows, by name.
class LOCKSTEP_API SolveError : public Error {
 public:
  using Error::Error;
  ~SolveError() override;
  Kind kind() const noexcept override { return Kind::solve; }
};

/// A step could not be made: the step became too small, the projection did not converge. `t` is the time of the last
/// accepted state.
class LOCKSTEP_API StepError : public Error {
 public:
  using Error::Error;
  StepError(const std::string& sentence, double time) : Error(sentence, {.t = time}) {}
  ~StepError() override;
  Kind kind() const noexcept override { return Kind::step; }
};

/// A NaN or an infinity came out of an evaluation; names the law, force, link or body that made it. `t` is the time of
/// the evaluation.
class LOCKSTEP_API NonFiniteError : public Error {
 public:
  using Error::Error;
  NonFiniteError(const std::string& sentence, double time) : Error(sentence, {.t = time}) {}
  ~NonFiniteError() override;
  Kind kind() const noexcept override { return Kind::non_finite; }
};

/// A plugin that cannot be loaded, and why.
class LOCKSTEP_API PluginError : public Error {
 public:
  using Error::Error;
  ~PluginError() override;
  Kind kind() const noexcept override { return Kind::plugin; }
};

/// A scene (or parameters given in C++) that cannot be understood, with its place.
class LOCKSTEP_API SceneError : public Error {
 public:
  using Error::Error;
  explicit SceneError(const std::string& sentence, const std::string& source, int at_line = 0, int at_column = 0)
      : Error(sentence, {.file = source, .line = at_line, .column = at_column}) {}
  ~SceneError() override;
  Kind kind() const noexcept override { return Kind::scene; }
};

/// A file that cannot be read or written.
class LOCKSTEP_API FileError : public Error {
 public:
  using Error::Error;
  ~FileError() override;
  Kind kind() const noexcept override { return Kind::file; }
};

/// Code that is not lockstep's own - a law, link, force or integrator of a plugin or of the host - threw while it was
/// made or used, or wrote where it must not. `thing` is whose code it was, `t` the time; what it threw is nested in it
/// (std::rethrow_if_nested).
class LOCKSTEP_API UserCodeError : public Error {
 public:
  using Error::Error;
  ~UserCodeError() override;
  Kind kind() const noexcept override { return Kind::user_code; }
};

/// Somebody asked for the end of a run.
class LOCKSTEP_API InterruptedError : public Error {
 public:
  using Error::Error;
  ~InterruptedError() override;
  Kind kind() const noexcept override { return Kind::interrupted; }
};

/// "model", "user code", ...
LOCKSTEP_API const char* to_string(Error::Kind);

/// "t = 0.5 s: ", the beginning of what is said of an instant; "" for NaN.
LOCKSTEP_API std::string at_time(double t);

/// " of plugin gears"; "" for what is built in and for the host's own.
LOCKSTEP_API std::string of_plugin(const std::string& origin);


// Whose code runs: the one way in which an exception is given the name of its culprit.


/// Whose code threw, and how its errors name it. Made only once something was thrown, so that the passes pay nothing.
struct ErrorContext {
  Thing thing{};
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s; NaN: while it is made or set up
  std::string fault{};   ///< what is wrong with one of its laws, in words; "" when nothing is
  bool refuses = false;  ///< its Errors are refusals and keep their type: makers, setup, integrators
  std::string label{};   ///< as in messages; "": thing.label()
  std::string before{};  ///< in front of the label where it threw: "link 'A', law: the maker of "
};

/// In a catch block: throws what is in flight as an error that names its culprit.
/// - UserCodeError and NonFiniteError name it already and go on as they are.
/// - An Error of a class that no plugin brought and whose laws are sound goes on with the thing noted in its data. So
///   does every refusal, with the label in front of its words if a plugin refuses.
/// - Everything else (an int as well) becomes a UserCodeError with kind, name, plugin, law and time, and the original
///   nested in it. Only what is not an Error and comes from built-in code (std::bad_alloc) goes on as it is.
[[noreturn]] LOCKSTEP_API void rethrow_in(const ErrorContext&);

/// Runs `act` and returns what it returns; what it throws goes through rethrow_in(context()). Costs nothing unless
/// something is thrown.
template <class Context, class Act>
decltype(auto) in_context(Context&& context, Act&& act) {
  try {
    return act();
  } catch (...) {
    rethrow_in(context());
  }
}

/// The same for the code of a thing that has a context_of(thing, t): a link, a force, an integrator.
template <class T, class Act>
decltype(auto) named(const T& thing, double t, Act&& act) {
  return in_context([&] { return context_of(thing, t); }, static_cast<Act&&>(act));
}

}  // namespace lockstep
