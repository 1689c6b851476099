// SPDX-License-Identifier: BSD-3-Clause
// The command demo: a mechanism that moves, from nothing but the program.

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "framework/tools/program/files.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

Result show_demo(const Arguments& args) {
  const fs::path folder = args["--into"].empty() ? (fs::path(output_folder()) / "lockstep_demo").lexically_normal()
                                                 : fs::path(args["--into"]);
  make_folder(folder.string(), "go to another folder, or name one (--into)");
  const std::string scene = (folder / "four_bar.json").string();
  std::error_code error;
  Result written;
  if (!fs::exists(scene, error))
    written.write(scene, demo_scene());
  else  // it stays, with the changes made to it
    fmt::print("{} exists; it is shown unchanged\n", scene);
  Arguments run = args;
  run.set("scene", scene);
  run.set("--record", (folder / "four_bar.csv").string());
  run.set("--report", (folder / "four_bar.html").string());
  if (!args.has("--no-open")) run.set("--open", "");
  Result result = run_scene(run);
  result.files.insert(result.files.begin(), written.files.begin(), written.files.end());
  print(result, args);
  fmt::print(
      "\nNext:\n"
      "  change the crank   lockstep report {0} --set crank=\"80 mm\" --open\n"
      "  check the scene    lockstep check {0}\n"
      "  list its keys      lockstep describe scene\n",
      in_quotes(scene));
  return result.code;
}

}  // namespace

Command demo_command() {
  return {"demo",
          {{"--into", "DIR", "folder of the files; default: lockstep_demo in LOCKSTEP_OUTPUT or here"},
           {"--no-open", "", "write the files without opening a browser"},
           {"--summary", "", "print the extremes of all recorded columns, with their times"}},
          show_demo,
          "Writes four_bar.json, .csv, .png, .svg and .html. If four_bar.json exists, it is shown unchanged.\n\n"
          "Example:\n  lockstep demo"};
}

}  // namespace lockstep
