#include <lockstep/report.h>

#include <nlohmann/json.hpp>
#include <optional>

#include <lockstep/error.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/numbers.h"
#include "framework/tools/report/outline.h"
#include "framework/tools/report/page.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;
using report::Frames;
using report::Numbers;

constexpr std::size_t kMostCells = 12'000'000;  // of the table: 64 MB of page

// Every k-th value, the last one too.
std::vector<double> thinned(const std::vector<double>& values, std::size_t k) {
  if (k == 1) return values;
  std::vector<double> some;
  for (std::size_t i = 0; i < values.size(); i += k) some.push_back(values[i]);
  if ((values.size() - 1) % k != 0) some.push_back(values.back());
  return some;
}

Json table_of(const Table& table, Numbers& numbers) {
  const std::size_t stride = 1 + table.n_rows() * table.n_columns() / kMostCells;
  Json json{{"rows", table.n_rows()}, {"stride", stride}, {"columns", Json::array()}};
  for (const Column& column : table.columns()) {
    const std::vector<double> values = thinned(column.values, stride);
    const bool is_time = &column == &table.columns().front();
    json["columns"].push_back(
        {{"name", column.name},
         {"unit", column.unit},
         {"values", is_time ? numbers.add(std::span<const double>(values)) : numbers.add_column(values)}});
  }
  return json;
}

Json frames_of(const Frames& frames, Numbers& numbers) {
  Json json{{"n", frames.times().size()},
            {"width", frames.width()},
            {"times", numbers.add(std::span<const double>(frames.times()))},
            {"rows", numbers.add(std::span<const float>(frames.rows()))},
            {"jumps", Json::array()}};
  for (std::size_t k = 0; k < frames.times().size(); ++k)
    if (frames.after_jump()[k]) json["jumps"].push_back(k);
  return json;
}

Json marks_of(const Frames& frames) {
  Json json = Json::array();
  for (const report::Mark& mark : frames.marks()) json.push_back({{"t", mark.t}, {"what", mark.what}});
  return json;
}

Json switches_of(const Frames& frames) {
  Json json{{"at_start", frames.modes_at_start()}, {"later", Json::array()}};
  for (const report::Switch& s : frames.switches())
    json["later"].push_back({{"t", s.t}, {"link", s.link}, {"active", s.active}});
  return json;
}

}  // namespace

struct Report::Seen {
  std::optional<Frames> frames;  // none before the start
};

Report::Report(const Recorder& recorder, std::vector<Solid> solids, std::vector<Look> looks)
    : recorder_(recorder), solids_(std::move(solids)), looks_(std::move(looks)), seen_(std::make_unique<Seen>()) {}
Report::~Report() = default;

void Report::start(const Sample& sample) { seen_->frames.emplace(sample.system()); }
void Report::step(const Sample& sample) { seen_->frames->step(sample); }
void Report::jumped(const Sample& sample) { seen_->frames->jumped(sample); }
void Report::output(const Sample& sample) { seen_->frames->output(sample); }

void Report::finish(const Sample& sample) {
  if (seen_->frames) seen_->frames->finish(sample);
}

std::string Report::page(const ReportText& text) const {
  if (!seen_->frames || seen_->frames->times().empty())
    throw ModelError(
        "report: there is nothing to show before the run; add it to the run (add_observer), then write it");
  const Frames& frames = *seen_->frames;
  Numbers numbers;
  const Json json{{"text", report::json_of(text)},
                  {"mechanism", report::outline_of(frames, solids_, looks_)},
                  {"frames", frames_of(frames, numbers)},
                  {"table", table_of(recorder_.table(), numbers)},
                  {"marks", marks_of(frames)},
                  {"switches", switches_of(frames)}};
  const std::string title = text.title.empty() ? "lockstep report" : text.title;
  return report::page_with(title, json.dump(-1, ' ', false, Json::error_handler_t::replace), numbers.base64());
}

void Report::write(const std::string& file, const ReportText& text) const { report::write_whole(file, page(text)); }

}  // namespace lockstep
