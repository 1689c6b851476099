// Link 'rack_and_pinion': a pinion that rolls along a rack, or the same between two joints.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_coupling.h"
#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) phi = x + radius theta - reference, m: the pinion's centre along x of S, its turn about z. Its multiplier is
/// the force at the teeth along the rack.
struct RollingPinion {
  double radius;         ///< of the pitch circle, m
  double reference = 0;  ///< of the start, m
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T rolled(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return rolled(y) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y) { reference = rolled(y).v; }
};

/// A pinion that rolls along a rack: its centre P moves along x of S, which is fixed to the rack and lies on the line
/// of the centre. Free: rolling.
class LOCKSTEP_API RollingRack final : public PhiLock<RollingPinion> {
 public:
  /// `radius`: of the pitch circle, m; negative when the rack lies on the other side (above the pinion).
  RollingRack(std::string name, Marker& p, Marker& s, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
};

/// phi = z2 - radius theta1 - reference, m: pair 1 is the pinion's joint (turn about z), pair 2 the rack's (sliding
/// along z).
struct PinionAndSlide {
  double radius;         ///< of the pitch circle, m
  double reference = 0;  ///< of the start, m
  static constexpr int kPairs = 2;
  static constexpr std::array<Reads, 2> kReads = {Reads::rotation, Reads::translation};
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T advance(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return rack.z - radius * pinion.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return advance(pinion, rack) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& pinion, const LockCoords<Time>& rack) {
    reference = advance(pinion, rack).v;
  }
};

/// Pinion and rack in joints of their own on a common carrier, the ground or a moving one. They mesh at the start. The
/// carrier's share of the tooth force is in the reactions of this link, not in those of the bearings.
class LOCKSTEP_API RackAndPinion final : public PhiCoupling<PinionAndSlide> {
 public:
  /// `radius`: slide along z per radian of the pinion, m; negative reverses it.
  RackAndPinion(const CoupledPairs& pairs, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
  static TypeInfo info();
  /// With one pair a RollingRack, with two a RackAndPinion.
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
