// The verbs of the program `lockstep` itself: their options.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>

#include "framework/tools/program/complete.h"
#include "framework/tools/program/manual.h"
#include "framework/tools/program/options.h"

namespace lockstep {

void add_run(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  CLI::Option* report =
      add(verb, "--report", a.report, "FILE.html", "one HTML file that shows the motion and the columns in a browser");
  CLI::Option* certify = verb.add_flag("--certify", a.certify,
                                       "repeat the run with a tighter tolerance and with a second method; report how "
                                       "many digits of each column agree; exit code 11 where not one digit of a "
                                       "column does");
  add(verb, "--budget", a.budget, "T", "CPU time for all runs of --certify together; default 60 s")->needs(certify);
  certify->excludes(add_run_outputs(verb, a));
  CLI::Option* checkpoint = add(
      verb, "--checkpoint", a.checkpoint, "FILE",
      "write all that the run holds to this file now and then, and when it is interrupted; `lockstep resume` goes on "
      "from there. It is removed when the run is done");
  checkpoint->excludes(certify)->excludes(report);
  add(verb, "--every", a.every, "T", "how often, by the clock; default 60 s")->needs(checkpoint);
}

namespace {

void add_resume(CLI::App& verb, Arguments& a) {
  add(verb, "checkpoint", a.checkpoint, "FILE", "what `lockstep run --checkpoint` wrote")->required();
}

void add_report(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  add(verb, "--out", a.report, "FILE.html", "the HTML file; default: beside the CSV, with its name");
  verb.add_flag("--open", a.open, "show it in the browser (xdg-open)");
  add_run_outputs(verb, a);
}

void add_demo(CLI::App& verb, Arguments& a) {
  add(verb, "--into", a.into, "DIR", "folder of its files; default: lockstep_demo in LOCKSTEP_OUTPUT or here");
  verb.add_flag("--no-open", a.no_open, "only write the files, open no browser");
}

void add_check(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  CLI::Option* channels =
      verb.add_flag("--channels", a.channels, "list every channel that the scene may record, with unit and meaning");
  add(verb, "--of", a.name, "NAME", "with --channels: only those of this body, marker, link or force")->needs(channels);
  verb.add_option("more", a.more_scenes, "further scenes")->type_name("SCENE");
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

constexpr Verb kVerbs[] = {
    {"run", "Compute the motion of a scene, write CSV and a picture", add_run, run_command,
     "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv"},
    {"resume", "Go on with a run from its checkpoint", add_resume, resume_command,
     "The run has the command line and the folder that it was begun with, and equals one that was not interrupted, to "
     "the\n"
     "last bit. Scene, plugins and version must be the same.\n\n"
     "Example:\n  lockstep run samples/scenes/four_bar.json --until 10000 --checkpoint four_bar.checkpoint --every "
     "10s\n"
     "  lockstep resume four_bar.checkpoint"},
    {"report", "Run a scene and write it as one HTML file: the mechanism in motion, its columns, its settings",
     add_report, report_command,
     "What `lockstep run` writes is written too. The file needs no network and no other file.\n\n"
     "Example:\n  lockstep report samples/scenes/four_bar.json --open"},
    {"demo", "Show a moving four-bar in the browser, and leave its scene to play with", add_demo, demo_command,
     "Writes four_bar.json, .csv, .png, .svg and .html; a four_bar.json that is there already is shown as it is.\n\n"
     "Example:\n  lockstep demo"},
    {"check", "Read and build a scene; report its bodies, unknowns, rows and degrees of freedom", add_check,
     check_command, "Example:\n  lockstep check samples/scenes/four_bar.json --json"},
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

std::span<const Verb> own_verbs() { return kVerbs; }
const Verb& plugins_list_verb() { return kPluginsList; }

}  // namespace lockstep
