// SPDX-License-Identifier: BSD-3-Clause
// The command run with --certify: the run is repeated by other means, and the columns are compared.
#include "framework/tools/commands/tool_commands.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/simulation.h>
#include <lockstep/text.h>
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/precision/certificate.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/rank/doubts.h"

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
  RunSettings run;
  Table table{};         // what it recorded
  double exchanged = 0;  // energy, J
};

Repeat at_tolerance(const std::string& name, RunSettings run, double relative) {
  run.tolerance = {relative, kTighter * relative};
  return {name, fmt::format("tolerance {:.0e}", relative), std::move(run)};
}
double tightened(const RunSettings& run) { return std::max(kTightest, kTighter * run.tolerance.relative); }

// Runs it; false if that took longer than `limit`, s of CPU time.
bool make_again(const Loaded& loaded, Repeat& repeat, double limit) {
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  m.run = repeat.run;
  Simulation sim(std::move(m));
  StepLoop& loop = sim.loop();
  const double begin = thread_seconds();
  bool given_up = false;
  loop.progress = [&](const State&) { return !(given_up = thread_seconds() - begin > limit); };
  sim.run();
  repeat.table = sim.table(), repeat.exchanged = sim.verdict().audit.scale;
  return !given_up;
}

Repeat tighter_of(RunSettings run, bool adaptive) {
  const std::string name = "tighter " + run.integrator.type;
  if (adaptive) return at_tolerance(name, run, tightened(run));
  run.step *= kShorter;
  return {name, fmt::format("step {:.3g} s", run.step), run};
}

// The other adaptive methods, the most promising first.
std::vector<Repeat> others_of(const Registry& registry, const RunSettings& run, const IntegratorInfo& own) {
  std::vector<Repeat> all;
  for (const MethodChoice& method : references_of(run, registry, own.implicit)) {
    RunSettings other = run;
    other.integrator = read_spec("integrator", method.name, types_of(registry.integrators));
    if (other.integrator.type == run.integrator.type) continue;
    if (!own.adaptive) other.step = 0;
    all.push_back(at_tolerance(other.integrator.type, other, own.adaptive ? tightened(run) : kFixedAgainst));
  }
  return all;
}

// Makes the repeat and keeps it if it reached the end; else adds the reason to `text` and returns false.
bool add(std::vector<Repeat>& repeats, const Loaded& loaded, Repeat repeat, double limit, std::string& text) {
  std::string failure = fmt::format("stopped after {:.2g} s; increase --budget", limit);
  try {
    if (make_again(loaded, repeat, limit)) {
      repeats.push_back(std::move(repeat));
      return true;
    }
  } catch (const Error& error) {
    failure = error.what();
  }
  text += fmt::format("{} at {}: {}\n", repeat.name, repeat.setting, failure);
  return false;
}

std::string verdict(const Certificate& c, const std::vector<Repeat>& repeats, bool energies) {
  const CertifiedChannel* worst = nullptr;
  std::size_t n_zero = 0;
  for (const CertifiedChannel& channel : c.channels) {
    n_zero += channel.zero ? 1 : 0;
    if (!channel.zero && (worst == nullptr || channel.worst().digits < worst->worst().digits)) worst = &channel;
  }
  std::string text = fmt::format("{} times compared", c.n_rows);
  if (c.cut) text += " (the runs ended at different times)";
  if (worst != nullptr) text += fmt::format("; fewest digits: {:.1f}, of {}", worst->worst().digits, worst->name);
  if (energies) text += "; scale of energies: at least the energy exchanged";
  if (n_zero > 0) text += fmt::format("; {} {} only round-off", n_zero, n_zero == 1 ? "channel is" : "channels are");
  if (repeats.size() < 2) text += "; only one repeat was completed";
  return text + "\n";
}

// The columns without a verified digit.
std::string doubt_of(const Certificate& c) {
  if (c.n_rows == 0) return "the repeats have no time in common with the run: no digit is verified";
  const std::vector<std::string> names = without_a_digit(c);
  if (names.empty()) return {};
  return fmt::format(
      "no digit of {} is verified; use a smaller tolerance or step, or a shorter run if the motion is chaotic",
      first_of(names, 5));
}

// Repeats the run with a tighter tolerance (or shorter steps) and with a second method; reports how many digits of each
// column agree. `run`: its settings; `table`: its results. Repeats that fail or exceed --budget are listed.
CertifiedRun certificate_of(const Loaded& loaded, const Arguments& args, const RunSettings& run, const Table& table) {
  const IntegratorInfo own = integrator_info(run, loaded.registry);
  RunSettings again = run;
  again.times = table.columns().front().values;
  again.times.erase(std::unique(again.times.begin(), again.times.end()), again.times.end());
  again.output = 0, again.at_jumps = false, again.max_steps = 0;
  again.stabilization.tolerance = std::min(run.stabilization.tolerance, kProjection);
  const double limit = 0.5 * budget_of(args);
  std::string text;
  std::vector<Repeat> repeats;
  add(repeats, loaded, tighter_of(again, own.adaptive), limit, text);
  for (const Repeat& other : others_of(loaded.registry, again, own))
    if (add(repeats, loaded, other, limit, text)) break;
  if (repeats.empty())
    return {text + "no repeat was completed: no digit is verified\n", "no repeat was completed: no digit is verified"};
  std::vector<const Table*> tables;
  std::vector<std::string> names, against;
  for (const Repeat& repeat : repeats) {
    tables.push_back(&repeat.table);
    names.push_back(repeat.name);
    against.push_back(fmt::format("{} ({})", repeat.name, repeat.setting));
  }
  const Certificate c = certify(table, tables, repeats.front().exchanged);
  const bool energies = std::ranges::any_of(table.columns(), [](const Column& column) { return column.unit == "J"; });
  return {text + fmt::format("verified digits, log10(scale / difference), by {}\n{}{}", lockstep::text::join(against),
                             certificate_text(c, names), verdict(c, repeats, energies)),
          doubt_of(c)};
}

}  // namespace

Command certify_command() {
  return {"run", run_options(), [](const Arguments& args) { return run_and_certify(args, certificate_of); }, "",
          run_results()};
}

}  // namespace lockstep
