// phi: a function of the relative coordinates of marker pairs: what it is given, and what it may say about itself
// (theory, section 7).
//
//   struct ScrewThread {                                       // advance per turn along z
//     double lead;
//     static constexpr bool kCountsTurns = true;               // angle_z() runs on past full turns
//     template <class T> T operator()(const LockCoords<T>& y) const { return y.z - lead / kTwoPi * y.angle_z(); }
//   };
//
// A function of several pairs takes one LockCoords for each; several rows come as std::array<T, n>.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "framework/foundation/math/jet.h"
#include "framework/mechanism/lock/lock.h"
#include "framework/mechanism/lock/look.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// Turn of P about the z axis of S from its quaternion, 2 atan2(e3, e0): the branch nearest to `near` (7.9).
template <class T>
T angle_about_z(const T& e0, const T& e3, double near) {
  using std::atan2;
  T a = 2.0 * atan2(e3, e0);
  a.v -= kTwoPi * std::round((a.v - near) / kTwoPi);
  return a;
}

/// What phi sees of a pair: P from S in S's axes, before any imposed law. x y z in m; r = (e0 e1 e2 e3) the unit
/// relative quaternion; t in s.
template <class T>
struct LockCoords {
  T x, y, z, e0, e1, e2, e3, t;
  double near_angle = 0;           ///< where angle_z is expected: the last accepted one, carried on at its rate
  const double* memory = nullptr;  ///< numbers of phi's own in State::z, kMemory of them

  /// Turn of P about the z axis of S. With kCountsTurns it runs on past full turns; with kCountsTurns = false it is the
  /// one within half a turn of zero. Singular where z_P = -z_S.
  T angle_z() const { return angle_about_z(e0, e3, near_angle); }
};

/// Law of time, or of any other number, on a jet: f(t) with its exact derivatives.
template <int N>
inline Jet<N> law_at(const MotionLaw& law, const Jet<N>& t) {
  const LawValue l = law.at(t.v);
  return jet_detail::chain(t, l.y, l.yd, l.ydd);
}

/// f(a, b) by the chain rule, where f is known by numbers: its value, gradient and second derivatives at (a.v, b.v).
template <int N>
inline Jet<N> function_of(const Jet<N>& a, const Jet<N>& b, double f, double fa, double fb, double faa, double fab,
                          double fbb) {
  Jet<N> r(f, fa * a.d + fb * b.d, fa * a.h + fb * b.h + faa * a.d * a.d + 2.0 * fab * a.d * b.d + fbb * b.d * b.d);
  r.g = fa * a.g + fb * b.g;
  return r;
}

/// What Phi may say about itself, all optional; what is misspelt, or does not fit the function, does not compile
/// (phi_check.h).
///   kPairs        pairs of markers that it takes, 1 to 3                                   default 1
///   kRows         functions that it returns, as std::array<T, kRows> from 2 on             default 1
///   kReads        which coordinates it reads: Reads::translation, rotation or both; with
///                 several pairs a std::array of them, or one for all. What is not read
///                 costs nothing                                                            default both
///   kCountsTurns  whether angle_z() runs on past full turns, its memory in State::z        to be said with angle_z()
///   kKind         what its rows measure: RowKind::translation (m) for lengths              default function
///   kNames        names of its rows for messages and channels                              "phi", or "phi1" ...
///   kMemory       numbers of its own in State::z, which it reads as y.memory; written by
///                 reset(z, y...) at the start and accept_step(z, y...) after an accepted step   default 0
///   initialise(link, y...)  called by setup() with the poses of the start: phase angles, refusals
///   breakpoints(t0, t1, out), diagnose(t)  as in Driven, where it has laws
template <class Phi>
struct PhiTraits {
  static constexpr int kPairs = [] {
    if constexpr (requires { Phi::kPairs; }) return int(Phi::kPairs);
    return 1;
  }();
  static constexpr int kRows = [] {
    if constexpr (requires { Phi::kRows; }) return int(Phi::kRows);
    return 1;
  }();
  static constexpr bool kCountsTurns = [] {
    if constexpr (requires { Phi::kCountsTurns; }) return bool(Phi::kCountsTurns);
    return false;
  }();
  static constexpr int kMemory = [] {
    if constexpr (requires { Phi::kMemory; }) return int(Phi::kMemory);
    return 0;
  }();
  static constexpr RowKind kKind = [] {
    if constexpr (requires { Phi::kKind; }) return RowKind(Phi::kKind);
    return RowKind::function;
  }();
  static constexpr std::array<Reads, static_cast<std::size_t>(kPairs)> kReads = [] {
    std::array<Reads, static_cast<std::size_t>(kPairs)> reads;
    reads.fill(Reads::both);
    if constexpr (requires { Phi::kReads[0]; })
      for (std::size_t k = 0; k < reads.size(); ++k) reads[k] = Phi::kReads[k];
    else if constexpr (requires { Phi::kReads; })
      reads.fill(Phi::kReads);
    return reads;
  }();

  static constexpr bool reads(int pair, Reads half) {
    return (unsigned(kReads[static_cast<std::size_t>(pair)]) & unsigned(half)) != 0;
  }
  /// Of any pair.
  static constexpr bool reads(Reads half) {
    for (int k = 0; k < kPairs; ++k)
      if (reads(k, half)) return true;
    return false;
  }
  /// Coordinates of a pair that are variables: [first, end) of y.
  static constexpr int first(int pair) { return reads(pair, Reads::translation) ? 0 : 3; }
  static constexpr int end(int pair) { return reads(pair, Reads::rotation) ? 7 : 3; }
  /// Number of the first variable of a pair among those of all pairs.
  static constexpr int start(int pair) {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += end(k) - first(k);
    return n;
  }
  /// Whether turns of this pair are counted, and how many of the pairs before it have theirs.
  static constexpr bool counts(int pair) { return kCountsTurns && reads(pair, Reads::rotation); }
  static constexpr int counted(int pair) {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += counts(k);
    return n;
  }
  static constexpr int kVariables = start(kPairs);
  static constexpr int kWidth = (kVariables + 1) / 2 * 2;  // of gradients: whole packs

  static LinkRow row(int k) {
    if constexpr (requires { Phi::kNames[0]; })
      return {kKind, Phi::kNames[static_cast<std::size_t>(k)]};
    else
      return {kKind, kRows == 1 ? "phi" : "phi" + std::to_string(k + 1)};
  }
  static_assert(kPairs >= 1 && kPairs <= 3, "kPairs: a function takes one to three pairs");
  static_assert(kRows >= 1 && kRows <= kMaxRows, "kRows: a link has at most kMaxRows rows");
};

}  // namespace lockstep
