// SPDX-License-Identifier: BSD-3-Clause
// The commands run, report and resume.
#include <spdlog/fmt/fmt.h>

#include <exception>
#include <filesystem>

#include <lockstep/assembly.h>
#include <lockstep/log.h>
#include <lockstep/step_loop.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
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
#include "framework/tools/program/terminal.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/scene_run/requirements.h"
#include "framework/tools/scene_run/rows_at_jumps.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

/// A run that did not reach its end.
struct FailedRun {
  std::string status = "failed";
  double t;
  std::string error;
  long rows;
};
const Fields<FailedRun> kFailedFields{{"status", "", "status", &FailedRun::status},
                                      {"t", "s", "ended at t", &FailedRun::t},
                                      {"error", "", "", &FailedRun::error},
                                      {"rows", "", "rows", &FailedRun::rows}};

// The report of a run until it failed; the error itself matters more than one of this file.
void write_unfinished(const RunReport& report, const StepLoop& sim, const std::exception_ptr& error) {
  if (!report) return;
  try {
    const std::string why = fmt::format("the run ended at t = {:.9g} s: {}", sim.state().t, thrown_words(error));
    tell(fmt::format("note: unfinished report: {}\n", report.write(sim, "", why)));
  } catch (const std::exception& second) {
    tell(fmt::format("note: no report: {}\n", second.what()));
  }
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
           "the scene has no end time; add it, or give --until 5");
  refuse_impossible_formulation(m.run, loaded);
  record_places(m);
  return csv_path(args, m.system);
}

// Unknown velocities. Counting the degrees of freedom of more takes long: it is done only if nothing moved.
constexpr int kFewVelocities = 300;

// One run of a scene, with all its observers and all its results.
class ProgramRun {
 public:
  /// `from`: the checkpoint that it continues; null: it begins.
  ProgramRun(const Arguments& args, const RunCheckpoint* from, Certify certify = nullptr)
      : args_(args),
        from_(from),
        certify_(certify),
        loaded_(load_for(args, from)),
        m_(build_observed(loaded_.scene, loaded_.registry)),
        csv_(table_of(m_, loaded_, args)),
        recorder_(make_recorder(m_)),
        requirements_(make_requirements(m_)),
        outputs_(checked_outputs(loaded_, args, recorder_->table(), csv_)),
        file_(csv_),
        checkpoints_(args, loaded_, file_),
        events_(make_events(m_, *recorder_)),
        report_(args, loaded_, m_, *recorder_, csv_),
        rows_(file_, *recorder_, report_ || args.has("--certify"), outputs_.units),  // both read the rows afterwards
        details_(picture_rows(m_, csv_, *recorder_, outputs_, args)),
        at_jumps_([this](const Sample& s) { recorder_->output(s); }, *recorder_),
        singular_(system_of(m_)),
        audit_(system_of(m_), m_.run.limits),
        dynamics_(make_dynamics(m_, loaded_.registry)),
        sim_(dynamics_, make_integrator(m_.run, loaded_.registry), loop_options(m_.run)),
        doubts_(are_of_reactions(m_.run.record), sim_.integrator().info().adaptive ? m_.run.tolerance.relative : 0.0) {}

  Result go() {
    checkpoints_.refuse_unsaved(sim_.integrator());
    recorder_->find_extremes();
    State start = assembled_start();
    report_.mark(dynamics_, start);
    add_observers(start);
    begin(std::move(start));
    const std::exception_ptr error = run_on(), unwritten = thrown_by([&] { file_.write(); });  // which hides no other
    if (error) fail(error, unwritten);
    end_.audit = audit_.result();
    const bool quaternion = m_.run.formulation == Formulation::quaternion;
    end_.formulation = sim_.state().coordinates != nullptr ? "joint" : quaternion ? "quaternion" : "omega";
    end_.missed = missed_events(m_, sim_);
    end_.findings = run_findings(sim_, end_.audit, doubts_, singular_);
    for (Finding& f : broken_requirements(m_, requirements_.get())) end_.findings.push_back(std::move(f));
    for (Finding& f : share_findings(system_of(m_), m_, {&started_, &sim_.state()}))
      end_.findings.push_back(std::move(f));
    end_.near = decided(near_.all, m_.run.nearly_redundant);
    for (const MissedEvent& e : end_.missed) end_.findings.push_back(finding_of(e));
    for (Finding& f : suspects_of(end_, system_of(m_), singular_.n_passed())) end_.findings.push_back(std::move(f));
    CommandFindings::add(end_.findings);
    std::vector<std::string> files;
    try {
      files = conclude(unwritten);
    } catch (...) {  // the result is printed all the same
      print(result(), args_);
      throw;
    }
    Result out = result();
    out.files = files, out.code = exit_code();
    return out;
  }

 private:
  State assembled_start() {
    State start = decided_start(dynamics_, m_, &near_);
    if (from_ != nullptr) return start;
    if (m_.run.assemble) {
      const AssemblyReport assembled = assemble_told(start);
      if (assembled.is_notable()) end_.assembled = assembled.text(), end_.moved = assembled.is_moved();
    } else {
      begin_turns(dynamics_, start);
    }
    tell_near(start);
    refuse_locked(dynamics_, start);
    if (m_.system.n_velocities() <= kFewVelocities) refuse_driven_lock(dynamics_, start);
    refuse_short_laws(m_, dynamics_, start);
    if (args_.has("--quiet")) return start;
    if (are_of_reactions(m_.run.record))
      end_.not_unique = columns_not_unique(m_.run.record, uniqueness(dynamics_, start));
    if (!end_.not_unique.empty()) {
      const std::string names = first_of(end_.not_unique);
      CommandFindings::add({&finding::reactions_not_unique, names,
                            names + ": reactions are not unique, because constraints are redundant",
                            "lockstep check --verbose lists them"});
    }
    return start;
  }

  // If solvers differ, one may reject the start: near dependencies are reported then too.
  AssemblyReport assemble_told(State& start) {
    const State typed = start;
    try {
      return assemble_scene(dynamics_, m_, start, near_);
    } catch (const Error&) {
      tell_near(typed);
      throw;
    }
  }
  void tell_near(const State& start) {
    if (!near_.looked && !args_.has("--quiet")) near_ = {true, nearly_redundant_at(dynamics_, m_, start)};
    note_near(near_.all, m_.run.nearly_redundant);
  }

  Result result() const {
    Result out(loaded_, kRunFields, end_);
    out.brief = run_text(end_, args_.has("--summary") ? ColumnText::all : ColumnText::some, args_.has("--verbose"));
    return out;
  }

  bool judged() const { return !args_.has("--quiet") || args_.has("--strict"); }

  void add_observers(const State& start) {
    sim_.add_observer(*recorder_);
    if (m_.run.at_jumps) sim_.add_observer(at_jumps_);
    if (requirements_) sim_.add_observer(*requirements_);
    sim_.add_observer(rows_);
    if (judged()) sim_.add_observer(doubts_);
    if (judged() && SingularWatch::is_needed(dynamics_, start, sim_.integrator().info())) sim_.add_observer(singular_);
    if (details_) sim_.add_observer(*details_);
    sim_.add_observer(audit_);
    report_.watch(sim_);
    for (Event& event : events_) sim_.add_event(std::move(event));
  }

  void begin(State start) {
    if (from_ != nullptr) {
      rows_.go_on();
      sim_.load(from_->run);
      started_ = sim_.state();
      CommandFindings::add(sim_.report().findings);
      end_.resumed_at = sim_.state().t;
      return;
    }
    sim_.set_state(start);
    started_ = std::move(start);
    for (const Finding& f : settings_to_warn_of(loaded_.scene, m_, args_, sim_.integrator().info().adaptive))
      sim_.add_finding(f);
    if (!judged()) return;
    warn_of_branches(dynamics_, sim_);
    warn_of_no_freedom(m_, dynamics_, sim_, kFewVelocities);
  }

  // To the end, an error, which is returned, or an interruption.
  std::exception_ptr run_on() {
    Interrupt interrupt;
    Progress progress(m_.run.until, args_.has("--quiet"));
    const double before = from_ != nullptr ? from_->seconds : 0;
    if (checkpoints_)
      sim_.between_steps = [&] { checkpoints_.write_if_due(sim_, interrupt.asked(), before + progress.seconds()); };
    sim_.progress = [&](const State& s) {
      progress.at(s.t);
      return !interrupt.asked() || s.t >= m_.run.until;
    };
    const std::exception_ptr error = thrown_by([&] { sim_.run_until(m_.run.until); });
    progress.finish();
    end_.interrupted = interrupt.asked() && sim_.state().t < m_.run.until;
    end_.seconds = before + progress.seconds();
    return error;
  }

  [[noreturn]] void fail(const std::exception_ptr& error, const std::exception_ptr& unwritten) {
    const long n =
        from_ != nullptr || sim_.state().t > started_.t ? rows_.rows().n_rows() : 0;  // the start alone is not kept
    const std::string saved = unwritten ? "  saved: no rows: " + thrown_words(unwritten) + "\n"
                              : n == 0
                                  ? std::string()
                                  : fmt::format("  saved: {} row{} in {}\n", n, n == 1 ? "" : "s", file_.partial());
    std::error_code code;
    const std::exception_ptr explained = explain(error, saved);
    if (explained == error) tell(saved);
    write_unfinished(report_, sim_, explained);
    CommandFindings::add(doubts_.findings(sim_.report().steps, sim_.state().t));
    Result result(loaded_, kFailedFields, {.t = sim_.state().t, .error = thrown_words(explained), .rows = n});
    if (n == 0)
      std::filesystem::remove(file_.partial(), code);
    else
      result.files = {file_.partial()};
    result.printed = true, result.command = args_.command;
    print(result, args_);
    std::rethrow_exception(explained);
  }

  // The error with its cause in front, and what was saved.
  std::exception_ptr explain(const std::exception_ptr& error, const std::string& saved) {
    try {
      std::rethrow_exception(error);
    } catch (const Error& e) {
      return thrown_by([&] { rethrow_of_run(system_of(m_), sim_, started_, m_.run.step, e, saved); });
    } catch (...) {
      return error;
    }
  }

  // Files, pictures, report and verified digits of a run that reached its end; of one that was interrupted, its rows.
  std::vector<std::string> conclude(const std::exception_ptr& unwritten) {
    try {
      const State now = dynamics_.in_slots(sim_.state()), given = m_.system.start();
      const auto stays = [&](const Body& b) {
        if (b.fixed) return true;
        const Pose a = given.slot_pose(b.slot), z = now.slot_pose(b.slot);
        return (z.x - a.x).norm() <= kSlight * m_.system.length() &&
               rotation_vector(z.q * conjugate(a.q)).norm() <= kSlight;
      };
      if (judged() && m_.system.n_velocities() > kFewVelocities && std::ranges::all_of(m_.system.bodies(), stays))
        warn_of_no_freedom(m_, dynamics_, sim_, kManyVelocities);
    } catch (const std::exception&) {  // results are written even if this warning fails
    }
    if (unwritten) std::rethrow_exception(unwritten);
    const std::string lines = report_ ? run_text(end_, ColumnText::none, true) + text_of(end_.findings) : "";
    if (end_.interrupted) {  // it replaces nothing: its rows and its report have other names
      std::vector<std::string> files{file_.partial()};
      const std::string why = fmt::format("interrupted at t = {:.9g} s", sim_.state().t);
      if (report_) files.push_back(report_.write(sim_, lines, why));
      return files;
    }
    file_.commit();
    checkpoints_.remove();
    std::vector<std::string> files{csv_ == "-" ? "standard output" : csv_};
    if (!draw_run(args_, csv_, loaded_.title(), rows_.rows(), details_.get(), m_.run, outputs_, files, end_.notes) &&
        args_.has("--quiet"))
      tell(fmt::format("note: {}\n", end_.notes.front()));
    if (report_) {
      files.push_back(report_.write(sim_, lines));
      if (const std::string part = report_.left_out(); !part.empty())
        end_.notes.push_back(fmt::format("the report has {}, and all extremes (limit 20 MB)", part));
      if (args_.has("--open"))
        if (const std::string problem = open_in_browser(files.back()); !problem.empty())
          tell(fmt::format("note: {}\n", problem));
    }
    if (certify_ != nullptr) {
      const CertifiedRun certified = certify_(loaded_, args_, m_.run, recorder_->table());
      end_.certificate = certified.text, uncertified_ = certified.doubt;
    }
    return files;
  }

  int exit_code() {
    if (end_.interrupted) {
      tell(fmt::format(
          "note: interrupted at t = {:.9g} s; rows saved in {}{}\n", sim_.state().t, file_.partial(),
          checkpoints_ ? "; continue with: lockstep resume " + in_quotes(checkpoints_.file()) : std::string()));
      return kExitInterrupted;
    }
    const std::vector<Finding> all = CommandFindings::all();  // those of reading, too
    for (const Finding& f : all)
      if (args_.has("--strict") && f.severity() == Severity::doubt) tell_error("--strict: " + f.text());
    if (!uncertified_.empty()) tell_error("--certify: " + uncertified_);
    const Exit code = exit_code_of(all, args_.has("--strict"));
    return code == kExitOk && !uncertified_.empty() ? kExitDoubtful : code;
  }

  const Arguments& args_;
  const RunCheckpoint* from_;
  const Certify certify_;
  Loaded loaded_;
  Mechanism m_;
  const std::string csv_;
  const std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<Requirements> requirements_;  // null: none
  const RunOutputs outputs_;
  std::string uncertified_;  // columns without a digit verified by --certify
  GrowingFile file_;
  Checkpoints checkpoints_;
  std::vector<Event> events_;
  RunReport report_;
  RunRows rows_;
  const std::unique_ptr<PictureRows> details_;
  RowsAtJumps at_jumps_;
  SingularWatch singular_;
  EnergyAudit audit_;
  Dynamics dynamics_;
  StepLoop sim_;
  Doubts doubts_;
  NearRows near_;
  State started_;
  EndedRun end_{sim_, m_.run, rows_.rows(), *recorder_, singular_.passed(), frames_taken(loaded_.scene)};
};

Result resume_run(const Arguments& args) {
  const RunCheckpoint from = RunCheckpoint::read(args["checkpoint"]);
  const std::string file = std::filesystem::absolute(args["checkpoint"]).string();
  std::error_code error;
  std::filesystem::current_path(from.folder, error);
  if (error)
    throw FileError(fmt::format("checkpoint '{}': the folder '{}' of the run cannot be entered: {}", file, from.folder,
                                error.message()));
  Arguments begun = read_run_words(from.words);
  begun.set("--record", from.csv), begun.set("--checkpoint", file);
  Result result = ProgramRun(begun, &from).go();
  result.command = begun.command;
  print(result, begun);  // as the original command line asks
  return result.code;
}

Result report_run(const Arguments& args) {
  Arguments with_report = args;
  with_report.set("--report", args["--out"]);
  if (args["--out"].empty()) {
    std::filesystem::path csv = csv_path(args["--record"] == "-" ? "" : args["--record"], args["scene"]);
    with_report.set("--report", csv.replace_extension(".html").string());
  }
  return run_scene(with_report);
}

}  // namespace

Result run_scene(const Arguments& args) {
  if (args.has("--certify")) throw UsageError("--certify: give it as a separate word, after the command");
  return ProgramRun(args, nullptr).go();
}
Result run_and_certify(const Arguments& args, Certify certify) { return ProgramRun(args, nullptr, certify).go(); }

std::vector<const Schema*> run_results() { return {&kRunFields.schema(), &kFailedFields.schema()}; }

Command run_command() {
  return {"run", run_options(), run_scene,
          "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv",
          run_results()};
}
Command resume_command() {
  return {
      "resume",
      {Option{"checkpoint", "FILE", "file of `lockstep run --checkpoint`"}.needed()},
      resume_run,
      "The run continues with its original command line and folder. Its result is identical, bit by bit, to that of\n"
      "an uninterrupted run. Scene, plugins and version must be unchanged.\n\n"
      "Example:\n  lockstep run samples/scenes/four_bar.json --until 10000 --checkpoint four_bar.checkpoint --every "
      "10s\n  lockstep resume four_bar.checkpoint"};
}
Command report_command() {
  return {"report",
          join({settings_options(),
                {{"--out", "FILE.html", "the HTML file; default: next to the CSV file, with its name"},
                 {"--open", "", "show it in the browser (xdg-open)"}},
                run_outputs()}),
          report_run,
          "Also writes the results of `lockstep run`. The file needs no network and no other file.\n"
          "It has 20 MB at most, besides meshes: of a long run it keeps fewer times, and all extremes.\n\n"
          "Example:\n  lockstep report samples/scenes/four_bar.json --open",
          run_results()};
}

}  // namespace lockstep
