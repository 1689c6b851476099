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
#include <lockstep/text.h>
#include "framework/description/scene/run_outputs.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/analysis/branch_point.h"
#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/program/certify.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/detail_rows.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_checkpoint.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/run_rows.h"
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

Ended go(StepLoop& sim, double until, bool quiet, Checkpoints& checkpoints, double& seconds) {
  Ended ended;
  Interrupt interrupt;
  Progress progress(until, quiet);
  if (checkpoints) sim.between_steps = [&] { checkpoints.write_if_due(sim, interrupt.asked()); };
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

// "X:Y" of the command line, columns that are recorded.
PictureRequest picture_of(const std::string& text, const Table& columns) {
  for (std::size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
    const PictureRequest picture{text.substr(0, colon), text.substr(colon + 1)};
    if (columns.has(picture.x) && columns.has(picture.y)) return picture;
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw UsageError("--picture " + text + ": expected X:Y, two recorded columns, as in --picture crank.x:crank.y");
  for (const std::string& name : {text.substr(0, colon), text.substr(colon + 1)})
    if (!columns.has(name))
      throw UsageError("--picture " + text + ": \"" + name + "\" is not recorded" +
                       text::suggestion(name, columns.names()));
  return {};
}

// Of the scene and the command line.
RunOutputs outputs_of(const Loaded& loaded, const Arguments& args, const Table& columns) {
  RunOutputs out = outputs_of(loaded.scene);
  if (!args.headers.empty()) out.units = args.headers == "units";
  out.at_jumps = out.at_jumps || args.at_jumps;
  for (const std::string& text : args.pictures) out.pictures.push_back(picture_of(text, columns));
  return out;
}

// The rows that pictures need beside the table's; null where none is drawn.
std::unique_ptr<PictureRows> picture_rows(Mechanism& m, const std::string& csv, const RunRows& rows,
                                          const Arguments& args) {
  std::error_code error;
  const bool draws = !args.no_picture && csv != "-" && m.run.record.size() > 0 && !find_gnuplot().empty() &&
                     (!std::filesystem::exists(csv, error) || std::filesystem::is_regular_file(csv, error));
  if (!draws) return nullptr;
  return std::make_unique<PictureRows>(make_recorder(m), rows, picture_spacing(loop_options(m.run), m.run.until));
}

// The table first: it is reported even if the picture fails.
std::vector<std::string> print_files(const std::string& csv, const std::string& title, const RowEnvelope& rows,
                                     const PictureRows* details, const RunSettings& run, const RunOutputs& outputs,
                                     const Arguments& args, const Words& words) {
  words.say("  files      {} ({})\n", args.record == "-" ? "the rows on standard output" : csv, rows_of(rows.n_rows()));
  if (args.no_picture || args.record == "-") return {csv};
  const Table table = rows.table();
  const bool detailed = details != nullptr && table.n_rows() > 1;
  const Drawing drawing =
      draw_columns(csv, title, detailed ? details->together(table) : table, run.draw, outputs.pictures);
  if (!words && drawing.failed) fmt::print(stderr, "lockstep: no picture: {}\n", drawing.reason);
  for (const std::string& picture : drawing.files) words.say("             {}\n", picture);
  if (drawing.files.empty()) words.say("             no picture: {}\n", drawing.reason);
  if (!drawing.files.empty() && detailed && details->joins_steps())
    words.say("             curves join the ends of steps: {} has no dense output\n", run.integrator.type);
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

bool records_reactions(const RunSettings& run) {
  return std::ranges::any_of(run.record, [](const ChannelRequest& r) {
    return r.channel.find("_on_p_") != std::string::npos || r.channel.find("_on_s_") != std::string::npos ||
           r.channel.find(".lambda_") != std::string::npos;
  });
}

// A start in a singular position, where the rows alone do not say how the motion continues.
void warn_of_branches(Dynamics& dynamics, StepLoop& sim) {
  const State& start = sim.state();
  const BranchPoint at = branch_point(dynamics, start);
  if (!at.singular) return;
  constexpr double kOff = 1e-3;  // of the velocity
  const bool moves = start.v.size() > 0 && !start.v.isZero(0);
  const double off = moves && at.all ? at.off_branches(dynamics.system(), start.v) : 0;
  sim.warn(fmt::format(
      "the start lies in a singular position: {}{}", at.text(dynamics, start),
      !moves ? ". It is at rest there: which of them it takes is not determined; choose one by a small start velocity "
               "along it, or start beside the position"
      : off > kOff
          ? fmt::format(". The start velocity lies along none of them (a part of {:.2g} of it does not): give it "
                        "along one",
                        off)
          : ". It goes on along its velocity"));
}

// The recorded columns that hold reactions which are not unique at the start.
std::vector<std::string> not_unique(Dynamics& dynamics, const State& start, const RunSettings& run) {
  if (!records_reactions(run)) return {};
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

namespace {

// `from`: the checkpoint that the run goes on from; null: it begins.
int run_scene(const Arguments& args, const RunCheckpoint* from) {
  if (args.quiet) set_logger(nullptr);
  const Words words(args);
  Loaded loaded = load(args);
  if (from != nullptr) from->check(args.checkpoint, args, loaded);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  if (m.run.until <= 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene does not say how long it runs; add it, or give --until 5");
  record_places(m);
  const std::string csv = csv_path(args.record, args.scene);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  const RunOutputs outputs = outputs_of(loaded, args, recorder->table());
  check_overwrites(csv, loaded.scene, outputs.pictures);
  GrowingFile file(csv);
  Checkpoints checkpoints(args, loaded, file);

  std::vector<Event> events = make_events(m, *recorder);
  RunReport report(args, loaded, m, *recorder, csv);
  RunRows rows(file, *recorder, report || args.certify, outputs.units);  // both read the rows afterwards
  const std::unique_ptr<PictureRows> details = picture_rows(m, csv, rows, args);
  RowsAtJumps at_jumps(*recorder, rows);
  Summary summary;
  std::optional<EnergyAudit> audit;  // energies are integrated only if they are printed
  if (!args.quiet) audit.emplace(m.system, m.run.limits);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State start = m.system.start();
  words.say("{}\n", loaded.title());
  if (m.run.assemble && from == nullptr) {
    const AssemblyReport assembled = assemble(dynamics, start, m.start_speeds, m.assembly);
    if (assembled.is_notable()) words.say("  assembled  {}\n", assembled.text());
    if (assembled.largest_move > 1e-6)
      for (const std::string& text : frames_taken(loaded.scene))
        words.say("  taken      {}, as no place is given\n", text);
  }

  if (!args.quiet && from == nullptr)
    if (const std::vector<std::string> columns = not_unique(dynamics, start, m.run); !columns.empty())
      fmt::print("  not unique {}: how redundant rows share these reactions is the solver's choice (lockstep check)\n",
                 first_of(columns));

  report.mark(dynamics, start);

  StepLoop sim(dynamics, make_integrator(m.run, loaded.registry), loop_options(m.run));
  sim.add_observer(*recorder);
  if (outputs.at_jumps) sim.add_observer(at_jumps);
  sim.add_observer(rows);
  const bool judged = !args.quiet || args.strict;
  const IntegratorInfo method = sim.integrator().info();
  Doubts doubts(records_reactions(m.run), method.adaptive ? m.run.tolerance.relative : 0.0);
  SingularWatch singular(m.system);
  if (judged) sim.add_observer(doubts);
  if (judged && SingularWatch::is_needed(dynamics, start, method)) sim.add_observer(singular);
  if (details) sim.add_observer(*details);
  if (audit) sim.add_observer(summary), sim.add_observer(*audit);
  report.watch(sim);
  for (Event& event : events) sim.add_event(std::move(event));
  if (from == nullptr) {
    sim.set_state(std::move(start));
    warn(loaded.scene, m, args, sim);
    if (judged) warn_of_branches(dynamics, sim);
  } else {
    rows.go_on();
    sim.load(from->run);
    words.say("  resumed    at t = {:.6g} s, after {} steps\n", sim.state().t, sim.report().steps);
  }

  double seconds = 0;
  const Ended ended = go(sim, m.run.until, args.quiet, checkpoints, seconds);
  const std::exception_ptr unwritten = write_rest(file);
  if (ended.error) {
    const std::string written = unwritten ? "the rows up to there could not be written: " + thrown_words(unwritten)
                                          : rows_of(rows.rows().n_rows()) + " up to there " +
                                                (rows.rows().n_rows() == 1 ? "is" : "are") + " in " + file.partial();
    fmt::print(stderr, "lockstep: the run ended at t = {:.9g} s; {}\n", sim.state().t, written);
    write_unfinished(report, sim, ended.error);
    if (args.json)
      print_json(args, loaded,
                 {{"status", "failed"},
                  {"t", sim.state().t},
                  {"error", thrown_words(ended.error)},
                  {"rows", rows.rows().n_rows()},
                  {"files", {file.partial()}}});
    std::rethrow_exception(ended.error);
  }
  const Audit found = audit ? audit->result() : drift_alone(sim, m.run.limits);
  const EndedRun end{sim, m.run, found, seconds, ended.interrupted, doubts, singular.passed()};
  const std::string lines = audit ? end_words(end, summary) : "";
  words.say("{}", lines);
  if (unwritten) std::rethrow_exception(unwritten);
  file.commit();
  if (!ended.interrupted) checkpoints.remove();
  std::vector<std::string> files =
      print_files(csv, loaded.title(), rows.rows(), details.get(), m.run, outputs, args, words);
  if (report) {
    report.write(sim, lines, ended.interrupted ? fmt::format("interrupted at t = {:.9g} s", sim.state().t) : "");
    words.say("             {}\n", report.file());
    files.push_back(report.file());
    show(args, report);
  }
  if (args.json) {
    nlohmann::ordered_json j = json_of(end, rows.rows());
    j["files"] = files;
    print_json(args, loaded, std::move(j));
  }
  if (args.certify && !ended.interrupted)
    fmt::print(args.record == "-" ? stderr : stdout, "{}", certificate_of(loaded, args, m.run, recorder->table()));
  if (ended.interrupted)
    fmt::print(stderr, "lockstep: interrupted at t = {:.9g} s; everything up to there is written{}\n", sim.state().t,
               checkpoints ? "; go on with: lockstep resume " + in_quotes(checkpoints.file()) : "");
  if (ended.interrupted) return kExitInterrupted;
  if (args.strict)
    if (const std::vector<std::string> all = doubts_of(end); !all.empty()) {
      for (const std::string& doubt : all) fmt::print(stderr, "lockstep: --strict: {}\n", doubt);
      return kExitDoubtful;
    }
  return is_wrong(found, sim.integrator().info()) ? kExitNotConserved : kExitOk;
}

}  // namespace

int run_command(const Arguments& args) { return run_scene(args, nullptr); }

int resume_command(const Arguments& args) {
  const RunCheckpoint from = RunCheckpoint::read(args.checkpoint);
  const std::string file = std::filesystem::absolute(args.checkpoint).string();
  std::error_code error;
  std::filesystem::current_path(from.folder, error);
  if (error)
    throw FileError(fmt::format("checkpoint '{}': the folder '{}', in which the run was begun, cannot be entered: {}",
                                file, from.folder, error.message()));
  Arguments begun = read_run_words(from.words);
  begun.record = from.csv, begun.checkpoint = file;
  return run_scene(begun, &from);
}

int assemble_command(const Arguments& args) {
  if (!args.branches.empty()) return branches_command(args);
  if (!args.wild.empty()) return wild_command(args);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State state = m.system.start();
  const AssemblyReport r = assemble(dynamics, state, m.start_speeds, m.assembly);
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
  // Farther than the distance asked for, or than what the report warns of.
  const double far = std::max(r.largest_move, m.system.length() * r.largest_turn);
  if (args.within.empty()) return r.warnings.empty() ? kExitOk : kExitDoubtful;
  const double within = positive_number("--within", args.within, Unit::length, "0.1m");
  if (far <= within) return kExitOk;
  fmt::print(
      stderr,
      "lockstep: --within: the assembled start is {:.3g} m from the one given (turns by the length of the mechanism), "
      "beyond {:g} m: moved '{}' by {:.3g} m, turned '{}' by {:.3g} rad\n",
      far, within, r.moved_most, r.largest_move, r.turned_most, r.largest_turn);
  return kExitDoubtful;
}

}  // namespace lockstep
