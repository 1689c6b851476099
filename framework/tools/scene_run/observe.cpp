// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/scene_run.h"

#include "framework/description/scene/builder.h"
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/simulate/event_locator.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {

namespace {

Channel channel_of(Mechanism& m, const EventRequest& request) {
  const std::string owner = owner_of("event", request.event.name);
  Channel channel =
      placed(request.where, owner + ", when.channel", [&] { return make_channel(system_of(m), request.channel); });
  if (const std::string problem = request.given.empty() ? "" : misfit(request.given, channel.unit); !problem.empty())
    refuse(request.given_where, owner + ", when.crosses", problem);
  return channel;
}

}  // namespace

std::unique_ptr<Recorder> make_recorder(Mechanism& m, const std::set<std::string>* only) {
  auto recorder = std::make_unique<Recorder>(system_of(m));
  Refusals wrong;
  for (const ChannelRequest& request : m.run.record)
    if (only == nullptr || only->contains(request.column()))
      wrong.attempt([&] {
        placed(request.where, "run.record",
               [&] { recorder->add(system_of(m), Request(request.column(), request.channel)); });
      });
  for (const EventRequest& request : m.events)
    if (!request.channel.empty()) wrong.attempt([&] { channel_of(m, request); });
  wrong.raise();
  return recorder;
}

Mechanism build_observed(const Scene& scene, const Registry& registry) {
  return build_mechanism(scene, registry, [](Mechanism& m, SceneErrors& wrong) {
    if (!wrong.attempt(Value(), [&] { system_of(m).setup(); })) return;
    const auto look_for = [&](const std::string& channel, const SourceLocation& where, const std::string& context) {
      if (channel.empty()) return;
      Value name(channel);
      name.where = where;
      wrong.attempt(Value::List{name}, [&] { placed(where, context, [&] { make_channel(system_of(m), channel); }); });
    };
    for (const ChannelRequest& r : m.run.record) look_for(r.channel, r.where, "run.record");
    for (const EventRequest& e : m.events)
      look_for(e.channel, e.where, owner_of("event", e.event.name) + ", when.channel");
  });
}

std::vector<Event> make_events(Mechanism& m, Recorder& recorder) {
  std::vector<Event> events;
  Refusals wrong;
  for (const EventRequest& request : m.events)
    wrong.attempt([&] {
      Event& event = events.emplace_back(request.event);
      if (request.channel.empty()) return;
      const Channel channel = channel_of(m, request);
      recorder.follow(channel);
      event.value = ChannelCondition{channel.value, request.crosses, channel.of_motion ? channel.memory : nullptr};
    });
  wrong.raise();
  return events;
}

}  // namespace lockstep
