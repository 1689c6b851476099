// The verbs on types, plugins, other formats and the command line: their options.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>

#include "framework/tools/program/complete.h"
#include "framework/tools/program/manual.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

void add_import(CLI::App& verb, Arguments& a) {
  add(verb, "file", a.scene, "FILE.urdf",
      "the robot; -: from standard input, as in `xacro robot.xacro | lockstep import -`")
      ->required();
  add(verb, "--out", a.out, "FILE.json", "the scene; default: standard output");
  verb.add_flag("--floating", a.floating, "the first link is not held; without it, it is fixed in the world");
}

void add_list(CLI::App& verb, Arguments& a) {
  add(verb, "shelf", a.name, "SHELF", "only one of them", {"links", "laws", "forces", "integrators", "solvers"});
  add_plugins(verb, a);
  add_json(verb, a);
}

void add_describe(CLI::App& verb, Arguments& a) {
  add(verb, "name", a.name, "NAME",
      "a name of `lockstep list`; an object of scenes: body, marker, link, force, event, "
      "run, ...; a key; or orientation, axis, law, formula, unit, channel, ...; with --scene a parameter or point");
  add(verb, "--scene", a.scene, "FILE.json",
      "describe a parameter or point of this scene, or all of them: value, place, what hangs on it");
  add_plugins(verb, a);
  add_json(verb, a);
}

void add_new_plugin(CLI::App& verb, Arguments& a) {
  add(verb, "kind", a.kind, "KIND", "link, coupling, law, force or integrator",
      {"link", "coupling", "law", "force", "integrator"})
      ->required();
  add(verb, "name", a.name, "NAME", "its name in scenes, and its folder's: small letters, digits and _")->required();
  add(verb, "--into", a.into, "DIR", "the parent of its folder; default: here");
}

void add_plugins_list(CLI::App& verb, Arguments& a) {
  verb.add_flag("--why", a.why, "report everything: folders, files, builds, and why a plugin is refused");
  add_json(verb, a);
}

void add_completion(CLI::App& verb, Arguments& a) {
  add(verb, "shell", a.kind, "SHELL", "bash or zsh", {"bash", "zsh"})->required();
}

int completion_command(const Arguments& args) {
  fmt::print("{}", completion_script(args.kind));
  return kExitOk;
}

int man_command(const Arguments& args) {
  fmt::print("{}", manual_page(*args.line));
  return kExitOk;
}

void add_nothing(CLI::App&, Arguments&) {}

constexpr Verb kOtherVerbs[] = {
    {"import", "Read a robot in URDF and write it as a scene", add_import, import_command,
     "Limits become stops, damping becomes forces; what is left out (mimicry, friction) is named.\n\n"
     "Example:\n  lockstep import robot.urdf --out robot.json"},
    {"list", "List the laws, links, forces, integrators and solvers that scenes may name", add_list, list_command,
     "Example:\n  lockstep list links"},
    {"describe", "Print what a type or an object of a scene is and which keys it takes", add_describe, describe_command,
     "Example:\n  lockstep describe revolute\n  lockstep describe crank --scene samples/scenes/four_bar.json"},
    {"schema", "Print the JSON Schema of scene files, for editors", add_plugins, schema_command,
     "Example:\n  lockstep schema > scene.schema.json"},
    {"reference", "Print the reference of scenes as a page in Markdown: every object, type, key and unit", add_plugins,
     reference_command, "Example:\n  lockstep reference > reference.md"},
    {"new-plugin", "Write the folder of a plugin: source, CMake file, test, scene; it builds and passes at once",
     add_new_plugin, new_plugin_command, "Example:\n  lockstep new-plugin link wavy_rail"},
    {"completion", "Print the script by which a shell completes lines: verbs, options, names of the scene",
     add_completion, completion_command,
     "Example:\n  lockstep completion bash > ~/.local/share/bash-completion/completions/lockstep"},
    {"man", "Print the manual page", add_nothing, man_command, "Example:\n  lockstep man | man -l -"},
};
constexpr Verb kPluginsList = {"list", "Load each plugin of the search path; report what it brings", add_plugins_list,
                               plugins_list_command,
                               "Example:\n  LOCKSTEP_PLUGIN_PATH=~/my/plugins lockstep plugins list --why"};

}  // namespace

std::span<const Verb> other_verbs() { return kOtherVerbs; }
const Verb& plugins_list_verb() { return kPluginsList; }

}  // namespace lockstep
