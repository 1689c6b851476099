// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/decided_rows.h"

#include <algorithm>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

bool switches(const Event& event, const std::string& name) {
  return std::ranges::find(event.activate, name) != event.activate.end() ||
         std::ranges::find(event.deactivate, name) != event.deactivate.end();
}

const Lock* switched_of_decided(const System& system, const std::vector<bool>& modes, const Event& event) {
  const bool held = system.held_down_to() > 0;
  const auto is_left_out = [&](const auto& link) { return system.left_out(*link) != 0; };
  if (!held && std::ranges::none_of(system.links(), is_left_out)) return nullptr;
  std::vector<const Lock*> links;  // of each edge, in force before or after the event
  std::vector<std::pair<int, int>> edges;
  for (const auto& link : system.links()) {
    const bool counts = modes[link->number()] || switches(event, link->name());
    if (system.merged(*link) || !counts) continue;
    const std::vector<int> ends = ends_of(system, *link);
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = i + 1; j < ends.size(); ++j)
        edges.emplace_back(ends[i], ends[j]), links.push_back(link.get());
  }
  const std::vector<std::size_t> loops = loop_groups(system.n_slots(), edges);
  for (std::size_t a = 0; a < links.size(); ++a)
    for (std::size_t b = 0; b < links.size() && switches(event, links[a]->name()); ++b)
      if (loops[a] == loops[b] && (is_left_out(links[b]) || (held && links[a] != links[b]))) return links[a];
  return nullptr;
}

void refuse_switch_of_decided(const System& system, const std::vector<bool>& modes, const Event& event,
                              const std::string& who) {
  const Lock* const link = switched_of_decided(system, modes, event);
  if (link == nullptr) return;
  throw ModelError(who + " switches joint '" + link->name() + "' in a loop with constraints that were " +
                       (system.held_down_to() > 0 ? "kept as nearly redundant" : "left out as redundant") +
                       " at the start; set \"nearly_redundant\" to \"report\" (decide_nearly_redundant())",
                   {.thing = event.name.empty() ? thing_of(*link) : Thing{.kind = "event", .name = event.name}});
}

}  // namespace lockstep
