// Reactions of links and the share of their drives, from multipliers and rows alone, for every type of link.
#include <spdlog/fmt/fmt.h>

#include <lockstep/lock.h>
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {
namespace {

constexpr int kJoint = Reactions::kJoint, kDrives = Reactions::kDrives;

void add_wrench(const Lock& link, const std::string& prefix, int part, const std::string& by, Entries& out) {
  const Lock* const l = &link;
  const auto [p, s] = link.pairs().front();
  const Marker *const P = p, *const S = s;
  struct Vector {
    const char *name, *unit, *help;
    bool on_p, force, world;  // else: on s, the moment, S axes
  };
  constexpr Vector kVectors[] = {
      {"force_on_p_world_", "N", "force on p's body at P by {}, world axes", true, true, true},
      {"force_on_p_link_", "N", "force on p's body at P by {}, S axes", true, true, false},
      {"torque_on_p_world_", "N m", "torque on p's body about P by {}, world axes", true, false, true},
      {"torque_on_p_link_", "N m", "torque on p's body about P by {}, S axes", true, false, false},
      {"force_on_s_world_", "N", "force on s's body at S by {}, world axes", false, true, true},
      {"torque_on_s_world_", "N m", "torque on s's body about S by {}, world axes", false, false, true}};
  for (const Vector& v : kVectors)
    add_vector(out, prefix + v.name, v.unit, fmt::format(fmt::runtime(v.help), by), [=](const Sample& x) -> Vec3 {
      const LinkWrench& wrench = x.wrench(*l, v.on_p ? *P : *S, part);
      const Vec3 f = v.force ? wrench.force : wrench.moment;
      return v.world ? f : Vec3(in_world(MarkerFrame(*S), x.values().in).A.transpose() * f);
    });
}

// (8.8) lambda . Ct over the rows of the drive
double power_of_drive(const Lock& link, const Evaluated& v, int part) {
  const RowEntry* e = entry_of(link, v.rows);
  double power = 0;
  for (int k = 0; e && k < e->m; ++k)
    if (Reactions::belongs(link.row(e->own[k]), part)) power += v.lambda[e->first_row + k] * v.rows.block(*e).Ct(k);
  return power;
}

void add_drive(const Lock& link, const std::string& name, int part, const std::string& by, Entries& out) {
  const Lock* const l = &link;
  add_wrench(link, name + ".", part, by, out);
  add(out, name + ".power", "W", "power put in by " + by,
      [l, part](const Sample& s) { return power_of_drive(*l, s.values(), part); });
  add_integral(
      out, name + ".work", "J", "work of " + by + " since the start", link.name() + "." + name + ".work",
      [l, part](const Evaluated& v) { return power_of_drive(*l, v, part); }, Integrand::drive);
}

}  // namespace

void of_reactions(const Lock& link, Entries& out) {
  if (link.pairs().empty()) return;
  const Driven* driven = link.driven();
  const int n = driven ? driven->n_drives() : 0;
  add_wrench(link, "", kJoint, n > 0 ? "the link, drives left out" : "the link", out);
  if (n == 0) return;
  add_drive(link, "drive", kDrives, n > 1 ? "all its drives" : "its drive", out);
  for (int d = 0; d < n; ++d) {
    const std::string name = driven->drive(d).name;
    add_drive(link, "drive_" + name, d, "its drive on " + name, out);
  }
}

}  // namespace lockstep::channels
