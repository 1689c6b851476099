// Auxiliary: states of the user's own that are integrated with the mechanism: controllers, actuators, quadratures.
#pragma once

#include <span>
#include <string>

#include "framework/mechanism/rows/rows.h"
#include "framework/mechanism/model/inputs.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// The inputs together with what the solution made of them. Views, valid during the call.
struct Evaluated {
  const Inputs& in;
  const VecX& a;       ///< 6 a slot: acceleration (world), angular acceleration (slot axes)
  const VecX& lambda;  ///< one a row of `rows`
  const RowTable& rows;
};

class LOCKSTEP_API Auxiliary {
 public:
  explicit Auxiliary(std::string name) : name_(std::move(name)) {}
  virtual ~Auxiliary();
  Auxiliary(const Auxiliary&) = delete;
  Auxiliary& operator=(const Auxiliary&) = delete;

  const std::string& name() const { return name_; }
  virtual int size() const = 0;
  /// Whether its error controls the step of an adaptive integrator; of a mere quadrature it should not.
  virtual bool controls_error() const { return true; }
  /// Values at the start; default: zeros.
  virtual void start(std::span<double> s) const;
  /// d/dt of its slice of State::s. Its own values stand at in.s[first() ...].
  virtual void rates(const Evaluated&, std::span<double> sd) const = 0;
  /// What an impact adds to its slice: `impulses` has them, N s, in the place of the multipliers. Default: nothing.
  virtual void impact(const Evaluated& impulses, std::span<double> s) const;

  int first() const { return first_; }       ///< where its slice begins in State::s
  void place(int first) { first_ = first; }  ///< called by System::setup

 private:
  std::string name_;
  int first_ = 0;
};

}  // namespace lockstep
