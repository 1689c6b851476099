// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <lockstep/author/phi_links.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace force_joint_friction_test {

using namespace lockstep;

namespace {

/// Two bodies in motion and a link between them that rubs.
template <class Link>
struct Pair {
  System system;
  Body *a, *b;
  Link* link;
  JointFriction* friction;

  explicit Pair(const JointFriction::Options& options) {
    a = &system.add_body("a", MassProperties{1.2, {0.1, 0, 0.2}, Vec3(0.3, 0.4, 0.5).asDiagonal().toDenseMatrix()});
    b = &system.add_body("b", MassProperties{2.1, {0, 0.3, 0}, Vec3(0.5, 0.3, 0.4).asDiagonal().toDenseMatrix()});
    a->start = {{0.3, -0.2, 0.5}, {0.4, 0.9, -0.7}};
    b->start = {{-0.1, 0.4, 0.2}, {-0.3, 0.2, 1.1}};
    link = &system.add<Link>("link", *a, *b, pose_at(Vec3(0.2, 0.1, -0.3), Vec3(1, 2, 2)));
    friction = &static_cast<JointFriction&>(system.add(std::make_unique<JointFriction>("rub", *link, options)));
    system.setup();
  }
  /// A quantity of the friction at given multipliers.
  double quantity(const std::string& name, const VecX& lambda) {
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    const Evaluation& gathered = dynamics.gather(system.start());
    const Reactions reactions(gathered.rows(), {lambda.data(), static_cast<std::size_t>(lambda.size())});
    const std::vector<Quantity> all = friction->quantities();
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k].name == name) return friction->reacting_quantity(static_cast<int>(k), gathered.inputs(), reactions);
    return std::nan("");
  }
};

JointFriction::Options rough() {
  JointFriction::Options o;
  o.mu = 0.3, o.mu_static = 0.5, o.stribeck_speed = 0.4, o.smoothing_speed = 0.3, o.radius = 0.4, o.axial_radius = 0.2;
  o.bending_length = 0.5, o.viscous = 0.7, o.viscous_turn = 0.2, o.load_smoothing = 0;
  return o;
}

/// What the force does to the two bodies at given multipliers.
template <class Link>
VecX pushed(Pair<Link>& pair, Dynamics& dynamics, const VecX& lambda) {
  const Evaluation& gathered = dynamics.gather(pair.system.start());
  VecX f = VecX::Zero(12);
  gathered.react(lambda, f);
  return f;
}

template <class Link>
void check_all() {
  JointFriction::Options o = rough();
  o.preload = 5;
  Pair<Link> pair(o);
  Dynamics dynamics(pair.system, std::make_unique<SchurSolver>());
  const Evaluation& gathered = dynamics.gather(pair.system.start());
  const int m = gathered.rows().n_rows;
  VecX lambda(m);
  for (int k = 0; k < m; ++k) lambda[k] = 3.0 * std::cos(1.0 + 2.0 * k);
  const State s = pair.system.start();

  // action and reaction, and power: it takes what it says
  const VecX f = pushed(pair, dynamics, lambda);
  const Inputs& in = gathered.inputs();
  CHECK(f.norm() > 0.1);
  CHECK((f.segment<3>(0) + f.segment<3>(6)).norm() < 1e-13);
  const auto about_origin = [&](int slot) {
    return Vec3(in.slot(slot).A * f.segment<3>(6 * slot + 3) + cross(in.slot(slot).x, Vec3(f.segment<3>(6 * slot))));
  };
  CHECK((about_origin(0) + about_origin(1)).norm() < 1e-13);
  const Reactions reactions(gathered.rows(), {lambda.data(), static_cast<std::size_t>(m)});
  const double loss = pair.friction->friction_loss(in, reactions);
  CHECK(loss > 0);
  CHECK(-f.dot(s.v) == Approx(loss).epsilon(1e-12));

  // the tangent, where the load is the preload's alone, against differences
  const VecX none = VecX::Zero(m);
  const Reactions unloaded(gathered.rows(), {none.data(), static_cast<std::size_t>(m)});
  TangentSum exact, differences;
  exact.lay_out(2), differences.lay_out(2);
  pair.friction->react_tangent(in, unloaded, exact);
  pair.friction->Reacting::react_tangent(in, unloaded, differences);
  REQUIRE(exact.pairs().size() == differences.pairs().size());
  for (std::size_t i = 0; i < exact.pairs().size(); ++i)
    for (std::size_t j = 0; j < exact.pairs().size(); ++j) {
      const auto &p = exact.pairs()[i], &q = differences.pairs()[j];
      if (p.row != q.row || p.column != q.column) continue;
      CHECK((exact.K(i) - differences.K(j)).norm() < 1e-7);
      CHECK((exact.D(i) - differences.D(j)).norm() < 1e-7);
    }
}

}  // namespace

TEST_CASE("joint friction: action, reaction, power and tangent in every joint that rubs", "[unit][force]") {
  check_all<Prismatic>();
  check_all<Cylindrical>();
  check_all<Revolute>();
  check_all<PointOnPlane>();
  check_all<PlaneOnPlane>();
  check_all<PointOnLine>();
}

namespace {

/// A guide that also keeps the two bodies at a distance.
struct Kept {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x * y.x + y.y * y.y + y.z * y.z - 1.0;
  }
};
struct KeptGuide final : PhiLock<Kept> {
  KeptGuide(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::x | Mask::e123, Kept{}) {}
  std::string_view type() const override { return "kept_guide"; }
};

}  // namespace

TEST_CASE("joint friction: a host's joint with a function besides its mask is rejected", "[unit][force]") {
  JointFriction::Options o = rough();
  testing::check_words(testing::message_of<ModelError>([&] { Pair<KeptGuide>{o}; }),
                       {"force 'rub'", "joint 'link' (kept_guide)", "revolute, prismatic"});
}

// The load of a bearing: the reaction by the rows x y z, seen in S axes.
TEST_CASE("joint friction: loads are the reactions in S axes", "[unit][force]") {
  JointFriction::Options o = rough();
  Pair<Revolute> pair(o);
  VecX lambda(5);
  lambda << 3, -4, 12, 0.7, 0.2;
  const auto quantity = [&](const std::string& name) { return pair.quantity(name, lambda); };
  CHECK(quantity("radial_force") == Approx(5).epsilon(1e-12));
  CHECK(quantity("axial_force") == Approx(12).epsilon(1e-12));
  const double w = quantity("turning_rate"), s = o.radius * std::abs(w);
  const double mu =
      (o.mu + (o.mu_static - o.mu) * std::exp(-std::pow(s / o.stribeck_speed, 2))) * std::tanh(s / o.smoothing_speed);
  const double T = mu * (o.radius * 5 + o.axial_radius * 12) + o.viscous_turn * std::abs(w);
  CHECK(quantity("friction_torque") == Approx(w > 0 ? -T : T).epsilon(1e-12));
}

// mu tanh(s/v_0) at any v_0, s = r w: the series near rest is for s far below v_0.
TEST_CASE("joint friction: near rest it is smooth at any smoothing speed", "[unit][force]") {
  for (const double v0 : {1e-9, 1e-3, 1.0})
    for (const double of_v0 : {1e-7, 1e-3, 0.5, 2.0}) {
      JointFriction::Options o;
      o.mu = 0.3, o.smoothing_speed = v0, o.load_smoothing = 0, o.radius = 1;
      const double w = std::abs(Pair<Revolute>(o).quantity("turning_rate", VecX::Zero(5)));
      o.radius = of_v0 * v0 / w;
      Pair<Revolute> pair(o);
      VecX lambda(5);
      lambda << 3, -4, 12, 0.7, 0.2;
      CAPTURE(v0, of_v0);
      CHECK(std::abs(pair.quantity("friction_torque", lambda)) ==
            Approx(o.radius * 0.3 * 5 * std::tanh(of_v0)).epsilon(1e-12));
    }
}

}  // namespace force_joint_friction_test
