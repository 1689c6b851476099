#include "framework/tools/report/histories.h"

#include <algorithm>

#include "framework/tools/report/outline.h"

namespace lockstep::report {
namespace {

constexpr long kMostRuns = 2000;
constexpr std::size_t kMostOfAll = 4'000'000, kFewest = 30;

std::size_t share(long n_runs) { return kMostOfAll / static_cast<std::size_t>(std::clamp(n_runs, 1L, kMostRuns)); }

}  // namespace

Histories::Histories(long n_runs) : n_runs_(n_runs), stride_((std::max(n_runs, 1L) + kMostRuns - 1) / kMostRuns) {}

std::unique_ptr<Watcher> Histories::watcher() const { return std::make_unique<Watcher>(share(n_runs_), kFewest); }

std::size_t Histories::mechanism_number(const nlohmann::ordered_json& outline) {
  std::string text = outline.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const auto found = std::ranges::find(mechanisms_, text);
  const auto number = static_cast<std::size_t>(found - mechanisms_.begin());
  if (found == mechanisms_.end()) mechanisms_.push_back(std::move(text));
  return number;
}

void Histories::add(long run, const Table& table, const Watcher& watcher, const Mechanism& m) {
  const std::scoped_lock lock(adding_);
  nlohmann::ordered_json json{{"run", run}};
  json["table"] = table_json(table, share(n_runs_), kFewest, numbers_);
  most_rows_left_out_ = std::max(most_rows_left_out_, json["table"]["stride"].get<std::size_t>());
  if (watcher.has_seen()) {
    json["mechanism"] = mechanism_number(outline_of(watcher.frames(), m.solids, m.looks, meshes_));
    json.update(frames_json(watcher.frames(), numbers_));
  }
  runs_.push_back(std::move(json));
}

long Histories::n_kept() const {
  const std::scoped_lock lock(adding_);
  return static_cast<long>(runs_.size());
}

std::string Histories::left_out() const {
  const std::scoped_lock lock(adding_);
  std::string words;
  if (stride_ > 1) words = "1 run in " + std::to_string(stride_);
  if (most_rows_left_out_ > 1)
    words += (words.empty() ? "" : ", ") + ("1 row in " + std::to_string(most_rows_left_out_));
  return words;
}

nlohmann::ordered_json Histories::json() const {
  const std::scoped_lock lock(adding_);
  std::vector<nlohmann::ordered_json> runs = runs_;
  std::ranges::sort(runs, {}, [](const nlohmann::ordered_json& run) { return run["run"].get<long>(); });
  nlohmann::ordered_json json{{"runs", runs}, {"mechanisms", nlohmann::ordered_json::array()}};
  for (const std::string& text : mechanisms_) json["mechanisms"].push_back(nlohmann::ordered_json::parse(text));
  json["meshes"] = meshes_.list();
  return json;
}

}  // namespace lockstep::report
