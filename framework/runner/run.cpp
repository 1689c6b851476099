// The verbs that move something: run and assemble.
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "framework/analysis/assembly.h"
#include "framework/dynamics/simulation.h"
#include "framework/model/read.h"
#include "framework/runner/commands.h"
#include "framework/runner/files.h"
#include "framework/runner/progress.h"
#include "framework/runner/summary.h"
#include "framework/scene/observe.h"

namespace lockstep {
namespace {

constexpr double kSayMove = 1e-6;  // m, rad, m/s: an assembly that changed less goes without saying

// Where nothing is recorded: the places of the bodies that move.
void record_places(Mechanism& m) {
  if (!m.run.record.empty()) return;
  for (const Body& body : m.system.bodies())
    if (!body.fixed)
      for (const char* axis : {".x", ".y", ".z"}) m.run.record.push_back({body.name + axis, "", {}});
}

std::string assembly_text(const AssemblyReport& r) {
  std::string text = fmt::format(
      "assembled  the start violated the constraints by {:.2g} m and {:.2g} m/s, now by {:.2g} m and {:.2g} m/s",
      r.before, r.before_v, r.after, r.after_v);
  if (r.largest_move == 0 && r.largest_turn == 0) text += "; only velocities changed";
  if (r.largest_move > 0) text += fmt::format("; moved '{}' by {:.3g} m", r.moved_most, r.largest_move);
  if (r.largest_turn > 0) text += fmt::format("; turned '{}' by {:.3g} rad", r.turned_most, r.largest_turn);
  return text;
}

bool worth_saying(const AssemblyReport& r) {
  return r.before > kSayMove || r.before_v > kSayMove || r.largest_move > kSayMove || r.largest_turn > kSayMove;
}

std::string heading(const Loaded& loaded) {
  return loaded.scene.title.empty() ? loaded.scene.file : loaded.scene.title;
}

SimulationOptions options_of(const RunSettings& run) {
  SimulationOptions options;
  options.step = run.step;
  options.tolerance = run.tolerance;
  options.output = run.output;
  options.output_times = run.times;
  return options;
}

struct Ended {
  std::exception_ptr error;
  bool interrupted = false;
};

Ended go(Simulation& sim, double until, bool quiet, double& seconds) {
  Ended ended;
  Interrupt interrupt;
  Progress progress(until, quiet);
  sim.progress = [&](const State& s) {
    progress.at(s.t);
    return !interrupt.asked();
  };
  try {
    sim.run_until(until);
  } catch (...) {
    ended.error = std::current_exception();
  }
  progress.finish();
  ended.interrupted = interrupt.asked();
  seconds = progress.seconds();
  return ended;
}

void print_end(const Simulation& sim, const RunSettings& run, const Summary& summary, double seconds) {
  const SimulationReport& r = sim.report();
  fmt::print("  run        t = {:.6g} s in {} steps of {} ({} tries rejected), {:.3g} s of computing\n", sim.state().t,
             r.steps, run.integrator.type, r.rejected, seconds);
  if (r.stopped && !r.stopped_by.empty()) fmt::print("  stopped    by '{}'\n", r.stopped_by);
  fmt::print("{}", summary.text());
  fmt::print("  drift      constraints violated by at most {:.2g} m after a step\n", r.largest_violation);
}

}  // namespace

int run_command(const Words& w) {
  Loaded loaded = load(w);
  Mechanism m = build(loaded.scene, loaded.registry);
  if (m.run.until <= 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene does not say how long it runs; add it, or give --until 5");
  record_places(m);
  const std::string csv = csv_path(w.record, w.scene);
  check_writable(csv);

  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  Summary summary(m.system);
  Dynamics dynamics(m.system, make_solver(m.run, loaded.registry), {m.run.formulation, m.run.stabilization});
  State start = m.system.start();
  if (!w.quiet) fmt::print("{}\n", heading(loaded));
  if (m.run.assemble) {
    const AssemblyReport report = assemble(dynamics, start, m.start_speeds);
    if (!w.quiet && worth_saying(report)) fmt::print("  {}\n", assembly_text(report));
  }

  Simulation sim(dynamics, make_integrator(m.run, loaded.registry), options_of(m.run));
  sim.add_observer(*recorder);
  sim.add_observer(summary);
  for (Event& event : events) sim.add_event(std::move(event));
  sim.set_state(std::move(start));

  double seconds = 0;
  const Ended ended = go(sim, m.run.until, w.quiet, seconds);
  write_csv(csv, recorder->table());  // in every case: what was computed is never lost
  if (ended.error) {
    fmt::print(stderr, "lockstep: the run ended at t = {:.9g} s; {} rows up to there are in {}\n", sim.state().t,
               recorder->table().n_rows(), csv);
    std::rethrow_exception(ended.error);
  }
  const std::vector<std::string> pictures = draw_columns(csv, heading(loaded), recorder->table(), m.run.draw);
  if (!w.quiet) {
    print_end(sim, m.run, summary, seconds);
    fmt::print("  files      {} ({} rows)\n", csv, recorder->table().n_rows());
    for (const std::string& picture : pictures) fmt::print("             {}\n", picture);
    if (pictures.empty())
      fmt::print(
          "             no picture: gnuplot is not installed (apt install gnuplot-nox), or there is nothing to draw\n");
  }
  if (ended.interrupted)
    fmt::print(stderr, "lockstep: interrupted at t = {:.9g} s; everything up to there is written\n", sim.state().t);
  return ended.interrupted ? kExitInterrupted : kExitOk;
}

int assemble_command(const Words& w) {
  const Loaded loaded = load(w);
  Mechanism m = build(loaded.scene, loaded.registry);
  Dynamics dynamics(m.system, make_solver(m.run, loaded.registry), {m.run.formulation, m.run.stabilization});
  State state = m.system.start();
  const AssemblyReport r = assemble(dynamics, state, m.start_speeds);
  nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
  if (!w.json) fmt::print("{}\n  {}\n", heading(loaded), assembly_text(r));
  for (const Body& body : m.system.bodies()) {
    if (body.fixed) continue;
    const Pose at = pose(body, state);
    bodies[body.name] = {{"position", {at.x[0], at.x[1], at.x[2]}}, {"orientation", {at.q.w, at.q.x, at.q.y, at.q.z}}};
    if (!w.json)
      fmt::print("  {:<14} at [{}, {}, {}], orientation [{}, {}, {}, {}]\n", body.name, at.x[0], at.x[1], at.x[2],
                 at.q.w, at.q.x, at.q.y, at.q.z);
  }
  const nlohmann::ordered_json report = {{"before", r.before},           {"after", r.after},
                                         {"before_v", r.before_v},       {"after_v", r.after_v},
                                         {"iterations", r.iterations},   {"largest_move", r.largest_move},
                                         {"moved_most", r.moved_most},   {"largest_turn", r.largest_turn},
                                         {"turned_most", r.turned_most}, {"bodies", bodies}};
  if (w.json) fmt::print("{}\n", report.dump(1, ' '));
  return kExitOk;
}

}  // namespace lockstep
