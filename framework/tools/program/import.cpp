// The verb import: a robot in URDF becomes a scene.
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <lockstep/error.h>
#include "framework/description/scene/write.h"
#include "framework/tools/import/urdf.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"

namespace lockstep {

namespace {

std::string text_of_robot(const std::string& file) {
  if (file == "-") return standard_input();
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, error))
    throw FileError(
        "cannot read '" + file +
        "': " + (std::filesystem::exists(file, error) ? "it is no file that can be read" : "there is no such file") +
        "; check the path");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

int import_command(const Arguments& args) {
  namespace fs = std::filesystem;
  const std::string file = args.scene == "-" ? "standard input" : args.scene;
  const ImportedRobot robot = read_urdf(text_of_robot(args.scene), file, args.floating);
  const std::string text = write_json(robot.scene);
  build_mechanism(scene_from_text(text, file + ", as a scene"), builtin_registry());
  for (const std::string& what : robot.left_out) fmt::print(stderr, "lockstep: left out: {}\n", what);
  if (args.out.empty()) {
    fmt::print("{}", text);
    return kExitOk;
  }
  std::error_code error;
  if (fs::is_regular_file(args.out, error))
    throw UsageError("--out: '" + args.out + "' is there already; name another file");
  std::ofstream out(args.out, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw FileError("file '" + args.out + "' cannot be written; check the folder, or name another (--out)");
  return kExitOk;
}

}  // namespace lockstep
