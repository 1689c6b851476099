// SPDX-License-Identifier: BSD-3-Clause
// Joints and integrators whose code is that of a host in another language.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include <lockstep/author/phi_links.h>
#include <lockstep/author/stepping.h>

namespace lockstep {

/// A joint, a PhiLock or a PhiCoupling, of a type that has its name from the host.
template <class Joint>
class HostJoint final : public Joint {
 public:
  template <class... Args>
  explicit HostJoint(std::string type, Args&&... args) : Joint(std::forward<Args>(args)...), type_(std::move(type)) {}
  std::string_view type() const override { return type_; }

 private:
  std::string type_;
};

/// A method of fixed steps without a history. The end of each step is put onto the constraints.
class HostIntegrator : public Integrator {
 public:
  /// Moves a state by h, s, except for its time.
  using Move = std::function<void(Dynamics&, State&, double h)>;
  HostIntegrator(std::string type, int order, Move move)
      : type_(std::move(type)), order_(order), move_(std::move(move)) {}
  IntegratorInfo info() const override { return {type_, order_, false, false, order_}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    State end = state;
    move_(dynamics, end, h);
    end.t = state.t + h;
    const ProjectReport landed = project_end_or_throw(dynamics, end, type_.c_str(), state.t, h);
    state = std::move(end);
    return {.h = h, .violation = landed.before, .violation_after = landed.after};
  }

 private:
  std::string type_;
  int order_;
  Move move_;
};

}  // namespace lockstep
