// The verb chart: what accuracy costs on this scene, measured on this machine.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "framework/analysis/mobility.h"
#include "framework/analysis/work_precision.h"
#include "framework/model/units.h"
#include "framework/record/gnuplot.h"
#include "framework/runner/commands.h"
#include "framework/runner/files.h"
#include "framework/runner/progress.h"
#include "framework/scene/observe.h"

namespace lockstep {
namespace {

constexpr double kBudget = 60;  // s
constexpr const char* kInterrupted = "interrupted";
constexpr double kLimits[] = {1e-3, 1e-6, 1e-9};

/// Ends the run that is being measured, and with it all that follow.
class Ender final : public Observer {
 public:
  explicit Ender(const Interrupt& interrupt) : interrupt_(&interrupt) {}
  void step(const Sample& s) override {
    if (interrupt_->asked()) throw StepError(kInterrupted, s.state.t);
  }

 private:
  const Interrupt* interrupt_;
};

/// A mechanism that stays where it is in memory, and what its events look at.
struct Standing {
  Mechanism mechanism;
  std::unique_ptr<Recorder> recorder{};
  Ender ender;
};

Subject subject_of(const Scene& scene, const Registry& registry, const Interrupt& interrupt) {
  auto standing = std::make_shared<Standing>(Standing{build(scene, registry), nullptr, Ender(interrupt)});
  Mechanism& m = standing->mechanism;
  standing->recorder = make_recorder(m);
  Subject subject{standing, &m.system, {}};
  subject.events = make_events(m, *standing->recorder);
  if (!subject.events.empty()) subject.observers.push_back(standing->recorder.get());
  subject.observers.push_back(&standing->ender);
  subject.start = m.system.start();
  Dynamics dynamics(m.system, make_solver(m.run, registry), {Formulation::omega, m.run.stabilization});
  if (m.run.assemble) assemble(dynamics, subject.start, m.start_speeds);
  return subject;
}

double budget_of(const Words& w) {
  if (w.budget.empty()) return kBudget;
  std::string text = w.budget;
  if (text.find_first_not_of("0123456789.eE+-") == std::string::npos) text += " s";
  const Measured budget = read_quantity(text, Unit::time);
  if (!budget.problem.empty()) throw UsageError("--budget: " + budget.problem);
  if (!(budget.value >= 1)) throw UsageError("--budget: the value is " + w.budget + "; it must be 1 s at least");
  return budget.value;
}

WorkPrecisionOptions options_for(const Loaded& loaded, double budget) {
  WorkPrecisionOptions options;
  const RunSettings run = loaded.scene.run;
  const Registry& registry = loaded.registry;
  const auto method = [&](const std::string& name) {
    RunSettings own = run;
    own.integrator = {name, Value(Value::Object{}), {}};
    own.step = 1;  // fixed steps come from the ladder
    return MethodChoice{name, [&registry, own] { return make_integrator(own, registry); }};
  };
  for (const std::string& name : registry.integrators.names()) options.integrators.push_back(method(name));
  options.solvers = {{run.solver.type, [&registry, run] { return make_solver(run, registry); }}};
  options.reference = method("dop853"), options.second = method("dopri5");
  options.gains = run.stabilization;
  options.budget = budget;
  return options;
}

void print_cheapest(const WorkPrecision& result) {
  fmt::print("cheapest run with a position error of at most\n");
  for (const double limit : kLimits) {
    const WorkPrecisionRun* run = cheapest(result, limit);
    if (run == nullptr)
      fmt::print("  {:.0e} m   none reached it\n", limit);
    else
      fmt::print("  {:.0e} m   {:8.2g} s CPU  {:7} evaluations  {}  (error {:.1e} m)\n", limit, run->cpu,
                 run->evaluations, label(*run), run->error.position);
  }
}

// Runs that Ctrl-C cut short count as not begun.
void leave_out_interrupted(WorkPrecision& result) {
  std::vector<WorkPrecisionRun> measured;
  for (WorkPrecisionRun& run : result.runs) {
    if (run.failure == kInterrupted)
      result.left_out.push_back(label(run));
    else
      measured.push_back(std::move(run));
  }
  result.runs = std::move(measured);
}

void print_failures(const WorkPrecision& result) {
  std::size_t n = 0;
  for (const WorkPrecisionRun& run : result.runs) n += run.done() ? 0 : 1;
  if (n > 0) fmt::print("{} runs failed (grey marks in the pictures); the reasons stand in the CSV file\n", n);
  if (!result.left_out.empty())
    fmt::print("{} runs were not reached in the time; give more with --budget\n", result.left_out.size());
}

}  // namespace

int chart_command(const Words& w) {
  Loaded loaded = load(w);
  loaded.scene.run.record.clear();
  const double until = loaded.scene.run.until, budget = budget_of(w);
  if (until <= 0)
    throw SceneError(
        loaded.scene.file + ": run.until: the scene does not say how long it runs; add it, or give --until 5",
        loaded.scene.file);
  const std::string csv = csv_path(
      w.out.empty() ? "" : (std::filesystem::path(w.out) / std::filesystem::path(w.scene).stem()).string() + ".csv",
      w.scene);
  const std::string base = std::filesystem::path(csv).replace_extension().string() + "_chart";
  check_writable(base + ".csv");

  const Interrupt interrupt;
  const Subject first = subject_of(loaded.scene, loaded.registry, interrupt);
  Dynamics dynamics(*first.system, make_solver(loaded.scene.run, loaded.registry));
  const bool imposed = mobility(dynamics, first.start).freedoms == 0;
  const std::string title = loaded.scene.title.empty() ? loaded.scene.file : loaded.scene.title;

  const Course course{[&] { return subject_of(loaded.scene, loaded.registry, interrupt); }, until};
  WorkPrecisionOptions options = options_for(loaded, budget);
  options.progress = [&](const std::string& what) {
    if (!w.quiet && !interrupt.asked()) fmt::print(stderr, "  {}\n", what);
  };
  WorkPrecision result;
  try {
    result = work_precision(course, options);
  } catch (const Error&) {
    if (!interrupt.asked()) throw;
    fmt::print(stderr, "lockstep: interrupted before the reference was there; nothing is written\n");
    return kExitInterrupted;
  }
  leave_out_interrupted(result);

  write_runs(base + ".csv", result);
  fmt::print("{}\n  {} runs over {:g} s; {} and {} at their tightest agree to {:.1e} m\n", title, result.runs.size(),
             until, result.reference, result.second, result.agreement.position);
  if (imposed)
    fmt::print(
        "  no freedom is left to integrate: laws impose the whole motion, so that projection gives it exactly at any "
        "step;\n"
        "  the integrators are compared without stabilisation\n");
  print_cheapest(result);
  print_failures(result);
  fmt::print("files: {}.csv", base);
  if (result.runs.empty()) {
    fmt::print("\n       no pictures: no run was measured");
  } else if (!find_gnuplot().empty()) {
    const auto kind = imposed ? Stabilization::Kind::none : Stabilization::Kind::project;
    write_chart(base, work_precision_chart(result, title, ChartBy::integrator, kind));
    write_chart(base + "_forms", work_precision_chart(result, title, ChartBy::form, kind, {"dopri5", "rk4"}));
    fmt::print(", {0}.svg, {0}.png, {0}_forms.svg, {0}_forms.png", base);
  } else {
    fmt::print("\n       no pictures: gnuplot is not installed (apt install gnuplot-nox)");
  }
  fmt::print("\n");
  if (interrupt.asked()) fmt::print(stderr, "lockstep: interrupted; the runs up to there are written\n");
  return interrupt.asked() ? kExitInterrupted : kExitOk;
}

}  // namespace lockstep
