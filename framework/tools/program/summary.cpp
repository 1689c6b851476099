#include "framework/tools/program/summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr double kStill = 1e-9;  // of the system's length, and rad: less is rounding

// Angular velocity, world, rad/s.
Vec3 turning_of(const Body& body, const Sample& s) {
  const Motion& O = s.inputs().slot(body.slot);
  return O.A * O.w;
}

// Velocity of the mass centre, m/s.
Vec3 speed_of(const Body& body, const Vec3& center, const Sample& s) {
  const Motion& O = s.inputs().slot(body.slot);
  return O.v + cross(turning_of(body, s), Vec3(center - O.x));
}

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

// Axes of the body's frame at its mass centre. By the inputs, which are found once for all bodies: in joint coordinates
// the pose of one body alone is found along the whole chain to the ground.
Pose center_pose(const Body& body, const Sample& s) {
  const Motion& O = s.inputs().slot(body.slot);
  return Pose{O.x, normalized(O.e)} * body.in_slot * Pose{body.mass.center, {}};
}

}  // namespace

void Summary::start(const Sample& s) {
  movers_.clear();
  length_ = s.system().length();
  for (const Body& body : s.system().bodies())
    if (!body.fixed) {
      const Pose at = center_pose(body, s);
      movers_.push_back({&body, at.x, at.x, speed_of(body, at.x, s), turning_of(body, s), at.q});
    }
}

// Paths and turns are summed over the steps, so that coarse outputs do not shorten them.
void Summary::step(const Sample& s) {
  for (Mover& m : movers_) {
    const Pose at = center_pose(*m.body, s);
    const Vec3 v = speed_of(*m.body, at.x, s), w = turning_of(*m.body, s);
    const Vec3 turn = rotation_vector(at.q * conjugate(m.last_q));  // world axes
    const double h = s.report.h, shortest = turn.norm(), whole = turn_of_step(shortest, h, w.norm());
    m.away = std::max(m.away, (at.x - m.x0).norm());
    m.path += length_of_step(at.x - m.last_x, m.last_v, v, h);
    m.turned += whole == shortest ? length_of_step(turn, m.last_w, w, h) : whole;
    m.last_x = at.x, m.last_v = v, m.last_w = w, m.last_q = at.q;
  }
}

void Summary::jumped(const Sample& s) {
  for (Mover& m : movers_) m.last_v = speed_of(*m.body, m.last_x, s), m.last_w = turning_of(*m.body, s);
}

void Summary::save(Snapshot& out) const {
  for (const Mover& m : movers_) {
    for (const Vec3* x : {&m.x0, &m.last_x, &m.last_v, &m.last_w}) out.put((*x)[0]), out.put((*x)[1]), out.put((*x)[2]);
    for (const double x : {m.last_q.w, m.last_q.x, m.last_q.y, m.last_q.z, m.away, m.path, m.turned}) out.put(x);
  }
}

// start() has found the bodies.
void Summary::load(SnapshotReader& in) {
  for (Mover& m : movers_) {
    for (Vec3* x : {&m.x0, &m.last_x, &m.last_v, &m.last_w})
      for (int k = 0; k < 3; ++k) (*x)[k] = in.get();
    for (double* x : {&m.last_q.w, &m.last_q.x, &m.last_q.y, &m.last_q.z, &m.away, &m.path, &m.turned}) *x = in.get();
  }
}

std::string Summary::text() const {
  constexpr std::size_t kMost = 8;
  std::vector<Mover> order = movers_;
  std::stable_sort(order.begin(), order.end(), [](const Mover& a, const Mover& b) { return a.path > b.path; });
  std::string text;
  for (std::size_t k = 0; k < std::min(kMost, order.size()); ++k) {
    text += fmt::format("  moved      {:<14} {:.4g} m along its way, at most {:.4g} m from its start",
                        order[k].body->name, order[k].path, order[k].away);
    if (order[k].body->freedoms == Freedoms::spatial) text += fmt::format(", turned by {:.4g} rad", order[k].turned);
    text += "\n";
  }
  if (order.size() > kMost) text += fmt::format("             and {} more\n", order.size() - kMost);
  return text;
}

bool Summary::nothing_moved() const {
  return std::all_of(movers_.begin(), movers_.end(),
                     [&](const Mover& m) { return m.path <= kStill * length_ && m.turned <= kStill; });
}

std::string words_of(const Audit& audit, bool still, bool adaptive) {
  std::string text = fmt::format(
      "  energy     change {:.6g} J, work of drives {:.6g} J, of motors and applied forces {:.6g} J, dissipated {:.6g} "
      "J\n",
      audit.end - audit.start, audit.drives, audit.supplied, audit.dissipated);
  for (const Audit::Instant& i : audit.instants) {
    const std::string when = i.count == 1 ? fmt::format("at {:.6g} s", i.first)
                                          : fmt::format("{} times from {:.6g} s to {:.6g} s", i.count, i.first, i.last);
    text += fmt::format("             {} {}: {:+.6g} J\n", i.cause, when, i.energy);
  }
  const std::string share =
      audit.scale > 0 ? fmt::format("{:.2g} of the energy exchanged", audit.imbalance_share()) : "none was exchanged";
  const bool many = audit.unbooked_forces.size() > 1;
  switch (audit.energy) {
    case Audit::Energy::conserved:
      text += fmt::format("  conserved  energy balance within {:.2g} J{}\n", audit.imbalance,
                          still ? "; nothing moved" : " (" + share + ")");
      break;
    case Audit::Energy::not_conserved:
      text += fmt::format(
          "  NOT CONSERVED  energy balance off by {:.2g} J ({}, limit {:g}): {}; or a force's potential, dissipation "
          "or "
          "supply does not fit what it exerts\n",
          audit.imbalance, share, audit.limits.energy,
          adaptive ? "take a smaller tolerance (--tolerance), look for singular positions (lockstep check)"
                   : "take a smaller step (--step)");
      break;
    case Audit::Energy::not_judged:
      text += fmt::format(
          "  NOT JUDGED  energy balance off by {:.2g} J ({}): force{} {} {} power, but no potential, dissipation or "
          "supply\n",
          audit.imbalance, share, many ? "s" : "", text::join(audit.unbooked_forces), many ? "give" : "gives");
  }
  return text;
}

}  // namespace lockstep
