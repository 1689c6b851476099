// SPDX-License-Identifier: BSD-3-Clause
// Robots in URDF, the XML format of ROS, as scenes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>

namespace lockstep {

/// The result of reading a URDF file.
struct ImportedRobot {
  Value scene;                          ///< a whole scene
  std::vector<std::string> left_out{};  ///< items of the file that are not in the scene, one line per kind
};

/// URDF links with a mass become bodies; joints become `links` of the scene, with their limits as stops and their damping
/// as forces. Positions are those of the file, with all joints at zero. Links without a mass join a link fixed to them; the
/// root is the ground, unless it has a mass: it is then fixed, or free if `floating`. `name`: the file's, for messages.
/// Shapes are kept: boxes, cylinders, spheres, and meshes for which `find_mesh` returns the file name in the scene, from
/// the name in the robot ("package://arm/meshes/a.stl"); "": the mesh is left out. Throws SceneError with the names of link
/// and joint: invalid XML, no or several roots, joints of unknown types or between unknown links, moving links without mass;
/// and elements that are not read, but are joints or misspelt, unless `without` has their kind ("loop_joint").
LOCKSTEP_API ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating,
                                     const std::function<std::string(const std::string&)>& find_mesh = {},
                                     const std::vector<std::string>& without = {});

/// The file of a robot's mesh name, for a robot in `folder`: for "package://arm/meshes/a.stl" the first meshes/a.stl in a
/// folder arm that contains `folder`, or is next to a folder that does; for "file:///x" x; else the path from `folder`.
/// "" if there is no such file.
LOCKSTEP_API std::string find_robot_mesh(const std::string& name, const std::string& folder);

}  // namespace lockstep
