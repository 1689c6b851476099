#include "framework/tools/import/urdf.h"

#include <algorithm>
#include <array>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/math.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

using Tree = boost::property_tree::ptree;

/// A link of the robot.
struct Part {
  std::string name, parent_joint{};  // "" for the root
  double mass = 0;
  Pose centre{};                    // of mass, with the axes of the inertia; in the link's frame
  std::array<double, 6> inertia{};  // xx xy xz yy yz zz
  std::string color{};
  Pose place{};         // in the world, all joints at zero
  std::string solid{};  // the link with a mass that this one moves with
};

struct Joint {
  std::string name, type, parent, child;
  Pose origin{};  // of the child's frame in the parent's
  Vec3 axis = Vec3::UnitX();
  std::optional<double> low{}, high{};
  double damping = 0;
};

/// Reads a robot, and knows where it is for messages.
class Reader {
 public:
  Reader(std::string file, bool floating) : file_(std::move(file)), floating_(floating) {}

  ImportedRobot read(const std::string& text) {
    const Tree robot = robot_of(text);
    name_ = robot.get<std::string>("<xmlattr>.name", "robot");
    read_materials(robot);
    for (const auto& [tag, tree] : robot) {
      if (tag == "link") read_link(tree);
      if (tag == "joint") read_joint(tree);
    }
    place_all();
    settle_masses();
    return {scene(), left_out_};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw SceneError(file_ + ": " + what, file_); }

  Tree robot_of(const std::string& text) const {
    Tree tree;
    std::istringstream in(text);
    try {
      boost::property_tree::read_xml(in, tree, boost::property_tree::xml_parser::no_comments);
    } catch (const boost::property_tree::xml_parser_error& error) {
      throw SceneError(file_ + ":" + std::to_string(error.line()) + ": " + error.message() + "; it is no XML", file_);
    }
    const auto robot = tree.find("robot");
    if (robot == tree.not_found())
      fail("there is no <robot>: is it URDF? A xacro file is made one by `xacro robot.xacro`");
    return robot->second;
  }

  template <std::size_t N>
  std::array<double, N> numbers(const std::string& words, const std::string& of) const {
    std::array<double, N> all{};
    std::istringstream in(words);
    in.imbue(std::locale::classic());
    for (double& x : all)
      if (!(in >> x) || !std::isfinite(x))
        fail(of + ": \"" + words + "\" should be " + std::to_string(N) + " number" + (N == 1 ? "" : "s"));
    if (std::string rest; in >> rest) fail(of + ": \"" + words + "\" has more than " + std::to_string(N) + " numbers");
    return all;
  }
  double number(const Tree& tree, const std::string& attribute, const std::string& of, double fallback) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + attribute);
    return words ? numbers<1>(*words, of + ", " + attribute)[0] : fallback;
  }
  Vec3 vector(const Tree& tree, const std::string& attribute, const std::string& of, const Vec3& fallback) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + attribute);
    if (!words) return fallback;
    const std::array<double, 3> x = numbers<3>(*words, of + ", " + attribute);
    return {x[0], x[1], x[2]};
  }
  std::string attribute(const Tree& tree, const std::string& name, const std::string& of) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + name);
    if (!words || words->empty()) fail(of + ": it has no " + name);
    return *words;
  }

  // rpy: turns about the fixed axes x, y, z, one after the other.
  Pose origin(const Tree& tree, const std::string& of) const {
    const auto found = tree.get_child_optional("origin");
    if (!found) return {};
    const Vec3 rpy = vector(*found, "rpy", of + ", origin", Vec3::Zero());
    const Quat q =
        axis_angle(Vec3::UnitZ(), rpy[2]) * axis_angle(Vec3::UnitY(), rpy[1]) * axis_angle(Vec3::UnitX(), rpy[0]);
    return {vector(*found, "xyz", of + ", origin", Vec3::Zero()), q};
  }

  void read_materials(const Tree& robot) {
    for (const auto& [tag, tree] : robot)
      if (tag == "material") colors_[tree.get<std::string>("<xmlattr>.name", "")] = color_of(tree);
  }
  std::string color_of(const Tree& material) const {
    const auto rgba = material.get_optional<std::string>("color.<xmlattr>.rgba");
    if (!rgba) return "";
    std::string text = "#";
    const std::array<double, 4> c = numbers<4>(*rgba, "material, rgba");
    for (int k = 0; k < 3; ++k) {
      const auto level = static_cast<unsigned>(std::lround(255 * std::clamp(c[static_cast<std::size_t>(k)], 0.0, 1.0)));
      for (const unsigned digit : {level / 16, level % 16}) text += "0123456789abcdef"[digit];
    }
    return text;
  }

  void read_link(const Tree& tree) {
    Part part{attribute(tree, "name", "a link")};
    const std::string of = "link '" + part.name + "'";
    if (part_of(part.name) != nullptr) fail(of + " is there twice");
    if (const auto inertial = tree.get_child_optional("inertial")) {
      part.centre = origin(*inertial, of + ", inertial");
      if (const auto mass = inertial->get_child_optional("mass")) part.mass = number(*mass, "value", of + ", mass", 0);
      if (part.mass < 0) fail(of + ": its mass is negative");
      if (const auto inertia = inertial->get_child_optional("inertia")) {
        std::size_t k = 0;
        for (const char* entry : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
          part.inertia[k++] = number(*inertia, entry, of + ", inertia", 0);
      }
    }
    for (const auto& [tag, visual] : tree) {
      if (tag != "visual") continue;
      if (visual.get_child_optional("geometry.mesh")) left_out_.push_back(of + ": its mesh");
      if (const auto material = visual.get_child_optional("material"); material && part.color.empty()) {
        part.color = color_of(*material);
        if (part.color.empty()) part.color = colors_[material->get<std::string>("<xmlattr>.name", "")];
      }
    }
    parts_.push_back(std::move(part));
  }

  void read_joint(const Tree& tree) {
    Joint joint;
    joint.name = attribute(tree, "name", "a joint");
    const std::string of = "joint '" + joint.name + "'";
    joint.type = attribute(tree, "type", of);
    static const std::vector<std::string> types{"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
    if (std::find(types.begin(), types.end(), joint.type) == types.end())
      fail(of + ": unknown type \"" + joint.type + "\"; known: " + text::join(types));
    for (const auto& [end, link] : {std::pair{"parent", &joint.parent}, std::pair{"child", &joint.child}}) {
      const auto found = tree.get_child_optional(end);
      if (!found) fail(of + ": it has no <" + end + ">");
      *link = attribute(*found, "link", of + ", " + end);
    }
    joint.origin = origin(tree, of);
    if (const auto axis = tree.get_child_optional("axis")) joint.axis = vector(*axis, "xyz", of + ", axis", joint.axis);
    if (!(joint.axis.norm() > 0)) fail(of + ": its axis is zero");
    if (const auto limit = tree.get_child_optional("limit");
        limit && (joint.type == "revolute" || joint.type == "prismatic")) {
      joint.low = number(*limit, "lower", of + ", limit", 0), joint.high = number(*limit, "upper", of + ", limit", 0);
      if (*joint.low >= *joint.high) {
        left_out_.push_back(of + ": its limits, as lower is not below upper");
        joint.low.reset(), joint.high.reset();
      }
    }
    if (const auto dynamics = tree.get_child_optional("dynamics")) {
      joint.damping = number(*dynamics, "damping", of + ", dynamics", 0);
      if (number(*dynamics, "friction", of + ", dynamics", 0) != 0) left_out_.push_back(of + ": its friction");
    }
    if (tree.get_child_optional("mimic")) left_out_.push_back(of + ": that it mimics another");
    joints_.push_back(std::move(joint));
  }

  Part* part_of(const std::string& name) {
    const auto found = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == name; });
    return found == parts_.end() ? nullptr : &*found;
  }
  const Joint* joint_of(const std::string& name) const {
    const auto found = std::find_if(joints_.begin(), joints_.end(), [&](const Joint& j) { return j.name == name; });
    return found == joints_.end() ? nullptr : &*found;
  }

  // From the root outward.
  void place_all() {
    if (parts_.empty()) fail("there is no <link>");
    for (const Joint& joint : joints_) {
      for (const std::string* end : {&joint.parent, &joint.child})
        if (part_of(*end) == nullptr) fail("joint '" + joint.name + "': there is no link '" + *end + "'");
      Part& child = *part_of(joint.child);
      if (!child.parent_joint.empty())
        fail("link '" + child.name + "' is the child of two joints, '" + child.parent_joint + "' and '" + joint.name +
             "'");
      child.parent_joint = joint.name;
    }
    std::vector<std::string> roots;
    for (const Part& part : parts_)
      if (part.parent_joint.empty()) roots.push_back("'" + part.name + "'");
    if (roots.size() != 1)
      fail(roots.empty() ? "its joints go in a circle: no link is the root"
                         : "several links are the child of no joint: " + text::join(roots));
    for (Part& part : parts_) place(part, 0);
  }
  void place(Part& part, std::size_t depth) {
    if (depth > parts_.size()) fail("the joints above link '" + part.name + "' go in a circle");
    if (part.parent_joint.empty()) return;
    const Joint& joint = *joint_of(part.parent_joint);
    Part& parent = *part_of(joint.parent);
    place(parent, depth + 1);
    part.place = parent.place * joint.origin;
  }

  // Whom a link moves with: what fixed joints connect is one.
  void settle_masses() {
    std::map<std::string, std::string> group;
    for (const Part& part : parts_) group[part.name] = group_of(part);
    const std::string root =
        group_of(*std::find_if(parts_.begin(), parts_.end(), [](const Part& p) { return p.parent_joint.empty(); }));
    for (Part& part : parts_) {
      if (part.mass > 0) part.solid = part.name;
      for (const Part& other : parts_)
        if (part.solid.empty() && other.mass > 0 && group[other.name] == group[part.name]) part.solid = other.name;
      if (part.solid.empty() && group[part.name] == root && !floating_) part.solid = "ground";
      if (part.solid.empty())
        fail("link '" + part.name +
             "' moves and has no mass, nor has anything that is fixed to it; give it an <inertial>");
    }
    root_ = root, groups_ = std::move(group);
  }
  std::string group_of(const Part& part) {
    const Joint* joint = part.parent_joint.empty() ? nullptr : joint_of(part.parent_joint);
    return joint != nullptr && joint->type == "fixed" ? group_of(*part_of(joint->parent)) : part.name;
  }

  static Value vec(const Vec3& v) { return Value::list({v[0], v[1], v[2]}); }
  static Value quat(const Quat& q) { return Value::list({q.w, q.x, q.y, q.z}); }

  Value body(const Part& part) const {
    Value::Object b{{"name", Value(part.name), {}}, {"mass", Value(part.mass), {}}};
    b.push_back({"center", vec(part.centre.x), {}});
    const auto& J = part.inertia;
    b.push_back({"inertia",
                 Value::object({{"xx", J[0]}, {"yy", J[3]}, {"zz", J[5]}, {"xy", J[1]}, {"yz", J[4]}, {"zx", J[2]}}),
                 {}});
    b.push_back({"inertia_axes", quat(part.centre.q), {}});
    b.push_back({"position", vec(part.place.x), {}});
    b.push_back({"orientation", quat(part.place.q), {}});
    if (groups_.at(part.name) == root_ && !floating_) b.push_back({"fixed", Value(true), {}});
    if (!part.color.empty()) b.push_back({"visual", Value::object({{"color", Value(part.color)}}), {}});
    return Value(std::move(b));
  }

  // Ends, place and axis of what acts at a joint.
  Value::Object at_joint(const std::string& name, const std::string& type, const Joint& joint) {
    const Part& child = *part_of(joint.child);
    return {{"name", Value(name), {}},      {"type", Value(type), {}},
            {"p", Value(child.solid), {}},  {"s", Value(part_of(joint.parent)->solid), {}},
            {"at", vec(child.place.x), {}}, {"axis", vec(rotation(child.place.q) * joint.axis.normalized()), {}}};
  }

  std::string name_of(const Joint& joint) {
    return part_of(joint.name) != nullptr ? joint.name + "_joint" : joint.name;
  }

  std::optional<Value> link(const Joint& joint) {
    if (joint.type == "floating") return {};
    static const std::map<std::string, const char*> types{
        {"revolute", "revolute"}, {"continuous", "revolute"}, {"prismatic", "prismatic"}, {"planar", "plane_on_plane"}};
    Value::Object link = at_joint(name_of(joint), types.at(joint.type), joint);
    if (joint.low) {
      Value::Object stop{{"axis", Value(joint.type == "revolute" ? "rz" : "z"), {}},
                         {"low", Value(*joint.low), {}},
                         {"high", Value(*joint.high), {}}};
      link.push_back({"stops", Value(Value::List{Value(std::move(stop))}), {}});
    }
    return Value(std::move(link));
  }

  std::optional<Value> damper(const Joint& joint) {
    if (joint.damping == 0 || joint.type == "fixed") return {};
    if (joint.type == "floating" || joint.type == "planar") {
      left_out_.push_back("joint '" + joint.name + "': its damping");
      return {};
    }
    const bool slides = joint.type == "prismatic";
    Value::Object force = at_joint(name_of(joint) + "_damping", slides ? "bushing" : "torsion_spring_damper", joint);
    force.push_back({"damping", slides ? Value::list({0, 0, joint.damping}) : Value(joint.damping), {}});
    return Value(std::move(force));
  }

  // Bodies of one group are bolted to the first of it.
  void bolt(Value::List& links) const {
    std::map<std::string, std::string> first;
    for (const Part& part : parts_) {
      if (part.mass <= 0 || (groups_.at(part.name) == root_ && !floating_)) continue;
      const auto [at, is_first] = first.emplace(groups_.at(part.name), part.name);
      if (is_first) continue;
      links.push_back(Value(Value::Object{{"name", Value(part.name + "_bolted"), {}},
                                          {"type", Value("fixed"), {}},
                                          {"p", Value(part.name), {}},
                                          {"s", Value(at->second), {}},
                                          {"at", vec(part.place.x), {}}}));
    }
  }

  Value scene() {
    Value::List bodies, links, forces;
    for (const Part& part : parts_)
      if (part.mass > 0) bodies.push_back(body(part));
    bolt(links);
    for (const Joint& joint : joints_) {
      if (joint.type == "fixed") continue;
      if (std::optional<Value> made = link(joint)) links.push_back(*std::move(made));
      if (std::optional<Value> made = damper(joint)) forces.push_back(*std::move(made));
    }
    Value::Object all{{"lockstep", Value(1), {}},
                      {"title", Value(name_), {}},
                      {"gravity", Value::list({0, 0, -9.81}), {}},
                      {"merge", Value("auto"), {}},
                      {"bodies", Value(std::move(bodies)), {}},
                      {"links", Value(std::move(links)), {}}};
    if (!forces.empty()) all.push_back({"forces", Value(std::move(forces)), {}});
    all.push_back({"run", Value::object({{"until", Value("1 s")}, {"output", Value("10 ms")}}), {}});
    return Value(std::move(all));
  }

  std::string file_, name_, root_;
  bool floating_;
  std::map<std::string, std::string> colors_, groups_;
  std::vector<Part> parts_;
  std::vector<Joint> joints_;
  std::vector<std::string> left_out_;
};

}  // namespace

ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating) {
  return Reader(name, floating).read(text);
}

}  // namespace lockstep
