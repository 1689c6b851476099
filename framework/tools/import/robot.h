// SPDX-License-Identifier: BSD-3-Clause
// A robot in URDF: a tree of links (bodies) that joints connect.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/math.h>

namespace lockstep::urdf {

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

inline Value vec(const Vec3& v) { return Value::list({v[0], v[1], v[2]}); }

/// A shape of a link for drawing.
struct Picture {
  Pose at{};                  ///< its frame in the link's
  Value::Object shape{};      ///< as scenes have it: "box" with its size, ...; empty for a mesh
  std::string mesh{};         ///< the file as the robot names it: "package://arm/meshes/a.stl"
  Vec3 scale = Vec3::Ones();  ///< of a mesh: the factors on its points
};

/// A link.
struct Part {
  std::string name, color{};        ///< color: "#rrggbb" or ""
  double mass = 0;                  ///< kg
  Pose centre{};                    ///< of mass, with the axes of the inertia; in the link's frame
  std::array<double, 6> inertia{};  ///< xx xy xz yy yz zz, kg m^2
  std::size_t joint = kNone;        ///< of which it is the child; none for the root
  std::size_t group = 0;            ///< the outermost of the links that fixed joints connect with it
  Pose place{};                     ///< in the world, all joints at zero
  std::string body{};               ///< of the scene, with which it moves
  std::vector<Picture> pictures{};
};

struct Joint {
  std::string name, type;
  std::string parent_name, child_name;
  std::size_t parent = kNone, child = kNone;  ///< parts
  Pose origin{};                              ///< of the child's frame in the parent's
  Vec3 axis = Vec3::UnitX();                  ///< in the child's frame
  std::optional<double> low{}, high{};        ///< m or rad
  double damping = 0;                         ///< N s/m or N m s/rad

  bool moves_along_axis() const { return type == "revolute" || type == "continuous" || type == "prismatic"; }
};

struct Robot {
  std::string file, name;
  std::vector<Part> parts;  ///< the root first, each after its parent
  std::vector<Joint> joints;
  std::map<std::string, std::vector<std::string>> left_out;  ///< what: names of links and joints
};

/// Reads a file of URDF; `without`: kinds of elements that are left out even if they are joints or misspelt. Throws
/// SceneError.
Robot read_robot(const std::string& text, const std::string& file, const std::vector<std::string>& without);

/// The file of a mesh as the scene names it, for the name in the robot; "" if there is no such file.
using FindMesh = std::function<std::string(const std::string&)>;

/// The robot as a scene; items that are left out are added to `left_out`. Throws SceneError.
Value scene_of(Robot&, bool floating, const FindMesh&);

}  // namespace lockstep::urdf
