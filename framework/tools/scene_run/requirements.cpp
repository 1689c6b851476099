// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/requirements.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/description/scene/builder.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {

void Requirements::require(Channel margin) {
  margins_.push_back(margin), failed_.push_back(HUGE_VAL);
  add(std::move(margin));
}

void Requirements::start(const Sample& s) {
  std::ranges::fill(failed_, HUGE_VAL);
  Recorder::start(s), note(nullptr);
}
void Requirements::inside(const InsideStep& step) { Recorder::inside(step), note(&step); }
void Requirements::jumped(const Sample& s) { Recorder::jumped(s), note(nullptr); }
void Requirements::output(const Sample& s) { Recorder::output(s), note(nullptr); }

// A condition that fails is looked at by halves of the part of the step before.
void Requirements::note(const InsideStep* step) {
  for (std::size_t k = 0; k < ranges().size(); ++k) {
    if (std::isfinite(failed_[k]) || ranges()[k].least >= 0) continue;
    double to = failed_[k] = ranges()[k].t_least;
    if (step == nullptr || !step->has_states()) continue;
    double from = step->begin();
    for (double t = std::midpoint(from, to); from < t && t < to; t = std::midpoint(from, to))
      if (!succeeds([&] { (margins_[k].value(step->at(t)) >= 0 ? from : to) = t; })) break;
    failed_[k] = to;
  }
}

void Requirements::save(Snapshot& out) const { Recorder::save(out), out.put_all(failed_); }
void Requirements::load(SnapshotReader& in) { Recorder::load(in), in.get_all(failed_); }

std::unique_ptr<Requirements> make_requirements(Mechanism& m) {
  if (m.run.require.empty()) return nullptr;
  auto margins = std::make_unique<Requirements>(system_of(m));
  Refusals wrong;
  for (const ChannelRequest& r : m.run.require)
    wrong.attempt([&] {
      placed(r.where, "scene.require", [&] {
        Channel margin = channels::computed_channel(system_of(m), r.channel, true);
        margin.name = r.column();
        margins->require(std::move(margin));
      });
    });
  wrong.raise();
  margins->find_extremes();
  margins->on_row([](std::span<const double>) {});
  return margins;
}

std::vector<Finding> broken_requirements(const Mechanism& m, const Requirements* margins) {
  std::vector<Finding> broken;
  const std::span<const ColumnRange> ranges = margins != nullptr ? margins->ranges() : std::span<const ColumnRange>();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    if (ranges[k].least >= 0) continue;
    const ChannelRequest& r = m.run.require[k];
    const std::string unit = margins->table().columns()[k + 1].unit;
    const double first = margins->failed(k), worst = -ranges[k].least;
    const std::string words =
        std::isnan(worst) ? fmt::format("is no number at t = {:.6g} s", ranges[k].t_least)
        : r.channel.find_first_of("<>") == std::string::npos
            ? fmt::format("does not hold, first at t = {:.6g} s", first)
            : fmt::format("does not hold, first at t = {:.6g} s, and worst at t = {:.6g} s by {:.4g}{}", first,
                          ranges[k].t_least, worst, unit.empty() ? "" : " " + unit);
    Finding f{&finding::requirement_broken, "requirement '" + r.column() + "'",
              fmt::format("requirement \"{}\"{} {}", r.column(), r.name.empty() ? "" : " (" + r.channel.substr(1) + ")",
                          words),
              "look at that time in `lockstep report`, and change the mechanism or the condition"};
    f.value = worst, f.limit = 0, f.unit = unit, f.t = first;
    broken.push_back(std::move(f));
  }
  return broken;
}

}  // namespace lockstep
