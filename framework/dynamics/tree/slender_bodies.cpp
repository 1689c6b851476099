// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/slender_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"

namespace lockstep {

std::string slender_body(const JointTree& tree, const System& system, double most) {
  if (tree.planar()) return "";
  const std::vector<TreeNode>& nodes = tree.nodes();
  std::vector<double> m(nodes.size(), 0.0), r2(nodes.size(), 0.0);
  std::string words;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    const TreeNode& n = nodes[k];
    const Slot& slot = system.slot(n.slot);
    m[k] += slot.mass;
    if (n.link >= 0) r2[k] = std::max(r2[k], n.far_u.squaredNorm());
    if (n.parent >= 0) {
      const auto parent = static_cast<std::size_t>(n.parent);
      m[parent] += m[k], r2[parent] = std::max(r2[parent], n.near_u.squaredNorm());
    }
    if (n.turn != TreeTurn::ball || slot.freedoms == Freedoms::particle) continue;
    const double least = symmetric_eigenvalues(slot.J)[0];
    const double slenderness = m[k] * r2[k] / least;
    if (!(slenderness > most)) continue;
    most = slenderness;
    words = fmt::format(
        "body '{}' rotates about all axes with a least inertia of {} kg m^2 but carries {} kg on arms of {} m, so its "
        "rotation is lost in round-off",
        system.body_of_slot(n.slot).name, text::brief(least), text::brief(m[k]), text::brief(std::sqrt(r2[k])));
  }
  return words;
}

namespace {

// The least principal inertia of a slot, where those axes have m r^2 that a joint holds on a body which is not lost.
double least_inertia(const System& system, int k, double mr2, const std::vector<bool>& lost) {
  Mat3 J = system.slot(k).J;
  for (const auto& link : system.links()) {
    if (link->jointed() == nullptr || !link->active_at_start()) continue;
    for (const auto& [p, s] : link->pairs()) {
      const Marker& own = p->body->slot == k ? *p : *s;
      const int other = (&own == p ? s : p)->body->slot;
      if (own.body->slot != k || other == k || (other != kGround && lost[other])) continue;
      const Mat3 A = rotation((own.body->in_slot * own.local).q);
      for (int i = 0; i < 3; ++i)
        if (includes(link->jointed()->mask(), row_bit(3 + i))) J += mr2 * A.col(i) * A.col(i).transpose();
    }
  }
  return symmetric_eigenvalues(J)[0];
}

}  // namespace

std::vector<Finding> lost_inertias(const System& system) {
  std::vector<Finding> all;
  if (system.plane()) return all;
  std::vector<double> r2(system.n_slots(), 0.0);
  for (const auto& link : system.links())
    for (const auto& [p, s] : link->pairs())
      for (const Marker* marker : {p, s})
        if (const int slot = marker->body->slot; slot != kGround)
          r2[slot] = std::max(r2[slot], (marker->body->in_slot * marker->local).x.squaredNorm());
  const auto limit_of = [&](int k) { return system.slot(k).mass * r2[k] / slenderness_at(kSlight); };
  std::vector<bool> lost(system.n_slots());
  for (int k = 0; k < system.n_slots(); ++k)
    lost[k] = system.slot(k).freedoms != Freedoms::particle && symmetric_eigenvalues(system.slot(k).J)[0] < limit_of(k);
  for (bool found = true; std::exchange(found, false);)
    for (int k = 0; k < system.n_slots(); ++k)
      if (lost[k] && least_inertia(system, k, system.slot(k).mass * r2[k], lost) >= limit_of(k))
        lost[k] = false, found = true;
  for (int k = 0; k < system.n_slots(); ++k) {
    if (!lost[k]) continue;
    const Slot& slot = system.slot(k);
    const double limit = limit_of(k), least = symmetric_eigenvalues(slot.J)[0];
    const std::string body = "body '" + system.body_of_slot(k).name + "'";
    all.push_back({&finding::inertia_lost, body,
                   fmt::format("{}: least inertia {} kg m^2, {} kg, joint at {} m: its rotation is lost in round-off",
                               body, text::brief(least), text::brief(slot.mass), text::brief(std::sqrt(r2[k]))),
                   "give it at least " + text::brief(limit) + " kg m^2 about each axis", least, limit, "kg m^2"});
  }
  return all;
}

}  // namespace lockstep
