// SPDX-License-Identifier: BSD-3-Clause
// Robots in URDF, the XML format of ROS, as scenes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>

namespace lockstep {

/// What a file of URDF becomes.
struct ImportedRobot {
  Value scene;                          ///< a whole scene
  std::vector<std::string> left_out{};  ///< what the file has and the scene has not, a line a kind
};

/// Links with a mass become bodies, joints links, with their limits as stops and their damping as forces; positions are
/// those of the file, with all joints at zero. Links without a mass are what is fixed to them; the first of the tree is
/// the ground, unless it has a mass: it is then held fast, or free where `floating`. `name`: the file's, for messages.
/// What links look like goes with them: boxes, cylinders, spheres, and meshes for which `find_mesh` gives a file as the
/// scene is to name it, of the name in the robot ("package://arm/meshes/a.stl"); "": the mesh is left out.
/// Throws SceneError by the names of link and joint: XML that cannot be read, no or several roots, joints of unknown
/// types or between unknown links, moving links without a mass.
LOCKSTEP_API ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating,
                                     const std::function<std::string(const std::string&)>& find_mesh = {});

/// The file that a robot's mesh name means, for a robot whose file is in `folder`: of "package://arm/meshes/a.stl" the
/// first meshes/a.stl in a folder arm that holds `folder`, or lies beside a folder that does; of "file:///x" x; else the
/// path from `folder`. "" where there is no such file.
LOCKSTEP_API std::string find_robot_mesh(const std::string& name, const std::string& folder);

}  // namespace lockstep
