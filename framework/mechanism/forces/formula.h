// Formulas of forces: what a force does, said once on any scalar; its wrench, its tangent and its powers follow.
//
//   template <class T, class Load>
//   void act(const Ends<T>& at, Load& load) const {
//     const Vec3T<T> d = at.P.x() - at.S.x();
//     load.force(-k_ * d, at.P.x(), at.S.x());
//     load.stores(0.5 * k_ * d.dot(d));
//   }
//
// Numbers (T = double) give the wrench, jets the tangent (9.13), (9.14). A load takes
//
//   force(F, x)           force F (world, N) on P's body at the point x (world, m), -F on S's body at the same point
//   force(F, x_P, x_S)    the same with a point of its own on S's body, on the line of F
//   torque(M)             torque M (world, N m) on P's body, -M on S's
//   stores(V)             potential energy, J
//   dissipates(D)         power that dampers take out, W, not negative
//   supplies(P)           power that the force's own laws put in at the markers, W
//   shows(a, b, ...)      the force's quantities(), in their order: numbers and vectors
//
// and uses what it needs of it; the rest costs nothing. Markers that move on their bodies by laws put in what the bodies
// get beyond what the markers get: that is added to supply by itself.
#pragma once

#include <array>
#include <type_traits>

#include "framework/foundation/math/jet.h"
#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/rows/sums.h"
#include "framework/mechanism/rows/tangent.h"

namespace lockstep {

/// The two markers of a force at one instant. Without an S it is the ground's origin.
template <class T>
struct Ends {
  MarkerOn<T> P, S;
  double t;                   ///< s
  std::span<const double> z;  ///< the mechanism's memory, State::z
};

/// A number with its derivatives on the pose of one slot, dx dth, or on its velocity, v w: three each, turns and angular
/// velocities in slot axes.
using SlotJet = Jet<6, double, NoMotion>;

/// What a force does to its two bodies at one instant, and where its power goes.
struct ForceAccount {
  double power = 0;        ///< W, given to the two bodies
  double potential = 0;    ///< J
  double dissipation = 0;  ///< W
  double supply = 0;       ///< W, put in by laws: those of the force and those that move its markers
  std::array<double, 16> shown{};
  int n_shown = 0;
};

namespace formula {

template <class T>
struct Silent {
  void stores(const T&) {}
  void dissipates(const T&) {}
  void supplies(const T&) {}
  template <class... Values>
  void shows(const Values&...) {}
};

struct WrenchLoad : Silent<double> {
  const WrenchSum& sum;
  int P, S;
  WrenchLoad(const WrenchSum& to, int p, int s) : sum(to), P(p), S(s) {}

  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    sum.force(P, F, x_P);
    sum.force(S, -F, x_S);
  }
  void torque(const Vec3& M) {
    sum.torque(P, M);
    sum.torque(S, -M);
  }
};

struct AccountLoad : ForceAccount {
  const Ends<double>& at;
  explicit AccountLoad(const Ends<double>& ends) : at(ends) {}

  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    const auto marker_velocity = [](const MarkerOn<double>& m, const Vec3& x) -> Vec3 {
      return m.v() + cross(m.w(), Vec3(x - m.x()));
    };
    give(F.dot(at.P.slot_velocity(x_P) - at.S.slot_velocity(x_S)),
         F.dot(marker_velocity(at.P, x_P) - marker_velocity(at.S, x_S)));
  }
  void torque(const Vec3& M) { give(M.dot(at.P.slot_rate() - at.S.slot_rate()), M.dot(at.P.w() - at.S.w())); }
  void stores(double V) { potential += V; }
  void dissipates(double D) { dissipation += D; }
  void supplies(double W) { supply += W; }
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

/// The wrenches on both slots in the coordinates of the equations of motion, with what they vary by.
struct LOCKSTEP_API TangentLoad : Silent<SlotJet> {
  using Vec = Vec3T<SlotJet>;
  const Ends<SlotJet>& at;
  Vec F[2], M[2];  // of P and S: world; about the slot's origin, slot axes
  explicit TangentLoad(const Ends<SlotJet>& ends);

  void force(const Vec& f, const Vec& x) { force(f, x, x); }
  void force(const Vec& f, const Vec& x_P, const Vec& x_S);
  void torque(const Vec& m);
  /// Minus the derivatives of the wrench on P's slot (i = 0) or S's: a load enters the equations of motion so.
  Mat6 rows(int i) const;
};

/// The motion of a slot with its derivatives on its own pose or velocity, or with none.
enum class Vary { nothing, pose, velocity };
LOCKSTEP_API MotionT<SlotJet> varied(const Motion&, Vary);

inline Ends<double> ends(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
  return {{in.slot(P.slot), P.at(in.t)}, {in.slot(S.slot), S.at(in.t)}, in.t, in.z};
}

/// Adds the wrench of act(ends, load).
template <class Act>
void apply(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, WrenchSum& out) {
  WrenchLoad load(out, P.slot, S.slot);
  act(ends(P, S, in), load);
}

template <class Act>
ForceAccount account(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act) {
  const Ends<double> at = ends(P, S, in);
  AccountLoad load(at);
  act(at, load);
  return load;
}

/// Adds K and D of act(ends, load): two passes over the formula for each slot that moves, its pose and its velocity.
template <class Act>
void tangent(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, TangentSum& out) {
  const MarkerMotion m_P = P.at(in.t), m_S = S.at(in.t);
  for (const bool of_P : {true, false})
    for (const Vary what : {Vary::pose, Vary::velocity}) {
      const int column = of_P ? P.slot : S.slot;
      if (column == kGround) continue;
      const MotionT<SlotJet> O_P = varied(in.slot(P.slot), of_P ? what : Vary::nothing),
                             O_S = varied(in.slot(S.slot), of_P ? Vary::nothing : what);
      const Ends<SlotJet> at{{O_P, m_P}, {O_S, m_S}, in.t, in.z};
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
}

}  // namespace formula
}  // namespace lockstep
