// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/system.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include <lockstep/author/force.h>
#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

template <class Item>
const std::string& name_in(const Item& item) {
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
  for (const auto& item : range) names.push_back(name_in(item));
  return names;
}

void check_pose(const std::string& what, const Pose& pose) {
  if (!pose.x.allFinite() || !pose.q.coefficients().allFinite())
    throw ModelError(what + ": its pose is not finite; give numbers");
  if (std::abs(norm2(pose.q) - 1.0) > 1e-9)
    throw ModelError(what + ": its quaternion has length " + text::brief(std::sqrt(norm2(pose.q))) + "; normalise it");
}

std::uint32_t hash_of(std::string_view name) {
  const std::uint64_t h = std::hash<std::string_view>{}(name);
  return static_cast<std::uint32_t>(h ^ h >> 32);
}

// The place at which a name of this hash is looked for first, of so many.
std::size_t place_of(std::uint32_t hash, std::size_t places) {
  return static_cast<std::size_t>(std::uint64_t{hash} * places >> 32);
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
  ground_ = &place_body("ground", {});
  ground_->fixed = true;
}
System::~System() = default;
System::System(System&&) noexcept = default;
System& System::operator=(System&&) noexcept = default;

// --------------------------------------------------------------------------------------------------------------- names

std::string_view System::word_of(Kind kind) {
  constexpr std::array kWords{"thing", "body", "marker", "joint", "force", "control input"};
  return kWords[static_cast<std::size_t>(kind)];
}

const std::string& System::name_of(const Named& n) const {
  const Kind kind = static_cast<Kind>(n.kind);
  if (kind == Kind::body) return bodies_[n.number].name;
  if (kind == Kind::marker) return markers_[n.number].name;
  if (kind == Kind::link) return links_[n.number]->name();
  return kind == Kind::input ? inputs_[n.number].name() : forces_[n.number]->name();
}

// The new name of renamed things is not known here.
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
    for (const Named& n : std::exchange(names_, std::vector<Named>(16 + names_.size() * 3 / 2)))
      if (n.kind != 0) put(n);
  }
  Named n;
  n.hash = hash_of(name), n.kind = static_cast<std::uint32_t>(kind) & 7U;
  n.number = static_cast<std::uint32_t>(number) & 0x1fffffffU;
  put(n);
  ++n_names_;
}

// Finds a thing that was renamed.
template <class Things>
auto& System::find(const char* kind, Kind of, Things& things, const std::string& name) const {
  if (const Named known = named_thing(name); static_cast<Kind>(known.kind) == of) return things[known.number];
  for (auto& thing : things)
    if (name_in(thing) == name) return thing;
  throw ModelError(std::string("unknown ") + kind + " \"" + name + "\"" + text::suggestion(name, names_of(things)));
}

void System::check_new_name(const std::string& kind, const std::string& name) const {
  if (name.empty()) throw ModelError("a " + kind + " without a name; give it one");
  if (!run_.expired() && (kind == "body" || kind == "joint"))
    throw ModelError({.thing = {.kind = kind, .name = name},
                      .problem = "the run of its system has begun",
                      .advice = "add it before the run, or build the system again"});
  const Named taken = named_thing(name);
  if (taken.kind == 0) return;
  throw ModelError({.thing = {.kind = kind, .name = name},
                    .problem = "this name is already taken by a " + std::string(word_of(static_cast<Kind>(taken.kind))),
                    .advice = "names are unique in a system: choose another"});
}

// Its name was checked.
Body& System::place_body(const std::string& name, const Pose& home) {
  check_pose("body '" + name + "'", home);
  ready_ = false;
  Body& b = bodies_.emplace_back();
  b.name = name, b.home = home;
  take_name(name, Kind::body, bodies_.size() - 1);
  return b;
}

Body& System::add_body(const std::string& name, const MassProperties& mass, const Pose& home) {
  check_new_name("body", name);
  check_mass(mass, "body '" + name + "'");
  Body& b = place_body(name, home);
  b.mass = mass;
  return b;
}

Body& System::add_particle(const std::string& name, double mass, const Vec3& x) {
  check_new_name("body", name);
  if (!(mass > 0) || !std::isfinite(mass))
    throw ModelError("body '" + name + "': mass " + text::brief(mass) + " kg; a particle needs a mass above zero");
  Body& b = place_body(name, {x, {}});
  b.mass.mass = mass, b.freedoms = Freedoms::particle;
  return b;
}

Body& System::add_fixed(const std::string& name, const Pose& home) {
  check_new_name("body", name);
  Body& b = place_body(name, home);
  b.fixed = true;
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
  if (!link) throw ModelError("add: no joint was given; make one first");
  check_new_name("joint", link->name());
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

// A state that a channel needs; a run has those of its start.
[[noreturn]] static void refuse_late_state(const std::string& name) {
  throw ModelError({.thing = {.kind = "integrated state", .name = name},
                    .problem = "the run of its system has begun",
                    .advice = "record what needs it before the run"});
}

Auxiliary& System::add(std::unique_ptr<Auxiliary> auxiliary) {
  if (!auxiliary) throw ModelError("add: no auxiliary was given; make one first");
  if (!run_.expired()) refuse_late_state(auxiliary->name());
  ready_ = false;
  return *auxiliaries_.emplace_back(std::move(auxiliary));
}

CountedAngle& System::count(std::unique_ptr<CountedAngle> angle) {
  if (!angle) throw ModelError("count: no angle was given; make one first");
  if (const auto known = angle_of_.find(angle->name()); known != angle_of_.end()) return *known->second;
  if (!run_.expired()) refuse_late_state(angle->name());
  angle_of_.emplace(angle->name(), angle.get());
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

void System::define(NamedNumbers numbers) {
  if (!numbers.table && numbers.values.size() != 1 && numbers.values.size() != 3)
    throw ModelError(fmt::format("\"{}\" has {} values; give one or three", numbers.name, numbers.values.size()));
  const auto same = std::ranges::find(defined_, numbers.name, &NamedNumbers::name);
  (same != defined_.end() ? *same : defined_.emplace_back()) = std::move(numbers);
}

ControlInput& System::add_input(const std::string& name, double value, const std::string& unit) {
  check_new_name("input", name);
  ControlInput& added = inputs_.emplace_back(name, value, unit);
  take_name(name, Kind::input, inputs_.size() - 1);
  return added;
}

ControlInput& System::input(const std::string& name) { return find("input", Kind::input, inputs_, name); }
Body& System::body(const std::string& name) { return find("body", Kind::body, bodies_, name); }
Marker& System::marker(const std::string& name) { return find("marker", Kind::marker, markers_, name); }
Lock& System::link(const std::string& name) { return *find("joint", Kind::link, links_, name); }
Force& System::force(const std::string& name) { return *find("force", Kind::force, forces_, name); }
const Body& System::body(const std::string& name) const { return find("body", Kind::body, bodies_, name); }
const Marker& System::marker(const std::string& name) const { return find("marker", Kind::marker, markers_, name); }
const Lock& System::link(const std::string& name) const { return *find("joint", Kind::link, links_, name); }
const Force& System::force(const std::string& name) const { return *find("force", Kind::force, forces_, name); }

bool System::owns(const Lock& link) const {
  const auto k = static_cast<std::size_t>(link.number());
  return link.number() >= 0 && k < links_.size() && links_[k].get() == &link;
}

bool System::merged(const Lock& link) const {
  return found_.merged.size() == links_.size() && owns(link) && found_.merged[static_cast<std::size_t>(link.number())];
}

void System::leave_out(const Lock& link, unsigned rows) {
  if (!owns(link) || rows >> link.row_count() != 0)
    throw ModelError("joint '" + link.name() + "': constraints to leave out are not its own, or it is not set up",
                     {.thing = thing_of(link)});
  left_out_.resize(links_.size(), 0U);
  left_out_[static_cast<std::size_t>(link.number())] = rows;
  ready_ = false;
}

unsigned System::left_out(const Lock& link) const {
  const auto k = static_cast<std::size_t>(link.number());
  return link.number() >= 0 && k < left_out_.size() ? left_out_[k] : 0U;
}

}  // namespace lockstep
