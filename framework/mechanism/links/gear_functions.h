// SPDX-License-Identifier: BSD-3-Clause
// Functions of gears, belts and racks.
#pragma once

#include <string>

#include <lockstep/author/phi.h>

namespace lockstep {

/// (7.4) phi = a theta1 + b theta2 - reference, theta being the turn of a pair about z of its S, rad.
struct TurnsOfTwo final : PhiHooks {
  double a,                                               ///< factor of theta1
      b;                                                  ///< factor of theta2
  double reference = 0;                                   ///< a theta1 + b theta2 at the start
  TurnsOfTwo(double of1, double of2) : a(of1), b(of2) {}  ///< without a reference yet
  static constexpr PhiSpec spec{
      .pairs = 2, .reads = Reads::rotation, .counts_turns = true, .stays_in_plane = true, .names = {"teeth"}};
  /// a theta1 + b theta2.
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return a * y1.rest_z() + b * y2.rest_z() + kTwoPi * (a * y1.turns + b * y2.turns);
  }
  /// phi.
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2) const {
    return turned(y1, y2) - reference;
  }
  void initialise(const std::string&, PhiCoords y) override { reference = turned(y[0], y[1]).v; }
};

/// phi = a theta1 + b theta2 + c theta3 - reference, theta being the turn of a pair about z of its S, rad.
struct TurnsOfThree final : PhiHooks {
  double a,              ///< factor of theta1
      b,                 ///< factor of theta2
      c;                 ///< factor of theta3
  double reference = 0;  ///< a theta1 + b theta2 + c theta3 at the start
  TurnsOfThree(double of1, double of2, double of3) : a(of1), b(of2), c(of3) {}  ///< without a reference yet
  static constexpr PhiSpec spec{
      .pairs = 3, .reads = Reads::rotation, .counts_turns = true, .stays_in_plane = true, .names = {"teeth"}};
  /// a theta1 + b theta2 + c theta3.
  template <class T>
  T turned(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return a * y1.rest_z() + b * y2.rest_z() + c * y3.rest_z() + kTwoPi * (a * y1.turns + b * y2.turns + c * y3.turns);
  }
  /// phi.
  template <class T>
  T operator()(const LockCoords<T>& y1, const LockCoords<T>& y2, const LockCoords<T>& y3) const {
    return turned(y1, y2, y3) - reference;
  }
  void initialise(const std::string&, PhiCoords y) override { reference = turned(y[0], y[1], y[2]).v; }
};

/// (7.4) phi = x + radius theta - reference, m: the pinion's centre along x of S, its turn about z. The multiplier is
/// the force at the teeth along the rack, N.
struct RollingPinion final : PhiHooks {
  double radius;                                   ///< of the pitch circle, m
  double reference = 0;                            ///< x + radius theta at the start, m
  explicit RollingPinion(double m) : radius(m) {}  ///< without a reference yet
  static constexpr PhiSpec spec{
      .counts_turns = true, .stays_in_plane = true, .kind = RowKind::translation, .names = {"teeth"}};
  /// x + radius theta, m.
  template <class T>
  T rolled(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z();
  }
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return rolled(y) - reference;
  }
  void initialise(const std::string&, PhiCoords y) override { reference = rolled(y[0]).v; }
};

/// phi = z2 - radius theta1 - reference, m: pair 1 is the pinion's joint (turn about z), pair 2 the rack's (sliding
/// along z).
struct PinionAndSlide final : PhiHooks {
  double radius;                                    ///< of the pitch circle, m
  double reference = 0;                             ///< z2 - radius theta1 at the start, m
  explicit PinionAndSlide(double m) : radius(m) {}  ///< without a reference yet
  static constexpr PhiSpec spec{.pairs = 2,
                                .reads = {Reads::rotation, Reads::translation},
                                .counts_turns = true,
                                .stays_in_plane = true,
                                .kind = RowKind::translation,
                                .names = {"teeth"}};
  /// z2 - radius theta1, m.
  template <class T>
  T advance(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return rack.z - radius * pinion.angle_z();
  }
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return advance(pinion, rack) - reference;
  }
  void initialise(const std::string&, PhiCoords y) override { reference = advance(y[0], y[1]).v; }
};

}  // namespace lockstep
