// PhiLock: a joint from one function of the relative coordinates, phi(y, t) = 0, beside the mask's rows (theory,
// section 7). Constraint, row, Ct and right side follow from the lock's own and phi's exact derivatives; nobody writes
// a jacobian.
//
//   struct ScrewThread {                                       // advance per turn along z
//     double lead;
//     static constexpr bool kCountsTurns = true;               // angle_z() runs on past full turns
//     template <class T> T operator()(const LockCoords<T>& y) const { return y.z - lead / kTwoPi * y.angle_z(); }
//   };
//   using Screw = PhiLock<ScrewThread>;
#pragma once

#include <string>

#include "framework/lock/geometric_stiffness.h"
#include "framework/lock/look.h"
#include "framework/lock/marker_lock.h"
#include "framework/math/jet.h"

namespace lockstep {

/// What phi sees: P from S in S's axes, before any imposed law. x y z in m; r the unit relative quaternion; t in s.
template <class T>
struct LockCoords {
  T x, y, z, e0, e1, e2, e3, t;
  double last_angle = 0;  ///< angle_z at the last accepted step

  /// Turn of P about the z axis of S, 2 atan2(e3, e0): the branch nearest to the last accepted angle (7.9). Needs
  /// kCountsTurns in phi; without it the branch is the one within half a turn of zero. Singular where z_P = -z_S.
  T angle_z() const {
    using std::atan2;
    T a = 2.0 * atan2(e3, e0);
    a.v -= kTwoPi * std::round((a.v - last_angle) / kTwoPi);
    return a;
  }
};

/// Law of time on a jet: f(t) with its exact derivatives.
template <int N>
inline Jet<N> of(const MotionLaw& law, const Jet<N>& t) {
  const LawValue l = law.at(t.v);
  return jet_detail::chain(t, l.y, l.yd, l.ydd);
}

/// What phi may say about itself; the defaults serve a function of everything that does not count turns. A function of
/// x y z alone says kNeeds = Needs::translation: then it costs no rotational half and serves particles too.
template <class Phi>
constexpr bool counts_turns() {
  if constexpr (requires { Phi::kCountsTurns; })
    return Phi::kCountsTurns;
  else
    return false;
}
template <class Phi>
constexpr Needs needs_of() {
  if constexpr (requires { Phi::kNeeds; })
    return Phi::kNeeds;
  else
    return Needs::both;
}

/// What phi measures, for scales and norms: metres (RowKind::translation), or anything else.
template <class Phi>
constexpr RowKind kind_of() {
  if constexpr (requires { Phi::kKind; })
    return Phi::kKind;
  else
    return RowKind::function;
}

/// Rows: those of the mask and its drives as in MarkerLock, then phi. Derive, give it a type() and, for files, info()
/// and make().
template <class Phi>
class PhiLock : public MarkerLock {
 public:
  PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi)
      : MarkerLock(std::move(name), p, s, mask), phi_(std::move(phi)) {}

  const Phi& phi() const { return phi_; }
  int row_count() const override { return MarkerLock::row_count() + 1; }
  RowKind row_kind(int k) const override { return is_phi(k) ? kind_of<Phi>() : MarkerLock::row_kind(k); }
  std::string row_name(int k) const override { return is_phi(k) ? "phi" : MarkerLock::row_name(k); }
  int drive_row(int k) const override { return is_phi(k) ? -1 : MarkerLock::drive_row(k); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    MarkerLock::breakpoints(t0, t1, out);
    if constexpr (requires { phi_.breakpoints(t0, t1, out); }) phi_.breakpoints(t0, t1, out);
  }

  std::string blame(double t) const override {
    std::string law = MarkerLock::blame(t);
    if constexpr (requires { phi_.blame(t); }) {
      if (law.empty()) law = phi_.blame(t);
    }
    return law;
  }

  void setup() override {
    MarkerLock::setup();
    if constexpr (needs_of<Phi>() != Needs::translation) refuse_particles("phi");
    P_ = MarkerFrame(p()), S_ = MarkerFrame(s());
    moving_ = P_.slide || P_.spin || S_.slide || S_.spin;
  }

  void gather(Group links, const Inputs& in, RowSpan out) const override {
    MarkerLock::gather(links, in, out);
    for (std::size_t i = 0; i < links.size(); ++i) static_cast<const PhiLock&>(*links[i]).fill(in, out.lane(i));
  }

  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override {
    MarkerLock::tangent(in, lambda, out);
    const double l = lambda[static_cast<std::size_t>(MarkerLock::row_count())];
    const LockPoint L = look_at(in);
    const Jet<kN> f = phi_(coords(L, in));
    add_function_stiffness(in, P_.slot, S_.slot, P_.at(in.t), S_.at(in.t), L, needs_of<Phi>(), l * f.g,
                           l * second_derivatives(L, in), out);
  }

  /// A triple only beside a phi of the turn alone: any other has columns on v.
  RowLayout layout() const override {
    return needs_of<Phi>() == Needs::rotation && has(rows(), Mask::xyz) ? RowLayout::triple : RowLayout::dense;
  }

  int n_memory() const override { return counts_turns<Phi>() ? 1 : 0; }
  void start_memory(std::span<double> z) const override {
    if constexpr (counts_turns<Phi>()) {
      const Pose rel = start_pose();
      const double a = 2.0 * std::atan2(rel.q.z, rel.q.w);
      z[0] = a - kTwoPi * std::round(a / kTwoPi);
    }
  }
  void accept(const Inputs& in, std::span<double> z) const override {
    if constexpr (counts_turns<Phi>()) z[0] = coords(look_at(in), in).angle_z().v;
  }

 private:
  static constexpr int kN = 7;
  bool is_phi(int k) const { return k == MarkerLock::row_count(); }

  LockPoint look_at(const Inputs& in) const {
    return look(in.slot(P_.slot), in.slot(S_.slot), P_.at(in.t), S_.at(in.t), moving_ ? 1u : 0u, needs_of<Phi>());
  }
  LockCoords<Jet<kN>> coords(const LockPoint& L, const Inputs& in) const {
    const auto v = [&](int k) { return Jet<kN>::variable(k, L.y[k], L.yd[k]); };
    LockCoords<Jet<kN>> y{v(0), v(1), v(2), v(3), v(4), v(5), v(6), Jet<kN>(in.t, 1.0, 0.0)};
    if constexpr (counts_turns<Phi>()) y.last_angle = in.z[static_cast<std::size_t>(first_memory())];
    return y;
  }
  /// phi'' along y + t yd with time fixed: yd^T phi_yy yd.
  double bend(const LockPoint& L, const Inputs& in, const Vec7T<double>& yd) const {
    const auto v = [&](int k) { return Jet<0>(L.y[k], yd[k], 0.0); };
    LockCoords<Jet<0>> y{v(0), v(1), v(2), v(3), v(4), v(5), v(6), Jet<0>(in.t)};
    if constexpr (counts_turns<Phi>()) y.last_angle = in.z[static_cast<std::size_t>(first_memory())];
    return phi_(y).h;
  }
  /// phi_yy by its bends along each variable and along each pair of them: exact, and no more than what phi can tell.
  Eigen::Matrix<double, kN, kN> second_derivatives(const LockPoint& L, const Inputs& in) const {
    constexpr int kFirst = needs_of<Phi>() == Needs::rotation ? 3 : 0;
    constexpr int kEnd = needs_of<Phi>() == Needs::translation ? 3 : kN;
    using Vec = Vec7T<double>;
    Eigen::Matrix<double, kN, kN> H = Eigen::Matrix<double, kN, kN>::Zero();
    for (int i = kFirst; i < kEnd; ++i) {
      H(i, i) = bend(L, in, Vec::Unit(i));
      for (int j = kFirst; j < i; ++j)
        H(i, j) = H(j, i) = 0.5 * (bend(L, in, Vec::Unit(i) + Vec::Unit(j)) - H(i, i) - H(j, j));
    }
    return H;
  }
  void fill(const Inputs& in, const RowBlock& block) const {
    const LockPoint L = look_at(in);
    const Jet<kN> f = phi_(coords(L, in));
    // (7.2) C = phi,  Ct = phi_y Ct_y + phi_t,  Jh = phi_y Jh_y,  Qhat = phi_y Qhat_y - phi'' along the motion
    const int k = MarkerLock::row_count();
    block.C(k) = f.v;
    block.Ct(k) = f.g.dot(L.Ct) + (f.d - f.g.dot(L.yd));
    block.Qhat(k) = f.g.dot(L.Qhat) - f.h;
    const Vec3 v = L.Jv1.transpose() * f.g;
    block.set(slots().position(P_.slot), k, v, Vec3(L.Jw1.transpose() * f.g));
    block.set(slots().position(S_.slot), k, Vec3(-v), Vec3(L.Jw2.transpose() * f.g));
  }

  Phi phi_;
  MarkerFrame P_, S_;
  bool moving_ = false;
};

}  // namespace lockstep
