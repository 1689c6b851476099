// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/summary.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace lockstep {
namespace {

constexpr double kStill = 1e-9;  // of the system's length, and rad: less is rounding

// The integral of |v| over a step, by Simpson's rule with v of the cubic in the middle: 3/2 way / h - (v0 + v1) / 4.
double length_of_step(const Vec3& way, const Vec3& v0, const Vec3& v1, double h) {
  if (!(h > 0)) return way.norm();
  return h / 6 * (v0.norm() + (6 * way / h - v0 - v1).norm() + v1.norm());
}

// A turn is known up to full ones, and to its sense: the one nearest to what the rate says, rad.
double turn_of_step(double shortest, double h, double rate) {
  const double expected = h * rate;
  if (!(expected > kPi)) return shortest;
  const auto nearest = [&](double a) { return a + kTwoPi * std::round((expected - a) / kTwoPi); };
  const double with = nearest(shortest), against = nearest(-shortest);
  return std::abs(with - expected) <= std::abs(against - expected) ? with : against;
}

}  // namespace

// By the inputs, which are found once for all bodies: in joint coordinates the pose of one body alone is found along the
// whole chain to the ground.
Summary::Place Summary::place(const Mover& m, const Sample& s) {
  const Motion& O = s.inputs().slot(m.body->slot);
  const Vec3 w = O.A * O.w;
  if (m.center == Vec3::Zero()) return {O.x, O.v, w, O.e};
  const Vec3 r = O.A * m.center;
  return {O.x + r, O.v + cross(w, r), w, O.e};
}

void Summary::start(const Sample& s) {
  movers_.clear();
  length_ = s.system().length();
  for (const Body& body : s.system().bodies())
    if (!body.fixed) {
      const bool alone = s.system().slot(body.slot).bodies.size() == 1;  // then its mass centre is the slot's origin
      Mover m{&body, alone ? Vec3(Vec3::Zero()) : (body.in_slot * Pose{body.mass.center, {}}).x, {}, {}};
      m.last = place(m, s), m.x0 = m.last.x;
      movers_.push_back(m);
    }
}

// Paths and turns are summed over the steps, so that coarse outputs do not shorten them.
void Summary::step(const Sample& s) {
  const double h = s.report.h;
  for (Mover& m : movers_) {
    const Place now = place(m, s);
    m.away = std::max(m.away, (now.x - m.x0).norm());
    m.path += length_of_step(now.x - m.last.x, m.last.v, now.v, h);
    const Vec3 turn = rotation_vector(now.e * conjugate(m.last.e));  // world axes
    const double shortest = turn.norm(), whole = turn_of_step(shortest, h, now.w.norm());
    m.turned += whole == shortest ? length_of_step(turn, m.last.w, now.w, h) : whole;
    m.last = now;
  }
}

void Summary::jumped(const Sample& s) {
  for (Mover& m : movers_) m.last = place(m, s);
}

void Summary::save(Snapshot& out) const {
  for (const Mover& m : movers_) {
    for (const Vec3* x : {&m.x0, &m.last.x, &m.last.v, &m.last.w}) out.put((*x)[0]), out.put((*x)[1]), out.put((*x)[2]);
    for (const double x : {m.last.e.w, m.last.e.x, m.last.e.y, m.last.e.z, m.away, m.path, m.turned}) out.put(x);
  }
}

// start() has found the bodies.
void Summary::load(SnapshotReader& in) {
  for (Mover& m : movers_) {
    for (Vec3* x : {&m.x0, &m.last.x, &m.last.v, &m.last.w})
      for (int k = 0; k < 3; ++k) (*x)[k] = in.get();
    for (double* x : {&m.last.e.w, &m.last.e.x, &m.last.e.y, &m.last.e.z, &m.away, &m.path, &m.turned}) *x = in.get();
  }
}

std::vector<Summary::Way> Summary::ways() const {
  std::vector<Way> all;
  for (const Mover& m : movers_) all.push_back({m.body->name, m.path, m.away, m.turned});
  std::ranges::stable_sort(all, std::greater{}, &Way::path);
  return all;
}

const Fields<Summary::Way>& way_fields() {
  using Way = Summary::Way;
  static const Fields<Way> kFields{{"body", "", "body", &Way::body},
                                   {"path", "m", "along its way", &Way::path},
                                   {"away", "m", "farthest from its start", &Way::away},
                                   {"turned", "rad", "turned", &Way::turned}};
  return kFields;
}

bool Summary::nothing_moved() const {
  return std::all_of(movers_.begin(), movers_.end(),
                     [&](const Mover& m) { return m.path <= kStill * length_ && m.turned <= kStill; });
}

}  // namespace lockstep
