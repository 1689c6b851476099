// SPDX-License-Identifier: BSD-3-Clause
// What is refused of a function joint at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <lockstep/author/phi.h>

/// @cond
/// Left out of the pages: only PhiFunction refers to these names.

// Checks of a function joint at compile time: that its hooks are spelt as PhiTraits reads them and can be called, and
// that it reads no coordinate that its kReads leaves out. PhiFunction asserts them; each message names what was meant.
// tests/compile_fail has one wrong function for each.
namespace lockstep::phi_check {

// ------------------------------------------------------------------------------------------------------------ spelling

/// Names that are likely to be written in place of ours. If Phi has a member of such a name, be it data, a function or
/// a template, a class that derives from Phi and from this has two of it, and its lookup fails.
struct Misspellings {
  int kPair, kNPairs, kNumPairs, kPairCount, Pairs, kpairs;
  int kRow, kNRows, kNumRows, kRowCount, Rows, krows;
  int kNeeds, kNeed, kRead, kReading, kCoordinates, Reads, Needs, kreads;
  int kCountTurns, kCountTurn, kCountsTurn, kCountingTurns, kCountedTurns, kCounts_turns, kCountsturns, kCountsTruns,
      kTurnsCounted, kTurns, CountsTurns, counts_turns;
  int kStayInPlane, kStaysInAPlane, kInPlane, kIsPlanar, kPlanar, StaysInPlane, stays_in_plane;
  int kKinds, kRowKind, kRowKinds, kType, Kind;
  int kName, kRowNames, kRowName, Names;
  int kMemories, kOwnMemory, kNMemory, Memory, n_memory;
  int initialize, initialse, initalise, init, at_home, at_start;
  int begin, start_memory, resets;
  int remember, remembers, accept, accepts, accept_steps, acceptStep;
  int breakpoint, break_points, breakPoints;
  int blame, diagnosis, diagnostic, diagnoses;
};
/// Names of the functions that Phi may have, for the same use: their lookup fails if Phi has them with any signature.
struct Functions {
  int initialise, reset, accept_step, breakpoints, diagnose;
};
/// Phi together with members of these names.
template <class Phi, class Names>
struct Beside : Phi, Names {};

/// What one can derive from.
template <class Phi>
concept IsClass = std::is_class_v<Phi> && !std::is_final_v<Phi>;

/// Refuses misspelt names, and names the one that is meant.
template <class Phi>
struct Spelling {
  static_assert(IsClass<Phi>, "a function of a joint is a class or struct that is not final");
  using B = Beside<Phi, Misspellings>;
  static_assert(
      requires(B b) { b.kPair, b.kNPairs, b.kNumPairs, b.kPairCount, b.Pairs, b.kpairs; },
      "misspelt: a function says how many pairs of markers it takes by kPairs");
  static_assert(
      requires(B b) { b.kRow, b.kNRows, b.kNumRows, b.kRowCount, b.Rows, b.krows; },
      "misspelt: a function says how many rows it returns by kRows");
  static_assert(
      requires(B b) { b.kNeeds, b.kNeed, b.kRead, b.kReading, b.kCoordinates, b.Reads, b.Needs, b.kreads; },
      "misspelt: a function says which coordinates it reads by kReads (kNeeds is its old name)");
  static_assert(
      requires(B b) {
        b.kCountTurns, b.kCountTurn, b.kCountsTurn, b.kCountingTurns, b.kCountedTurns, b.kCounts_turns, b.kCountsturns,
            b.kCountsTruns, b.kTurnsCounted, b.kTurns, b.CountsTurns, b.counts_turns;
      },
      "misspelt: a function says that angle_z() runs on past full turns by kCountsTurns");
  static_assert(
      requires(B b) {
        b.kStayInPlane, b.kStaysInAPlane, b.kInPlane, b.kIsPlanar, b.kPlanar, b.StaysInPlane, b.stays_in_plane;
      },
      "misspelt: a function says that planar mechanisms stay in their plane by kStaysInPlane");
  static_assert(
      requires(B b) { b.kKinds, b.kRowKind, b.kRowKinds, b.kType, b.Kind; },
      "misspelt: a function says what its rows measure by kKind");
  static_assert(
      requires(B b) { b.kName, b.kRowNames, b.kRowName, b.Names; }, "misspelt: a function names its rows by kNames");
  static_assert(
      requires(B b) { b.kMemories, b.kOwnMemory, b.kNMemory, b.Memory, b.n_memory; },
      "misspelt: a function says how many numbers it remembers by kMemory");
  static_assert(
      requires(B b) { b.initialize, b.initialse, b.initalise, b.init, b.at_home, b.at_start; },
      "misspelt: what setup() calls with the poses of the start is initialise(link, y...)");
  static_assert(
      requires(B b) { b.begin, b.start_memory, b.resets; },
      "misspelt: what writes the memory of the start is reset(z, y...)");
  static_assert(
      requires(B b) { b.remember, b.remembers, b.accept, b.accepts, b.accept_steps, b.acceptStep; },
      "misspelt: what writes the memory after an accepted step is accept_step(z, y...)");
  static_assert(
      requires(B b) { b.breakpoint, b.break_points, b.breakPoints; },
      "misspelt: what lists the jumps of its laws is breakpoints(t0, t1, out)");
  static_assert(
      requires(B b) { b.blame, b.diagnosis, b.diagnostic, b.diagnoses; },
      "misspelt: what names the law at fault is diagnose(t) (blame is its old name)");
  static constexpr bool kChecked = true;
};

// ----------------------------------------------------------------------------------------------------------- functions

/// Which of the functions that it may have Phi has; refuses one that cannot be called as PhiFunction calls it.
template <class Phi>
struct Hooks {
  using F = Beside<Phi, Functions>;
  using Traits = PhiTraits<Phi>;
  /// Whether it can be called with one LockCoords<T> for each pair.
  template <class T, class Call>
  static constexpr bool takes(Call) {
    return []<std::size_t... k>(std::index_sequence<k...>) {
      return std::invocable<Call, Phi&, decltype((void(k), std::declval<const LockCoords<T>&>()))...>;
    }
    (std::make_index_sequence<Traits::kPairs>{});
  }
  static constexpr auto initialise = [](auto& phi, const auto&... y) -> decltype(phi.initialise(std::string(), y...)) {
  };
  static constexpr auto reset = [](const auto& phi,
                                   const auto&... y) -> decltype(phi.reset(std::span<double>(), y...)) {};
  static constexpr auto accept_step = [](const auto& phi,
                                         const auto&... y) -> decltype(phi.accept_step(std::span<double>(), y...)) {};

  static constexpr bool kInitialises = takes<Time>(initialise), kResets = takes<Time>(reset),
                        kAccepts = takes<Time>(accept_step);
  static constexpr bool kHasBreakpoints = requires(const Phi& phi, std::vector<double>& out) {
    phi.breakpoints(0.0, 1.0, out);
  };
  static constexpr bool kDiagnoses = requires(const Phi& phi) {
    { phi.diagnose(0.0) } -> std::convertible_to<std::string>;
  };
  static_assert(
      kInitialises || requires(F f) { f.initialise; },
      "initialise is not void initialise(const std::string& link, const LockCoords<Time>& y), with one y for "
      "each pair");
  static_assert(
      kResets || requires(F f) { f.reset; },
      "reset is not void reset(std::span<double> z, const LockCoords<Time>& y) const, with one y for each "
      "pair");
  static_assert(
      kAccepts || requires(F f) { f.accept_step; },
      "accept_step is not void accept_step(std::span<double> z, const LockCoords<Time>& y) const, with one y "
      "for each pair");
  static_assert(
      kHasBreakpoints || requires(F f) { f.breakpoints; },
      "breakpoints is not void breakpoints(double t0, double t1, std::vector<double>& out) const");
  static_assert(
      kDiagnoses || requires(F f) { f.diagnose; }, "diagnose is not std::string diagnose(double t) const");
  static_assert(Traits::kMemory == 0 || (kResets && kAccepts),
                "a function with kMemory writes it by reset(z, y...) and accept_step(z, y...)");
  static_assert(Traits::kMemory > 0 || !(kResets || kAccepts),
                "reset and accept_step write a memory; say by kMemory how many numbers it has");
  static constexpr bool kChecked = true;
};

// ------------------------------------------------------------------------------------------------------------- reading

/// Types of the coordinates that kReads leaves out, and of a memory without kMemory; the compiler's message shows their
/// names.
struct add_translation_to_kReads {};
struct add_rotation_to_kReads {};
struct say_kMemory {};
template <class T>
concept Unread = std::same_as<T, add_translation_to_kReads> || std::same_as<T, add_rotation_to_kReads>;

template <class Half>
void unread() {
  if constexpr (std::same_as<Half, add_translation_to_kReads>)
    static_assert(!Unread<Half>,
                  "this function reads x, y or z, which its kReads leaves out; add translation to kReads");
  else
    static_assert(!Unread<Half>, "this function reads e0 ... e3, which its kReads leaves out; add rotation to kReads");
}
template <class A, class B>
requires(Unread<A> || Unread<B>) Time operand(const A&, const B&) {
  unread<std::conditional_t<Unread<A>, A, B>>();
  return {};
}
template <class A, class B>
requires(Unread<A> || Unread<B>) Time operator+(const A& a, const B& b) { return operand(a, b); }
template <class A, class B>
requires(Unread<A> || Unread<B>) Time operator-(const A& a, const B& b) { return operand(a, b); }
template <class A, class B>
requires(Unread<A> || Unread<B>) Time operator*(const A& a, const B& b) { return operand(a, b); }
template <class A, class B>
requires(Unread<A> || Unread<B>) Time operator/(const A& a, const B& b) { return operand(a, b); }

/// Probes are jets of a negative N, whose bits encode what Phi defines. They never hold numbers: a function is only
/// compiled for them.
enum ProbeBits : int { kTranslation = 1, kRotation = 2, kTurnsSaid = 4, kMemorySaid = 8 };
constexpr bool has(int probe, ProbeBits bit) { return ((-1 - probe) & bit) != 0; }

template <class Phi>
constexpr int probe() {
  using Traits = PhiTraits<Phi>;
  int bits = Traits::kMemory > 0 ? kMemorySaid : 0;
  if (Traits::reads(Reads::translation)) bits |= kTranslation;
  if (Traits::reads(Reads::rotation)) bits |= kRotation;
  if constexpr (requires { Phi::kCountsTurns; }) bits |= kTurnsSaid;
  return -1 - bits;
}

/// Gradient of a probe.
struct NoGradient {
  NoGradient operator-() const { return {}; }
  NoGradient& operator+=(NoGradient) { return *this; }
  NoGradient& operator-=(NoGradient) { return *this; }
  NoGradient& operator*=(double) { return *this; }
  friend NoGradient operator+(NoGradient, NoGradient) { return {}; }
  friend NoGradient operator-(NoGradient, NoGradient) { return {}; }
  friend NoGradient operator*(double, NoGradient) { return {}; }
  friend NoGradient operator*(NoGradient, double) { return {}; }
};

}  // namespace lockstep::phi_check

namespace lockstep {

/// A probe.
template <int N>
requires(N < 0) struct Jet<N, double> {
  double v{0}, d{0}, h{0};
  phi_check::NoGradient g;
  Jet() = default;
  Jet(double value) : v(value) {}  // NOLINT: a constant is a jet
  Jet(double value, double first, double second) : v(value), d(first), h(second) {}
  template <std::same_as<long double> F>
  operator F() const {
    return jet_detail::not_a_number<F>();
  }
};

/// Coordinates on a probe: using those that Phi does not define does not compile.
template <int N>
requires(N < 0) struct LockCoords<Jet<N>> {
  using T = Jet<N>;
  std::conditional_t<phi_check::has(N, phi_check::kTranslation), T, phi_check::add_translation_to_kReads> x, y, z;
  std::conditional_t<phi_check::has(N, phi_check::kRotation), T, phi_check::add_rotation_to_kReads> e0, e1, e2, e3;
  T t;
  double near_rest = 0, turns = 0;
  std::conditional_t<phi_check::has(N, phi_check::kMemorySaid), const double*, phi_check::say_kMemory> memory{};

  T angle_z() const {
    static_assert(phi_check::has(N, phi_check::kRotation),
                  "this function calls angle_z(), a turn, which its kReads leaves out; add rotation to kReads");
    static_assert(phi_check::has(N, phi_check::kTurnsSaid),
                  "this function calls angle_z(); say static constexpr bool kCountsTurns = true, or false where the "
                  "angle stays within half a turn of zero");
    return {};
  }
  T rest_z() const { return angle_z(); }
};

namespace phi_check {

/// Calls of a function with one LockCoords<T> for each pair.
template <class Phi, class T>
struct Call {
  template <std::size_t... k>
  static constexpr bool callable(std::index_sequence<k...>) {
    return std::invocable<const Phi&, decltype((void(k), std::declval<const LockCoords<T>&>()))...>;
  }
  template <std::size_t... k>
  static auto compile(const Phi& phi, std::index_sequence<k...>) {
    return phi((void(k), LockCoords<T>{})...);
  }
  using Pairs = std::make_index_sequence<PhiTraits<Phi>::kPairs>;
};

/// Number of rows in the returned type R: 1 for a T, n for an array, 0 for anything else.
template <class R, class T>
inline constexpr int kReturned = std::convertible_to<R, T> ? 1 : 0;
template <class R, std::size_t n, class T>
inline constexpr int kReturned<std::array<R, n>, T> = static_cast<int>(n);

/// Refuses a function that cannot be called, that reads what its kReads leaves out, or whose kRows does not fit.
template <class Phi>
struct Reading {
  using Traits = PhiTraits<Phi>;
  template <class T>
  using On = Call<Phi, T>;
  static_assert(On<Time>::callable(typename On<Time>::Pairs{}),
                "a function is called as const with one LockCoords<T> for each pair, for any T; kPairs says how many");
  using T = Jet<probe<Phi>()>;
  using Returned = decltype(On<T>::compile(std::declval<const Phi&>(), typename On<T>::Pairs{}));
  static_assert(kReturned<Returned, T> > 0, "a function returns T, or std::array<T, kRows> where it has several rows");
  static_assert(kReturned<Returned, T> == 0 || kReturned<Returned, T> == Traits::kRows,
                "kRows is not the number of rows that the function returns: std::array<T, n> needs kRows = n");
  static constexpr bool kChecked = true;
};

/// Whether kNames, if there is one, has kRows names.
template <class Phi>
constexpr bool names_fit() {
  if constexpr (requires { Phi::kNames[0]; }) return std::size(Phi::kNames) == std::size_t(PhiTraits<Phi>::kRows);
  return true;
}

}  // namespace phi_check
}  // namespace lockstep
/// @endcond
