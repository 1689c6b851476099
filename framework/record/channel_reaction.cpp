// Reactions of links and what drives add, from the multipliers and the rows alone: no formula a link.
#include <spdlog/fmt/fmt.h>

#include "framework/record/channel_entry.h"

namespace lockstep::channels {
namespace {

// Which rows of a link: the joint's own, those of all drives, or those of drive number 0, 1, ...
enum Part : int { kJoint = -2, kDrives = -1 };
bool belongs(int drive_row, int part) {
  return part == kJoint ? drive_row < 0 : part == kDrives ? drive_row >= 0 : drive_row == part;
}

/// Force and moment about a point, world axes.
struct Wrench {
  Vec3 F = Vec3::Zero(), tau = Vec3::Zero();
};

// (2.1) generalised force on the link's i-th slot: -J_i^T lambda; its moment carried to the point.
Wrench on_slot(const Lock& link, const Evaluated& v, const RowEntry& e, int i, int part, const Vec3& point) {
  const RowBlock block = v.rows.block(e);
  Vec3 F = Vec3::Zero(), m = Vec3::Zero();
  for (int k = 0; k < e.m; ++k) {
    if (!belongs(link.drive_row(e.own[static_cast<std::size_t>(k)]), part)) continue;
    const double lambda = v.lambda[e.first_row + k];
    const auto r = block.J(i, k);
    F -= lambda * Vec3(r[0], r[1], r[2]);
    m -= lambda * Vec3(r[3], r[4], r[5]);
  }
  const Motion& O = v.in.slot(e.slots[i]);
  return {F, O.A * m - cross(Vec3(point - O.x), F)};
}

// On the body of marker `at`, about the marker's origin. A body that is fixed has no rows: it takes what all others
// give.
Wrench on_body_of(const Marker& at, const Lock& link, const Evaluated& v, int part) {
  const int entry = v.rows.entry_of_link[static_cast<std::size_t>(link.number())];
  if (entry < 0) return {};
  const RowEntry& e = v.rows.entries[static_cast<std::size_t>(entry)];
  const Vec3 point = in_world(MarkerFrame(at), v.in).x;
  if (const int i = e.slots.position(at.body->slot); i >= 0) return on_slot(link, v, e, i, part, point);
  Wrench sum;
  for (int i = 0; i < e.slots.n; ++i) {
    const Wrench w = on_slot(link, v, e, i, part, point);
    sum.F -= w.F, sum.tau -= w.tau;
  }
  return sum;
}

void add_wrench(const Lock& link, const std::string& prefix, int part, const std::string& by, Entries& out) {
  const Lock* const l = &link;
  const auto [p, s] = link.pairs().front();
  const Marker *const P = p, *const S = s;
  add_vector(out, prefix + "force_on_p_world_", "N", fmt::format("force on p's body at P by {}, world axes", by),
             [=](const Sample& x) { return on_body_of(*P, *l, x.values(), part).F; });
  add_vector(
      out, prefix + "force_on_p_link_", "N", fmt::format("force on p's body at P by {}, S axes", by),
      [=](const Sample& x) {
        return Vec3(in_world(MarkerFrame(*S), x.values().in).A.transpose() * on_body_of(*P, *l, x.values(), part).F);
      });
  add_vector(out, prefix + "torque_on_p_world_", "N m", fmt::format("torque on p's body about P by {}, world axes", by),
             [=](const Sample& x) { return on_body_of(*P, *l, x.values(), part).tau; });
  add_vector(
      out, prefix + "torque_on_p_link_", "N m", fmt::format("torque on p's body about P by {}, S axes", by),
      [=](const Sample& x) {
        return Vec3(in_world(MarkerFrame(*S), x.values().in).A.transpose() * on_body_of(*P, *l, x.values(), part).tau);
      });
  add_vector(out, prefix + "force_on_s_world_", "N", fmt::format("force on s's body at S by {}, world axes", by),
             [=](const Sample& x) { return on_body_of(*S, *l, x.values(), part).F; });
  add_vector(out, prefix + "torque_on_s_world_", "N m", fmt::format("torque on s's body about S by {}, world axes", by),
             [=](const Sample& x) { return on_body_of(*S, *l, x.values(), part).tau; });
}

// (8.8) lambda . Ct over the rows of the drive
double power_of_drive(const Lock& link, const Evaluated& v, int part) {
  const int entry = v.rows.entry_of_link[static_cast<std::size_t>(link.number())];
  if (entry < 0) return 0;
  const RowEntry& e = v.rows.entries[static_cast<std::size_t>(entry)];
  const RowBlock block = v.rows.block(e);
  double power = 0;
  for (int k = 0; k < e.m; ++k)
    if (belongs(link.drive_row(e.own[static_cast<std::size_t>(k)]), part))
      power += v.lambda[e.first_row + k] * block.Ct(k);
  return power;
}

void add_drive(const Lock& link, const std::string& name, int part, const std::string& by, Entries& out) {
  const Lock* const l = &link;
  add_wrench(link, name + ".", part, by, out);
  add(out, name + ".power", "W", "power put in by " + by,
      [l, part](const Sample& s) { return power_of_drive(*l, s.values(), part); });
  add_integral(out, name + ".work", "J", "work of " + by + " since the start", link.name() + "." + name + ".work",
               [l, part](const Evaluated& v) { return power_of_drive(*l, v, part); });
}

}  // namespace

void of_reactions(const Lock& link, Entries& out) {
  if (link.pairs().empty()) return;
  add_wrench(link, "", kJoint, link.n_drives() > 0 ? "the link, drives left out" : "the link", out);
  if (link.n_drives() == 0) return;
  add_drive(link, "drive", kDrives, link.n_drives() > 1 ? "all its drives" : "its drive", out);
  for (int d = 0; d < link.n_drives(); ++d)
    add_drive(link, "drive_" + link.drive(d).name, d, "its drive on " + link.drive(d).name, out);
}

double power_of_laws(const Evaluated& v) {
  double power = 0;
  for (const RowEntry& e : v.rows.entries) {
    const RowBlock block = v.rows.block(e);
    for (int k = 0; k < e.m; ++k) power += v.lambda[e.first_row + k] * block.Ct(k);
  }
  return power;
}

}  // namespace lockstep::channels
