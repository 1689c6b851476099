// SPDX-License-Identifier: BSD-3-Clause
// The command advise: the cheapest method and setting that met a wanted error on the user's own scene.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include <lockstep/text.h>
#include "framework/description/scene/write.h"
#include "framework/tools/commands/benchmark.h"
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

// The command that repeats this run; it gives every setting, so that none is taken from the scene.
std::string command_line(const Arguments& args, const WorkPrecisionRun& run) {
  std::string text = "lockstep run " + in_quotes(args["scene"]);
  for (const std::string& plugin : args.all("--plugin")) text += " --plugin " + in_quotes(plugin);
  text += " --integrator " + in_quotes(run.integrator) + (run.adaptive ? " --tolerance " : " --step ") +
          text::number(run.setting) + " --formulation " + to_string(run.formulation) + " --stabilization " +
          to_string(run.stabilization);
  if (!needs_no_solver(run.formulation)) text += " --solver " + in_quotes(run.solver);
  if (!args["--until"].empty()) text += " --until " + in_quotes(args["--until"]);
  if (!args["--planar"].empty()) text += " --planar " + args["--planar"];
  if (args.has("--full")) text += " --full";
  return text;
}

// The same as keys of the scene's "run".
std::string run_block(const RunSettings& run, const WorkPrecisionRun& r, double largest_step) {
  Value::Object members{{"integrator", to_value(run.integrator), {}}};
  if (r.adaptive) members.push_back({"tolerance", Value(r.setting), {}});
  if (!r.adaptive || largest_step > 0) members.push_back({"step", Value(r.adaptive ? largest_step : r.setting), {}});
  members.push_back({"formulation", Value(to_string(r.formulation)), {}});
  const Stabilization &s = run.stabilization, usual;
  if (s.alpha == usual.alpha && s.beta == usual.beta && s.tolerance == usual.tolerance)
    members.push_back({"stabilization", Value(to_string(s.kind)), {}});
  else
    members.push_back({"stabilization",
                       Value(Value::Object{{"kind", Value(to_string(s.kind)), {}},
                                           {"alpha", Value(s.alpha), {}},
                                           {"beta", Value(s.beta), {}},
                                           {"tolerance", Value(s.tolerance), {}}}),
                       {}});
  if (!needs_no_solver(r.formulation)) members.push_back({"solver", to_value(run.solver), {}});
  return write_json(Value(std::move(members)));
}

// "dopri5" of "dopri5:stages=manifold".
std::string type_of(const std::string& integrator) { return integrator.substr(0, integrator.find(':')); }

// The run that came closest.
const WorkPrecisionRun* nearest_of(const WorkPrecision& result, ErrorKind kind) {
  const WorkPrecisionRun* best = nullptr;
  for (const WorkPrecisionRun& run : result.runs)
    if (counts(result, run, kind) && (best == nullptr || run.error.of(kind) < best->error.of(kind))) best = &run;
  return best;
}

/// The answer: null if no run, or no second run, met the error.
struct Advice {
  const CostAtError *best = nullptr, *second = nullptr;
};

// A run that no finer one confirmed may be accurate by chance.
Advice advice_of(const std::vector<CostAtError>& all) {
  if (all.empty()) return {};
  const auto first = [&](auto&& holds) {
    const auto found = std::find_if(all.begin(), all.end(), holds);
    return found == all.end() ? nullptr : &*found;
  };
  Advice advice{first([](const CostAtError& c) { return c.confirmed; })};
  if (advice.best == nullptr) advice.best = &all.front();
  const std::string best = type_of(advice.best->run->integrator);
  advice.second = first([&](const CostAtError& c) { return type_of(c.run->integrator) != best && c.confirmed; });
  if (advice.second == nullptr) advice.second = first([&](const CostAtError& c) { return c.run != advice.best->run; });
  return advice;
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
  std::optional<WorkPrecisionRun> nearest;  // if none met the error
  const WorkPrecision* measured;
};
std::string hint_of(const Advised& a) {
  if (!a.cheapest) return "increase --budget, or allow a larger error";
  return a.cheapest->cost.confirmed ? "" : "not confirmed by a finer run; increase --budget";
}
const Fields<Advised>& advise_fields() {
  static const Fields<Choice> kChoice =
      Fields<Choice>{}
          .with(&Choice::cost, cost_fields())
          .with({{"command", "", "command", &Choice::command},
                 {"run", "", "or in the scene's \"run\"", [](const Choice& c) { return Json::parse(c.block); },
                  [](const Json& block) { return "\n" + block.dump(2); }}});
  static const Fields<Advised> kFields = Fields<Advised>{
      {"error", "", "error", &Advised::error},
      {"unit", "", "  unit", [](const Advised& a) { return unit_of(a.kind); }},
      {"of", "", "of", [](const Advised& a) { return to_string(a.kind); }},
      {"cheapest", "cheapest", &Advised::cheapest, kChoice},
      {"runner_up", "runner-up", &Advised::second, kChoice},
      {"nearest", "no run met the error; best run", &Advised::nearest, measured_run_fields()},
      {"hint", "", "next",
       hint_of}}.with([](const Advised& a) -> const WorkPrecision& { return *a.measured; }, measurement_fields());
  return kFields;
}

Result advise(const Arguments& args) {
  Loaded loaded = load(args);
  loaded.scene = in_space(std::move(loaded.scene));  // as all formulations need
  const double error = args["--error"].empty() ? kError : positive_number("--error", args["--error"], Unit::none);
  const ErrorKind kind = kind_of(args);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], "", loaded.scene);
  const Interrupt interrupt;
  SceneBenchmark benchmark = benchmark_of(loaded, args, interrupt);
  benchmark.options.target = error, benchmark.options.target_kind = kind;
  const std::unique_ptr<WorkPrecision> result = measure(benchmark, args, interrupt);
  if (!result) return kExitInterrupted;
  if (!report.empty())
    write_runs_report(report, text_of(args, loaded), runs_text(*result), "cpu [s]",
                      fmt::format("{} error [{}]", to_string(kind), unit_of(kind)), true);
  const std::vector<CostAtError> all = costs_at_error(*result, error, kind);
  const Advice advice = advice_of(all);
  const WorkPrecisionRun* nearest = nearest_of(*result, kind);
  const auto choice = [&](const CostAtError* c) -> std::optional<Choice> {
    if (c == nullptr) return {};
    const RunSettings run = settings_of(loaded.scene.run, *c->run, loaded.registry);
    return Choice{*c, command_line(args, *c->run), run_block(run, *c->run, benchmark.options.largest_step)};
  };
  Result out(
      loaded, advise_fields(),
      Advised{error, kind, choice(advice.best), choice(advice.second),
              advice.best == nullptr && nearest != nullptr ? std::optional(*nearest) : std::nullopt, result.get()});
  out.even_if_quiet = true;
  if (!report.empty()) out.files = {report};
  out.code = interrupt.asked() ? kExitInterrupted : advice.best != nullptr ? kExitOk : kExitFailure;
  return out;
}

}  // namespace

Command advise_command() {
  return {"advise",
          join({measuring_options(),
                {{"--error", "E", "largest allowed error over the run, SI units; default 1e-6"},
                 Option{"--of", "WHAT", "kind of error: position (m), velocity (m/s), energy (J), reaction (N)"}.among(
                     "position,velocity,energy,reaction")}}),
          advise,
          "Measures like `lockstep chart`, only as far as the answer requires. Exit code 1: no run met the error.\n\n"
          "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2",
          {&advise_fields().schema()}};
}

}  // namespace lockstep
