// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/new_plugin.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cctype>
#include <filesystem>
#include <regex>

#include "framework/description/registry/shelves.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

std::string capitalised(std::string word) {
  if (!word.empty()) word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
  return word;
}

void check_letters(const std::string& name) {
  static const std::regex kName("[a-z][a-z0-9]*(_[a-z0-9]+)*");
  if (name.size() > 60 || !std::regex_match(name, kName))
    throw UsageError(
        fmt::format("new-plugin: \"{}\" cannot be a plugin's name; use small letters, digits and single _, "
                    "a letter first, at most 60, as in wavy_rail",
                    name));
  if (name.starts_with("lib"))
    throw UsageError(
        fmt::format("new-plugin: \"{}\" begins with \"lib\", which lockstep removes from the name of a plugin's file "
                    "(libbump.so is plugin bump); use a name without it",
                    name));
}

void check_free(const std::string& kind, const std::string& name, const Registry& taken) {
  for_each_shelf([&](auto, const std::string& by, auto shelf) {
    if ((taken.*shelf).find(name) == nullptr) return;
    throw UsageError(
        fmt::format("new-plugin: \"{}\" is already {} {} of lockstep (`lockstep describe {}`); use another name", name,
                    by.front() == 'i' ? "an" : "a", by == "link" ? "joint" : by, name));
  });
  // Names of lockstep's own classes, and of CMake's own targets.
  constexpr std::array kClasses = {"MotionLaw",     "TranslationLaw", "RotationLaw", "MarkerForce", "AppliedForce",
                                   "FunctionForce", "FormulaForce",   "PhiCoupling", "MaskJoint"};
  const std::string made = class_name(kind, name);
  if (std::find(kClasses.begin(), kClasses.end(), made) != kClasses.end())
    throw UsageError(
        fmt::format("new-plugin: the class of \"{}\" would be {}, which lockstep has; use another name", name, made));
  constexpr std::array kTargets = {"all",      "clean",   "edit_cache", "help",          "install",
                                   "lockstep", "package", "preinstall", "rebuild_cache", "test"};
  if (std::find(kTargets.begin(), kTargets.end(), name) != kTargets.end())
    throw UsageError(fmt::format("new-plugin: \"{}\" is a target of every CMake project; use another name", name));
}

Result make_plugin(const Arguments& args) {
  const std::string kind = args["kind"] == "link" ? "joint" : args["kind"];
  const std::vector<std::string> files = write_plugin(kind, args["name"], args["--into"], builtin_registry());
  const std::string folder = fs::path(files.front()).parent_path().string();
  for (const std::string& file : files) fmt::print("{}\n", file);
  fmt::print("Build and test: cmake -S {0} -B {0}/build && cmake --build {0}/build && ctest --test-dir {0}/build -V\n",
             folder);
  return kExitOk;
}

}  // namespace

std::string class_name(const std::string& kind, const std::string& name) {
  std::string camel;
  for (const std::string& word : lines_of(name, '_')) camel += capitalised(word);
  const std::string end = capitalised(kind);
  return camel.size() > end.size() && camel.ends_with(end) ? camel : camel + end;
}

std::vector<std::string> write_plugin(const std::string& kind, const std::string& name, const std::string& into,
                                      const Registry& taken) {
  check_letters(name);
  check_free(kind, name, taken);
  const fs::path folder = fs::path(into.empty() ? "." : into) / name;
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder, error)))
    throw FileError(
        fmt::format("{}: exists and is left unchanged; use another name, or --into another folder", folder.string()));
  if (!fs::create_directories(folder, error))
    throw FileError(
        fmt::format("{}: cannot be created: {}; give --into a writable folder", folder.string(), error.message()));
  Result made;
  try {
    for (const TemplateFile& file : template_files()) {
      if (file.kind != kind) continue;
      const std::string old_name = "template_" + kind, old_class = "Template" + capitalised(kind);
      const auto renamed = [&](const std::string& text) {
        return boost::replace_all_copy(boost::replace_all_copy(text, old_name, name), old_class,
                                       class_name(kind, name));
      };
      made.write((folder / renamed(file.name)).string(), renamed(file.text));
    }
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  return made.files;
}

Command new_plugin_command() {
  return {"new-plugin",
          {Option{"kind", "KIND", "what it adds"}.among("joint,coupling,law,force,integrator,link").needed(),
           Option{"name", "NAME", "its name in scenes and of its folder: small letters, digits and _"}.needed(),
           {"--into", "DIR", "the parent of its folder; default: here"}},
          make_plugin,
          "Example:\n  lockstep new-plugin joint wavy_rail"};
}

}  // namespace lockstep
