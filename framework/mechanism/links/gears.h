// Links 'gear', 'belt' and 'differential': turns of two or three pairs, each about its own z, measured on a common
// carrier. The carrier may move: a planet carrier. Bearings are links of their own; the carrier's share of the tooth
// force is in the reactions of the coupling, not in those of the bearings.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_coupling.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) phi = a theta1 + b theta2 - reference.
struct TurnsOfTwo {
  double a, b;           ///< factors of the two turns
  double reference = 0;  ///< a theta1 + b theta2 of the start
  static constexpr int kPairs = 2;
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return a * y1.angle_z() + b * y2.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return turned(y1, y2) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2) {
    reference = turned(y1, y2).v;
  }
};

/// phi = a theta1 + b theta2 + c theta3 - reference.
struct TurnsOfThree {
  double a, b, c;        ///< factors of the three turns
  double reference = 0;  ///< of the start
  static constexpr int kPairs = 3;
  static constexpr Reads kReads = Reads::rotation;
  static constexpr bool kCountsTurns = true;
  static constexpr std::array<const char*, 1> kNames = {"teeth"};
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return a * y1.angle_z() + b * y2.angle_z() + c * y3.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return turned(y1, y2, y3) - reference;
  }
  void initialise(const std::string&, const LockCoords<Time>& y1, const LockCoords<Time>& y2,
                  const LockCoords<Time>& y3) {
    reference = turned(y1, y2, y3).v;
  }
};

/// Two gears: theta1 + ratio theta2 = as at the start (external, bevel), theta1 - ratio theta2 (internal). Bevel: both
/// z axes point away from the apex, or both towards it.
class LOCKSTEP_API Gear final : public PhiCoupling<TurnsOfTwo> {
 public:
  enum class Mesh { external, internal, bevel };
  /// `ratio`: turns of gear 1 per turn of gear 2, that is teeth of 2 to teeth of 1; above zero. Throws ModelError.
  Gear(const CoupledPairs& pairs, double ratio, Mesh mesh = Mesh::external);
  std::string_view type() const override { return "gear"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Two pulleys: radius1 theta1 = radius2 theta2 as at the start, or opposed when the belt is crossed. It does not slip
/// or stretch.
class LOCKSTEP_API Belt final : public PhiCoupling<TurnsOfTwo> {
 public:
  struct Options {
    double radius1, radius2;  ///< of the pulleys, m, above zero
    bool crossed = false;     ///< the pulleys turn against each other
  };
  /// Throws ModelError: a radius that is not above zero.
  Belt(const CoupledPairs& pairs, Options options);
  std::string_view type() const override { return "belt"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Three turns on one carrier: theta1 + ratio theta2 = (1 + ratio) theta3 as at the start. With ratio 1 a bevel
/// differential: both wheels and the cage; with (teeth of the ring)/(teeth of the sun) a planetary gear: sun, ring and
/// arm.
class LOCKSTEP_API Differential final : public PhiCoupling<TurnsOfThree> {
 public:
  /// `ratio` above zero. Throws ModelError.
  explicit Differential(const CoupledPairs& pairs, double ratio = 1);
  std::string_view type() const override { return "differential"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
