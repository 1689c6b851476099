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
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/run_words.h"
#include "framework/tools/program/words.h"
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
std::vector<std::string> print_files(const std::string& csv, const std::string& title, const Table& table,
                                     const RunSettings& run, const Arguments& args, const Words& words) {
  words.say("  files      {} ({})\n", args.record == "-" ? "the rows on standard output" : csv, rows_of(table));
  if (args.no_picture || args.record == "-") return {csv};
  const Drawing drawing = draw_columns(csv, title, table, run.draw);
  if (!words && drawing.failed) fmt::print(stderr, "lockstep: no picture: {}\n", drawing.reason);
  for (const std::string& picture : drawing.files) words.say("             {}\n", picture);
  if (drawing.files.empty()) words.say("             no picture: {}\n", drawing.reason);
  const std::size_t n = table.n_columns() - 1;
  if (!drawing.files.empty() && run.draw.empty() && drawing.n_drawn < n)
    words.say("             drawn: {} of {} columns; choose with run.draw\n", drawing.n_drawn, n);
  std::vector<std::string> files{csv};
  files.insert(files.end(), drawing.files.begin(), drawing.files.end());
  return files;
}

void print_json(const Arguments& args, const Loaded& loaded, nlohmann::ordered_json result) {
  nlohmann::ordered_json j = {{"scene", loaded.scene.file}, {"title", loaded.title()}, {"command", args.command}};
  j.update(result);
  print_document(j);
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
    const std::filesystem::path csv = csv_path(args.record == "-" ? "" : args.record, args.scene);
    with_report.report = std::filesystem::path(csv).replace_extension(".html").string();
  }
  return run_command(with_report);
}

int run_command(const Arguments& args) {
  if (args.quiet) set_logger(nullptr);
  const Words words(args);
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
  words.say("{}\n", loaded.title());
  if (m.run.assemble) {
    const AssemblyReport assembled = assemble(dynamics, start, m.start_speeds);
    if (assembled.is_notable()) words.say("  assembled  {}\n", assembled.text());
    if (assembled.largest_move > 1e-6)
      for (const std::string& text : frames_taken(loaded.scene))
        words.say("  taken      {}, as no place is given\n", text);
  }

  if (!args.quiet)
    if (const std::vector<std::string> columns = not_unique(dynamics, start, m.run); !columns.empty())
      fmt::print("  not unique {}: how redundant rows share these reactions is the solver's choice (lockstep check)\n",
                 first_of(columns));

  report.mark(dynamics, start);

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
    if (args.json)
      print_json(args, loaded,
                 {{"status", "failed"},
                  {"t", sim.state().t},
                  {"error", thrown_words(ended.error)},
                  {"rows", recorder->table().n_rows()},
                  {"files", {file.partial()}}});
    std::rethrow_exception(ended.error);
  }
  const Audit found = audit ? audit->result() : drift_alone(sim, m.run.limits);
  const EndedRun end{sim, m.run, found, seconds, ended.interrupted};
  const std::string lines = audit ? end_words(end, summary) : "";
  words.say("{}", lines);
  if (unwritten) std::rethrow_exception(unwritten);
  file.commit();
  std::vector<std::string> files = print_files(csv, loaded.title(), recorder->table(), m.run, args, words);
  if (report) {
    report.write(sim, lines, ended.interrupted ? fmt::format("interrupted at t = {:.9g} s", sim.state().t) : "");
    words.say("             {}\n", report.file());
    files.push_back(report.file());
    show(args, report);
  }
  if (args.json) {
    nlohmann::ordered_json j = json_of(end, recorder->table());
    j["files"] = files;
    print_json(args, loaded, std::move(j));
  }
  if (args.certify && !ended.interrupted)
    fmt::print(args.record == "-" ? stderr : stdout, "{}", certificate_of(loaded, args, m.run, recorder->table()));
  if (ended.interrupted)
    fmt::print(stderr, "lockstep: interrupted at t = {:.9g} s; everything up to there is written\n", sim.state().t);
  if (ended.interrupted) return kExitInterrupted;
  return is_wrong(found, sim.integrator().info()) ? kExitNotConserved : kExitOk;
}

int assemble_command(const Arguments& args) {
  if (!args.branches.empty()) return branches_command(args);
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
  if (args.json) print_document(report);
  return kExitOk;
}

}  // namespace lockstep
