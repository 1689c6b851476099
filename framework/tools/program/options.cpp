#include "framework/tools/program/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace lockstep {

// "AXIS:{off,auto,x}" holds the choices of an option.
Choices choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  Choices all;
  std::size_t begin = open + 1;
  while (begin < close) {
    const std::size_t end = std::min(type.find(',', begin), close);
    all.push_back(type.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

std::string value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help) {
  return verb.add_option(name, to, help)->type_name(type);
}
CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help,
                 const Choices& choices) {
  return add(verb, name, to, type, help)->check(CLI::IsMember(choices));
}

CLI::Option* add_each(CLI::App& verb, const char* name, std::vector<std::string>& to, const char* type,
                      const std::string& help) {
  return verb.add_option(name, to, help)->type_name(type)->allow_extra_args(false);
}
CLI::Option* add_names(CLI::App& verb, const char* name, std::vector<std::string>& to, const std::string& help) {
  return add_each(verb, name, to, "A,B", help)->delimiter(',');
}

CLI::Option* add_json(CLI::App& verb, Arguments& a) {
  return verb.add_flag("--json", a.json, "print the result as JSON, and nothing else");
}

void add_plugins(CLI::App& verb, Arguments& a) {
  add_each(verb, "--plugin", a.plugins, "P", "load a plugin, by name or path; may be given several times");
}

void add_scene(CLI::App& verb, Arguments& a) {
  add(verb, "scene", a.scene, "SCENE", "the scene file (JSON); -: from standard input")->required();
  add_plugins(verb, a);
  add(verb, "--planar", a.planar, "AXIS", "planar motion, by its normal; auto: where that is exact",
      {"off", "auto", "x", "y", "z"});
  add_each(
      verb, "--set", a.set, "NAME=VALUE",
      "NAME=VALUE: another value of a parameter (crank=\"120 mm\"), or of a path as in `lockstep sweep --help`; may be "
      "repeated");
  verb.add_flag("--allow-files", a.allow_files, "let the scene read files outside of its folder");
  add(verb, "--nearly-redundant", a.nearly_redundant, "WORD",
      "rows that depend on others but for a singular value below 1e-3: held (auto, where that can be), left out "
      "(free), "
      "or told and not decided",
      {"auto", "told", "free", "held"});
  verb.add_flag("--full", a.full, "no shortcuts: neither planar motion nor merged bodies nor coordinates of joints");
}

// What run and sweep share.
void add_settings(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add(verb, "--integrator", a.integrator, "N", "see `lockstep list integrators`; with keys: dopri5:fixed=true");
  CLI::Option* step = add(verb, "--step", a.step, "H", "fixed step, or the largest step of an adaptive integrator, s");
  add(verb, "--tolerance", a.tolerance, "T", "relative tolerance of adaptive integrators")->excludes(step);
  add(verb, "--until", a.until, "T", "end of the run, s");
  add(verb, "--formulation", a.formulation, "F",
      "unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of the "
      "joints "
      "where that can be, else omega",
      formulation_names());
  add(verb, "--stabilization", a.stabilization, "S", "constraint stabilisation", kStabilizations);
  add(verb, "--solver", a.solver, "N", "see `lockstep list solvers`");
}

void add_headers(CLI::App& verb, Arguments& a) {
  add(verb, "--headers", a.headers, "KIND", "names of the CSV's columns: with units, \"x [m]\", or plain, \"x\"",
      {"units", "plain"});
}

CLI::Option* add_run_outputs(CLI::App& verb, Arguments& a) {
  add(verb, "--record", a.record, "FILE.csv",
      "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here; -: standard output, and words to standard error");
  verb.add_flag(
      "--strict", a.strict,
      "end with 11 where the result is doubtful: singular positions passed with plain stages, a tolerance that "
      "was not reached, recorded reactions beside a singular position");
  add_headers(verb, a);
  verb.add_flag("--at-jumps", a.at_jumps, "rows also just before and just after events, impacts and jumps of laws");
  CLI::Option* pictures =
      add_each(verb, "--picture", a.pictures, "X:Y",
               "X:Y: one more picture, of column Y against column X (the path of a point); may be repeated");
  verb.add_flag("--no-picture", a.no_picture, "draw no picture beside the CSV file")->excludes(pictures);
  CLI::Option* quiet =
      verb.add_flag("--quiet", a.quiet, "print errors only; energy is then not integrated and not judged, drift is");
  return add_json(verb, a)->excludes(quiet);
}

}  // namespace lockstep
