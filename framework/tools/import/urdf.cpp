#include "framework/tools/import/urdf.h"

#include "framework/tools/import/robot.h"

namespace lockstep {
namespace {

// "meshes: of 'a', 'b' and 5 more"
std::string line_of(const std::string& what, const std::vector<std::string>& of) {
  constexpr std::size_t kMost = 3;
  std::string line = what + ": of ";
  for (std::size_t k = 0; k < std::min(kMost, of.size()); ++k) line += (k == 0 ? "'" : ", '") + of[k] + "'";
  return of.size() > kMost ? line + " and " + std::to_string(of.size() - kMost) + " more" : line;
}

}  // namespace

ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating) {
  urdf::Robot robot = urdf::read_robot(text, name);
  ImportedRobot imported{urdf::scene_of(robot, floating)};
  for (const auto& [what, of] : robot.left_out) imported.left_out.push_back(line_of(what, of));
  return imported;
}

}  // namespace lockstep
