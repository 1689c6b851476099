// The verb check: a scene in numbers, and what is left out because it does not need it.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include <lockstep/analysis.h>
#include <lockstep/lock.h>
#include "framework/tools/program/commands.h"
#include <lockstep/sweep.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

using Names = std::vector<std::string>;

/// Parts of the computation that this scene does without: what, and the things that it concerns.
struct LeftOut {
  std::string what;
  Names names;
};

bool laws_of(const Marker& m) { return m.translation_law != nullptr || m.rotation_law != nullptr; }

/// Joints of which `is_so` holds; both halves of the same link.
Names where(const Mechanism& m, const std::function<bool(const Lock&, const Jointed&)>& is_so) {
  Names names;
  for (const auto& link : m.system.links())
    if (const Jointed* joint = std::as_const(*link).jointed(); joint != nullptr && is_so(*link, *joint))
      names.push_back(link->name());
  return names;
}

bool markers_still(const Lock& link) {
  const auto [p, s] = link.pairs().front();
  return !laws_of(*p) && !laws_of(*s);
}

std::vector<LeftOut> left_out(const Mechanism& m) {
  Names fixed, particles, inactive;
  for (const Body& body : m.system.bodies()) {
    if (body.fixed && body.name != "ground") fixed.push_back(body.name);
    if (body.freedoms == Freedoms::particle) particles.push_back(body.name);
  }
  for (const auto& link : m.system.links())
    if (!link->active_at_start()) inactive.push_back(link->name());
  const bool dense = std::any_of(m.run.record.begin(), m.run.record.end(),
                                 [](const ChannelRequest& r) { return r.channel.find("energy.") == 0; });
  std::vector<LeftOut> all = {{"motion of fixed bodies: no unknowns", fixed},
                              {"rotation of particles: 3 unknowns instead of 6", particles},
                              {"rows of links that are not active at the start", inactive},
                              {"rotational half of the lock: never evaluated",
                               where(m, [](const Lock&, const Jointed& j) { return !overlaps(j.rows(), Mask::e123); })},
                              {"translational half of the lock: never evaluated",
                               where(m, [](const Lock&, const Jointed& j) { return !overlaps(j.rows(), Mask::xyz); })},
                              {"motion of markers: they stand still on their bodies",
                               where(m, [](const Lock& l, const Jointed&) { return markers_still(l); })}};
  Names merged;
  for (const auto& link : m.system.links())
    if (m.system.merged(*link)) merged.push_back(link->name());
  all.push_back({"rows of fixed links: their bodies move as one", merged});
  if (const Plane plane = m.system.plane())
    all.push_back({"motion out of the plane: three velocities a body", {std::string("normal ") + "xyz"[plane.n]}});
  if (!dense) all.push_back({"energies: integrated for the summary only, with --quiet not at all", {"energy"}});
  if (m.system.forces().empty()) all.push_back({"forces: there are none but gravity", {"forces"}});
  std::erase_if(all, [](const LeftOut& l) { return l.names.empty(); });
  return all;
}

/// What a channel belongs to: "body 'crank'".
std::vector<std::pair<std::string, std::string>> owners(const System& system) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const Body& b : system.bodies()) all.emplace_back(b.name, "body");
  for (const Marker& m : system.markers()) all.emplace_back(m.name, "marker");
  for (const auto& l : system.links()) all.emplace_back(l->name(), "link");
  for (const auto& f : system.forces()) all.emplace_back(f->name(), "force");
  return all;
}

/// The longest name of an object that the channel begins with; "" for those of the whole mechanism.
std::string owner_of(const ChannelHelp& channel, const System& system) {
  std::string best, text;
  for (const auto& [name, kind] : owners(system))
    if (name.size() > best.size() && channel.name.rfind(name + ".", 0) == 0)
      best = name, text = kind + " '" + name + "'";
  return text.empty() ? "the whole mechanism" : text;
}

int list_channels(const System& system, bool as_json) {
  std::vector<ChannelHelp> all = channel_help(system);
  std::erase_if(all, [](const ChannelHelp& c) { return c.name.rfind("ground.", 0) == 0; });  // it never moves
  std::size_t name = 0, unit = 0;
  auto j = nlohmann::ordered_json::array();
  for (const ChannelHelp& c : all) {
    name = std::max(name, c.name.size()), unit = std::max(unit, c.unit.size());
    j.push_back({{"name", c.name}, {"unit", c.unit}, {"of", owner_of(c, system)}, {"help", c.help}});
  }
  if (as_json) {
    fmt::print("{}\n", j.dump(1, ' '));
    return kExitOk;
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
  return kExitOk;
}

/// What the scene could leave out besides, exactly.
std::vector<std::string> proposals(const Loaded& loaded, const Mechanism& m) {
  std::vector<std::string> all;
  Mechanism other = build(loaded.scene, loaded.registry);
  if (!m.system.plane())
    if (const Plane plane = find_plane(other.system)) {
      other.system.set_planar(plane);
      other.system.setup();
      all.push_back(fmt::format("\"planar\": \"{}\" is exact here: {} unknown velocities instead of {}", "xyz"[plane.n],
                                other.system.n_velocities(), m.system.n_velocities()));
    }
  if (loaded.scene.root.find("merge") != nullptr) return all;
  Scene scene = loaded.scene;
  scene.root.object()->push_back({"merge", Value("auto"), scene.root.where});
  try {
    const Mechanism merged = build(scene, loaded.registry);
    const long n = std::count_if(merged.system.links().begin(), merged.system.links().end(),
                                 [&](const auto& l) { return merged.system.merged(*l); });
    if (n > 0)
      all.push_back(
          fmt::format("\"merge\": \"auto\" would move the bodies of {} fixed link{} as one", n, n > 1 ? "s" : ""));
  } catch (const Error&) {  // then there is nothing to propose
  }
  return all;
}

}  // namespace

int check_command(const Words& w) {
  const Loaded loaded = load(w);
  Mechanism m = build(loaded.scene, loaded.registry);
  if (w.channels) return list_channels(m.system, w.json);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  make_events(m, *recorder);
  Dynamics dynamics(m.system, make_solver(m.run, loaded.registry), {m.run.formulation, m.run.stabilization});
  const State start = m.system.start();
  const double violation = dynamics.violation(start), violation_v = dynamics.violation_v(start);
  const MobilityReport r = mobility(dynamics, start);
  const std::vector<LeftOut> out = left_out(m);
  const std::vector<std::string> more = w.full ? std::vector<std::string>{} : proposals(loaded, m);

  if (w.json) {
    nlohmann::ordered_json j = {{"scene", loaded.scene.file},
                                {"title", loaded.scene.title},
                                {"bodies", r.bodies},
                                {"unknowns", r.unknowns},
                                {"rows", r.rows},
                                {"rank", r.rank},
                                {"freedoms", r.freedoms},
                                {"redundant", r.redundant},
                                {"redundant_links", r.redundant_links},
                                {"violation", violation},
                                {"violation_v", violation_v},
                                {"columns", recorder->table().names()},
                                {"left_out", nlohmann::ordered_json::array()}};
    for (const LeftOut& l : out) j["left_out"].push_back({{"what", l.what}, {"names", l.names}});
    j["proposals"] = more;
    fmt::print("{}\n", j.dump(1, ' '));
    return kExitOk;
  }
  fmt::print("{}\n", loaded.scene.title.empty() ? loaded.scene.file : loaded.scene.title);
  fmt::print("  bodies that move    {}\n  unknown velocities  {}\n  rows                {}\n  degrees of freedom  {}\n",
             r.bodies, r.unknowns, r.rows, r.freedoms);
  if (r.redundant > 0) fmt::print("  redundant rows      {} (in {})\n", r.redundant, text::join(r.redundant_links));
  fmt::print("  start violates      {:.2g} m, {:.2g} m/s{}\n", violation, violation_v,
             violation > 1e-6 || violation_v > 1e-6 ? "; a run assembles it first" : "");
  fmt::print("left out, because the scene does not need it:\n");
  for (const LeftOut& l : out) fmt::print("  {} ({})\n", l.what, text::join(l.names));
  if (!more.empty()) fmt::print("could be left out too:\n");
  for (const std::string& text : more) fmt::print("  {}\n", text);
  return kExitOk;
}

}  // namespace lockstep
