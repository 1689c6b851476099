// SPDX-License-Identifier: BSD-3-Clause
// The verb check: the size of a scene, and which parts of the computation it does not need.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/check_tree.h"
#include "framework/tools/program/describe_scene.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/mobility_findings.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/run_warnings.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostProposed = 20000;  // bodies

using Names = std::vector<std::string>;

/// A part of the computation that this scene does not need, and the objects concerned.
struct LeftOut {
  std::string what;
  Names names;
};

/// The names of those that satisfy a condition.
template <class Objects, class Condition>
Names names_of(const Objects& objects, Condition&& holds) {
  Names names;
  for (const auto& object : objects)
    if constexpr (requires { object.name; }) {
      if (holds(object)) names.push_back(object.name);
    } else if (holds(*object)) {
      names.push_back(object->name());
    }
  return names;
}

std::vector<LeftOut> left_out(const Mechanism& m) {
  const System& system = m.system;
  const auto joints = [&](auto&& holds) {
    return names_of(system.links(), [&](const Lock& link) { return link.jointed() != nullptr && holds(link); });
  };
  const auto lacks = [&](Mask rows) {
    return joints([=](const Lock& link) { return !overlaps(link.jointed()->rows(), rows); });
  };
  const auto still = [](const Marker* marker) {
    return marker->translation_law == nullptr && marker->rotation_law == nullptr;
  };
  std::vector<LeftOut> all = {
      {"motion of fixed bodies: no unknowns",
       names_of(system.bodies(), [](const Body& b) { return b.fixed && b.name != "ground"; })},
      {"rotation of particles: 3 unknowns instead of 6",
       names_of(system.bodies(), [](const Body& b) { return b.freedoms == Freedoms::particle; })},
      {"rows of links that are not active at the start",
       names_of(system.links(), [](const Lock& link) { return !link.active_at_start(); })},
      {"rotational half of the lock: never evaluated", lacks(Mask::e123)},
      {"translational half of the lock: never evaluated", lacks(Mask::xyz)},
      {"motion of markers: they stand still on their bodies", joints([&](const Lock& link) {
         return still(link.pairs().front().first) && still(link.pairs().front().second);
       })},
      {"rows of fixed links: their bodies move as one",
       names_of(system.links(), [&](const Lock& link) { return system.merged(link); })}};
  if (const Plane plane = system.plane())
    all.push_back({"motion out of the plane: three velocities a body", {std::string("normal ") + "xyz"[plane.n]}});
  if (std::none_of(m.run.record.begin(), m.run.record.end(),
                   [](const ChannelRequest& r) { return r.channel.starts_with("energy."); }))
    all.push_back({"energies: integrated for the summary only, with --quiet not at all", {"energy"}});
  if (system.forces().empty()) all.push_back({"forces: there are none but gravity", {"forces"}});
  std::erase_if(all, [](const LeftOut& l) { return l.names.empty(); });
  return all;
}

/// The value of a key of the scene's integrator; "" where it is not given.
std::string integrator_key(const RunSettings& run, const char* key) {
  const Value* value = run.integrator.keys.object() != nullptr ? run.integrator.keys.find(key) : nullptr;
  return value == nullptr ? "" : plain_text(*value);
}

/// Where the stages of an explicit method that may go onto the constraints are evaluated, and why; "" of other methods.
/// `rows`: whether the run has rows.
std::string stages_of(const Mechanism& m, const State& start, const Registry& registry, bool rows) {
  const auto* type = registry.integrators.find(m.run.integrator.type);
  if (type == nullptr || type->origin != "built in" ||
      std::ranges::none_of(type->info.keys, [](const Key& key) { return key.name == "stages"; }))
    return "";
  const std::string asked = integrator_key(m.run, "stages");
  if (asked == "plain") return "plain, as asked for";
  if (!rows) return "plain: no rows are left";
  if (asked == "manifold") return "on the constraints in every step, as asked for";
  if (!make_integrator(m.run, registry)->info().adaptive) return "plain: the steps are fixed";
  if (m.run.stabilization.kind != Stabilization::Kind::project)
    return "plain: nothing is projected onto the constraints";
  if (!has_loops(m.system, start.modes)) return "plain: no loop is closed, so that no position is singular";
  return "plain, and on the constraints near singular positions, or where rows are redundant there only";
}

struct OwnedChannel {
  ChannelHelp channel;
  std::string owner;
};

// Of the thing of this name; "": of all.
std::vector<OwnedChannel> channels_of(const System& system, const std::string& of) {
  std::vector<OwnedChannel> all;
  Names owners;
  for (ChannelHelp& c : channel_help(system)) {
    if (c.name.starts_with("ground.")) continue;  // it never moves
    const auto [kind, owner] = owner_of(c.name, system);
    if (!owner.empty()) owners.push_back(owner);
    if (of.empty() || owner == of)
      all.push_back({std::move(c), owner.empty() ? "the whole mechanism" : fmt::format("{} '{}'", kind, owner)});
  }
  if (all.empty()) throw UsageError("--of: nothing named \"" + of + "\" has channels" + text::suggestion(of, owners));
  return all;
}

const Fields<std::vector<OwnedChannel>>& channel_fields() {
  using Owned = OwnedChannel;
  static const Fields<Owned> kChannel{{"name", "", "name", [](const Owned& c) { return c.channel.name; }},
                                      {"unit", "", "unit", [](const Owned& c) { return c.channel.unit; }},
                                      {"of", "", "of", &Owned::owner},
                                      {"help", "", "what it is", [](const Owned& c) { return c.channel.help; }}};
  static const Fields<std::vector<Owned>> kFields{
      Field<std::vector<Owned>>("channels", "channels", std::identity(), kChannel).whole()};
  return kFields;
}

/// The rows that a tree leaves: of what closes loops, and of joints that do not hold all of theirs.
std::string rows_in_words(const TreeReport& tree) {
  if (!tree.has_rows()) return "no rows";
  std::string words;
  if (!tree.closures.empty()) words = "the rows of what closes loops: " + first_of(tree.closures);
  if (!tree.left.empty()) words += (words.empty() ? "" : "; ") + ("single rows: " + first_of(tree.left));
  return words;
}

/// What "auto" would integrate, in space unless the scene names its plane: "no rows", or the rows that are left; "" where it
/// takes omega.
std::string rows_along_joints(const Loaded& loaded) {
  Scene scene = in_space(loaded.scene);
  scene.run.formulation = Formulation::automatic;
  Mechanism m = build_mechanism(scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  const std::vector<bool> modes = m.system.start().modes;
  if (!dynamics.why_not_joint(modes).empty()) return "";
  return rows_in_words(tree_of(m.system, modes));
}

/// The scene in the plane with this normal, where only the word of a part is missing that it stays there.
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
} catch (const std::bad_alloc&) {
  throw;
} catch (...) {  // not in this plane; code of a user that throws where it is only looked at will say so in the run
  return {};
}

/// What the scene could also leave out without an approximation.
std::vector<std::string> proposals(const Loaded& loaded, const Mechanism& m, bool needs_rows) {
  std::vector<std::string> all;
  const Value* planar = loaded.scene.root.find("planar");
  const bool finds_plane = planar == nullptr || (planar->text() != nullptr && *planar->text() == "auto");
  if (!finds_plane && !m.system.plane()) {
    Scene scene = loaded.scene;
    scene.root = scene.root.without({"planar"});
    const Mechanism other = build_mechanism(scene, loaded.registry);
    if (const Plane plane = other.system.plane())
      all.push_back(
          fmt::format("without \"planar\" it moves in the plane with normal {}: {} unknown velocities instead of {}",
                      "xyz"[plane.n], other.system.n_velocities(), m.system.n_velocities()));
  }
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
          fmt::format("\"merge\": \"auto\" would move the bodies of {} fixed link{} as one", n, n > 1 ? "s" : ""));
  } catch (const Error&) {  // nothing to propose
  }
  return all;
}

std::string value_text(const Value& v) {
  if (v.list() == nullptr) return plain_text(v);
  std::string text;
  for (const Value& each : *v.list()) text += (text.empty() ? "" : ", ") + value_text(each);
  return "[" + text + "]";
}

/// What is counted and found of a scene.
struct Findings {
  MobilityFindings moves;
  double violation = 0, violation_v = 0;  // of the start as it was typed
  std::vector<LeftOut> left_out;
  std::vector<std::string> proposals;
  std::string formulation, stages;
  TreeReport tree;
  Names columns, taken;
  std::vector<SceneParameter> parameters;
  std::string error;  // why a run would not start; "" if it would
};

std::vector<std::string> all_proposals(const Arguments& args, const Loaded& loaded, const Mechanism& m,
                                       const MobilityReport& r, bool is_tree) {
  if (args.has("--full")) return {};
  const FindingScope unheard;                    // each builds the scene anew, with the same findings
  if (m.system.bodies().size() > kMostProposed)  // each one builds it anew
    return {fmt::format("(not looked for in more than {} bodies)", kMostProposed)};
  std::vector<std::string> more = proposals(loaded, m, !is_tree);
  if (m.run.formulation != Formulation::omega || !make_integrator(m.run, loaded.registry)->info().joint) return more;
  if (const std::string rows = rows_along_joints(loaded); !rows.empty())
    more.push_back(fmt::format(
        "\"formulation\": \"auto\" integrates the joints' own coordinates, with {} instead of {}", rows, r.rows));
  return more;
}

/// The formulation of a run, and what it makes of the mechanism; `why_not_joint`: what keeps it from joint coordinates.
std::string formulation_of(const Mechanism& m, const std::string& why_not_joint, const Findings& found) {
  const Formulation asked = m.run.formulation;
  if (asked == Formulation::quaternion || (asked == Formulation::omega && !m.system.plane())) return to_string(asked);
  const Plane plane = m.system.plane();
  const std::string where = plane ? fmt::format(", in the plane with normal {}", "xyz"[plane.n]) : "";
  if (asked == Formulation::omega) return "omega" + where;
  if (!why_not_joint.empty()) return "omega" + where + ": " + why_not_joint;
  const int unknowns = found.tree.n_coordinates;
  if (unknowns == 0) return fmt::format("joint{}: nothing is unknown, laws alone move it", where);
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
  const MobilityReport& r = found.moves.mobility;
  found.left_out = left_out(m);
  const std::string not_joint = why_not_joint(m.run, dynamics, start, loaded.registry);
  TreeReport tree;
  if (not_joint.empty()) tree = tree_of(m.system, start.modes);
  found.proposals = all_proposals(args, loaded, m, r, not_joint.empty() && !tree.has_rows());
  if (m.run.formulation == Formulation::automatic || m.run.formulation == Formulation::joint)
    found.tree = std::move(tree);
  found.formulation = formulation_of(m, not_joint, found);
  const bool joint = found.formulation.starts_with("joint");
  found.stages = stages_of(m, start, loaded.registry, joint ? found.tree.has_rows() : r.rows > 0);
  found.taken = frames_taken(loaded.scene), found.parameters = loaded.scene.parameters;
  return found;
}

const Fields<Findings>& check_fields() {
  using Parameter = SceneParameter;
  static const Fields<LeftOut> kLeftOut{{"what", "", "what", &LeftOut::what}, {"names", "", "of", &LeftOut::names}};
  static const Fields<Parameter> kParameter{
      {"name", "", "name", &Parameter::name},
      {"kind", "", "", [](const Parameter& p) { return p.is_point ? "point" : "parameter"; }},
      {"now", "", "value", [](const Parameter& p) { return value_words(p.value, true); }},
      {"value", "", "", [](const Parameter& p) { return value_text(p.value); }},
      {"written", "", "written", [](const Parameter& p) { return value_text(p.written); }}};
  static const Fields<Findings> kFields =
      Fields<Findings>{}
          .with(&Findings::moves, mobility_fields())
          .with({{"formulation", "", "formulation", &Findings::formulation},
                 {"stages", "", "stages", &Findings::stages},
                 {"violation", "m", "start violates", &Findings::violation},
                 {"violation_v", "m/s", "  in velocity", &Findings::violation_v},
                 {"frames_taken", "", "places taken", &Findings::taken},
                 {"tree", "joint coordinates", [](const Findings& f) { return f.tree.branches; }, branch_fields()},
                 {"closures", "", "", [](const Findings& f) { return f.tree.closures; }},
                 {"columns", "", "", &Findings::columns},
                 {"parameters", "parameters and points", &Findings::parameters, kParameter},
                 {"left_out", "not needed, and left out", &Findings::left_out, kLeftOut},
                 {"proposals", "", "could be left out too", &Findings::proposals},
                 {"error", "", "", &Findings::error}});
  return kFields;
}

int refused(const Error& error) {
  fmt::print(stderr, "{} {}\n", error_mark(), error.what());
  return exit_code_of(error);
}

// The exit code of a run of it, as far as its start: the findings stand before what that refuses.
Result check_scene(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_observed(loaded.scene, loaded.registry);
  if (args.has("--channels")) return {loaded, channel_fields(), channels_of(m.system, args["--of"])};
  Findings found = found_in(args, loaded, m);
  int code = kExitOk;
  if (found.moves.refused) try {
      std::rethrow_exception(found.moves.refused);
    } catch (const Error& error) {
      code = refused(error), found.error = error.what();
    }
  Result result(loaded, check_fields(), found);
  result.code = code;
  return result;
}

// Each is checked, whatever the others are; the first that fails decides the exit code.
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
      result.code = refused(error);
      result.scene = scene, result.data = {{"error", error.what()}};
    }
    if (all.code == kExitOk) all.code = result.code;
    all.each.push_back(std::move(result));
  }
  return all;
}

}  // namespace

std::pair<std::string, std::string> owner_of(const std::string& channel, const System& system) {
  std::pair<std::string, std::string> owner;
  const auto take = [&](const char* kind, const std::string& name) {
    if (name.size() > owner.second.size() && channel.starts_with(name + ".")) owner = {kind, name};
  };
  for (const Body& b : system.bodies()) take("body", b.name);
  for (const Marker& m : system.markers()) take("marker", m.name);
  for (const auto& l : system.links()) take("link", l->name());
  for (const auto& f : system.forces()) take("force", f->name());
  return owner;
}

Command check_command() {
  return {"check",
          join({scene_options(),
                {kJson,
                 {"--channels", "", "list every channel that the scene may record, with unit and meaning"},
                 Option{"--of", "NAME", "with --channels: only those of this body, marker, link or force"}.along(
                     "--channels"),
                 Option{"more", "SCENE", "further scenes"}.repeated()}}),
          check,
          "Example:\n  lockstep check samples/scenes/four_bar.json --json",
          {&check_fields().schema(), &channel_fields().schema()}};
}

}  // namespace lockstep
