// SPDX-License-Identifier: BSD-3-Clause
// Joints from functions of relative coordinates: arguments and declarations of the function.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/law.h>
#include <lockstep/detail/markers.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

// phi: a function of the relative coordinates of pairs of markers, with its arguments and declarations (theory,
// section 7).
//
//   struct ScrewThread {                                       // advance per revolution along z
//     double lead;
//     static constexpr PhiSpec spec{.counts_turns = true};     // angle_z() runs on past full revolutions
//     template <class T> T operator()(const LockCoords<T>& y) const { return y.z - lead / kTwoPi * y.angle_z(); }
//   };
//
// A function of several pairs takes one LockCoords for each; several rows come as std::array<T, n>.

/// (7.9) Rotation of P about the z axis of S, rad: 2 atan2(e3, e0) on the branch nearest to `near`. T is a jet.
template <class T>
T angle_about_z(const T& e0, const T& e3, double near) {
  using std::atan2;
  T a = 2.0 * atan2(e3, e0);
  a.v -= kTwoPi * std::round((a.v - near) / kTwoPi);
  return a;
}

/// The arguments of phi for a pair: the pose of P relative to S, to which no imposed law is applied, and the time.
template <class T>
struct LockCoords {
  T x,                             ///< position of P along x of S, m
      y,                           ///< along y of S, m
      z,                           ///< along z of S, m
      e0,                          ///< scalar part of the relative quaternion r, |r| = 1
      e1,                          ///< its component along x of S
      e2,                          ///< along y of S
      e3,                          ///< along z of S
      t;                           ///< time, s
  double near_rest = 0;            ///< expected rest_z(), rad: as integrated (CountedAngle)
  double turns = 0;                ///< whole revolutions of angle_z()
  const double* memory = nullptr;  ///< the numbers of phi itself in State::z, PhiSpec::memory of them

  /// Rotation of P about the z axis of S, rad. With counts_turns = true it continues past full revolutions, with false
  /// it is within half a revolution of zero. Singular at z_P = -z_S.
  T angle_z() const { return rest_z() + kTwoPi * turns; }
  /// angle_z() less its whole revolutions, rad: a large sum keeps its digits if these are added separately.
  T rest_z() const { return angle_about_z(e0, e3, near_rest); }
};

/// A law on a jet t, the time or any other number: f(t) with its exact derivatives.
template <int N>
inline Jet<N> law_at(const MotionLaw& law, const Jet<N>& t) {
  const LawValue l = law.at(t.v);
  return jet_detail::chain(t, l.y, l.yd, l.ydd);
}

/// f(a, b) by the chain rule, if f is known by numbers: its value, gradient and second derivatives at (a.v, b.v).
template <int N>
inline Jet<N> function_of(const Jet<N>& a, const Jet<N>& b, double f, double fa, double fb, double faa, double fab,
                          double fbb) {
  Jet<N> r(f, fa * a.d + fb * b.d, fa * a.h + fb * b.h + faa * a.d * a.d + 2.0 * fab * a.d * b.d + fbb * b.d * b.d);
  r.g = fa * a.g + fb * b.g;
  return r;
}

/// The coordinates that a function reads of each of its pairs.
struct PairReads {
  std::array<Reads, 3> of;  ///< of pair 1, 2, 3
  /// The same of every pair.
  constexpr PairReads(Reads every) : of{every, every, every} {}  // NOLINT: one value stands for all
  /// Those of each pair.
  constexpr PairReads(Reads first, Reads second, Reads third = Reads::both) : of{first, second, third} {}
};

/// The declarations of a function, in its member `static constexpr PhiSpec spec`.
struct PhiSpec {
  int pairs = 1;  ///< pairs of markers that it takes, 1 to 3
  int rows = 1;   ///< functions that it returns, as std::array<T, rows> from 2 on
  /// Coordinates that it reads of each pair. Others cost nothing; setup() rejects a function that reads them.
  PairReads reads = Reads::both;
  /// Whether angle_z() continues past full revolutions, as a CountedAngle of each pair. setup() rejects a function that
  /// calls angle_z() without declaring it.
  std::optional<bool> counts_turns{};
  /// Whether a mechanism that moves in a plane stays there by it, at any time and in any position: see
  /// Lock::stays_in_plane. False: unknown, which keeps the mechanism in space.
  bool stays_in_plane = false;
  RowKind kind = RowKind::function;           ///< what its rows measure: RowKind::translation for lengths, m
  int memory = 0;                             ///< numbers that it keeps in State::z, see PhiHooks::reset
  std::array<const char*, kMaxRows> names{};  ///< of its rows; default "phi", or "phi1", "phi2", ...

  /// Whether it reads this half of the coordinates of a pair.
  constexpr bool reads_of(int pair, Reads half) const {
    return lockstep::reads(reads.of[static_cast<std::size_t>(pair)], half);
  }
  /// First of the seven coordinates of a pair that it reads.
  constexpr int first(int pair) const { return reads_of(pair, Reads::translation) ? 0 : 3; }
  /// One past the last of them.
  constexpr int end(int pair) const { return reads_of(pair, Reads::rotation) ? 7 : 3; }
  /// Index of the first coordinate of a pair among its variables, those it reads of all pairs.
  constexpr int start(int pair) const {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += end(k) - first(k);
    return n;
  }
  constexpr int variables() const { return start(pairs); }  ///< number of coordinates that it reads
  /// Whether the revolutions of a pair are counted.
  constexpr bool counts(int pair) const { return counts_turns.value_or(false) && reads_of(pair, Reads::rotation); }
  /// Whether there is a name for each row, or none.
  constexpr bool names_fit() const {
    int n = 0;
    while (n < kMaxRows && names[static_cast<std::size_t>(n)] != nullptr) ++n;
    return n == 0 || n == rows;
  }
};

/// The coordinates of each pair, with their rates.
using PhiCoords = std::span<const LockCoords<Time>>;

/// What a function derives from that does more than return its rows: it overrides what it needs.
struct LOCKSTEP_API PhiHooks {
  PhiHooks() = default;
  PhiHooks(const PhiHooks&) = default;             ///< has no data
  PhiHooks& operator=(const PhiHooks&) = default;  ///< has no data
  virtual ~PhiHooks();
  /// Called by setup() with the coordinates of the start: phase angles, errors that name the joint.
  virtual void initialise(const std::string& /*link*/, PhiCoords /*y*/) {}
  /// Writes its memory at the start.
  virtual void reset(std::span<double> /*z*/, PhiCoords /*y*/) const {}
  /// Updates its memory after an accepted step.
  virtual void accept_step(std::span<double> /*z*/, PhiCoords /*y*/) const {}
  /// As Driven::breakpoints, for laws in the function.
  virtual void breakpoints(double /*t0*/, double /*t1*/, std::vector<double>& /*out*/) const {}
  /// As Driven::diagnose.
  virtual std::string diagnose(double /*t*/) const { return {}; }
};

}  // namespace lockstep
