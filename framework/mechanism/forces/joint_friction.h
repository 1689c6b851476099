// Force 'joint_friction': dry and viscous friction in a joint, from the reaction that the joint has at this instant.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/mechanism/forces/force.h"
#include "framework/mechanism/forces/formula.h"
#include "framework/mechanism/params/params.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// Rubs where the link's mask leaves P free to slide in S or to turn about one axis of S. With F and M the reaction of
/// the joint's own rows on P's body at the origin of P (drives left out), in S axes, u the sliding velocity of P in the
/// free directions and w the rate about the free axis:
///
///   sliding   N = N0 + |F held| + |M held, normal to a single free direction|/b         N
///             force on P's body at P: -(mu(|u|) N + c |u|) u/|u|, the opposite on S's   N
///   turning   T = mu(r |w|) (r (N0 + |F radial|) + r_a |F axial|) + c_t |w|             N m, against w
///   mu(s)     = (mu_k + (mu_s - mu_k) exp(-(s/v_s)^2)) tanh(s/v_0)                      Stribeck; Coulomb: mu_s = mu_k
///   |F|       = sqrt(F.F + e^2) - e, smooth where the reaction passes zero
///
/// All of it is odd in u and w and smooth at rest: below v_0 a joint creeps where it would stick. The torque takes r_a
/// for r in mu where r is zero. Refused: links that are no locks of markers, markers with laws of their own.
class LOCKSTEP_API JointFriction final : public Force, public Reacting {
 public:
  struct Options {
    double mu = 0;                  ///< mu_k, not negative
    double mu_static = -1;          ///< mu_s; below zero: mu_k
    double stribeck_speed = 0.01;   ///< v_s, m/s
    double smoothing_speed = 1e-3;  ///< v_0, m/s
    double radius = 0;              ///< r, m: where a bearing rubs under its radial load
    double axial_radius = 0;        ///< r_a, m: where it rubs under its axial load
    double bending_length = 0;      ///< b, m; 0: bending moments press on nothing
    double preload = 0;             ///< N0, N: a normal force that is always there
    double viscous = 0;             ///< c, N s/m
    double viscous_turn = 0;        ///< c_t, N m s/rad
    double load_smoothing = 1e-6;   ///< e, N
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be, ModelError for a link that does not rub.
  JointFriction(std::string name, const Lock& link, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<const Marker*> markers() const override { return {p_, s_}; }
  /// normal_force, friction_force (on P along the sliding, with its sign where there is one direction), sliding_speed;
  /// radial_force, axial_force, friction_torque (on P about the axis), turning_rate: those that the link has.
  std::vector<Quantity> quantities() const override;
  double reacting_quantity(int k, const Inputs&, const Reactions&) const override;
  void setup() override;
  void apply(const Inputs&, WrenchSum&) const override {}
  void tangent(const Inputs&, TangentSum&) const override {}

  const Reacting* reacting() const override { return this; }
  std::vector<const Lock*> reads() const override { return {link_}; }
  void react(const Inputs&, const Reactions&, WrenchSum& out) const override;
  void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const override;
  double friction_loss(const Inputs&, const Reactions&) const override;

  static const TypeInfo& info();
  static Options options(const Params&);
  static std::unique_ptr<Force> make(const Site&, const Params&);

 private:
  struct Pressing;
  void check_numbers() const;
  template <class T>
  T coefficient(const T& square_of_speed) const;
  double size(double square) const;
  Pressing pressing(const Inputs&, const Reactions&) const;
  template <class T, class Load>
  void act(const Pressing&, const Ends<T>&, Load&) const;
  ForceAccount account(const Inputs&, const Reactions&) const;

  const Lock* link_;
  const Marker *p_, *s_;
  Options options_;
  Vec3 sliding_ = Vec3::Zero();  // 1 in the free directions of S, where something is held to press on
  Vec3 pressing_ = Vec3::Zero();
  int turning_ = -1;  // free axis of S
  Vec3 radial_ = Vec3::Zero(), axial_ = Vec3::Zero(), bending_ = Vec3::Zero();
  double arm_ = 0;
  MarkerFrame P_, S_;
};

}  // namespace lockstep
