// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/pose_columns.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include <lockstep/author/lock.h>

namespace lockstep {
namespace {

// What is below this share of the largest number of its kind is rounding, and is printed as 0.
constexpr double kRounding = 1e-12;

/// visit(link, name, part) for every link with markers, and for its drives.
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

std::string vector_text(const Vec3& v, double largest) {
  const auto shown = [&](double x) { return std::abs(x) <= kRounding * largest ? 0.0 : x; };
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", shown(v[0]), shown(v[1]), shown(v[2]));
}

}  // namespace

std::vector<NamedReaction> reactions_of(const System& system, const Evaluated& v) {
  std::vector<NamedReaction> all;
  for_each_reaction(system, [&](const Lock& link, const std::string& name, int part) {
    if (Reactions(v).in_force(link))
      all.push_back({name, link.pairs().front().first->body->name, wrench_of(link, part, v)});
  });
  return all;
}

std::vector<Column> pose_columns(const System& system) {
  std::vector<Column> all;
  for (const Body& body : system.bodies()) {
    if (body.fixed) continue;
    for (const char* axis : {"x", "y", "z"}) all.push_back({body.name + "." + axis, "m", {}});
    if (body.freedoms == Freedoms::particle) continue;
    for (const char* axis : {"qw", "qx", "qy", "qz"}) all.push_back({body.name + "." + axis, "", {}});
  }
  for_each_reaction(system, [&](const Lock&, const std::string& name, int) {
    for (const auto& [what, unit] : {std::pair{".force_on_p_world_", "N"}, std::pair{".torque_on_p_world_", "N m"}})
      for (const char* axis : {"x", "y", "z"}) all.push_back({name + what + axis, unit, {}});
  });
  return all;
}

std::vector<double> pose_row(const System& system, const State& state, const Evaluated& v) {
  std::vector<double> row;
  for (const Body& body : system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    for (int k = 0; k < 3; ++k) row.push_back(at.x[k]);
    if (body.freedoms == Freedoms::particle) continue;
    for (const double q : {at.q.w, at.q.x, at.q.y, at.q.z}) row.push_back(q);
  }
  for_each_reaction(system, [&](const Lock& link, const std::string&, int part) {
    const LinkWrench w = wrench_of(link, part, v);
    for (int k = 0; k < 3; ++k) row.push_back(w.force[k]);
    for (int k = 0; k < 3; ++k) row.push_back(w.moment[k]);
  });
  return row;
}

std::string pose_text(const System& system, const State& state) {
  std::string text;
  for (const Body& body : system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    text += fmt::format("  {:<14} at {} m", body.name, vector_text(at.x, std::max(at.x.norm(), system.length())));
    if (body.freedoms != Freedoms::particle)
      text += fmt::format(", orientation [{:.9g}, {:.9g}, {:.9g}, {:.9g}]", at.q.w, at.q.x, at.q.y, at.q.z);
    text += "\n";
  }
  return text;
}

std::string reaction_text(const System& system, const Evaluated& v) {
  const std::vector<NamedReaction> all = reactions_of(system, v);
  double force = 0, moment = 0;
  for (const NamedReaction& r : all)
    force = std::max(force, r.wrench.force.norm()), moment = std::max(moment, r.wrench.moment.norm());
  moment = std::max(moment, force * system.length());
  std::string text;
  for (const NamedReaction& r : all)
    text += fmt::format("  {:<14} on '{}': force {} N, moment {} N m\n", r.name, r.body,
                        vector_text(r.wrench.force, force), vector_text(r.wrench.moment, moment));
  return text;
}

nlohmann::ordered_json pose_json(const System& system, const State& state) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
  for (const Body& body : system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    bodies[body.name] = {{"position", {at.x[0], at.x[1], at.x[2]}}, {"orientation", {at.q.w, at.q.x, at.q.y, at.q.z}}};
  }
  return bodies;
}

nlohmann::ordered_json reaction_json(const System& system, const Evaluated& v) {
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const NamedReaction& r : reactions_of(system, v)) {
    const Vec3 &f = r.wrench.force, &m = r.wrench.moment;
    all[r.name] = {{"on", r.body}, {"force", {f[0], f[1], f[2]}}, {"moment", {m[0], m[1], m[2]}}};
  }
  return all;
}

}  // namespace lockstep
