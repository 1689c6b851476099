// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Random mechanisms of generic locks, described twice: as a System, and as what the oracles need. Chains with loops,
/// mixed masks, laws, drives, ground, particles.

#include <memory>
#include <string>
#include <vector>

#include "tests/support/lock_inputs.h"

namespace lockstep::inputs {

/// One link as the oracles see it: which bodies (-1 ground), which rows, and all laws' values (drives are in p and
/// q_D).
struct LinkSpec {
  int body1 = 0, body2 = -1;
  Mask rows = Mask::none;
  oracle::Configuration laws;  ///< its bodies' part is not used
};

class RandomMechanism {
 public:
  explicit RandomMechanism(std::uint64_t seed, const Vec3& gravity = Vec3(0.4, -1.1, -9.0)) : draw_(seed), seed_(seed) {
    system.set_gravity(gravity);
  }

  System system;
  std::vector<Body*> bodies;
  std::vector<LinkSpec> links;

  /// A body with a full inertia and its mass centre away from its origin; random pose and velocity.
  int add_body() {
    const Mat3 A = rotation(quat(draw_.quaternion()));
    const Mat3 J =
        A * Vec3(draw_.number(0.5, 0.6), draw_.number(0.6, 0.7), draw_.number(0.7, 0.8)).asDiagonal() * A.transpose();
    Body& b = system.add_body("body " + std::to_string(bodies.size()),
                              {draw_.number(1, 3), draw_.vector(0.2), 0.5 * (J + J.transpose())},
                              {draw_.vector(1.0), quat(draw_.quaternion())});
    return take(b, draw_.vector(1.0), draw_.vector(2.0));
  }
  int add_particle() {
    return take(system.add_particle("body " + std::to_string(bodies.size()), draw_.number(1, 2), draw_.vector(1.0)),
                draw_.vector(1.0), Vec3::Zero());
  }

  /// A lock with random markers and the laws said by their bits (oracle::LawBit).
  GenericLock& link(int body1, int body2, Mask mask, unsigned laws = 0) {
    const std::string name = "link " + std::to_string(links.size());
    oracle::Configuration c = oracle::random_configuration(seed_ * 1000 + links.size(), {laws});
    const auto at = [&](int k) -> Body& { return k < 0 ? system.ground() : *bodies[k]; };
    Marker& P = add_marker(system, name + ".P", at(body1), c.uP, c.uPd, c.uPdd, c.qP, c.qPd, c.qPdd, laws & oracle::kUP,
                           laws & oracle::kQP);
    Marker& S = add_marker(system, name + ".S", at(body2), c.uS, c.uSd, c.uSdd, c.qS, c.qSd, c.qSdd, laws & oracle::kUS,
                           laws & oracle::kQS);
    GenericLock& lock = system.add<GenericLock>(name, P, S, mask);
    if (laws & oracle::kP) lock.move(std::make_shared<Translation>(TranslationValue{c.pD, c.pDd, c.pDdd}));
    if (laws & oracle::kQD) lock.turn(std::make_shared<Rotation>(rotation_value(c.qD, c.qDd, c.qDdd)));
    links.push_back({body1, body2, mask, c});
    return lock;
  }
  /// The same with a drive; then without imposed laws.
  void driven(int body1, int body2, Mask mask, Axis axis, unsigned marker_laws = 0) {
    const LawValue y{draw_.number(-2, 2), draw_.number(-2, 2), draw_.number(-2, 2)};
    link(body1, body2, mask, marker_laws).drive(axis, std::make_shared<Number>(y));
    LinkSpec& spec = links.back();
    spec.rows = mask | row_of(axis);
    oracle::Configuration& c = spec.laws;
    if (!is_rotation(axis)) {
      c.pD[axis_index(axis)] = y.y, c.pDd[axis_index(axis)] = y.yd, c.pDdd[axis_index(axis)] = y.ydd;
      return;
    }
    const Vec3 n = Vec3::Unit(axis_index(axis) - 3);
    c.qD << std::cos(y.y / 2), std::sin(y.y / 2) * n;
    oracle::set_rates(c.qD, y.yd * n, y.ydd * n, c.qDd, c.qDdd);
  }

  /// The configuration of a link at a state. Markers are given in body axes from the body's origin: the slots, whose
  /// origin is the mass centre, are put in its place.
  oracle::Configuration configuration(const LinkSpec& spec, const State& state) const {
    oracle::Configuration c = spec.laws;
    const auto body = [&](int k, Vec3& x, Vec4& q, Vec3& v, Vec3& w, Vec4& qd, Vec4& qdd, Vec3& u) {
      x.setZero(), q = Vec4::UnitX(), v.setZero(), w.setZero();
      if (k >= 0) {
        const Body& b = *bodies[k];
        x = state.q.segment<3>(7 * b.slot), q = state.q.segment<4>(7 * b.slot + 3).normalized();
        v = state.v.segment<3>(6 * b.slot), w = state.v.segment<3>(6 * b.slot + 3);
        u -= b.mass.center;
      }
      oracle::set_rates(q, w, Vec3::Zero(), qd, qdd);
    };
    body(spec.body1, c.x1, c.q1, c.v1, c.w1, c.qd1, c.qdd1, c.uP);
    body(spec.body2, c.x2, c.q2, c.v2, c.w2, c.qd2, c.qdd2, c.uS);
    return c;
  }

 private:
  int take(Body& b, const Vec3& v, const Vec3& w) {
    b.start = {v, w};
    bodies.push_back(&b);
    return static_cast<int>(bodies.size()) - 1;
  }

  oracle::Draw draw_;
  std::uint64_t seed_;
};

}  // namespace lockstep::inputs
