#include "framework/tools/program/certify.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "framework/tools/analysis/certificate.h"
#include "framework/tools/program/survey.h"
#include "framework/tools/program/ways.h"
#include <lockstep/sweep.h>

namespace lockstep {
namespace {

constexpr double kTighter = 1e-2, kShorter = 0.25;  // of the tolerance, of the step
constexpr double kTightest = 1e-13,
                 kFixedAgainst = 1e-10;  // tolerances: the least; of the second method beside fixed steps
constexpr double kProjection = 1e-12;    // m

/// The run again, by other means.
struct SecondRun {
  std::string name;     // of its column
  std::string setting;  // in words
  std::function<std::unique_ptr<Integrator>()> make;
  StepLoopOptions options;
};

Tolerance tightened(double relative) {
  const double r = std::max(kTightest, kTighter * relative);
  return {r, kTighter * r};
}

// Throws what the run throws; nothing when it outlasted `limit`, s of CPU time.
std::optional<Table> make_again(const Loaded& loaded, const RunSettings& run, const SecondRun& repeat, double limit) {
  Mechanism m = build(loaded.scene, loaded.registry);
  m.run.record = run.record;
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  Stabilization stabilization = run.stabilization;
  stabilization.tolerance = std::min(stabilization.tolerance, kProjection);
  Dynamics dynamics(m.system, make_solver(run, loaded.registry), {run.formulation, stabilization});
  State start = m.system.start();
  if (run.assemble) assemble(dynamics, start, m.start_speeds);
  StepLoop sim(dynamics, repeat.make(), repeat.options);
  sim.add_observer(*recorder);
  for (Event& event : events) sim.add_event(std::move(event));
  sim.set_state(std::move(start));
  const double begin = thread_seconds();
  bool given_up = false;
  sim.progress = [&](const State&) { return !(given_up = thread_seconds() - begin > limit); };
  sim.run_until(run.until);
  if (given_up) return std::nullopt;
  return recorder->table();
}

SecondRun tighter_of(const Loaded& loaded, const RunSettings& run, bool adaptive, StepLoopOptions options) {
  SecondRun repeat{run.integrator.type + " tighter", "", {}, std::move(options)};
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

// The other adaptive methods, the likeliest first.
std::vector<SecondRun> others_of(const Loaded& loaded, const RunSettings& run, const IntegratorInfo& own,
                              const StepLoopOptions& options) {
  std::vector<SecondRun> all;
  for (const MethodChoice& method : references_of(run, loaded.registry, own.implicit)) {
    const std::string type = method.name.substr(0, method.name.find(':'));
    if (type == run.integrator.type) continue;
    SecondRun repeat{type, "", method.make, options};
    repeat.options.tolerance =
        own.adaptive ? tightened(run.tolerance.relative) : Tolerance{kFixedAgainst, kTighter * kFixedAgainst};
    repeat.options.step = own.adaptive ? run.step : 0;
    repeat.setting = fmt::format("tolerance {:.0e}", repeat.options.tolerance.relative);
    all.push_back(std::move(repeat));
  }
  return all;
}

/// Repeats that came to an end.
struct Repeats {
  std::vector<Table> tables;
  std::vector<std::string> names, settings;
};

// Whether it came to an end; why not is said.
bool add(Repeats& repeats, const Loaded& loaded, const RunSettings& run, const SecondRun& repeat, double limit) {
  try {
    std::optional<Table> table = make_again(loaded, run, repeat, limit);
    if (table) {
      repeats.tables.push_back(std::move(*table));
      repeats.names.push_back(repeat.name), repeats.settings.push_back(repeat.setting);
      return true;
    }
    fmt::print("             {} at {}: given up after {:.2g} s; give more with --budget\n", repeat.name, repeat.setting,
               limit);
  } catch (const Error& error) {
    fmt::print("             {} at {}: {}\n", repeat.name, repeat.setting, error.what());
  }
  return false;
}

std::string verdict(const Certificate& c, const Repeats& repeats) {
  const CertifiedChannel* worst = nullptr;
  std::size_t n_zero = 0;
  for (const CertifiedChannel& channel : c.channels) {
    n_zero += channel.zero ? 1 : 0;
    if (!channel.zero && (worst == nullptr || channel.worst().digits < worst->worst().digits)) worst = &channel;
  }
  std::string text = fmt::format("  {} instants compared", c.n_rows);
  if (c.cut) text += " (the runs ended at different instants)";
  if (worst != nullptr) text += fmt::format("; fewest digits: {:.1f}, of {}", worst->worst().digits, worst->name);
  if (n_zero > 0)
    text += fmt::format("; {} {} nothing but round-off", n_zero, n_zero == 1 ? "channel is" : "channels are");
  if (repeats.tables.size() < 2) text += "; only one repeat came to an end";
  return text + "\n";
}

}  // namespace

void print_certificate(const Loaded& loaded, const Words& w, const RunSettings& run, const Table& table) {
  RunSettings with_step = run;
  with_step.step = std::max(run.step, 1e-300);
  const IntegratorInfo own = make_integrator(with_step, loaded.registry)->info();
  StepLoopOptions options;
  options.output_times = table.columns().front().values;
  options.output_times.erase(std::unique(options.output_times.begin(), options.output_times.end()),
                             options.output_times.end());
  const double limit = 0.5 * budget_of(w);
  fmt::print("  certificate\n");
  Repeats repeats;
  add(repeats, loaded, run, tighter_of(loaded, run, own.adaptive, options), limit);
  for (const SecondRun& other : others_of(loaded, run, own, options))
    if (add(repeats, loaded, run, other, limit)) break;
  if (repeats.tables.empty()) {
    fmt::print("             no repeat came to an end: nothing is certified\n");
    return;
  }
  std::vector<const Table*> tables;
  for (const Table& t : repeats.tables) tables.push_back(&t);
  const Certificate c = certify(table, tables);
  std::string against;
  for (std::size_t i = 0; i < repeats.names.size(); ++i)
    against += fmt::format("{}{} ({})", i == 0 ? "" : " and ", repeats.names[i], repeats.settings[i]);
  fmt::print("  digits of each column that agree with {}: log10(largest / difference)\n{}{}", against,
             certificate_text(c, repeats.names), verdict(c, repeats));
}

}  // namespace lockstep
