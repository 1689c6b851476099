// The force 'function_force': a formula of one coordinate of P seen from S, its rate and the time, written in a scene.
#pragma once

#include <algorithm>

#include <lockstep/force.h>
#include <lockstep/forces.h>
#include <lockstep/mask.h>
#include <lockstep/params.h>
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/forces/counted_angle.h"

namespace lockstep {

class CoordinateForce;
extern template class LOCKSTEP_API FormulaForce<CoordinateForce>;

/// Force f(q, qd, t) along an axis of S, or torque about it.
///
///     force   q = a.(x_P - x_S), a an axis of S                m; f a on P's body at P, -f a on S's body at the same point
///     torque  q = 2 atan2(e_k, e0), full turns counted         rad; f g on P, -f g on S, g the gradient of q
///     power   f qd, all of it supply                           W
///
/// No potential: what the formula stores or dissipates is not known.
class LOCKSTEP_API CoordinateForce final : public FormulaForce<CoordinateForce>, public Remembering {
 public:
  /// `axis` rx, ry, rz: a torque. Throws ModelError as MarkerForce does.
  CoordinateForce(std::string name, Marker& p, Marker& s, Axis axis, expression::FormulaFunction f);
  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< coordinate, rate, force (torque), power
  void setup() override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  /// This for a torque.
  const Remembering* remembering() const override { return is_rotation(axis_) ? this : nullptr; }
  int n_memory() const override { return CountedAngle::kMemory; }
  bool counts_turns_alone() const override { return true; }
  void start_memory(std::span<double> z) const override { std::ranges::fill(z, 0.0); }
  void accept_step(const Inputs& in, std::span<double> z) const override {
    CountedAngle::accept(quantity(0, in), quantity(1, in), in.t, z);
  }

  static const TypeInfo& info();                                         ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  Axis axis_;
  expression::FormulaFunction f_;
};

}  // namespace lockstep
