// SPDX-License-Identifier: BSD-3-Clause
// Formulas of forces, written once for any scalar, and what follows from them: wrench, tangent and powers.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include <lockstep/author/force.h>
#include <lockstep/author/jet.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

/// A number with its derivatives with respect to the pose of one slot (dx, dth) or its velocity (v, w): three each,
/// translations in world axes, rotations and angular velocities in slot axes.
using SlotJet = Jet<6, double, NoMotion>;

namespace formula {
/// What of a slot's motion has derivatives.
enum class Vary {
  nothing,  ///< nothing: constants
  pose,     ///< with respect to dx, dth
  velocity  ///< with respect to v, w
};
/// A motion as jets, with the derivatives of the pose or velocity, or with none.
LOCKSTEP_API MotionT<SlotJet> varied(const Motion&, Vary);
}  // namespace formula

/// The two markers of a force at one time. Without an S, S is the ground's origin.
template <class T>
struct Ends {
  MarkerOn<T> P,                                ///< marker P on its slot
      S;                                        ///< marker S on its slot, or the ground's origin
  const Inputs& in;                             ///< time, motions and integrated states of the mechanism
  int column = kGround;                         ///< of jets: the slot whose motion has derivatives
  formula::Vary what = formula::Vary::nothing;  ///< which of its motion has them
  double t = in.t;                              ///< time, s
  std::span<const double> s = in.s;             ///< State::s, for counted angles

  /// The motion of any slot, for a formula that reads more than its markers.
  MotionT<T> motion(int slot) const {
    if constexpr (std::is_same_v<T, double>)
      return in.slot(slot);
    else
      return formula::varied(in.slot(slot), slot == column ? what : formula::Vary::nothing);
  }
};

/// The powers and quantities of a force at one instant.
struct ForceAccount {
  double power = 0;                ///< given to the two bodies, W
  double potential = 0;            ///< potential energy, J
  double dissipation = 0;          ///< taken out by dampers, W
  double supply = 0;               ///< put in by laws, W: those of the force and those that move its markers
  std::array<double, 16> shown{};  ///< values of the force's quantities(), in their order, without "power"
  int n_shown = 0;                 ///< how many values are in `shown`
};

/// Formulas of forces. The formula of a force is a function of its two markers, written for any scalar:
///
///     template <class T, class Load>
///     void act(const Ends<T>& at, Load& load) const {
///       const Vec3T<T> d = at.P.x() - at.S.x();
///       load.force(-k_ * d, at.P.x(), at.S.x());
///       load.stores(0.5 * k_ * d.dot(d));
///     }
///
/// Numbers (T = double) give the wrench, jets the tangent (9.13), (9.14). The load has these functions; each kind of
/// load uses those it needs, and the others cost nothing:
///
///     force(F, x)           force F (world, N) on P's body at the point x (world, m), -F on S's body at the same point
///     force(F, x_P, x_S)    force F on P's body at x_P, -F on S's body at x_S, which is on the line of F
///     torque(M)             torque M (world, N m) on P's body, -M on S's
///     stores(V)             potential energy, J
///     dissipates(D)         power that dampers take out, W, not negative
///     supplies(P)           power that the force's own laws put in at the markers, W
///     shows(a, b, ...)      values of the force's quantities(), in their order: numbers and vectors
///
/// If markers are moved on their bodies by laws, the power given to the bodies differs from that at the markers.
/// The difference comes from those laws and is added to the supply.
namespace formula {

/// Base of loads that ignore energies and quantities.
template <class T>
struct Silent {
  void stores(const T&) {}      ///< ignored
  void dissipates(const T&) {}  ///< ignored
  void supplies(const T&) {}    ///< ignored
  /// Ignored.
  template <class... Values>
  void shows(const Values&...) {}
};

/// The load that adds the wrench of a formula to a sum.
struct WrenchLoad : Silent<double> {
  const WrenchSum& sum;  ///< the sum that it adds to
  int P,                 ///< slot of P
      S;                 ///< slot of S
  /// Adds to `to`; p and s are the slots of P and S.
  WrenchLoad(const WrenchSum& to, int p, int s) : sum(to), P(p), S(s) {}

  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }  ///< F at x on P's body, -F at x on S's body
  /// F at x_P on P's body, -F at x_S on S's body.
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    sum.force(P, F, x_P);
    sum.force(S, -F, x_S);
  }
  /// M on P's body, -M on S's body.
  void torque(const Vec3& M) {
    sum.torque(P, M);
    sum.torque(S, -M);
  }
};

/// The load that collects powers, energies and quantities of a formula.
struct AccountLoad : ForceAccount {
  const Ends<double>& at;  ///< the markers
  /// For a formula at these markers.
  explicit AccountLoad(const Ends<double>& ends) : at(ends) {}

  /// Adds the power of F at x.
  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }
  /// Adds the power of F at x_P and -F at x_S.
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    const auto marker_velocity = [](const MarkerOn<double>& m, const Vec3& x) -> Vec3 {
      return m.v() + cross(m.w(), Vec3(x - m.x()));
    };
    give(F.dot(at.P.slot_velocity(x_P) - at.S.slot_velocity(x_S)),
         F.dot(marker_velocity(at.P, x_P) - marker_velocity(at.S, x_S)));
  }
  /// Adds the power of M.
  void torque(const Vec3& M) { give(M.dot(at.P.slot_rate() - at.S.slot_rate()), M.dot(at.P.w() - at.S.w())); }
  void stores(double V) { potential += V; }        ///< adds V, J
  void dissipates(double D) { dissipation += D; }  ///< adds D, W
  void supplies(double W) { supply += W; }         ///< adds W, in watts
  /// Appends numbers and components of vectors; throws std::out_of_range after 16.
  template <class... Values>
  void shows(const Values&... values) {
    (show(values), ...);
  }

 private:
  void give(double to_bodies, double to_markers) { power += to_bodies, supply += to_bodies - to_markers; }
  void show(double value) { shown.at(static_cast<std::size_t>(n_shown++)) = value; }
  void show(const Vec3& value) {
    for (const double x : value) show(x);
  }
};

/// The load that collects the wrenches on both slots, in the coordinates of the equations of motion, with their
/// derivatives.
struct LOCKSTEP_API TangentLoad : Silent<SlotJet> {
  using Vec = Vec3T<SlotJet>;  ///< a vector with derivatives
  const Ends<SlotJet>& at;     ///< the markers, with derivatives
  Vec F[2],                    ///< forces on the slots of P and S, world axes, N
      M[2];                    ///< moments on the slots of P and S, about their origins, slot axes, N m
  /// For a formula at these markers.
  explicit TangentLoad(const Ends<SlotJet>& ends);

  /// Adds f at x on P's body, -f at x on S's body.
  void force(const Vec& f, const Vec& x) { force(f, x, x); }
  /// Adds f at x_P on P's body, -f at x_S on S's body.
  void force(const Vec& f, const Vec& x_P, const Vec& x_S);
  /// Adds m on P's body, -m on S's body.
  void torque(const Vec& m);
  /// Minus the derivatives of the wrench on the slot of P (i = 0) or S (i = 1): the sign of loads in the equations of
  /// motion. Rows: force, moment; columns: those of SlotJet.
  Mat6 rows(int i) const;
};

/// The markers of a force at the inputs' motions and time.
inline Ends<double> ends(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
  return {{in.slot(P.slot), P.at(in.t)}, {in.slot(S.slot), S.at(in.t)}, in};
}

/// Adds the wrench of the formula act(ends, load) to `out`.
template <class Act>
void apply(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, WrenchSum& out) {
  WrenchLoad load(out, P.slot, S.slot);
  act(ends(P, S, in), load);
}

/// Powers, energies and quantities of the formula act(ends, load).
template <class Act>
ForceAccount account(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act) {
  const Ends<double> at = ends(P, S, in);
  AccountLoad load(at);
  act(at, load);
  return static_cast<const ForceAccount&>(load);
}

/// Adds K and D of the formula act(ends, load) to `out`, with two passes over it for each slot that moves: pose and
/// velocity. `also`: further slots whose motion it reads.
template <class Act>
void tangent(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, TangentSum& out,
             std::span<const int> also = {}) {
  const MarkerMotion m_P = P.at(in.t), m_S = S.at(in.t);
  const auto add_column = [&](int column) {
    if (column == kGround) return;
    for (const Vary what : {Vary::pose, Vary::velocity}) {
      const auto motion = [&](int slot) { return varied(in.slot(slot), slot == column ? what : Vary::nothing); };
      const MotionT<SlotJet> O_P = motion(P.slot), O_S = motion(S.slot);
      const Ends<SlotJet> at{{O_P, m_P}, {O_S, m_S}, in, column, what};
      TangentLoad load(at);
      act(at, load);
      for (int i = 0; i < 2; ++i) {
        const int row = i == 0 ? P.slot : S.slot;
        if (what == Vary::pose)
          out.add_K(row, column, load.rows(i));
        else
          out.add_D(row, column, load.rows(i));
      }
    }
  };
  add_column(P.slot);
  if (S.slot != P.slot) add_column(S.slot);
  for (const int column : also)
    if (column != P.slot && column != S.slot) add_column(column);
}

}  // namespace formula

// FormulaForce (force.h): files do not compile these again for a force that is declared `extern template`.

template <class F>
auto FormulaForce<F>::act() const {
  return [this](const auto& at, auto& load) { static_cast<const F&>(*this).act(at, load); };
}

template <class F>
ForceAccount FormulaForce<F>::account(const Inputs& in) const {
  return formula::account(P_, S_, in, act());
}

template <class F>
void FormulaForce<F>::apply(const Inputs& in, WrenchSum& out) const {
  formula::apply(P_, S_, in, act(), out);
}

template <class F>
void FormulaForce<F>::tangent(const Inputs& in, TangentSum& out) const {
  formula::tangent(P_, S_, in, act(), out, static_cast<const F&>(*this).also_reads());
}

template <class F>
double FormulaForce<F>::potential(const Inputs& in) const {
  return account(in).potential;
}

template <class F>
double FormulaForce<F>::dissipation(const Inputs& in) const {
  return account(in).dissipation;
}

template <class F>
double FormulaForce<F>::supply(const Inputs& in) const {
  return account(in).supply;
}

template <class F>
double FormulaForce<F>::quantity(int k, const Inputs& in) const {
  const ForceAccount all = account(in);
  return k < all.n_shown ? all.shown[static_cast<std::size_t>(k)] : all.power;
}

}  // namespace lockstep
