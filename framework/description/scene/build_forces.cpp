// SPDX-License-Identifier: BSD-3-Clause
// Forces and events of a scene.
#include <algorithm>

#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/split.h"
#include "framework/mechanism/system/coordinate_names.h"

namespace lockstep {

void Builder::force(const Value& object, const std::string& owner) {
  const Split parts =
      placed(object.where, [&] { return split(object, scene_table("force"), registry_.forces, owner, registry_); });
  const Params& p = parts.common;
  Attachment where = attachment(p, claim(p.value("name"), "force"), false);
  const bool built_in = registry_.forces.find(parts.type)->origin == "built in";
  const bool on_coordinate = built_in && parts.type == "function_force";
  if (p.has("link")) {
    const std::string link = p.text("link");
    if (!is_taken("link", link))
      p.refuse("link", "unknown joint \"" + link + "\"" + text::suggestion(link, names({"link"})));
    where.link = &system_.link(link);
    if (built_in && parts.type != "joint_friction" && !on_coordinate)
      p.refuse("link", "a " + parts.type + " does not act in a joint; name \"p\" and \"s\"");
    if (built_in && !on_coordinate && !where.pairs.empty())
      p.refuse("link", "a " + parts.type + " acts in its joint, and \"p\" and \"s\" are given as well; remove them");
    if (on_coordinate) {
      if (!where.pairs.empty())
        p.refuse("link", "\"p\" and \"s\" are given as well; name either a joint or two markers");
      const auto its = where.link->pairs();
      if (its.empty()) p.refuse("link", "joint '" + link + "' has no markers; name \"p\" and \"s\"");
      where.pairs.emplace_back(&system_.marker(its.front().first->name), &system_.marker(its.front().second->name));
    }
  }
  where.coordinate = [this](const std::string& name) { return coordinate_named(system_, name); };
  placed(object.where, [&] {
    Force& added = system_.add(registry_.forces.make_checked(parts.type, where, parts.own));
    if (!p.boolean("active")) added.set_switched(false);
  });
}

// The joints and forces that an event switches.
std::vector<std::string> Builder::switched_by(const Params& event, const std::string& key) {
  std::vector<std::string> things;
  for (const auto& [name, where] : texts_of(event, key)) {
    if (is_taken("force", name)) {
      Force& force = system_.force(name);
      force.set_switched(force.acts_at_start());
    } else if (!is_taken("link", name)) {
      refuse(where, part_of(event.owner(), key),
             "unknown joint or force \"" + name + "\"" + text::suggestion(name, names({"link", "force"})));
    }
    things.push_back(name);
  }
  return things;
}

void Builder::event(const Value& object, const std::string& owner) {
  const Params p = params_of(object, "event", owner, nullptr);
  EventRequest request;
  request.where = object.where;
  Event& e = request.event;
  e.name = claim(p.value("name"), "event");
  if (p.has("at") == p.has("when"))
    p.refuse(p.has("when") ? "when" : "", p.has("when") ? "\"at\" is given as well; remove one of the two"
                                                        : "it has no time and no condition; add \"at\" or \"when\"");
  if (p.has("at") && (e.at = p.number("at")) < 0)
    p.refuse("at", "the time " + text::number(e.at) + " s is before the start at 0 s; give a later time");
  if (p.has("when")) {
    const Params when = params_under(p, "when", "condition");
    const std::string sense = when.text("direction");
    request.where = when.value("channel").where;
    request.channel =
        placed(request.where, owner + ", when.channel", [&] { return without_columns(when.text("channel"), scene_); });
    request.crosses = when.number("crosses");
    if (const std::string* given = when.value("crosses").text())
      request.given = *given, request.given_where = when.value("crosses").where;
    e.crossing = sense == "rising"    ? Event::Crossing::rising
                 : sense == "falling" ? Event::Crossing::falling
                                      : Event::Crossing::any;
  }
  e.once = p.boolean("once");
  e.stop = p.boolean("stop");
  e.activate = switched_by(p, "activate");
  e.deactivate = switched_by(p, "deactivate");
  for (const std::string& name : e.activate)
    if (std::find(e.deactivate.begin(), e.deactivate.end(), name) != e.deactivate.end())
      p.refuse("deactivate",
               "'" + name + "' is activated and deactivated at the same time; remove it from one of the lists");
  if (e.activate.empty() && e.deactivate.empty() && !e.stop)
    p.refuse("", "the event does nothing; add \"activate\", \"deactivate\" or \"stop\": true");
  out_.events.push_back(std::move(request));
}

}  // namespace lockstep
