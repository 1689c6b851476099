// SPDX-License-Identifier: BSD-3-Clause
// The functions that joints hold at zero.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/phi.h>
#include <lockstep/body.h>

namespace lockstep {

/// (7.4) phi = |rho| - f(t), m. The multiplier is the axial force, N: positive pulls the two points together.
struct DistanceFunction : PhiHooks {
  LawPtr<MotionLaw> law;  ///< f(t), m; null: `length`
  double length = 0;      ///< constant f, m
  DistanceFunction(LawPtr<MotionLaw> by, double constant) : law(std::move(by)), length(constant) {}  ///< of these
  static constexpr PhiSpec spec{.reads = Reads::translation, .stays_in_plane = true, .kind = RowKind::translation};
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::sqrt;
    return sqrt(y.x * y.x + y.y * y.y + y.z * y.z) - (law ? law_at(*law, y.t) : T(length));
  }
  /// f(t), m.
  double length_at(double t) const { return law ? law->at(t).y : length; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (law) law->breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const override { return law ? law_fault("the law of its length", law, t) : ""; }
};

/// (7.4) phi = z - lead theta / 2 pi - reference - f(t), m. The multiplier is the axial force of the thread, N.
struct ScrewThread : PhiHooks {
  double lead;             ///< advance per turn, m; negative: left-hand thread
  LawPtr<MotionLaw> slip;  ///< f(t), distance from the thread, m; null: none
  double reference = 0;    ///< z - lead theta / 2 pi at the start, m
  ScrewThread(double m, LawPtr<MotionLaw> by) : lead(m), slip(std::move(by)) {}  ///< without a reference yet
  static constexpr PhiSpec spec{.counts_turns = true, .kind = RowKind::translation, .names = {"thread"}};
  /// z - lead theta / 2 pi, m.
  template <class T>
  T advance(const LockCoords<T>& y) const {
    return y.z - lead / kTwoPi * y.angle_z();
  }
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T phi = advance(y) - reference;
    return slip ? phi - law_at(*slip, y.t) : phi;
  }
  /// Sets the reference, so that the start is on the thread.
  void initialise(const std::string&, PhiCoords y) override { reference = advance(y[0]).v; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (slip) slip->breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const override { return law_fault("the law of its offset", slip, t); }
};

/// phi = +-(coordinate - limit), m: phi >= 0 is the free side, above a low end and below a high one.
struct StopAlong {
  int axis;      ///< of S: 0 x, 1 y, 2 z
  double limit;  ///< m
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr PhiSpec spec{.reads = Reads::translation, .stays_in_plane = true, .kind = RowKind::translation};
  /// phi, m.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * ((axis == 0 ? y.x : axis == 1 ? y.y : y.z) - limit);
  }
};
/// phi = +-(theta - limit), rad, with the turn theta about z of S; phi >= 0 is the free side.
struct StopAbout {
  double limit;  ///< rad
  double sign;   ///< +1: a low end, -1: a high one
  static constexpr PhiSpec spec{.reads = Reads::rotation, .counts_turns = true, .stays_in_plane = true};
  /// phi, rad.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return sign * (y.angle_z() - limit);
  }
};

/// (7.4) phi = x_S . y_P = 2 (e1 e2 - e0 e3): the two pins of the cross stay normal to each other.
struct Cross {
  static constexpr PhiSpec spec{.reads = Reads::rotation, .names = {"cross"}};
  /// phi, the cosine of the angle between the pins.
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * (y.e1 * y.e2 - y.e0 * y.e3);
  }
};

}  // namespace lockstep
