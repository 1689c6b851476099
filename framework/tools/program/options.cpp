// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/options.h"

#include <algorithm>

#include <lockstep/text.h>
#include "framework/foundation/support/lines.h"
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

Options grouped(std::string_view heading, Options options) {
  for (Option& o : options) o.group = heading;
  return options;
}

std::string Option::words() const {
  std::string all(help);
  const std::vector<std::string> words = lines_of(choices, ',');
  if (std::ranges::any_of(words, [&](const std::string& w) { return all.find(w) == std::string::npos; }))
    all += " (" + text::join(words, " or ") + ")";
  return needs.empty() ? all : all + " (with " + std::string(needs) + ")";
}

Options scene_options() {
  return grouped(
      "Scene",
      {Option{"scene", "SCENE", "scene file (JSON); -: standard input"}.needed(),
       Option{"--set", "NAME=VALUE",
              "another value for a parameter (crank=\"120 mm\") or a path (bodies.arm.mass=2); may be repeated"}
           .repeated(),
       kPlugin,
       {"--allow-files", "", "let the scene read files outside its folder"},
       Option{"--planar", "AXIS",
              "normal of the plane of motion: x, y or z; off: motion in space; auto (default): in a plane if that is "
              "exact"}
           .among("off,auto,x,y,z"),
       {"--full", "", "no simplifications: motion in space, no merged bodies, absolute coordinates"},
       Option{
           "--nearly-redundant", "CHOICE",
           "nearly dependent constraints: held keeps them, free drops them, report only reports them, auto (default) "
           "drops them unless joints would open"}
           .among("auto,report,free,held")});
}

Options settings_options() {
  return join(
      {scene_options(),
       grouped(
           "Method (defaults if the scene has none)",
           {{"--until", "TIME", "end of the run, in s or with a unit (\"50 ms\")"},
            {"--output", "TIME", "interval between the rows of the table; default: every step"},
            {"--integrator", "NAME", "default dopri5; see `lockstep list integrators`; with keys: dopri5:fixed=true"},
            {"--step", "TIME",
             "the step of a fixed-step integrator, the largest step of an adaptive one; in s or with a unit"},
            {"--tolerance", "NUMBER", "relative tolerance of adaptive integrators; default 1e-6"},
            Option{"--formulation", "NAME",
                   "coordinates: joint (relative), omega (6 velocities per body), quaternion (7 per body); auto "
                   "(default): joint if it costs less and the integrator supports it"}
                .among(kFormulations),
            {"--solver", "NAME", "default schur; see `lockstep list solvers`"},
            Option{"--stabilization", "NAME", "of the constraints: project (default), baumgarte or none"}.among(
                kStabilizations)})});
}

Options run_outputs() {
  return grouped(
      "Results",
      {{"--record", "FILE.csv",
        "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here; -: standard output, messages to standard "
        "error"},
       {"--summary", "", "print the extremes of all recorded columns over the motion, and when they occur"},
       {"--verbose,-v", "", "also print assembly, method and energy by source"},
       {"--quiet", "", "print errors only"},
       kJson.without("--quiet,--certify"),
       {"--strict", "",
        "exit code 11 for a doubtful result: singular configuration passed, tolerance not reached, uncertain "
        "reactions"},
       kPicture,
       kNoPicture.without("--picture"),
       kHeaders,
       {"--at-jumps", "", "also write rows just before and after events, impacts and jumps of laws"}});
}

Options run_options() {
  return join(
      {settings_options(),
       grouped("Results", {{"--report", "FILE.html", "one HTML file with the moving mechanism and its plots"}}),
       grouped("Verified digits",
               {{"--certify", "",
                 "repeat with a tighter tolerance and with a second method; report to how many digits each column "
                 "agrees; exit code 11 if one agrees in no digit"},
                Option{"--budget", "TIME", "CPU time for all runs of --certify together; default 60 s"}.along(
                    "--certify")}),
       run_outputs(),
       grouped(
           "Checkpoints",
           {Option{"--checkpoint", "FILE",
                   "write checkpoints to this file, for `lockstep resume`; it is removed when the run is done"}
                .without("--certify,--report"),
            Option{"--every", "TIME", "wall-clock time between checkpoints; default 60 s"}.along("--checkpoint")})});
}

Json results_of(std::span<const Command> commands) {
  Json all = Json::object();
  for (const Command& c : commands)
    if (!c.results.empty()) all[c.name] = schema_of(c.results, c.option("more") != nullptr);
  return all;
}

Json results_of_all() {
  Json all = results_of(own_commands());
  for (const std::string& line : lines_of(ask_tools("results")))
    if (const Json more = Json::parse(line); true)
      for (const auto& [name, schema] : more.items())
        if (!all.contains(name)) all[name] = schema;
  return all;
}

std::vector<Command> own_commands() {
  return {run_command(),        resume_command(),   report_command(),      demo_command(),      check_command(),
          list_command(),       describe_command(), schema_command(),      reference_command(), new_plugin_command(),
          completion_command(), man_command(),      plugins_list_command()};
}

}  // namespace lockstep
