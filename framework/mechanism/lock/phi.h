// phi: what a function of the relative coordinates sees, and what it may say about itself (theory, section 7).
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

#include "framework/mechanism/lock/relative_kinematics.h"
#include "framework/foundation/math/jet.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// What phi sees of a pair: P from S in S's axes, before any imposed law. x y z in m; r = (e0 e1 e2 e3) the unit
/// relative quaternion; t in s.
template <class T>
struct LockCoords {
  T x, y, z, e0, e1, e2, e3, t;
  double near_angle = 0;           ///< where angle_z is expected: the last accepted one, carried on at its rate
  const double* memory = nullptr;  ///< numbers of phi's own in State::z, kMemory of them

  /// Turn of P about the z axis of S, 2 atan2(e3, e0): the branch nearest to where it is expected (7.9). Needs
  /// kCountsTurns in phi; without it the branch is the one within half a turn of zero. Singular where z_P = -z_S.
  T angle_z() const {
    using std::atan2;
    T a = 2.0 * atan2(e3, e0);
    a.v -= kTwoPi * std::round((a.v - near_angle) / kTwoPi);
    return a;
  }
};

/// Law of time, or of any other number, on a jet: f(t) with its exact derivatives.
template <int N>
inline Jet<N> of(const MotionLaw& law, const Jet<N>& t) {
  const LawValue l = law.at(t.v);
  return jet_detail::chain(t, l.y, l.yd, l.ydd);
}

/// f(a, b) by the chain rule, where f is known by numbers: its value, gradient and second derivatives at (a.v, b.v).
template <int N>
inline Jet<N> of(const Jet<N>& a, const Jet<N>& b, double f, double fa, double fb, double faa, double fab, double fbb) {
  Jet<N> r(f, fa * a.d + fb * b.d, fa * a.h + fb * b.h + faa * a.d * a.d + 2.0 * fab * a.d * b.d + fbb * b.d * b.d);
  r.g = fa * a.g + fb * b.g;
  return r;
}

/// What Phi may say about itself, all optional:
///   kPairs       pairs of markers that it takes, 1 to 3                                    default 1
///   kRows        functions that it returns, as std::array<T, kRows> from 2 on              default 1
///   kNeeds       which coordinates it reads: translation, rotation or both; with several
///                pairs a std::array of them, or one for all. What is not read costs nothing     both
///   kCountsTurns angle_z() runs on past full turns, its memory in State::z                 default false
///   kKind        what its rows measure: RowKind::translation (m) for lengths               default function
///   kNames       names of its rows for messages and channels                               "phi", or "phi1" ...
///   breakpoints(t0, t1, out), blame(t)  as in Lock, where it has laws
///   at_home(link, y...)  called by setup() with the home poses: phase angles, refusals
///   kMemory      numbers of its own in State::z, which it reads as y.memory; written by
///                begin(z, y...) at home and remember(z, y...) after an accepted step                default 0
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
  static constexpr RowKind kKind = [] {
    if constexpr (requires { Phi::kKind; }) return RowKind(Phi::kKind);
    return RowKind::function;
  }();
  static constexpr std::array<Needs, static_cast<std::size_t>(kPairs)> kNeeds = [] {
    std::array<Needs, static_cast<std::size_t>(kPairs)> needs;
    needs.fill(Needs::both);
    if constexpr (requires { Phi::kNeeds[0]; })
      for (std::size_t k = 0; k < needs.size(); ++k) needs[k] = Phi::kNeeds[k];
    else if constexpr (requires { Phi::kNeeds; })
      needs.fill(Phi::kNeeds);
    return needs;
  }();

  static constexpr bool needs(int pair, Needs half) {
    return (unsigned(kNeeds[static_cast<std::size_t>(pair)]) & unsigned(half)) != 0;
  }
  /// Coordinates of a pair that are variables: [first, end) of y.
  static constexpr int first(int pair) { return needs(pair, Needs::translation) ? 0 : 3; }
  static constexpr int end(int pair) { return needs(pair, Needs::rotation) ? 7 : 3; }
  /// Number of the first variable of a pair among those of all pairs.
  static constexpr int start(int pair) {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += end(k) - first(k);
    return n;
  }
  static constexpr int kVariables = start(kPairs);
  static constexpr int kWidth = (kVariables + 1) / 2 * 2;  // of gradients: whole packs

  static std::string row_name(int k) {
    if constexpr (requires { Phi::kNames[0]; })
      return Phi::kNames[static_cast<std::size_t>(k)];
    else
      return kRows == 1 ? "phi" : "phi" + std::to_string(k + 1);
  }
  static_assert(kPairs >= 1 && kPairs <= 3, "a function takes one to three pairs");
  static_assert(kRows >= 1 && kRows <= kMaxRows, "a link has at most kMaxRows rows");
};

}  // namespace lockstep
