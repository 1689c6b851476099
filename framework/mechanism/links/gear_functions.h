// SPDX-License-Identifier: BSD-3-Clause
// Functions of gears, belts and racks.
#pragma once

#include <array>
#include <string>
#include <utility>

#include <lockstep/author/phi.h>

namespace lockstep {

/// phi = f less its value at the start.
template <class F>
struct FromStart final : PhiHooks, F {
  double reference = 0;                     ///< f at the start
  explicit FromStart(const F& f) : F(f) {}  ///< without a reference yet
  /// phi.
  template <class... Y>
  auto operator()(const Y&... y) const {
    return F::operator()(y...) - reference;
  }
  void initialise(const std::string&, PhiCoords y) override {
    [&]<std::size_t... k>(std::index_sequence<k...>) { reference = F::operator()(y[k]...).v; }
    (std::make_index_sequence<F::spec.pairs>{});
  }
};

/// (7.4) f = a theta1 + b theta2 + ..., theta being the turn of a pair about z of its S, rad.
template <std::size_t n>
struct SumOfTurns {
  std::array<double, n> factors;  ///< a, b, ...
  static constexpr PhiSpec spec{
      .pairs = n, .reads = Reads::rotation, .counts_turns = true, .stays_in_plane = true, .names = {"teeth"}};
  /// f.
  template <class... Y>
  auto operator()(const Y&... y) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      return (... + (factors[k] * y.rest_z())) + kTwoPi * (... + (factors[k] * y.turns));
    }
    (std::index_sequence_for<Y...>{});
  }
};
using TurnsOfTwo = FromStart<SumOfTurns<2>>;
using TurnsOfThree = FromStart<SumOfTurns<3>>;

/// (7.4) f = x + radius theta, m: the pinion's centre along x of S, its turn about z. The multiplier is the force at the
/// teeth along the rack, N.
struct RolledWay {
  double radius;  ///< of the pitch circle, m
  static constexpr PhiSpec spec{
      .counts_turns = true, .stays_in_plane = true, .kind = RowKind::translation, .names = {"teeth"}};
  /// f, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z();
  }
};
using RollingPinion = FromStart<RolledWay>;

/// f = z2 - radius theta1, m: pair 1 is the pinion's joint (turn about z), pair 2 the rack's (sliding along z).
struct RackAdvance {
  double radius;  ///< of the pitch circle, m
  static constexpr PhiSpec spec{.pairs = 2,
                                .reads = {Reads::rotation, Reads::translation},
                                .counts_turns = true,
                                .stays_in_plane = true,
                                .kind = RowKind::translation,
                                .names = {"teeth"}};
  /// f, m.
  template <class T>
  T operator()(const LockCoords<T>& pinion, const LockCoords<T>& rack) const {
    return rack.z - radius * pinion.angle_z();
  }
};
using PinionAndSlide = FromStart<RackAdvance>;

}  // namespace lockstep
