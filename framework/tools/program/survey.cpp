#include "framework/tools/program/survey.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include <lockstep/analysis.h>
#include "framework/mechanism/params/units.h"
#include "framework/tools/program/ways.h"
#include <lockstep/sweep.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr double kBudget = 60;  // s

/// Ends the run that is being measured, and with it all that follow.
class Ender final : public Observer {
 public:
  explicit Ender(const Interrupt& interrupt) : interrupt_(&interrupt) {}
  void step(const Sample& s) override {
    if (interrupt_->asked()) throw InterruptedError("interrupted", {.t = s.state.t});
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

// `assembled`: the start of an earlier one, which is the start of all.
Subject subject_of(const Scene& scene, const Registry& registry, const Interrupt& interrupt,
                   std::optional<State>& assembled) {
  auto standing = std::make_shared<Standing>(Standing{build(scene, registry), nullptr, Ender(interrupt)});
  Mechanism& m = standing->mechanism;
  m.run.record.clear();
  standing->recorder = make_recorder(m);
  Subject subject{standing, &m.system, {}};
  subject.events = make_events(m, *standing->recorder);
  if (!subject.events.empty()) subject.observers.push_back(standing->recorder.get());
  subject.observers.push_back(&standing->ender);
  if (assembled) {
    subject.start = *assembled;
    return subject;
  }
  subject.start = m.system.start();
  Dynamics dynamics(m.system, make_solver(m.run, registry), {Formulation::omega, m.run.stabilization});
  if (m.run.assemble) assemble(dynamics, subject.start, m.start_speeds);
  assembled = subject.start;
  return subject;
}

MethodChoice method_of(const MethodSpec& way, const RunSettings& run, const Registry& registry) {
  RunSettings own = run;
  own.integrator = way;
  own.step = 1;  // fixed steps come from the ladder
  return {spelled(way), [&registry, own] { return make_integrator(own, registry); }};
}

bool is_adaptive(const MethodChoice& method) {
  try {
    return method.make()->info().adaptive;
  } catch (const Error&) {
    return false;  // it needs keys that nobody gave
  }
}

std::vector<MethodSpec> ways_of(const std::string& option, const std::vector<std::string>& words, const MethodSpec& own,
                           const std::vector<TypeInfo>& types) {
  if (words.empty()) return all_ways(own, types);
  std::vector<MethodSpec> all;
  for (const std::string& word : words) all.push_back(read_way(option, word, types));
  return all;
}

// "1e-2:1e-9" in falling order.
std::pair<double, double> range_of(const std::string& option, const std::string& text, Unit unit) {
  const std::size_t colon = text.find(':');
  const auto read = [&](std::string part) {
    if (unit == Unit::time && part.find_first_not_of("0123456789.eE+-") == std::string::npos) part += " s";
    if (unit == Unit::time) {
      const Measured m = read_quantity(part, unit);
      if (m.problem.empty() && m.value > 0) return m.value;
    } else {
      char* end = nullptr;
      const double x = std::strtod(part.c_str(), &end);
      if (!part.empty() && *end == 0 && x > 0 && std::isfinite(x)) return x;
    }
    throw UsageError(option + ": \"" + text + "\" is no range; write it as COARSE:FINE, as in " + option +
                     " 1e-2:1e-6");
  };
  const double a = read(text.substr(0, colon)), b = colon == std::string::npos ? a : read(text.substr(colon + 1));
  return {std::max(a, b), std::min(a, b)};
}

void set_ranges(const Words& w, const Trajectory& trajectory, WorkPrecisionOptions& options) {
  if (!w.tolerances.empty()) {
    const auto [coarse, fine] = range_of("--tolerances", w.tolerances, Unit::none);
    options.tolerances.clear();
    for (double x = coarse; x > 0.999 * fine; x /= 10) options.tolerances.push_back(x);
  }
  if (!w.steps.empty()) {
    const auto [coarse, fine] = range_of("--steps", w.steps, Unit::time);
    const double interval = trajectory.length / trajectory.outputs;
    options.steps.clear();
    for (double n = std::max(1.0, std::ceil(interval / coarse - 1e-9)); interval / n > 0.999 * fine && n < 1e9; n *= 2)
      options.steps.push_back(static_cast<int>(n));
    if (options.steps.empty())
      throw UsageError(
          fmt::format("--steps: {} s is longer than the {:.3g} s between two instants of comparison; give "
                      "smaller steps, or a longer run",
                      coarse, interval));
  }
}

Formulation formulation_of(const std::string& word) {
  return word == "quaternion" ? Formulation::quaternion : Formulation::omega;
}

Stabilization::Kind kind_of(const std::string& word) {
  if (word == "baumgarte") return Stabilization::Kind::baumgarte;
  return word == "none" ? Stabilization::Kind::none : Stabilization::Kind::project;
}

// `own` first, then the other values, or those that were named.
template <class T, class Read>
std::vector<T> values_of(const std::vector<std::string>& words, T own, const std::vector<T>& all, Read&& read) {
  std::vector<T> values;
  if (!words.empty()) {
    for (const std::string& word : words) values.push_back(read(word));
  } else {
    values.push_back(own);
    for (const T& v : all)
      if (v != own) values.push_back(v);
  }
  return values;
}

// What the mechanism has not, makes no difference.
void leave_out(const System& system, SceneSurvey& survey) {
  WorkPrecisionOptions& o = survey.options;
  if (!system.links().empty()) return;
  if (o.stabilizations.size() > 1 || o.solvers.size() > 1)
    survey.remarks.push_back("no links: stabilisations and solvers make no difference, one of each is charted");
  o.stabilizations.resize(1);
  o.solvers.resize(1);
}

}  // namespace

std::vector<MethodChoice> references_of(const RunSettings& run, const Registry& registry, bool implicit) {
  struct Candidate {
    MethodChoice method;
    IntegratorInfo info;
    bool usual;
  };
  std::vector<Candidate> all;
  const auto add = [&](const MethodSpec& way, bool usual) {
    const MethodChoice method = method_of(way, run, registry);
    const auto same = [&](const Candidate& c) { return c.method.name == method.name; };
    if (is_adaptive(method) && std::none_of(all.begin(), all.end(), same))
      all.push_back({method, method.make()->info(), usual});
  };
  const std::vector<TypeInfo> types = types_of(registry.integrators);
  for (const TypeInfo& type : types) add(with_known_keys(type, run.integrator.keys), true);
  for (const MethodSpec& way : all_ways(run.integrator, types)) add(way, spelled(way) == way.type);
  std::stable_sort(all.begin(), all.end(), [&](const Candidate& a, const Candidate& b) {
    const bool a_like = a.info.implicit == implicit, b_like = b.info.implicit == implicit;
    if (a.usual != b.usual) return a.usual;
    return a_like != b_like ? a_like : a.info.order > b.info.order;
  });
  std::vector<MethodChoice> methods;
  for (Candidate& c : all) methods.push_back(std::move(c.method));
  return methods;
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

SceneSurvey survey_of(const Loaded& loaded, const Words& w, const Interrupt& interrupt) {
  const Scene& scene = loaded.scene;
  const Registry& registry = loaded.registry;
  const RunSettings& run = scene.run;
  if (run.until <= 0)
    throw SceneError(scene.file + ": run.until: the scene does not say how long it runs; add it, or give --until 5",
                     scene.file);
  SceneSurvey survey;
  survey.title = scene.title.empty() ? scene.file : scene.title;
  auto assembled = std::make_shared<std::optional<State>>();
  survey.trajectory = {
      [&scene, &registry, &interrupt, assembled] { return subject_of(scene, registry, interrupt, *assembled); },
      run.until};
  const Subject first = survey.trajectory.make();
  Dynamics dynamics(*first.system, make_solver(run, registry));
  survey.imposed = !first.system->links().empty() && mobility(dynamics, first.start).freedoms == 0;

  WorkPrecisionOptions& o = survey.options;
  for (const MethodSpec& way : ways_of("--integrators", w.integrators, run.integrator, types_of(registry.integrators)))
    o.integrators.push_back(method_of(way, run, registry));
  for (const MethodSpec& way : ways_of("--solvers", w.solvers, run.solver, types_of(registry.solvers))) {
    RunSettings own = run;
    own.solver = way;
    o.solvers.push_back({spelled(way), [&registry, own] { return make_solver(own, registry); }});
  }
  using Kind = Stabilization::Kind;
  o.formulations =
      values_of(w.formulations, run.formulation, {Formulation::omega, Formulation::quaternion}, formulation_of);
  o.stabilizations = values_of(w.stabilizations, survey.imposed ? Kind::none : run.stabilization.kind,
                               {Kind::project, Kind::baumgarte, Kind::none}, kind_of);
  o.separately = w.separately;
  o.gains = run.stabilization;
  RunSettings own = run;
  own.step = 1;
  const IntegratorInfo info = make_integrator(own, registry)->info();
  if (info.adaptive) o.largest_step = run.step;
  o.references = references_of(run, registry, info.implicit);
  o.budget = budget_of(w);
  set_ranges(w, survey.trajectory, o);
  leave_out(*first.system, survey);
  survey.base.integrator = o.integrators.front().name, survey.base.solver = o.solvers.front().name;
  survey.base.formulation = o.formulations.front(), survey.base.stabilization = o.stabilizations.front();
  return survey;
}

std::unique_ptr<WorkPrecision> measure(SceneSurvey& survey, const Words& w, const Interrupt& interrupt) {
  const bool quiet = w.quiet;
  bool headed = false;
  survey.options.progress = [&](const std::string& what) {
    if (!quiet && what.rfind("reference", 0) == 0) fmt::print(stderr, "  {}\n", what);
  };
  survey.options.measured = [&](const WorkPrecisionRun& run) {
    if (quiet || run.interrupted) return;
    if (!headed) fmt::print("{}\n", run_heading());
    headed = true;
    fmt::print("{}\n", run_line(run));
    std::fflush(stdout);
  };
  survey.options.clock = [&] {  // when somebody asks for the end, no time is left
    return interrupt.asked() ? HUGE_VAL : thread_seconds();
  };
  auto result = std::make_unique<WorkPrecision>();
  try {
    *result = work_precision(survey.trajectory, survey.options);
  } catch (const Error&) {
    if (!interrupt.asked()) throw;
    fmt::print(stderr, "lockstep: interrupted before the reference was there; nothing is written\n");
    return nullptr;
  }
  std::vector<WorkPrecisionRun> measured;
  for (WorkPrecisionRun& run : result->runs) {
    if (run.interrupted)
      result->left_out.push_back(label(run));
    else
      measured.push_back(std::move(run));
  }
  result->runs = std::move(measured);
  return result;
}

std::string run_heading() {
  return fmt::format("  {:<24} {:<10} {:<9} {:<8} {:<16} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}", "integrator",
                     "formulation", "stabil.", "solver", "setting", "m", "m/s", "J", "N", "CPU s", "evals");
}

std::string run_line(const WorkPrecisionRun& r) {
  std::string line = fmt::format(
      "  {:<24} {:<10}  {:<9} {:<8} {:<16} ", r.integrator, to_string(r.formulation), to_string(r.stabilization),
      r.solver, fmt::format("{} {:.3g}{}", r.adaptive ? "tolerance" : "step", r.setting, r.adaptive ? "" : " s"));
  if (!r.done()) {
    std::string reason = r.failure.substr(0, r.failure.find('\n'));
    if (reason.size() > 90) reason = reason.substr(0, reason.rfind(' ', 90)) + " ...";
    return line + "failed: " + reason;
  }
  return line + fmt::format("{:9.1e} {:9.1e} {:9.1e} {:9.1e} {:9.2g} {:8}", r.error.position, r.error.velocity,
                            r.error.energy, r.error.reaction, r.cpu, r.evaluations);
}

std::string cost_text(double seconds, bool upper_bound) {
  return fmt::format("{}{:.2g} s", upper_bound ? "<= " : "", seconds);
}

RunSettings settings_of(const RunSettings& scene, const WorkPrecisionRun& r, const Registry& registry) {
  RunSettings run = scene;
  run.integrator = read_way("integrator", r.integrator, types_of(registry.integrators));
  run.solver = read_way("solver", r.solver, types_of(registry.solvers));
  run.formulation = r.formulation;
  run.stabilization.kind = r.stabilization;
  if (r.adaptive)
    run.tolerance = {r.setting, 1e-2 * r.setting};
  else
    run.step = r.setting;
  return run;
}

}  // namespace lockstep
