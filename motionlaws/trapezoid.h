// Law 'trapezoid'.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// Two of speed, acceleration and duration are given, the third is 0 and follows.
struct TrapezoidSettings {
  double distance = 1;      ///< unit of the coordinate; may be negative
  double speed = 0;         ///< largest |yd|; with `acceleration` it is a limit that a short way need not reach
  double acceleration = 0;  ///< |ydd| while speeding up and slowing down
  double duration = 0;      ///< T of the whole, s
  double t0 = 0;            ///< start, s
  double y0 = 0;            ///< value before
};

/// Trapezoidal speed: acceleration a for v/a, speed v, acceleration -a for v/a; d = v (T - v/a). y0 before, y0 + d
/// after. Breakpoints: the (three or) four instants where the acceleration jumps.
class LOCKSTEP_API Trapezoid final : public MotionLaw {
 public:
  /// Throws ModelError for values that are not finite, not exactly two given, or a duration too short for the distance.
  explicit Trapezoid(const TrapezoidSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  double duration() const { return T_; }
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  void solve(TrapezoidSettings);
  double d_ = 0, v_ = 0, a_ = 0, ta_ = 0,
         T_ = 0;  // signed distance, speed and acceleration; times of speeding up and of all
  double t0_, y0_;
};

namespace laws {
inline LawPtr<MotionLaw> trapezoid(const TrapezoidSettings& k) { return std::make_shared<const Trapezoid>(k); }
}  // namespace laws

}  // namespace lockstep
