// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/system/coordinate_names.h"

#include <algorithm>
#include <string>
#include <string_view>

#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

// In a name and its help, '?' stands for each of the three axes, or of the four components of a quaternion, and '+' for the
// next axis.
struct Rule {
  CoordinateOwner owner;
  std::string_view name;
  Coordinate::Kind kind;
  int order;
  std::string_view help;
};
using Kind = Coordinate::Kind;
using enum CoordinateOwner;
constexpr Rule kRules[] = {
    {joint, "?", Kind::position, 0, "position of P relative to S, S axes, ?"},
    {joint, "v?", Kind::position, 1, "rate of the position, ?"},
    {joint, "a?", Kind::position, 2, "second rate of the position, ?"},
    {joint, "omega_?", Kind::omega, 1, "angular velocity of P relative to S, S axes, ?"},
    {joint, "?_d", Kind::position, 1, "rate of ?"},
    {joint, "?_dd", Kind::position, 2, "second rate of ?"},
    {joint, "r?", Kind::turn, 0, "rotation of P about S's ?, with its revolutions"},
    {joint, "r?_d", Kind::turn, 1, "rate of r?"},
    {joint, "r?_dd", Kind::turn, 2, "second rate of r?"},
    {joint, "angle_?", Kind::turn, 0, "rotation of P about S's ?, with its revolutions"},
    {joint, "angle_?_d", Kind::turn, 1, "rate of angle_?"},
    {joint, "angle_?_dd", Kind::turn, 2, "second rate of angle_?"},
    {frame, "?", Kind::position, 0, "position of the origin, world, ?"},
    {frame, "v?", Kind::position, 1, "velocity of the origin, world, ?"},
    {frame, "a?", Kind::position, 2, "acceleration of the origin, world, ?"},
    {frame, "omega_world_?", Kind::omega, 1, "angular velocity, world axes, ?"},
    {frame, "omega_body_?", Kind::own_omega, 1, "angular velocity, its axes, ?"},
    {frame, "alpha_world_?", Kind::omega, 2, "angular acceleration, world axes, ?"},
    {frame, "alpha_body_?", Kind::own_omega, 2, "angular acceleration, its axes, ?"},
    {frame, "q?", Kind::quaternion, 0, "quaternion to world axes, scalar first"},
    {frame, "angle_?", Kind::heading, 0, "angle about the world's ?, of the own + axis, with its revolutions"},
    {body, "center_?", Kind::position, 0, "position of the centre of mass, world, ?"},
    {body, "center_v?", Kind::position, 1, "velocity of the centre of mass, world, ?"},
    {body, "center_a?", Kind::position, 2, "acceleration of the centre of mass, world, ?"},
    {pair, "?", Kind::position, 0, "position of the origin seen from the other frame, ?"},
    {pair, "v?", Kind::position, 1, "rate of the position, ?"},
    {pair, "a?", Kind::position, 2, "second rate of the position, ?"},
    {pair, "omega_?", Kind::omega, 1, "angular velocity relative to the other frame, its axes, ?"},
    {pair, "distance", Kind::distance, 0, "distance between the two origins"},
    {pair, "distance_d", Kind::distance, 1, "rate of the distance; 0 if the origins meet"},
    {pair, "q?", Kind::quaternion, 0, "quaternion to the axes of the other frame, scalar first"},
    {pair, "angle_?", Kind::heading, 0, "angle about the ? axis of the other frame, with its revolutions"}};

constexpr const char* kCanRead =
    "formulas of forces read coordinates and rates of joints (crank.rz, crank.rz_d), and motions of bodies and markers "
    "(P.x, P.vx, P.distance@Q)";

std::string for_axis(std::string_view text, Kind kind, int axis) {
  std::string named(text);
  std::ranges::replace(named, '?', kind == Kind::quaternion ? "wxyz"[axis] : "xyz"[axis]);
  std::ranges::replace(named, '+', "xyz"[(axis + 1) % 3]);
  return named;
}

// Of a lower order than accelerations; null if there is none.
std::shared_ptr<Coordinate> coordinate_of(CoordinateOwner owner, std::string_view name, const BodyOrMarker& m,
                                          const BodyOrMarker& n) {
  for (const NamedCoordinate& c : coordinates_of(owner))
    if (c.name == name && c.of.order < 2) return std::make_shared<Coordinate>(c.of, m, n);
  return nullptr;
}

// Why a formula of a force cannot read this: of nothing, found by solving for it, or misspelt. `known`: of the object that
// it names; none if there is no such object.
[[noreturn]] void refuse_name(const System& system, const std::string& name,
                              const std::vector<NamedCoordinate>& known) {
  const std::size_t at = std::min(name.find('@'), name.size()), dot = name.rfind('.', at);
  const std::string word = name.substr(dot + 1, at - dot - 1), quoted = "\"" + name + "\"";
  bool is_solved = false;
  for (const char* part : {"force", "torque", "drive"}) is_solved = is_solved || word.find(part) != std::string::npos;
  std::vector<std::string> names;
  for (const NamedCoordinate& c : known)
    c.of.order > 1 ? void(is_solved = is_solved || c.name == word) : names.push_back(c.name);
  if (is_solved)
    throw ModelError(quoted + " depends on what this formula gives, as forces and accelerations do; " + kCanRead);
  if (!known.empty())
    throw ModelError(quoted + ": there is no coordinate \"" + word + "\"" + text::suggestion(word, names) + "; " +
                     kCanRead);
  for (const Body& b : system.bodies()) names.push_back(b.name);
  for (const Marker& m : system.markers()) names.push_back(m.name);
  for (const auto& l : system.links()) names.push_back(l->name());
  const std::string first = name.substr(0, dot);
  const std::string missing = at < name.size() && frame_named(system, first) ? name.substr(at + 1) : first;
  throw ModelError(quoted + " is no parameter or table, and no body, marker or joint is called \"" + missing + "\"" +
                   text::suggestion(missing, names));
}

}  // namespace

std::vector<NamedCoordinate> coordinates_of(CoordinateOwner owner) {
  std::vector<NamedCoordinate> all;
  for (const Rule& r : kRules)
    for (int axis = 0, n = r.name.find('?') == std::string_view::npos ? 1
                           : r.kind == Kind::quaternion               ? 4
                                                                      : 3;
         r.owner == owner && axis < n; ++axis)
      all.push_back({for_axis(r.name, r.kind, axis), for_axis(r.help, r.kind, axis), {r.kind, axis, r.order}});
  return all;
}

std::optional<BodyOrMarker> frame_named(const System& system, std::string_view name) {
  for (const Body& b : system.bodies())
    if (b.name == name) return BodyOrMarker{&b, nullptr};
  for (const Marker& m : system.markers())
    if (m.name == name) return BodyOrMarker{m.body, &m};
  return std::nullopt;
}

std::shared_ptr<Coordinate> coordinate_named(const System& system, const std::string& name) {
  constexpr BodyOrMarker kWorld;
  const std::size_t at = name.find('@');
  const bool of_pair = at != std::string::npos;
  const std::string_view left = std::string_view(name).substr(0, at);
  for (std::size_t dot = left.rfind('.'); dot != std::string::npos && dot > 0; dot = left.rfind('.', dot - 1)) {
    const std::string_view owner = left.substr(0, dot), word = left.substr(dot + 1);
    const std::optional<BodyOrMarker> m = frame_named(system, owner);
    const std::optional<BodyOrMarker> n = of_pair ? frame_named(system, std::string_view(name).substr(at + 1)) : kWorld;
    std::shared_ptr<Coordinate> found = m && n ? coordinate_of(of_pair ? pair : frame, word, *m, *n) : nullptr;
    if (m && !found && !of_pair && m->marker == nullptr && !m->body->fixed)
      found = coordinate_of(body, word, {m->body, nullptr, true}, kWorld);
    for (const auto& link : system.links())
      if (!of_pair && link->name() == owner && !link->pairs().empty()) {
        const auto [p, s] = link->pairs().front();
        found = coordinate_of(joint, word, {p->body, p}, {s->body, s});
      }
    if (found) return found;
    const bool is_joint =
        std::ranges::any_of(system.links(), [&](const auto& link) { return !of_pair && link->name() == owner; });
    if (is_joint || (m && n)) refuse_name(system, name, coordinates_of(is_joint ? joint : of_pair ? pair : frame));
  }
  refuse_name(system, name, {});
}

}  // namespace lockstep
