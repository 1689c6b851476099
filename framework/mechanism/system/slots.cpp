// SPDX-License-Identifier: BSD-3-Clause
// Slots: the clusters of welded bodies that move as one.
#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include <lockstep/author/force.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/system.h>
#include <lockstep/text.h>

namespace lockstep {

namespace {

// Finds the welded parts: the first body of each body's part, or a fixed one if there is one. `part_of`: each its own.
void merge(const System& system, const std::vector<const Lock*>& kept, std::vector<std::size_t>& part_of,
           std::vector<bool>& merged) {
  std::unordered_map<const Body*, std::size_t> numbers;  // filled where something is merged
  const auto number_of = [&](const Body* body) {
    if (numbers.empty())
      for (const Body& b : system.bodies()) numbers.emplace(&b, numbers.size());
    return numbers.at(body);
  };
  const auto part = [&](std::size_t k) {
    for (; part_of[k] != k; k = part_of[k]) part_of[k] = part_of[part_of[k]];  // ways grow shorter
    return k;
  };
  const auto join = [&](std::size_t a, std::size_t b) {
    std::size_t first = std::min(part(a), part(b)), second = std::max(part(a), part(b));
    if (system.bodies()[second].fixed && !system.bodies()[first].fixed) std::swap(first, second);
    part_of[second] = first;
  };
  const auto meet = [](const Marker& p, const Marker& s) {  // same pose at the start, and same velocity
    const Pose P = p.body->home * p.local, S = s.body->home * s.local;
    if ((P.x - S.x).norm() > 1e-9 || !rotation(P.q).isApprox(rotation(S.q), 1e-9)) return false;
    const auto v_of = [](const Body& b, const Vec3& x) {
      return Vec3(b.start.v + cross(Vec3(rotation(b.home.q) * b.start.w), Vec3(x - b.home.x)));
    };
    return (v_of(*p.body, P.x) - v_of(*s.body, P.x)).norm() <= 1e-9 &&
           (rotation(p.body->home.q) * p.body->start.w - rotation(s.body->home.q) * s.body->start.w).norm() <= 1e-9;
  };
  std::unordered_set<const Lock*> stays(kept.begin(), kept.end());  // and joints whose reactions are read
  for (const auto& force : system.forces())
    if (const Reacting* own = force->reacting())
      for (const Lock* link : own->reads()) stays.insert(link);
  for (std::size_t l = 0; l < system.links().size(); ++l) {
    const Lock& link = *system.links()[l];
    const auto particle = [](const Marker* m) { return m->body->freedoms == Freedoms::particle && !m->body->fixed; };
    if (!link.is_weld() || !link.active_at_start() || stays.contains(&link)) continue;
    const auto [p, s] = link.pairs().front();
    if (particle(p) || particle(s) || !meet(*p, *s)) continue;
    merged[l] = true;
    join(number_of(p->body), number_of(s->body));
  }
  if (numbers.empty()) return;
  std::vector<std::vector<std::size_t>> bodies(system.bodies().size()), links(system.bodies().size());  // of each part
  for (std::size_t k = 0; k < part_of.size(); ++k) bodies[part_of[k] = part(k)].push_back(k);
  for (std::size_t k = 0; k < system.links().size(); ++k)
    if (merged[k]) links[part_of[number_of(system.links()[k]->pairs().front().first->body)]].push_back(k);
  const auto dissolve = [&](std::size_t of) {
    for (const std::size_t k : links[of]) merged[k] = false;
    for (const std::size_t k : bodies[of]) part_of[k] = k;
    links[of].clear(), bodies[of].clear();
  };
  // A part within which another joint acts is not merged: both ends of that joint would be on one rigid body.
  for (std::size_t l = 0; l < system.links().size(); ++l) {
    if (merged[l]) continue;
    for (const auto& [p, s] : system.links()[l]->pairs()) {
      const std::size_t a = part_of[number_of(p->body)], b = part_of[number_of(s->body)];
      if (a != b && !(system.bodies()[a].fixed && system.bodies()[b].fixed))
        continue;  // fixed parts are at rest against each other
      dissolve(a), dissolve(b);
    }
  }
}

// Mass, inertia and pose of a slot. Its origin is the centre of mass; its axes are those of the first body or, `of_world`,
// the world's at the start: in a plane every slot turns about the same one.
void fill_slot(Slot& s, bool of_world) {
  const Body& first = *s.bodies.front();
  s.freedoms = s.bodies.size() == 1 ? first.freedoms : Freedoms::spatial;
  s.home.q = of_world ? Quat{} : first.home.q;
  s.home.x.setZero();
  for (const Body* b : s.bodies) {
    s.mass += b->mass.mass;
    s.home.x += b->mass.mass * (b->home.x + rotation(b->home.q) * b->mass.center);
  }
  s.home.x /= s.mass;
  if (s.bodies.size() == 1) s.home.x = first.home.x + rotation(first.home.q) * first.mass.center;
  const Mat3 to_slot = rotation(conjugate(s.home.q));
  for (Body* b : s.bodies) {
    const bool own_axes = !of_world && b == &first;
    const Mat3 A = own_axes ? Mat3(Mat3::Identity()) : Mat3(to_slot * rotation(b->home.q));
    const Vec3 r = to_slot * (b->home.x - s.home.x) + A * b->mass.center;  // centre of mass of the body in the slot
    b->in_slot = {Vec3(to_slot * (b->home.x - s.home.x)), own_axes ? Quat{} : conjugate(s.home.q) * b->home.q};
    if (s.bodies.size() == 1) b->in_slot.x = A * -b->mass.center;
    s.J += A * b->mass.J * A.transpose();
    if (s.bodies.size() > 1) s.J += b->mass.mass * (r.dot(r) * Mat3::Identity() - r * r.transpose());  // Steiner
  }
}

}  // namespace

// One slot per body, or one for all bodies that are welded together.
void System::setup_slots() {
  std::vector<Slot>& slots = found_.slots;
  std::vector<std::size_t> part_of(bodies_.size());  // of each body: the first body of its slot
  std::iota(part_of.begin(), part_of.end(), std::size_t{0});
  found_.merged.assign(links_.size(), false);
  if (merge_) merge(*this, kept_, part_of, found_.merged);
  slots.reserve(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Body& b = bodies_[k];
    if (b.freedoms == Freedoms::particle && !b.fixed && !b.start.w.isZero(0))
      throw ModelError("body '" + b.name + "' is a particle and starts with the angular velocity " +
                           text::brief(b.start.w.norm()) +
                           " rad/s; a particle cannot rotate: remove it, or give the body an inertia",
                       {.thing = {.kind = "body", .name = b.name}});
    if (!b.start.v.allFinite() || !b.start.w.allFinite())
      throw ModelError("body '" + b.name + "' starts with a velocity that is not finite; give numbers",
                       {.thing = {.kind = "body", .name = b.name}});
    if (b.fixed) {
      b.slot = kGround;
      b.in_slot = b.home;
    } else if (part_of[k] == k) {
      b.slot = n_slots();
      slots.emplace_back().bodies = {&b};
    } else {  // the first body of its part comes earlier; if that is fixed, so is this
      b.slot = bodies_[part_of[k]].slot;
      if (b.slot == kGround)
        b.in_slot = b.home;
      else
        slots[b.slot].bodies.push_back(&b);
    }
  }
  for (Slot& slot : slots) {
    fill_slot(slot, plane_ || has_left_plane_);
    found_.n_velocities += BodyMass(slot, plane_).width();
  }
}

}  // namespace lockstep
