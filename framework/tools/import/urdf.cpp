// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/import/urdf.h"

#include <filesystem>

#include "framework/tools/import/robot.h"

namespace lockstep {
namespace {

// "meshes: 'a', 'b' and 5 more"
std::string line_of(const std::string& what, const std::vector<std::string>& of) {
  constexpr std::size_t kMost = 3;
  std::string line = what + ": ";
  for (std::size_t k = 0; k < std::min(kMost, of.size()); ++k) line += (k == 0 ? "'" : ", '") + of[k] + "'";
  return of.size() > kMost ? line + " and " + std::to_string(of.size() - kMost) + " more" : line;
}

}  // namespace

ImportedRobot read_urdf(const std::string& text, const std::string& name, bool floating,
                        const std::function<std::string(const std::string&)>& find_mesh,
                        const std::vector<std::string>& without) {
  urdf::Robot robot = urdf::read_robot(text, name, without);
  ImportedRobot imported{urdf::scene_of(robot, floating, find_mesh)};
  for (const auto& [what, of] : robot.left_out) imported.left_out.push_back(line_of(what, of));
  return imported;
}

std::string find_robot_mesh(const std::string& name, const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto if_there = [&](const fs::path& file) {
    return fs::is_regular_file(file, error) ? file.lexically_normal().string() : std::string();
  };
  constexpr std::string_view kFile = "file://", kPackage = "package://";
  if (name.starts_with(kFile)) return if_there(name.substr(kFile.size()));
  if (!name.starts_with(kPackage)) return if_there(fs::path(folder) / name);
  const fs::path in_package = name.substr(kPackage.size());
  if (in_package.empty()) return "";
  const fs::path package = *in_package.begin(), rest = in_package.lexically_relative(package);
  fs::path holder = fs::absolute(folder, error).lexically_normal();
  if (!holder.has_filename()) holder = holder.parent_path();
  for (; !holder.empty(); holder = holder.parent_path()) {
    if (holder.filename() == package)
      if (const std::string file = if_there(holder / rest); !file.empty()) return file;
    if (const std::string file = if_there(holder / in_package); !file.empty()) return file;
    if (holder == holder.root_path()) break;
  }
  return "";
}

}  // namespace lockstep
