// SPDX-License-Identifier: BSD-3-Clause
// Joints from functions of relative coordinates: what the function is given and what it defines.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/law.h>
#include <lockstep/author/lock.h>
#include <lockstep/author/relative.h>

namespace lockstep {

// phi: a function of the relative coordinates of pairs of markers: what it is given, and what it may define about
// itself (theory, section 7).
//
//   struct ScrewThread {                                       // advance per turn along z
//     double lead;
//     static constexpr bool kCountsTurns = true;               // angle_z() runs on past full turns
//     template <class T> T operator()(const LockCoords<T>& y) const { return y.z - lead / kTwoPi * y.angle_z(); }
//   };
//
// A function of several pairs takes one LockCoords for each; several rows come as std::array<T, n>.

/// (7.9) Turn of P about the z axis of S, rad: 2 atan2(e3, e0) on the branch nearest to `near`. T is a jet.
template <class T>
T angle_about_z(const T& e0, const T& e3, double near) {
  using std::atan2;
  T a = 2.0 * atan2(e3, e0);
  a.v -= kTwoPi * std::round((a.v - near) / kTwoPi);
  return a;
}

/// What phi sees of a pair: the pose of P seen from S, to which no imposed law is applied, and the time.
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
  double near_rest = 0;            ///< where rest_z() is expected, rad: as it was integrated (CountedAngle)
  double turns = 0;                ///< whole turns of angle_z()
  const double* memory = nullptr;  ///< the kMemory numbers of phi itself in State::z

  /// Turn of P about the z axis of S, rad. With kCountsTurns = true it runs on past full turns, with false it is within
  /// half a turn of zero. Singular where z_P = -z_S.
  T angle_z() const { return rest_z() + kTwoPi * turns; }
  /// angle_z() less its whole turns, rad: a sum of many turns keeps its digits where these are added by themselves.
  T rest_z() const { return angle_about_z(e0, e3, near_rest); }
};

/// A law on a jet t, the time or any other number: f(t) with its exact derivatives.
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

/// What a function Phi may define about itself. All of it is optional; what is misspelt, or does not fit the function,
/// does not compile. Constants: kPairs, kRows, kReads, kCountsTurns, kStaysInPlane, kKind, kMemory as below, and kNames,
/// the names of its rows in messages and channels. Functions:
///   - initialise(link, y...) is called by setup() with the coordinates of the start: phase angles, refusals;
///   - reset(z, y...) and accept_step(z, y...) write its kMemory numbers at the start and after accepted steps;
///   - breakpoints(t0, t1, out) and diagnose(t) are those of Driven, for laws.
template <class Phi>
struct PhiTraits {
  /// Pairs of markers that it takes, 1 to 3; default 1.
  static constexpr int kPairs = [] {
    if constexpr (requires { Phi::kPairs; }) return int(Phi::kPairs);
    return 1;
  }();
  /// Functions that it returns, as std::array<T, kRows> from 2 on; default 1.
  static constexpr int kRows = [] {
    if constexpr (requires { Phi::kRows; }) return int(Phi::kRows);
    return 1;
  }();
  /// Whether angle_z() runs on past full turns, as a CountedAngle of each pair. To be defined where angle_z() is called;
  /// otherwise false.
  static constexpr bool kCountsTurns = [] {
    if constexpr (requires { Phi::kCountsTurns; }) return bool(Phi::kCountsTurns);
    return false;
  }();
  /// Whether a mechanism that moves in a plane stays there by it, at any time and in any position: see
  /// Lock::stays_in_plane. Default false, unknown, which keeps the mechanism in space.
  static constexpr bool kStaysInPlane = [] {
    if constexpr (requires { Phi::kStaysInPlane; }) return bool(Phi::kStaysInPlane);
    return false;
  }();
  /// Numbers that it keeps in State::z and reads as y.memory[0], ...; default 0.
  static constexpr int kMemory = [] {
    if constexpr (requires { Phi::kMemory; }) return int(Phi::kMemory);
    return 0;
  }();
  /// What its rows measure: RowKind::translation for lengths, m; default function.
  static constexpr RowKind kKind = [] {
    if constexpr (requires { Phi::kKind; }) return RowKind(Phi::kKind);
    return RowKind::function;
  }();
  /// Coordinates that it reads of each pair; in Phi a std::array of Reads, or one for all pairs; default both. What is
  /// not read costs nothing.
  static constexpr std::array<Reads, kPairs> kReads = [] {
    std::array<Reads, kPairs> reads;
    reads.fill(Reads::both);
    if constexpr (requires { Phi::kReads[0]; })
      for (std::size_t k = 0; k < reads.size(); ++k) reads[k] = Phi::kReads[k];
    else if constexpr (requires { Phi::kReads; })
      reads.fill(Phi::kReads);
    return reads;
  }();

  /// Whether it reads this half of the coordinates of a pair.
  static constexpr bool reads(int pair, Reads half) { return (unsigned(kReads[pair]) & unsigned(half)) != 0; }
  /// Whether it reads this half of any pair.
  static constexpr bool reads(Reads half) {
    for (int k = 0; k < kPairs; ++k)
      if (reads(k, half)) return true;
    return false;
  }
  /// First of the seven coordinates of a pair that it reads.
  static constexpr int first(int pair) { return reads(pair, Reads::translation) ? 0 : 3; }
  /// One past the last of them.
  static constexpr int end(int pair) { return reads(pair, Reads::rotation) ? 7 : 3; }
  /// Where the coordinates of a pair begin among its variables, those it reads of all pairs.
  static constexpr int start(int pair) {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += end(k) - first(k);
    return n;
  }
  /// Whether the turns of a pair are counted.
  static constexpr bool counts(int pair) { return kCountsTurns && reads(pair, Reads::rotation); }
  static constexpr int kVariables = start(kPairs);         ///< number of coordinates that it reads
  static constexpr int kWidth = (kVariables + 1) / 2 * 2;  ///< length of gradients, an even number: whole packs

  /// Row k: kKind, and the name that kNames gives it; default "phi", or "phi1", "phi2", ...
  static LinkRow row(int k) {
    if constexpr (requires { Phi::kNames[0]; })
      return {kKind, Phi::kNames[k]};
    else
      return {kKind, kRows == 1 ? "phi" : "phi" + std::to_string(k + 1)};
  }
  static_assert(kPairs >= 1 && kPairs <= 3, "kPairs: a function takes one to three pairs");
  static_assert(kRows >= 1 && kRows <= kMaxRows, "kRows: a link has at most kMaxRows rows");
};

}  // namespace lockstep
