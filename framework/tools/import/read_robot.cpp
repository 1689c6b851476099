// SPDX-License-Identifier: BSD-3-Clause
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <locale>
#include <nlohmann/json.hpp>
#include <sstream>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/tools/import/robot.h"

namespace lockstep::urdf {
namespace {

using Tree = boost::property_tree::ptree;
using Words = std::vector<std::string>;

constexpr int kMostTags = 200;  // nested: the parser calls itself

/// The nesting of tags, at most.
int depth_of(const std::string& text) {
  int depth = 0, most = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos && at + 1 < text.size(); at = text.find('<', at + 1)) {
    const char next = text[at + 1];
    if (next == '!' || next == '?') continue;
    const std::size_t end = text.find('>', at);
    if (next == '/')
      --depth;
    else if (end == std::string::npos || text[end - 1] != '/')
      most = std::max(most, ++depth);
  }
  return most;
}

// JSON is written in UTF-8 alone.
bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

bool has(const Words& words, const std::string& word) { return std::ranges::find(words, word) != words.end(); }

// What is read in an element, or left out under a name of its own; "*": all that it holds is left out with it.
Words known_in(const std::string& element) {
  static const std::map<std::string, Words> known{
      {"robot", {"link", "joint", "material", "transmission"}},
      {"link", {"inertial", "visual", "collision"}},
      {"inertial", {"origin", "mass", "inertia"}},
      {"visual", {"origin", "geometry", "material"}},
      {"geometry", {"box", "cylinder", "sphere", "mesh"}},  // the first of these
      {"material", {"color"}},
      {"joint", {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic"}},
      {"collision", {"*"}},
      {"transmission", {"*"}}};
  return known.contains(element) ? known.at(element) : Words();
}

// Whether an element that is not read is a joint: by its name without the prefix of a program ("drake:"), or its ends.
bool is_joint(const std::string& element, const Tree& tree) {
  const std::string own = element.substr(element.find(':') + 1);
  const auto names = [&](const std::string& end) {
    return tree.count(end) > 0 || tree.get_child_optional("<xmlattr>." + end).has_value();
  };
  return own == "loop_joint" || own == "equality" || own.ends_with("constraint") ||
         (names("parent") && names("child")) || (names("link1") && names("link2"));
}

std::string name_of(const Tree& tree, const std::string& of) {
  return tree.get("<xmlattr>.name", tree.get("<xmlattr>.reference", of));
}

/// Reads a robot, and keeps the place for messages.
class Reader {
 public:
  Reader(std::string file, const Words& without) : without_(without) { robot_.file = std::move(file); }

  Robot read(const std::string& text) {
    const Tree tree = tree_of(text);
    robot_.name = tree.get<std::string>("<xmlattr>.name", "robot");
    note_unread("robot", tree, robot_.name);
    wrong_.raise();
    read_colors(tree);
    for (const auto& [tag, child] : tree) {
      if (tag == "link") read_link(child);
      if (tag == "joint") read_joint(child);
      if (tag == "transmission") leave_out("transmissions", child.get<std::string>("<xmlattr>.name", "one"));
    }
    connect();
    return std::move(robot_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw SceneError(robot_.file + ": " + what, robot_.file); }
  void leave_out(const std::string& what, const std::string& of) { robot_.left_out[what].push_back(of); }

  Tree tree_of(const std::string& text) const {
    if (text.size() > kMostBytes) fail("it is larger than 64 MB, the limit");
    if (!is_utf8(text)) fail("it is not in UTF-8; convert it");
    if (depth_of(text) > kMostTags) fail("its tags are nested deeper than " + std::to_string(kMostTags) + " levels");
    Tree tree;
    std::istringstream in(text);
    try {
      boost::property_tree::read_xml(in, tree, boost::property_tree::xml_parser::no_comments);
    } catch (const boost::property_tree::xml_parser_error& error) {
      throw SceneError(robot_.file + ":" + std::to_string(error.line()) + ": invalid XML: " + error.message(),
                       robot_.file);
    }
    const auto robot = tree.find("robot");
    if (robot == tree.not_found())
      fail("it has no <robot>, so it is not URDF; convert a xacro file by `xacro robot.xacro`");
    return robot->second;
  }

  // The elements that are not read, in one that is; `of`: the innermost name around them.
  void note_unread(const std::string& in, const Tree& tree, const std::string& of) {
    const Words known = known_in(in);
    const auto first = std::ranges::find_if(known, [&](const std::string& kind) { return tree.count(kind) > 0; });
    for (const auto& [kind, child] : tree) {
      const bool repeats = in == "robot" || kind == "visual" || kind == "collision";
      if (kind == "<xmlattr>" || has(known, "*")) continue;
      if (!has(known, kind))
        leave_out_element(kind, child, of, known, "");
      else if (repeats || &child == &tree.get_child(in == "geometry" ? *first : kind))
        note_unread(kind, child, name_of(child, of));
      else
        leave_out("further <" + kind + ">", of);
    }
  }

  // `known`: what it may be misspelt for. `inside`: "", or where it is, if that is not read either.
  void leave_out_element(const std::string& kind, const Tree& tree, const std::string& of, const Words& known,
                         const std::string& inside) {
    const std::string name = name_of(tree, of), near = text::closest_name(kind, known);
    if (inside.empty() || has(without_, kind)) leave_out("<" + kind + ">", name);
    if (has(without_, kind)) return;
    const std::string whose = tree.get_child_optional("<xmlattr>.name") ? " '" : " of '",
                      called = "<" + kind + ">" + whose + name + "'" + inside, by = " --without " + kind;
    if (!near.empty())
      wrong_.attempt([&] { fail(called + " is unknown; did you mean \"" + near + "\"? Else leave it out by" + by); });
    else if (is_joint(kind, tree))
      wrong_.attempt([&] { fail(called + " is a joint that is not read; add it to the scene, and give" + by); });
    for (const auto& [below, child] : tree)
      if (below != "<xmlattr>")
        leave_out_element(below, child, name, {}, inside.empty() ? " in <" + kind + ">" : inside);
  }

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const std::string& words, const std::string& of) const {
    Eigen::Matrix<double, N, 1> all;
    std::istringstream in(words);
    in.imbue(std::locale::classic());
    for (double& x : all)
      if (!(in >> x) || !std::isfinite(x))
        fail(of + ": \"" + words + "\" is not " + std::to_string(N) + " number" + (N == 1 ? "" : "s"));
    if (std::string rest; in >> rest) fail(of + ": \"" + words + "\" is more than " + std::to_string(N) + " numbers");
    return all;
  }
  double number(const Tree& tree, const std::string& attribute, const std::string& of, double fallback) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + attribute);
    return words ? numbers<1>(*words, of + ", " + attribute)[0] : fallback;
  }
  Vec3 vector(const Tree& tree, const std::string& attribute, const std::string& of, const Vec3& fallback) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + attribute);
    return words ? Vec3(numbers<3>(*words, of + ", " + attribute)) : fallback;
  }
  std::string attribute(const Tree& tree, const std::string& name, const std::string& of) const {
    const auto words = tree.get_optional<std::string>("<xmlattr>." + name);
    if (!words || words->empty()) fail(of + ": it has no " + name + "; add it");
    return *words;
  }

  // rpy: rotations about the fixed axes x, y, z, one after the other.
  Pose origin(const Tree& tree, const std::string& of) const {
    const auto found = tree.get_child_optional("origin");
    if (!found) return {};
    const Vec3 rpy = vector(*found, "rpy", of + ", origin", Vec3::Zero());
    const Quat q =
        axis_angle(Vec3::UnitZ(), rpy[2]) * axis_angle(Vec3::UnitY(), rpy[1]) * axis_angle(Vec3::UnitX(), rpy[0]);
    return {vector(*found, "xyz", of + ", origin", Vec3::Zero()), q};
  }

  // Of the robot's own materials, and of those that a visual of any link defines.
  void read_colors(const Tree& robot) {
    const auto keep = [&](const Tree& material) {
      if (const std::string color = color_of(material); !color.empty())
        colors_[material.get<std::string>("<xmlattr>.name", "")] = color;
    };
    for (const auto& [tag, tree] : robot) {
      if (tag == "material") keep(tree);
      if (tag == "link")
        for (const auto& [part, visual] : tree)
          if (const auto material = visual.get_child_optional("material"); part == "visual" && material)
            keep(*material);
    }
  }
  std::string color_of(const Tree& material) const {
    const auto rgba = material.get_optional<std::string>("color.<xmlattr>.rgba");
    if (!rgba) return "";
    const Eigen::Vector4d c = numbers<4>(*rgba, "material, rgba");
    const auto level = [&](int k) { return std::lround(255 * std::clamp(c[k], 0.0, 1.0)); };
    return fmt::format("#{:02x}{:02x}{:02x}", level(0), level(1), level(2));
  }

  void read_link(const Tree& tree) {
    Part part{attribute(tree, "name", "a link")};
    const std::string of = "link '" + part.name + "'";
    if (!parts_.emplace(part.name, robot_.parts.size()).second) fail(of + " is defined twice; rename one of them");
    if (const auto inertial = tree.get_child_optional("inertial")) read_inertial(*inertial, of, part);
    for (const auto& [tag, visual] : tree) {
      if (tag == "collision") leave_out("collision shapes", part.name);
      if (tag != "visual") continue;
      read_picture(visual, of + ", visual", part);
      if (const auto material = visual.get_child_optional("material"); material && part.color.empty()) {
        part.color = color_of(*material);
        if (part.color.empty()) part.color = colors_[material->get<std::string>("<xmlattr>.name", "")];
      }
    }
    robot_.parts.push_back(std::move(part));
  }

  void read_picture(const Tree& visual, const std::string& of, Part& part) {
    const Pose at = origin(visual, of);
    const auto length = [&](const Tree& tree, const char* attribute) {
      const double value = number(tree, attribute, of, 0);
      if (!(value > 0)) fail(of + ", " + attribute + ": it must be above 0");
      return value;
    };
    if (const auto box = visual.get_child_optional("geometry.box")) {
      const Vec3 size = vector(*box, "size", of, Vec3::Zero());
      if (!(size.minCoeff() > 0)) fail(of + ", size: all edges must be above 0");
      part.pictures.push_back({at, {{"box", Value::object({{"size", vec(size)}}), {}}}});
    } else if (const auto cylinder = visual.get_child_optional("geometry.cylinder")) {
      const double radius = length(*cylinder, "radius"), height = length(*cylinder, "length");
      part.pictures.push_back({at, {{"cylinder", Value::object({{"radius", radius}, {"length", height}}), {}}}});
    } else if (const auto sphere = visual.get_child_optional("geometry.sphere")) {
      part.pictures.push_back({at, {{"sphere", Value::object({{"radius", length(*sphere, "radius")}}), {}}}});
    } else if (const auto mesh = visual.get_child_optional("geometry.mesh")) {
      const Vec3 scale = vector(*mesh, "scale", of, Vec3::Ones());
      part.pictures.push_back({at, {}, attribute(*mesh, "filename", of + ", mesh"), scale});
    } else {
      leave_out("visual shapes", part.name);
    }
  }

  void read_inertial(const Tree& inertial, const std::string& of, Part& part) {
    part.centre = origin(inertial, of + ", inertial");
    if (const auto mass = inertial.get_child_optional("mass")) part.mass = number(*mass, "value", of + ", mass", 0);
    if (part.mass < 0) fail(of + ": its mass is negative; give it a positive one");
    const auto inertia = inertial.get_child_optional("inertia");
    if (!inertia && part.mass > 0) fail(of + ": it has a mass and no <inertia>; give it one");
    if (!inertia) return;
    std::size_t k = 0;
    for (const char* entry : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      part.inertia[k++] = number(*inertia, entry, of + ", inertia", 0);
    const std::array<double, 6>& J = part.inertia;
    if (part.mass == 0) {
      if (J[0] != 0 || J[3] != 0 || J[5] != 0) leave_out("inertias of links without a mass", part.name);
      return;
    }
    Mat3 full;
    full << J[0], J[1], J[2], J[1], J[3], J[4], J[2], J[4], J[5];
    try {
      check_mass({part.mass, Vec3::Zero(), full}, of);
    } catch (const ModelError& error) {
      fail(error.what());
    }
  }

  void read_joint(const Tree& tree) {
    Joint joint;
    joint.name = attribute(tree, "name", "a joint");
    const std::string of = "joint '" + joint.name + "'";
    if (!joints_.emplace(joint.name, robot_.joints.size()).second) fail(of + " is defined twice; rename one of them");
    joint.type = attribute(tree, "type", of);
    static const std::vector<std::string> types{"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
    if (std::find(types.begin(), types.end(), joint.type) == types.end())
      fail(of + ": unknown type \"" + joint.type + "\"; known: " + text::join(types));
    for (const auto& [end, link] : {std::pair{"parent", &joint.parent_name}, std::pair{"child", &joint.child_name}}) {
      const auto found = tree.get_child_optional(end);
      if (!found) fail(of + ": it has no <" + end + ">; add it");
      *link = attribute(*found, "link", of + ", " + end);
    }
    joint.origin = origin(tree, of);
    if (joint.moves_along_axis() || joint.type == "planar") {  // others have none, even if it is written
      if (const auto axis = tree.get_child_optional("axis"))
        joint.axis = vector(*axis, "xyz", of + ", axis", joint.axis);
      if (!(joint.axis.norm() > 0)) fail(of + ": its axis is zero; give a direction");
    }
    read_limits(tree, of, joint);
    if (const auto dynamics = tree.get_child_optional("dynamics")) {
      joint.damping = number(*dynamics, "damping", of + ", dynamics", 0);
      if (number(*dynamics, "friction", of + ", dynamics", 0) != 0) leave_out("friction", joint.name);
    }
    if (tree.get_child_optional("mimic")) leave_out("mimic relations", joint.name);
    robot_.joints.push_back(std::move(joint));
  }

  // A stop acts from the start: one that is exceeded there would throw the joint back.
  void read_limits(const Tree& tree, const std::string& of, Joint& joint) {
    const auto limit = tree.get_child_optional("limit");
    if (!limit) return;
    for (const char* name : {"effort", "velocity"})
      if (limit->get_optional<std::string>(std::string("<xmlattr>.") + name))
        leave_out(std::string("limits of ") + name, joint.name);
    if (joint.type != "revolute" && joint.type != "prismatic") return;
    const double low = number(*limit, "lower", of + ", limit", 0), high = number(*limit, "upper", of + ", limit", 0);
    if (!(low < high))
      leave_out("limits with lower not below upper", joint.name);
    else if (low > 0 || high < 0)
      leave_out("limits that exclude the joint's zero", joint.name);
    else
      joint.low = low, joint.high = high;
  }

  // Puts the parts in the order of the tree, from the root outward, and each in its place.
  void connect() {
    if (robot_.parts.empty()) fail("there is no <link>");
    std::vector<std::vector<std::size_t>> joints_below(robot_.parts.size());
    for (std::size_t k = 0; k < robot_.joints.size(); ++k) {
      Joint& joint = robot_.joints[k];
      joint.parent = part_of(joint.parent_name, joint), joint.child = part_of(joint.child_name, joint);
      Part& child = robot_.parts[joint.child];
      if (child.joint != kNone)
        fail("link '" + child.name + "' is the child of two joints, '" + robot_.joints[child.joint].name + "' and '" +
             joint.name + "'; remove one");
      child.joint = k;
      joints_below[joint.parent].push_back(k);
    }
    std::vector<std::size_t> order = roots();
    for (std::size_t next = 0; next < order.size(); ++next)
      for (const std::size_t k : joints_below[order[next]]) order.push_back(robot_.joints[k].child);
    for (std::size_t k = 0; order.size() < robot_.parts.size(); ++k)
      if (std::ranges::find(order, k) == order.end())
        fail("the joints above link '" + robot_.parts[k].name + "' form a closed loop, and URDF needs a tree");
    std::vector<std::size_t> place_of(robot_.parts.size());
    std::vector<Part> sorted;
    for (const std::size_t k : order) place_of[k] = sorted.size(), sorted.push_back(std::move(robot_.parts[k]));
    robot_.parts = std::move(sorted);
    for (Joint& joint : robot_.joints) joint.parent = place_of[joint.parent], joint.child = place_of[joint.child];
    for (std::size_t k = 0; k < robot_.parts.size(); ++k) {
      Part& part = robot_.parts[k];
      part.group = k;
      if (part.joint == kNone) continue;
      const Joint& joint = robot_.joints[part.joint];
      const Part& parent = robot_.parts[joint.parent];
      part.place = parent.place * joint.origin;
      if (joint.type == "fixed") part.group = parent.group;
    }
  }
  std::size_t part_of(const std::string& name, const Joint& joint) const {
    const auto found = parts_.find(name);
    if (found == parts_.end()) fail("joint '" + joint.name + "': there is no link '" + name + "'");
    return found->second;
  }
  std::vector<std::size_t> roots() const {
    std::vector<std::size_t> all;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < robot_.parts.size(); ++k)
      if (robot_.parts[k].joint == kNone) all.push_back(k), names.push_back("'" + robot_.parts[k].name + "'");
    if (all.empty()) fail("its joints form a closed loop, and URDF needs a tree; every link is the child of a joint");
    if (all.size() > 1) fail("it has several root links, and URDF needs one: " + text::join(names));
    return all;
  }

  const Words& without_;
  Robot robot_;
  Refusals wrong_;
  std::map<std::string, std::string> colors_;
  std::map<std::string, std::size_t> parts_, joints_;
};

}  // namespace

Robot read_robot(const std::string& text, const std::string& file, const Words& without) {
  return Reader(file, without).read(text);
}

}  // namespace lockstep::urdf
