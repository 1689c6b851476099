#include "framework/tools/program/summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/text.h>

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
Summary::Mover Summary::at(const Body& body, const Vec3& center, const Sample& s) {
  const Motion& O = s.inputs().slot(body.slot);
  const Vec3 r = O.A * center, w = O.A * O.w, x = O.x + r;
  return {&body, center, x, x, O.v + cross(w, r), w, normalized(O.e)};
}

void Summary::start(const Sample& s) {
  movers_.clear();
  length_ = s.system().length();
  for (const Body& body : s.system().bodies())
    if (!body.fixed) movers_.push_back(at(body, (body.in_slot * Pose{body.mass.center, {}}).x, s));
}

// Paths and turns are summed over the steps, so that coarse outputs do not shorten them.
void Summary::step(const Sample& s) {
  for (Mover& m : movers_) {
    const Mover now = at(*m.body, m.center, s);
    const double h = s.report.h;
    m.away = std::max(m.away, (now.last_x - m.x0).norm());
    m.path += length_of_step(now.last_x - m.last_x, m.last_v, now.last_v, h);
    const Vec3 turn = rotation_vector(now.last_e * conjugate(m.last_e));  // world axes
    const double shortest = turn.norm(), whole = turn_of_step(shortest, h, now.last_w.norm());
    m.turned += whole == shortest ? length_of_step(turn, m.last_w, now.last_w, h) : whole;
    m.last_x = now.last_x, m.last_v = now.last_v, m.last_w = now.last_w, m.last_e = now.last_e;
  }
}

void Summary::jumped(const Sample& s) {
  for (Mover& m : movers_) {
    const Mover now = at(*m.body, m.center, s);
    m.last_v = now.last_v, m.last_w = now.last_w;
  }
}

void Summary::save(Snapshot& out) const {
  for (const Mover& m : movers_) {
    for (const Vec3* x : {&m.x0, &m.last_x, &m.last_v, &m.last_w}) out.put((*x)[0]), out.put((*x)[1]), out.put((*x)[2]);
    for (const double x : {m.last_e.w, m.last_e.x, m.last_e.y, m.last_e.z, m.away, m.path, m.turned}) out.put(x);
  }
}

// start() has found the bodies.
void Summary::load(SnapshotReader& in) {
  for (Mover& m : movers_) {
    for (Vec3* x : {&m.x0, &m.last_x, &m.last_v, &m.last_w})
      for (int k = 0; k < 3; ++k) (*x)[k] = in.get();
    for (double* x : {&m.last_e.w, &m.last_e.x, &m.last_e.y, &m.last_e.z, &m.away, &m.path, &m.turned}) *x = in.get();
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
