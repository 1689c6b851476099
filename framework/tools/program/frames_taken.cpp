// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/frames_taken.h"

#include <algorithm>
#include <initializer_list>
#include <map>

#include "framework/description/scene/tree.h"

namespace lockstep {
namespace {

bool has_any(const Value& object, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return object.find(key) != nullptr; });
}

}  // namespace

std::vector<std::string> frames_taken(const Scene& scene) {
  std::vector<std::string> lines;
  std::map<std::string, const Value*> bodies;
  for (const Value& body : items(scene.root, "bodies")) {
    const std::string* name = text_under(body, "name");
    if (name == nullptr) continue;
    bodies[*name] = &body;
    if (!has_any(body, {"position", "rod"})) lines.push_back("body '" + *name + "' starts at the world's origin");
  }
  for (const Value& marker : items(scene.root, "markers")) {
    const std::string* name = text_under(marker, "name");
    if (name == nullptr || has_any(marker, {"at", "world_at"})) continue;
    const std::string* body = text_under(marker, "body");
    const std::string carrier = body != nullptr ? *body : "its body";
    const auto on = [&](const char* key) { return bodies.contains(carrier) && bodies[carrier]->find(key) != nullptr; };
    const bool in_world = marker.find("world_orientation") != nullptr || carrier == "ground";
    if (!in_world && on("particle")) continue;  // a point has no other place
    lines.push_back("marker '" + *name + "' is at the origin of " + (in_world ? "the world" : "'" + carrier + "'") +
                    (!in_world && on("rod") ? ", the centre of its rod" : ""));
  }
  return lines;
}

}  // namespace lockstep
