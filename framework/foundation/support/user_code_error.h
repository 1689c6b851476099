// The error of code that is not lockstep's own.
#pragma once

#include <string>
#include <utility>

#include "framework/foundation/support/error.h"

namespace lockstep {

/// Code that is not lockstep's own - a law, link, force or integrator of a plugin or of the host - threw while it was
/// used, or wrote where it must not. What it threw is nested in it (std::rethrow_if_nested).
class LOCKSTEP_API UserCodeError : public Error {
 public:
  UserCodeError(const std::string& message, std::string whose, double time)
      : Error(message), origin(std::move(whose)), t(time) {}
  ~UserCodeError() override;
  std::string origin;  ///< the plugin's name, or "" for a class of the host's own
  double t;            ///< simulated time, s
};

}  // namespace lockstep
