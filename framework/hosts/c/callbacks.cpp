// SPDX-License-Identifier: BSD-3-Clause
// The callbacks of a run, its events, and the states that it takes and gives.
#include <utility>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include "framework/dynamics/simulate/event_locator.h"
#include "framework/hosts/c/run.h"
#include "framework/hosts/c/state.h"
#include "framework/hosts/c/user_code.h"

namespace lockstep::c {
namespace {

constexpr Event::Crossing kCrossings[] = {Event::Crossing::falling, Event::Crossing::any, Event::Crossing::rising};

std::function<double(const Sample&)> channel_of(Run& run, Simulation& s, const char* name, double crosses) {
  const Channel channel = make_channel(s.system(), name);
  if (!run.begun) s.recorder().follow(channel);
  return ChannelCondition{channel.value, crosses, channel.of_motion ? channel.memory : nullptr};
}

}  // namespace
}  // namespace lockstep::c

using namespace lockstep;
using namespace lockstep::c;

extern "C" {

int lockstep_on_step(lockstep_run* run, lockstep_observer observer, void* user, lockstep_free_user free_user) {
  return with_user(user, free_user, [&](const User& owner) {
    return call_begun(run, [&](Run&, Simulation& s) {
      s.loop().progress = nullptr;
      if (observer == nullptr) return;
      s.loop().progress = [owner, observer, &dynamics = s.dynamics()](const State& state) {
        return goes_on(observer, owner.get(), static_cast<const lockstep_state*>(Lent(state, dynamics).handle()));
      };
    });
  });
}

int lockstep_on_row(lockstep_run* run, lockstep_row row, int keep, void* user, lockstep_free_user free_user) {
  return with_user(user, free_user, [&](const User& owner) {
    return call_run(run, [&](Run&, Simulation& s) {
      if (row == nullptr) return s.on_row(nullptr);
      s.on_row([owner,
                row](std::span<const double> of) { invoke(row, owner.get(), of.data(), static_cast<int>(of.size())); },
               flag(keep, "keep"));
    });
  });
}

int lockstep_add_event(lockstep_run* run, const char* name, const char* channel, lockstep_condition condition,
                       double value, int crossing, int once, lockstep_action action, void* user,
                       lockstep_free_user free_user) {
  return with_user(user, free_user, [&](const User& owner) {
    return call_run(run, [&](Run& r, Simulation& s) {
      if (channel != nullptr && condition != nullptr)
        refuse(LOCKSTEP_USAGE, "an event has a channel or a condition; give null for one of them");
      check_given(&value, 1, "value");
      Event event{.name = needed_text(name, "name"),
                  .crossing = kCrossings[within(crossing, -1, 1, "crossing") + 1],
                  .once = flag(once, "once"),
                  .stop = action == nullptr};
      if (channel != nullptr)
        event.value = channel_of(r, s, needed_text(channel, "channel"), value);
      else if (condition != nullptr)
        event.value = [=](const Sample& at) {
          double now = 0;
          invoke(condition, owner.get(), Lent(at.state, at.dynamics()).handle(), &now);
          return now - value;
        };
      else
        event.at = value;
      if (action != nullptr)
        event.change = [owner, action, &s](State& state) {
          invoke(action, owner.get(), Lent(state, s.dynamics(), StateObject::May::change).handle());
        };
      r.begin();
      s.add_event(std::move(event));
    });
  });
}

int lockstep_get_state(lockstep_run* run, lockstep_state** made) {
  if (made != nullptr) *made = nullptr;
  return call_begun(run, [&](Run&, Simulation& s) {
    lockstep_state*& state = needed(made, "made");
    const auto object = std::make_shared<StateObject>(s.dynamics().in_slots(s.state()), s.dynamics());
    object->also = object_of(run);
    state = static_cast<lockstep_state*>(new_handle(object));
  });
}

int lockstep_set_state(lockstep_run* run, lockstep_state* state) {
  return call_begun(run, [&](Run& r, Simulation& s) {
    State start;
    with_argument<StateObject>(&needed(state, "state"), "state", [&](StateObject& of) { start = of.in_slots(); });
    s.set_state(std::move(start)), r.started = s.state();
  });
}
}
