// SPDX-License-Identifier: BSD-3-Clause
// The verb advise: the cheapest method and setting that met a wanted error on the user's own scene.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include <lockstep/text.h>
#include "framework/description/scene/write.h"
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/benchmark_json.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/precision/pareto.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "framework/tools/program/document.h"
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

std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);) out += "  " + line + "\n";
  return out;
}

void print_choice(const char* what, const CostAtError& c, ErrorKind kind) {
  fmt::print("{:<11}{}\n", what, label(*c.run));
  fmt::print("           {} error {:.1e} {}, {} CPU, {} evaluations, {} steps{}\n", to_string(kind),
             c.run->error.of(kind), unit_of(kind), cost_text(c.run->cpu, c.upper_bound), c.run->evaluations,
             c.run->steps, c.upper_bound ? "; no coarser setting was tried" : "");
}

// "dopri5" of "dopri5:stages=manifold".
std::string type_of(const std::string& integrator) { return integrator.substr(0, integrator.find(':')); }

// How close the best run came, if none met the error.
void print_nearest(const WorkPrecision& result, ErrorKind kind, double error) {
  const WorkPrecisionRun* best = nullptr;
  for (const WorkPrecisionRun& run : result.runs)
    if (counts(result, run, kind) && (best == nullptr || run.error.of(kind) < best->error.of(kind))) best = &run;
  fmt::print("no run met a {} error of {:.2g} {}", to_string(kind), error, unit_of(kind));
  if (best == nullptr)
    fmt::print("; none ended at all\n");
  else
    fmt::print("; the best came to {:.1e} {} in {:.2g} s: {}\n", best->error.of(kind), unit_of(kind), best->cpu,
               label(*best));
  if (result.agreement.of(kind) > error)
    fmt::print("the references themselves agree to {:.1e} {} only\n", result.agreement.of(kind), unit_of(kind));
  fmt::print("give more time (--budget), or take a wider error\n");
}

/// The answer: null where nothing met the error, or nothing else did.
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

/// What an answer is about.
struct Question {
  const Arguments& args;
  const Loaded& loaded;
  const SceneBenchmark& benchmark;
  ErrorKind kind;
  double error;

  std::string block(const WorkPrecisionRun& run) const {
    return run_block(settings_of(loaded.scene.run, run, loaded.registry), run, benchmark.options.largest_step);
  }
};

void print_advice(const Question& q, const WorkPrecision& result, const Advice& advice) {
  fmt::print("{} runs over {:g} s; truth by {} and {}, which agree to {:.1e} {}\n", result.runs.size(),
             q.benchmark.trajectory.length, result.reference, result.second, result.agreement.of(q.kind),
             unit_of(q.kind));
  if (advice.best == nullptr) return print_nearest(result, q.kind, q.error);
  print_choice("cheapest", *advice.best, q.kind);
  if (advice.second != nullptr)
    print_choice("runner-up", *advice.second, q.kind);
  else
    fmt::print("runner-up  none: no other combination met it in the time\n");
  if (!advice.best->confirmed) fmt::print("not confirmed by a finer run; give more time with --budget\n");
  fmt::print("\n  {}\n\nor in the scene's \"run\" (without any other of these keys):\n{}",
             command_line(q.args, *advice.best->run), indented(q.block(*advice.best->run)));
}

void print_json(const Question& q, const WorkPrecision& result, const Advice& advice) {
  using nlohmann::ordered_json;
  const auto choice = [&](const CostAtError* c) {
    if (c == nullptr) return ordered_json(nullptr);
    ordered_json j = json_of(*c);
    j["command"] = command_line(q.args, *c->run), j["run"] = ordered_json::parse(q.block(*c->run));
    return j;
  };
  ordered_json j = {
      {"scene", q.loaded.scene.file}, {"title", q.benchmark.title},      {"error", q.error},
      {"of", to_string(q.kind)},      {"cheapest", choice(advice.best)}, {"runner_up", choice(advice.second)}};
  j.update(json_of(result));
  print_result(j);
}

}  // namespace

int advise_command(const Arguments& args) {
  Loaded loaded = load(args);
  loaded.scene = in_space(std::move(loaded.scene));  // where all formulations compute it
  const double error = args["--error"].empty() ? kError : positive_number("--error", args["--error"], Unit::none);
  const ErrorKind kind = kind_of(args);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], "", loaded.scene);
  const Interrupt interrupt;
  SceneBenchmark benchmark = benchmark_of(loaded, args, interrupt);
  benchmark.options.target = error, benchmark.options.target_kind = kind;
  if (!args.has("--json")) fmt::print("{}\n", benchmark.title);
  const std::unique_ptr<WorkPrecision> result = measure(benchmark, args, interrupt);
  if (!result) return kExitInterrupted;
  if (!report.empty())
    write_runs_report(report, text_of(args, loaded), runs_text(*result), "cpu [s]",
                      fmt::format("{} error [{}]", to_string(kind), unit_of(kind)), true);
  const std::vector<CostAtError> all = costs_at_error(*result, error, kind);
  const Question question{args, loaded, benchmark, kind, error};
  const Advice advice = advice_of(all);
  if (args.has("--json"))
    print_json(question, *result, advice);
  else
    print_advice(question, *result, advice);
  if (interrupt.asked()) return kExitInterrupted;
  return advice.best != nullptr ? kExitOk : kExitFailure;
}

}  // namespace lockstep
