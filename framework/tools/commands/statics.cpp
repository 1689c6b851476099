// SPDX-License-Identifier: BSD-3-Clause
// The command statics: the equilibrium of a scene under its loads.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <lockstep/analysis.h>
#include <lockstep/equilibrium.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/analysis/wild_starts.h"
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/pictures.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/scene_run/requirements.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

/// The lengths and angles that a scene records, the columns that it computes, and what forces show. Functions of the motion
/// are reported.
std::vector<Channel> recorded_at_rest(Mechanism& m) {
  std::vector<Channel> all;
  for (const ChannelRequest& request : m.run.record) {
    Channel c = make_channel(system_of(m), request.channel);
    c.name = request.column();
    if (c.of_motion)
      report_finding({&finding::analysis_note, "",
                      fmt::format("column \"{}\" has no value at rest: it is a function of the motion", c.name)});
    else if (request.channel.starts_with('=') || c.unit == "rad" || c.unit == "m")
      all.push_back(std::move(c));
  }
  for (Channel& c : load_channels(system_of(m)))
    if (std::ranges::find(all, c.name, &Channel::name) == all.end()) all.push_back(std::move(c));
  return all;
}

/// A scene at rest. It must not be moved in memory.
struct Resting {
  Mechanism m;
  std::unique_ptr<Requirements> requirements;
  std::vector<Channel> recorded, poses;
  Dynamics dynamics;
  NearRows near{};
  State state;
  EquilibriumReport report{};
  Dynamics at_rest = dynamics_at_rest(system_of(m), report.lambda);

  Resting(const Scene& scene, const Registry& registry)
      : m(build_observed(scene, registry)),
        requirements(make_requirements(m)),
        recorded(recorded_at_rest(m)),
        poses(pose_channels(system_of(m))),
        dynamics(make_dynamics(m, registry)),
        state(decided_start(dynamics, m, &near)) {
    m.start_speeds.clear();
  }

  /// Takes the assembled start, or the poses of `before`, if it has as many.
  void begin(const Arguments& args, const State* before = nullptr) {
    state.t = instant_of(args);
    if (before != nullptr) m.assembly = {}, near = {};
    if (before != nullptr && before->q.size() == state.q.size()) state.q = before->q, state.s = before->s;
    state.v.setZero();
    if (before == nullptr && !m.run.assemble) return begin_turns(dynamics, state);
    assemble_scene(dynamics, m, state, near);
  }
  /// From there. `friction`: whether it may hold the poses.
  void find(const Arguments& args, const State* before, bool friction) {
    begin(args, before);
    report = find_equilibrium(dynamics, state, {.friction = friction, .nearest = args.has("--nearest")});
  }
  std::vector<PoseNumber> values(const std::vector<Channel>& channels) {
    std::vector<PoseNumber> all;
    const StepReport none{};
    const Sample sample(at_rest, state, none);
    for (const Channel& c : channels) {
      if (c.memory) c.memory->start(sample);
      all.push_back({c.name, c.unit, without_rounding(c.value(sample), c.unit)});
    }
    return all;
  }
  /// Requirements that do not hold there.
  std::vector<Finding> broken() {
    const StepReport none{};
    if (requirements) requirements->start(Sample(at_rest, state, none));
    return broken_requirements(m, requirements.get(), true);
  }
  double without_rounding(double x, std::string_view unit) const {
    const double force = kNegligible * report.largest_force, length = m.system.length();
    const double least = unit == "N"     ? force
                         : unit == "N m" ? force * length
                         : unit == "m"   ? kRoundOff * length
                                         : kRoundOff;
    return std::abs(x) <= least ? 0 : x;  // of other units: quaternions, angles
  }
};

/// What is found of it.
struct AtRest {
  EquilibriumReport report;
  NamedPoses poses;
  std::vector<std::pair<std::string, NamedReaction>> reactions;
  std::vector<PoseNumber> quantities;
  int number = 0, found = 0;  // of --all: its own; of starts that lead here
  std::vector<Finding> broken{};
};

/// `tells`: whether its notes are findings of the command.
AtRest found_of(Resting& r, bool tells = true) {
  const UniquenessReport unique = uniqueness(r.dynamics, r.state);
  AtRest found{r.report, named_poses(r.m.system, r.state), reactions_at_rest(r.dynamics, r.state, r.report, unique),
               r.values(r.recorded)};
  found.broken = r.broken();
  if (!tells) return found;
  CommandFindings::add(r.report.notes);
  note_near(r.near.all, r.m.run.nearly_redundant);
  note_not_unique(unique);
  return found;
}

/// Of --all and --vary.
void note_friction(const System& system) {
  if (std::ranges::any_of(system.forces(), [](const auto& force) { return force->reacting() != nullptr; }))
    CommandFindings::add({&finding::analysis_note, "",
                          "static friction is not considered: with it, positions near these are at rest too"});
}

std::string frequency_text(const Json& stiffness) {
  const double omega = stiffness.is_number() ? std::sqrt(std::max(stiffness.get<double>(), 0.0)) : 0;
  return omega > 0 ? fmt::format("{:.4g} Hz ({:.4g} rad/s), without damping", omega / kTwoPi, omega) : "";
}

std::string stability_word(const Stability& s) { return s.freedoms == 0 ? "no free motion" : to_string(s.kind); }

double growth_time(double stiffness) { return stiffness < 0 ? 1 / std::sqrt(-stiffness) : NAN; }
std::string growth_text(const Json& time) {
  return time.is_number() ? fmt::format("time constant {:.3g} s", time.get<double>()) : "";
}

const Fields<FreeMotion> kNeutralFields{{"motion", "", "moves", &FreeMotion::words},
                                        {"stiffness", "1/s^2", "", &FreeMotion::stiffness},
                                        {"zero_below", "1/s^2", "", &FreeMotion::bound}};
const Fields<FreeMotion> kUnstableFields = kNeutralFields.with(
    {{"growth_time", "s", "grows", [](const FreeMotion& m) { return growth_time(m.stiffness); }, growth_text}});
const Fields<GripReport> kGripFields{{"force", "", "of", &GripReport::force},
                                     {"what", "", "against", &GripReport::what},
                                     {"carries", "", "load", &GripReport::carries},
                                     {"most", "", "limit", &GripReport::most},
                                     {"unit", "", "unit", &GripReport::unit}};
const Fields<Stability> kStabilityFields{
    {"stability", "", "stability", stability_word},
    {"freedoms", "", "remaining degrees of freedom", &Stability::freedoms},
    {"lowest_eigenvalue", "1/s^2", "lowest natural frequency", &Stability::softest, frequency_text},
    {"growth_time", "s", "fastest growth", [](const Stability& s) { return growth_time(s.softest); }, growth_text},
    {"has_potential", "", "potential", &Stability::has_potential,
     [](const Json& v) { return v.get<bool>() ? std::string() : "none: damping may decide the stability"; }},
    {"unstable", "unstable motions", &Stability::unstable, kUnstableFields},
    {"not_held", "neutral motions", &Stability::neutral, kNeutralFields}};
const Fields<EquilibriumReport> kRestReportFields{
    {"method", "", "found by", &EquilibriumReport::method},
    {"by_friction", "", "held by friction", &EquilibriumReport::by_friction},
    {"relaxed", "", "", &EquilibriumReport::relaxed},
    {"singular", "", "near a singular configuration", &EquilibriumReport::singular},
    {"iterations", "", "", &EquilibriumReport::iterations},
    {"relaxation_steps", "", "", &EquilibriumReport::relaxation_steps},
    {"unbalanced", "", "unbalanced force, relative", &EquilibriumReport::unbalanced,
     [](const Json& share) { return share < kRoundOff ? std::string("0") : number_text(share); }},
    {"largest_force", "N", "largest force on a body", &EquilibriumReport::largest_force},
    {"largest_move", "m", "largest move", &EquilibriumReport::largest_move},
    {"moved_most", "", "  of", &EquilibriumReport::moved_most},
    {"friction", "friction at the start", &EquilibriumReport::grips, kGripFields},
    {"left", "", "left an unstable pose along", &EquilibriumReport::left},
    {"pressed", "", "in contact", &EquilibriumReport::pressed},
    {"free", "", "free (one-sided)", &EquilibriumReport::free}};
const Fields<AtRest> kRestFields =
    Fields<AtRest>{}
        .with([](const AtRest& r) -> const Stability& { return r.report.stability; }, kStabilityFields)
        .with({{"energy", "J", "potential energy", [](const AtRest& r) { return r.report.energy; }},
               {"found", "", "starts that lead here", &AtRest::found, unless_zero},
               {"bodies", "bodies", &AtRest::poses, kPoseFields},
               {"quantities", "forces and recorded quantities", &AtRest::quantities, kNumberFields},
               {"reactions", "reactions at P, world", &AtRest::reactions, kReactionFields}})
        .with(&AtRest::report, kRestReportFields);

/// Of --all.
struct AllAtRest {
  int starts = 0, failed = 0, unassembled = 0;
  std::vector<AtRest> all;
};
Fields<AllAtRest> fields_of_all(const char* label, const Fields<AtRest>& each) {
  return {{"starts", "", "starts", &AllAtRest::starts,
           [](const Json& n) {
             return fmt::format("{} random ones, and the given one; there may be more equilibria", n.get<int>() - 1);
           }},
          {"failed", "", "", &AllAtRest::failed},
          {"failures", "", "  failed",
           [](const AllAtRest& a) {
             std::vector<std::string> all;
             if (a.unassembled > 0) all.push_back(fmt::format("{} not assembled", a.unassembled));
             if (a.failed > a.unassembled) all.push_back(fmt::format("{} not converged", a.failed - a.unassembled));
             return all.empty() ? "0" : text::join(all, ", ");
           }},
          {"equilibria", label, &AllAtRest::all, each, kWhole}};
}
const Fields<AllAtRest> kAllRestFields = fields_of_all("equilibrium", kRestFields);
/// One line for each equilibrium, with the first quantities that differ between them; where these are equal for two, with
/// the coordinate of a body that differs most.
std::string overview_of(const AllAtRest& found) {
  constexpr std::size_t kMost = 4;
  const std::vector<AtRest>& all = found.all;
  std::vector<std::vector<std::string>> shown(all.size());
  for (std::size_t k = 0, n = 0; k < all.front().quantities.size() && n < kMost; ++k) {
    double largest = 0;  // round-off of the column is 0
    for (const AtRest& r : all) largest = std::max(largest, std::abs(r.quantities[k].value));
    std::vector<std::string> words;
    for (const AtRest& r : all) {
      const PoseNumber& q = r.quantities[k];
      words.push_back(
          fmt::format("{} {:.4g} {}", q.name, std::abs(q.value) <= kNegligible * largest ? 0 : q.value, q.unit));
    }
    if (all.size() > 1 && std::ranges::count(words, words.front()) == std::ssize(words)) continue;
    for (std::size_t i = 0; i < all.size(); ++i) shown[i].push_back(words[i]);
    ++n;
  }
  auto words = shown;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (shown[i] != shown[j]) continue;
      double most = 0;
      std::string word;
      for (std::size_t b = 0; b < all[i].poses.size(); ++b)
        for (int k = 0; k < 3; ++k) {
          const auto& [name, pose] = all[i].poses[b];
          const double apart = std::abs(pose.x[k] - all[j].poses[b].second.x[k]);
          if (apart > most) most = apart, word = fmt::format("{}.{} {:.4g} m", name, "xyz"[k], pose.x[k]);
        }
      if (most > 0 && std::ranges::find(words[i], word) == words[i].end()) words[i].push_back(word);
    }
  const Fields<AtRest> line{
      {"number", "", "nr", &AtRest::number},
      {"stability", "", "stability", [](const AtRest& r) { return stability_word(r.report.stability); }},
      {"frequency", "Hz", "lowest frequency [Hz]",
       [](const AtRest& r) { return std::sqrt(r.report.stability.softest) / kTwoPi; }, unless_zero},
      {"growth_time", "s", "growth time constant",
       [](const AtRest& r) { return growth_time(r.report.stability.softest); }},
      {"energy", "J", "potential energy", [](const AtRest& r) { return r.report.energy; }},
      {"found", "", "starts", &AtRest::found},
      {"quantities", "", "quantities", [&](const AtRest& r) { return text::join(words[r.number - 1], ", "); }},
      {"note", "", "note", [](const AtRest& r) { return r.report.singular ? "near a singular configuration" : ""; }}};
  const Fields<AllAtRest> fields = fields_of_all("equilibria", line);
  return text_of(fields.schema(), fields(found));
}

/// Of --vary.
struct Varied {
  std::size_t found = 0;
  long failed = 0, broken = 0;
};
const Fields<Varied> kVariedFields{{"equilibria", "", "equilibria", &Varied::found},
                                   {"failed", "", "failed", &Varied::failed},
                                   {"broken", "", "with broken requirements", &Varied::broken, unless_zero}};

/// An equilibrium as numbers: what was found, poses and reactions (not if `brief`), what is recorded.
std::vector<PoseNumber> numbers_of(Resting& r, bool brief = false) {
  const Stability& s = r.report.stability;
  const double stable = s.kind == Stability::Kind::stable || s.kind == Stability::Kind::gripped ? 1
                        : s.kind == Stability::Kind::neutral                                    ? 0
                        : s.kind == Stability::Kind::unstable                                   ? -1
                                                                                                : NAN;
  std::vector<PoseNumber> all{
      {"stable", "", stable}, {"lowest_eigenvalue", "1/s^2", s.softest}, {"move", "m", r.report.largest_move}};
  if (!brief) all.push_back({"unbalanced", "", r.report.unbalanced});
  if (!brief || r.recorded.empty())
    for (PoseNumber& n : r.values(r.poses)) all.push_back(std::move(n));
  for (PoseNumber& n : r.values(r.recorded))
    if (std::ranges::find(all, n.name, &PoseNumber::name) == all.end()) all.push_back(std::move(n));
  return all;
}

using Cells = std::vector<std::string>;

/// More cells of a line: titles, or values.
void add_titles(Cells& line, const std::vector<PoseNumber>& numbers) {
  for (const PoseNumber& n : numbers) line.push_back(column_title({n.name, n.unit, {}}));
}
void add_values(Cells& line, const std::vector<PoseNumber>& numbers, bool brief = false) {
  for (const PoseNumber& n : numbers) line.push_back(brief ? fmt::format("{:.9g}", n.value) : text::number(n.value));
}

/// "another branch: ..." if the way back from an equilibrium does not lead to the one before, else "ok". `before` then
/// holds other poses.
std::string branch_status(const Arguments& args, Resting& before, const Resting& now) {
  const State was = before.state;
  if (now.state.q.size() != was.q.size() || !before.report.stability.neutral.empty() ||
      !now.report.stability.neutral.empty())
    return "ok";
  try {
    before.find(args, &now.state, false);
  } catch (const Error&) {
    return "ok";
  }
  if (apart(before.m.system, was, before.state) <= kSlight * before.m.system.length()) return "ok";
  return fmt::format("another branch: '{}' moved by {:.3g} m", now.report.moved_most, now.report.largest_move);
}

/// Draws columns over the value that varies, the first. Of run.draw remain those that have values at rest.
void draw_curves(const Arguments& args, const std::string& title, const Table& curves, RunSettings run,
                 std::vector<std::string>& files) {
  for (auto& panel : run.draw)
    std::erase_if(panel, [&](const std::string& name) {
      if (!curves.has(name)) tell(fmt::format("note: not drawn: \"{}\" is no column at rest\n", name));
      return !curves.has(name);
    });
  std::erase_if(run.draw, [](const auto& panel) { return panel.empty(); });
  RowEnvelope rows(curves);
  for (std::size_t i = 0; i < curves.n_rows(); ++i) rows.add(curves, i);
  draw_told(args, args["--record"], title, rows, nullptr, run, {}, files);
}

Result vary(const Arguments& args) {
  const VariedScene scenes = read_varied(args);
  const std::vector<Variable>& variables = scenes.variables;
  const std::string& record = args["--record"];
  if (!record.empty()) check_overwrites(record, scenes.loaded.scene);
  std::vector<Cells> lines(1);  // that wait for the first equilibrium, which completes their header
  for (const Variable& v : variables) {
    for (const auto& value : v.values)
      if (value.number() == nullptr)
        throw UsageError("--vary: \"" + v.path + "\" has no numbers; statics varies numbers only");
    lines[0].push_back(column_title({v.path, v.unit, {}}));
  }
  GrowingFile file(record.empty() ? "-" : record);
  file.clear();                     // rows of an interrupted run
  std::unique_ptr<Resting> before;  // on the same line of the grid
  Varied varied;
  std::size_t width = 0;  // of the header
  Table curves;           // over the value, if one varies
  RunSettings settings;
  for (long run = 1; run <= scenes.grid.n_runs(); ++run) {
    const std::vector<std::size_t> choice = scenes.grid.at(run);
    const std::string setting = setting_text(variables, choice);
    Cells& line = lines.emplace_back();
    for (std::size_t k = 0; k < choice.size(); ++k) line.push_back(plain_text(variables[k].values[choice[k]]));
    std::vector<double> point{*variables[0].values[choice[0]].number()};
    if (choice.back() == 0) before.reset();
    std::optional<FindingScope> unheard;
    if (run > 1) unheard.emplace();  // the first found the same
    try {
      auto now = std::make_unique<Resting>(scenes.scene(run), scenes.loaded.registry);
      now->find(args, before ? &before->state : nullptr, false);
      const std::vector<PoseNumber> numbers = numbers_of(*now, record.empty());
      if (width != 0 && line.size() + numbers.size() + 1 != width)
        throw ModelError("its columns are not those of the values before; vary values that keep bodies and joints");
      const std::vector<PoseNumber> drawn = now->values(now->recorded.empty() ? now->poses : now->recorded);
      std::string status = before ? branch_status(args, *before, *now) : "ok";
      const std::vector<Finding> broken = now->broken();
      for (const Finding& f : broken) status = (status == "ok" ? "" : status + "; ") + f.message;
      varied.broken += broken.empty() ? 0 : 1;
      if (width == 0) {
        found_of(*now), note_friction(now->m.system);
        add_titles(lines[0], numbers), lines[0].emplace_back("status"), width = lines[0].size();
        curves.add_column(variables[0].place, variables[0].unit), settings = now->m.run;
        for (const PoseNumber& n : drawn) curves.add_column(n.name, n.unit);
      }
      for (const PoseNumber& n : drawn) point.push_back(n.value);
      if (status != "ok") tell(fmt::format("warning: {}: {}\n", setting, status));
      add_values(line, numbers, record.empty()), line.push_back(status);
      ++varied.found, before = std::move(now);
    } catch (const Error& error) {
      ++varied.failed;
      tell_error(setting + ": " + error.what());
      line.push_back("failed: " + first_line(error.what()));
    }
    if (width == 0) continue;
    for (Cells& each : lines) each.insert(each.end() - 1, width - each.size(), "");
    point.resize(curves.n_columns(), NAN), curves.add_row(point);  // a gap, if nothing is found
    file.append(csv_of(lines)), file.write();
    lines.clear();
  }
  Result result;
  if (varied.found > 0) {
    file.commit();
    if (!record.empty()) result = {scenes.loaded, kVariedFields, varied}, result.files = {record};
    if (!record.empty() && variables.size() == 1)
      draw_curves(args, scenes.loaded.title(), curves, settings, result.files);
    if (record.empty()) tell(text_of(CommandFindings::added()));
  }
  result.code = varied.failed > 0 ? kExitFailure : varied.broken > 0 ? kExitNotConserved : kExitOk;
  return result;
}

/// All equilibria that random starts lead to.
Result find_all(const Arguments& args) {
  const int starts = whole_number("--all", args["--all"], kMostStarts);
  const Loaded loaded = load(args);
  Resting first(loaded.scene, loaded.registry);
  first.begin(args), note_friction(first.m.system);
  EquilibriaReport report = find_equilibria(first.dynamics, first.state, {.starts = starts});
  AllAtRest found{report.starts, report.failed, report.unassembled, {}};
  for (Equilibrium& e : report.all) {
    first.state = std::move(e.state), first.report = std::move(e.report);
    found.all.push_back(found_of(first, found.all.empty()));
    AtRest& each = found.all.back();
    each.number = static_cast<int>(found.all.size()), each.found = e.found;
    for (Finding& f : each.broken) f.message = fmt::format("equilibrium {}: {}", each.number, f.message);
    CommandFindings::add(each.broken);
  }
  Result result(loaded, kAllRestFields, found);
  result.code = exit_code_of(CommandFindings::added(), false);
  if (!args.has("--verbose")) result.brief = overview_of(found);
  return result;
}

Result find_rest(const Arguments& args) {
  const bool varies = !args.all("--vary").empty();
  const std::string& record = args["--record"];
  if (args.has("--json") && varies) throw UsageError("--json: with --vary the result is CSV; leave out one of the two");
  if (!args["--all"].empty() && (varies || !record.empty()))
    throw UsageError("--all prints every equilibrium; leave out --vary and --record");
  if (!args["--all"].empty()) return find_all(args);
  if (varies) return vary(args);
  const Loaded loaded = load(args);
  if (!record.empty()) check_overwrites(record, loaded.scene);
  Resting resting(loaded.scene, loaded.registry);
  resting.find(args, nullptr, true);
  const AtRest found = found_of(resting);
  CommandFindings::add(found.broken);
  Result result(loaded, kRestFields, found);
  result.code = exit_code_of(found.broken, false);
  if (record.empty()) return result;
  std::vector<Cells> lines(2);
  const std::vector<PoseNumber> numbers = numbers_of(resting);
  add_titles(lines[0], numbers), add_values(lines[1], numbers);
  result.write(record, csv_of(lines));
  return result;
}

}  // namespace

Command statics_command() {
  return {
      "statics",
      join(
          {scene_options(),
           {kJson,
            {"--at", "TIME", "time of laws and drives, s; default 0"},
            {"--nearest", "", "accept the first equilibrium found, stable or not"},
            Option{
                "--all", "N",
                "look for all equilibria, unstable ones too, from N random starts; 200 is a good value, but the list "
                "may be incomplete"}
                .without("--nearest"),
            Option{"--verbose,-v", "", "print all details of each equilibrium of --all"},
            Option{"--vary", "NAME=VALUES",
                   "follow the equilibrium over a:b:n, a:b:n:log or v1,v2,... of a parameter, one CSV row each; may be "
                   "repeated"}
                .repeated(),
            {"--record", "FILE.csv", "write poses, reactions, loads of forces and recorded quantities as CSV"},
            kNoPicture}}),
      find_rest,
      R"(Newton's method reduces the potential energy; if it fails, dynamic relaxation follows. Velocities are zero, drives
hold their coordinates.

Each value of --vary begins at the equilibrium of the value before. With several --vary each line of the grid
begins at the start of the scene. A row with the status `another branch` does not lead back to the row before.
Columns of the CSV: `stable` is 1, 0 if neutral, -1 if unstable. `lowest_eigenvalue` is the square of the lowest
natural angular frequency. `move` is the largest displacement of a body. --record adds poses, reactions, and
`unbalanced`, the remaining force relative to the largest. `stable` and --all do not consider friction.

Example:
  lockstep statics samples/scenes/double_pendulum.json)",
      {&kRestFields.schema(), &kAllRestFields.schema(), &kVariedFields.schema()}};
}

}  // namespace lockstep
