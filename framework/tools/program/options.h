// Verbs with their options, and what several verbs share of these.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/tools/program/commands.h"

namespace CLI {
class Option;
}

namespace lockstep {

/// A verb of the program.
struct Verb {
  const char* name;
  const char* help;  ///< "": as tools() has it
  void (*add_options)(CLI::App&, Arguments&);
  int (*run)(const Arguments&);
  const char* footer;
};

/// Those of the program `lockstep`, but for `plugins list`.
std::span<const Verb> own_verbs();
/// `plugins list`.
const Verb& plugins_list_verb();

using Choices = std::vector<std::string>;
inline const Choices kStabilizations{"project", "baumgarte", "none"};

/// The choices of an option; none where it takes anything.
Choices choices_of(const CLI::Option&);
/// What stands for its value in help texts: "H", "FILE.csv".
std::string value_of(const CLI::Option&);

/// An option or a positional, as text.
CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help);
/// One of some words.
CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help,
                 const Choices& choices);
/// One that may be given several times, a value each.
CLI::Option* add_each(CLI::App& verb, const char* name, std::vector<std::string>& to, const char* type,
                      const std::string& help);
/// Names, with commas between them.
CLI::Option* add_names(CLI::App& verb, const char* name, std::vector<std::string>& to, const std::string& help);
CLI::Option* add_json(CLI::App& verb, Arguments&);
void add_plugins(CLI::App& verb, Arguments&);
/// The scene, and what changes it.
void add_scene(CLI::App& verb, Arguments&);
/// The scene, and how it is run.
void add_settings(CLI::App& verb, Arguments&);
/// All that `run` takes.
void add_run(CLI::App& verb, Arguments&);
/// --headers.
void add_headers(CLI::App& verb, Arguments&);
/// What a run writes beside its report. Returns --json.
CLI::Option* add_run_outputs(CLI::App& verb, Arguments&);

}  // namespace lockstep
