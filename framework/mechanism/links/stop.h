// Link 'stop': one end of the travel of one coordinate; a unilateral link.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// +-(coordinate - limit), so that C >= 0 is the free side: above a low end, below a high one.
struct StopAlong {
  int axis;      ///< of S: 0 x, 1 y, 2 z
  double limit;  ///< m
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * ((axis == 0 ? y.x : axis == 1 ? y.y : y.z) - limit);
  }
};
/// The same of the turn about z of S, counted past full turns.
struct StopAbout {
  double limit;  ///< rad
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * (y.angle_z() - limit);
  }
};

/// Free: everything, until the coordinate x, y or z of P seen from S comes to its limit.
class LOCKSTEP_API SlideStop final : public PhiLock<StopAlong> {
 public:
  struct Options {
    int axis = 0;      ///< of S: 0 x, 1 y, 2 z
    double limit = 0;  ///< m
    bool low = true;   ///< the coordinate stays above the limit, else below it
  };
  /// Throws ModelError: a limit that is not finite.
  SlideStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// Free: everything, until the turn about z of S comes to its limit (rad, counted past full turns; at the start within
/// half a turn of zero).
class LOCKSTEP_API TurnStop final : public PhiLock<StopAbout> {
 public:
  struct Options {
    double limit = 0;  ///< rad
    bool low = true;   ///< the angle stays above the limit, else below it
  };
  /// Throws ModelError: a limit that is not finite.
  TurnStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// Type "stop" of files. Unilateral by itself, without restitution until set_unilateral() says more.
struct LOCKSTEP_API Stop {
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
