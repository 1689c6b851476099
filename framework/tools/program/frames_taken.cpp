// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/frames_taken.h"

#include <algorithm>
#include <initializer_list>
#include <map>

#include "framework/description/scene/tree.h"

namespace lockstep {

namespace {

// visit(name, object) for the named objects of a list of the scene.
template <class Visit>
void for_each_named(const Scene& scene, const char* list, Visit&& visit) {
  const Value* items = scene.root.find(list);
  if (items == nullptr || items->list() == nullptr) return;
  for (const Value& item : *items->list())
    if (const std::string* name = text_under(item, "name")) visit(*name, item);
}

bool has_any(const Value& object, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return object.find(key) != nullptr; });
}

}  // namespace

std::vector<std::string> frames_taken(const Scene& scene) {
  std::vector<std::string> lines;
  std::map<std::string, const Value*> bodies;
  for_each_named(scene, "bodies", [&](const std::string& name, const Value& body) {
    bodies[name] = &body;
    if (!has_any(body, {"position", "rod"})) lines.push_back("body '" + name + "' starts at the world's origin");
  });
  for_each_named(scene, "markers", [&](const std::string& name, const Value& marker) {
    if (has_any(marker, {"at", "world_at"})) return;
    const std::string* body = text_under(marker, "body");
    const std::string carrier = body != nullptr ? *body : "its body";
    const auto on = [&](const char* key) { return bodies.contains(carrier) && bodies[carrier]->find(key) != nullptr; };
    const bool in_world = marker.find("world_orientation") != nullptr || carrier == "ground";
    if (!in_world && on("particle")) return;  // a point has no other place
    lines.push_back("marker '" + name + "' is at the origin of " + (in_world ? "the world" : "'" + carrier + "'") +
                    (!in_world && on("rod") ? ", the centre of its rod" : ""));
  });
  return lines;
}

}  // namespace lockstep
