#include "framework/tools/program/summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr double kStill = 1e-9;  // of the system's length, and rad: less is rounding

enum : std::size_t { kTotal, kKinetic, kBalance, kDrives, kSupplied, kDissipated };

// Axes of the body's frame at its mass centre.
Pose center_pose(const Body& body, const State& state) { return body_pose(body, state) * Pose{body.mass.center, {}}; }

}  // namespace

Summary::Summary(System& system) {
  const bool links = !system.links().empty(), forces = !system.forces().empty();
  const bool impacts = std::any_of(system.links().begin(), system.links().end(),
                                   [](const auto& link) { return link->unilateral() != nullptr; });
  const auto add = [&](const char* name, bool present) {  // nothing is integrated in vain
    channels_.push_back(present ? make_channel(system, name) : Channel{});
  };
  add("energy.total", true), add("energy.kinetic", true), add("energy.balance", true);
  add("energy.drives", links), add("energy.supplied", forces), add("energy.dissipated", forces || impacts);
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

// Paths and turns are summed over the steps, so that coarse outputs do not shorten them.
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
