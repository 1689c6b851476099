// TurnCounter: an angle that runs on past full turns (theory, (7.9)).
#pragma once

#include <cmath>

#include <lockstep/math.h>
#include <lockstep/memory.h>
#include "framework/mechanism/forces/counted_angle.h"

namespace lockstep {

/// Angles are known up to full turns. The counter keeps the last accepted angle and takes the branch nearest to its
/// extrapolation by the rates. A step may make several turns; the extrapolation must be within half a turn.
class TurnCounter {
 public:
  /// The angle at time t, from any branch `raw` (rad) and its rate (rad/s). Before the first accept: in (-pi, pi], or that
  /// far from where it begins about.
  double at(double raw, double t, double rate) const {
    return begun_ ? raw + kTwoPi * std::round((expected(t, rate) - raw) / kTwoPi) : about_ + principal(raw - about_);
  }
  /// Where the next start is near, rad.
  void begin_about(double angle) { about_ = angle; }
  bool has_begun() const { return begun_; }
  /// Whether the angle is within a quarter turn of its extrapolation, or the first.
  bool is_sure(double raw, double t, double rate) const {
    return !begun_ || std::abs(at(raw, t, rate) - expected(t, rate)) < 0.5 * kPi;
  }
  void accept(double raw, double t, double rate) {
    angle_ = at(raw, t, rate);
    t_ = t, rate_ = rate, begun_ = true;
  }
  /// From the last accepted angle to t, s; before the first 0.
  double since(double t) const { return begun_ ? t - t_ : 0.0; }
  void restart() { begun_ = false; }
  void save(Snapshot& out) const { out.put(begun_ ? 1 : 0), out.put(angle_), out.put(t_), out.put(rate_); }
  void load(SnapshotReader& in) { begun_ = in.get_flag(), angle_ = in.get(), t_ = in.get(), rate_ = in.get(); }

  static double principal(double raw) {
    const double a = raw - kTwoPi * std::round(raw / kTwoPi);
    return a <= -kPi ? a + kTwoPi : a;
  }

 private:
  double expected(double t, double rate) const {
    const double z[CountedAngle::kMemory] = {angle_, rate_, t_, 1.0};
    return CountedAngle::expected(z, t, rate);
  }

  bool begun_ = false;
  double angle_ = 0, t_ = 0, rate_ = 0, about_ = 0;
};

}  // namespace lockstep
