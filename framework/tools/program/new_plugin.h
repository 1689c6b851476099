// SPDX-License-Identifier: BSD-3-Clause
// Writes the folder of a new plugin from the templates: source, CMake file, test, scene, README.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>

namespace lockstep {

/// A file of a template. template_<kind> and Template<Kind> in its name and text become the plugin's names.
struct TemplateFile {
  const char* kind;  ///< "joint", "coupling", "law", "force", "integrator"
  const char* name;
  const char* text;
};
std::span<const TemplateFile> template_files();

/// The name of the class: WavyRailJoint of the joint "wavy_rail", MyJoint of "my_joint".
std::string class_name(const std::string& kind, const std::string& name);

/// Makes the folder `into`/`name` and fills it; returns the files written. Existing files are never touched. Throws
/// UsageError for an invalid or taken name, FileError if the folder exists or cannot be written; then it leaves no file
/// behind.
std::vector<std::string> write_plugin(const std::string& kind, const std::string& name, const std::string& into,
                                      const Registry& taken);

}  // namespace lockstep
