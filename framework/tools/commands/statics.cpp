// SPDX-License-Identifier: BSD-3-Clause
// The verb statics: where a scene rests under its loads.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include <lockstep/analysis.h>
#include <lockstep/equilibrium.h>
#include <lockstep/log.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/record/csv_lines.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

/// A scene at rest. It stays where it is in memory.
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
  /// Rows and multipliers at rest, without accelerations.
  Evaluated values() {
    const Evaluation& e = dynamics.gather(state);
    none_.setZero(6 * m.system.n_slots());
    return {e.inputs(), none_, report.lambda, e.rows()};
  }

 private:
  VecX none_;
};

std::string frequency_text(double stiffness) {
  const double omega = std::sqrt(std::abs(stiffness));
  return stiffness >= 0 ? fmt::format("{:.6g} rad/s ({:.6g} Hz)", omega, omega / (2 * std::numbers::pi))
                        : fmt::format("grows by a factor e in {:.3g} s", 1 / omega);
}

std::string stability_text(const Stability& s) {
  std::string text = fmt::format("  {:<12} ", to_string(s.kind));
  if (s.kind == Stability::Kind::not_judged) return text + "too many unknowns for dense matrices\n";
  text += s.freedoms == 0 ? "nothing is free to move"
                          : fmt::format("{} free motion{}", s.freedoms, s.freedoms == 1 ? "" : "s");
  if (s.softest > 0) text += ", the softest without damping at " + frequency_text(s.softest);
  if (!s.has_potential) text += "; the loads have no potential: damping may decide";
  text += "\n";
  for (const FreeMotion& m : s.unstable)
    text += fmt::format("  unstable     {}: {}\n", m.words, frequency_text(m.stiffness));
  for (const FreeMotion& m : s.neutral) text += fmt::format("  not held     {}\n", m.words);
  return text;
}

Json motions_json(const std::vector<FreeMotion>& motions) {
  Json all = Json::array();
  for (const FreeMotion& m : motions)
    all.push_back({{"motion", m.words}, {"stiffness", m.stiffness}, {"zero_below", m.bound}});
  return all;
}

Json grips_json(const std::vector<GripReport>& grips) {
  Json all = Json::array();
  for (const GripReport& g : grips)
    all.push_back({{"force", g.force}, {"what", g.what}, {"carries", g.carries}, {"most", g.most}, {"unit", g.unit}});
  return all;
}

Json report_json(Resting& r) {
  const EquilibriumReport& e = r.report;
  CommandFindings::add(e.notes);
  return {{"method", e.method()},
          {"by_friction", e.by_friction},
          {"relaxed", e.relaxed},
          {"iterations", e.iterations},
          {"relaxation_steps", e.relaxation_steps},
          {"unbalanced", e.unbalanced},
          {"largest_force", e.largest_force},
          {"largest_move", e.largest_move},
          {"stability", to_string(e.stability.kind)},
          {"freedoms", e.stability.freedoms},
          {"softest", e.stability.softest},
          {"unstable", motions_json(e.stability.unstable)},
          {"not_held", motions_json(e.stability.neutral)},
          {"friction", grips_json(e.grips)},
          {"left", e.left},
          {"pressed", e.pressed},
          {"free", e.free},
          {"notes", texts_of(e.notes)},
          {"bodies", pose_json(r.m.system, r.state)},
          {"reactions", reaction_json(r.m.system, r.values())}};
}

void print(const Loaded& loaded, Resting& r) {
  const EquilibriumReport& e = r.report;
  fmt::print("{}\n  equilibrium  {}", loaded.title(), e.method());
  if (!e.by_friction) fmt::print("; unbalanced {:.2g} of the largest force, {:.4g} N", e.unbalanced, e.largest_force);
  fmt::print("\n");
  fmt::print("{}", stability_text(e.stability));
  for (const GripReport& g : e.grips)
    if (e.by_friction)
      fmt::print("  friction     '{}' ({}) carries {:.6g} of {:.6g} {}\n", g.force, g.what, g.carries, g.most, g.unit);
  if (e.largest_move > 0) fmt::print("  moved        '{}' by {:.6g} m, most of all\n", e.moved_most, e.largest_move);
  for (const std::string& words : e.left) fmt::print("  left         a position that is unstable: {}\n", words);
  if (!e.pressed.empty()) fmt::print("  pressed      {}\n", text::join(e.pressed));
  if (!e.free.empty()) fmt::print("  free         {} (one-sided)\n", text::join(e.free));
  for (const Finding& note : e.notes) fmt::print("  note         {}\n", note.text());
  fmt::print("bodies:\n{}reactions at P, world axes:\n{}", pose_text(r.m.system, r.state),
             reaction_text(r.m.system, r.values()));
}

/// The table of one equilibrium a row: values of the variables, what was found, poses and reactions.
class Path {
 public:
  Path(const std::vector<Variable>& variables, const System& system) {
    for (const Variable& v : variables) table_.add_column(v.path, v.unit);
    table_.add_column("stable");  // 1; 0 neutral; -1 unstable
    table_.add_column("softest", "1/s^2");
    table_.add_column("unbalanced");
    for (const Column& c : pose_columns(system)) table_.add_column(c.name, c.unit);
  }
  const Table& add(const std::vector<double>& values, Resting& r) {
    std::vector<double> row = values;
    const Stability& s = r.report.stability;
    row.push_back(s.kind == Stability::Kind::stable || s.kind == Stability::Kind::gripped ? 1
                  : s.kind == Stability::Kind::neutral                                    ? 0
                  : s.kind == Stability::Kind::unstable                                   ? -1
                                                                                          : std::nan(""));
    row.push_back(s.softest), row.push_back(r.report.unbalanced);
    const std::vector<double> poses = pose_row(r.m.system, r.state, r.values());
    row.insert(row.end(), poses.begin(), poses.end());
    table_.add_row(row);
    return table_;
  }
  const Table& table() const { return table_; }

 private:
  Table table_;
};

std::vector<double> numbers_of(const std::vector<Variable>& variables, const std::vector<std::size_t>& choice) {
  std::vector<double> values;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const double* number = variables[k].values[choice[k]].number();
    if (number == nullptr)
      throw UsageError("--vary: \"" + variables[k].path + "\" takes words; statics draws its path over numbers");
    values.push_back(*number);
  }
  return values;
}

/// Where rows go: to a file that loses nothing, or to standard output.
class Rows {
 public:
  explicit Rows(const std::string& record) {
    if (!record.empty()) file_.emplace(record);
  }
  void write(const std::string& text) {
    if (!file_) {
      fmt::print("{}", text);
      return;
    }
    file_->append(text);
    file_->write();
  }
  void commit() {
    if (file_) file_->commit();
  }
  explicit operator bool() const { return file_.has_value(); }

 private:
  std::optional<GrowingFile> file_;
};

int vary(const Arguments& args, const Loaded& loaded) {
  std::vector<Variable> variables;
  try {
    variables = read_variables(args.all("--vary"), loaded.scene, loaded.registry);
  } catch (const ModelError& error) {
    throw UsageError(std::string("--vary: ") + error.what());
  }
  std::vector<std::size_t> sizes;
  for (const Variable& v : variables) sizes.push_back(v.values.size());
  const Grid grid(sizes);
  Rows rows(args["--record"]);
  std::optional<Path> path;
  std::unique_ptr<Resting> before;
  long failed = 0;
  for (long run = 1; run <= grid.n_runs(); ++run) {
    const std::vector<std::size_t> choice = grid.at(run);
    const std::vector<double> values = numbers_of(variables, choice);
    try {
      auto now =
          std::make_unique<Resting>(vary_scene(loaded.scene, variables, choice, loaded.registry), loaded.registry);
      now->find(args, before ? &before->state : nullptr, false);
      std::string text;
      if (!path) {
        path.emplace(variables, now->m.system);
        append_csv_header(text, path->table());
      }
      const Table& table = path->add(values, *now);
      append_csv_row(text, table, table.n_rows() - 1);
      rows.write(text);
      before = std::move(now);
    } catch (const Error& error) {
      ++failed;
      fmt::print(stderr, "lockstep: {}: {}\n", setting_text(variables, choice), error.what());
    }
  }
  rows.commit();
  if (rows && path)
    fmt::print("{}\n  equilibria {}, {} failed\n  files      {}\n", loaded.title(), path->table().n_rows(), failed,
               args["--record"]);
  return failed > 0 ? kExitFailure : kExitOk;
}

/// All equilibria that random starts lead to.
int find_all(const Arguments& args, const Loaded& loaded) {
  constexpr int kMostStarts = 1'000'000;
  const int starts = whole_number("--all", args["--all"], kMostStarts);
  Resting first(loaded.scene, loaded.registry);
  first.begin(args);
  EquilibriaReport found = find_equilibria(first.dynamics, first.state, {.starts = starts});
  Json all = Json::array();
  if (!args.has("--json"))
    fmt::print("{}\n  equilibria   {}, from {} starts, of which {} led nowhere\n", loaded.title(), found.all.size(),
               found.starts, found.failed);
  int number = 0;
  for (Equilibrium& e : found.all) {
    first.state = std::move(e.state), first.report = std::move(e.report);
    if (args.has("--json")) {
      all.push_back(report_json(first));
      all.back()["found"] = e.found;
      continue;
    }
    fmt::print("equilibrium {}, found {} time{}:\n{}{}", ++number, e.found, e.found == 1 ? "" : "s",
               stability_text(first.report.stability), pose_text(first.m.system, first.state));
  }
  if (args.has("--json")) print_result(Json({{"starts", found.starts}, {"failed", found.failed}, {"equilibria", all}}));
  return kExitOk;
}

}  // namespace

int statics_command(const Arguments& args) {
  const Loaded loaded = load(args);
  if (!args["--record"].empty()) check_overwrites(args["--record"], loaded.scene);
  if (args.has("--json") && !args.all("--vary").empty())
    throw UsageError("--json: with --vary the rows are CSV; leave one of the two out");
  if (!args["--all"].empty() && (!args.all("--vary").empty() || !args["--record"].empty()))
    throw UsageError("--all: it prints every equilibrium, and goes with neither --vary nor --record");
  if (!args["--all"].empty()) return find_all(args, loaded);
  if (!args.all("--vary").empty()) return vary(args, loaded);
  Resting resting(loaded.scene, loaded.registry);
  resting.find(args, nullptr, true);
  if (!args["--record"].empty()) {
    Rows rows(args["--record"]);
    Path path({}, resting.m.system);
    const Table& table = path.add({}, resting);
    std::string text;
    append_csv_header(text, table);
    append_csv_row(text, table, 0);
    rows.write(text);
    rows.commit();
  }
  if (args.has("--json"))
    print_result(report_json(resting));
  else
    print(loaded, resting);
  return kExitOk;
}

}  // namespace lockstep
