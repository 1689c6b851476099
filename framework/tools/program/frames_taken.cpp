#include "framework/tools/program/frames_taken.h"

#include <algorithm>
#include <initializer_list>

namespace lockstep {

namespace {

// visit(name, object) for the named objects of a list of the scene.
template <class Visit>
void for_each_named(const Scene& scene, const char* list, Visit&& visit) {
  const Value* items = scene.root.find(list);
  if (items == nullptr || items->list() == nullptr) return;
  for (const Value& item : *items->list())
    if (const Value* name = item.find("name"); name != nullptr && name->text() != nullptr) visit(*name->text(), item);
}

bool has_any(const Value& object, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return object.find(key) != nullptr; });
}

}  // namespace

std::vector<std::string> frames_taken(const Scene& scene) {
  std::vector<std::string> lines;
  for_each_named(scene, "bodies", [&](const std::string& name, const Value& body) {
    if (!has_any(body, {"position", "rod"})) lines.push_back("body '" + name + "' starts at the world's origin");
  });
  for_each_named(scene, "markers", [&](const std::string& name, const Value& marker) {
    if (has_any(marker, {"at", "world_at"})) return;
    const Value* body = marker.find("body");
    const std::string carrier = body != nullptr && body->text() != nullptr ? *body->text() : "its body";
    lines.push_back(
        "marker '" + name + "' is at the origin of " +
        (marker.find("world_orientation") != nullptr || carrier == "ground" ? "the world" : "'" + carrier + "'"));
  });
  return lines;
}

}  // namespace lockstep
