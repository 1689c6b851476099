// SPDX-License-Identifier: BSD-3-Clause
// The command statics: the equilibrium of a scene under its loads.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include <lockstep/analysis.h>
#include <lockstep/equilibrium.h>
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/record/csv_lines.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

/// A scene at rest. It must not be moved in memory.
struct Resting {
  Mechanism m;
  Dynamics dynamics;
  State state;
  EquilibriumReport report;

  Resting(const Scene& scene, const Registry& registry)
      : m(build_mechanism(scene, registry)), dynamics(make_dynamics(m, registry)), state(decided_start(dynamics, m)) {}

  /// Takes the assembled start, or the poses of `before`, if it has as many.
  void begin(const Arguments& args, const State* before = nullptr) {
    state.t = instant_of(args);
    if (before != nullptr && before->q.size() == state.q.size()) state.q = before->q, state.s = before->s;
    state.v.setZero();
    if (m.run.assemble || before != nullptr)
      assemble(dynamics, state, {}, before == nullptr ? m.assembly : AssemblyOptions());
    else
      begin_turns(dynamics, state);
  }
  /// From there. `friction`: whether it may hold the poses.
  void find(const Arguments& args, const State* before, bool friction) {
    begin(args, before);
    report = find_equilibrium(dynamics, state, {.friction = friction, .nearest = args.has("--nearest")});
  }
  /// Constraints and multipliers at rest, without accelerations.
  Evaluated values() {
    const Evaluation& e = dynamics.gather(state);
    none_.setZero(6 * m.system.n_slots());
    return {e.inputs(), none_, report.lambda, e.rows()};
  }

 private:
  VecX none_;
};

/// What is found of it.
struct AtRest {
  EquilibriumReport report;
  NamedPoses poses;
  std::vector<std::pair<std::string, NamedReaction>> reactions;
  int found = 1;  // by how many starts
};
AtRest found_of(Resting& r) {
  CommandFindings::add(r.report.notes);
  return {r.report, poses_of(r.m.system, r.state), reactions_of(r.m.system, r.values())};
}

// "8.1 rad/s (1.3 Hz)" of a stiffness.
std::string frequency_text(const Json& stiffness) {
  const double k = stiffness.is_null() ? 0 : stiffness.get<double>(), omega = std::sqrt(std::abs(k));
  if (k == 0) return "";
  return k > 0 ? fmt::format("{:.6g} rad/s ({:.6g} Hz) without damping", omega, omega / (2 * std::numbers::pi))
               : fmt::format("grows by a factor e in {:.3g} s", 1 / omega);
}

const Fields<EquilibriumReport>& report_fields() {
  using Report = EquilibriumReport;
  static const Fields<FreeMotion> kMotion{{"motion", "", "moves", &FreeMotion::words},
                                          {"stiffness", "1/s^2", "frequency", &FreeMotion::stiffness, frequency_text},
                                          {"zero_below", "1/s^2", "", &FreeMotion::bound}};
  static const Fields<GripReport> kGrip{{"force", "", "of", &GripReport::force},
                                        {"what", "", "motion", &GripReport::what},
                                        {"carries", "", "load", &GripReport::carries},
                                        {"most", "", "limit", &GripReport::most},
                                        {"unit", "", "unit", &GripReport::unit}};
  static const Fields<Stability> kStability{
      {"stability", "", "stability", [](const Stability& s) { return to_string(s.kind); }},
      {"freedoms", "", "degrees of freedom", &Stability::freedoms},
      {"softest", "1/s^2", "lowest stiffness", &Stability::softest, frequency_text},
      {"has_potential", "", "potential", &Stability::has_potential,
       [](const Json& v) { return v.get<bool>() ? std::string() : "none: damping may decide the stability"; }},
      {"unstable", "unstable motions", &Stability::unstable, kMotion},
      {"not_held", "neutral motions", &Stability::neutral, kMotion}};
  static const Fields<Report> kFields = Fields<Report>{
      {"method", "", "equilibrium", &Report::method},
      {"by_friction", "", "held by friction", &Report::by_friction},
      {"relaxed", "", "", &Report::relaxed},
      {"iterations", "", "", &Report::iterations},
      {"relaxation_steps", "", "", &Report::relaxation_steps},
      {"unbalanced", "", "relative unbalance", &Report::unbalanced},
      {"largest_force", "N", "largest force", &Report::largest_force},
      {"largest_move", "m", "largest move", &Report::largest_move},
      {"moved_most", "", "  of", &Report::moved_most},
      {"friction", "friction", &Report::grips, kGrip},
      {"left", "", "unstable poses left", &Report::left},
      {"pressed", "", "in contact", &Report::pressed},
      {"free", "", "free (one-sided)",
       &Report::free}}.with(&Report::stability, kStability);
  return kFields;
}

const Fields<AtRest>& rest_fields() {
  static const Fields<AtRest> kFields =
      Fields<AtRest>{}
          .with(&AtRest::report, report_fields())
          .with({{"found", "", "", &AtRest::found},
                 {"bodies", "bodies", &AtRest::poses, pose_fields()},
                 {"reactions", "reactions at P, world", &AtRest::reactions, reaction_fields()}});
  return kFields;
}

/// Of --all.
struct AllAtRest {
  int starts = 0, failed = 0;
  std::vector<AtRest> all;
};
const Fields<AllAtRest>& all_fields() {
  static const Fields<AllAtRest> kFields{{"starts", "", "starts", &AllAtRest::starts},
                                         {"failed", "", "  failed", &AllAtRest::failed},
                                         {"equilibria", "equilibrium", &AllAtRest::all, rest_fields()}};
  return kFields;
}

/// Of --vary.
struct Varied {
  std::size_t found = 0;
  long failed = 0;
};
const Fields<Varied>& varied_fields() {
  static const Fields<Varied> kFields{{"equilibria", "", "equilibria", &Varied::found},
                                      {"failed", "", "failed", &Varied::failed}};
  return kFields;
}

/// Adds an equilibrium to a table, whose columns come with the first: values of the variables, what was found, poses
/// and reactions.
void add_row(Table& table, const std::vector<Variable>& variables, std::vector<double> row, Resting& r) {
  const auto numbers = pose_numbers(r.m.system, r.state, r.values());
  const Stability& s = r.report.stability;
  row.push_back(s.kind == Stability::Kind::stable || s.kind == Stability::Kind::gripped ? 1
                : s.kind == Stability::Kind::neutral                                    ? 0
                : s.kind == Stability::Kind::unstable                                   ? -1
                                                                                        : std::nan(""));
  row.push_back(s.softest), row.push_back(r.report.unbalanced);
  const bool first = table.n_columns() == 0;
  if (first) {
    for (const Variable& v : variables) table.add_column(v.path, v.unit);
    table.add_column("stable");  // 1; 0 neutral; -1 unstable
    table.add_column("softest", "1/s^2");
    table.add_column("unbalanced");
  }
  for (const PoseNumber& n : numbers) {
    if (first) table.add_column(n.name, n.unit);
    row.push_back(n.value);
  }
  table.add_row(row);
}

std::vector<double> numbers_of(const std::vector<Variable>& variables, const std::vector<std::size_t>& choice) {
  std::vector<double> values;
  for (std::size_t k = 0; k < variables.size(); ++k) values.push_back(*variables[k].values[choice[k]].number());
  return values;
}

Result vary(const Arguments& args, const Loaded& loaded) {
  const std::vector<Variable> variables =
      as_usage("--vary", [&] { return read_variables(args.all("--vary"), loaded.scene, loaded.registry); });
  std::vector<std::size_t> sizes;
  for (const Variable& v : variables) {
    for (const auto& value : v.values)
      if (value.number() == nullptr)
        throw UsageError("--vary: \"" + v.path + "\" has no numbers; statics varies numbers only");
    sizes.push_back(v.values.size());
  }
  const Grid grid(sizes);
  const std::string& record = args["--record"];
  GrowingFile file(record.empty() ? "-" : record);
  Table table;
  GrowingCsv rows(file, table);
  file.clear();  // rows of an interrupted run
  std::unique_ptr<Resting> before;
  long failed = 0;
  for (long run = 1; run <= grid.n_runs(); ++run) {
    const std::vector<std::size_t> choice = grid.at(run);
    try {
      auto now =
          std::make_unique<Resting>(vary_scene(loaded.scene, variables, choice, loaded.registry), loaded.registry);
      now->find(args, before ? &before->state : nullptr, false);
      add_row(table, variables, numbers_of(variables, choice), *now);
      before = std::move(now);
    } catch (const Error& error) {
      ++failed;
      fmt::print(stderr, "lockstep: {}: {}\n", setting_text(variables, choice), error.what());
      continue;
    }
    if (table.n_rows() == 1) rows.begin();
    rows.take(), file.write();
  }
  if (before) file.commit();
  Result result;
  if (!record.empty() && before) {
    result = {loaded, varied_fields(), {table.n_rows(), failed}};
    result.files = {record};
  }
  result.code = failed > 0 ? kExitFailure : kExitOk;
  return result;
}

/// All equilibria that random starts lead to.
Result find_all(const Arguments& args, const Loaded& loaded) {
  const int starts = whole_number("--all", args["--all"], kMostStarts);
  Resting first(loaded.scene, loaded.registry);
  first.begin(args);
  EquilibriaReport report = find_equilibria(first.dynamics, first.state, {.starts = starts});
  AllAtRest found{report.starts, report.failed, {}};
  for (Equilibrium& e : report.all) {
    first.state = std::move(e.state), first.report = std::move(e.report);
    found.all.push_back(found_of(first));
    found.all.back().found = e.found;
  }
  return {loaded, all_fields(), found};
}

Result find_rest(const Arguments& args) {
  const Loaded loaded = load(args);
  const std::string& record = args["--record"];
  if (!record.empty()) check_overwrites(record, loaded.scene);
  if (args.has("--json") && !args.all("--vary").empty())
    throw UsageError("--json: with --vary the result is CSV; leave out one of the two");
  if (!args["--all"].empty() && (!args.all("--vary").empty() || !record.empty()))
    throw UsageError("--all prints every equilibrium; leave out --vary and --record");
  if (!args["--all"].empty()) return find_all(args, loaded);
  if (!args.all("--vary").empty()) return vary(args, loaded);
  Resting resting(loaded.scene, loaded.registry);
  resting.find(args, nullptr, true);
  Result result(loaded, rest_fields(), found_of(resting));
  if (record.empty()) return result;
  Table table;
  add_row(table, {}, {}, resting);
  std::string text;
  append_csv_header(text, table);
  append_csv_row(text, table, 0);
  result.write(record, text);
  return result;
}

}  // namespace

Command statics_command() {
  return {
      "statics",
      join({scene_options(),
            {kJson,
             {"--at", "T", "time of laws and drives, s; default 0"},
             {"--nearest", "", "accept the first equilibrium found, stable or not"},
             Option{"--all", "N", "find all equilibria, unstable ones too, from N random starts"}.without("--nearest"),
             Option{"--vary", "NAME=...",
                    "NAME=a:b:n or NAME=v1,v2,...: follow the equilibrium over a parameter, one CSV row each"}
                 .repeated(),
             {"--record", "FILE.csv", "write poses and reactions as CSV"}}}),
      find_rest,
      "Newton's method reduces the potential energy; if it fails, dynamic relaxation follows. Velocities are zero, "
      "drives hold their coordinates.\n\n"
      "Example:\n  lockstep statics samples/scenes/double_pendulum.json",
      {&rest_fields().schema(), &all_fields().schema(), &varied_fields().schema()}};
}

}  // namespace lockstep
