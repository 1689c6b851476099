// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/benchmark_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <lockstep/analysis.h>
#include "framework/description/scene/reading.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr double kDefaultBudget = 60;  // s

/// A mechanism at a fixed address, with its observer.
struct Owner {
  Mechanism mechanism;
  std::unique_ptr<Recorder> recorder{};
  std::unique_ptr<EnergyAudit> audit{};
};

// `assembled`: the start that all mechanisms of the scene share, computed by the first.
Subject subject_of(const Scene& scene, const Registry& registry, std::optional<State>& assembled) {
  auto owner = std::make_shared<Owner>(Owner{build_mechanism(scene, registry)});
  Mechanism& m = owner->mechanism;
  m.run.record.clear();
  owner->recorder = make_recorder(m);
  Subject subject{owner, &system_of(m), {}};
  subject.events = make_events(m, *owner->recorder);
  owner->audit = std::make_unique<EnergyAudit>(system_of(m), m.run.limits);
  subject.audit = owner->audit.get();
  if (!subject.events.empty()) subject.observers.push_back(owner->recorder.get());
  Dynamics dynamics(system_of(m), make_solver(m.run, registry), {Formulation::omega, m.run.stabilization});
  if (!assembled)
    assembled = assembled_start(dynamics, m);
  else
    decided_start(dynamics, m);  // the rows of this mechanism
  subject.start = *assembled;
  return subject;
}

MethodChoice method_of(const MethodSpec& spec, const RunSettings& run, const Registry& registry) {
  RunSettings own = run;
  own.integrator = spec;
  own.step = 1;  // the benchmark sets the steps
  return {to_word(spec), [&registry, own] { return make_integrator(own, registry); }};
}

std::vector<MethodSpec> specs_of(const std::string& option, const std::vector<std::string>& names,
                                 const MethodSpec& own, const std::vector<TypeInfo>& types) {
  if (names.empty()) return all_specs(own, types);
  std::vector<MethodSpec> all;
  for (const std::string& name : names) all.push_back(read_spec(option, name, types));
  return all;
}

// "1e-2:1e-9" in falling order.
std::pair<double, double> range_of(const std::string& option, const std::string& text, Unit unit) {
  try {
    const std::size_t colon = text.find(':');
    const double a = positive_number(option, text.substr(0, colon), unit),
                 b = colon == std::string::npos ? a : positive_number(option, text.substr(colon + 1), unit);
    return {std::max(a, b), std::min(a, b)};
  } catch (const UsageError&) {
    throw UsageError(option + ": \"" + text + "\" is not a range; write it as COARSE:FINE, as in " + option +
                     " 1e-2:1e-6");
  }
}

void set_ranges(const Arguments& args, const Trajectory& trajectory, WorkPrecisionOptions& options) {
  if (!args["--tolerances"].empty()) {
    const auto [coarse, fine] = range_of("--tolerances", args["--tolerances"], Unit::none);
    options.tolerances.clear();
    for (double by = 1; coarse / by > 0.999 * fine; by *= 10) options.tolerances.push_back(coarse / by);
  }
  if (!args["--steps"].empty()) {
    const auto [coarse, fine] = range_of("--steps", args["--steps"], Unit::time);
    const double interval = trajectory.length / trajectory.outputs;
    options.steps.clear();
    for (double n = std::max(1.0, std::ceil(interval / coarse - 1e-9)); interval / n > 0.999 * fine && n < 1e9; n *= 2)
      options.steps.push_back(static_cast<int>(n));
    if (options.steps.empty())
      throw UsageError(
          fmt::format("--steps: {} s is longer than the {:.3g} s between two compared times; give "
                      "smaller steps, or a longer run",
                      coarse, interval));
  }
}

// The values that were named, else all with `own` first.
template <class T, class Read>
std::vector<T> values_of(const std::vector<std::string>& words, T own, std::vector<T> all, Read&& read) {
  if (words.empty()) {
    std::stable_partition(all.begin(), all.end(), [&](T v) { return v == own; });
    return all;
  }
  std::vector<T> values;
  std::transform(words.begin(), words.end(), std::back_inserter(values), read);
  return values;
}

// Stabilisations and solvers make no difference to a mechanism without joints.
void leave_out(const System& system, SceneBenchmark& benchmark) {
  WorkPrecisionOptions& o = benchmark.options;
  if (!system.links().empty()) return;
  if (o.stabilizations.size() > 1 || o.solvers.size() > 1)
    benchmark.remarks.push_back("no joints: stabilisations and solvers make no difference, so one of each is charted");
  o.stabilizations.resize(1);
  o.solvers.resize(1);
}

// What is named, else all that the mechanism allows, the scene's own first. Automatic is omega if a solver is named, or if
// joint coordinates cost more, else joint for all methods that support it.
std::vector<Formulation> formulations_of(const Arguments& args, Formulation own, bool joint_possible,
                                         Dynamics& by_itself, const State& start) {
  const bool joint = args.all("--solvers").empty() && by_itself.why_not_joint(start.modes).empty();
  std::vector<Formulation> all{Formulation::automatic, Formulation::omega, Formulation::quaternion};
  if (own != Formulation::automatic) all.erase(all.begin());
  if (joint_possible && !(joint && own == Formulation::automatic)) all.push_back(Formulation::joint);
  std::vector<Formulation> settled;
  for (Formulation f : values_of(args.all("--formulations"), own, all, formulation_from)) {
    if (f == Formulation::automatic && !joint) f = Formulation::omega;
    if (std::find(settled.begin(), settled.end(), f) == settled.end()) settled.push_back(f);
  }
  return settled;
}

// Whether loop-closure constraints are left in joint coordinates.
bool has_loops(Dynamics& along_joints, State start) {
  if (!along_joints.why_not_joint(start.modes).empty()) return false;
  along_joints.to_formulation(start);
  return start.coordinates && start.coordinates->has_rows();
}

}  // namespace

Options measuring_options() {
  return join(
      {scene_options(),
       {kIntegrators,
        Option{"--formulations", "A,B", "omega, quaternion, joint, auto; default: all that the mechanism allows"}.among(
            kFormulations),
        Option{"--stabilizations,--stabilisations", "A,B", "project, baumgarte, none; default: all"}.among(
            kStabilizations),
        {"--solvers", "A,B", "solvers; default: all of `lockstep list solvers`"},
        {"--separately", "",
         "vary integrator, formulation, stabilisation and solver one at a time: faster than all combinations"},
        {"--tolerances", "COARSE:FINE", "range of tolerances; default 1:1e-12"},
        {"--steps", "COARSE:FINE", "range of fixed steps, s; default: a hundredth of the run, and 2^14 times less"},
        kUntil,
        kBudget,
        {"--report", "FILE.html", "one HTML file with a scatter plot of all runs"},
        {"--verbose,-v", "", "also print each run as it ends"},
        {"--quiet", "", "no progress"},
        kJson}});
}

Arguments measuring_arguments(Arguments args) {
  if (args["--planar"].empty() && std::ranges::count(args.all("--formulations"), "quaternion") > 0)
    args.set("--planar", "off");
  return args;
}

std::vector<MethodChoice> references_of(const RunSettings& run, const Registry& registry, bool implicit) {
  struct Candidate {
    MethodChoice method;
    IntegratorInfo info;
    bool usual;
  };
  std::vector<Candidate> all;
  const auto add = [&](const MethodSpec& spec, bool usual) {
    const MethodChoice method = method_of(spec, run, registry);
    const auto same = [&](const Candidate& c) { return c.method.name == method.name; };
    if (std::ranges::any_of(all, same)) return;
    try {
      if (const IntegratorInfo info = method.make()->info(); info.adaptive) all.push_back({method, info, usual});
    } catch (const Error&) {  // it needs keys that were not given
    }
  };
  const std::vector<TypeInfo> types = types_of(registry.integrators);
  for (const TypeInfo& type : types) add(with_known_keys(type, run.integrator.keys), true);
  for (const MethodSpec& spec : all_specs(run.integrator, types)) add(spec, to_word(spec) == spec.type);
  std::ranges::stable_sort(all, std::greater{}, [&](const Candidate& c) {
    return std::tuple(c.usual, c.info.implicit == implicit, c.info.order);
  });
  std::vector<MethodChoice> methods;
  for (Candidate& c : all) methods.push_back(std::move(c.method));
  return methods;
}

std::string base_of(const Arguments& args, const char* ending) {
  const std::filesystem::path folder = args["--out"].empty() ? output_folder() : args["--out"];
  const std::string base = csv_path((folder / stem_of(args["scene"])).string() + ending, "");
  check_writable(base + ".csv");
  return base;
}

double budget_of(const Arguments& args) {
  if (args["--budget"].empty()) return kDefaultBudget;
  const double budget = positive_number("--budget", args["--budget"], Unit::time, "60");
  if (budget < 1) throw UsageError("--budget: the value is " + args["--budget"] + "; it must be at least 1 s");
  return budget;
}

SceneBenchmark benchmark_of(const Loaded& loaded, const Arguments& args) {
  const Scene& scene = loaded.scene;
  const Registry& registry = loaded.registry;
  const RunSettings& run = scene.run;
  if (run.until <= 0)
    throw SceneError(scene.file + ": run.until: the scene has no end time, or 0; add it, or give --until 5",
                     scene.file);
  SceneBenchmark benchmark;
  benchmark.title = scene.title.empty() ? scene.file : scene.title;
  auto assembled = std::make_shared<std::optional<State>>();
  benchmark.trajectory = {[&scene, &registry, assembled] { return subject_of(scene, registry, *assembled); },
                          run.until};
  const Subject first = benchmark.trajectory.make();
  Dynamics dynamics(*first.system, make_solver(run, registry));
  benchmark.imposed = !first.system->links().empty() && mobility(dynamics, first.start).freedoms == 0;
  if (benchmark.imposed)
    CommandFindings::add(
        {&finding::analysis_note, "",
         "the motion is fully prescribed: lockstep kinematics or inverse computes it without integration"});

  WorkPrecisionOptions& o = benchmark.options;
  for (const MethodSpec& spec :
       specs_of("--integrators", args.all("--integrators"), run.integrator, types_of(registry.integrators)))
    o.integrators.push_back(method_of(spec, run, registry));
  for (const MethodSpec& spec : specs_of("--solvers", args.all("--solvers"), run.solver, types_of(registry.solvers))) {
    RunSettings own = run;
    own.solver = spec;
    o.solvers.push_back({to_word(spec), [&registry, own] { return make_solver(own, registry); }});
  }
  using Kind = Stabilization::Kind;
  Dynamics along_joints(*first.system, make_solver(run, registry), {Formulation::joint, {}});  // even if it costs more
  o.formulations = formulations_of(args, run.formulation, along_joints.why_not_joint(first.start.modes).empty(),
                                   dynamics, first.start);
  o.loops = has_loops(along_joints, first.start);
  o.stabilizations = values_of(args.all("--stabilizations"), run.stabilization.kind,
                               {Kind::project, Kind::baumgarte, Kind::none}, stabilization_from);
  o.separately = args.has("--separately");
  o.gains = run.stabilization;
  const IntegratorInfo info = integrator_info(run, registry);
  if (info.adaptive) o.largest_step = run.step;
  o.references = references_of(run, registry, info.implicit);
  o.budget = budget_of(args);
  set_ranges(args, benchmark.trajectory, o);
  leave_out(*first.system, benchmark);
  benchmark.base.integrator = o.integrators.front().name, benchmark.base.solver = o.solvers.front().name;
  benchmark.base.formulation = o.formulations.front(), benchmark.base.stabilization = o.stabilizations.front();
  return benchmark;
}

std::unique_ptr<WorkPrecision> measure(SceneBenchmark& benchmark, const Arguments& args, const Interrupt& interrupt) {
  const bool quiet = !args.has("--verbose") || args.has("--quiet") || args.has("--json");
  Progress progress(benchmark.options.budget, args.has("--quiet"), Counts::budget);
  const double begin = thread_seconds();
  const FindingScope unheard;  // what coarse settings do to a run is what is measured
  benchmark.options.progress = [&](const std::string& what) {
    if (!quiet && what.rfind("reference", 0) == 0) {
      progress.finish();
      fmt::print(stderr, "  {}\n", what);
    }
    progress.at(thread_seconds() - begin);
  };
  benchmark.options.measured = [&](const WorkPrecisionRun& run) {
    if (quiet || run.interrupted) return;
    progress.finish();
    fmt::print("{}", run_line(run));
    std::fflush(stdout);
  };
  benchmark.options.clock = [&] {  // after an interrupt, no time is left
    return interrupt.asked() ? HUGE_VAL : thread_seconds();
  };
  auto result = std::make_unique<WorkPrecision>();
  try {
    *result = work_precision(benchmark.trajectory, benchmark.options);
    progress.finish();
  } catch (const Error&) {
    progress.finish();
    if (!interrupt.asked()) throw;
    fmt::print(stderr, "note: interrupted before the reference solution; nothing is written\n");
    return nullptr;
  }
  for (const WorkPrecisionRun& run : result->runs)
    if (run.interrupted) result->left_out.push_back(label(run));
  std::erase_if(result->runs, [](const WorkPrecisionRun& run) { return run.interrupted; });
  return result;
}

RunSettings settings_of(const RunSettings& scene, const WorkPrecisionRun& r, const Registry& registry) {
  RunSettings run = scene;
  run.integrator = read_spec("integrator", r.integrator, types_of(registry.integrators));
  run.solver = read_spec("solver", r.solver, types_of(registry.solvers));
  run.formulation = r.formulation;
  run.stabilization.kind = r.stabilization;
  if (r.adaptive)
    run.tolerance = {r.setting, 1e-2 * r.setting};
  else
    run.step = r.setting;
  return run;
}

}  // namespace lockstep
