// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/requirements.h"

#include <spdlog/fmt/fmt.h>

#include <numeric>

#include "framework/description/scene/builder.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {

Requirements::Requirements(Mechanism& m) : Recorder(system_of(m)), system_(system_of(m)) {
  Refusals wrong;
  for (const ChannelRequest& r : m.run.require)
    wrong.attempt([&] {
      placed(r.where, "scene.require", [&] {
        margins_.push_back(channels::computed_channel(system_of(m), r.channel, true));
        margins_.back().name = r.column();
        add(margins_.back());
      });
    });
  wrong.raise();
  find_extremes();
  on_row([](std::span<const double>) {});
}

bool Requirements::held(std::size_t k) const {
  return ranges()[k].least >= (margins_[k].unit == "m" ? -kRoundOff * system_.length() : 0);
}

// Where a condition fails, by halves of the part of the step before that.
void Requirements::inside(const InsideStep& step) {
  Recorder::inside(step);
  for (std::size_t k = 0; k < ranges().size(); ++k) {
    if (std::isfinite(failed_[k]) || held(k)) continue;
    double from = step.begin(), to = failed_[k] = ranges()[k].t_least;
    for (double t = std::midpoint(from, to); step.has_states() && from < t && t < to; t = std::midpoint(from, to))
      if (!succeeds([&] { (margins_[k].value(step.at(t)) >= 0 ? from : to) = t; })) break;
    failed_[k] = to;
  }
}

std::unique_ptr<Requirements> make_requirements(Mechanism& m) {
  return m.run.require.empty() ? nullptr : std::make_unique<Requirements>(m);
}

std::vector<Finding> broken_requirements(const Mechanism& m, const Requirements* margins, bool at_rest) {
  std::vector<Finding> broken;
  const std::span<const ColumnRange> ranges = margins != nullptr ? margins->ranges() : std::span<const ColumnRange>();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    if (margins->held(k)) continue;
    const ChannelRequest& r = m.run.require[k];
    const std::string unit = margins->table().columns()[k + 1].unit;
    const double first = margins->failed(k), worst = -ranges[k].least;
    std::string words = std::isnan(worst) ? "is no number" : "does not hold";
    const expression::Expression e(r.channel, std::vector<std::string>{"t"}, expression::Naming::channels);
    const expression::Operation o = e.node(e.root()).operation;
    const bool compares =
        o >= expression::Operation::less && o <= expression::Operation::greater_equal && !std::isnan(worst);
    if (!at_rest) words += fmt::format(", first at t = {:.6g} s", first);
    if (!at_rest && compares)
      words += ranges[k].t_least > first ? fmt::format(", and worst at t = {:.6g} s", ranges[k].t_least) : ",";
    if (compares) words += fmt::format(" by {:.4g}{}", worst, unit.empty() ? "" : " " + unit);
    Finding f{&finding::requirement_broken, "requirement '" + r.column() + "'",
              fmt::format("requirement \"{}\"{} {}", r.column(), r.name.empty() ? "" : " (" + r.channel.substr(1) + ")",
                          words),
              std::string(at_rest ? "" : "look at that time in `lockstep report`, and ") +
                  "change the mechanism or the condition"};
    f.value = worst, f.limit = 0, f.unit = unit, f.t = first;
    broken.push_back(std::move(f));
  }
  return broken;
}

}  // namespace lockstep
