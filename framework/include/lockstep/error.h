// SPDX-License-Identifier: BSD-3-Clause
// The errors of lockstep.
#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include <lockstep/detail/export.h>

namespace lockstep {

// Every error has a sentence for people and the same facts as data for programs. A sentence has three parts: what is
// wrong and in what, the value, and what to do next.

/// What an error is about: a joint, a force, a law, a body, ...
struct LOCKSTEP_API Thing {
  std::string kind{},  ///< "joint", "force", "law", ...; empty: nothing is named
      name{};          ///< its name in the system; empty: a type that has made nothing yet
  std::string type{},  ///< name of its type, "revolute"
      origin{};        ///< origin of the type: "built in", a plugin's name, or "" for a class of the host

  bool known() const { return !kind.empty(); }                                  ///< whether it names anything
  bool of_a_plugin() const { return !origin.empty() && origin != "built in"; }  ///< whether a plugin brought its type
  std::string words() const;                                                    ///< "joint 'A'", or the kind alone
  std::string label() const;  ///< "joint 'A' (revolute)", "force 'F' (wind of plugin weather)"
};

/// The contents of an error, as data. Fields that do not apply are empty, 0 or NaN.
struct ErrorData {
  Thing thing{};                                        ///< what it is about, or the code that threw
  std::string key{};                                    ///< the parameter
  std::string value{};                                  ///< the value that was found, with its unit
  std::string problem{};                                ///< what is wrong with it; never empty
  std::string advice{};                                 ///< what to do next
  std::string file{};                                   ///< the file it was read from
  int line = 0,                                         ///< line in the file, from 1; 0: not from a file
      column = 0;                                       ///< column in the line, from 1; 0: not from a file
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s; NaN: not during a run
};

/// Base of every error that lockstep throws: wrong input and runs that fail. Programming errors are assertions.
class LOCKSTEP_API Error : public std::runtime_error, public ErrorData {
 public:
  /// Takes the sentence as it is, with the data `about` it. Without a problem in them, the sentence is the problem. A
  /// problem without advice is split at its first semicolon outside of parentheses, behind which stands the advice.
  explicit Error(const std::string& sentence, ErrorData about = {});
  /// Makes the sentence from the data: "file:line:column: t = T s: joint 'A': key problem; advice", without the parts
  /// that are empty.
  explicit Error(ErrorData about);
  ~Error() override;
  const ErrorData& data() const { return *this; }  ///< the data alone
  /// The class of an error, one value per class, for programs that store errors or choose by switch.
  enum class Kind {
    other,       ///< none of the classes below
    model,       ///< ModelError, ParameterError
    assembly,    ///< AssemblyError
    solve,       ///< SolveError
    step,        ///< StepError
    non_finite,  ///< NonFiniteError
    plugin,      ///< PluginError
    scene,       ///< SceneError
    file,        ///< FileError
    user_code,   ///< UserCodeError
    usage,       ///< wrong arguments of the program lockstep
    interrupted  ///< InterruptedError
  };
  virtual Kind kind() const noexcept { return Kind::other; }  ///< the error's class
  std::string fact() const;  ///< the sentence up to its advice: what is wrong, where, when and in what
  /// The sentence, with its label once attributed.
  const char* what() const noexcept override { return sentence_.c_str(); }

  /// Sets `thing` to `whose` unless it names something else, and puts `label` in front of the sentence, after its place
  /// in a file. Only the first label is used; an empty one leaves the sentence as it is.
  void attribute(const Thing& whose, const std::string& label);

 private:
  std::string sentence_;
  bool labelled_ = false;
};

/// An impossible mechanism: a body without mass, a drive on a locked axis, a joint between a body and itself.
class LOCKSTEP_API ModelError : public Error {
 public:
  using Error::Error;
  ~ModelError() override;
  Kind kind() const noexcept override { return Kind::model; }
};

/// An invalid parameter of a law, force, joint or integrator: `key` is its name in the type's table of keys,
/// `problem` what is wrong with it. Thrown by a maker, it becomes a SceneError at the place of the key.
class LOCKSTEP_API ParameterError : public ModelError {
 public:
  /// The sentence is "law 'sine': omega is -1; must be above 0"; `its_problem` may include the advice.
  ParameterError(Thing whose, std::string its_key, std::string its_problem);
  ~ParameterError() override;
};

/// A start, or a state that an event changed, that could not be brought onto the constraints.
class LOCKSTEP_API AssemblyError : public Error {
 public:
  using Error::Error;
  ~AssemblyError() override;
  Kind kind() const noexcept override { return Kind::assembly; }
};

/// The equations of motion could not be solved at this state: contradictory rows, by name, or a singular matrix.
class LOCKSTEP_API SolveError : public Error {
 public:
  using Error::Error;
  ~SolveError() override;
  Kind kind() const noexcept override { return Kind::solve; }
};

/// A step could not be made: it became too short, or the projection did not converge. `t` is the time of the last
/// accepted state.
class LOCKSTEP_API StepError : public Error {
 public:
  using Error::Error;
  /// The sentence, and the time of the last accepted state, s.
  StepError(const std::string& sentence, double time) : Error(sentence, {.t = time}) {}
  ~StepError() override;
  Kind kind() const noexcept override { return Kind::step; }
};

/// An evaluation gave a NaN or an infinity; names the law, force, joint or body that gave it. `t` is the time of the
/// evaluation.
class LOCKSTEP_API NonFiniteError : public Error {
 public:
  using Error::Error;
  /// The sentence, and the time of the evaluation, s.
  NonFiniteError(const std::string& sentence, double time) : Error(sentence, {.t = time}) {}
  ~NonFiniteError() override;
  Kind kind() const noexcept override { return Kind::non_finite; }
};

/// A plugin that cannot be loaded, or a type that cannot be registered, and why.
class LOCKSTEP_API PluginError : public Error {
 public:
  using Error::Error;
  ~PluginError() override;
  Kind kind() const noexcept override { return Kind::plugin; }
};

/// A scene (or parameters given in C++) that cannot be understood, and its place.
class LOCKSTEP_API SceneError : public Error {
 public:
  using Error::Error;
  /// The sentence, and its place: file, and line and column from 1 (0: unknown).
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

/// Code from outside lockstep - a law, joint, force or integrator of a plugin or of the host - threw while it was made
/// or used, or wrote outside of its arrays. `thing` is the owner of the code, `t` the time; the original exception is
/// nested (std::rethrow_if_nested).
class LOCKSTEP_API UserCodeError : public Error {
 public:
  using Error::Error;
  ~UserCodeError() override;
  Kind kind() const noexcept override { return Kind::user_code; }
};

/// A run was interrupted on request.
class LOCKSTEP_API InterruptedError : public Error {
 public:
  using Error::Error;
  ~InterruptedError() override;
  Kind kind() const noexcept override { return Kind::interrupted; }
};

/// "model", "user code", ...
LOCKSTEP_API const char* to_string(Error::Kind);

/// "t = 0.5 s: ", the start of a message about a time, t in s; "" for NaN.
LOCKSTEP_API std::string at_time(double t);

/// " of plugin gears"; "" for what is built in and for the host's own classes.
LOCKSTEP_API std::string of_plugin(const std::string& origin);

// The one way in which an exception is given the name of the code that threw it.

/// The owner of code that threw, and its name in errors. Made only after a throw, so that the passes cost nothing.
struct ErrorContext {
  Thing thing{};                                        ///< the owner of the code
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s; NaN: while it is made or set up
  std::string fault{};                                  ///< what is wrong with one of its laws; "" when nothing is
  bool refuses = false;  ///< its Errors reject a model and keep their type: makers, setup, integrators
  std::string label{};   ///< its name in messages; "": thing.label()
};

/// To be called in a catch block: rethrows the exception in flight with the name of the code that threw it.
/// - std::bad_alloc and InterruptedError are rethrown unchanged. So is an Error that has a thing and a time; of a
///   plugin's code only a UserCodeError or NonFiniteError.
/// - Any other Error that rejects a model keeps its type. It gets the thing, and the label in front of its sentence
///   unless the thing is built in. SolveError and AssemblyError are about the mechanism and are rethrown unchanged.
/// - A ModelError named by a built-in law (a spline evaluated beyond its end) stays one, with thing, law and time,
///   unless the thing belongs to a plugin.
/// - Any other Error of the host's code, and a UserCodeError or NonFiniteError of any code, keeps its type. Thing and
///   time are added, also to the sentence, and the original is nested. An Error of built-in code gets the thing alone.
///   Of classes derived from those below the object itself is rethrown, with nothing nested.
/// - Everything else (also an int) becomes a UserCodeError with thing and time, and the original is nested. Of built-in
///   code with finite laws, exceptions that are not Errors are rethrown unchanged.
[[noreturn]] LOCKSTEP_API void rethrow_in(const ErrorContext&);

/// Calls `act` and returns its result; what it throws goes through rethrow_in(context()). Costs nothing unless
/// something is thrown.
template <class Context, class Act>
decltype(auto) in_context(Context&& context, Act&& act) {
  try {
    return act();
  } catch (...) {
    rethrow_in(context());
  }
}

/// The same for the code of a thing that has a context_of(thing, t): a joint, a force, an integrator. t in s.
template <class T, class Act>
decltype(auto) named(const T& thing, double t, Act&& act) {
  return in_context([&] { return context_of(thing, t); }, static_cast<Act&&>(act));
}

}  // namespace lockstep
