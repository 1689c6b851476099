// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/system.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <tuple>
#include <typeindex>
#include <unordered_set>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/system/check_writes.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kShortest = 1e-12;  // m, of a body with a size; and, of the distance from the origin, its rounding
constexpr double kApart = 1e-6;      // m, between points: less may be a misfit

// Between the ends of a force.
template <class Forces>
double length_between_ends(const Forces& forces) {
  double length = 0;
  for (const auto& force : forces) {
    const std::vector<const Marker*> ends = force->markers();
    for (const Marker* end : ends)
      length = std::max(length, ((end->body->home * end->local).x - (ends[0]->body->home * ends[0]->local).x).norm());
  }
  return length;
}

// Particles without links have no length of their own: that between bodies, else 1 m.
template <class Bodies>
double length_between_bodies(const Bodies& bodies) {
  double length = 0;
  for (const Body& body : bodies)
    if (body.slot != kGround) length = std::max(length, (body.home.x - bodies.front().home.x).norm());
  return length > kApart ? length : 1;
}

template <class Item>
const std::string& name_of(const Item& item) {
  if constexpr (requires { item->name(); })
    return item->name();
  else if constexpr (requires { item.name(); })
    return item.name();
  else
    return item.name;
}

template <class Range>
std::vector<std::string> names_of(const Range& range) {
  std::vector<std::string> names;
  for (const auto& item : range) names.push_back(name_of(item));
  return names;
}

// By its number among the names, -1: none; a thing that was named anew is looked for.
template <class Range>
auto& find(const std::string& kind, Range& range, std::ptrdiff_t number, const std::string& name) {
  if (number >= 0) return range[number];
  for (auto& item : range)
    if (name_of(item) == name) return item;
  throw ModelError("unknown " + kind + " \"" + name + "\"" + text::suggestion(name, names_of(range)));
}

// Markers and links of another System would be read as if they were of this one.
template <class Bodies, class Links, class Forces>
void check_markers(const Bodies& bodies, const Links& links, const Forces& forces) {
  std::vector<const Body*> own;
  own.reserve(bodies.size());
  for (const Body& body : bodies) own.push_back(&body);
  std::ranges::sort(own);
  const auto check = [&](const auto& thing, const Marker* m) {
    if (m == nullptr || m->body == nullptr || std::ranges::binary_search(own, m->body)) return;
    throw ModelError(thing_of(thing).words() + ": marker '" + m->name + "' is on body '" + m->body->name +
                         "' of another System; make a marker of this one (add_marker)",
                     {.thing = thing_of(thing)});
  };
  for (const auto& link : links)
    for (const auto& [p, s] : link->pairs()) check(*link, p), check(*link, s);
  std::unordered_set<const Lock*> known;
  if (std::ranges::any_of(forces, [](const auto& force) { return force->reacting() != nullptr; }))
    for (const auto& link : links) known.insert(link.get());
  for (const auto& force : forces) {
    for (const Marker* m : force->markers()) check(*force, m);
    if (force->reacting() == nullptr) continue;
    for (const Lock* link : force->reacting()->reads())
      if (link != nullptr && !known.contains(link))
        throw ModelError(
            thing_of(*force).words() + ": link '" + link->name() + "', whose reactions it reads, is of another System",
            {.thing = thing_of(*force)});
  }
}

void check_pose(const std::string& what, const Pose& pose) {
  if (!pose.x.allFinite() || !pose.q.coefficients().allFinite())
    throw ModelError(what + ": its pose is not finite; give numbers");
  if (std::abs(norm2(pose.q) - 1.0) > 1e-9)
    throw ModelError(what + ": its quaternion has length " + text::brief(std::sqrt(norm2(pose.q))) + "; normalise it");
}

}  // namespace

Pose pose_at(const Vec3& x, const Vec3& z) {
  const double length = z.norm();
  if (!(length > 0)) throw ModelError("at: the direction of z is zero; give a direction");
  const Vec3 n = z / length;
  // x as close as possible to the world's x (the world's y where z is along x), so that planar scenes keep their axes.
  const Vec3 guide = std::abs(n[0]) < 0.99 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 ex = (guide - guide.dot(n) * n).normalized();
  Mat3 A;
  A << ex, cross(n, ex), n;
  return {x, quaternion_of(A)};
}

System::System(Options options) : options_(options) {
  Body& g = bodies_.emplace_back();
  g.name = "ground";
  take_name(g.name, Kind::body, 0);
  g.fixed = true;
  ground_ = &g;
}
System::~System() = default;
System::System(System&&) noexcept = default;
System& System::operator=(System&&) noexcept = default;

// --------------------------------------------------------------------------------------------------------------- names

namespace {

std::uint32_t hash_of(std::string_view name) {
  const std::uint64_t h = std::hash<std::string_view>{}(name);
  return static_cast<std::uint32_t>(h ^ h >> 32);
}

// The place at which a name of this hash is looked for first, of so many.
std::size_t place_of(std::uint32_t hash, std::size_t places) {
  return static_cast<std::size_t>(std::uint64_t{hash} * places >> 32);
}

}  // namespace

std::string_view System::word_of(Kind kind) {
  constexpr std::array kWords{"thing", "body", "marker", "link", "force", "control input"};
  return kWords[static_cast<std::size_t>(kind)];
}

const std::string& System::name_of(const Named& n) const {
  switch (static_cast<Kind>(n.kind)) {
    case Kind::body:
      return bodies_[n.number].name;
    case Kind::marker:
      return markers_[n.number].name;
    case Kind::link:
      return links_[n.number]->name();
    case Kind::input:
      return inputs_[n.number].name();
    default:
      return forces_[n.number]->name();
  }
}

// Of things that were named anew the new name is not known here.
System::Named System::named_thing(std::string_view name) const {
  if (names_.empty()) return {};  // moved from
  const std::uint32_t hash = hash_of(name);
  for (std::size_t at = place_of(hash, names_.size()); names_[at].kind != 0; at = at + 1 < names_.size() ? at + 1 : 0)
    if (names_[at].hash == hash && name_of(names_[at]) == name) return names_[at];
  return {};
}

// At most three quarters of the places are taken, and one more is always empty.
void System::take_name(const std::string& name, Kind kind, std::size_t number) {
  const auto put = [this](const Named& n) {
    std::size_t at = place_of(n.hash, names_.size());
    while (names_[at].kind != 0) at = at + 1 < names_.size() ? at + 1 : 0;
    names_[at] = n;
  };
  if (4 * (n_names_ + 1) > 3 * names_.size()) {
    const std::vector<Named> before = std::exchange(names_, std::vector<Named>(16 + names_.size() * 3 / 2));
    for (const Named& n : before)
      if (n.kind != 0) put(n);
  }
  Named n;
  n.hash = hash_of(name), n.kind = static_cast<std::uint32_t>(kind) & 7U;
  n.number = static_cast<std::uint32_t>(number) & 0x1fffffffU;
  put(n);
  ++n_names_;
}

std::ptrdiff_t System::number_of(Kind kind, const std::string& name) const {
  const Named known = named_thing(name);
  return static_cast<Kind>(known.kind) == kind ? static_cast<std::ptrdiff_t>(known.number) : -1;
}

void System::check_new_name(const std::string& kind, const std::string& name) const {
  if (name.empty()) throw ModelError("a " + kind + " without a name; give it one");
  const Named taken = named_thing(name);
  if (taken.kind == 0) return;
  throw ModelError(kind + " '" + name + "': this name is already taken by a " +
                   std::string(word_of(static_cast<Kind>(taken.kind))) +
                   "; names are unique in a system, so that a channel name is unambiguous: choose another");
}

Body& System::add_body(const std::string& name, const MassProperties& mass, const Pose& home) {
  check_new_name("body", name);
  check_mass(mass, "body '" + name + "'");
  check_pose("body '" + name + "'", home);
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.mass = mass, b.home = home;
  take_name(name, Kind::body, bodies_.size() - 1);
  return b;
}

Body& System::add_particle(const std::string& name, double mass, const Vec3& x) {
  check_new_name("body", name);
  if (!(mass > 0) || !std::isfinite(mass))
    throw ModelError("body '" + name + "': mass " + text::brief(mass) + " kg; a particle needs a mass above zero");
  check_pose("body '" + name + "'", {x, {}});
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.mass.mass = mass, b.home.x = x, b.freedoms = Freedoms::particle;
  take_name(name, Kind::body, bodies_.size() - 1);
  return b;
}

Body& System::add_fixed(const std::string& name, const Pose& home) {
  check_new_name("body", name);
  check_pose("body '" + name + "'", home);
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.home = home, b.fixed = true;
  take_name(name, Kind::body, bodies_.size() - 1);
  return b;
}

Marker& System::add_marker(const std::string& name, Body& body, const Pose& local) {
  check_new_name("marker", name);
  check_pose("marker '" + name + "'", local);
  ready_ = false;
  Marker& marker = markers_.emplace_back(Marker{name, &body, local});
  take_name(name, Kind::marker, markers_.size() - 1);
  return marker;
}

Marker& System::add_marker_at(const std::string& name, Body& body, const Pose& world) {
  check_pose("marker '" + name + "'", world);
  return add_marker(name, body, inverse(body.home) * world);
}

Lock& System::add(std::unique_ptr<Lock> link) {
  if (!link) throw ModelError("add: no link was given; make one first");
  check_new_name("link", link->name());
  ready_ = false;
  Lock& added = *links_.emplace_back(std::move(link));
  take_name(added.name(), Kind::link, links_.size() - 1);
  return added;
}

Force& System::add(std::unique_ptr<Force> force) {
  if (!force) throw ModelError("add: no force was given; make one first");
  check_new_name("force", force->name());
  ready_ = false;
  Force& added = *forces_.emplace_back(std::move(force));
  take_name(added.name(), Kind::force, forces_.size() - 1);
  return added;
}

Auxiliary& System::add(std::unique_ptr<Auxiliary> auxiliary) {
  if (!auxiliary) throw ModelError("add: no auxiliary was given; make one first");
  ready_ = false;
  return *auxiliaries_.emplace_back(std::move(auxiliary));
}

CountedAngle& System::count(std::unique_ptr<CountedAngle> angle) {
  if (!angle) throw ModelError("count: no angle was given; make one first");
  const auto [place, is_new] = angle_of_.try_emplace(angle->name(), angle.get());
  if (!is_new) return *place->second;
  angles_.push_back(std::move(angle));
  ready_ = false;
  return *angles_.back();
}

const CountedAngle* System::counted(const Marker& p, const Marker& s, int axis) const {
  const auto found = angle_of_.find(TurnAngle::name_of(p, s, axis));
  return found == angle_of_.end() ? nullptr : found->second;
}

ControlInput::ControlInput(std::string name, double value, std::string unit)
    : name_(std::move(name)), unit_(std::move(unit)) {
  set(value);
}

void ControlInput::refuse(double value) const {
  throw ParameterError({.kind = "input", .name = name_}, "value",
                       "is " + text::brief(value) + "; must be a finite number, it stays " + text::brief(value_));
}

ControlInput& System::add_input(const std::string& name, double value, const std::string& unit) {
  check_new_name("input", name);
  ControlInput& added = inputs_.emplace_back(name, value, unit);
  take_name(name, Kind::input, inputs_.size() - 1);
  return added;
}

ControlInput& System::input(const std::string& name) {
  return find("input", inputs_, number_of(Kind::input, name), name);
}
Body& System::body(const std::string& name) { return find("body", bodies_, number_of(Kind::body, name), name); }
Marker& System::marker(const std::string& name) {
  return find("marker", markers_, number_of(Kind::marker, name), name);
}
Lock& System::link(const std::string& name) { return *find("link", links_, number_of(Kind::link, name), name); }
Force& System::force(const std::string& name) { return *find("force", forces_, number_of(Kind::force, name), name); }
const Body& System::body(const std::string& name) const {
  return find("body", bodies_, number_of(Kind::body, name), name);
}
const Marker& System::marker(const std::string& name) const {
  return find("marker", markers_, number_of(Kind::marker, name), name);
}
const Lock& System::link(const std::string& name) const {
  return *find("link", links_, number_of(Kind::link, name), name);
}
const Force& System::force(const std::string& name) const {
  return *find("force", forces_, number_of(Kind::force, name), name);
}

// --------------------------------------------------------------------------------------------------------------- setup

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
  system_.n_velocities_ = 0;
  for (const Slot& slot : system_.slots_) system_.n_velocities_ += BodyMass(slot, plane).width();
}

std::optional<ModelError> System::try_setup() {
  ready_ = false;
  check_markers(bodies_, links_, forces_);
  setup_slots();
  setup_links();
  setup_forces();
  setup_states();
  setup_length();
  ready_ = true;  // what follows evaluates it at its start
  try {
    if (plane_)
      if (std::optional<ModelError> refusal = setup_plane()) {
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

// States whose error controls the step come first, then quadratures and counted angles.
void System::setup_states() {
  n_states_ = 0;
  n_memory_ = 0;
  int number = 0;
  for (auto& link : links_) {
    link->set_indices(number++, n_states_, n_memory_);
    n_states_ += link->n_own_states();
    n_memory_ += link->n_own_memory() + (link->unilateral() ? 1 : 0);
  }
  for (auto& force : forces_) {
    force->place(n_memory_);
    n_memory_ += force->n_own_memory() + (force->is_switched() ? 1 : 0);
  }
  for (const bool controlled : {true, false}) {
    for (auto& auxiliary : auxiliaries_) {
      if (auxiliary->controls_error() != controlled) continue;
      auxiliary->place(n_states_);
      n_states_ += auxiliary->size();
    }
    if (controlled) n_controlled_ = n_states_;
  }
  for (std::size_t k = 0; k < angles_.size(); ++k) {
    angles_[k]->setup();
    angles_[k]->place(static_cast<int>(k), n_states_);
    n_states_ += CountedAngle::kStates;
  }
}

void System::setup_length() {
  double rounding = kShortest;  // of what is computed from places
  for (const Slot& s : slots_) rounding = std::max(rounding, kShortest * s.home.x.norm());
  length_ = rounding;
  for (const Marker& m : markers_)
    if (m.body->slot != kGround) length_ = std::max(length_, (m.body->in_slot * m.local).x.norm());
  for (const Slot& s : slots_)  // (i_x^2 + i_y^2 + i_z^2)/2 = trace(J)/(2 m)
    if (s.freedoms == Freedoms::spatial) length_ = std::max(length_, std::sqrt(s.J.trace() / (2 * s.mass)));
  double apart = 0;
  for (const auto& link : links_)
    for (const auto& [p, s] : link->pairs())
      apart = std::max(apart, ((p->body->home * p->local).x - (s->body->home * s->local).x).norm());
  if (std::max(length_, apart) <= kApart) apart = length_between_ends(forces_);
  if (apart > kApart) length_ = std::max(length_, apart);
  if (length_ <= rounding) length_ = length_between_bodies(bodies_);
}

void System::setup_links() {
  // Links of equal type, pattern, rows and slots form a group; groups are in the order of their first members.
  using Likeness = std::tuple<std::type_index, LinkPattern, int, int>;
  struct Alike {
    std::size_t number;  // of the group
    const Lock* first;
  };
  std::map<Likeness, Alike> known;
  std::vector<std::size_t> of_link, first;  // groups of the links set up; where each group begins in ordered_
  of_link.reserve(links_.size());
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (merged_[k]) continue;
    Lock& l = *links_[k];
    set_up(l);
    l.count_angles(*this);
    const auto [it, is_new] =
        known.try_emplace({typeid(l), l.pattern(), l.row_count(), l.slots().n}, Alike{first.size(), &l});
    if (is_new) first.push_back(0);
    l.share_rows(*it->second.first);
    of_link.push_back(it->second.number), ++first[it->second.number];
  }
  for (std::size_t begin = 0; std::size_t & n : first) begin += std::exchange(n, begin);
  ordered_.resize(of_link.size()), group_.resize(of_link.size());
  for (std::size_t k = 0, i = 0; k < links_.size(); ++k) {
    if (merged_[k]) continue;
    const std::size_t group = of_link[i++], at = first[group]++;
    ordered_[at] = links_[k].get(), group_[at] = static_cast<int>(group);
  }
}

void System::setup_forces() {
  for (auto& force : forces_) {
    set_up(*force);
    force->count_angles(*this);
  }
}

namespace {

// Apart, since the check is made at every evaluation.
[[noreturn]] void refuse_size(const System& system, const State& state) {
  throw ModelError(
      fmt::format("a state of {} coordinates, {} velocities, {} own states, {} remembered numbers and {} links does "
                  "not fit a system "
                  "of {} moving bodies, {} own states, {} remembered numbers and {} links; begin from System::start() "
                  "once the system "
                  "is complete",
                  state.q.size(), state.v.size(), state.s.size(), state.z.size(), state.modes.size(), system.n_slots(),
                  system.n_states(), system.n_memory(), system.links().size()));
}

}  // namespace

void System::check_size(const State& state) const {
  const auto links = links_.size();
  const int n_q = state.coordinates ? state.coordinates->n_q() : 7 * n_slots();
  const int n_v = state.coordinates ? state.coordinates->n_v() : 6 * n_slots();
  if (state.q.size() != n_q || state.v.size() != n_v || state.s.size() != n_states_ || state.z.size() != n_memory_ ||
      state.modes.size() != links || state.watched.size() != links)
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
  state.s = VecX::Zero(n_states_);
  state.z = VecX::Zero(n_memory_);
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
  motions(state, at_home);
  const Inputs in{0, at_home, part(state.s, 0, n_states_), part(state.z, 0, n_memory_)};
  for (const auto& angle : angles_) named(*angle, 0.0, [&] { angle->set(in, 0.0, state.s); });
  return state;
}

}  // namespace lockstep
