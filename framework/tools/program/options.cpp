// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/options.h"

#include <algorithm>

#include "framework/tools/program/tools.h"

namespace lockstep {

Options join(std::initializer_list<Options> lists) {
  Options all;
  for (const Options& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

const Option* Command::option(std::string_view word) const {
  const auto found = std::ranges::find_if(options, [&](const Option& o) { return o.is(word); });
  return found == options.end() ? nullptr : &*found;
}

std::vector<std::string> words_of(std::string_view choices) {
  std::vector<std::string> all;
  while (!choices.empty()) {
    const std::size_t comma = std::min(choices.find(','), choices.size());
    all.emplace_back(choices.substr(0, comma));
    choices.remove_prefix(std::min(comma + 1, choices.size()));
  }
  return all;
}

const Options& scene_options() {
  static const Options kOptions{
      Option{"scene", "SCENE", "the scene file (JSON); -: from standard input"}.needed(),
      kPlugin,
      Option{"--planar", "AXIS", "planar motion, by its normal; auto: where that is exact"}.among("off,auto,x,y,z"),
      Option{"--set", "NAME=VALUE",
             "NAME=VALUE: another value of a parameter (crank=\"120 mm\"), or of a path as in `lockstep sweep --help`; "
             "may be repeated"}
          .repeated(),
      {"--allow-files", "", "let the scene read files outside of its folder"},
      Option{"--nearly-redundant", "WORD",
             "rows that depend on others but for a singular value below 1e-3: held (auto, where that can be), left out "
             "(free), or told and not decided"}
          .among("auto,told,free,held"),
      {"--full", "", "no shortcuts: neither planar motion nor merged bodies nor coordinates of joints"}};
  return kOptions;
}

const Options& settings_options() {
  static const Options kOptions = join(
      {scene_options(),
       {{"--integrator", "N", "see `lockstep list integrators`; with keys: dopri5:fixed=true"},
        {"--step", "H", "fixed step, or the largest step of an adaptive integrator, s"},
        Option{"--tolerance", "T", "relative tolerance of adaptive integrators"}.without("--step"),
        {"--until", "T", "end of the run, s"},
        Option{"--formulation", "F",
               "unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of "
               "the joints where that can be, else omega"}
            .among(kFormulations),
        Option{"--stabilization", "S", "constraint stabilisation"}.among(kStabilizations),
        {"--solver", "N", "see `lockstep list solvers`"}}});
  return kOptions;
}

namespace {

// What a run writes beside its report.
Options run_outputs() {
  return {
      {"--record", "FILE.csv",
       "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here; -: standard output, and words to standard "
       "error"},
      {"--strict", "",
       "end with 11 where the result is doubtful: singular positions passed with plain stages, a tolerance that was "
       "not reached, recorded reactions beside a singular position"},
      kHeaders,
      {"--at-jumps", "", "rows also just before and just after events, impacts and jumps of laws"},
      Option{"--picture", "X:Y",
             "X:Y: one more picture, of column Y against column X (the path of a point); may be repeated"}
          .repeated(),
      Option{"--no-picture", "", "draw no picture beside the CSV file"}.without("--picture"),
      {"--quiet", "", "print errors only; energy is then not integrated and not judged, drift is"},
      kJson.without("--quiet,--certify")};
}

}  // namespace

const Options& run_options() {
  static const Options kOptions = join(
      {settings_options(),
       {{"--report", "FILE.html", "one HTML file that shows the motion and the columns in a browser"},
        {"--certify", "",
         "repeat the run with a tighter tolerance and with a second method; report how many digits of each column "
         "agree; exit code 11 where not one digit of a column does"},
        Option{"--budget", "T", "CPU time for all runs of --certify together; default 60 s"}.along("--certify")},
       run_outputs(),
       {Option{"--checkpoint", "FILE",
               "write all that the run holds to this file now and then, and when it is interrupted; `lockstep resume` "
               "goes on from there. It is removed when the run is done"}
            .without("--certify,--report"),
        Option{"--every", "T", "how often, by the clock; default 60 s"}.along("--checkpoint")}});
  return kOptions;
}

std::vector<Command> own_commands() {
  return {
      {"run", kRun, "Compute the motion of a scene, write CSV and a picture", run_options(), run_command,
       "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv"},
      {"resume",
       kRun,
       "Go on with a run from its checkpoint",
       {Option{"checkpoint", "FILE", "what `lockstep run --checkpoint` wrote"}.needed()},
       resume_command,
       "The run has the command line and the folder that it was begun with, and equals one that was not interrupted, "
       "to "
       "the\nlast bit. Scene, plugins and version must be the same.\n\n"
       "Example:\n  lockstep run samples/scenes/four_bar.json --until 10000 --checkpoint four_bar.checkpoint --every "
       "10s\n  lockstep resume four_bar.checkpoint"},
      {"report", kRun, "Run a scene and write it as one HTML file: the mechanism in motion, its columns, its settings",
       join({settings_options(),
             {{"--out", "FILE.html", "the HTML file; default: beside the CSV, with its name"},
              {"--open", "", "show it in the browser (xdg-open)"}},
             run_outputs()}),
       report_command,
       "What `lockstep run` writes is written too. The file needs no network and no other file.\n\n"
       "Example:\n  lockstep report samples/scenes/four_bar.json --open"},
      {"demo",
       kRun,
       "Show a moving four-bar in the browser, and leave its scene to play with",
       {{"--into", "DIR", "folder of its files; default: lockstep_demo in LOCKSTEP_OUTPUT or here"},
        {"--no-open", "", "only write the files, open no browser"}},
       demo_command,
       "Writes four_bar.json, .csv, .png, .svg and .html; a four_bar.json that is there already is shown as it is.\n\n"
       "Example:\n  lockstep demo"},
      {"check", kLook, "Read and build a scene; report its bodies, unknowns, rows and degrees of freedom",
       join({scene_options(),
             {kJson,
              {"--channels", "", "list every channel that the scene may record, with unit and meaning"},
              Option{"--of", "NAME", "with --channels: only those of this body, marker, link or force"}.along(
                  "--channels"),
              Option{"more", "SCENE", "further scenes"}.repeated()}}),
       check_command, "Example:\n  lockstep check samples/scenes/four_bar.json --json"},
      {"list",
       kLook,
       "List the laws, links, forces, integrators and solvers that scenes may name; `list findings`: what may be found",
       {Option{"shelf", "SHELF", "only one of them"}.among("links,laws,forces,integrators,solvers,findings"), kPlugin,
        kJson},
       list_command,
       "Example:\n  lockstep list links"},
      {"describe",
       kLook,
       "Print what a type, an object of a scene or a finding is, and which keys it takes",
       {{"name", "NAME",
         "a name of `lockstep list`; an object of scenes: body, marker, link, force, event, run, ...; a key; or "
         "orientation, axis, law, formula, unit, channel, ...; with --scene a parameter or point"},
        {"--scene", "FILE.json",
         "describe a parameter or point of this scene, or all of them: value, place, what hangs on it"},
        kPlugin,
        kJson},
       describe_command,
       "Example:\n  lockstep describe revolute\n  lockstep describe crank --scene samples/scenes/four_bar.json"},
      {"schema",
       kLook,
       "Print the JSON Schema of scene files, for editors",
       {kPlugin},
       schema_command,
       "Example:\n  lockstep schema > scene.schema.json"},
      {"reference",
       kLook,
       "Print the reference of scenes as a page in Markdown: every object, type, key and unit; or that of findings",
       {Option{"page", "PAGE", "default: scenes"}.among("scenes,findings"), kPlugin},
       reference_command,
       "Example:\n  lockstep reference > reference.md"},
      {"new-plugin",
       kExtend,
       "Write the folder of a plugin: source, CMake file, test, scene; it builds and passes at once",
       {Option{"kind", "KIND", "link, coupling, law, force or integrator"}
            .among("link,coupling,law,force,integrator")
            .needed(),
        Option{"name", "NAME", "its name in scenes, and its folder's: small letters, digits and _"}.needed(),
        {"--into", "DIR", "the parent of its folder; default: here"}},
       new_plugin_command,
       "Example:\n  lockstep new-plugin link wavy_rail"},
      {"completion",
       kExtend,
       "Print the script by which a shell completes lines: verbs, options, names of the scene",
       {Option{"shell", "SHELL", "bash or zsh"}.among("bash,zsh").needed()},
       completion_command,
       "Example:\n  lockstep completion bash > ~/.local/share/bash-completion/completions/lockstep"},
      {"man", kExtend, "Print the manual page", {}, man_command, "Example:\n  lockstep man | man -l -"},
      {"plugins list",
       kExtend,
       "Load each plugin of the search path; report what it brings",
       {{"--why", "", "report everything: folders, files, builds, and why a plugin is refused"}, kJson},
       plugins_list_command,
       "Example:\n  LOCKSTEP_PLUGIN_PATH=~/my/plugins lockstep plugins list --why"}};
}

}  // namespace lockstep
