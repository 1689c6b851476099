// Robots in URDF, the XML format of ROS, as scenes.
#pragma once

#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/params.h>

namespace lockstep {

/// What a file of URDF becomes.
struct ImportedRobot {
  Value scene;                          ///< a whole scene
  std::vector<std::string> left_out{};  ///< what the file has and the scene has not, a line a kind
};

/// Links with a mass become bodies, joints links, with their limits as stops and their damping as forces; positions are
/// those of the file, with all joints at zero. Links without a mass are what is fixed to them; the first of the tree is
/// the ground, unless it has a mass: it is then held fast, or free where `floating`. `name`: the file's, for messages.
/// Throws SceneError by the names of link and joint: XML that cannot be read, no or several roots, joints of unknown
/// types or between unknown links, moving links without a mass.
LOCKSTEP_API ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating);

}  // namespace lockstep
