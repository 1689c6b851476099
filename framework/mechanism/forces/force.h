// Force: anything that pushes without holding. Writes into the sum, never into the bodies.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/mechanism/forces/reactions.h"
#include "framework/mechanism/rows/sums.h"
#include "framework/mechanism/lock/lock.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

class LOCKSTEP_API Force {
 public:
  explicit Force(std::string name);
  virtual ~Force();
  Force(const Force&) = delete;
  Force& operator=(const Force&) = delete;

  const std::string& name() const { return name_; }
  virtual std::string_view type() const = 0;
  /// Who brought its class: "built in", a plugin's name, or "" for a class of the host's own. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }

  // -- description
  virtual std::vector<const Marker*> markers() const = 0;  ///< those it acts at, for messages and checks
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
  /// Which of its laws throws or is not finite at time t, in words; "" when none is. As Lock::diagnose.
  virtual std::string diagnose(double t) const;
  virtual std::vector<Quantity> quantities() const;  ///< "length" m, "force" N, ... for the recorder
  virtual double quantity(int k, const Inputs&) const;

  // -- setup: called once the bodies have their slots
  virtual void setup() = 0;

  // -- evaluation
  virtual void apply(const Inputs&, WrenchSum& out) const = 0;
  /// K = -df/d(dx, dth) and D = -df/d(v, w); conventions of TangentSum. Asked by implicit methods only. Default:
  /// central differences of the force's own apply() over the slots of its markers, for forces that bring no formula.
  virtual void tangent(const Inputs&, TangentSum& out) const;
  virtual double potential(const Inputs&) const;    ///< J; asked only while energy is recorded; default 0
  virtual double dissipation(const Inputs&) const;  ///< W taken out by dampers, >= 0; default 0
  /// W put in by laws and motors: what the force gives to the bodies beyond -dV/dt and the dampers; default 0. The
  /// energy balance rests on it.
  virtual double supply(const Inputs&) const;

  // -- a force that depends on the present reactions of links (friction)
  /// The links it reads; none: apply() is all there is. Known before setup(): these links are not merged into bodies.
  virtual std::vector<const Lock*> reads() const { return {}; }
  /// What it adds to apply() at these reactions. The solution is found by iteration: its change with the reactions has
  /// to be a contraction, as friction with a coefficient well below one is.
  virtual void react(const Inputs&, const Reactions&, WrenchSum&) const {}
  virtual double friction_loss(const Inputs&, const Reactions&) const { return 0; }  ///< W taken out by react(), >= 0
  /// K and D of react() with the multipliers fixed; as tangent(), and by default differences like that.
  virtual void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const;
  /// quantity() of a force that reads reactions; default: quantity(k, in).
  virtual double reacting_quantity(int k, const Inputs&, const Reactions&) const;

  // -- what the force remembers (turn counters)
  virtual int n_memory() const { return 0; }
  virtual void start_memory(std::span<double> z) const;
  virtual void accept(const Inputs&, std::span<double> z) const;
  int first_memory() const { return first_memory_; }
  const std::vector<int>& slots() const { return slots_; }  ///< moving slots of its markers, each once
  void place(int first_memory);                             ///< called by System::setup

 private:
  std::string name_, origin_;
  int first_memory_ = 0;
  std::vector<int> slots_;
};

}  // namespace lockstep
