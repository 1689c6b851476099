// SPDX-License-Identifier: BSD-3-Clause
// The command run with --certify: the run is repeated by other means, and the columns are compared.
#include "framework/tools/commands/tool_commands.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/text.h>
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/precision/certificate.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr double kTighter = 1e-2, kShorter = 0.25;  // factors on the tolerance and on the step
constexpr double kTightest = 1e-13;                 // tolerance
constexpr double kFixedAgainst = 1e-10;             // tolerance of the second method if the run has fixed steps
constexpr double kProjection = 1e-12;               // m

/// The run repeated by other means.
struct Repeat {
  std::string name;     // of its column
  std::string setting;  // in words
  std::function<std::unique_ptr<Integrator>()> make;
  StepLoopOptions options;
  Table table{};         // what it recorded
  double exchanged = 0;  // energy, J
};

Tolerance tightened(double relative) {
  const double r = std::max(kTightest, kTighter * relative);
  return {r, kTighter * r};
}

// Runs it; false if that took longer than `limit`, s of CPU time.
bool make_again(const Loaded& loaded, const RunSettings& run, Repeat& repeat, double limit) {
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  m.run.record = run.record;
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  EnergyAudit audit(system_of(m));
  Stabilization stabilization = run.stabilization;
  stabilization.tolerance = std::min(stabilization.tolerance, kProjection);
  Dynamics dynamics(system_of(m), make_solver(run, loaded.registry), {run.formulation, stabilization});
  StepLoop sim(dynamics, repeat.make(), repeat.options);
  sim.add_observer(*recorder), sim.add_observer(audit);
  for (Event& event : events) sim.add_event(std::move(event));
  sim.set_state(assembled_start(dynamics, m));
  const double begin = thread_seconds();
  bool given_up = false;
  sim.progress = [&](const State&) { return !(given_up = thread_seconds() - begin > limit); };
  sim.run_until(run.until);
  repeat.table = recorder->table(), repeat.exchanged = audit.result().scale;
  return !given_up;
}

Repeat tighter_of(const Loaded& loaded, const RunSettings& run, bool adaptive, StepLoopOptions options) {
  Repeat repeat{run.integrator.type + " tighter", "", {}, std::move(options)};
  if (adaptive) {
    repeat.options.tolerance = tightened(run.tolerance.relative), repeat.options.step = run.step;
    repeat.setting = fmt::format("tolerance {:.0e}", repeat.options.tolerance.relative);
  } else {
    repeat.options.step = kShorter * run.step;
    repeat.setting = fmt::format("step {:.3g} s", repeat.options.step);
  }
  repeat.make = [&loaded, run] { return make_integrator(run, loaded.registry); };
  return repeat;
}

// The other adaptive methods, the most promising first.
std::vector<Repeat> others_of(const Loaded& loaded, const RunSettings& run, const IntegratorInfo& own,
                              const StepLoopOptions& options) {
  std::vector<Repeat> all;
  for (const MethodChoice& method : references_of(run, loaded.registry, own.implicit)) {
    const std::string type = method.name.substr(0, method.name.find(':'));
    if (type == run.integrator.type) continue;
    Repeat repeat{type, "", method.make, options};
    repeat.options.tolerance =
        own.adaptive ? tightened(run.tolerance.relative) : Tolerance{kFixedAgainst, kTighter * kFixedAgainst};
    repeat.options.step = own.adaptive ? run.step : 0;
    repeat.setting = fmt::format("tolerance {:.0e}", repeat.options.tolerance.relative);
    all.push_back(std::move(repeat));
  }
  return all;
}

// Makes the repeat and keeps it if it reached the end; else adds the reason to `text` and returns false.
bool add(std::vector<Repeat>& repeats, const Loaded& loaded, const RunSettings& run, Repeat repeat, double limit,
         std::string& text) {
  std::string failure = fmt::format("stopped after {:.2g} s; increase --budget", limit);
  try {
    if (make_again(loaded, run, repeat, limit)) {
      repeats.push_back(std::move(repeat));
      return true;
    }
  } catch (const Error& error) {
    failure = error.what();
  }
  text += fmt::format("{} at {}: {}\n", repeat.name, repeat.setting, failure);
  return false;
}

std::string verdict(const Certificate& c, const std::vector<Repeat>& repeats) {
  const CertifiedChannel* worst = nullptr;
  std::size_t n_zero = 0;
  for (const CertifiedChannel& channel : c.channels) {
    n_zero += channel.zero ? 1 : 0;
    if (!channel.zero && (worst == nullptr || channel.worst().digits < worst->worst().digits)) worst = &channel;
  }
  std::string text = fmt::format("{} times compared", c.n_rows);
  if (c.cut) text += " (the runs ended at different times)";
  if (worst != nullptr) text += fmt::format("; fewest digits: {:.1f}, of {}", worst->worst().digits, worst->name);
  if (n_zero > 0) text += fmt::format("; {} {} only round-off", n_zero, n_zero == 1 ? "channel is" : "channels are");
  if (repeats.size() < 2) text += "; only one repeat was completed";
  return text + "\n";
}

// The columns without a verified digit.
std::string doubt_of(const Certificate& c) {
  if (c.n_rows == 0) return "the repeats have no time in common with the run: no digit is verified";
  std::vector<std::string> names = without_a_digit(c);
  if (names.empty()) return {};
  constexpr std::size_t kNamed = 5;
  const std::size_t n = names.size();
  if (n > kNamed) names.resize(kNamed), names.push_back(fmt::format("{} more", n - kNamed));
  return fmt::format(
      "no digit of {} is verified; use a smaller tolerance or step, or a shorter run if the motion is chaotic",
      lockstep::text::join(names));
}

// Repeats the run with a tighter tolerance (or shorter steps) and with a second method; reports how many digits of each
// column agree. `run`: its settings; `table`: its results. Repeats that fail or exceed --budget are listed.
CertifiedRun certificate_of(const Loaded& loaded, const Arguments& args, const RunSettings& run, const Table& table) {
  RunSettings with_step = run;
  with_step.step = std::max(run.step, 1e-300);
  const IntegratorInfo own = make_integrator(with_step, loaded.registry)->info();
  StepLoopOptions options;
  options.output_times = table.columns().front().values;
  options.output_times.erase(std::unique(options.output_times.begin(), options.output_times.end()),
                             options.output_times.end());
  const double limit = 0.5 * budget_of(args);
  std::string text;
  std::vector<Repeat> repeats;
  add(repeats, loaded, run, tighter_of(loaded, run, own.adaptive, options), limit, text);
  for (const Repeat& other : others_of(loaded, run, own, options))
    if (add(repeats, loaded, run, other, limit, text)) break;
  if (repeats.empty())
    return {text + "no repeat was completed: no digit is verified\n", "no repeat was completed: no digit is verified"};
  std::vector<const Table*> tables;
  std::vector<std::string> names, against;
  for (const Repeat& repeat : repeats) {
    tables.push_back(&repeat.table);
    names.push_back(repeat.name);
    against.push_back(fmt::format("{} ({})", repeat.name, repeat.setting));
  }
  const double exchanged = repeats.front().exchanged;
  const Certificate c = certify(table, tables, exchanged);
  const bool energies = std::ranges::any_of(table.columns(), [](const Column& column) { return column.unit == "J"; });
  return {
      text + fmt::format(
                 "digits of each column that agree with {}: log10(largest / difference){}\n{}{}",
                 lockstep::text::join(against),
                 energies ? fmt::format("; for energies, largest is at least the {:.2g} J exchanged", exchanged) : "",
                 certificate_text(c, names), verdict(c, repeats)),
      doubt_of(c)};
}

}  // namespace

Command certify_command() {
  return {"run", run_options(), [](const Arguments& args) { return run_and_certify(args, certificate_of); }, "",
          run_results()};
}

}  // namespace lockstep
