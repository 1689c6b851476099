// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/pose_numbers.h"

#include <algorithm>
#include <cmath>

#include <lockstep/author/lock.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {
namespace {

/// visit(link, name, part) for every joint with markers, and for its drives.
template <class Visit>
void for_each_reaction(const System& system, Visit&& visit) {
  for (const auto& link : system.links()) {
    if (link->pairs().empty() || system.merged(*link)) continue;
    visit(*link, link->name(), Reactions::kJoint);
    if (link->driven() != nullptr && link->driven()->n_drives() > 0)
      visit(*link, link->name() + ".drive", Reactions::kDrives);
  }
}

LinkWrench wrench_of(const Lock& link, int part, const Evaluated& v) {
  const MarkerFrame at(*link.pairs().front().first);
  return Reactions(v).on_body_of(at, link, v.in, part);
}

}  // namespace

std::vector<std::pair<std::string, NamedReaction>> reactions_of(const System& system, const Evaluated& v) {
  std::vector<std::pair<std::string, NamedReaction>> all;
  for_each_reaction(system, [&](const Lock& link, const std::string& name, int part) {
    const bool holds = Reactions(v).in_force(link);
    if (holds || system.left_out(link) != 0)
      all.push_back(
          {name, {name, link.pairs().front().first->body->name, wrench_of(link, part, v), holds ? "" : "left out"}});
  });
  return all;
}

std::vector<PoseNumber> pose_numbers(const System& system, const State& state, const Evaluated& v) {
  std::vector<PoseNumber> all;
  for (const Body& body : system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    for (int k = 0; k < 3; ++k) all.push_back({body.name + "." + "xyz"[k], "m", at.x[k]});
    if (body.freedoms == Freedoms::particle) continue;
    for (const auto& [name, q] : {std::pair{".qw", at.q.w}, {".qx", at.q.x}, {".qy", at.q.y}, {".qz", at.q.z}})
      all.push_back({body.name + name, "", q});
  }
  for_each_reaction(system, [&](const Lock& link, const std::string& name, int part) {
    const LinkWrench w = wrench_of(link, part, v);
    for (int k = 0; k < 3; ++k) all.push_back({name + ".force_on_p_world_" + "xyz"[k], "N", w.force[k]});
    for (int k = 0; k < 3; ++k) all.push_back({name + ".torque_on_p_world_" + "xyz"[k], "N m", w.moment[k]});
  });
  return all;
}

std::vector<PoseNumber> force_numbers(const System& system, const Inputs& in) {
  std::vector<PoseNumber> all;
  for (const auto& force : system.forces()) {
    const Observable* shows = force->reacting() == nullptr ? force->observable() : nullptr;
    if (shows == nullptr) continue;
    const std::vector<Quantity> own = shows->quantities();
    for (int k = 0; k < static_cast<int>(own.size()); ++k)
      if (const std::string& unit = own[k].unit; unit != "W" && !unit.ends_with("/s"))
        all.push_back({force->name() + "." + own[k].name, unit,
                       unit.starts_with("N") && !force->acts(in) ? 0 : shows->quantity(k, in)});
  }
  return all;
}

std::vector<std::pair<std::string, NamedReaction>> reactions_at_rest(Dynamics& dynamics, const State& state,
                                                                     const EquilibriumReport& report,
                                                                     const UniquenessReport& unique) {
  const System& system = dynamics.system();
  const Evaluation& e = dynamics.gather(state);
  const VecX still = VecX::Zero(6 * system.n_slots());
  const double force = kNegligible * report.largest_force, moment = force * system.length();
  auto all = reactions_of(system, {e.inputs(), still, report.lambda, e.rows()});
  for (auto& [name, reaction] : all) {
    const auto is_of = [&, &its = name](const std::string& channel) {
      return channel.starts_with(its + ".force_on_p_world_") || channel.starts_with(its + ".torque_on_p_world_");
    };
    for (double& x : reaction.wrench.force) x = std::abs(x) <= force ? 0 : x;
    for (double& x : reaction.wrench.moment) x = std::abs(x) <= moment ? 0 : x;
    if (reaction.note.empty() && std::ranges::any_of(unique.channels, is_of)) reaction.note = "not unique";
  }
  return all;
}

NamedPoses named_poses(const System& system, const State& state) {
  NamedPoses all;
  for (const Body& body : system.bodies())
    if (!body.fixed) all.emplace_back(body.name, body_pose(body, state));
  return all;
}

}  // namespace lockstep
