#include "framework/tools/program/summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr double kStill = 1e-9;  // of the system's length, and rad: rounding moves no further

enum : std::size_t { kTotal, kKinetic, kBalance, kDrives, kSupplied, kDissipated };

// Axes of the body's frame at its mass centre.
Pose center_pose(const Body& body, const State& state) { return pose(body, state) * Pose{body.mass.center, {}}; }

}  // namespace

Summary::Summary(System& system) {
  // What the system has not is not integrated.
  const bool links = !system.links().empty(), forces = !system.forces().empty();
  for (const char* name : {"energy.total", "energy.kinetic", "energy.balance"})
    channels_.push_back(make_channel(system, name));
  channels_.push_back(links ? make_channel(system, "energy.drives") : Channel{});
  const bool hits = std::any_of(system.links().begin(), system.links().end(),
                                [](const auto& link) { return link->unilateral() != nullptr; });
  channels_.push_back(forces ? make_channel(system, "energy.supplied") : Channel{});
  channels_.push_back(forces || hits ? make_channel(system, "energy.dissipated") : Channel{});
}

void Summary::start(const Sample& s) {
  movers_.clear();
  length_ = s.system().length();
  for (const Body& body : s.system().bodies())
    if (!body.fixed) {
      const Pose at = center_pose(body, s.state);
      movers_.push_back({&body, at.x, at.x, at.q});
    }
  for (const Channel& c : channels_)
    if (c.restart) c.restart();
  step(s);
  first_energy_ = value(kTotal, s);
  balance_ = scale_ = 0;
}

// Ways and turns by the steps, so that they are not shortened by coarse outputs.
void Summary::step(const Sample& s) {
  for (const Channel& c : channels_)
    if (c.track) c.track(s);
  for (Mover& m : movers_) {
    const Pose at = center_pose(*m.body, s.state);
    m.away = std::max(m.away, (at.x - m.x0).norm());
    m.path += (at.x - m.last_x).norm();
    m.turned += rotation_vector(conjugate(m.last_q) * at.q).norm();
    m.last_x = at.x, m.last_q = at.q;
  }
}

void Summary::output(const Sample& s) {
  last_energy_ = value(kTotal, s);
  drives_ = value(kDrives, s), supplied_ = value(kSupplied, s), dissipated_ = value(kDissipated, s);
  balance_ = std::max(balance_, std::abs(value(kBalance, s)));
  scale_ = std::max(
      {scale_, std::abs(last_energy_ - first_energy_), value(kKinetic, s), std::abs(drives_), std::abs(supplied_)});
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
  text += fmt::format(
      "  energy     change {:.6g} J, work of drives {:.6g} J, of motors and applied forces {:.6g} J, dissipated {:.6g} "
      "J\n",
      last_energy_ - first_energy_, drives_, supplied_, dissipated_);
  text += fmt::format("  conserved  energy balance within {:.2g} J", balance_);
  const bool still = std::all_of(order.begin(), order.end(),
                                 [&](const Mover& m) { return m.path <= kStill * length_ && m.turned <= kStill; });
  if (still)
    text += "; nothing moved";
  else if (scale_ > 0)
    text += fmt::format(" ({:.2g} of the largest energy)", balance_ / scale_);
  return text + "\n";
}

}  // namespace lockstep
