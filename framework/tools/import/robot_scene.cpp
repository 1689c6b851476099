// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <set>

#include <lockstep/error.h>
#include "framework/tools/import/robot.h"

namespace lockstep::urdf {
namespace {

Value quat(const Quat& q) { return Value::list({q.w, q.x, q.y, q.z}); }

/// Writes a robot as a scene.
class Writer {
 public:
  Writer(Robot& robot, bool floating, const FindMesh& find_mesh)
      : robot_(robot), floating_(floating), find_mesh_(find_mesh) {}

  Value scene() {
    name_bodies();
    Value::List bodies, links, forces;
    gather_pictures();
    for (const Part& part : robot_.parts)
      if (part.mass > 0)
        bodies.push_back(body(part));
      else if (part.body == "ground" && !shapes_[&part].empty())
        bodies.push_back(scenery(part));
    bolt(links);
    for (const Joint& joint : robot_.joints) {
      if (joint.type == "fixed" || joint.type == "floating") continue;
      const std::string name = unique(joint.name);
      links.push_back(link(joint, name));
      if (joint.damping != 0) damp(joint, name, forces);
    }
    Value all = Value::object({{"lockstep", 1},
                               {"title", robot_.name},
                               {"gravity", Value::list({0, 0, -9.81})},
                               {"merge", "auto"},
                               {"bodies", std::move(bodies)},
                               {"joints", std::move(links)}});
    if (!forces.empty()) all.object()->push_back({"forces", Value(std::move(forces)), {}});
    all.object()->push_back({"run", Value::object({{"until", "1 s"}, {"output", "10 ms"}}), {}});
    return all;
  }

 private:
  // A name of the scene: without dots, which separate the parts of a channel's name, and given once.
  std::string unique(const std::string& wanted) {
    std::string name = wanted;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '.' || c == '@' || (c >= 0 && c < ' '); }, '_');
    const std::string plain = name;
    for (int k = 2; !names_.insert(name).second; ++k) name = plain + "_" + std::to_string(k);
    if (name != wanted) robot_.left_out["names that changed"].push_back(wanted + " (" + name + ")");
    return name;
  }

  bool is_held(const Part& part) const { return part.group == robot_.parts.front().group && !floating_; }

  // The body of each link: links that fixed joints connect are one body.
  void name_bodies() {
    for (Part& part : robot_.parts) {
      if (part.mass <= 0) continue;
      part.body = unique(part.name);
      heavy_.emplace(part.group, part.body);
    }
    for (Part& part : robot_.parts) {
      if (!part.body.empty()) continue;
      if (const auto found = heavy_.find(part.group); found != heavy_.end())
        part.body = found->second;
      else if (is_held(part))
        part.body = "ground";
      else
        throw SceneError(robot_.file + ": link '" + part.name +
                             "' moves but has no mass, nor has a link fixed to it; give it an <inertial>",
                         robot_.file);
    }
  }

  Value body(const Part& part) const {
    const auto& J = part.inertia;
    Value b = Value::object(
        {{"name", part.body},
         {"mass", part.mass},
         {"center", vec(part.centre.x)},
         {"inertia",
          Value::object({{"xx", J[0]}, {"yy", J[3]}, {"zz", J[5]}, {"xy", J[1]}, {"yz", J[4]}, {"zx", J[2]}})},
         {"inertia_axes", quat(part.centre.q)},
         {"position", vec(part.place.x)},
         {"orientation", quat(part.place.q)}});
    if (is_held(part)) b.object()->push_back({"fixed", Value(true), {}});
    add_visual(part, *b.object());
    return b;
  }

  // A link of the ground, for drawing only.
  Value scenery(const Part& part) {
    Value b = Value::object({{"name", unique(part.name)},
                             {"fixed", true},
                             {"position", vec(part.place.x)},
                             {"orientation", quat(part.place.q)}});
    add_visual(part, *b.object());
    return b;
  }

  void add_visual(const Part& part, Value::Object& body) const {
    Value::Object visual;
    if (!part.color.empty()) visual.push_back({"color", Value(part.color), {}});
    const auto found = shapes_.find(&part);
    if (found != shapes_.end() && !found->second.empty()) visual.push_back({"shapes", Value(found->second), {}});
    if (!visual.empty()) body.push_back({"visual", Value(std::move(visual)), {}});
  }

  // The shapes of all links, by the link that shows them: for one without mass, the link with which it moves.
  void gather_pictures() {
    for (const Part& part : robot_.parts) {
      const Part* bearer = &part;
      if (part.mass <= 0 && part.body != "ground")
        for (const Part& other : robot_.parts)
          if (other.mass > 0 && other.body == part.body) bearer = &other;
      const Pose place = inverse(bearer->place) * part.place;
      for (const Picture& picture : part.pictures) add_picture(picture, place * picture.at, part, shapes_[bearer]);
    }
  }

  // A mesh with factors of different signs is one with the opposite factor, rotated by 180 deg.
  void add_picture(const Picture& picture, Pose at, const Part& part, Value::List& shapes) {
    Value::Object shape = picture.shape;
    if (const Vec3& scale = picture.scale; !picture.mesh.empty()) {
      const std::string file = find_mesh_ ? find_mesh_(picture.mesh) : "";
      if (file.empty()) return robot_.left_out["meshes"].push_back(part.name);
      const double factor = std::abs(scale[0]), sign = scale[0] * scale[1] * scale[2] < 0 ? -1 : 1;
      if (!(factor > 0) || std::abs(std::abs(scale[1]) - factor) > 1e-6 * factor ||
          std::abs(std::abs(scale[2]) - factor) > 1e-6 * factor)
        return robot_.left_out["meshes whose scale differs by axis"].push_back(part.name);
      shape = {{"mesh", Value(file), {}}};
      if (sign * factor != 1) shape.push_back({"scale", Value(sign * factor), {}});
      for (int k = 0; k < 3; ++k)  // the axis about which 180 deg make up for the other two
        if (sign * scale[k] > 0 && sign * scale[(k + 1) % 3] < 0) at.q = at.q * axis_angle(Vec3::Unit(k), kPi);
    }
    if (at.x.norm() > 0) shape.push_back({"at", vec(at.x), {}});
    if (std::abs(at.q.w) < 1) shape.push_back({"orientation", quat(at.q), {}});
    shapes.push_back(Value(std::move(shape)));
  }

  // Bodies of one group are bolted to the first of it.
  void bolt(Value::List& links) {
    for (const Part& part : robot_.parts) {
      if (part.mass <= 0 || is_held(part) || part.body == heavy_[part.group]) continue;
      links.push_back(Value::object({{"name", unique(part.body + "_bolted")},
                                     {"type", "fixed"},
                                     {"p", part.body},
                                     {"s", heavy_[part.group]},
                                     {"at", vec(part.place.x)}}));
    }
  }

  // Ends, place and axis of what acts at a joint.
  Value::Object at_joint(const std::string& name, const char* type, const Joint& joint) const {
    const Part& child = robot_.parts[joint.child];
    return {{"name", Value(name), {}},      {"type", Value(type), {}},
            {"p", Value(child.body), {}},   {"s", Value(robot_.parts[joint.parent].body), {}},
            {"at", vec(child.place.x), {}}, {"axis", vec(rotation(child.place.q) * joint.axis.normalized()), {}}};
  }

  Value link(const Joint& joint, const std::string& name) const {
    const char* type = joint.type == "prismatic" ? "prismatic" : joint.type == "planar" ? "plane_on_plane" : "revolute";
    Value::Object link = at_joint(name, type, joint);
    if (joint.low) {
      const char* axis = joint.type == "prismatic" ? "z" : "rz";
      const Value stop = Value::object({{"axis", axis}, {"low", *joint.low}, {"high", *joint.high}});
      link.push_back({"stops", Value(Value::List{stop}), {}});
    }
    return Value(std::move(link));
  }

  void damp(const Joint& joint, const std::string& name, Value::List& forces) {
    if (!joint.moves_along_axis()) return robot_.left_out["damping"].push_back(joint.name);
    const bool slides = joint.type == "prismatic";
    Value::Object force = at_joint(unique(name + "_damping"), slides ? "bushing" : "torsion_spring_damper", joint);
    force.push_back({"damping", slides ? Value::list({0, 0, joint.damping}) : Value(joint.damping), {}});
    forces.push_back(Value(std::move(force)));
  }

  Robot& robot_;
  bool floating_;
  const FindMesh& find_mesh_;
  std::map<std::size_t, std::string> heavy_;   // the first body of each group
  std::map<const Part*, Value::List> shapes_;  // by the link that shows them
  std::set<std::string> names_{"ground"};
};

}  // namespace

Value scene_of(Robot& robot, bool floating, const FindMesh& find_mesh) {
  return Writer(robot, floating, find_mesh).scene();
}

}  // namespace lockstep::urdf
