#include <algorithm>
#include <set>

#include <lockstep/error.h>
#include "framework/tools/import/robot.h"

namespace lockstep::urdf {
namespace {

Value vec(const Vec3& v) { return Value::list({v[0], v[1], v[2]}); }
Value quat(const Quat& q) { return Value::list({q.w, q.x, q.y, q.z}); }

/// Writes a robot as a scene.
class Writer {
 public:
  Writer(Robot& robot, bool floating) : robot_(robot), floating_(floating) {}

  Value scene() {
    name_bodies();
    Value::List bodies, links, forces;
    for (const Part& part : robot_.parts)
      if (part.mass > 0) bodies.push_back(body(part));
    bolt(links);
    for (const Joint& joint : robot_.joints) {
      if (joint.type == "fixed" || joint.type == "floating") continue;
      const std::string name = unique(joint.name);
      links.push_back(link(joint, name));
      if (joint.damping != 0) damp(joint, name, forces);
    }
    Value::Object all{{"lockstep", Value(1), {}},
                      {"title", Value(robot_.name), {}},
                      {"gravity", Value::list({0, 0, -9.81}), {}},
                      {"merge", Value("auto"), {}},
                      {"bodies", Value(std::move(bodies)), {}},
                      {"links", Value(std::move(links)), {}}};
    if (!forces.empty()) all.push_back({"forces", Value(std::move(forces)), {}});
    all.push_back({"run", Value::object({{"until", Value("1 s")}, {"output", Value("10 ms")}}), {}});
    return Value(std::move(all));
  }

 private:
  // A name of the scene: without dots, which separate the parts of a channel's name, and given once.
  std::string unique(const std::string& wanted) {
    std::string name = wanted;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '.' || c == '@' || (c >= 0 && c < ' '); }, '_');
    const std::string plain = name;
    for (int k = 2; !names_.insert(name).second; ++k) name = plain + "_" + std::to_string(k);
    if (name != wanted) robot_.left_out["names, which are others here"].push_back(wanted + " (" + name + ")");
    return name;
  }

  bool is_held(const Part& part) const { return part.group == robot_.parts.front().group && !floating_; }

  // With whom a link moves: what fixed joints connect is one.
  void name_bodies() {
    std::map<std::size_t, std::string> heavy;  // the first with a mass, of each group
    for (Part& part : robot_.parts) {
      if (part.mass <= 0) continue;
      part.body = unique(part.name);
      heavy.emplace(part.group, part.body);
    }
    for (Part& part : robot_.parts) {
      if (!part.body.empty()) continue;
      if (const auto found = heavy.find(part.group); found != heavy.end())
        part.body = found->second;
      else if (is_held(part))
        part.body = "ground";
      else
        throw SceneError(robot_.file + ": link '" + part.name +
                             "' moves and has no mass, nor has anything that is fixed to it; give it an <inertial>",
                         robot_.file);
    }
  }

  Value body(const Part& part) const {
    const auto& J = part.inertia;
    Value::Object b{
        {"name", Value(part.body), {}},
        {"mass", Value(part.mass), {}},
        {"center", vec(part.centre.x), {}},
        {"inertia",
         Value::object({{"xx", J[0]}, {"yy", J[3]}, {"zz", J[5]}, {"xy", J[1]}, {"yz", J[4]}, {"zx", J[2]}}),
         {}},
        {"inertia_axes", quat(part.centre.q), {}},
        {"position", vec(part.place.x), {}},
        {"orientation", quat(part.place.q), {}}};
    if (is_held(part)) b.push_back({"fixed", Value(true), {}});
    if (!part.color.empty()) b.push_back({"visual", Value::object({{"color", Value(part.color)}}), {}});
    return Value(std::move(b));
  }

  // Bodies of one group are bolted to the first of it.
  void bolt(Value::List& links) {
    std::map<std::size_t, std::string> first;
    for (const Part& part : robot_.parts) {
      if (part.mass <= 0 || is_held(part)) continue;
      const auto [at, is_first] = first.emplace(part.group, part.body);
      if (is_first) continue;
      links.push_back(Value(Value::Object{{"name", Value(unique(part.body + "_bolted")), {}},
                                          {"type", Value("fixed"), {}},
                                          {"p", Value(part.body), {}},
                                          {"s", Value(at->second), {}},
                                          {"at", vec(part.place.x), {}}}));
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
      Value::Object stop{{"axis", Value(joint.type == "prismatic" ? "z" : "rz"), {}},
                         {"low", Value(*joint.low), {}},
                         {"high", Value(*joint.high), {}}};
      link.push_back({"stops", Value(Value::List{Value(std::move(stop))}), {}});
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
  std::set<std::string> names_{"ground"};
};

}  // namespace

Value scene_of(Robot& robot, bool floating) { return Writer(robot, floating).scene(); }

}  // namespace lockstep::urdf
