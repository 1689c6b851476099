// SPDX-License-Identifier: BSD-3-Clause
// The attachments of joints and forces; joints with their drives, laws and start speeds.

#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/description/registry/law_units.h"
#include "framework/description/scene/builder.h"
#include "framework/description/scene/split.h"
#include "framework/description/scene/tree.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/system/coordinate_names.h"

namespace lockstep {
namespace {

const std::vector<std::string> kPlaces = {"at", "at_p", "at_s", "axis", "orientation"};

// A free coordinate of a joint; another one is an error.
Axis free_axis(const Params& of, const Key& key, const Lock& link) {
  const Jointed* joint = link.jointed();
  if (joint == nullptr)
    of.refuse(key.name, "a joint of type \"" + std::string(link.type()) + "\" has no such coordinate; remove it");
  const Axis axis = axis_from(key.name);
  if (includes(joint->rows(), row_of(axis)))
    of.refuse(key.name, "the joint constrains or drives this coordinate; name a free one");
  return axis;
}

// Origin of the new marker for side "p" or "s"; false when it is not given.
bool origin_of(const Params& p, const std::string& key, const Body& body, Vec3& x) {
  const std::string own = "at_" + key;
  if (p.has("at") && p.has(own)) p.refuse(own, "\"at\" places both markers; remove one of the two");
  if (p.has("at") || p.has(own)) {
    x = p.vector3(p.has("at") ? "at" : own);
  } else if (body.freedoms == Freedoms::particle) {
    x = body.home.x;
  } else {
    return false;
  }
  return true;
}

Quat axes_of(const Params& p) {
  if (p.has("axis") && p.has("orientation"))
    p.refuse("orientation", "\"axis\" is given as well; remove one of the two");
  if (p.has("axis")) return pose_at(Vec3::Zero(), p.vector3("axis")).q;
  return p.has("orientation") ? p.orientation("orientation") : Quat{};
}

// A gear or belt between two rotations of which one is constrained constrains the other: of a pair that is the markers of
// a joint, its mask decides. Laws that impose the rotation, or rotate a marker, allow it.
void warn_of_held_turns(const Params& p, const std::string& type, const System& system) {
  if ((type != "gear" && type != "belt") || !p.has("pairs")) return;
  const Value::List& items = *p.value("pairs").list();
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string* word = items[i].text();
    if (word == nullptr) continue;
    const Lock& link = system.link(*word);
    const Jointed* joint = link.jointed();
    if (joint == nullptr || !includes(joint->mask(), row_of(Axis::rz)) || joint->turned()) continue;
    const auto [P, S] = link.pairs().front();
    if (P->rotation_law != nullptr || S->rotation_law != nullptr) continue;
    Finding f{&finding::held_turn, "joint '" + *word + "'",
              part_of(p.owner(), "pairs[" + std::to_string(i) + "]") + ": joint '" + *word + "' (" +
                  std::string(link.type()) + ") does not rotate about its z axis, so the " + type +
                  " locks the other pair too",
              "name a joint that rotates about z"};
    f.place = items[i].where.text();
    report_finding(f);
  }
}

}  // namespace

void Builder::check_side(const Value& word, const std::string& context) const {
  const std::string& name = *word.text();
  if (name == "ground" || is_taken("marker", name) || is_taken("body", name)) return;
  refuse(word.where, context,
         "unknown marker or body \"" + name + "\"" + text::suggestion(name, names({"marker", "body"})),
         {.value = name});
}

// The sides of a failed joint, whose error may have another cause.
void Builder::note_sides(const Value& object, const std::string& owner) {
  for (const char* key : {"p", "s"})
    if (const Value* word = object.find(key); word != nullptr && word->text() != nullptr)
      errors_.attempt(*word, [&] { check_side(*word, part_of(owner, key)); });
}

// The marker that the key names, or a new one on the body that it names. `other` is the home pose of the marker on the
// other side, if it exists already, and the default of the new one.
Marker* Builder::side(const Params& p, const std::string& key, const std::string& name, const Pose* other) {
  const std::string word = p.text(key);
  if (is_taken("marker", word)) return &system_.marker(word);
  check_side(p.value(key), part_of(p.owner(), key));
  Body& body = system_.body(word);
  Pose world{Vec3::Zero(), axes_of(p)};
  if (!origin_of(p, key, body, world.x)) {
    if (other == nullptr)
      p.refuse(key,
               "\"" + word + "\" is a body without a given point; add \"at\": [x, y, z] (world), or name a marker");
    world.x = other->x;
  }
  if (other != nullptr && !p.has("axis") && !p.has("orientation")) world.q = other->q;
  return &system_.add_marker_at(name + (key == "p" ? ".P" : ".S"), body, world);
}

Attachment Builder::attachment(const Params& p, const std::string& name, bool both) {
  Attachment attachment{name, {}};
  if (!p.has("p") && !p.has("s")) {
    for (const std::string& key : kPlaces)
      if (p.has(key)) p.refuse(key, "it places a marker, but neither \"p\" nor \"s\" names a body; add \"p\"");
    return attachment;
  }
  if (!p.has("p")) p.refuse("s", "\"s\" is given without \"p\"; name the first marker or body \"p\"");
  const bool marker_p = is_taken("marker", p.text("p")), marker_s = p.has("s") && is_taken("marker", p.text("s"));
  if (marker_p && (marker_s || !p.has("s")))
    for (const std::string& key : kPlaces)
      if (p.has(key)) p.refuse(key, "the named markers have a pose already; remove it, or name bodies instead");
  const auto home = [](const Marker& m) { return m.body->home * m.local; };
  Pose at_marker;
  Marker *P = nullptr, *S = nullptr;
  if (marker_s) S = side(p, "s", name, nullptr), at_marker = home(*S);
  P = side(p, "p", name, marker_s && !marker_p ? &at_marker : nullptr);
  at_marker = home(*P);
  if (p.has("s") && S == nullptr) S = side(p, "s", name, &at_marker);
  if (S != nullptr && P->body == S->body)
    p.refuse("s", "both sides are on body '" + P->body->name + "'; name another body for \"p\" or \"s\"");
  if (both && P->body->fixed && S->body->fixed)
    p.refuse("s", "bodies '" + P->body->name + "' and '" + S->body->name +
                      "' are both fixed, so the joint has no effect; remove it");
  attachment.pairs.emplace_back(P, S);
  return attachment;
}

// The pairs of a coupling: each is the markers of an existing joint, or two new ones.
Attachment Builder::pairs(const Params& p, const std::string& name) {
  for (const char* key : {"p", "s"})
    if (p.has(key)) p.refuse(key, "\"pairs\" is given as well; remove one of the two");
  for (const std::string& key : kPlaces)
    if (p.has(key)) p.refuse(key, "it belongs inside the pairs; move it there");
  const Value::List* items = p.value("pairs").list();
  if (items == nullptr || items->empty())
    p.refuse("pairs", "expected a list of joint names and of objects, got " + shown(p.value("pairs")));
  Attachment all{name, {}};
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Value& item = (*items)[i];
    const std::string place = part_of(p.owner(), "pairs[" + std::to_string(i) + "]");
    if (const std::string* word = item.text()) {
      if (*word == name || !is_taken("link", *word)) {  // its own name is taken, but the link does not exist yet
        std::vector<std::string> known = names({"link"});
        std::erase(known, name);
        refuse(
            item.where, place,
            "unknown joint \"" + *word + "\"" + text::suggestion(*word, known) + "; a coupling comes after its joints");
      }
      const auto its = system_.link(*word).pairs();
      if (its.empty()) refuse(item.where, place, "joint \"" + *word + "\" has no markers; name a pair of markers");
      const auto [P, S] = its.front();
      all.pairs.emplace_back(&system_.marker(P->name), &system_.marker(S->name));
    } else {
      const Params own = params_of(item, "pair", place, nullptr);
      for (const char* key : {"p", "s"})
        if (!own.has(key)) refuse(item.where, place, "missing key \"" + std::string(key) + "\"; a pair has both sides");
      all.pairs.push_back(attachment(own, name + "." + std::to_string(i + 1), false).pairs.front());
    }
  }
  return all;
}

void Builder::link(const Value& object, const std::string& owner) {
  const Split parts =
      placed(object.where, [&] { return split(object, scene_table("link"), registry_.links, owner, registry_); });
  const Params& p = parts.common;
  const std::string name = claim(p.value("name"), "link");
  if (!p.has("pairs") && !p.has("p") && !p.has("s"))
    refuse(object.where, owner,
           "missing keys: \"p\" and \"s\", the two sides of a joint, or \"pairs\" of a coupling such as a gear");
  if (!p.has("pairs"))
    for (const char* key : {"p", "s"})
      if (!p.has(key))
        refuse(object.where, owner,
               "missing key \"" + std::string(key) +
                   "\"; a joint needs both sides, a coupling such as a gear needs \"pairs\" instead");
  Attachment where;
  try {
    where = p.has("pairs") ? pairs(p, name) : attachment(p, name, true);
    where.coordinate = [this](const std::string& called) { return coordinate_named(system_, called); };
  } catch (const SceneError&) {  // the keys of its type may be wrong too
    Marker& any = system_.add_marker(unnamed(), system_.body("ground"));
    errors_.within(object, [&] { registry_.links.make_checked(parts.type, {name, {{&any, &any}}}, parts.own); });
    throw;
  }
  placed(object.where, [&] {
    std::unique_ptr<Lock> made = registry_.links.make_checked(parts.type, where, parts.own);
    if (made->pairs().size() < where.pairs.size())
      p.refuse("pairs", std::to_string(where.pairs.size()) + " pairs are given, a " + std::string(made->type()) +
                            " has " + std::to_string(made->pairs().size()) + "; remove the others");
    made->set_active_at_start(p.boolean("active"));
    unilateral(p, *made);
    Lock& added = system_.add(std::move(made));
    warn_of_held_turns(p, parts.type, system_);
    laws(p, added);
    drives(p, added);
    start_speeds(p, added);
    brought_along(p, where, added);
  });
}

void Builder::laws(const Params& p, Lock& link) {
  Jointed* joint = link.jointed();
  for (const char* key : {"move", "turn", "hold"})
    if (joint == nullptr && p.has(key))
      p.refuse(key, "a joint of type \"" + std::string(link.type()) + "\" cannot have a prescribed pose; remove it");
  if (p.has("move")) placed(p.value("move").where, [&] { joint->move(p.translation_law("move")); });
  if (p.has("turn")) placed(p.value("turn").where, [&] { joint->turn(p.rotation_law("turn")); });
  if (p.boolean("hold")) joint->hold();
}

// One drive, or a list of them.
void Builder::drives(const Params& p, Lock& link) {
  if (!p.has("drive")) return;
  const Value& v = p.value("drive");
  Jointed* joint = link.jointed();
  if (joint == nullptr)
    p.refuse("drive", "a joint of type \"" + std::string(link.type()) + "\" cannot have a drive; remove it");
  const std::span<const Value> items = one_or_all(v);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string place = part_of(p.owner(), "drive") + (v.list() != nullptr ? "[" + std::to_string(i) + "]" : "");
    const Params drive = params_of(items[i], "drive", place, &registry_);
    if (drive.has("law") == drive.has("speed"))
      drive.refuse(drive.has("speed") ? "speed" : "", drive.has("speed")
                                                          ? "\"law\" is given as well; remove one of the two"
                                                          : "the drive has no motion; add \"law\" or \"speed\"");
    const Axis axis = axis_from(drive.text("axis"));
    const bool held = includes(joint->mask(), row_of(axis));  // which is an error whatever its law
    for (const auto& [key, per_second] : {std::pair{"law", 0}, std::pair{"speed", 1}})
      if (drive.has(key) && !held)
        check_law_units(drive.value(key), Form::law, {is_rotation(axis) ? Unit::angle : Unit::length, per_second},
                        registry_, part_of(place, key));
    placed(drive.value("axis").where, [&] {
      if (drive.has("law")) joint->drive(axis, drive.law("law"));
      if (drive.has("speed")) joint->drive_speed(axis, drive.law("speed"));
    });
  }
}

void Builder::start_speeds(const Params& p, const Lock& link) {
  if (!p.has("start")) return;
  const Params start = params_under(p, "start", "start");
  const auto each = [&](const char* part, const char* table, auto& targets, auto... weight) {
    if (!start.has(part)) return;
    const Params of = params_under(start, part, table);
    for (const Key& key : scene_table(table).info.keys)
      if (of.has(key.name)) targets.push_back({link.name(), free_axis(of, key, link), of.number(key.name), weight...});
  };
  each("velocity", "start_velocity", out_.start_speeds);
  each("position", "start_position", out_.assembly.coordinates);
  each("near", "start_position", out_.assembly.coordinates, 1.0);
}

}  // namespace lockstep
