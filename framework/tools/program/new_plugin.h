// Writes the folder of a new plugin: source, CMake file, test, scene, README, from the templates in runner/templates.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lockstep/registry.h>

namespace lockstep {

/// A file of a template; its name and text contain template_<kind> and Template<Kind>, which become the plugin's names.
struct TemplateFile {
  const char* kind;  ///< "link", "coupling", "law", "force", "integrator"
  const char* name;
  const char* text;
};
std::span<const TemplateFile> template_files();

/// The name of the class: "wavy_rail", a link, is WavyRailLink; "my_link" is MyLink.
std::string class_name(const std::string& kind, const std::string& name);

/// Makes the folder `into`/`name` and fills it; returns the files written. Nothing that exists is touched. Throws
/// UsageError for a name that cannot be one (in words: which letters, taken by which type), FileError where a folder or
/// file stands in the way or cannot be written; then none of its files is left behind.
std::vector<std::string> write_plugin(const std::string& kind, const std::string& name, const std::string& into,
                                      const Registry& taken);

}  // namespace lockstep
