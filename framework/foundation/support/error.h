// The errors of lockstep. A message has three parts: what and where, the value, the next move.
#pragma once

#include <stdexcept>
#include <string>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// Root of every error that lockstep throws on purpose. Programmer slips are assert, wrong input is an Error.
class LOCKSTEP_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  ~Error() override;
};

/// A mechanism that cannot be: a body without mass, a drive on a locked axis, a link between a body and itself.
class LOCKSTEP_API ModelError : public Error {
 public:
  using Error::Error;
  ~ModelError() override;
};

/// The start could not be brought onto the constraints.
class LOCKSTEP_API AssemblyError : public Error {
 public:
  using Error::Error;
  ~AssemblyError() override;
};

/// The equations of motion have no solution at this state: contradictory rows, by name.
class LOCKSTEP_API SolveError : public Error {
 public:
  using Error::Error;
  ~SolveError() override;
};

/// A step could not be made: the step became too small, the projection did not converge.
class LOCKSTEP_API StepError : public Error {
 public:
  StepError(const std::string& message, double time) : Error(message), t(time) {}
  ~StepError() override;
  double t;  ///< simulated time of the last accepted state, s
};

/// A NaN or an infinity came out of an evaluation; names the law, force, link or body that made it.
class LOCKSTEP_API NonFiniteError : public Error {
 public:
  NonFiniteError(const std::string& message, double time) : Error(message), t(time) {}
  ~NonFiniteError() override;
  double t;  ///< simulated time of the evaluation, s
};

/// A plugin that cannot be loaded, and why.
class LOCKSTEP_API PluginError : public Error {
 public:
  using Error::Error;
  ~PluginError() override;
};

/// A scene (or parameters given in C++) that cannot be understood. `line` and `column` count from 1; 0 = not from a
/// file.
class LOCKSTEP_API SceneError : public Error {
 public:
  explicit SceneError(const std::string& message, std::string source = {}, int at_line = 0, int at_column = 0)
      : Error(message), file(std::move(source)), line(at_line), column(at_column) {}
  ~SceneError() override;
  std::string file;
  int line, column;
};

/// A file that cannot be read or written.
class LOCKSTEP_API FileError : public Error {
 public:
  using Error::Error;
  ~FileError() override;
};

}  // namespace lockstep
