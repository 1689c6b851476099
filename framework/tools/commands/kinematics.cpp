// SPDX-License-Identifier: BSD-3-Clause
// The commands kinematics and inverse: a fully driven scene over time, without integration.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include <lockstep/assembly.h>
#include <lockstep/author/lock.h>
#include <lockstep/kinematics.h>
#include <lockstep/log.h>
#include "framework/dynamics/simulate/contacts.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/analysis/driven_scene.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/pictures.h"
#include "framework/tools/program/run_rows.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/scene_run/requirements.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

/// A column, and its largest value over the motion.
struct Peak {
  Column column;
  double value = 0, t = 0;
  bool resolved = true;
};
struct Motion {
  std::string assembled{};  // "" if assembly moved nothing
  std::size_t poses = 0;
  long solutions = 0;
  double seconds = 0;
  std::vector<Peak> peaks;
};
std::vector<Peak> peaks_of(const Recorder& recorder) {
  std::vector<Peak> all{{recorder.table().columns().front()}};
  for (const ColumnRange& r : recorder.ranges()) {
    const double most_size = std::abs(r.most), least_size = std::abs(r.least);
    const bool equal = std::abs(most_size - least_size) <= kNegligible * most_size;  // then the first
    const bool most = equal ? r.t_most <= r.t_least : most_size > least_size;
    all.push_back(
        {recorder.table().columns()[all.size()], most ? r.most : r.least, most ? r.t_most : r.t_least, r.resolved});
  }
  all.front().value = all.front().t = all.front().column.values.back();
  return all;
}

const Fields<Peak> kPeakFields{{"name", "", "column", [](const Peak& p) { return p.column.name; }},
                               {"unit", "", "unit", [](const Peak& p) { return p.column.unit; }},
                               {"peak", "", "peak", &Peak::value},
                               {"t", "s", "at t", &Peak::t},
                               {"resolved", "", "resolved between poses", &Peak::resolved, only_if_false},
                               {"values", "", "", [](const Peak& p) { return p.column.values; }}};
const Fields<Motion> kKinematicsFields{
    {"assembled", "", "assembled", &Motion::assembled},
    {"poses", "", "poses", &Motion::poses},
    {"solutions", "", "", &Motion::solutions},
    {"seconds", "s", "computed in", &Motion::seconds, [](const Json& s) { return time_text(s.get<double>()); }},
    {"columns", "columns", &Motion::peaks, kPeakFields}};

// Without the time, columns that are zero throughout, and reactions that the scene records by another name.
std::string text_of_motion(Motion motion, const Mechanism& m) {
  std::map<std::string, double> largest;  // by units
  for (const Peak& p : motion.peaks)
    if (p.resolved) largest[p.column.unit] = std::max(largest[p.column.unit], std::abs(p.value));
  largest["N m"] = std::max(largest["N m"], m.system.length() * largest["N"]);
  std::erase_if(motion.peaks, [&](const Peak& p) {
    const auto is_of = [&](const ChannelRequest& r) { return r.channel == p.column.name && r.column() != r.channel; };
    return p.column.name == "t" || std::ranges::any_of(m.run.record, is_of) ||
           number_text(p.value, largest[p.column.unit]) == "0";
  });
  return text_of(kKinematicsFields.schema(), kKinematicsFields(motion));
}

/// One-sided joints that a motion passes.
class PassedStops {
 public:
  explicit PassedStops(const Mechanism& m) { stops_.lay_out(m.system, m.run.stabilization); }
  void look(Dynamics& dynamics, const State& state) {
    for (std::size_t i = 0; i < stops_.size(); ++i) {
      if (stops_.in_force(i, state) || !stops_.watched(i, state) || passed_.contains(i)) continue;
      if (stops_.gap(i, dynamics.inputs(state)).c < -stops_[i].margin) passed_.emplace(i, state.t);
    }
  }
  void tell() const {
    for (const auto& [i, t] : passed_) {
      const std::string& name = stops_[i].link->name();
      CommandFindings::add(
          {&finding::stop_passed, "joint '" + name + "'",
           fmt::format("'{}' is passed before t = {:.6g} s, as a prescribed motion does not stop there", name, t),
           "end the motion before it, or move the stop", NAN, NAN, "", t});
    }
  }

 private:
  Contacts stops_;
  std::map<std::size_t, double> passed_;  // when, s
};

Result follow_scene(const Arguments& args, bool inverse) {
  if (args.has("--quiet")) set_logger(nullptr);
  Loaded loaded = load(args);
  const std::vector<std::string> without = inverse ? std::vector<std::string>{} : fill_masses(loaded.scene);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  if (m.run.until <= 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene has no end time, or 0; add it, or give --until 5");
  const std::vector<double> times = pose_times(m.run);
  if (m.run.times.empty() && m.run.output > m.run.until)
    tell(fmt::format(
        "warning: the interval of the poses, {:.6g} s, is longer than the motion of {:.6g} s; only start and "
        "end are computed\n",
        m.run.output, m.run.until));
  record_driven(m, without, inverse);
  const std::string csv = csv_path(args, m.system);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  const RunOutputs outputs = checked_outputs(loaded, args, recorder->table(), csv);
  const std::unique_ptr<PictureRows> details = picture_rows(m, csv, *recorder, outputs, args);
  GrowingFile file(csv);
  recorder->find_extremes();
  const std::unique_ptr<Requirements> requirements = make_requirements(m);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  for (const EventRequest& e : m.events)
    tell(fmt::format("warning: event '{}' has no effect without a simulation\n", e.event.name));
  m.events.clear();
  NearRows near;
  State start = decided_start(dynamics, m, &near);
  note_near(near.all, m.run.nearly_redundant);
  const AssemblyReport assembled = assemble_scene(dynamics, m, start, near);
  refuse_driven_lock(dynamics, start);
  if (inverse) CommandFindings::add(share_findings(system_of(m), m, {&start}));

  const auto begun = std::chrono::steady_clock::now();
  DrivenMotion motion(dynamics, std::move(start));
  RunRows rows(file, *recorder, true, outputs.units);
  Doubts doubts(!args.has("--quiet") && are_of_reactions(m.run.record), 0);
  PassedStops stops(m);
  std::vector<Observer*> observers{requirements.get(), recorder.get(), details.get()};
  std::erase(observers, nullptr);
  const auto seen = [&](const Sample& sample) {
    if (recorder->table().n_rows() == 0) rows.start(sample), doubts.start(sample);
    recorder->output(sample), rows.output(sample), doubts.output(sample), stops.look(dynamics, sample.state);
  };
  follow(motion, dynamics, times, observers, seen, [&] {
    file.write();
    const std::size_t n = recorder->table().n_rows();
    return n == 0 ? "" : fmt::format("  saved: {} row{} in {}\n", n, n == 1 ? "" : "s", file.partial());
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  file.write();
  file.commit();
  stops.tell();
  CommandFindings::add(doubts.findings(motion.steps(), motion.state().t));
  const std::vector<Finding> broken = broken_requirements(m, requirements.get());
  CommandFindings::add(broken);
  Motion found{assembled.is_moved() ? assembled.text() : "", recorder->table().n_rows(), motion.steps(), seconds,
               peaks_of(*recorder)};
  Result result(loaded, kKinematicsFields, found);
  result.brief = text_of_motion(std::move(found), m);
  result.files = {csv};
  draw_told(args, csv, loaded.title(), rows.rows(), details.get(), m.run, outputs, result.files);
  result.code = exit_code_of(broken, false);
  return result;
}

Command driven_command(std::string_view name, Result (*run)(const Arguments&), std::string_view footer) {
  return {name,
          join({scene_options(),
                {kJson,
                 {"--until", "TIME", "end time, in s or with a unit (\"50 ms\"); default: that of the scene"},
                 {"--output", "TIME", "interval of the poses; default: that of the scene, or a hundredth of the time"},
                 {"--record", "FILE.csv", "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here"},
                 kPicture,
                 kNoPicture.without("--picture"),
                 {"--quiet", "", "print errors only"}}}),
          run,
          footer,
          {&kKinematicsFields.schema()}};
}

}  // namespace

Command kinematics_command() {
  return driven_command(
      "kinematics", [](const Arguments& args) { return follow_scene(args, false); },
      "Masses are needed only for columns of forces and energies. For too few or too many drives, the error names the "
      "coordinates to drive or the drives to release.\n\nExample:\n  lockstep kinematics samples/scenes/four_bar.json "
      "--until 0.2");
}
Command inverse_command() {
  return driven_command(
      "inverse", [](const Arguments& args) { return follow_scene(args, true); },
      "Columns: those of the scene, then all drives and reactions. Text omits zeros and repetitions.\n\n"
      "Example:\n  lockstep inverse samples/scenes/four_bar.json --until 0.2");
}

}  // namespace lockstep
