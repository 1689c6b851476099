// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/doubts.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <nlohmann/ordered_map.hpp>
#include <span>
#include <string_view>

#include <lockstep/dynamics.h>
#include <lockstep/text.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/mechanism/expression/expression.h"

namespace lockstep {

namespace {

constexpr double kUncertain = 1e-2;  // of the largest multiplier

}  // namespace

void Doubts::start(const Sample& sample) {
  loops_ = has_loops(sample.system(), sample.state.modes);
  unmet_ = {}, n_uncertain_ = 0, begun_ = sample.state.t;
  uncertain_.clear();
}

void Doubts::save(Snapshot& out) const {
  out.put(static_cast<double>(unmet_.steps)), out.put(unmet_.largest), out.put(unmet_.first), out.put(unmet_.lost);
  out.put(begun_);
  out.put(static_cast<double>(n_uncertain_));
  out.put_all(uncertain_);
}

void Doubts::load(SnapshotReader& in) {
  unmet_.steps = in.get_count(), unmet_.largest = in.get(), unmet_.first = in.get(), unmet_.lost = in.get();
  begun_ = in.get();
  n_uncertain_ = in.get_count();
  in.get_all(uncertain_);
}

void Doubts::step(const Sample& sample) { unmet_.count(sample.report, sample.state.t); }

void Doubts::output(const Sample& sample) {
  if (!reactions_ || !loops_ || !(sample.values().uncertainty > kUncertain)) return;
  ++n_uncertain_;
  if (uncertain_.size() < kNamed) uncertain_.push_back(sample.state.t);
}

std::vector<Finding> Doubts::findings(long steps, double t) const {
  std::vector<Finding> all;
  const double seconds = t - begun_;
  if (unmet_.lost > seconds)
    all.push_back(
        {&finding::tolerance_not_reached, "",
         fmt::format("the tolerance of {:g} was not reached in {} of {} step{}, from t = {:.6g} s: errors are up to "
                     "{:.2g} times the tolerance, in sum {:.2g} times the limit of the whole run",
                     tolerance_, unmet_.steps, steps, steps == 1 ? "" : "s", unmet_.first, unmet_.largest,
                     unmet_.lost / seconds),
         "", unmet_.lost / seconds, 1, "", unmet_.first});
  if (const long n = n_uncertain_; n > 0) {
    all.push_back(
        {&finding::reactions_uncertain, "",
         fmt::format("the reactions at t = {}{} are uncertain by more than 1 %, or undefined, near a singular "
                     "configuration",
                     times_of(uncertain_, static_cast<std::size_t>(n)),
                     n > static_cast<long>(kNamed) ? fmt::format(" ({} times)", n) : ""),
         "use those before and after"});
    all.back().t = uncertain_.front();
  }
  return all;
}

std::string times_of(const std::vector<double>& first, std::size_t n) {
  std::string words;
  const std::size_t shown = std::min(Doubts::kNamed, first.size());
  for (std::size_t k = 0; k < shown; ++k) words += fmt::format("{}{:.6g}", k > 0 ? ", " : "", first[k]);
  return words + (n > shown ? ", ... s" : " s");
}

std::string first_of(const std::vector<std::string>& names, std::size_t most) {
  if (names.size() <= most) return text::join(names);
  return fmt::format("{} and {} more", fmt::join(std::span(names).first(most), ", "), names.size() - most);
}

std::string by_joint(const std::vector<std::string>& constraints) {
  nlohmann::ordered_map<std::string, std::string> joints;
  for (const std::string& name : constraints) {
    const std::size_t dot = std::min(name.rfind('.'), name.size());
    std::string& own = joints[name.substr(0, dot)];
    if (dot < name.size()) own += (own.empty() ? "" : " ") + name.substr(dot + 1);
  }
  nlohmann::ordered_map<std::string, std::vector<std::string>> groups;  // of the same constraints
  for (const auto& [joint, own] : joints) groups[own].push_back(joint);
  std::string words;
  for (const auto& [own, all] : groups)
    words += (words.empty() ? "" : "; ") + first_of(all) +
             (own.empty() ? "" : (all.size() > 1 ? " (each " : " (") + own + ")");
  return words;
}

bool are_of_reactions(const std::vector<ChannelRequest>& channels) {
  constexpr std::string_view kParts[] = {"_on_p_", "_on_s_", ".lambda_", "friction", ".normal_force", ".drive"};
  return std::ranges::any_of(channels, [&](const ChannelRequest& r) {
    return std::ranges::any_of(kParts,
                               [&](std::string_view part) { return r.channel.find(part) != std::string::npos; });
  });
}

std::vector<std::string> columns_not_unique(const std::vector<ChannelRequest>& channels,
                                            const UniquenessReport& reactions) {
  std::vector<std::string> names;
  for (const ChannelRequest& request : channels)
    if (!std::ranges::all_of(expression::channels_in(request.channel),
                             [&](const std::string& channel) { return reactions.unique(channel); }))
      names.push_back(request.column());
  return names;
}

}  // namespace lockstep
