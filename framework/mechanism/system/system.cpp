#include <lockstep/system.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <typeindex>
#include <unordered_set>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/mechanism/system/check_writes.h"

namespace lockstep {
namespace {

constexpr double kShortest = 1e-6;  // m, of a system

// Particles without links have no length of their own: that between the ends of a force, else between bodies, else 1 m.
template <class Forces, class Bodies>
double length_between_points(const Forces& forces, const Bodies& bodies) {
  double length = kShortest;
  for (const auto& force : forces) {
    const std::vector<const Marker*> ends = force->markers();
    for (const Marker* end : ends)
      length = std::max(length, ((end->body->home * end->local).x - (ends[0]->body->home * ends[0]->local).x).norm());
  }
  if (length <= kShortest)
    for (const Body& body : bodies)
      if (body.slot != kGround) length = std::max(length, (body.home.x - bodies.front().home.x).norm());
  return length > kShortest ? length : 1;
}

template <class Item>
const std::string& name_of(const Item& item) {
  if constexpr (requires { item->name(); })
    return item->name();
  else
    return item.name;
}

template <class Range>
std::vector<std::string> names_of(const Range& range) {
  std::vector<std::string> names;
  for (const auto& item : range) names.push_back(name_of(item));
  return names;
}

// By the number that `names` has for it; a thing that was named anew since is looked for.
template <class Range, class Names>
auto& find(const std::string& kind, Range& range, const Names& names, const std::string& name) {
  if (const auto known = names.find(name); known != names.end() && known->second.kind == kind)
    if (auto& item = range[known->second.number]; name_of(item) == name) return item;
  for (auto& item : range)
    if (name_of(item) == name) return item;
  throw ModelError("unknown " + kind + " \"" + name + "\"" + text::suggestion(name, names_of(range)));
}

// Markers and links of another System would be read as if they were of this one.
template <class Bodies, class Links, class Forces>
void check_markers(const Bodies& bodies, const Links& links, const Forces& forces) {
  std::unordered_set<const Body*> own;
  for (const Body& body : bodies) own.insert(&body);
  const auto check = [&](const auto& thing, const Marker* m) {
    if (m == nullptr || m->body == nullptr || own.contains(m->body)) return;
    throw ModelError(thing_of(thing).words() + ": marker '" + m->name + "' is on body '" + m->body->name +
                         "' of another System; make a marker of this one (add_marker)",
                     {.thing = thing_of(thing)});
  };
  std::unordered_set<const Lock*> known;
  for (const auto& link : links) {
    known.insert(link.get());
    for (const auto& [p, s] : link->pairs()) check(*link, p), check(*link, s);
  }
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
  names_.emplace(g.name, Named{"body", 0});
  g.fixed = true;
  ground_ = &g;
}
System::~System() = default;
System::System(System&&) noexcept = default;
System& System::operator=(System&&) noexcept = default;

void System::check_new_name(const std::string& kind, const std::string& name) const {
  if (name.empty()) throw ModelError("a " + kind + " without a name; give it one");
  const auto taken = [&](const std::string& by) {
    throw ModelError(kind + " '" + name + "': this name is already taken by a " + by +
                     "; names are unique in a system, so that a channel name is unambiguous: choose another");
  };
  const auto found = names_.find(name);
  if (found != names_.end()) taken(std::string(found->second.kind));
}

Body& System::add_body(const std::string& name, const MassProperties& mass, const Pose& home) {
  check_new_name("body", name);
  check_mass(mass, "body '" + name + "'");
  check_pose("body '" + name + "'", home);
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.mass = mass, b.home = home;
  names_.emplace(name, Named{"body", bodies_.size() - 1});
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
  names_.emplace(name, Named{"body", bodies_.size() - 1});
  return b;
}

Body& System::add_fixed(const std::string& name, const Pose& home) {
  check_new_name("body", name);
  check_pose("body '" + name + "'", home);
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.home = home, b.fixed = true;
  names_.emplace(name, Named{"body", bodies_.size() - 1});
  return b;
}

Marker& System::add_marker(const std::string& name, Body& body, const Pose& local) {
  check_new_name("marker", name);
  check_pose("marker '" + name + "'", local);
  ready_ = false;
  names_.emplace(name, Named{"marker", markers_.size()});
  return markers_.emplace_back(Marker{name, &body, local});
}

Marker& System::add_marker_at(const std::string& name, Body& body, const Pose& world) {
  check_pose("marker '" + name + "'", world);
  return add_marker(name, body, inverse(body.home) * world);
}

Lock& System::add(std::unique_ptr<Lock> link) {
  if (!link) throw ModelError("add: no link was given; make one first");
  check_new_name("link", link->name());
  ready_ = false;
  names_.emplace(link->name(), Named{"link", links_.size()});
  return *links_.emplace_back(std::move(link));
}

Force& System::add(std::unique_ptr<Force> force) {
  if (!force) throw ModelError("add: no force was given; make one first");
  check_new_name("force", force->name());
  ready_ = false;
  names_.emplace(force->name(), Named{"force", forces_.size()});
  return *forces_.emplace_back(std::move(force));
}

Auxiliary& System::add(std::unique_ptr<Auxiliary> auxiliary) {
  if (!auxiliary) throw ModelError("add: no auxiliary was given; make one first");
  ready_ = false;
  return *auxiliaries_.emplace_back(std::move(auxiliary));
}

Body& System::body(const std::string& name) { return find("body", bodies_, names_, name); }
Marker& System::marker(const std::string& name) { return find("marker", markers_, names_, name); }
Lock& System::link(const std::string& name) { return *find("link", links_, names_, name); }
Force& System::force(const std::string& name) { return *find("force", forces_, names_, name); }
const Body& System::body(const std::string& name) const { return find("body", bodies_, names_, name); }
const Marker& System::marker(const std::string& name) const { return find("marker", markers_, names_, name); }
const Lock& System::link(const std::string& name) const { return *find("link", links_, names_, name); }
const Force& System::force(const std::string& name) const { return *find("force", forces_, names_, name); }

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

std::optional<ModelError> System::try_setup() {
  ready_ = false;
  check_markers(bodies_, links_, forces_);
  setup_slots();
  setup_links();
  setup_forces();
  setup_states();
  setup_length();
  if (plane_)
    if (std::optional<ModelError> refusal = setup_plane()) return refusal;
  ready_ = true;
  ++revision_;
  try {
    check_writes(*this);
  } catch (...) {
    ready_ = false;
    throw;
  }
  return {};
}

// States whose error controls the step come first, then quadratures.
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
}

void System::setup_length() {
  length_ = kShortest;
  for (const Marker& m : markers_)
    if (m.body->slot != kGround) length_ = std::max(length_, (m.body->in_slot * m.local).x.norm());
  for (const Slot& s : slots_)  // (i_x^2 + i_y^2 + i_z^2)/2 = trace(J)/(2 m)
    if (s.freedoms == Freedoms::spatial) length_ = std::max(length_, std::sqrt(s.J.trace() / (2 * s.mass)));
  for (const auto& link : links_)
    for (const auto& [p, s] : link->pairs())
      length_ = std::max(length_, ((p->body->home * p->local).x - (s->body->home * s->local).x).norm());
  if (length_ <= kShortest) length_ = length_between_points(forces_, bodies_);
}

void System::setup_links() {
  for (std::size_t l = 0; l < links_.size(); ++l) {
    if (!merged_[l]) set_up(*links_[l]);
  }
  // Links of equal type, pattern, rows and slots form a group; groups are in the order of their first members.
  using Kind = std::tuple<std::type_index, LinkPattern, int, int>;
  std::map<Kind, std::vector<const Lock*>> members;
  std::vector<Kind> order;
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const Lock& l = *links_[k];
    if (merged_[k]) continue;
    const Kind kind{typeid(l), l.pattern(), l.row_count(), l.slots().n};
    auto& group = members[kind];
    if (group.empty()) order.push_back(kind);
    group.push_back(&l);
  }
  ordered_.clear();
  group_.clear();
  for (std::size_t g = 0; g < order.size(); ++g)
    for (const Lock* l : members[order[g]]) {
      ordered_.push_back(l);
      group_.push_back(static_cast<int>(g));
    }
}

void System::setup_forces() {
  for (auto& force : forces_) set_up(*force);
}

void System::check_size(const State& state) const {
  const auto links = links_.size();
  const int n_q = state.coordinates ? state.coordinates->n_q() : 7 * n_slots();
  const int n_v = state.coordinates ? state.coordinates->n_v() : 6 * n_slots();
  if (state.q.size() == n_q && state.v.size() == n_v && state.s.size() == n_states_ && state.z.size() == n_memory_ &&
      state.modes.size() == links && state.watched.size() == links)
    return;
  throw ModelError("a state of " + std::to_string(state.q.size()) + " coordinates, " + std::to_string(state.v.size()) +
                   " velocities, " + std::to_string(state.s.size()) + " own states, " + std::to_string(state.z.size()) +
                   " remembered numbers and " + std::to_string(state.modes.size()) +
                   " links does not fit a system of " + std::to_string(n_slots()) + " moving bodies, " +
                   std::to_string(n_states_) + " own states, " + std::to_string(n_memory_) +
                   " remembered numbers and " + std::to_string(links) +
                   " links; begin from System::start() once the system is complete");
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
  return state;
}

}  // namespace lockstep
