// SPDX-License-Identifier: BSD-3-Clause
// Slots: the clusters of welded bodies that move as one.
#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include <lockstep/body.h>
#include <lockstep/system.h>

namespace lockstep {

// One slot per body, or one for all bodies that are welded together.
void System::setup_slots() {
  slots_.clear();
  n_velocities_ = 0;
  setup_merge();
  slots_.reserve(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Body& b = bodies_[k];
    if (b.freedoms == Freedoms::particle && !b.fixed && !b.start.w.isZero(0))
      throw ModelError("body '" + b.name + "' is a particle and starts with the angular velocity " +
                           text::brief(b.start.w.norm()) +
                           " rad/s; a particle does not turn: leave it out, or give the body an inertia",
                       {.thing = {.kind = "body", .name = b.name}});
    if (!b.start.v.allFinite() || !b.start.w.allFinite())
      throw ModelError("body '" + b.name + "' starts with a velocity that is not finite; give numbers",
                       {.thing = {.kind = "body", .name = b.name}});
    if (b.fixed) {
      b.slot = kGround;
      b.in_slot = b.home;
    } else if (part_of_[k] == k) {
      b.slot = n_slots();
      slots_.emplace_back().bodies = {&b};
    } else {  // the first body of its part comes earlier; if that is fixed, so is this
      b.slot = bodies_[part_of_[k]].slot;
      if (b.slot == kGround)
        b.in_slot = b.home;
      else
        slots_[b.slot].bodies.push_back(&b);
    }
  }
  for (Slot& slot : slots_) {
    fill_slot(slot);
    n_velocities_ += BodyMass(slot, plane_).width();
  }
}

// Mass, inertia and pose of a slot. Its origin is the mass centre; its axes are those of the first body, in a
// planar mechanism the world's at the start, so that every slot turns about the same one.
void System::fill_slot(Slot& s) {
  const Body& first = *s.bodies.front();
  s.freedoms = s.bodies.size() == 1 ? first.freedoms : Freedoms::spatial;
  const bool of_world = plane_ || has_left_plane_;
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
    const Vec3 r = to_slot * (b->home.x - s.home.x) + A * b->mass.center;  // mass centre of the body in the slot
    b->in_slot = {Vec3(to_slot * (b->home.x - s.home.x)), own_axes ? Quat{} : conjugate(s.home.q) * b->home.q};
    if (s.bodies.size() == 1) b->in_slot.x = A * -b->mass.center;
    s.J += A * b->mass.J * A.transpose();
    if (s.bodies.size() > 1) s.J += b->mass.mass * (r.dot(r) * Mat3::Identity() - r * r.transpose());  // Steiner
  }
}

std::size_t System::index_of(const Lock& link) const {
  const auto k = static_cast<std::size_t>(link.number());  // as of the last setup
  if (link.number() >= 0 && k < links_.size() && links_[k].get() == &link) return k;
  const auto it = std::find_if(links_.begin(), links_.end(), [&](const auto& l) { return l.get() == &link; });
  return static_cast<std::size_t>(it - links_.begin());
}

// Finds the welded parts: part_of_ is the first body of each body's part, or a fixed one if there is one.
void System::setup_merge() {
  part_of_.resize(bodies_.size());
  for (std::size_t k = 0; k < part_of_.size(); ++k) part_of_[k] = k;
  merged_.assign(links_.size(), false);
  if (!merge_) return;
  std::unordered_map<const Body*, std::size_t> numbers;  // filled where something is merged
  const auto number_of = [&](const Body* body) {
    if (numbers.empty())
      for (const Body& b : bodies_) numbers.emplace(&b, numbers.size());
    return numbers.at(body);
  };
  const auto part = [&](std::size_t k) {
    for (; part_of_[k] != k; k = part_of_[k]) part_of_[k] = part_of_[part_of_[k]];  // ways grow shorter
    return k;
  };
  const auto join = [&](std::size_t a, std::size_t b) {
    std::size_t first = std::min(part(a), part(b)), second = std::max(part(a), part(b));
    if (bodies_[second].fixed && !bodies_[first].fixed) std::swap(first, second);
    part_of_[second] = first;
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
  std::unordered_set<const Lock*> stays(kept_.begin(), kept_.end());  // and links whose reactions are read
  for (const auto& force : forces_)
    if (const Reacting* own = force->reacting())
      for (const Lock* link : own->reads()) stays.insert(link);
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const Lock& link = *links_[l];
    const auto particle = [](const Marker* m) { return m->body->freedoms == Freedoms::particle && !m->body->fixed; };
    if (!link.is_weld() || !link.active_at_start() || stays.contains(&link)) continue;
    const auto [p, s] = link.pairs().front();
    if (particle(p) || particle(s) || !meet(*p, *s)) continue;
    merged_[l] = true;
    join(number_of(p->body), number_of(s->body));
  }
  if (numbers.empty()) return;
  std::vector<std::vector<std::size_t>> bodies(bodies_.size()), links(bodies_.size());  // of each part
  for (std::size_t k = 0; k < part_of_.size(); ++k) bodies[part_of_[k] = part(k)].push_back(k);
  for (std::size_t k = 0; k < links_.size(); ++k)
    if (merged_[k]) links[part_of_[number_of(links_[k]->pairs().front().first->body)]].push_back(k);
  const auto dissolve = [&](std::size_t of) {
    for (const std::size_t k : links[of]) merged_[k] = false;
    for (const std::size_t k : bodies[of]) part_of_[k] = k;
    links[of].clear(), bodies[of].clear();
  };
  // A part within which another link acts is not merged: both ends of that link would be on one rigid body.
  for (std::size_t l = 0; l < links_.size(); ++l) {
    if (merged_[l]) continue;
    for (const auto& [p, s] : links_[l]->pairs()) {
      const std::size_t a = part_of_[number_of(p->body)], b = part_of_[number_of(s->body)];
      if (a != b && !(bodies_[a].fixed && bodies_[b].fixed)) continue;  // fixed parts are at rest against each other
      dissolve(a), dissolve(b);
    }
  }
}

}  // namespace lockstep
