// SPDX-License-Identifier: BSD-3-Clause
// The command advise: the cheapest method and setting that met a wanted error on the user's own scene.
#include <spdlog/fmt/fmt.h>

#include <optional>

#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/benchmark_fields.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/precision/pareto.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/run_report.h"

namespace lockstep {
namespace {

constexpr double kError = 1e-6;  // SI

ErrorKind kind_of(const Arguments& args) {
  for (const ErrorKind kind : kErrorKinds)
    if (to_string(kind) == args["--of"]) return kind;
  return ErrorKind::position;
}

/// A setting of a run: its key, its value in a scene, and as a word of the command line, "" where that needs none.
struct Setting {
  std::string key;
  Value value;
  std::string word;
};

// What the choice of a run changes in the scene. `run`: all its settings.
std::vector<Setting> settings_to_change(const Arguments& args, const RunSettings& scene, const SceneBenchmark& measured,
                                        const WorkPrecisionRun& best, const RunSettings& run) {
  std::vector<Setting> all{{"integrator", to_value(run.integrator), in_quotes(best.integrator)},
                           {best.adaptive ? "tolerance" : "step", best.setting, text::number(best.setting)}};
  const double largest_step = measured.options.largest_step;
  if (best.adaptive && largest_step > 0) all.push_back({"step", largest_step, ""});
  if (!args.all("--formulations").empty() || best.formulation != measured.base.formulation)
    all.push_back({"formulation", to_string(best.formulation), to_string(best.formulation)});
  if (const Stabilization& s = run.stabilization, usual; best.stabilization != scene.stabilization.kind) {
    Value kind = to_string(s.kind);
    if (s.alpha != usual.alpha || s.beta != usual.beta || s.tolerance != usual.tolerance)
      kind = Value::object({{"kind", kind}, {"alpha", s.alpha}, {"beta", s.beta}, {"tolerance", s.tolerance}});
    all.push_back({"stabilization", std::move(kind), to_string(best.stabilization)});
  }
  const bool other_solver = !args.all("--solvers").empty() || best.solver != to_word(scene.solver);
  if (other_solver && !needs_no_solver(best.formulation))
    all.push_back({"solver", to_value(run.solver), in_quotes(best.solver)});
  return all;
}

std::string command_line(const Arguments& args, const std::vector<Setting>& changed) {
  std::string text = "lockstep run " + in_quotes(args["scene"]);
  for (const std::string& plugin : args.all("--plugin")) text += " --plugin " + in_quotes(plugin);
  for (const Setting& s : changed)
    if (!s.word.empty()) text += " --" + s.key + " " + s.word;
  if (!args["--until"].empty()) text += " --until " + in_quotes(args["--until"]);
  if (!args["--planar"].empty()) text += " --planar " + args["--planar"];
  if (args.has("--full")) text += " --full";
  return text;
}

// The same as keys of the scene's "run".
std::string run_block(const std::vector<Setting>& changed) {
  Value block = Value::object({});
  for (const Setting& s : changed) block.object()->push_back({s.key, s.value, {}});
  return write_json(block);
}

// The run that came closest to an error; null if the references differ by more than that.
const WorkPrecisionRun* nearest_of(const WorkPrecision& result, ErrorKind kind, double error) {
  const WorkPrecisionRun* best = nullptr;
  if (result.agreement.of(kind) > error) return best;
  for (const WorkPrecisionRun& run : result.runs)
    if (counts(result, run, kind) && (best == nullptr || run.error.of(kind) < best->error.of(kind))) best = &run;
  return best;
}

/// A run, and how to repeat it.
struct Choice {
  CostAtError cost;
  std::string command, block;
};
struct Advised {
  double error;
  ErrorKind kind;
  std::optional<Choice> cheapest, second;
  std::vector<CostAtError> each{};            // the cheapest of each integrator
  std::optional<WorkPrecisionRun> nearest{};  // if none met the error
  const WorkPrecision* measured;
};
std::string hint_of(const Advised& a) {
  const double agreement = a.measured->agreement.of(a.kind);
  if (agreement > a.error)
    return fmt::format(
        "the reference solutions differ by {:.2g} {}, so no method can be shown to meet the error; allow a larger "
        "error, or shorten the run (--until)",
        agreement, unit_of(a.kind));
  if (!a.cheapest && a.measured->left_out.empty()) return "allow a larger error, other methods or finer settings";
  if (!a.cheapest) return "increase --budget, or allow a larger error";
  if (!a.cheapest->cost.confirmed) return "not confirmed by a finer run; increase --budget";
  if (a.cheapest->command.find(" --stabilization none") == std::string::npos) return "";
  return "without stabilisation the constraints drift in longer runs; to exclude it, repeat lockstep advise with "
         "--stabilizations project";
}
const Fields<Choice> kChoiceFields = [] {
  Fields<Choice> all{{"command", "", "command", &Choice::command},
                     {"run", "", "or in the scene's \"run\"", [](const Choice& c) { return Json::parse(c.block); },
                      [](const Json& block) { return block.dump(); }}};
  const Fields<Choice> costs = Fields<Choice>{}.with(&Choice::cost, kCostFields);
  for (Field<Choice> f : costs.fields()) f.info.label.clear(), all.add(f);  // text has them in its table
  return all;
}();
const Fields<Advised> kAdviseFields = Fields<Advised>{
    {"error", "", "", &Advised::error},
    {"unit", "", "", [](const Advised& a) { return unit_of(a.kind); }},
    {"of", "", "", [](const Advised& a) { return to_string(a.kind); }},
    {"wanted", "", "wanted",
     [](const Advised& a) {
       return fmt::format("{} error of at most {:.3g} {}{}", to_string(a.kind), a.error, unit_of(a.kind),
                          a.cheapest ? "" : ": no run met it");
     }},
    {"cheapest", "cheapest", &Advised::cheapest, kChoiceFields},
    {"runner_up", "", &Advised::second, kChoiceFields},
    {"nearest", "best run", &Advised::nearest, kMeasuredFields},
    {"hint", "", "next", hint_of},
    {"each", "cheapest of each integrator, the recommended one first", &Advised::each,
     kCostFields}}.with([](const Advised& a) -> const WorkPrecision& { return *a.measured; }, kMeasurementFields);

// The recommended run of each integrator that met the error; the one to recommend first.
std::vector<CostAtError> each_of(std::vector<CostAtError> costs) {
  std::vector<CostAtError> each;
  while (const CostAtError* best = recommended(costs)) {
    each.push_back(*best);
    std::erase_if(costs, [type = integrator_type(best->run->integrator)](const CostAtError& c) {
      return integrator_type(c.run->integrator) == type;
    });
  }
  return each;
}

Result advise(const Arguments& given) {
  const Arguments args = measuring_arguments(given);
  Loaded loaded = load(args);
  const double error = args["--error"].empty() ? kError : positive_number("--error", args["--error"], Unit::none);
  const ErrorKind kind = kind_of(args);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], "", loaded.scene);
  const Interrupt interrupt;
  SceneBenchmark benchmark = benchmark_of(loaded, args);
  benchmark.options.target = error, benchmark.options.target_kind = kind;
  const std::unique_ptr<WorkPrecision> result = measure(benchmark, args, interrupt);
  if (!result) return kExitInterrupted;
  if (!report.empty())
    write_runs_report(report, text_of(args, loaded), runs_text(*result), "cpu [s]",
                      fmt::format("{} error [{}]", to_string(kind), unit_of(kind)), true);
  const std::vector<CostAtError> each = each_of(costs_at_error(*result, error, kind));
  const WorkPrecisionRun* nearest = nearest_of(*result, kind, error);
  const auto choice = [&](std::size_t k) -> std::optional<Choice> {
    if (k >= each.size()) return {};
    const WorkPrecisionRun& best = *each[k].run;
    const RunSettings run = settings_of(loaded.scene.run, best, loaded.registry);
    const std::vector<Setting> changed = settings_to_change(args, loaded.scene.run, benchmark, best, run);
    return Choice{each[k], command_line(args, changed), run_block(changed)};
  };
  Result out(loaded, kAdviseFields,
             Advised{error, kind, choice(0), choice(1), each,
                     each.empty() && nearest != nullptr ? std::optional(*nearest) : std::nullopt, result.get()});
  out.even_if_quiet = true;
  if (!report.empty()) out.files = {report};
  out.code = interrupt.asked() ? kExitInterrupted : !each.empty() ? kExitOk : kExitFailure;
  return out;
}

}  // namespace

Command advise_command() {
  return {"advise",
          join({measuring_options(),
                {{"--error", "ERROR", "largest allowed error over the run, SI units; default 1e-6"},
                 Option{"--of", "WHAT", "kind of error: position (m), velocity (m/s), energy (J), reaction (N)"}.among(
                     "position,velocity,energy,reaction")}}),
          advise,
          "Measures like `lockstep chart`. First every integrator runs in the formulation of the scene, until two\n"
          "meet the error; then all other combinations run that may be cheaper. Exit code 1: no run met the error.\n\n"
          "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2",
          {&kAdviseFields.schema()}};
}

}  // namespace lockstep
