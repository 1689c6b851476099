// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// What a scene does not need costs nothing: one mechanism, each feature absent and present.

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/relative.h>
#include <lockstep/dynamics.h>
#include <lockstep/frame_laws.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "tests/support/counted.h"

namespace lockstep::economies {

inline constexpr int kRods = 6;

/// A chain of six rods on ball joints or hinges; the one mechanism of which all the others are made.
struct Chain {
  std::unique_ptr<System> sys = std::make_unique<System>(System::Options{Vec3(0, 0, -9.81)});
  std::vector<Body*> rods;
  std::vector<MarkerLock*> joints;

  template <class Joint>
  Chain& hang(Body& from) {
    Body* last = &from;
    for (int i = 0; i < kRods; ++i) {
      const Vec3 begin(i, 0, 0), end(i + 1, 0, 0);
      rods.push_back(&sys->add_body("rod" + std::to_string(i), shapes::rod(1.0, begin, end, 0.05)));
      joints.push_back(&sys->add<Joint>("joint" + std::to_string(i), *rods.back(), *last, pose_at(begin, Vec3(0, 1, 0))));
      last = rods.back();
    }
    return *this;
  }
};

/// A feature; `absent` and `present` make the mechanism without and with it.
struct Economy {
  std::string name, absent_is, present_is;
  std::function<Chain()> absent, present;
};

inline Chain plain() {
  Chain c;
  c.hang<Revolute>(c.sys->ground());
  return c;
}

inline Chain on_a_plate(bool held) {
  Chain c;
  const MassProperties plate = shapes::box(10.0, {1, 1, 0.1});
  Body& body = held ? c.sys->add_body("plate", plate) : c.sys->add_fixed("plate");
  if (held) c.sys->add<Fixed>("bolts", body, c.sys->ground(), pose_at({0, 0, 0}));
  c.hang<Revolute>(body);
  return c;
}

inline Chain balls(bool hinges) {
  Chain c;
  if (hinges)
    c.hang<Revolute>(c.sys->ground());
  else
    c.hang<Spherical>(c.sys->ground());
  return c;
}

inline Chain driven() {
  Chain c = plain();
  for (MarkerLock* joint : c.joints) joint->drive(Axis::rz, laws::ramp(1.0));
  return c;
}

inline Chain shaken() {
  Chain c = plain();
  const LawPtr<TranslationLaw> law = laws::along(Vec3(0, 0, 1), laws::sine({.amplitude = 0.1, .omega = 3.0}));
  for (MarkerLock* joint : c.joints) c.sys->marker(joint->s().name).translation_law = law;
  return c;
}

inline Chain stayed(bool active) {
  Chain c = plain();
  for (int i = 0; i < kRods; ++i) {
    const std::string name = "stay" + std::to_string(i);
    Marker& P = c.sys->add_marker_at(name + ".P", *c.rods[i], pose_at(Vec3(i + 1, 0, 0)));
    Marker& S = c.sys->add_marker_at(name + ".S", c.sys->ground(), pose_at(Vec3(i, 0, 1)));
    c.sys->add<Distance>(name, P, S, std::sqrt(2.0)).set_active_at_start(active);
  }
  return c;
}

/// A string of masses, each at 1 m from the one before.
inline Chain pearls(bool bodies) {
  Chain c;
  Body* last = &c.sys->ground();
  for (int i = 0; i < kRods; ++i) {
    const Vec3 x(i + 1, 0, 0);
    const std::string name = "pearl" + std::to_string(i);
    Body& pearl = bodies ? c.sys->add_body(name, shapes::sphere(1.0, 0.05), {x, {}}) : c.sys->add_particle(name, 1.0, x);
    Marker &P = c.sys->add_marker_at(name + ".P", pearl, pose_at(x)),
           &S = c.sys->add_marker_at(name + ".S", *last, pose_at(Vec3(i, 0, 0)));
    c.sys->add<Distance>("string" + std::to_string(i), P, S, 1.0);
    last = &pearl;
  }
  return c;
}

/// The chain in its plane, whose normal is y.
inline Chain flat() {
  Chain c = plain();
  c.sys->set_planar(Plane{1});
  return c;
}

/// A lump bolted to every rod.
inline Chain lumps(bool merged) {
  Chain c = plain();
  for (int i = 0; i < kRods; ++i) {
    const Vec3 x(i + 0.7, 0, 0.1);
    const std::string name = "lump" + std::to_string(i);
    Body& lump = c.sys->add_body(name, shapes::sphere(0.5, 0.05), {x, {}});
    c.sys->add<Fixed>("bolt" + std::to_string(i), lump, *c.rods[i], pose_at(x));
  }
  c.sys->set_merge(merged);
  return c;
}

inline std::vector<Economy> all() {
  return {
      {"plate on a joint", "a fixed body", "a body held by a fixed joint", [] { return on_a_plate(false); },
       [] { return on_a_plate(true); }},
      {"rotation constraints", "ball joints", "hinges: constraints of rotation too", [] { return balls(false); },
       [] { return balls(true); }},
      {"drives", "no law", "a law on every hinge", plain, driven},
      {"moving markers", "markers at rest", "markers that slide by a law", plain, shaken},
      {"switched joints", "six joints out of force", "six joints in force", [] { return stayed(false); },
       [] { return stayed(true); }},
      {"rotating bodies", "particles", "bodies that rotate", [] { return pearls(false); }, [] { return pearls(true); }},
      {"motion in space", "in its plane", "in space", flat, plain},
      {"bolts as joints", "bolted bodies move as one", "bolts are joints", [] { return lumps(true); },
       [] { return lumps(false); }}};
}

/// Size of the equations that an evaluation solves.
struct Size {
  int unknowns = 0, rows = 0;
};
inline Size size(Chain chain) {
  Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
  const Evaluation& gathered = dynamics.gather(chain.sys->start());
  return {dynamics.system().n_velocities(), gathered.rows().n_rows};
}

/// Multiplications and additions of one lock with the laws of `kWith`, all rows of the halves that `rows` has.
template <unsigned kWith>
long lock_operations(Mask rows) {
  using oracle::Counted;
  const MotionT<Counted> O;
  const MarkerMotionT<Counted> M;
  return oracle::operations_of([&] {
           TranslationRowsT<Counted> t;
           RotationRowsT<Counted> r;
           if (overlaps(rows, Mask::xyz)) translation<kWith>(O, O, M, M, ImposedTranslationT<Counted>{}, rows, t);
           if (overlaps(rows, Mask::e123)) rotation<kWith>(O, O, M, M, ImposedRotationT<Counted>{}, rows, r);
         })
      .total();
}

}  // namespace lockstep::economies
