// Reacting: the facet of a force that depends on the present reactions of links, as friction does.
#pragma once

#include <vector>

#include "framework/mechanism/lock/facets.h"
#include "framework/mechanism/lock/reactions.h"
#include "framework/mechanism/rows/sums.h"

namespace lockstep {

class Force;

/// A force that has it derives from it and lets Force::reacting() return `this`. What it does goes on top of apply(). The
/// solution is found by iteration: its change with the reactions has to be a contraction, as friction with a coefficient
/// well below one is.
class LOCKSTEP_API Reacting {
 public:
  explicit Reacting(const Force& self) : self_(&self) {}

  /// The links it reads. Known before setup(): these links are not merged into bodies.
  virtual std::vector<const Lock*> reads() const = 0;
  /// What it adds to apply() at these reactions.
  virtual void react(const Inputs&, const Reactions&, WrenchSum&) const = 0;
  virtual double friction_loss(const Inputs&, const Reactions&) const { return 0; }  ///< W taken out by react(), >= 0
  /// K and D of react() with the multipliers fixed; conventions of TangentSum. Default: central differences.
  virtual void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const;
  /// Recorder channels, those that read reactions and those that do not; they stand in for Observable's.
  virtual std::vector<Quantity> quantities() const { return {}; }
  virtual double reacting_quantity(int, const Inputs&, const Reactions&) const { return 0; }

 protected:
  ~Reacting() = default;

 private:
  const Force* self_;
};

}  // namespace lockstep
