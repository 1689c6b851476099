// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/mechanism_at.h"

#include <algorithm>

#include <lockstep/simulation.h>
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

// The states of an auxiliary that both mechanisms have; others keep their start.
void take_states(const System& from, const State& given, const System& to, State& state) {
  for (const auto& mine : to.auxiliaries())
    for (const auto& other : from.auxiliaries())
      if (other->name() == mine->name() && other->size() == mine->size())
        state.s.segment(mine->first(), mine->size()) = given.s.segment(other->first(), other->size());
}

}  // namespace

MechanismAt mechanism_at(std::unique_ptr<Mechanism> mechanism, const Registry& registry, State state) {
  auto dynamics = std::make_unique<Dynamics>(
      system_of(*mechanism), make_solver(mechanism->run, registry),
      DynamicsOptions{.formulation = Formulation::omega, .stabilization = {.kind = Stabilization::Kind::none}});
  return {std::move(mechanism), std::move(dynamics), std::move(state)};
}

State start_or_present(Mechanism& m, Dynamics& dynamics, Simulation* run) {
  if (run != nullptr)
    for (ControlInput& input : system_of(m).control_inputs()) input.set(run->input(input.name()).value());
  State state = assembled_start(dynamics, m);
  dynamics.to_slots(state);
  if (run == nullptr) return state;
  State now = run->dynamics().in_slots(run->state());
  take_states(run->system(), now, m.system, state);
  now.s = state.s;
  if (now.q.size() != state.q.size() || now.z.size() != state.z.size())
    throw ModelError("the run was changed after its scene was read; analyse a scene that has these changes");
  return now;
}

std::vector<Channel> channels_of(Mechanism& m, const std::vector<std::string>& names) {
  std::vector<Channel> channels;
  for (const std::string& name : names) {
    const auto own = std::ranges::find(m.run.record, name, &ChannelRequest::column);
    channels.push_back(make_channel(system_of(m), own != m.run.record.end() ? own->channel : name));
    channels.back().name = name;
  }
  return channels;
}

}  // namespace lockstep
