// SPDX-License-Identifier: BSD-3-Clause
// The command import: a robot in URDF becomes a scene.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <lockstep/error.h>
#include <lockstep/solid.h>
#include "framework/description/scene/json.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/import/urdf.h"
#include "framework/tools/program/files.h"

namespace lockstep {

namespace {

std::string text_of_robot(const std::string& file) {
  if (file == "-") return standard_input();
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, error))
    throw FileError("cannot read '" + file + "': " +
                    (std::filesystem::exists(file, error) ? "it is not a readable file" : "there is no such file") +
                    "; check the path");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string folder_of(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

/// Meshes of a robot, by their paths from the folder of the scene that is written.
struct MeshFinder {
  std::string robots, folder;          // of the robot, and of the scene
  std::vector<std::string> refused{};  // why meshes were left out
  bool outside = false;                // one is not below the folder

  std::string find(const std::string& name) {
    const std::string file = find_robot_mesh(name, robots);
    if (file.empty()) return "";
    try {
      read_mesh(file);
    } catch (const FileError& error) {
      refused.push_back(error.what());
      return "";
    }
    std::error_code error;
    const auto path = [&](const std::string& of) { return std::filesystem::weakly_canonical(of, error); };
    const std::string shown = path(file).lexically_relative(path(folder)).string();
    outside = outside || shown.empty() || shown.starts_with("..");
    return shown.empty() ? path(file).string() : shown;
  }
};

Result import_robot(const Arguments& args) {
  namespace fs = std::filesystem;
  const std::string file = args["file"] == "-" ? "standard input" : args["file"];
  const std::string robots = folder_of(args["file"] == "-" ? "" : args["file"]);
  MeshFinder meshes{robots, args["--out"].empty() ? robots : folder_of(args["--out"])};
  const ImportedRobot robot = read_urdf(
      text_of_robot(args["file"]), file, args.has("--floating"),
      [&](const std::string& name) { return meshes.find(name); }, args.all("--without"));
  for (const std::string& kind : args.all("--without"))
    if (std::ranges::none_of(robot.left_out, [&](const auto& line) { return line.starts_with("<" + kind + ">: "); }))
      throw UsageError("--without: no <" + kind + "> is left out; remove it, or correct its name");
  const std::string text = write_json(robot.scene);
  build_mechanism(
      scene_from_text(text, (fs::path(meshes.folder) / (fs::path(file).filename().string() + ", as a scene")).string()),
      builtin_registry());
  for (const std::string& what : robot.left_out) fmt::print(stderr, "note: left out: {}\n", what);
  for (const std::string& why : meshes.refused) fmt::print(stderr, "note: left out: {}\n", why);
  if (meshes.outside)
    fmt::print(stderr,
               "note: meshes are outside the scene's folder; run it with --allow-files, or write it next to the robot "
               "(--out)\n");
  if (args["--out"].empty()) {
    fmt::print("{}", text);
    return kExitOk;
  }
  std::error_code error;
  if (fs::is_regular_file(args["--out"], error))
    throw UsageError("--out: '" + args["--out"] + "' exists; name another file");
  Result scene;
  scene.write(args["--out"], text);
  return scene;
}

}  // namespace

Command import_command() {
  return {"import",
          {Option{"file", "FILE.urdf", "the robot; -: standard input, as in `xacro robot.xacro | lockstep import -`"}
               .needed(),
           {"--out", "FILE.json", "the scene; default: standard output"},
           {"--floating", "", "the base link moves freely; default: it is fixed to the world"},
           Option{"--without", "KIND", "leave elements <KIND> out, even joints; may be repeated"}.repeated()},
          import_robot,
          "Limits become stops, damping becomes forces. Parts that are not converted (mimic, friction) are reported.\n"
          "Joints that are not converted (loop_joint) and misspelt elements are errors without --without.\n\n"
          "Example:\n  lockstep import robot.urdf --out robot.json"};
}

}  // namespace lockstep
