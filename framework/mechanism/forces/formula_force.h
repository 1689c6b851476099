// SPDX-License-Identifier: BSD-3-Clause
// The force 'function_force': a formula of a coordinate of P seen from S, of others and of the time, written in a scene.
#pragma once

#include <lockstep/author/force.h>
#include <lockstep/author/formula.h>
#include <lockstep/author/params.h>
#include <lockstep/forces.h>
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep {

class CoordinateForce;
extern template class LOCKSTEP_API FormulaForce<CoordinateForce>;

/// Force f(q, qd, t, ...) in a coordinate q of P relative to S, with the coordinates of others that the formula reads.
///
///     along an axis   q = a.(x_P - x_S), a an axis of S              f a on P's body at P, -f a on S's body at the same point
///     distance        q = |x_P - x_S|                                f (x_P - x_S)/q on P's body at P, minus it on S's at S
///     about an axis   q = 2 atan2(e_k, e0), full turns counted       f g on P, -f g on S, g the gradient of q
///     power           f qd, all of it supply                         W
///
/// No potential: what the formula stores or dissipates is not known.
class LOCKSTEP_API CoordinateForce final : public FormulaForce<CoordinateForce> {
 public:
  static constexpr std::size_t kMostVariables = 32;  ///< of a formula: q, qd, t and those that it reads
  using Readings = std::vector<std::shared_ptr<Coordinate>>;
  /// The formula's variables are q, qd, t and `reads`. A turn is a torque. Throws ModelError as MarkerForce does.
  CoordinateForce(std::string name, Marker& p, Marker& s, Coordinate::Of q, expression::FormulaFunction f,
                  Readings reads = {});
  std::string_view type() const override { return "function_force"; }
  std::vector<Quantity> quantities() const override;  ///< coordinate, rate, force (torque), power
  void setup() override;
  bool stays_in_plane(Plane) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;
  std::span<const int> also_reads() const { return also_; }  ///< slots

  /// Those of a torque and of what it reads.
  void count_angles(AngleCounter&) override;

  static TypeInfo info();                                                ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  bool is_torque() const { return q_.of().kind == Coordinate::Kind::turn; }
  template <std::size_t most, class T>
  T effort(const Ends<T>&, const T& q, const T& rate) const;

  Coordinate q_;
  expression::FormulaFunction f_;
  Readings reads_;
  std::vector<int> also_;
};

}  // namespace lockstep
