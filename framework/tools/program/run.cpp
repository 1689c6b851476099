// SPDX-License-Identifier: BSD-3-Clause
// The commands run, report and resume.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include <lockstep/assembly.h>
#include <lockstep/log.h>
#include <lockstep/step_loop.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/formulation_seen.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/pictures.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_checkpoint.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/run_rows.h"
#include "framework/tools/program/run_warnings.h"
#include "framework/tools/program/run_words.h"
#include "framework/tools/program/suspects.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/scene_run/rows_at_jumps.h"
#include "framework/tools/scene_run/run_findings.h"
#include "framework/tools/scene_run/scene_run.h"

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

// `seconds`: of computing so far, by the clock; those of this part are added.
Ended go(StepLoop& sim, double until, bool quiet, Checkpoints& checkpoints, double& seconds) {
  Ended ended;
  Interrupt interrupt;
  Progress progress(until, quiet);
  const double before = seconds;
  if (checkpoints)
    sim.between_steps = [&] { checkpoints.write_if_due(sim, interrupt.asked(), before + progress.seconds()); };
  sim.progress = [&](const State& s) {
    progress.at(s.t);
    return !interrupt.asked() || s.t >= until;
  };
  try {
    sim.run_until(until);
  } catch (...) {
    ended.error = std::current_exception();
  }
  progress.finish();
  ended.interrupted = interrupt.asked() && sim.state().t < until;
  seconds = before + progress.seconds();
  return ended;
}

// Without a report no energies are integrated, and drift alone is judged.
Audit drift_alone(const StepLoop& sim, const AuditLimits& limits) {
  Audit audit;
  audit.limits = limits.of(sim.system().length());
  audit.violation = sim.report().largest_violation;
  audit.drifted = !(audit.violation <= audit.limits.violation);
  if (audit.drifted)
    tell(fmt::format("lockstep: the run drifted off its constraints by {:.2g} m (limit {:.2g} m)\n", audit.violation,
                     audit.limits.violation));
  return audit;
}

/// A run that did not reach its end.
struct FailedRun {
  std::string status = "failed";
  double t;
  std::string error;
  long rows;
};
const Fields<FailedRun>& failed_fields() {
  static const Fields<FailedRun> kFields{{"status", "", "status", &FailedRun::status},
                                         {"t", "s", "ended at t", &FailedRun::t},
                                         {"error", "", "", &FailedRun::error},
                                         {"rows", "", "rows", &FailedRun::rows}};
  return kFields;
}

// What a run showed until it failed; the error itself matters more than one of this file.
void write_unfinished(const RunReport& report, const StepLoop& sim, const std::exception_ptr& error) {
  if (!report) return;
  try {
    const std::string why = fmt::format("the run ended at t = {:.9g} s: {}", sim.state().t, thrown_words(error));
    tell(fmt::format("lockstep: its report up to there is {}\n", report.write_unfinished(sim, "", why)));
  } catch (const std::exception& second) {
    tell(fmt::format("lockstep: no report: {}\n", second.what()));
  }
}

void show(const Arguments& args, const RunReport& report) {
  if (!args.has("--open")) return;
  const std::string problem = open_in_browser(report.file());
  if (!problem.empty()) tell(fmt::format("lockstep: {}\n", problem));
}

Loaded load_for(const Arguments& args, const RunCheckpoint* from) {
  if (args.has("--quiet")) set_logger(nullptr);
  Loaded loaded = load(args);
  if (from != nullptr) from->check(args["--checkpoint"], args, loaded);
  return loaded;
}

// The name of the table, of a mechanism that can be run.
std::string table_of(Mechanism& m, const Loaded& loaded, const Arguments& args) {
  if (m.run.until < 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene does not say how long it runs; add it, or give --until 5");
  refuse_impossible_formulation(m.run, loaded);
  record_places(m);
  return csv_path(args["--record"], args["scene"]);
}

// Unknown velocities. Counting the freedoms of many takes long: it is done where nothing moved, and the run is lost.
constexpr int kFewVelocities = 300, kManyVelocities = 3000;

// One run of a scene, with all that watches it and all that it leaves.
class ProgramRun {
 public:
  /// `from`: the checkpoint that it goes on from; null: it begins.
  ProgramRun(const Arguments& args, const RunCheckpoint* from, Certify certify = nullptr)
      : args_(args),
        from_(from),
        certify_(certify),
        loaded_(load_for(args, from)),
        m_(build_observed(loaded_.scene, loaded_.registry)),
        csv_(table_of(m_, loaded_, args)),
        recorder_(make_recorder(m_)),
        outputs_(checked_outputs(loaded_, args, recorder_->table(), csv_)),
        file_(csv_),
        checkpoints_(args, loaded_, file_),
        events_(make_events(m_, *recorder_)),
        report_(args, loaded_, m_, *recorder_, csv_),
        rows_(file_, *recorder_, report_ || args.has("--certify"), outputs_.units),  // both read the rows afterwards
        details_(picture_rows(m_, csv_, *recorder_, outputs_, args)),
        at_jumps_([this](const Sample& s) { recorder_->output(s); }, *recorder_),
        singular_(system_of(m_)),
        audit_(args.has("--quiet") ? nullptr : std::make_unique<EnergyAudit>(system_of(m_), m_.run.limits)),
        dynamics_(make_dynamics(m_, loaded_.registry)),
        sim_(dynamics_, make_integrator(m_.run, loaded_.registry), loop_options(m_.run)),
        doubts_(records_reactions(m_.run), sim_.integrator().info().adaptive ? m_.run.tolerance.relative : 0.0) {}

  Result go() {
    checkpoints_.refuse_unsaved(sim_.integrator());
    State start = assembled_start();
    report_.mark(dynamics_, start);
    add_observers(start);
    begin(std::move(start));
    double seconds = from_ != nullptr ? from_->seconds : 0;
    const Ended ended = lockstep::go(sim_, m_.run.until, args_.has("--quiet"), checkpoints_, seconds);
    const std::exception_ptr unwritten = write_rest(file_);
    if (ended.error) fail(ended.error, unwritten);
    const Audit found = audit_ ? audit_->result() : drift_alone(sim_, m_.run.limits);
    EndedRun end{sim_,
                 m_.run,
                 found,
                 seconds,
                 ended.interrupted,
                 singular_.passed(),
                 formulation_.name(sim_, m_.run.formulation),
                 missed_events(m_, sim_),
                 run_findings(sim_, found, doubts_, singular_),
                 &rows_.rows(),
                 frames_taken(loaded_.scene),
                 not_unique_,
                 decided(near_.all, m_.run.nearly_redundant),
                 assembled_,
                 resumed_at_,
                 summary_.ways()};
    for (const MissedEvent& e : end.missed) end.findings.push_back(finding_of(e));
    for (Finding& f : suspects_of(end, system_of(m_), singular_.n_passed())) end.findings.push_back(std::move(f));
    CommandFindings::add(end.findings);
    std::vector<std::string> files;
    try {
      files = conclude(end, unwritten);
    } catch (...) {  // what was computed is printed all the same
      print({loaded_, run_fields(), end}, args_);
      throw;
    }
    Result result(loaded_, run_fields(), end);
    result.files = files, result.code = exit_code(end);
    return result;
  }

 private:
  State assembled_start() {
    State start = decided_start(dynamics_, m_, &near_);
    if (from_ != nullptr) return start;
    if (m_.run.assemble) {
      const AssemblyReport assembled = assemble_told(start);
      if (assembled.is_notable()) assembled_ = assembled.text();
    } else {
      begin_turns(dynamics_, start);
    }
    tell_near(start);
    refuse_locked(dynamics_, start);
    if (args_.has("--quiet")) return start;
    not_unique_ = columns_not_unique(dynamics_, start, m_.run);
    if (!not_unique_.empty()) {
      const std::string names = first_of(not_unique_);
      CommandFindings::add({&finding::reactions_not_unique, names,
                            names + ": how redundant rows share these reactions is the solver's choice",
                            "lockstep check"});
    }
    return start;
  }

  // Where solvers differ one may refuse the start: what nearly depends is told then too.
  AssemblyReport assemble_told(State& start) {
    const State typed = start;
    try {
      return assemble(dynamics_, start, m_.start_speeds, m_.assembly);
    } catch (const Error&) {
      tell_near(typed);
      throw;
    }
  }
  void tell_near(const State& start) {
    if (!near_.looked && !args_.has("--quiet")) near_ = {true, nearly_redundant_at(dynamics_, m_, start)};
    for (const NearDependency& d : near_.all) CommandFindings::add(finding_of(d, m_.run.nearly_redundant));
  }

  bool judged() const { return !args_.has("--quiet") || args_.has("--strict"); }

  void add_observers(const State& start) {
    sim_.add_observer(*recorder_);
    if (m_.run.at_jumps) sim_.add_observer(at_jumps_);
    sim_.add_observer(rows_);
    sim_.add_observer(formulation_);
    if (judged()) sim_.add_observer(doubts_);
    if (judged() && SingularWatch::is_needed(dynamics_, start, sim_.integrator().info())) sim_.add_observer(singular_);
    if (details_) sim_.add_observer(*details_);
    if (audit_) sim_.add_observer(summary_), sim_.add_observer(*audit_);
    report_.watch(sim_);
    for (Event& event : events_) sim_.add_event(std::move(event));
  }

  void begin(State start) {
    if (from_ != nullptr) {
      rows_.go_on();
      sim_.load(from_->run);
      CommandFindings::add(sim_.report().findings);
      resumed_at_ = sim_.state().t;
      return;
    }
    sim_.set_state(std::move(start));
    warn_of_settings(loaded_.scene, m_, args_, sim_);
    if (!judged()) return;
    warn_of_branches(dynamics_, sim_);
    warn_of_no_freedom(m_, dynamics_, sim_, kFewVelocities);
  }

  [[noreturn]] void fail(const std::exception_ptr& error, const std::exception_ptr& unwritten) {
    const long n = rows_.rows().n_rows();
    const std::string written = unwritten ? "the rows up to there could not be written: " + thrown_words(unwritten)
                                          : fmt::format("{} row{} up to there {} in {}", n, n == 1 ? "" : "s",
                                                        n == 1 ? "is" : "are", file_.partial());
    tell(fmt::format("lockstep: the run ended at t = {:.9g} s; {}\n", sim_.state().t, written));
    write_unfinished(report_, sim_, error);
    CommandFindings::add(doubts_.findings(sim_.report().steps, sim_.state().t));
    Result result(loaded_, failed_fields(), {.t = sim_.state().t, .error = thrown_words(error), .rows = n});
    result.files = {file_.partial()}, result.printed = true, result.command = args_.command;
    print(result, args_);
    std::rethrow_exception(error);
  }

  // A run that was interrupted replaces nothing: its rows and its report stay beside the old ones, and pictures are not
  // drawn.
  std::vector<std::string> leave_unfinished(const std::string& lines) {
    std::vector<std::string> files{file_.partial()};
    if (report_)
      files.push_back(
          report_.write_unfinished(sim_, lines, fmt::format("interrupted at t = {:.9g} s", sim_.state().t)));
    return files;
  }

  // Files, pictures, report and certificate of a run that reached its end; what there is of one that was interrupted.
  std::vector<std::string> conclude(EndedRun& end, const std::exception_ptr& unwritten) {
    try {
      if (audit_ && m_.system.n_velocities() > kFewVelocities && summary_.nothing_moved())
        warn_of_no_freedom(m_, dynamics_, sim_, kManyVelocities);
    } catch (const std::exception&) {  // the rows of the run are worth more than this warning
    }
    if (unwritten) std::rethrow_exception(unwritten);
    const std::string lines =
        audit_ && report_ ? text_of(run_fields().schema(), run_fields()(end)) + text_of(end.findings) : "";
    if (end.interrupted) return leave_unfinished(lines);
    file_.commit();
    checkpoints_.remove();
    std::vector<std::string> files{csv_ == "-" ? "standard output" : csv_};
    if (!args_.has("--no-picture") && csv_ != "-" &&
        !draw_run(csv_, loaded_.title(), rows_.rows(), details_.get(), m_.run, outputs_, files, end.notes) &&
        args_.has("--quiet"))
      tell(fmt::format("lockstep: {}\n", end.notes.front()));
    if (report_) {
      report_.write(sim_, lines);
      files.push_back(report_.file());
      show(args_, report_);
    }
    if (certify_ != nullptr) {
      const CertifiedRun certified = certify_(loaded_, args_, m_.run, recorder_->table());
      end.certificate = certified.text, uncertified_ = certified.doubt;
    }
    return files;
  }

  int exit_code(const EndedRun& end) {
    if (end.interrupted) {
      tell(fmt::format(
          "lockstep: interrupted at t = {:.9g} s; the rows up to there are in {}{}\n", sim_.state().t, file_.partial(),
          checkpoints_ ? "; go on with: lockstep resume " + in_quotes(checkpoints_.file()) : std::string()));
      return kExitInterrupted;
    }
    if (args_.has("--strict"))
      for (const Finding& f : of_severity(end.findings, Severity::doubt))
        tell(fmt::format("lockstep: --strict: {}\n", f.text()));
    if (!uncertified_.empty()) tell(fmt::format("lockstep: --certify: {}\n", uncertified_));
    const Exit code = exit_code_of(end.findings, args_.has("--strict"));
    return code == kExitOk && !uncertified_.empty() ? kExitDoubtful : code;
  }

  const Arguments& args_;
  const RunCheckpoint* from_;
  const Certify certify_;
  Loaded loaded_;
  Mechanism m_;
  const std::string csv_;
  const std::unique_ptr<Recorder> recorder_;
  const RunOutputs outputs_;
  std::vector<std::string> not_unique_;  // columns of reactions
  std::string assembled_;
  double resumed_at_ = NAN;
  std::string uncertified_;              // what --certify found of which not one digit is certified
  GrowingFile file_;
  Checkpoints checkpoints_;
  std::vector<Event> events_;
  RunReport report_;
  RunRows rows_;
  const std::unique_ptr<PictureRows> details_;
  RowsAtJumps at_jumps_;
  SingularWatch singular_;
  FormulationSeen formulation_;
  Summary summary_;
  const std::unique_ptr<EnergyAudit> audit_;  // energies are integrated only if they are printed
  Dynamics dynamics_;
  StepLoop sim_;
  Doubts doubts_;
  NearRows near_;
};

}  // namespace

Result run_scene(const Arguments& args) {
  if (args.has("--certify")) throw UsageError("--certify: write it by itself, behind the verb");
  return ProgramRun(args, nullptr).go();
}
Result run_and_certify(const Arguments& args, Certify certify) { return ProgramRun(args, nullptr, certify).go(); }

namespace {

Result resume_run(const Arguments& args) {
  const RunCheckpoint from = RunCheckpoint::read(args["checkpoint"]);
  const std::string file = std::filesystem::absolute(args["checkpoint"]).string();
  std::error_code error;
  std::filesystem::current_path(from.folder, error);
  if (error)
    throw FileError(fmt::format("checkpoint '{}': the folder '{}', in which the run was begun, cannot be entered: {}",
                                file, from.folder, error.message()));
  Arguments begun = read_run_words(from.words);
  begun.set("--record", from.csv), begun.set("--checkpoint", file);
  Result result = ProgramRun(begun, &from).go();
  result.command = begun.command;
  print(result, begun);  // as the line asks that it goes on with
  return result.code;
}

Result report_run(const Arguments& args) {
  Arguments with_report = args;
  with_report.set("--report", args["--out"]);
  if (args["--out"].empty()) {
    const std::filesystem::path csv = csv_path(args["--record"] == "-" ? "" : args["--record"], args["scene"]);
    with_report.set("--report", std::filesystem::path(csv).replace_extension(".html").string());
  }
  return run_scene(with_report);
}

}  // namespace

std::vector<const Schema*> run_results() { return {&run_fields().schema(), &failed_fields().schema()}; }

Command run_command() {
  return {"run", run_options(), run_scene,
          "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv",
          run_results()};
}
Command resume_command() {
  return {
      "resume",
      {Option{"checkpoint", "FILE", "what `lockstep run --checkpoint` wrote"}.needed()},
      resume_run,
      "The run has the command line and the folder that it was begun with, and equals one that was not interrupted, "
      "to the\nlast bit. Scene, plugins and version must be the same.\n\n"
      "Example:\n  lockstep run samples/scenes/four_bar.json --until 10000 --checkpoint four_bar.checkpoint --every "
      "10s\n  lockstep resume four_bar.checkpoint"};
}
Command report_command() {
  return {"report",
          join({settings_options(),
                {{"--out", "FILE.html", "the HTML file; default: beside the CSV, with its name"},
                 {"--open", "", "show it in the browser (xdg-open)"}},
                run_outputs()}),
          report_run,
          "What `lockstep run` writes is written too. The file needs no network and no other file.\n\n"
          "Example:\n  lockstep report samples/scenes/four_bar.json --open",
          run_results()};
}

}  // namespace lockstep
