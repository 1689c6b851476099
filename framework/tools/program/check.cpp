// SPDX-License-Identifier: BSD-3-Clause
// The verb check: the size of a scene, and which parts of the computation it does not need.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include <lockstep/uniqueness.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/check_tree.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/frames_taken.h"
#include "framework/tools/program/mobility_findings.h"
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
    if (holds(*object)) names.push_back(object->name());
  return names;
}
template <class Condition>
Names names_of(const std::deque<Body>& bodies, Condition&& holds) {
  Names names;
  for (const Body& body : bodies)
    if (holds(body)) names.push_back(body.name);
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

/// What a channel belongs to, "body 'crank'": the object with the longest name that the channel begins with.
std::string owner_of(const ChannelHelp& channel, const System& system) {
  std::string owner;
  std::size_t longest = 0;
  const auto take = [&](const char* kind, const std::string& name) {
    if (name.size() <= longest || !channel.name.starts_with(name + ".")) return;
    longest = name.size(), owner = fmt::format("{} '{}'", kind, name);
  };
  for (const Body& b : system.bodies()) take("body", b.name);
  for (const Marker& m : system.markers()) take("marker", m.name);
  for (const auto& l : system.links()) take("link", l->name());
  for (const auto& f : system.forces()) take("force", f->name());
  return owner.empty() ? "the whole mechanism" : owner;
}

// `of`: the name of what they belong to; "" for all.
void list_channels(const System& system, const std::string& of, nlohmann::ordered_json* json) {
  std::vector<ChannelHelp> all = channel_help(system);
  std::erase_if(all, [](const ChannelHelp& c) { return c.name.starts_with("ground."); });  // it never moves
  if (!of.empty()) {
    Names owners;
    for (const ChannelHelp& c : all) {
      const std::string owner = owner_of(c, system);
      const std::size_t quote = owner.find('\'');
      if (quote != std::string::npos) owners.push_back(owner.substr(quote + 1, owner.size() - quote - 2));
    }
    if (std::find(owners.begin(), owners.end(), of) == owners.end())
      throw UsageError("--of: nothing named \"" + of + "\" has channels" + text::suggestion(of, owners));
    std::erase_if(all, [&](const ChannelHelp& c) { return !owner_of(c, system).ends_with(" '" + of + "'"); });
  }
  std::size_t name = 0, unit = 0;
  auto j = nlohmann::ordered_json::array();
  for (const ChannelHelp& c : all) {
    name = std::max(name, c.name.size()), unit = std::max(unit, c.unit.size());
    j.push_back({{"name", c.name}, {"unit", c.unit}, {"of", owner_of(c, system)}, {"help", c.help}});
  }
  if (json != nullptr) {
    *json = std::move(j);
    return;
  }
  std::string last;
  for (const ChannelHelp& c : all) {
    const std::string owner = owner_of(c, system);
    if (owner != last) fmt::print("{}:\n", owner);
    last = owner;
    fmt::print("  {:<{}}  {:<{}}  {}\n", c.name, name, c.unit, unit, c.help);
  }
  fmt::print("a body or marker seen from another: <one>.<quantity>@<other>, as in {0}.x@ground\n",
             system.bodies().empty() ? "body" : system.bodies().back().name);
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

/// A computed value in six digits: "0.15 m", "[0.1, 0.2, 0] m".
std::string brief_text(const Value& v) {
  const auto split = [](const Value& one) {
    const std::string text = plain_text(one);
    const std::size_t blank = std::min(text.find(' '), text.size());
    return std::pair(fmt::format("{:.6g}", std::stod(text.substr(0, blank))), text.substr(blank));
  };
  if (v.list() == nullptr) return split(v).first + split(v).second;
  std::string numbers, unit;
  for (const Value& each : *v.list()) {
    const auto [number, its] = split(each);
    numbers += (numbers.empty() ? "" : ", ") + number, unit = its;
  }
  return "[" + numbers + "]" + unit;
}

nlohmann::ordered_json parameters_json(const Scene& scene) {
  auto all = nlohmann::ordered_json::array();
  for (const SceneParameter& p : scene.parameters)
    all.push_back({{"name", p.name},
                   {"kind", p.is_point ? "point" : "parameter"},
                   {"value", value_text(p.value)},
                   {"written", value_text(p.written)}});
  return all;
}

constexpr int kMostListed = 40;  // of parameters, and of points

/// Parameters and points with their values, and the formula behind them.
void list_parameters(const Scene& scene) {
  std::size_t name = 0, value = 0;
  for (const SceneParameter& p : scene.parameters)
    name = std::max(name, p.name.size()), value = std::max(value, brief_text(p.value).size());
  for (const bool points : {false, true}) {
    bool first = true;
    int left = kMostListed;
    for (const SceneParameter& p : scene.parameters) {
      if (p.is_point != points) continue;
      if (left-- == 0) fmt::print("  ...\n");
      if (left < 0) continue;
      if (first) fmt::print("{}:\n", points ? "points" : "parameters (--set NAME=VALUE gives another value)");
      first = false;
      const std::string written = value_text(p.written), now = brief_text(p.value);
      if (written.find('=') == std::string::npos)
        fmt::print("  {:<{}}  {}\n", p.name, name, now);
      else
        fmt::print("  {:<{}}  {:<{}}  {}\n", p.name, name, now, value, written);
    }
  }
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
  found.taken = frames_taken(loaded.scene);
  return found;
}

nlohmann::ordered_json findings_json(const Loaded& loaded, const Mechanism& m, const Findings& found) {
  nlohmann::ordered_json j = {{"scene", loaded.scene.file}, {"title", loaded.scene.title}};
  put_mobility(j, found.moves, m.run);
  j["formulation"] = found.formulation, j["stages"] = found.stages;
  j["tree"] = tree_json(found.tree.branches), j["closures"] = found.tree.closures;
  j["violation"] = found.violation, j["violation_v"] = found.violation_v;
  j["columns"] = found.columns;
  j["left_out"] = nlohmann::ordered_json::array();
  for (const LeftOut& l : found.left_out) j["left_out"].push_back({{"what", l.what}, {"names", l.names}});
  j["proposals"] = found.proposals;
  j["parameters"] = parameters_json(loaded.scene);
  j["frames_taken"] = found.taken;
  return j;
}

void print_findings(const Loaded& loaded, const Mechanism& m, const Findings& found) {
  fmt::print("{}\n", loaded.title());
  print_freedoms(found.moves);
  fmt::print("  formulation         {}\n", found.formulation);
  if (!found.stages.empty()) fmt::print("  stages              {}\n", found.stages);
  print_dependencies(found.moves, m.run);
  fmt::print(
      "  start violates      {:.2g} m, {:.2g} m/s{}\n", found.violation, found.violation_v,
      m.run.assemble && (found.violation > 1e-6 || found.violation_v > 1e-6) ? "; a run assembles it first" : "");
  if (!found.taken.empty()) fmt::print("places that are taken, as none is given:\n");
  for (const std::string& text : found.taken) fmt::print("  {}\n", text);
  if (!found.tree.branches.empty())
    fmt::print("coordinates of the joints, from the ground outward:\n{}", tree_text(found.tree.branches));
  list_parameters(loaded.scene);
  fmt::print("left out, because the scene does not need it:\n");
  for (const LeftOut& l : found.left_out) fmt::print("  {} ({})\n", l.what, first_of(l.names));
  if (!found.proposals.empty()) fmt::print("could be left out too:\n");
  for (const std::string& text : found.proposals) fmt::print("  {}\n", text);
}

void check_channels(const Arguments& args, const Loaded& loaded, const System& system,
                    nlohmann::ordered_json& results) {
  if (!args.has("--json") && !args.all("more").empty()) fmt::print("{}\n", loaded.title());
  nlohmann::ordered_json channels;
  list_channels(system, args["--of"], args.has("--json") ? &channels : nullptr);
  if (args.has("--json") && args.all("more").empty())
    results.push_back(std::move(channels));
  else if (args.has("--json"))
    results.push_back({{"scene", loaded.scene.file}, {"channels", std::move(channels)}});
}

int refused(const Error& error) {
  fmt::print(stderr, "{} {}\n", error_mark(), error.what());
  return exit_code_of(error);
}

// The exit code of a run of it, as far as its start: the findings stand before what that refuses.
int check_scene(const Arguments& args, nlohmann::ordered_json& results) {
  const Loaded loaded = load(args);
  Mechanism m = build_observed(loaded.scene, loaded.registry);
  if (args.has("--channels")) return check_channels(args, loaded, m.system, results), kExitOk;
  const Findings found = found_in(args, loaded, m);
  if (args.has("--json"))
    results.push_back(findings_json(loaded, m, found));
  else
    print_findings(loaded, m, found);
  if (!found.moves.refused) return kExitOk;
  try {
    std::rethrow_exception(found.moves.refused);
  } catch (const Error& error) {
    if (args.has("--json")) results.back()["error"] = error.what();
    return refused(error);
  }
}

// Each is checked, whatever the others are; the first that fails decides the exit code.
int check_scenes(const Arguments& args, nlohmann::ordered_json& results) {
  int code = kExitOk;
  Arguments one = args;
  const auto check = [&](const std::string& scene) {
    one.set("scene", scene);
    int of_one = kExitOk;
    try {
      of_one = check_scene(one, results);
    } catch (const Error& error) {
      of_one = refused(error);
      results.push_back({{"scene", scene}, {"error", error.what()}});
    }
    if (code == kExitOk) code = of_one;
  };
  check(args["scene"]);
  for (const std::string& scene : args.all("more")) {
    if (!args.has("--json")) fmt::print("\n");
    std::fflush(stdout);
    check(scene);
  }
  return code;
}

}  // namespace

int check_command(const Arguments& args) {
  auto results = nlohmann::ordered_json::array();
  const bool several = !args.all("more").empty();
  int code = kExitOk;
  if (several)
    code = check_scenes(args, results);
  else
    code = check_scene(args, results);
  if (args.has("--json")) print_result(several ? results : results.front());
  return code;
}

}  // namespace lockstep
