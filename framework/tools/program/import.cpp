// The verb import: a robot in URDF becomes a scene.
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <fstream>

#include <lockstep/error.h>
#include "framework/description/scene/write.h"
#include "framework/tools/import/urdf.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/run_report.h"

namespace lockstep {

int import_command(const Arguments& args) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(args.scene, error))
    throw FileError("cannot read '" + args.scene + "': there is no such file; check the path");
  const ImportedRobot robot = read_urdf(contents_of(args.scene), args.scene, args.floating);
  const std::string text = write_json(robot.scene);
  for (const std::string& what : robot.left_out) fmt::print(stderr, "lockstep: left out: {}\n", what);
  if (args.out.empty()) {
    fmt::print("{}", text);
    return kExitOk;
  }
  if (fs::exists(args.out, error)) throw UsageError("--out: '" + args.out + "' is there already; name another file");
  std::ofstream out(args.out, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw FileError("file '" + args.out + "' cannot be written; check the folder, or name another (--out)");
  return kExitOk;
}

}  // namespace lockstep
