// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/outline.h"

#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>

#include <lockstep/author/force.h>
#include <lockstep/system.h>

namespace lockstep::report {
namespace {

using Json = nlohmann::ordered_json;

Json of(const Vec3& v) { return {v[0], v[1], v[2]}; }
Json of(const Pose& p) { return {p.x[0], p.x[1], p.x[2], p.q.w, p.q.x, p.q.y, p.q.z}; }

// Numbers of the things of one kind, by address.
template <class T>
using Numbering = std::unordered_map<const T*, std::size_t>;
template <class T>
Numbering<T> numbering_of(const std::deque<T>& things) {
  Numbering<T> numbers;
  for (const T& thing : things) numbers.emplace(&thing, numbers.size());
  return numbers;
}

constexpr const char* kWords[] = {"box", "cylinder", "sphere", "mesh"};  // of the kinds of solids

/// Solids and looks by the names of their bodies.
struct Shown {
  std::unordered_map<std::string, Json> solids, looks;
  Shown(const std::vector<Solid>& all, const std::vector<Look>& seen, Meshes& meshes) {
    for (const Solid& s : all) {
      const bool has_mesh = s.mesh != nullptr && !s.mesh->triangles.empty() && !s.mesh->points.empty();
      if (s.kind == Solid::Kind::mesh && !has_mesh) continue;
      Json json{{"kind", kWords[static_cast<std::size_t>(s.kind)]}, {"size", of(s.size)}, {"at", of(s.at)}};
      if (s.kind == Solid::Kind::mesh) json["mesh"] = meshes.number(s.mesh);
      solids.try_emplace(s.body, Json::array()).first->second.push_back(std::move(json));
    }
    for (const Look& look : seen) looks[look.body] = {{"color", look.color}, {"opacity", look.opacity}};
  }
};

Json body_of(const Body& body, const Shown& shown) {
  const auto solids = shown.solids.find(body.name);
  Json json{{"name", body.name},
            {"fixed", body.fixed},
            {"home", of(body.home)},
            {"solids", solids != shown.solids.end() ? solids->second : Json::array()}};
  if (const auto look = shown.looks.find(body.name); look != shown.looks.end()) json["look"] = look->second;
  if (body.fixed) return json;
  const Mat3& J = body.mass.J;
  json["mass"] = body.mass.mass;
  json["center"] = of(body.mass.center);
  json["particle"] = body.freedoms == Freedoms::particle;
  json["inertia"] = {J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(1, 2), J(2, 0)};
  return json;
}

Json link_of(const Lock& link, const System& system, const Numbering<Marker>& marker, const Frames& frames) {
  Json json{{"name", link.name()}, {"type", link.type()}};
  Json& pairs = json["pairs"] = Json::array();
  for (const auto& [p, s] : link.pairs()) pairs.push_back(Json::array({marker.at(p), marker.at(s)}));
  if (const Jointed* joint = link.jointed()) {
    json["mask"] = to_string(joint->mask());
    Json& drives = json["drives"] = Json::array();
    for (const Drive& drive : joint->imposed().drives) drives.push_back(to_string(drive.axis));
  }
  if (link.unilateral()) json["one_sided"] = link.unilateral()->below ? "rope" : "push";
  if (system.merged(link)) json["merged"] = true;
  json.update(drawing_of(link, frames.path_range(link.number())));
  return json;
}

Json force_of(const Force& force, const Numbering<Marker>& marker) {
  Json json{{"name", force.name()}, {"type", force.type()}};
  Json& markers = json["markers"] = Json::array();
  for (const Marker* m : force.markers()) markers.push_back(marker.at(m));
  return json;
}

}  // namespace

Json outline_of(const Frames& frames, const std::vector<Solid>& solids, const std::vector<Look>& looks,
                Meshes& meshes) {
  const System& system = frames.system();
  const Numbering<Body> body = numbering_of(system.bodies());
  const Numbering<Marker> marker = numbering_of(system.markers());
  Json json{{"gravity", of(system.gravity())}, {"plane", system.plane().n}, {"length", system.length()}};
  for (const char* list : {"bodies", "markers", "links", "forces", "loads", "moving", "moved_markers"})
    json[list] = Json::array();
  const Shown shown(solids, looks, meshes);
  for (const Body& b : system.bodies()) json["bodies"].push_back(body_of(b, shown));
  for (const Marker& m : system.markers())
    json["markers"].push_back({{"name", m.name}, {"body", body.at(m.body)}, {"at", of(m.local)}});
  for (const auto& link : system.links()) json["links"].push_back(link_of(*link, system, marker, frames));
  for (const auto& force : system.forces()) json["forces"].push_back(force_of(*force, marker));
  for (const Load& load : frames.loads())
    json["loads"].push_back({{"name", load.link ? load.link->name() : load.force->name()},
                             {"reaction", load.link != nullptr},
                             {"marker", marker.at(load.at)}});
  for (const Body* b : frames.bodies()) json["moving"].push_back(body.at(b));
  for (const Marker* m : frames.markers()) json["moved_markers"].push_back(marker.at(m));
  return json;
}

}  // namespace lockstep::report
