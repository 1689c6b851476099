// FunctionForce: a force that is a function of the user's.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "framework/mechanism/forces/force.h"

namespace lockstep {

/// Any force as a function of time, motions and states:
///
///   sys.add(function_force("drag", {&tip}, [&tip](const Inputs& in, WrenchSum& out) {
///     const MarkerInWorld M = in_world(MarkerFrame(tip), in);
///     out.force(tip.body->slot, -0.3 * M.v.norm() * M.v, M.x);
///   }));
///
/// The functions may not change anything but `out`, and the same inputs give the same result. `potential` (J) and
/// `dissipation` (W, not negative) enter the energies; left out, they are zero.
class LOCKSTEP_API FunctionForce final : public Force {
 public:
  using Apply = std::function<void(const Inputs&, WrenchSum&)>;
  using Energy = std::function<double(const Inputs&)>;

  /// `markers`: those it acts at, for messages and checks. Throws ModelError: no function, or a marker without a body.
  FunctionForce(std::string name, std::vector<const Marker*> markers, Apply apply, Energy potential = {},
                Energy dissipation = {});

  std::string_view type() const override { return "function_force"; }
  std::vector<const Marker*> markers() const override { return markers_; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;  ///< of the markers' laws
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { apply_(in, out); }
  double potential(const Inputs& in) const override { return potential_ ? potential_(in) : 0.0; }
  double dissipation(const Inputs& in) const override { return dissipation_ ? dissipation_(in) : 0.0; }

 private:
  std::vector<const Marker*> markers_;
  Apply apply_;
  Energy potential_, dissipation_;
};

LOCKSTEP_API std::unique_ptr<FunctionForce> function_force(std::string name, std::vector<const Marker*> markers,
                                                           FunctionForce::Apply apply,
                                                           FunctionForce::Energy potential = {},
                                                           FunctionForce::Energy dissipation = {});

}  // namespace lockstep
