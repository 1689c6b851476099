// SPDX-License-Identifier: BSD-3-Clause
// The verb explain: what acts on a body, what a link does and why it is redundant, what laws give, at one instant.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <lockstep/explain.h>
#include <lockstep/text.h>
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/document.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3& v) { return {v[0], v[1], v[2]}; }
Json json(const Contribution& c) { return {{"what", c.what}, {"force", json(c.force)}, {"moment", json(c.moment)}}; }

Json json(const BodyBalance& b) {
  Json parts = Json::array();
  for (const Contribution& c : b.parts) parts.push_back(json(c));
  return {{"body", b.body},
          {"mass", b.mass},
          {"center", json(b.center)},
          {"acceleration", json(b.acceleration)},
          {"parts", parts},
          {"sum", json(b.sum)},
          {"rate", json(b.rate)},
          {"left_force", b.left_force},
          {"left_moment", b.left_moment},
          {"incomplete", b.incomplete}};
}

Json json(const LawAccount& l) {
  return {{"what", l.what}, {"unit", l.unit}, {"value", l.value}, {"rate", l.rate}, {"second", l.second}};
}

Json json(const ForceEffect& a) {
  Json on = Json::array(), laws = Json::array();
  for (const Contribution& c : a.on)
    on.push_back({{"body", c.what}, {"force", json(c.force)}, {"moment", json(c.moment)}});
  for (const LawAccount& l : a.laws) laws.push_back(json(l));
  return {{"force", a.name},
          {"type", a.type},
          {"acts", a.acts},
          {"on", on},
          {"laws", laws},
          {"potential", a.potential},
          {"dissipation", a.dissipation},
          {"supply", a.supply}};
}

Json json(const LinkAccount& a) {
  Json rows = Json::array(), laws = Json::array(), sets = Json::array();
  for (const RowAccount& r : a.rows)
    rows.push_back(
        {{"row", r.name}, {"value", r.value}, {"rate", r.rate}, {"multiplier", r.multiplier}, {"drive", r.is_drive}});
  for (const LawAccount& l : a.laws) laws.push_back(json(l));
  for (const Dependency& d : a.dependencies)
    sets.push_back({{"rows", d.rows}, {"too_many", d.too_many}, {"nearly", d.nearly}});
  return {{"link", a.name},
          {"type", a.type},
          {"p", a.on_p},
          {"s", a.on_s},
          {"in_force", a.in_force},
          {"merged", a.merged},
          {"rows", rows},
          {"left_out", a.left_out},
          {"force_on_p", json(a.joint.force)},
          {"moment_on_p", json(a.joint.moment)},
          {"drive_force_on_p", json(a.drives.force)},
          {"drive_moment_on_p", json(a.drives.moment)},
          {"laws", laws},
          {"dependencies", sets}};
}

std::string number(double x, double largest) {
  if (std::isnan(x)) return fmt::format(" {:>12}", "no value");
  return fmt::format(" {:>12.6g}", std::abs(x) <= 1e-13 * largest ? 0.0 : x);
}

void print(const BodyBalance& b) {
  double force = b.rate.force.norm(), moment = b.rate.moment.norm();
  std::size_t width = b.rate.what.size();
  for (const Contribution& c : b.parts) {
    force = std::max(force, c.force.norm()), moment = std::max(moment, c.moment.norm());
    width = std::max(width, c.what.size());
  }
  const auto line = [&](const Contribution& c) {
    fmt::print("  {:<{}} ", c.what, width);
    for (int k = 0; k < 3; ++k) fmt::print("{}", number(c.force[k], force));
    fmt::print("  ");
    for (int k = 0; k < 3; ++k) fmt::print("{}", number(c.moment[k], moment));
    fmt::print("\n");
  };
  fmt::print(
      "body '{}', {:.6g} kg, mass centre at [{:.6g}, {:.6g}, {:.6g}] m; force in N, moment about the mass centre "
      "in N m, world axes\n",
      b.body, b.mass, b.center[0], b.center[1], b.center[2]);
  for (const Contribution& c : b.parts) line(c);
  line(b.sum);
  line(b.rate);
  if (std::isnan(b.left_force)) {
    fmt::print("  no value: a reaction grows without limit towards this singular position\n");
    return;
  }
  fmt::print("  left: {:.2g} N, {:.2g} N m{}\n", b.left_force, b.left_moment,
             b.incomplete.empty() ? "" : " (" + b.incomplete + ")");
}

std::string numbers(const std::vector<double>& values) {
  if (values.size() == 1) return fmt::format("{:.9g}", values.front());
  std::string all;
  for (const double v : values) all += (all.empty() ? "" : ", ") + fmt::format("{:.9g}", v);
  return "[" + all + "]";
}

/// The unit of a derivative of a law, with the space before it: " rad/s^2" of the second one of "rad". A quaternion has
/// angular velocities.
std::string per_second(const LawAccount& law, int times) {
  std::string unit = law.value.size() == 4 ? "rad" : law.unit.empty() ? "1" : law.unit;
  if (unit.ends_with("/s")) unit.resize(unit.size() - 2), ++times;
  return " " + unit + (times == 1 ? "/s" : fmt::format("/s^{}", times));
}

void print(const std::vector<LawAccount>& laws) {
  for (const LawAccount& l : laws)
    fmt::print("  {}: value {}{}{}, rate {}{}, second derivative {}{}\n", l.what, numbers(l.value),
               l.unit.empty() ? "" : " ", l.unit, numbers(l.rate), per_second(l, 1), numbers(l.second),
               per_second(l, 2));
}

void print(const ForceEffect& a) {
  fmt::print("force '{}', {}{}\n", a.name, a.type, a.acts ? "" : ": switched off");
  for (const Contribution& c : a.on)
    fmt::print(
        "  on '{}': force [{:.6g}, {:.6g}, {:.6g}] N, moment about its mass centre [{:.6g}, {:.6g}, {:.6g}] N m, "
        "world axes\n",
        c.what, c.force[0], c.force[1], c.force[2], c.moment[0], c.moment[1], c.moment[2]);
  if (a.potential != 0 || a.dissipation != 0 || a.supply != 0)
    fmt::print("  potential {:.6g} J, takes out {:.6g} W, puts in {:.6g} W\n", a.potential, a.dissipation, a.supply);
  print(a.laws);
}

void print(const LinkAccount& a) {
  fmt::print("link '{}', {}, of '{}' on '{}'", a.name, a.type, a.on_p, a.on_s);
  if (a.merged)
    fmt::print(": its bodies are welded into one, so that it has no rows (--full keeps it)");
  else if (!a.in_force)
    fmt::print(": not in force");
  fmt::print("\n");
  if (a.in_force && !a.left_out.empty())
    fmt::print("  left out, since they depend on others exactly or nearly (\"nearly_redundant\"): {}\n",
               text::join(a.left_out));
  for (const RowAccount& r : a.rows) {
    const bool length = r.kind == RowKind::translation, turn = r.kind == RowKind::rotation;
    fmt::print("  row {:<8} value {:>10.3g}{}, rate {:>10.3g}{}, multiplier {:>12.6g}{}{}\n", r.name, r.value,
               length ? " m" : "", r.rate,
               length ? " m/s"
               : turn ? " 1/s"
                      : "",
               r.multiplier,
               length ? " N"
               : turn ? " N m (twice the moment)"
                      : "",
               r.is_drive ? "  (drive)" : "");
  }
  const auto wrench = [&](const char* what, const LinkWrench& w) {
    fmt::print(
        "  {} on '{}': force [{:.6g}, {:.6g}, {:.6g}] N, moment about P [{:.6g}, {:.6g}, {:.6g}] N m, world "
        "axes\n",
        what, a.on_p, w.force[0], w.force[1], w.force[2], w.moment[0], w.moment[1], w.moment[2]);
  };
  if (!a.rows.empty()) wrench("joint", a.joint);
  if (std::ranges::any_of(a.rows, [](const RowAccount& r) { return r.is_drive; })) wrench("drives", a.drives);
  print(a.laws);
  for (const Dependency& d : a.dependencies)
    fmt::print(
        "  {} of the rows {} {} redundant: they hold one another's directions, so that how they share a load is "
        "not determined\n",
        d.too_many, text::join(d.rows), d.too_many == 1 ? "is" : "are");
  if (a.in_force && a.dependencies.empty() && a.left_out.empty())
    fmt::print("  not redundant: no row of it depends on others\n");
}

/// Things that can be explained.
std::vector<std::string> names_of(const System& system) {
  std::vector<std::string> names;
  for (const Body& b : system.bodies())
    if (!b.fixed) names.push_back(b.name);
  for (const auto& l : system.links()) names.push_back(l->name());
  for (const auto& f : system.forces()) names.push_back(f->name());
  return names;
}

template <class Account>
void tell(const Account& account, bool as_json) {
  if (as_json)
    print_result(json(account));
  else
    print(account);
}

}  // namespace

int explain_command(const Arguments& args) {
  Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  const System& system = m.system;
  const std::vector<std::string> known = names_of(system);
  if (!args["thing"].empty() && std::ranges::find(known, args["thing"]) == known.end())
    throw UsageError("nothing of the scene that moves, links or pushes is named \"" + args["thing"] + "\"" +
                     text::suggestion(args["thing"], known));
  const State state = run_to(m, loaded.registry, instant_of(args));
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  if (!args.has("--json")) fmt::print("{}, t = {:.9g} s\n", loaded.title(), state.t);

  for (const Body& body : system.bodies())
    if (body.name == args["thing"]) return tell(balance_of(dynamics, state, body), args.has("--json")), kExitOk;
  for (const auto& link : system.links())
    if (link->name() == args["thing"]) return tell(account_of(dynamics, state, *link), args.has("--json")), kExitOk;
  for (const auto& force : system.forces())
    if (force->name() == args["thing"]) return tell(account_of(dynamics, state, *force), args.has("--json")), kExitOk;
  Json all = Json::array();
  for (int k = 0; k < system.n_slots(); ++k) {
    const BodyBalance balance = balance_of(dynamics, state, system.body_of_slot(k));
    if (args.has("--json"))
      all.push_back(json(balance));
    else
      print(balance);
  }
  if (args.has("--json")) print_document(all);
  return kExitOk;
}

}  // namespace lockstep
