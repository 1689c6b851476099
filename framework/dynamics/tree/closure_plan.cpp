// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/closure_plan.h"

#include <algorithm>
#include <typeinfo>

#include <lockstep/author/lock.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/joints.h>

namespace lockstep::numbers {

namespace {

// Exactly these classes, which are masks only: a subclass could add behaviour that is not in the arrays.
template <class... Joints>
bool is_any_of(const Lock& link) {
  return ((typeid(link) == typeid(Joints)) || ...);
}

// Whether its own code writes its rows: all but masks of markers at rest on bodies of two rigid groups.
bool has_own_rows(const System& system, const RowEntry& e) {
  const Lock& link = *system.links()[e.link];
  if (!is_any_of<Fixed, PointOnLine, PointOnPlane, PlaneOnPlane, Revolute, Cylindrical, AngularAlignment, Oldham,
                 Prismatic, Rzeppa, Homokinetic, Spherical, GenericLock>(link))
    return true;
  const auto [p, s] = link.pairs().front();
  const auto moves = [](const Marker* m) { return m->translation_law || m->rotation_law; };
  return moves(p) || moves(s) || p->body->slot == s->body->slot;
}

Turn turn_of(const MarkerLock& lock) {
  if (!overlaps(lock.rows(), Mask::e123)) return Turn::none;
  if (lock.laws() & with::qD) return Turn::law;
  return lock.laws() & with::parallel ? Turn::parallel : Turn::plain;
}

// A link with these of its rows, all of them along the axes of S.
Link closing_link(const System& system, const RowEntry& e, ClosurePlan& plan) {
  const auto& lock = static_cast<const MarkerLock&>(*system.links()[e.link]);
  Link link;
  link.link = e.link, link.m = e.m, link.x = static_cast<std::size_t>(e.first_row);
  std::array<int, 6> rows{};
  for (int k = 0, next = 0; k < 6; ++k)
    if (includes(lock.rows(), row_bit(k))) rows[next++] = k;
  bool turns = false;
  for (int k = 0; k < e.m; ++k) {
    link.row[k] = rows[e.own[k]];
    turns = turns || link.row[k] >= 3;
  }
  link.moved = link.row[0] < 3 && (lock.laws() & with::p);
  link.turn = turns ? turn_of(lock) : Turn::none;
  const int P = lock.p().body->slot, S = lock.s().body->slot;
  const auto slot = [&](int k) { return k == kGround ? static_cast<int>(plan.n_slots) : k; };
  link.P = slot(P), link.S = slot(S);
  for (int i = 0; i < e.slots.n; ++i)
    (e.slots[i] == P ? link.J_P : link.J_S) = static_cast<std::ptrdiff_t>(plan.size_J) + 6 * e.m * i;
  link.frames = plan.size_frames, plan.size_frames += frames::size;
  link.law = plan.size_law;
  if (link.has_laws()) plan.size_law += law::size;
  return link;
}

}  // namespace

ClosurePlan make_closure_plan(const System& system, const TreeLayout& layout) {
  ClosurePlan plan;
  plan.fronts = layout.fronts;
  plan.n_slots = system.n_slots();
  plan.slots.resize(plan.fronts.sides.size());
  std::vector<bool> seen(system.n_slots(), false);
  for (const RowEntry& e : layout.closures.entries) {
    const auto m = static_cast<std::size_t>(e.m), first_row = static_cast<std::size_t>(e.first_row);
    if (has_own_rows(system, e))
      plan.own.push_back({e.link, first_row, m, static_cast<std::size_t>(e.slots.n), e.own, plan.size_J});
    else
      plan.masks.push_back(closing_link(system, e, plan));
    plan.links.push_back({first_row, e.m, KindBits(e.kind, e.m)});
    for (int i = 0; i < e.slots.n; ++i) {
      const auto slot = static_cast<std::size_t>(e.slots[static_cast<int>(i)]);
      for (std::size_t k = 0; k < m; ++k) {
        const ClosureSource& source = plan.fronts.sources[first_row + k];
        const auto at = static_cast<std::size_t>(source.first_side) + i;
        const ClosureSide& of = plan.fronts.sides[at];
        plan.slots[at] = {plan.size_J + k, m, static_cast<std::size_t>(of.node)};
        if (!seen[slot]) plan.seen.push_back({slot, static_cast<std::size_t>(of.node)});
        seen[slot] = true;
      }
      plan.size_J += 6 * m;
    }
  }
  if (plan.fronts.in_plane) plan.normal = layout.tree->planar()->plane().n;
  return plan;
}

}  // namespace lockstep::numbers
