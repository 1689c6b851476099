// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/requirements.h"

#include <spdlog/fmt/fmt.h>

#include "framework/description/scene/builder.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {

std::unique_ptr<Recorder> make_requirements(Mechanism& m) {
  if (m.run.require.empty()) return nullptr;
  auto margins = std::make_unique<Recorder>(system_of(m));
  Refusals wrong;
  for (const ChannelRequest& r : m.run.require)
    wrong.attempt([&] {
      placed(r.where, "scene.require", [&] {
        Channel margin = channels::computed_channel(system_of(m), r.channel, true);
        margin.name = r.column();
        margins->add(std::move(margin));
      });
    });
  wrong.raise();
  margins->find_extremes();
  margins->on_row([](std::span<const double>) {});
  return margins;
}

std::vector<Finding> broken_requirements(const Mechanism& m, const Recorder* margins) {
  std::vector<Finding> broken;
  const std::span<const ColumnRange> ranges = margins != nullptr ? margins->ranges() : std::span<const ColumnRange>();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    if (ranges[k].least >= 0) continue;
    const ChannelRequest& r = m.run.require[k];
    const std::string unit = margins->table().columns()[k + 1].unit;
    const std::string worst = r.channel.find_first_of("<>") == std::string::npos
                                  ? ""
                                  : fmt::format(" by {:.4g}{}", -ranges[k].least, unit.empty() ? "" : " " + unit);
    Finding f{&finding::requirement_broken, "requirement '" + r.column() + "'",
              fmt::format("requirement \"{}\"{} does not hold{}{}", r.column(),
                          r.name.empty() ? "" : " (" + r.channel.substr(1) + ")", worst,
                          fmt::format(", worst at t = {:.6g} s", ranges[k].t_least)),
              "look at that time in `lockstep report`, and change the mechanism or the condition"};
    f.value = -ranges[k].least, f.limit = 0, f.unit = unit, f.t = ranges[k].t_least;
    broken.push_back(std::move(f));
  }
  return broken;
}

}  // namespace lockstep
