// SPDX-License-Identifier: BSD-3-Clause
// The command demo: a mechanism that moves, from nothing but the program.
#include "framework/tools/program/demo.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "framework/tools/program/files.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/run_report.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

// An existing scene, with the changes made to it, stays.
std::string scene_in(const fs::path& folder) {
  make_folder(folder.string(), "go to another folder, or name one (--into)");
  const std::string file = (folder / "four_bar.json").string();
  std::error_code error;
  if (!fs::exists(file, error))
    Result().write(file, demo_scene());
  else if (contents_of(file) != demo_scene())
    fmt::print("{} exists and is shown unchanged\n", file);
  return file;
}

Result show_demo(const Arguments& args) {
  const fs::path folder = args["--into"].empty() ? (fs::path(output_folder()) / "lockstep_demo").lexically_normal()
                                                 : fs::path(args["--into"]);
  Arguments run = args;
  const std::string scene = scene_in(folder);
  run.set("scene", scene);
  run.set("--record", (folder / "four_bar.csv").string());
  run.set("--report", (folder / "four_bar.html").string());
  if (!args.has("--no-open")) run.set("--open", "");
  if (contents_of(scene) == demo_scene()) run.set("--until", "2.5");  // some revolutions
  const Result result = run_scene(run);
  fmt::print(
      "\nNext:\n"
      "  lockstep report {0} --set crank=\"80 mm\" --open     change the crank\n"
      "  lockstep check {0}                              bodies, joints, degrees of freedom\n"
      "  lockstep describe scene                         keys of a scene\n",
      scene);
  return result;
}

}  // namespace

Command demo_command() {
  return {"demo",
          {{"--into", "DIR", "folder of the files; default: lockstep_demo in LOCKSTEP_OUTPUT or here"},
           {"--no-open", "", "write the files without opening a browser"}},
          show_demo,
          "Writes four_bar.json, .csv, .png, .svg and .html. An existing four_bar.json is shown unchanged.\n\n"
          "Example:\n  lockstep demo"};
}

}  // namespace lockstep
