// SPDX-License-Identifier: BSD-3-Clause
// The command check: the size of a scene, and which parts of the computation it does not need.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/dynamics/simulate/along_laws.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/describe_scene.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/mobility_findings.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/run_warnings.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

using Names = std::vector<std::string>;

/// A node of the tree: the body that moves, the joint that carries it, and its coordinates.
struct Branch {
  std::string body, link, parent;        ///< link: empty if no joint carries the body
  std::vector<std::string> coordinates;  ///< "x", "rz": of P seen from S; of a free body in the world
  std::vector<std::string> rows;         ///< "e1": constraints that the joint's coordinates do not satisfy
};

/// The tree of a mechanism that runs in joint coordinates, and the joints that close loops. Empty if there is no tree.
struct TreeReport {
  std::vector<Branch> branches;       ///< parents before their children
  std::vector<std::string> closures;  ///< names of the active joints that close loops
  std::vector<std::string> left;      ///< "J.e1": constraints that joint coordinates do not satisfy
  int n_coordinates = 0;              ///< of all branches; three for the rotation of a spherical joint
  bool has_rows() const { return !closures.empty() || !left.empty(); }
};

// The coordinates that a lock leaves free and nothing drives; in a plane those in it, by the axes of S that lie in it
// or along its normal, else of the world.
std::vector<std::string> free_axes(const TreeNode& n, Plane plane) {
  std::vector<std::string> free;
  if (!plane) {
    for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz})
      if (!includes(n.rows, row_of(axis)) &&
          !(is_rotation(axis) && n.turn == TreeTurn::none))  // particles do not rotate
        free.emplace_back(to_string(axis));
    return free;
  }
  const Mat3 S = rotation(n.reversed ? n.far_q : n.near_q);
  const auto axis_of = [](const Mat3& axes, const Vec3& along) -> std::string {
    for (int k = 0; k < 3; ++k)
      if (are_parallel(axes.col(k), along)) return std::string(1, "xyz"[k]);
    return "";
  };
  for (int k = 0; k < n.n_slides; ++k) {
    const Vec3& along = n.slide(k);
    const std::string own = axis_of(S, along), world = axis_of(Mat3::Identity(), along);
    free.push_back(!own.empty() ? own : !world.empty() ? "world " + world : "normal to the constraints");
  }
  if (n.turn != TreeTurn::none) {
    const std::string own = axis_of(Mat3::Identity(), n.hinge);
    free.push_back(own.empty() ? "about the normal" : "r" + own);
  }
  return free;
}

TreeReport tree_of(const System& system, const std::vector<bool>& modes) {
  std::string why_not;
  const std::shared_ptr<const JointTree> tree = JointTree::of(system, modes, why_not);
  TreeReport report;
  if (!tree) return report;
  report.n_coordinates = tree->n_v();
  for (const TreeNode& n : tree->nodes()) {
    Branch b;
    b.body = system.body_of_slot(n.slot).name;
    if (n.link >= 0) b.parent = n.parent >= 0 ? report.branches[n.parent].body : "ground";
    const Lock* link = n.link >= 0 ? system.links()[n.link].get() : nullptr;
    if (link != nullptr) b.link = link->name();
    b.coordinates = free_axes(n, system.plane());
    for (int row = 0; link != nullptr && row < link->row_count(); ++row)
      if ((n.left >> row & 1U) != 0) {
        b.rows.push_back(link->row_name(row));
        report.left.push_back(b.link + "." + b.rows.back());
      }
    report.branches.push_back(std::move(b));
  }
  for (const int link : tree->closures()) report.closures.push_back(system.links()[link]->name());
  return report;
}

/// Whether the stages of an explicit method are projected onto the constraints, and why; "" of methods without that
/// choice. `rows`: whether the run has constraints.
std::string stages_of(const Mechanism& m, const State& start, const Registry& registry, bool rows) {
  const auto* type = registry.integrators.find(m.run.integrator.type);
  if (type == nullptr || type->origin != "built in" ||
      std::ranges::none_of(type->info.keys, [](const Key& key) { return key.name == "stages"; }))
    return "";
  const Value* given = m.run.integrator.keys.find("stages");
  const std::string asked = given != nullptr ? plain_text(*given) : "";
  if (asked == "plain") return "unprojected, as requested";
  if (!rows) return "unprojected: no constraints are left";
  if (asked == "manifold") return "projected in every step, as requested";
  if (!make_integrator(m.run, registry)->info().adaptive) return "unprojected: the steps are fixed";
  if (m.run.stabilization.kind != Stabilization::Kind::project) return "unprojected: the run has no projection";
  if (!has_loops(m.system, start.modes)) return "unprojected: without loops no configuration is singular";
  return "projected near singular configurations only";
}

struct OwnedChannel {
  ChannelHelp channel;
  std::string owner;
};

// Of the object of this name; "": of all but the markers that joints and forces make, "A.P".
std::vector<OwnedChannel> channels_of(const System& system, const std::string& of) {
  std::vector<OwnedChannel> all;
  Names owners;
  for (ChannelHelp& c : channel_help(system)) {
    if (of != "ground" && c.name.starts_with("ground.")) continue;  // it never moves
    const auto [kind, owner] = channels::owner_of(c.name, system);
    if (!owner.empty() && (owners.empty() || owners.back() != owner)) owners.push_back(owner);
    if (of.empty() ? kind != "marker" || owner.find('.') == std::string::npos : owner == of)
      all.push_back({std::move(c), owner.empty() ? "the whole mechanism" : fmt::format("{} '{}'", kind, owner)});
  }
  if (all.empty())
    throw UsageError("--of: no body, marker, joint or force is called \"" + of + "\"" + text::suggestion(of, owners));
  return all;
}

const Fields<OwnedChannel> kChannelFields{
    {"name", "", "name", [](const OwnedChannel& c) { return c.channel.name; }},
    {"unit", "", "unit", [](const OwnedChannel& c) { return c.channel.unit; }},
    {"of", "", "of", &OwnedChannel::owner, json_only},
    {"help", "", "what it is", [](const OwnedChannel& c) { return c.channel.help; }}};
const Fields<std::vector<OwnedChannel>> kChannelsFields{
    {"channels", "channels", std::identity(), kChannelFields, kWhole}};

/// The constraints that a tree leaves: of loop-closing joints, and of joints that do not hold all of theirs.
std::string rows_in_words(const TreeReport& tree) {
  if (!tree.has_rows()) return "no constraints";
  std::string words;
  if (!tree.closures.empty()) words = "the loop-closure constraints of " + first_of(tree.closures);
  if (!tree.left.empty()) words += (words.empty() ? "" : "; ") + ("single constraints " + first_of(tree.left));
  return words;
}

/// The scene in the plane with this normal, if only the declaration of a part is missing that it stays there.
std::optional<std::string> if_named(const char* normal, const Loaded& loaded, const Mechanism& m) try {
  Scene scene = loaded.scene;
  scene.root = scene.root.without({"planar"});
  scene.root.object()->push_back({"planar", Value(normal), scene.root.where});
  Mechanism named = build_mechanism(scene, loaded.registry);
  if (named.system.has_offsets()) return {};  // reactions would be incomplete
  system_of(named).set_planar(system_of(named).plane(), true);
  const std::optional<ModelError> missing = system_of(named).try_setup();
  if (!missing) return {};
  return fmt::format("\"planar\": \"{}\" gives {} unknown velocities instead of {}, if nothing leaves that plane: {}",
                     normal, named.system.n_velocities(), m.system.n_velocities(), missing->what());
} catch (const Error&) {  // not in this plane; an error of custom code is reported by the run
  return {};
}

/// What the scene could also leave out without an approximation.
std::vector<std::string> proposals(const Loaded& loaded, const Mechanism& m, bool needs_rows) {
  std::vector<std::string> all;
  const Value* planar = loaded.scene.root.find("planar");
  const bool finds_plane = planar == nullptr || (planar->text() != nullptr && *planar->text() == "auto");
  if (finds_plane && !m.system.plane() && needs_rows && m.run.formulation != Formulation::quaternion)
    for (const char* normal : {"z", "y", "x"})
      if (std::optional<std::string> words = if_named(normal, loaded, m)) {
        all.push_back(*std::move(words));
        break;
      }
  const bool has_welds = std::ranges::any_of(m.system.links(), [](const auto& link) { return link->is_weld(); });
  if (loaded.scene.root.find("merge") != nullptr || !has_welds) return all;
  Scene scene = loaded.scene;
  scene.root.object()->push_back({"merge", Value("auto"), scene.root.where});
  try {
    const Mechanism merged = build_mechanism(scene, loaded.registry);
    const long n = std::count_if(merged.system.links().begin(), merged.system.links().end(),
                                 [&](const auto& l) { return merged.system.merged(*l); });
    if (n > 0)
      all.push_back(
          fmt::format("\"merge\": \"auto\" would move the bodies of {} fixed joint{} as one", n, n > 1 ? "s" : ""));
  } catch (const Error&) {  // nothing to propose
  }
  return all;
}

std::string value_text(const Value& v) { return v.list() == nullptr ? plain_text(v) : write_json_line(v); }

/// Adds "torque.csv: 101 points; time 0 to 0.5 s; torque -1.4 to 2.21 N m" for each table of a law, in its own units.
void add_tables(const Value& v, Names& lines) {
  if (v.list() != nullptr)
    for (const Value& each : *v.list()) add_tables(each, lines);
  if (v.object() == nullptr) return;
  for (const Value::Member& m : *v.object()) add_tables(m.value, lines);
  const Value* file = v.find("file");
  if (file == nullptr || file->text() == nullptr || !file->text()->ends_with(".csv")) return;
  CsvReader table(path_of_file(*file));
  std::vector<std::pair<double, double>> ranges(table.columns().size(), {HUGE_VAL, -HUGE_VAL});
  int n = 0;
  for (Names cells; table.next(cells); ++n)
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (double x = 0; table.number(cells[k], x))
        ranges[k] = {std::min(ranges[k].first, x), std::max(ranges[k].second, x)};
  std::string line = fmt::format("{}: {} points", *file->text(), n);
  for (std::size_t k = 0; k < ranges.size(); ++k)
    if (const CsvColumn& c = table.columns()[k]; ranges[k].first <= ranges[k].second)
      line += fmt::format("; {} {:.4g} to {:.4g} {}", c.name, ranges[k].first, ranges[k].second,
                          c.unit.empty() ? "(SI)" : c.unit);
  if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
}

/// What is counted and found of a scene.
struct Findings {
  MobilityFindings moves;
  double violation = 0, violation_v = 0;  // of the start as it was typed
  std::vector<std::string> proposals;
  std::string formulation, stages;
  TreeReport tree;
  Names columns, taken, tables;
  std::vector<SceneParameter> parameters;
};

/// The formulation of a run, and what it makes of the mechanism; `why_not_joint`: what keeps it from joint coordinates.
std::string formulation_of(const Mechanism& m, const std::string& why_not_joint, const Findings& found) {
  const Formulation asked = m.run.formulation;
  if (asked == Formulation::quaternion || (asked == Formulation::omega && !m.system.plane())) return to_string(asked);
  const Plane plane = m.system.plane();
  const char* counts = found.moves.plane.empty() ? " (the start and all loads lie in it; counts are in space)" : "";
  const std::string where = plane ? fmt::format(", in the plane with normal {}{}", "xyz"[plane.n], counts) : "";
  if (asked == Formulation::omega) return "omega" + where;
  if (!why_not_joint.empty()) return "omega" + where + ": " + why_not_joint;
  const int unknowns = found.tree.n_coordinates;
  if (unknowns == 0) return fmt::format("joint{}: no unknowns, the motion is prescribed", where);
  return fmt::format("joint{}: {} unknown velocit{}, {}{}", where, unknowns, unknowns == 1 ? "y" : "ies",
                     found.tree.has_rows() ? "and " : "", rows_in_words(found.tree));
}

Findings found_in(const Arguments& args, const Loaded& loaded, Mechanism& m) {
  Findings found;
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  make_events(m, *recorder);
  found.columns = recorder->table().names();
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const State start = m.system.start();
  found.violation = dynamics.violation(start), found.violation_v = dynamics.violation_v(start);
  found.moves = mobility_of(dynamics, m, start);
  for (const Finding& f :
       settings_to_warn_of(loaded.scene, m, args, make_integrator(m.run, loaded.registry)->info().adaptive))
    report_finding(f);
  if (m.run.until < 0)
    CommandFindings::add({&finding::analysis_note, "", "the scene has no end time; a run needs \"until\" (--until)"});
  const MobilityReport& r = found.moves.mobility;
  const std::string not_joint = why_not_joint(dynamics, start, *make_integrator(m.run, loaded.registry));
  TreeReport tree;
  if (not_joint.empty()) tree = tree_of(m.system, start.modes);
  if (!args.has("--full")) {
    const FindingScope unheard;  // each builds the scene again, with the same findings
    found.proposals = proposals(loaded, m, !not_joint.empty() || tree.has_rows());
  }
  if (m.run.formulation == Formulation::automatic || m.run.formulation == Formulation::joint)
    found.tree = std::move(tree);
  found.formulation = formulation_of(m, not_joint, found);
  const bool joint = found.formulation.starts_with("joint");
  found.stages = stages_of(m, start, loaded.registry, joint ? found.tree.has_rows() : r.rows > 0);
  add_tables(loaded.scene.root, found.tables);
  found.taken = frames_taken(loaded.scene), found.parameters = loaded.scene.parameters;
  return found;
}

const Fields<Branch> kBranchFields{{"body", "", "body", &Branch::body},
                                   {"parent", "", "on", &Branch::parent},
                                   {"link", "", "by joint", &Branch::link},
                                   {"coordinates", "", "coordinates", &Branch::coordinates},
                                   {"held", "", "prescribed", [](const Branch& b) { return b.coordinates.empty(); }},
                                   {"rows", "", "constraints left", &Branch::rows}};
const Fields<SceneParameter> kSceneParameterFields{
    {"name", "", "name", &SceneParameter::name},
    {"kind", "", "", [](const SceneParameter& p) { return p.is_point ? "point" : "parameter"; }},
    {"now", "", "value", [](const SceneParameter& p) { return value_words(p.value, true); }},
    {"value", "", "", [](const SceneParameter& p) { return value_text(p.value); }},
    {"written", "", "written", [](const SceneParameter& p) { return value_text(p.written); }}};
const Fields<Findings> kCheckFields =
    Fields<Findings>{}
        .with(&Findings::moves, mobility_fields())
        .with({{"formulation", "", "", &Findings::formulation},
               {"stages", "", "", &Findings::stages},
               {"violation", "m", "", &Findings::violation},
               {"violation_v", "m/s", "", &Findings::violation_v},
               {"frames_taken", "", "places assumed", &Findings::taken},
               {"tables", "", "tables", &Findings::tables},
               {"tree", "joint coordinates", [](const Findings& f) { return f.tree.branches; }, kBranchFields},
               {"closures", "", "", [](const Findings& f) { return f.tree.closures; }},
               {"columns", "", "", &Findings::columns},
               {"parameters", "parameters and points", &Findings::parameters, kSceneParameterFields},
               {"proposals", "", "possible simplifications", &Findings::proposals}});

std::string counted(int n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

// "crank, coupler, rocker (+ ground)".
std::string body_words(const System& system) {
  Names moving, fixed;
  for (const Body& b : system.bodies()) (b.fixed ? fixed : moving).push_back(b.name);
  return (moving.empty() ? "none" : first_of(moving)) + " (+ " + first_of(fixed) + ")";
}

// "4 revolute: A, B, C, D; 1 distance: rope".
std::string joint_words(const System& system) {
  nlohmann::ordered_map<std::string, Names> by_type;
  for (const auto& link : system.links())
    by_type[link->active_at_start() ? std::string(link->type()) : "inactive"].push_back(link->name());
  std::string words;
  for (const auto& [type, names] : by_type)
    words += fmt::format("{}{} {}: {}", words.empty() ? "" : "; ", names.size(), type, first_of(names));
  return words;
}

std::string freedom_words(const MobilityFindings& f) {
  const MobilityReport& r = f.mobility;
  std::string words = fmt::format("{}", r.freedoms + r.driven);
  if (!f.laws.empty()) words += ", moved by the laws of " + first_of(f.laws);
  if (r.driven > 0)
    words += fmt::format(", {}driven by {}", r.freedoms > 0 ? fmt::format("{} ", r.driven) : "", first_of(r.drives));
  return words;
}

std::string redundant_words(const Findings& f, bool all) {
  const MobilityReport& r = f.moves.mobility;
  const std::string where = f.moves.plane.empty() ? "" : " in the plane (--full counts in space)";
  std::string words;
  const auto add = [&](std::size_t n, const char* how, const Names& rows) {
    if (n > 0)
      words += fmt::format("{}{} {} {}", words.empty() ? "" : "\n" + std::string(22, ' '), n, how, by_joint(rows));
  };
  if (all && r.redundant > 0) words = fmt::format("{}, in the table of dependent constraints", r.redundant);
  for (const Dependency& d : r.dependencies)
    if (!all) add(static_cast<std::size_t>(d.too_many), "of", d.rows);
  for (const NearDependency& d : f.moves.near.all) add(d.left_out.size(), "of these dropped:", d.left_out);
  return (words.empty() ? "none" : words) + where;
}

std::string fact_line(std::string_view label, const std::string& words) {
  return words.empty() ? "" : fmt::format("  {:<18}  {}\n", label, words);
}

// The verdict, the bodies and the joints.
std::string head_text(const System& system, const Findings& f) {
  const MobilityReport& r = f.moves.mobility;
  std::string text;
  if (f.moves.error.empty())
    text = fmt::format("  {}.\n\n", f.moves.position.singular
                                        ? "The mechanism assembles in a singular configuration; " +
                                              counted(r.freedoms + r.driven, "instantaneous degree") + " of freedom"
                                    : r.freedoms > 0 ? "OK: the mechanism assembles; " + counted(r.freedoms, "degree") +
                                                           " of freedom " + (r.freedoms == 1 ? "is free" : "are free")
                                    : r.driven > 0 || !f.moves.laws.empty()
                                        ? "OK: the mechanism assembles; its motion is fully prescribed"
                                        : "The mechanism assembles, but it cannot move");
  return text + fact_line("bodies", body_words(system)) + fact_line("joints", joint_words(system));
}

// The other facts that matter before a run; `all`: tables follow.
std::string brief_text(const Findings& f, bool all) {
  if (!f.moves.error.empty()) return fact_line("degrees of freedom", "not computed");
  return fact_line("degrees of freedom", freedom_words(f.moves)) + fact_line("redundant", redundant_words(f, all)) +
         fact_line("solved as", f.formulation);
}

// As text: one line for a vector, "A.v{x,y,z}".
std::string channels_text(const std::vector<OwnedChannel>& all) {
  const auto is_next = [&](std::size_t k, const ChannelHelp& x, char axis) {  // the same of another axis
    const auto same = [&](std::string text, const std::string& other) { return text.back() = axis, text == other; };
    return k < all.size() && same(x.name, all[k].channel.name) && same(x.help, all[k].channel.help);
  };
  std::vector<OwnedChannel> lines;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const ChannelHelp& x = all[k].channel;
    ChannelHelp& line = lines.emplace_back(all[k]).channel;
    if (!x.help.ends_with(", x") || !is_next(k + 1, x, 'y') || !is_next(k + 2, x, 'z')) continue;
    line.name.replace(line.name.size() - 1, 1, "{x,y,z}"), line.help.resize(line.help.size() - 3);
    k += 2;
  }
  return text_of(kChannelsFields.schema(), kChannelsFields(lines));
}

// The exit code of a run of it, as far as its start: the findings precede the error of the start.
Result check_scene(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_observed(loaded.scene, loaded.registry);
  if (args.has("--channels")) {
    const std::vector<OwnedChannel> channels = channels_of(m.system, args["--of"]);
    Result result(loaded, kChannelsFields, channels);
    result.brief = channels_text(channels);
    return result;
  }
  const Findings found = found_in(args, loaded, m);
  if (!found.moves.error.empty())
    tell_error(found.moves.error);
  else if (!args.has("--verbose"))  // which lists them
    note_not_unique(found.moves.reactions);
  Result result(loaded, kCheckFields, found);
  result.brief = head_text(m.system, found) + brief_text(found, args.has("--verbose"));
  Json shown = result.data;
  if (!found.moves.error.empty())
    for (const FieldInfo& count : mobility_fields().schema().fields) shown.erase(count.name);
  if (args.has("--verbose"))
    result.brief += "\n" + text_of(*result.schema, shown);
  else if (found.moves.error.empty())
    result.brief += std::string("\n  More: --verbose, --channels") + (args.has("--full") ? "\n" : ", --full\n");
  result.code = found.moves.exit_code;
  return result;
}

// Each is checked; the first that fails decides the exit code.
Result check(const Arguments& args) {
  if (args.all("more").empty()) return check_scene(args);
  Result all;
  std::vector<std::string> scenes = args.all("more");
  scenes.insert(scenes.begin(), args["scene"]);
  Arguments one = args;
  for (const std::string& scene : scenes) {
    one.set("scene", scene);
    Result result;
    try {
      result = check_scene(one);
    } catch (const Error& error) {
      tell_error(in_lines(error));
      result.code = exit_code_of(error), result.scene = scene, result.data = {{"error", error.what()}};
    }
    if (all.code == kExitOk) all.code = result.code;
    all.each.push_back(std::move(result));
  }
  return all;
}

}  // namespace

Command check_command() {
  return {
      "check",
      join({scene_options(),
            {kJson,
             {"--verbose,-v", "",
              "print all counts, free motions, the coordinates, parameters, possible simplifications"},
             {"--channels", "", "list the channels of the scene, with unit and meaning"},
             Option{"--of", "NAME", "only channels of this body, marker (also those of a joint: A.P), joint or force"}
                 .along("--channels"),
             Option{"more", "SCENE", "further scenes"}.repeated()}}),
      check,
      "Constraints of a joint are named by what they hold: x y z translations, e1 e2 e3 rotations, in the axes of "
      "S.\n\n"
      "Example:\n  lockstep check samples/scenes/four_bar.json --json",
      {&kCheckFields.schema(), &kChannelsFields.schema()}};
}

}  // namespace lockstep
