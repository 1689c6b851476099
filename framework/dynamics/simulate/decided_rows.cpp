#include "framework/dynamics/simulate/decided_rows.h"

#include <algorithm>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

bool switches(const Event& event, const std::string& name) {
  return std::ranges::find(event.activate, name) != event.activate.end() ||
         std::ranges::find(event.deactivate, name) != event.deactivate.end();
}

/// Loops of the links in force before or after an event.
class LoopsAt {
 public:
  LoopsAt(const System& system, const std::vector<bool>& modes, const Event& event) {
    std::vector<std::pair<int, int>> edges;
    for (std::size_t k = 0; k < system.links().size(); ++k) {
      const Lock& link = *system.links()[k];
      if (system.merged(link) || !(modes[k] || switches(event, link.name()))) continue;
      const std::vector<int> ends = ends_of(system, link);
      for (std::size_t i = 0; i < ends.size(); ++i)
        for (std::size_t j = i + 1; j < ends.size(); ++j) edges.emplace_back(ends[i], ends[j]), links_.push_back(&link);
    }
    groups_ = loop_groups(system.n_slots(), edges);
  }
  /// Whether a link that `counts` lies on a common loop with this one.
  template <class Counts>
  bool share(const Lock& link, Counts&& counts) const {
    for (std::size_t a = 0; a < links_.size(); ++a)
      for (std::size_t b = 0; links_[a] == &link && b < links_.size(); ++b)
        if (groups_[a] == groups_[b] && counts(*links_[b])) return true;
    return false;
  }

 private:
  std::vector<const Lock*> links_;   // of each edge
  std::vector<std::size_t> groups_;  // of each edge
};

}  // namespace

const Lock* switched_of_decided(const System& system, const std::vector<bool>& modes, const Event& event) {
  const bool held = system.held_down_to() > 0;
  const auto is_left_out = [&](const Lock& link) { return system.left_out(link) != 0; };
  if (!held && std::ranges::none_of(system.links(), [&](const auto& link) { return is_left_out(*link); }))
    return nullptr;
  const LoopsAt loops(system, modes, event);
  for (const auto& link : system.links())
    if (switches(event, link->name()) &&
        loops.share(*link, [&](const Lock& other) { return is_left_out(other) || (held && &other != link.get()); }))
      return link.get();
  return nullptr;
}

void refuse_switch_of_decided(const System& system, const std::vector<bool>& modes, const Event& event,
                              const std::string& who) {
  const Lock* const link = switched_of_decided(system, modes, event);
  if (link == nullptr) return;
  throw ModelError(who + " switches link '" + link->name() + "', on whose loop " +
                       (system.held_down_to() > 0 ? "rows hold that nearly depend on others" : "rows were left out") +
                       ": what was decided at the start is wrong then; leave it told "
                       "(\"nearly_redundant\", decide_nearly_redundant())",
                   {.thing = event.name.empty() ? thing_of(*link) : Thing{.kind = "event", .name = event.name}});
}

}  // namespace lockstep
