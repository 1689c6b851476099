// The verbs run and assemble.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include <lockstep/assembly.h>
#include <lockstep/log.h>
#include <lockstep/step_loop.h>
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/program/certify.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/summary.h"
#include "framework/tools/sweep/scene_run.h"

namespace lockstep {
namespace {

// An error is returned: it must not hide that of the run.
std::exception_ptr write_rest(GrowingFile& file) {
  try {
    file.write();
    return nullptr;
  } catch (const std::exception&) {
    return std::current_exception();
  }
}

struct Ended {
  std::exception_ptr error;
  bool interrupted = false;
};

Ended go(StepLoop& sim, double until, bool quiet, double& seconds) {
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

std::string counted(long n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }
std::string rows_of(const Table& table) { return counted(static_cast<long>(table.n_rows()), "row", "rows"); }

// What is printed of a run that ended.
std::string end_words(StepLoop& sim, const RunSettings& run, const Summary& summary, const Audit& audit, double seconds,
                      bool interrupted) {
  std::string words;
  const auto say = [&]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    words += fmt::format(format, std::forward<Args>(args)...);
  };
  const SimulationReport& r = sim.report();
  const std::string rejected =
      sim.integrator().info().adaptive ? fmt::format(" ({} rejected)", counted(r.rejected, "try", "tries")) : "";
  say("  run        t = {:.6g} s in {} of {}{}, {:.3g} s of computing\n", sim.state().t,
      counted(r.steps, "step", "steps"), run.integrator.type, rejected, seconds);
  if (r.manifold_steps > 0)
    say("  stages     on the constraints in {} of {}, as singular positions or rows that are redundant only there ask "
        "for\n",
        r.manifold_steps, counted(r.steps, "step", "steps"));
  if (std::isfinite(r.stiff_since))
    say("  stiff      from t = {:.4g} s on damped fast modes limited the steps, not accuracy: an implicit method is "
        "cheaper (--integrator radau5 or generalized_alpha)\n",
        r.stiff_since);
  const auto& links = sim.system().links();
  const auto resting = std::count_if(links.begin(), links.end(), [&](const auto& link) {
    return link->unilateral() && sim.state().modes[link->number()];
  });
  if (r.impacts > 0 || resting > 0)
    say("  impacts    {} of one-sided links; {} of them {} in contact at the end\n", r.impacts, resting,
        resting == 1 ? "is" : "are");
  if (r.stopped && !r.stopped_by.empty() && !interrupted) say("  stopped    by '{}'\n", r.stopped_by);
  say("{}", summary.text());
  say("{}", words_of(audit, summary.nothing_moved(), sim.integrator().info().adaptive));
  if (!sim.system().links().empty())
    say("  {}    constraints violated by at most {:.2g} m after a step{}\n", audit.drifted ? "DRIFTED" : "drift  ",
        r.largest_violation,
        audit.drifted ? fmt::format(" (limit {:.2g} m): project them (stabilization project)", audit.limits.violation)
                      : "");
  return words;
}

// Methods of fixed steps promise no error: what they do to the energy is only said.
bool is_wrong(const Audit& audit, const IntegratorInfo& method) {
  return audit.drifted || (audit.energy == Audit::Energy::not_conserved && method.adaptive);
}

// Without a report no energies are integrated, and drift alone is judged.
Audit drift_alone(const StepLoop& sim, const AuditLimits& limits) {
  Audit audit;
  audit.limits = limits.of(sim.system().length());
  audit.violation = sim.report().largest_violation;
  audit.drifted = !(audit.violation <= audit.limits.violation);
  if (audit.drifted)
    fmt::print(stderr, "lockstep: the run drifted off its constraints by {:.2g} m (limit {:.2g} m)\n", audit.violation,
               audit.limits.violation);
  return audit;
}

// The table first: it is reported even if the picture fails.
void print_files(const std::string& csv, const std::string& title, const Table& table, const RunSettings& run,
                 bool quiet) {
  if (!quiet) {
    fmt::print("  files      {} ({})\n", csv, rows_of(table));
    std::fflush(stdout);
  }
  const Drawing drawing = draw_columns(csv, title, table, run.draw);
  if (quiet) {
    if (drawing.failed) fmt::print(stderr, "lockstep: no picture: {}\n", drawing.reason);
    return;
  }
  for (const std::string& picture : drawing.files) fmt::print("             {}\n", picture);
  if (drawing.files.empty()) fmt::print("             no picture: {}\n", drawing.reason);
  const std::size_t n = table.n_columns() - 1;
  if (!drawing.files.empty() && run.draw.empty() && drawing.n_drawn < n)
    fmt::print("             drawn: {} of {} columns; choose with run.draw\n", drawing.n_drawn, n);
}

// Springs that push away from where they should hold.
std::vector<std::string> negative_stiffness(const Scene& scene) {
  std::vector<std::string> all;
  const Value* forces = scene.root.find("forces");
  if (forces == nullptr || forces->list() == nullptr) return all;
  for (const Value& force : *forces->list()) {
    const Value *name = force.find("name"), *k = force.find("stiffness");
    if (k == nullptr || name == nullptr || name->text() == nullptr) continue;
    const std::string* text = k->text();
    if (text != nullptr ? text->starts_with('-') : k->number() != nullptr && *k->number() < 0)
      all.push_back(fmt::format("force '{}', stiffness: {} is negative: it pushes away from its free length or angle",
                                *name->text(), plain_text(*k)));
  }
  return all;
}

// One line for each setting that has no effect, or hardly the one that was meant.
void warn(const Scene& scene, const Mechanism& m, const Arguments& args, StepLoop& sim) {
  const RunSettings& run = m.run;
  const auto say = [&](const std::string& text) { sim.warn(text); };
  if (!run.times.empty() && run.times.back() > run.until)
    say(fmt::format("run.times: {:g} s lies beyond the end of the run at {:g} s and is not recorded", run.times.back(),
                    run.until));
  if (run.output > run.until)
    say(fmt::format("run.output: {:g} s is longer than the run of {:g} s: only its start and its end are recorded",
                    run.output, run.until));
  for (const std::string& words : negative_stiffness(scene)) say(words);
  for (const EventRequest& e : m.events)
    if (e.event.at > run.until)
      say(fmt::format("event '{}': {:g} s lies beyond the end of the run at {:g} s, so it never comes", e.event.name,
                      e.event.at, run.until));
  const Value* settings = scene.root.find("run");
  const bool in_scene = args.integrator.empty() && settings != nullptr && settings->find("tolerance") != nullptr;
  if ((in_scene || !args.tolerance.empty()) && !sim.integrator().info().adaptive)
    say(fmt::format("tolerance: \"{}\" takes fixed steps and has no use for it", run.integrator.type));
}

// The recorded columns that hold reactions which are not unique at the start.
std::vector<std::string> not_unique(Dynamics& dynamics, const State& start, const RunSettings& run) {
  const auto is_reaction = [](const ChannelRequest& r) {
    return r.channel.find("_on_p_") != std::string::npos || r.channel.find("_on_s_") != std::string::npos ||
           r.channel.find(".lambda_") != std::string::npos;
  };
  if (std::ranges::none_of(run.record, is_reaction)) return {};
  return columns_not_unique(run, uniqueness(dynamics, start));
}

// What a run showed until it failed; the error itself matters more than one of this file.
void write_unfinished(const RunReport& report, const StepLoop& sim, const std::exception_ptr& error) {
  if (!report) return;
  try {
    report.write(sim, "", fmt::format("the run ended at t = {:.9g} s: {}", sim.state().t, thrown_words(error)));
    fmt::print(stderr, "lockstep: its report up to there is {}\n", report.file());
  } catch (const std::exception& second) {
    fmt::print(stderr, "lockstep: no report: {}\n", second.what());
  }
}

void show(const Arguments& args, const RunReport& report) {
  if (!args.open) return;
  const std::string problem = open_in_browser(report.file());
  if (!problem.empty()) fmt::print(stderr, "lockstep: {}\n", problem);
}

}  // namespace

int report_command(const Arguments& args) {
  Arguments with_report = args;
  if (with_report.report.empty()) {
    const std::filesystem::path csv = csv_path(args.record, args.scene);
    with_report.report = std::filesystem::path(csv).replace_extension(".html").string();
  }
  return run_command(with_report);
}

int run_command(const Arguments& args) {
  if (args.quiet) set_logger(nullptr);
  Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  if (m.run.until <= 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene does not say how long it runs; add it, or give --until 5");
  record_places(m);
  const std::string csv = csv_path(args.record, args.scene);
  check_overwrites(csv, loaded.scene);
  GrowingFile file(csv);

  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  RunReport report(args, loaded, m, *recorder, csv);
  Summary summary;
  std::optional<EnergyAudit> audit;  // energies are integrated only if they are printed
  if (!args.quiet) audit.emplace(m.system, m.run.limits);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State start = m.system.start();
  if (!args.quiet) fmt::print("{}\n", loaded.title());
  if (m.run.assemble) {
    const AssemblyReport assembled = assemble(dynamics, start, m.start_speeds);
    if (!args.quiet && assembled.is_notable()) fmt::print("  assembled  {}\n", assembled.text());
    if (!args.quiet && assembled.largest_move > 1e-6)
      for (const std::string& text : frames_taken(loaded.scene))
        fmt::print("  taken      {}, as no place is given\n", text);
  }

  if (!args.quiet)
    if (const std::vector<std::string> columns = not_unique(dynamics, start, m.run); !columns.empty())
      fmt::print("  not unique {}: how redundant rows share these reactions is the solver's choice (lockstep check)\n",
                 first_of(columns));

  StepLoop sim(dynamics, make_integrator(m.run, loaded.registry), loop_options(m.run));
  GrowingCsv rows(file, recorder->table());
  sim.add_observer(*recorder);
  sim.add_observer(rows);
  if (audit) sim.add_observer(summary), sim.add_observer(*audit);
  report.watch(sim);
  for (Event& event : events) sim.add_event(std::move(event));
  sim.set_state(std::move(start));
  warn(loaded.scene, m, args, sim);

  double seconds = 0;
  const Ended ended = go(sim, m.run.until, args.quiet, seconds);
  const std::exception_ptr unwritten = write_rest(file);
  if (ended.error) {
    const std::string written = unwritten
                                    ? "the rows up to there could not be written: " + thrown_words(unwritten)
                                    : rows_of(recorder->table()) + " up to there " +
                                          (recorder->table().n_rows() == 1 ? "is" : "are") + " in " + file.partial();
    fmt::print(stderr, "lockstep: the run ended at t = {:.9g} s; {}\n", sim.state().t, written);
    write_unfinished(report, sim, ended.error);
    std::rethrow_exception(ended.error);
  }
  const Audit found = audit ? audit->result() : drift_alone(sim, m.run.limits);
  const std::string words = audit ? end_words(sim, m.run, summary, found, seconds, ended.interrupted) : "";
  fmt::print("{}", words);
  if (unwritten) std::rethrow_exception(unwritten);
  file.commit();
  print_files(csv, loaded.title(), recorder->table(), m.run, args.quiet);
  if (report) {
    report.write(sim, words, ended.interrupted ? fmt::format("interrupted at t = {:.9g} s", sim.state().t) : "");
    if (!args.quiet) fmt::print("             {}\n", report.file());
    show(args, report);
  }
  if (args.certify && !ended.interrupted) print_certificate(loaded, args, m.run, recorder->table());
  if (ended.interrupted)
    fmt::print(stderr, "lockstep: interrupted at t = {:.9g} s; everything up to there is written\n", sim.state().t);
  if (ended.interrupted) return kExitInterrupted;
  return is_wrong(found, sim.integrator().info()) ? kExitNotConserved : kExitOk;
}

int assemble_command(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State state = m.system.start();
  const AssemblyReport r = assemble(dynamics, state, m.start_speeds);
  nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
  if (!args.json) fmt::print("{}\n  assembled  {}\n", loaded.title(), r.text());
  for (const Body& body : m.system.bodies()) {
    if (body.fixed) continue;
    const Pose at = body_pose(body, state);
    bodies[body.name] = {{"position", {at.x[0], at.x[1], at.x[2]}}, {"orientation", {at.q.w, at.q.x, at.q.y, at.q.z}}};
    if (!args.json)
      fmt::print("  {:<14} at [{}, {}, {}], orientation [{}, {}, {}, {}]\n", body.name, at.x[0], at.x[1], at.x[2],
                 at.q.w, at.q.x, at.q.y, at.q.z);
  }
  const nlohmann::ordered_json report = {{"before", r.before},           {"after", r.after},
                                         {"before_v", r.before_v},       {"after_v", r.after_v},
                                         {"iterations", r.iterations},   {"largest_move", r.largest_move},
                                         {"moved_most", r.moved_most},   {"largest_turn", r.largest_turn},
                                         {"turned_most", r.turned_most}, {"bodies", bodies}};
  if (args.json) fmt::print("{}\n", report.dump(1, ' '));
  return kExitOk;
}

}  // namespace lockstep
