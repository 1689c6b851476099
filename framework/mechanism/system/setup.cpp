// SPDX-License-Identifier: BSD-3-Clause
// Setup: what a description amounts to, before anything is evaluated. slots.cpp has the first step of it, plane.cpp the last.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <typeindex>
#include <unordered_set>
#include <utility>

#include <lockstep/author/passes.h>
#include "framework/mechanism/system/check_writes.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/mechanism/system/rows_at_start.h"

namespace lockstep {
namespace {

constexpr double kShortest = 1e-12;  // m, of a body with a size; and, of the distance from the origin, its rounding
constexpr double kApart = 1e-6;      // m, between points: less may be a misfit

// Markers and joints of another System would be read as if they were of this one.
void check_markers(const System& system) {
  std::vector<const Body*> own;
  own.reserve(system.bodies().size());
  for (const Body& body : system.bodies()) own.push_back(&body);
  std::ranges::sort(own);
  const auto check = [&](const auto& thing, const Marker* m) {
    if (m == nullptr || m->body == nullptr || std::ranges::binary_search(own, m->body)) return;
    throw ModelError(thing_of(thing).words() + ": marker '" + m->name + "' is on body '" + m->body->name +
                         "' of another System; make a marker of this one (add_marker)",
                     {.thing = thing_of(thing)});
  };
  for (const auto& link : system.links())
    for (const auto& [p, s] : link->pairs()) check(*link, p), check(*link, s);
  std::unordered_set<const Lock*> known;
  if (std::ranges::any_of(system.forces(), [](const auto& force) { return force->reacting() != nullptr; }))
    for (const auto& link : system.links()) known.insert(link.get());
  for (const auto& force : system.forces()) {
    for (const Marker* m : force->markers()) check(*force, m);
    if (force->reacting() == nullptr) continue;
    for (const Lock* link : force->reacting()->reads())
      if (link != nullptr && !known.contains(link))
        throw ModelError(thing_of(*force).words() + ": joint '" + link->name() +
                             "', whose reactions it reads, belongs to another System",
                         {.thing = thing_of(*force)});
  }
}

void order_links(System& system, System::Found& found) {
  // Joints of equal type, pattern, rows and slots form a group; groups are in the order of their first members.
  using Likeness = std::tuple<std::type_index, LinkPattern, int, int>;
  struct Alike {
    std::size_t number;  // of the group
    const Lock* first;
  };
  std::map<Likeness, Alike> known;
  std::vector<std::size_t> of_link, first;  // groups of the joints set up; where each group begins in found.ordered
  of_link.reserve(system.links().size());
  for (std::size_t k = 0; k < system.links().size(); ++k) {
    if (found.merged[k]) continue;
    Lock& l = *system.links()[k];
    set_up(l);
    l.count_angles(system);
    const auto [it, is_new] =
        known.try_emplace({typeid(l), l.pattern(), l.row_count(), l.slots().n}, Alike{first.size(), &l});
    if (is_new) first.push_back(0);
    l.share_rows(*it->second.first);
    of_link.push_back(it->second.number), ++first[it->second.number];
  }
  for (std::size_t begin = 0; std::size_t & n : first) begin += std::exchange(n, begin);
  found.ordered.resize(of_link.size()), found.group.resize(of_link.size());
  for (std::size_t k = 0, i = 0; k < system.links().size(); ++k) {
    if (found.merged[k]) continue;
    const std::size_t group = of_link[i++], at = first[group]++;
    found.ordered[at] = system.links()[k].get(), found.group[at] = static_cast<int>(group);
  }
}

// States whose error controls the step come first, then quadratures and counted angles.
void place_states(const System& system, System::Found& found) {
  for (int number = 0; const auto& link : system.links()) {
    link->set_indices(number++, found.n_states, found.n_memory);
    found.n_states += link->n_own_states();
    found.n_memory += link->n_own_memory() + (link->unilateral() ? 1 : 0);
  }
  for (const auto& force : system.forces()) {
    force->place(found.n_memory);
    found.n_memory += force->n_own_memory() + (force->is_switched() ? 1 : 0);
  }
  for (const bool controlled : {true, false}) {
    for (const auto& auxiliary : system.auxiliaries()) {
      if (auxiliary->controls_error() != controlled) continue;
      auxiliary->place(found.n_states);
      found.n_states += auxiliary->size();
    }
    if (controlled) found.n_controlled = found.n_states;
  }
  for (int k = 0; const auto& angle : system.counted_angles()) {
    angle->setup();
    angle->place(k++, found.n_states);
    found.n_states += CountedAngle::kStates;
  }
}

// Between the ends of a force.
double length_between_ends(const System& system) {
  double length = 0;
  for (const auto& force : system.forces()) {
    const std::vector<const Marker*> ends = force->markers();
    for (const Marker* end : ends)
      length = std::max(length, ((end->body->home * end->local).x - (ends[0]->body->home * ends[0]->local).x).norm());
  }
  return length;
}

// Particles without joints have no length of their own: that between bodies, else 1 m.
double length_between_bodies(const System& system) {
  double length = 0;
  for (const Body& body : system.bodies())
    if (body.slot != kGround) length = std::max(length, (body.home.x - system.bodies().front().home.x).norm());
  return length > kApart ? length : 1;
}

double length_of(const System& system) {
  double rounding = kShortest;  // of what is computed from places
  for (const Slot& s : system.found().slots) rounding = std::max(rounding, kShortest * s.home.x.norm());
  double length = rounding;
  for (const Marker& m : system.markers())
    if (m.body->slot != kGround) length = std::max(length, (m.body->in_slot * m.local).x.norm());
  for (const Slot& s : system.found().slots)  // (i_x^2 + i_y^2 + i_z^2)/2 = trace(J)/(2 m)
    if (s.freedoms == Freedoms::spatial) length = std::max(length, std::sqrt(s.J.trace() / (2 * s.mass)));
  double apart = 0;
  for (const auto& link : system.links())
    for (const auto& [p, s] : link->pairs())
      apart = std::max(apart, ((p->body->home * p->local).x - (s->body->home * s->local).x).norm());
  if (std::max(length, apart) <= kApart) apart = length_between_ends(system);
  if (apart > kApart) length = std::max(length, apart);
  return length <= rounding ? length_between_bodies(system) : length;
}

// Apart, since the check is made at every evaluation.
[[noreturn]] void refuse_size(const System& system, const State& state) {
  throw ModelError(fmt::format(
      "a state of {} coordinates, {} velocities, {} own states, {} remembered numbers and {} joints does "
      "not fit a system of {} moving bodies, {} own states, {} remembered numbers and {} joints; begin from "
      "System::start() once the system is complete",
      state.q.size(), state.v.size(), state.s.size(), state.z.size(), state.modes.size(), system.n_slots(),
      system.n_states(), system.n_memory(), system.links().size()));
}

}  // namespace

void System::setup() {
  if (ready_) return;
  std::optional<ModelError> refusal = try_setup();
  if (refusal && plane_is_known_) {
    set_planar({});
    refusal = try_setup();
  }
  if (refusal) throw ModelError(*refusal);
}

System::InSpace::InSpace(System& system) : system_(system) {
  system.setup();
  revision_ = system.revision_;
  if (!system.plane_is_known_ || !system.plane_) return;
  plane_ = system.plane_;
  set({}, -2 - revision_);  // of no setup, and the same in every look
}

void System::InSpace::end() {
  if (plane_) set(std::exchange(plane_, {}), revision_);
}

void System::InSpace::stay() {
  if (!plane_) return;
  plane_ = {}, system_.plane_is_known_ = false, system_.has_left_plane_ = true;
  system_.revision_ = revision_ + 1;
}

void System::InSpace::set(Plane plane, long revision) {
  system_.plane_ = plane, system_.revision_ = revision;
  system_.found_.n_velocities = 0;
  for (const Slot& slot : system_.found_.slots) system_.found_.n_velocities += BodyMass(slot, plane).width();
}

std::optional<ModelError> System::try_setup() {
  ready_ = false;
  check_markers(*this);
  found_ = {};
  setup_slots();
  order_links(*this, found_);
  for (auto& force : forces_) set_up(*force), force->count_angles(*this);
  place_states(*this, found_);
  found_.length = length_of(*this);
  ready_ = true;  // what follows evaluates it at its start
  try {
    if (plane_)
      if (std::optional<ModelError> refusal = setup_plane(*this, found_)) {
        ready_ = false;
        return refusal;
      }
    ++revision_;
    check_writes(*this);
  } catch (...) {
    ready_ = false;
    throw;
  }
  return {};
}

void System::check_size(const State& state) const {
  const auto links = links_.size();
  const int n_q = state.coordinates ? state.coordinates->n_q() : 7 * n_slots();
  const int n_v = state.coordinates ? state.coordinates->n_v() : 6 * n_slots();
  if (state.q.size() != n_q || state.v.size() != n_v || state.s.size() != found_.n_states ||
      state.z.size() != found_.n_memory || state.modes.size() != links || state.watched.size() != links)
    refuse_size(*this, state);
}

State System::start() const {
  if (!ready_)
    throw ModelError(
        "System::start: the system is not set up, or was changed since; call setup(), or make its Dynamics, first");
  State state;
  const int n = n_slots();
  state.q.resize(7 * n);
  state.v.resize(6 * n);
  for (int k = 0; k < n; ++k) {
    const Body& b = body_of_slot(k);
    const Pose& home = slot(k).home;
    state.set_slot_pose(k, home);
    const Mat3 A = rotation(b.home.q);  // a slot moves with its first body
    const Vec3 r = slot(k).bodies.size() == 1 ? b.mass.center : Vec3(A.transpose() * (home.x - b.home.x));
    state.set_slot_twist(k, {b.start.v + A * cross(b.start.w, r), rotation(b.in_slot.q) * b.start.w});
  }
  state.s = VecX::Zero(found_.n_states);
  state.z = VecX::Zero(found_.n_memory);
  const auto part = [](VecX& x, int first, int size) {
    return std::span<double>(x.data() + first, static_cast<std::size_t>(size));
  };
  for (const auto& link : links_) {
    state.modes.push_back(link->active_at_start() && !link->unilateral());  // unilateral links: at contact
    state.watched.push_back(link->active_at_start() && link->unilateral());
    named(*link, 0.0, [&] {
      if (const Stateful* own = link->stateful())
        own->start_states(part(state.s, link->first_state(), own->n_states()));
      if (const Remembering* own = link->remembering())
        own->start_memory(part(state.z, link->first_memory(), own->n_memory()));
    });
  }
  for (const auto& force : forces_) {
    if (const Remembering* own = force->remembering())
      named(*force, 0.0, [&] { own->start_memory(part(state.z, force->first_memory(), own->n_memory())); });
    if (force->switch_memory() >= 0) state.z[force->switch_memory()] = force->acts_at_start() ? 1 : 0;
  }
  for (const auto& auxiliary : auxiliaries_)
    named(*auxiliary, 0.0, [&] { auxiliary->start(part(state.s, auxiliary->first(), auxiliary->size())); });
  if (angles_.empty()) return state;
  std::vector<Motion> at_home;
  passes::motions(*this, state, at_home);
  const Inputs in{0, at_home, part(state.s, 0, found_.n_states), part(state.z, 0, found_.n_memory)};
  for (const auto& angle : angles_) named(*angle, 0.0, [&] { angle->set(in, 0.0, state.s); });
  return state;
}

}  // namespace lockstep
