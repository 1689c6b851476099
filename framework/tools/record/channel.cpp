// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/lines.h"
#include "framework/mechanism/params/units.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {
namespace channels {

void add(Entries& out, std::string name, std::string unit, std::string help, Value value) {
  if (!out.takes(name)) return;
  out.push_back({std::move(name), std::move(unit), std::move(help),
                 [value = std::move(value)](System&, Channel& c) { c.value = value; }});
}

void add_vector(Entries& out, const std::string& name, const std::string& unit, const std::string& help,
                std::function<Vec3(const Sample&)> value) {
  for (int k = 0; k < 3; ++k)
    if (std::string own = name + kAxisName[k]; out.takes(own))
      add(out, std::move(own), unit, fmt::format("{}, {}", help, kAxisName[k]),
          [value, k](const Sample& s) { return value(s)[k]; });
}

void add_angle(Entries& out, std::string name, std::string help, std::function<const CountedAngle&(System&)> count) {
  if (!out.takes(name)) return;
  const auto make = [count = std::move(count)](System& system, Channel& c) {
    const CountedAngle& angle = count(system);
    c.value = [&angle, channel = c.name, told = std::make_shared<bool>(false)](const Sample& s) {
      const Inputs& in = s.inputs();
      if (!*told && angle.doubt(in.s) > CountedAngle::kInDoubt) {
        *told = true;
        Finding f{
            &finding::turns_uncertain, "channel \"" + channel + "\"",
            fmt::format("channel \"{}\": by t = {} s the angle had changed by 90 deg more than its rate gives: it "
                        "is undefined nearby, or steps are too long; its revolutions are uncertain",
                        channel, text::brief(s.state.t)),
            "record an angle about another axis, or use smaller steps (--step)"};
        f.t = s.state.t;
        report_finding(f);
      }
      return angle.value(in);
    };
  };
  out.push_back({std::move(name), "rad", std::move(help), make});
}

void add_integral(Entries& out, std::string name, std::string unit, std::string help, std::string id,
                  std::function<double(const Evaluated&)> rate, Integrand of) {
  if (!out.takes(name)) return;
  const auto make = [id = std::move(id), rate = std::move(rate), of](System& system, Channel& c) {
    const Quadrature& q = quadrature(system, id, rate, of);
    c.value = [&q](const Sample& s) { return q.value(s.state); };
  };
  out.push_back({std::move(name), std::move(unit), std::move(help), make});
}

void add_coordinate(Entries& out, const NamedCoordinate& named, const Frame& m, const Frame& n) {
  const auto& [name, help, of] = named;
  if (!out.takes(name)) return;
  const Coordinate x(of, m, n);
  if ((of.kind == Coordinate::Kind::turn || of.kind == Coordinate::Kind::heading) && of.order == 0)
    return add_angle(out, name, help, [x = Coordinate(x)](System& system) mutable -> const CountedAngle& {
      x.count_angles(system);
      return *x.angle();
    });
  const auto value = [x, m, n](const Sample& s) { return x.value(m.at(s), n.at(s), s.inputs().s); };
  const auto derivative = [x, m, n](const Sample& s) {
    const MotionT<Time> M = m.moving(s), N = n.moving(s);
    return x.value(MarkerOn<Time>{M, {}}, MarkerOn<Time>{N, {}}, {}).d;
  };
  const Dimension d = x.dimension();
  add(out, name, d == Dimension{} ? "" : si_unit(d), help, of.order < 2 ? Value(value) : Value(derivative));
}

namespace {

// All objects that have channels: visit(kind, name, fill), where fill(Entries&) adds theirs.
template <class Visit>
void each_object(const System& system, Visit&& visit) {
  for (const Body& b : system.bodies()) visit("body", b.name, [&](Entries& out) { of_body(b, out); });
  for (const Marker& m : system.markers()) visit("marker", m.name, [&](Entries& out) { of_frame({{m.body, &m}}, out); });
  for (const auto& l : system.links())
    visit("joint", l->name(), [&](Entries& out) { of_link(system, *l, out), of_reactions(*l, out); });
  for (const auto& f : system.forces()) visit("force", f->name(), [&](Entries& out) { of_force(*f, out); });
  for (const ControlInput& i : system.control_inputs())
    visit("input", i.name(), [&](Entries& out) {
      add(out, "value", i.unit(), "value set by the host", [&i](const Sample&) { return i.value(); });
    });
}

const Entries& totals() {
  static const Entries kTotals = [] {
    Entries all;
    of_totals(all), of_run(all);
    return all;
  }();
  return kTotals;
}

/// An object that has channels: "body 'crank'".
struct Object {
  std::string label;
  Entries entries;
};

std::optional<Object> find_object(const System& system, std::string_view name, std::string_view only = {}) {
  std::optional<Object> found;
  each_object(system, [&](const char* kind, const std::string& own, const auto& fill) {
    if (own == name) fill(found.emplace(Object{fmt::format("{} '{}'", kind, own), {{}, only}}).entries);
  });
  return found;
}

// M seen from N, of "M.x@N".
std::optional<Object> find_pair(const System& system, const std::string& m, const std::string& n) {
  const std::optional<BodyOrMarker> M = frame_named(system, m), N = frame_named(system, n);
  if (!M || !N) return std::nullopt;
  Object pair{fmt::format("'{}' seen from '{}'", m, n), {}};
  of_pair(Frame{*M}, Frame{*N}, pair.entries);
  return pair;
}

std::vector<std::string> names_of(const Entries& entries) {
  std::vector<std::string> names;
  for (const Entry& e : entries) names.push_back(e.name);
  return names;
}

Channel made(System& system, const std::string& name, const Entry& entry) {
  Channel c{name, entry.unit, {}};
  entry.make(system, c);
  return c;
}

const Entry* find(const Entries& entries, std::string_view name) {
  const auto found = std::ranges::find(entries, name, &Entry::name);
  return found != entries.end() ? &*found : nullptr;
}

// Whether a name begins and ends with parts of the word, and has its other parts between them: "omega_world_z" for
// "omega_z".
bool says_more(std::string_view name, std::string_view word) {
  const std::vector<std::string> all = lines_of(name, '_'), some = lines_of(word, '_');
  if (some.size() < 2 || all.front() != some.front() || all.back() != some.back()) return false;
  std::size_t found = 0;
  for (const std::string& part : all) found += found < some.size() && part == some[found];
  return found == some.size();
}

constexpr std::size_t kMost = 4;  // names in a message

// What is meant by a quantity that is none of these: rz, the word for an axis of a drive or a start, is the channel
// angle_z, and a moment a torque.
std::vector<std::string> meant_by(const std::string& quantity, const std::vector<std::string>& names) {
  for (const auto& [word, ours] : {std::pair<std::string, std::string>{"reaction_", "force_on_p_world_"},
                                   {"drive_torque", "drive.torque_on_p_link_z"},
                                   {"drive.torque", "drive.torque_on_p_link_z"},
                                   {"drive.force", "drive.force_on_p_link_x"},
                                   {"reaction", "force_on_p_world_x"},
                                   {"force", "force_on_p_world_x"},
                                   {"angle_", "r"},
                                   {"angle", "angle_z"},
                                   {"torque", "drive.torque_on_p_link_z"},
                                   {"torque", "torque_on_p_link_z"},
                                   {"w", "omega_world_"},
                                   {"r", "angle_"},
                                   {"moment", "torque"}})
    if (quantity.starts_with(word))
      if (const std::string name = ours + quantity.substr(word.size()); std::ranges::find(names, name) != names.end())
        return {name};
  std::vector<std::string> meant;
  for (const std::string& name : names)
    if (says_more(name, quantity) || name.starts_with(quantity + "_")) meant.push_back(name);
  if (!meant.empty() && meant.size() <= kMost) return meant;
  const std::string near = text::closest_name(quantity, names);
  return near.empty() ? std::vector<std::string>{} : std::vector<std::string>{near};
}

[[noreturn]] void unknown_quantity(const std::string& channel, const std::string& owner, const std::string& quantity,
                                   const Entries& entries) {
  const std::vector<std::string> names = names_of(entries);
  const auto of_drive = [](const std::string& name) { return name.starts_with("drive"); };
  if (of_drive(quantity) && std::ranges::none_of(names, of_drive))
    throw ModelError(fmt::format("channel \"{}\": {} has no drive; add one, or remove the channel", channel, owner));
  std::vector<std::string> meant = meant_by(quantity, names);
  for (std::string& name : meant) name = "\"" + name + "\"";
  const bool whole = meant.size() == 1 && meant[0].starts_with("\"" + quantity + "_on_");
  std::string hint = (whole ? "it has components only; " : "") + ("did you mean " + text::join(meant, " or ") + "?");
  if (meant.empty())
    hint = "it has " + text::join(std::span(names).first(std::min(names.size(), kMost)), ", ") + ", ...";
  if (channel.find('@') == std::string::npos)
    hint += " All: lockstep check SCENE --channels --of " + channel.substr(0, channel.size() - quantity.size() - 1);
  throw ModelError(fmt::format("channel \"{}\": {} has no \"{}\"; {}", channel, owner, quantity, hint));
}

[[noreturn]] void unknown_object(const System& system, const std::string& channel, const std::string& object) {
  if (const std::optional<Object> whole = find_object(system, channel))
    throw ModelError(fmt::format("channel \"{0}\": this is {1}; add a quantity, such as \"{0}.{2}\"", channel,
                                 whole->label, whole->entries.front().name));
  if (frame_named(system, object))
    throw ModelError(fmt::format("channel \"{}\": add a quantity, such as \"{}.x{}\"", channel, object,
                                 channel.substr(std::min(channel.find('@'), channel.size()))));
  std::vector<std::string> names;
  each_object(system, [&](const char*, const std::string& name, const auto&) {
    if (name.find_first_of(".(") == std::string::npos) names.push_back(name);
  });
  const std::string near = text::closest_name(channel, names_of(totals()));
  std::string hint = !near.empty() ? "; did you mean \"" + near + "\"?" : text::suggestion(object, names);
  if (!hint.ends_with('?'))
    hint +=
        fmt::format(". A channel is an object and a quantity, such as \"{}.x\", or a total, such as \"energy.total\"",
                    names.size() > 1 ? names[1] : "body");
  throw ModelError(
      fmt::format("channel \"{}\": no body, marker, joint or force is called \"{}\"{}", channel, object, hint),
      {.value = object});
}

}  // namespace

std::pair<std::string, std::string> owner_of(const std::string& channel, const System& system) {
  std::pair<std::string, std::string> owner;
  each_object(system, [&](const char* kind, const std::string& name, const auto&) {
    if (name.size() > owner.second.size() && channel.starts_with(name + ".")) owner = {kind, name};
  });
  return owner;
}

}  // namespace channels

Channel make_channel(System& system, const std::string& name) {
  using namespace channels;
  if (!system.ready()) system.setup();
  if (name.starts_with('=')) return computed_channel(system, name);
  if (const Entry* e = find(totals(), name)) return made(system, name, *e);
  const std::size_t at = name.find('@');
  const bool is_pair = at != std::string::npos;
  const std::string own = name.substr(0, at), from = is_pair ? name.substr(at + 1) : "";
  if (is_pair && !frame_named(system, from)) unknown_object(system, name, from);
  // The object's name may hold points ("A.P"), so may the quantity's ("drive.work"): the longest object's name wins.
  for (std::size_t dot = own.rfind('.'); dot != std::string::npos && dot > 0; dot = own.rfind('.', dot - 1)) {
    const std::string word = own.substr(0, dot), quantity = own.substr(dot + 1);
    const std::optional<Object> object = is_pair ? find_pair(system, word, from) : find_object(system, word, quantity);
    if (!object) continue;
    if (const Entry* e = find(object->entries, quantity)) return made(system, name, *e);
    unknown_quantity(name, object->label, quantity, is_pair ? object->entries : find_object(system, word)->entries);
  }
  unknown_object(system, name, own.substr(0, is_pair ? own.rfind('.') : own.find('.')));
}

std::vector<ChannelHelp> channel_help(const System& system) {
  using namespace channels;
  std::vector<ChannelHelp> all;
  const auto take = [&](const std::string& object, const Entries& entries) {
    for (const Entry& e : entries) all.push_back({object.empty() ? e.name : object + "." + e.name, e.unit, e.help});
  };
  each_object(system, [&](const char*, const std::string& name, const auto& fill) {
    Entries entries;
    fill(entries);
    take(name, entries);
  });
  take("", totals());
  return all;
}

}  // namespace lockstep
