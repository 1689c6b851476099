// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <lockstep/body.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

void put(Value& object, const std::string& key, const Vec3& v) { put(object, key, Value::list({v[0], v[1], v[2]})); }
void put(Value& object, const std::string& key, const Quat& q) { put(object, key, Value::list({q.w, q.x, q.y, q.z})); }

class Mover {
 public:
  Mover(Value& scene, const Pose& by) : scene_(scene), by_(by), turns_(by.q.w != 1), turn_(rotation(by.q)) {}

  void move() {
    for (const Value::Member& m : members(scene_, "points")) point(*member(scene_, "points"), m.key, "scene, points");
    for (Value& v : items(scene_, "bodies"))
      if (is_free_particle(v)) particles_.insert(text_of(v, "name"));
    each("markers", [&](Value& v, const std::string& owner) {
      markers_.insert(text_of(v, "name"));
      if (is_on_particle(v)) on_particles_.insert(text_of(v, "name"));
      marker(v, owner);
    });
    each("bodies", [&](Value& v, const std::string& owner) { body(v, owner); });
    each("links", [&](Value& v, const std::string& owner) { attached(v, owner); });
    each("forces", [&](Value& v, const std::string& owner) { force(v, owner); });
  }

 private:
  template <class Move>
  void each(const std::string& list, Move&& move) {
    const auto* kind = std::ranges::find(kThings, list, [](const auto& t) { return t.first; })->second;
    for (std::size_t i = 0; Value & object : items(scene_, list)) {
      const std::string owner = owner_of(kind, object, list, i++);
      if (object.object() != nullptr) move(object, owner);
    }
  }

  // -- values under a key, moved where they are given
  void point(Value& object, const std::string& key, const std::string& owner) {
    if (const Value* v = member(object, key))
      put(object, key, Vec3(by_.x + turn_ * read_vector3(*v, Unit::length, part_of(owner, key))));
  }
  void point_or_origin(Value& object, const std::string& key, const std::string& owner) {
    if (member(object, key) == nullptr) return put(object, key, by_.x);
    point(object, key, owner);
  }
  void direction(Value& object, const std::string& key, Unit unit, const std::string& owner) {
    const Value* v = member(object, key);
    if (v != nullptr && turns_) put(object, key, Vec3(turn_ * read_vector3(*v, unit, part_of(owner, key))));
  }
  void orientation(Value& object, const std::string& owner, const std::string& key = "orientation") {
    if (!turns_) return;
    const Value* v = member(object, key);
    put(object, key, v != nullptr ? by_.q * read_orientation(*v, part_of(owner, key)) : by_.q);
  }

  // -- particles: their frames keep the world's axes, so values in "body" axes are rotated too
  static bool is_free_particle(Value& body) {
    const Value* fixed = member(body, "fixed");
    return member(body, "particle") != nullptr &&
           (fixed == nullptr || fixed->boolean() == nullptr || !*fixed->boolean());
  }
  bool is_on_particle(Value& marker) const { return particles_.contains(text_of(marker, "body")); }

  // -- things
  void body(Value& v, const std::string& owner) {
    if (Value* rod = member(v, "rod"); rod != nullptr && rod->object() != nullptr) {
      this->rod(*rod, owner);
    } else {
      point_or_origin(v, "position", owner);
      if (!is_free_particle(v)) orientation(v, owner);
    }
    direction(v, "velocity", Unit::speed, owner);
    direction(v, "omega_world", Unit::angular_speed, owner);
  }

  // A rod's ends define the roll of its frame (z as near to the world's as possible); the further rotation of the moved
  // rod about its axis is its "roll".
  void rod(Value& rod, const std::string& owner) {
    const Value *from = member(rod, "from"), *to = member(rod, "to");
    if (from == nullptr || to == nullptr) return;  // refused when it is built
    const std::string part = part_of(owner, "rod");
    const Vec3 a = read_vector3(*from, Unit::length, part_of(part, "from")),
               b = read_vector3(*to, Unit::length, part_of(part, "to"));
    if (!((b - a).norm() > 0)) return;
    const Vec3 moved_a = by_.x + turn_ * a, moved_b = by_.x + turn_ * b;
    const Quat wanted = by_.q * shapes::slender_rod(1, a, b, 1).home.q,
               by_ends = shapes::slender_rod(1, moved_a, moved_b, 1).home.q,
               beyond = conjugate(by_ends) * wanted;  // about x
    put(rod, "from", moved_a), put(rod, "to", moved_b);
    if (std::hypot(beyond.x, beyond.y, beyond.z) < 1e-12) return;
    const Value* roll = member(rod, "roll");
    const double before = roll != nullptr ? read_number(*roll, Unit::angle, part_of(part, "roll")) : 0;
    put(rod, "roll", std::remainder(before + 2 * std::atan2(beyond.x, beyond.w), 2 * kPi));
  }

  void marker(Value& v, const std::string& owner) {
    if (member(v, "world_at") != nullptr || member(v, "world_orientation") != nullptr) {
      point_or_origin(v, "world_at", owner), orientation(v, owner, "world_orientation");
    } else if (text_of(v, "body") == "ground") {
      point_or_origin(v, "at", owner), orientation(v, owner);
    } else if (is_on_particle(v)) {
      direction(v, "at", Unit::length, owner), orientation(v, owner);
    }
  }

  void attached(Value& v, const std::string& owner) {
    for_each_placing(v, owner, [&](Value& placing, const std::string& its) { places(placing, its); });
  }
  // New markers on bodies have the world's axes if none are given, and the axes of the other side if that is a marker.
  void places(Value& v, const std::string& owner) {
    if (v.object() == nullptr) return;
    for (const char* key : {"at", "at_p", "at_s"}) point(v, key, owner);
    if (!turns_) return;
    if (const Value* axis = member(v, "axis"); axis != nullptr && member(v, "orientation") == nullptr) {
      const Quat at_home = pose_at(Vec3::Zero(), read_axis(*axis, part_of(owner, "axis"))).q;  // with its x and y
      v = v.without({"axis"});
      return put(v, "orientation", by_.q * at_home);
    }
    const std::string p = text_of(v, "p"), s = text_of(v, "s");
    const bool on_bodies = !p.empty() && !markers_.contains(p) && (s.empty() || !markers_.contains(s));
    if (on_bodies || member(v, "orientation") != nullptr) orientation(v, owner);
  }

  void force(Value& v, const std::string& owner) {
    attached(v, owner);
    const std::string type = text_of(v, "type"), axes = text_of(v, "axes"), p = text_of(v, "p");
    const bool in_world =
        axes.empty() || axes == "world" || (axes == "body" && (particles_.contains(p) || on_particles_.contains(p)));
    if (!turns_ || (type != "applied_force" && type != "applied_torque") || !in_world) return;
    if (const Value* laws = member(v, "laws"))
      refuse(laws->where, part_of(owner, "laws"),
             "laws in world axes cannot be rotated with the included scene; give \"axes\": \"marker\", or "
             "\"direction\" and \"law\"");
    direction(v, type == "applied_force" ? "force" : "torque", Unit::any, owner);
    if (const Value* axis = member(v, "direction"))
      put(v, "direction", Vec3(turn_ * read_axis(*axis, part_of(owner, "direction"))));
  }

  Value& scene_;
  const Pose by_;
  const bool turns_;
  const Mat3 turn_;
  std::set<std::string> markers_, particles_, on_particles_;
};

}  // namespace

void move_scene(Value& scene, const Pose& by) { Mover(scene, by).move(); }

}  // namespace lockstep
