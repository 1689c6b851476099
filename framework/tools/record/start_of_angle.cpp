#include "framework/tools/record/start_of_angle.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/text.h>
#include "framework/dynamics/simulate/start_turns.h"
#include "framework/dynamics/solvers/graph.h"

namespace lockstep::channels {
namespace {

constexpr std::size_t kNamed = 6;  // angles, in one sentence

bool is_asked(const AssemblyOptions& options, const Lock& link, int axis) {
  return std::ranges::any_of(options.coordinates, [&](const CoordinateTarget& target) {
    return target.link == link.name() && is_rotation(target.axis) && axis_index(target.axis) % 3 == axis;
  });
}

}  // namespace

std::string uncounted(const System& system, const AssemblyOptions& options,
                      const std::vector<ChannelRequest>& recorded) {
  const State& start = system.start();
  if (!has_loops(system, start.modes)) return "";  // open chains carry their joints along
  if (!may_begin_beyond(system, start, options)) return "";
  std::vector<std::string> all;
  for (const ChannelRequest& request : recorded)
    for (const auto& link : system.links())
      for (int k = 0; k < 3; ++k)
        if (request.channel == link->name() + ".angle_" + "xyz"[k] && !is_asked(options, *link, k) &&
            !known_turn(system, start, *link, k))
          all.push_back(request.channel);
  const std::size_t n = all.size();
  if (n == 0) return "";
  if (n > kNamed) all.resize(kNamed), all.push_back(fmt::format("{} more", n - kNamed));
  return fmt::format(
      "the start may be beyond half a turn, and {} begin{} within half a turn of zero: nothing counts {} turns before "
      "the "
      "run; give the link a stop (\"stops\") or a torsion spring, which do",
      text::join(all), n == 1 ? "s" : "", n == 1 ? "its" : "their");
}

}  // namespace lockstep::channels
