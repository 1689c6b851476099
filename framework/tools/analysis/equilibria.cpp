// SPDX-License-Identifier: BSD-3-Clause
// All equilibria that many random starts lead to.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/back_to_plane.h"
#include "framework/tools/analysis/wild_starts.h"

namespace lockstep {
namespace {

/// What a slot does in the motions that nothing holds: its position or its orientation may then differ along a family.
struct Unheld {
  bool moves = false;
  int turns = 0;             ///< 0 none, 1 about one axis, 2 about several
  Vec3 axis = Vec3::Zero();  ///< the one axis, slot axes
};

Unheld unheld_of(const Stability& s, const System& system, int slot) {
  Unheld out;
  Vec3 move = Vec3::Zero();
  for (const FreeMotion& m : s.neutral) {
    const Vec3 turn = system.length() * m.motion.segment<3>(6 * slot + 3);
    move = move.cwiseMax(Vec3(m.motion.segment<3>(6 * slot).cwiseAbs()));
    if (turn.norm() <= kSlight) continue;
    const bool same = out.turns == 0 || cross(out.axis, turn).norm() <= kSlight;
    out.turns = same ? std::max(out.turns, 1) : 2;
    if (out.axis.isZero(0)) out.axis = turn.normalized();
  }
  out.moves = move.norm() > kSlight;
  return out;
}

/// Whether the slot's poses are the same except for motions without stiffness.
bool same_pose(const Pose& p, const Pose& q, const Unheld& unheld, double length, double near) {
  if (!unheld.moves && (p.x - q.x).norm() > near) return false;
  if (unheld.turns == 0) return length * rotation_vector(conjugate(normalized(p.q)) * normalized(q.q)).norm() <= near;
  return unheld.turns > 1 || length * (rotation(p.q) * unheld.axis - rotation(q.q) * unheld.axis).norm() <= near;
}

/// Whether two equilibria are one: the same poses, poses near one singular configuration, or, where a motion is held by
/// nothing, the same family of them: with the same potential energy, and the same in all that is held.
bool same_equilibrium(const System& system, const Equilibrium& a, const Equilibrium& b, double same) {
  const double near = a.report.singular && b.report.singular ? 2 * kNearlyDependent : same;
  if (apart(system, a.state, b.state) <= near * system.length()) return true;
  const Stability &s = a.report.stability, &o = b.report.stability;
  const double E = a.report.energy, other = b.report.energy, work = a.report.largest_force * system.length();
  if (s.neutral.empty() || s.neutral.size() != o.neutral.size() || s.unstable.size() != o.unstable.size() ||
      std::abs(E - other) > kSlight * std::max({std::abs(E), std::abs(other), work}))
    return false;
  for (int k = 0; k < system.n_slots(); ++k) {
    Unheld unheld = unheld_of(s, system, k);
    if (system.slot(k).freedoms == Freedoms::particle) unheld.turns = 2;
    if (!same_pose(a.state.slot_pose(k), b.state.slot_pose(k), unheld, system.length(), same * system.length()))
      return false;
  }
  return true;
}

}  // namespace

EquilibriaReport find_equilibria(Dynamics& dynamics, const State& start, const EquilibriaOptions& options) {
  const System& system = dynamics.system();
  EquilibriaReport report;
  const State first = dynamics.in_slots(start);
  System::InSpace look = dynamics.look_in_space();
  const auto take = [&](Equilibrium found) {
    const auto known = std::ranges::find_if(
        report.all, [&](const Equilibrium& e) { return same_equilibrium(system, e, found, options.same); });
    if (known != report.all.end())
      ++known->found;
    else
      report.all.push_back(std::move(found));
  };
  Equilibrium own{first, {}, 1};
  own.report = find_equilibrium(dynamics, own.state, {.friction = false});
  take(std::move(own));
  report.starts = 1;
  Draw random(options.seed);
  double reach = system.length();  // that of bodies; springs may be longer
  for (const auto& force : system.forces())
    for (const Marker* p : force->markers())
      for (const Marker* s : force->markers())
        reach = std::max(reach, ((p->body->home * p->local).x - (s->body->home * s->local).x).norm());
  for (int k = 0; k < options.starts; ++k, ++report.starts) {
    Equilibrium next{first, {}, 1};
    next.state.v.setZero();
    scatter(system, 2 * reach, random, next.state);
    if (!fit(dynamics, next.state)) {
      ++report.failed, ++report.unassembled;
      continue;
    }
    // Newton's method alone goes to unstable ones too; every other start goes downhill.
    const EquilibriumOptions how{.relaxation_steps = 0, .friction = false, .nearest = k % 2 == 0};
    if (solvable([&] { return next.report = find_equilibrium(dynamics, next.state, how), true; }))
      take(std::move(next));
    else
      ++report.failed;
  }
  std::ranges::stable_sort(report.all, {}, [](const Equilibrium& e) {
    return std::pair(e.report.singular, e.report.stability.unstable.size());
  });
  std::vector<AtRest> found;
  for (Equilibrium& e : report.all)
    measure_move(system, first, e.state, e.report), found.push_back({e.state, e.report});
  go_back_to_plane(dynamics, look, first, found);
  return report;
}

}  // namespace lockstep
