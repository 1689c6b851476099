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

#include <lockstep/jet.h>
#include <lockstep/law.h>
#include <lockstep/lock.h>
#include <lockstep/relative.h>

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
  T x,                    ///< position of P along x of S, m
      y,                  ///< along y of S, m
      z,                  ///< along z of S, m
      e0,                 ///< scalar part of the relative quaternion r, |r| = 1
      e1,                 ///< its component along x of S
      e2,                 ///< along y of S
      e3,                 ///< along z of S
      t;                  ///< time, s
  double near_angle = 0;  ///< where angle_z() is expected, rad: the last accepted angle, carried on at its rate
  const double* memory = nullptr;  ///< the kMemory numbers of phi itself in State::z

  /// Turn of P about the z axis of S, rad. With kCountsTurns = true it runs on past full turns, with false it is within
  /// half a turn of zero. Singular where z_P = -z_S.
  T angle_z() const { return angle_about_z(e0, e3, near_angle); }
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
/// does not compile. Constants: kPairs, kRows, kReads, kCountsTurns, kKind, kMemory as below, and kNames, the names of
/// its rows in messages and channels. Functions:
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
  /// Whether angle_z() runs on past full turns, by three numbers per pair in State::z. To be defined where angle_z() is
  /// called; otherwise false.
  static constexpr bool kCountsTurns = [] {
    if constexpr (requires { Phi::kCountsTurns; }) return bool(Phi::kCountsTurns);
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
  static constexpr std::array<Reads, static_cast<std::size_t>(kPairs)> kReads = [] {
    std::array<Reads, static_cast<std::size_t>(kPairs)> reads;
    reads.fill(Reads::both);
    if constexpr (requires { Phi::kReads[0]; })
      for (std::size_t k = 0; k < reads.size(); ++k) reads[k] = Phi::kReads[k];
    else if constexpr (requires { Phi::kReads; })
      reads.fill(Phi::kReads);
    return reads;
  }();

  /// Whether it reads this half of the coordinates of a pair.
  static constexpr bool reads(int pair, Reads half) {
    return (unsigned(kReads[static_cast<std::size_t>(pair)]) & unsigned(half)) != 0;
  }
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
  /// Number of pairs before this one whose turns are counted.
  static constexpr int counted(int pair) {
    int n = 0;
    for (int k = 0; k < pair; ++k) n += counts(k);
    return n;
  }
  static constexpr int kVariables = start(kPairs);         ///< number of coordinates that it reads
  static constexpr int kWidth = (kVariables + 1) / 2 * 2;  ///< length of gradients, an even number: whole packs

  /// Row k: kKind, and the name that kNames gives it; default "phi", or "phi1", "phi2", ...
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
    (std::make_index_sequence<static_cast<std::size_t>(Traits::kPairs)>{});
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
};

/// Coordinates on a probe: using those that Phi does not define does not compile.
template <int N>
requires(N < 0) struct LockCoords<Jet<N>> {
  using T = Jet<N>;
  std::conditional_t<phi_check::has(N, phi_check::kTranslation), T, phi_check::add_translation_to_kReads> x, y, z;
  std::conditional_t<phi_check::has(N, phi_check::kRotation), T, phi_check::add_rotation_to_kReads> e0, e1, e2, e3;
  T t;
  double near_angle = 0;
  std::conditional_t<phi_check::has(N, phi_check::kMemorySaid), const double*, phi_check::say_kMemory> memory{};

  T angle_z() const {
    static_assert(phi_check::has(N, phi_check::kRotation),
                  "this function calls angle_z(), a turn, which its kReads leaves out; add rotation to kReads");
    static_assert(phi_check::has(N, phi_check::kTurnsSaid),
                  "this function calls angle_z(); say static constexpr bool kCountsTurns = true, or false where the "
                  "angle stays within half a turn of zero");
    return {};
  }
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
  using Pairs = std::make_index_sequence<static_cast<std::size_t>(PhiTraits<Phi>::kPairs)>;
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
