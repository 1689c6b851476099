// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/histories.h"

#include <algorithm>

#include "framework/tools/report/outline.h"
#include "framework/tools/report/page.h"
#include "framework/tools/report/run_data.h"

namespace lockstep::report {
namespace {

constexpr long kMostRuns = 2000;
constexpr std::size_t kMostOfAll = 16'000'000, kFewest = 30;

std::size_t share(long n_runs) { return kMostOfAll / static_cast<std::size_t>(std::clamp(n_runs, 1L, kMostRuns)); }

}  // namespace

Histories::Histories(long n_runs, std::size_t most_outlines)
    : n_runs_(n_runs), stride_((std::max(n_runs, 1L) + kMostRuns - 1) / kMostRuns), most_outlines_(most_outlines) {}

std::unique_ptr<Frames> Histories::watcher() const { return std::make_unique<Frames>(share(n_runs_), kFewest); }

// None: there is no room for it.
std::optional<std::size_t> Histories::mechanism_number(std::string outline) {
  const auto found = mechanisms_.find(outline);
  if (found != mechanisms_.end()) return found->second;
  if (outline_bytes_ + outline.size() > most_outlines_) return std::nullopt;
  outline_bytes_ += outline.size();
  return mechanisms_.emplace(std::move(outline), mechanisms_.size()).first->second;
}

void Histories::add(long run, const Table& table, const Frames& frames, const Mechanism& m) {
  std::string outline;
  if (frames.any()) {
    const nlohmann::ordered_json json = [&] {
      const std::scoped_lock lock(adding_);
      return outline_of(frames, m.solids, m.looks, meshes_);
    }();
    outline = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }
  const std::scoped_lock lock(adding_);
  nlohmann::ordered_json json{{"run", run}};
  const std::size_t least =
      4 * kFewest * sizeof(double) * (table.n_columns() + 1);  // half of the rows, or a quarter, is kept
  json["table"] = table_json(table, {}, std::max(share(n_runs_), least), numbers_);
  most_rows_left_out_ = std::max(most_rows_left_out_, json["table"]["stride"].get<std::size_t>());
  if (frames.any()) {
    if (const std::optional<std::size_t> number = mechanism_number(std::move(outline))) {
      json["mechanism"] = *number;
      json.update(frames_json(frames, numbers_));
      most_instants_left_out_ = std::max(most_instants_left_out_, frames.stride());
    } else {
      ++n_without_motion_;
    }
  }
  runs_.push_back(std::move(json));
}

std::string Histories::left_out() const {
  const std::scoped_lock lock(adding_);
  std::string words = kept_part({{"run", stride_}, {"row", most_rows_left_out_}, {"frame", most_instants_left_out_}});
  if (n_without_motion_ > 0)
    words += (words.empty() ? "no motion of " : ", no motion of ") + std::to_string(n_without_motion_) + " of them";
  return words;
}

nlohmann::ordered_json Histories::json() const {
  const std::scoped_lock lock(adding_);
  std::vector<nlohmann::ordered_json> runs = runs_;
  std::ranges::sort(runs, {}, [](const nlohmann::ordered_json& run) { return run["run"].get<long>(); });
  nlohmann::ordered_json json{{"runs", runs}, {"mechanisms", nlohmann::ordered_json::array()}};
  std::vector<const std::string*> outlines(mechanisms_.size());
  for (const auto& [text, number] : mechanisms_) outlines[number] = &text;
  for (const std::string* text : outlines) json["mechanisms"].push_back(nlohmann::ordered_json::parse(*text));
  json["meshes"] = meshes_.list();
  return json;
}

std::string points_page(const Points& points) {
  nlohmann::ordered_json json{
      {"kind", "points"}, {"text", json_of(points.text)}, {"csv", points.csv}, {"x", points.x},
      {"y", points.y},    {"color", points.color},        {"log", points.log}, {"joined", points.joined}};
  if (points.histories == nullptr) return page_with(json, Numbers());
  json["histories"] = points.histories->json();
  json["shown"] = points.shown;
  return page_with(json, points.histories->numbers());
}

}  // namespace lockstep::report
