// SPDX-License-Identifier: BSD-3-Clause
// The command explain: the loads on a body, the constraints of a joint and the values of laws, at one time.
#include <algorithm>

#include <lockstep/explain.h>
#include <lockstep/text.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/commands/pose_columns.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

std::string components_text(const Json& v) { return v.size() == 1 ? number_text(v[0]) : vector_text(v); }

const Fields<LawAccount> kLawFields{
    {"what", "", "of", &LawAccount::what},
    {"unit", "", "unit", &LawAccount::unit},
    {"value", "", "value", &LawAccount::value, components_text},
    {"rate", "", "rate [per s]", &LawAccount::rate, components_text},
    {"second", "", "second derivative [per s^2]", &LawAccount::second, components_text}};

std::string contribution_text(const Json& c) {
  return vector_text(c["force"]) + " N, " + vector_text(c["moment"]) + " N m";
}

/// An account, its time and channels of the same thing.
template <class Account>
struct At {
  double t;
  Account account;
  std::vector<PoseNumber> quantities{};
  std::string contact{};  // of a one-sided joint
  double restitution = NAN;
};

const Fields<Contribution> kContributionFields{
    {"what", "", "of", &Contribution::what},
    {"force", "N", "force, world", &Contribution::force},
    {"moment", "N m", "moment about the centre of mass", &Contribution::moment}};
const Fields<BodyBalance> kBalanceFields{
    {"body", "", "body", &BodyBalance::body},
    {"mass", "kg", "mass", &BodyBalance::mass},
    {"center", "m", "centre of mass", &BodyBalance::center},
    {"acceleration", "m/s^2", "acceleration", &BodyBalance::acceleration},
    {"parts", "loads", &BodyBalance::parts, kContributionFields},
    {"sum", "sum of the loads", &BodyBalance::sum, kContributionFields, contribution_text},
    {"rate", "rate of momentum, and of angular momentum", &BodyBalance::rate, kContributionFields, contribution_text},
    {"left_force", "N", "residual force", &BodyBalance::left_force},
    {"left_moment", "N m", "residual moment", &BodyBalance::left_moment},
    {"incomplete", "", "incomplete", &BodyBalance::incomplete}};

// Of value and rate.
std::string units_of(const RowAccount& r) {
  return r.kind == RowKind::translation ? "m, m/s" : r.kind == RowKind::rotation ? "1, 1/s" : "";
}

std::string axes_text(const Json& axes) {
  std::string text;
  for (std::size_t k = 0; k < axes.size(); ++k)
    text += std::string(k == 0 ? "" : ", ") + "xyz"[k] + " = " + vector_text(axes[k]);
  return text;
}

// Empty without a drive.
std::vector<double> of_drives(const LinkAccount& a, const Vec3& load) {
  if (std::ranges::none_of(a.rows, &RowAccount::is_drive)) return {};
  return {load[0], load[1], load[2]};
}

std::string yes_or_no(const Json& v) { return v.get<bool>() ? "yes" : "no"; }  // no is shown, too
std::string violation_text(const Json& v) { return number_text(v, 1); }

const Fields<RowAccount> kRowAccountFields{
    {"row", "", "constraint", &RowAccount::name},
    {"kind", "", "", [](const RowAccount& r) { return word_of(r.kind); }},
    {"force", "N", "force", [](const RowAccount& r) { return r.on_p.force; }},
    {"moment", "N m", "moment", [](const RowAccount& r) { return r.on_p.moment; }},
    {"value", "", "violation", &RowAccount::value, violation_text},
    {"rate", "", "its rate", &RowAccount::rate, violation_text},
    {"multiplier", "", "", &RowAccount::multiplier},
    {"units", "", "units", units_of},
    {"drive", "", "driven", &RowAccount::is_drive}};
const Fields<LinkAccount> kLinkFields{
    {"link", "", "joint", &LinkAccount::name},
    {"type", "", "type", &LinkAccount::type},
    {"p", "", "P on", &LinkAccount::on_p},
    {"s", "", "S on", &LinkAccount::on_s},
    {"in_force", "", "active", &LinkAccount::in_force, yes_or_no},
    {"merged", "", "merged: its bodies move as one", &LinkAccount::merged},
    {"axes", "", "axes of S, world", &LinkAccount::axes, axes_text},
    {"rows", "constraints, with their loads on P's body about P in axes of S", &LinkAccount::rows, kRowAccountFields},
    {"left_out", "", "dropped as redundant", &LinkAccount::left_out},
    {"force_on_p", "N", "force on P's body without drives, world", [](const LinkAccount& a) { return a.joint.force; }},
    {"moment_on_p", "N m", "  moment about P", [](const LinkAccount& a) { return a.joint.moment; }},
    {"drive_force_on_p", "N", "force of the drives", [](const LinkAccount& a) { return of_drives(a, a.drives.force); }},
    {"drive_moment_on_p", "N m", "  moment about P",
     [](const LinkAccount& a) { return of_drives(a, a.drives.moment); }},
    {"incomplete", "", "incomplete", &LinkAccount::incomplete},
    {"laws", "laws", &LinkAccount::laws, kLawFields},
    {"dependencies", "dependent constraints; the model does not determine how they share the load",
     &LinkAccount::dependencies, kDependencyFields}};

const Fields<Contribution> kOnFields{{"body", "", "on", &Contribution::what},
                                     {"force", "N", "force, world", &Contribution::force},
                                     {"moment", "N m", "moment about its centre of mass", &Contribution::moment}};
const Fields<ForceEffect> kForceFields{{"force", "", "force", &ForceEffect::name},
                                       {"type", "", "type", &ForceEffect::type},
                                       {"acts", "", "active", &ForceEffect::acts, yes_or_no},
                                       {"on", "loads", &ForceEffect::on, kOnFields},
                                       {"laws", "laws", &ForceEffect::laws, kLawFields},
                                       {"potential", "J", "potential", &ForceEffect::potential},
                                       {"dissipation", "W", "dissipates", &ForceEffect::dissipation},
                                       {"supply", "W", "supplies", &ForceEffect::supply}};

template <class Account>
Fields<At<Account>> at_instant(const Fields<Account>& fields) {
  return Fields<At<Account>>{{"t", "s", "t", &At<Account>::t}}.with(&At<Account>::account, fields);
}
using Balances = At<std::vector<BodyBalance>>;

const Fields<At<BodyBalance>> kBodyAtFields = at_instant(kBalanceFields);
const Fields<At<LinkAccount>> kLinkAtFields =
    at_instant(kLinkFields)
        .with({{"restitution", "", "restitution", &At<LinkAccount>::restitution},
               {"contact", "", "state", &At<LinkAccount>::contact},
               {"quantities", "quantities", &At<LinkAccount>::quantities, kNumberFields}});
const Fields<At<ForceEffect>> kForceAtFields =
    at_instant(kForceFields).with({{"quantities", "quantities", &At<ForceEffect>::quantities, kNumberFields}});
const Fields<Balances> kBodiesAtFields{{"t", "s", "t", &Balances::t},
                                       {"bodies", "body", &Balances::account, kBalanceFields}};

/// What a force shows, and of a joint its free coordinates, the gaps of its stops, and its friction; of a stop also
/// those of its joint.
std::vector<std::string> channels_of(const System& system, const std::string& thing) {
  std::vector<std::string> all;
  const Lock* joint = nullptr;
  const std::string owner = thing.substr(0, thing.find(".stop_"));
  for (const auto& link : system.links()) {
    const std::string& name = link->name();
    if (name == thing) joint = link.get();
    if (const Jointed* jointed = name == owner ? link->jointed() : nullptr) {
      const Mask held = jointed->mask();
      for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz})
        if (!includes(held, row_of(axis)) && (!is_rotation(axis) || count_rows(held & Mask::e123) == 2))
          for (const char* rate : {"", "_d"}) all.push_back(name + "." + std::string(to_string(axis)) + rate);
    }
    if (link->unilateral() == nullptr || (name != thing && !name.starts_with(thing + ".stop_"))) continue;
    all.push_back(name + ".gap");
    if (name == thing) all.push_back(name + ".impact_loss");
  }
  for (const auto& force : system.forces()) {
    const Reacting* reacting = force->reacting();
    const bool rubs = reacting != nullptr && std::ranges::count(reacting->reads(), joint) > 0;
    if ((force->name() != thing && !rubs) || (reacting == nullptr && force->observable() == nullptr)) continue;
    for (const Quantity& q : reacting != nullptr ? reacting->quantities() : force->observable()->quantities())
      all.push_back(force->name() + "." + q.name);
  }
  return all;
}

/// Objects that can be explained.
std::vector<std::string> names_of(const System& system) {
  std::vector<std::string> names;
  for (const Body& b : system.bodies())
    if (!b.fixed) names.push_back(b.name);
  for (const auto& l : system.links()) names.push_back(l->name());
  for (const auto& f : system.forces()) names.push_back(f->name());
  return names;
}

Result explain(const Arguments& args) {
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  const System& system = m.system;
  const std::string& thing = args["thing"];
  const std::vector<std::string> known = names_of(system);
  if (!thing.empty() && std::ranges::find(known, thing) == known.end())
    throw UsageError("explain: no moving body, joint or force is called \"" + thing + "\"" +
                     text::suggestion(thing, known));
  std::vector<Channel> channels;  // before the run: angles count their revolutions in it
  for (const std::string& name : channels_of(system, thing)) channels.push_back(make_channel(system_of(m), name));
  const State state = run_to(m, loaded.registry, instant_of(args));
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  note_not_unique(uniqueness(dynamics, state));
  const StepReport none{};
  const Sample sample(dynamics, state, none);
  std::vector<PoseNumber> quantities;
  for (const Channel& c : channels) quantities.push_back({c.name, c.unit, c.value(sample)});
  const auto at = [&]<class Account>(Account account) { return At<Account>{state.t, std::move(account), quantities}; };
  for (const Body& body : system.bodies())
    if (body.name == thing) return {loaded, kBodyAtFields, at(balance_of(dynamics, state, body))};
  for (const auto& link : system.links()) {
    if (link->name() != thing) continue;
    At<LinkAccount> account = at(account_of(dynamics, state, *link));
    if (const Unilateral* side = link->unilateral())
      account.contact = state.modes[link->number()] ? "in contact" : "open", account.restitution = side->restitution;
    return {loaded, kLinkAtFields, account};
  }
  for (const auto& force : system.forces())
    if (force->name() == thing) return {loaded, kForceAtFields, at(account_of(dynamics, state, *force))};
  Balances all{state.t, {}};
  for (int k = 0; k < system.n_slots(); ++k) all.account.push_back(balance_of(dynamics, state, system.body_of_slot(k)));
  return {loaded, kBodiesAtFields, all};
}

}  // namespace

Command explain_command() {
  return {"explain",
          join({scene_options(),
                {{"thing", "THING", "a body, joint or force by its name; default: every body"}, kJson, kAt}}),
          explain,
          "Forces and moments are in world axes, those of single constraints in axes of S. A missing value (-) is a "
          "reaction that is unbounded near a singular configuration.\n\n"
          "Example:\n  lockstep explain samples/scenes/four_bar.json coupler --at 0.1",
          {&kBodyAtFields.schema(), &kLinkAtFields.schema(), &kForceAtFields.schema(), &kBodiesAtFields.schema()}};
}

}  // namespace lockstep
