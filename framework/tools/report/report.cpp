// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/report.h>

#include <nlohmann/json.hpp>

#include <lockstep/error.h>
#include "framework/tools/report/outline.h"
#include "framework/tools/report/page.h"
#include "framework/tools/report/run_data.h"

namespace lockstep {

struct Report::Seen {
  report::Frames frames{report::bytes_in(report::kMostBytes / 2)};
  std::string left_out{};
};

Report::Report(const Recorder& recorder, std::vector<Solid> solids, std::vector<Look> looks)
    : recorder_(recorder), solids_(std::move(solids)), looks_(std::move(looks)), seen_(std::make_unique<Seen>()) {}
Report::~Report() = default;

void Report::start(const Sample& sample) { seen_->frames.start(sample); }
void Report::step(const Sample& sample) { seen_->frames.step(sample); }
void Report::jumped(const Sample& sample) { seen_->frames.jumped(sample); }
void Report::output(const Sample& sample) { seen_->frames.output(sample); }
void Report::finish(const Sample& sample) { seen_->frames.finish(sample); }

std::string Report::page(const ReportText& text) const {
  if (!seen_->frames.any())
    throw ModelError(
        "report: the run has not begun; add the report to the run (add_observer), and write it after the run");
  const report::Frames& frames = seen_->frames;
  report::Numbers numbers;
  report::Meshes meshes(numbers);
  nlohmann::ordered_json json{{"text", report::json_of(text)},
                              {"mechanism", report::outline_of(frames, solids_, looks_, meshes)}};
  json["meshes"] = meshes.list();
  json.update(report::frames_json(frames, numbers));
  const auto with_table = [&](std::size_t bytes) {
    report::Numbers all = numbers;
    json["table"] = report::table_json(recorder_.table(), recorder_.ranges(), bytes, all);
    return report::page_with(json, all);
  };
  const std::size_t taken = with_table(0).size();  // with a few rows
  std::string page = with_table(taken < report::kMostBytes ? report::bytes_in(report::kMostBytes - taken) : 0);
  seen_->left_out = report::kept_part({{"row", json["table"]["stride"]}, {"frame", frames.stride()}});
  return page;
}

std::string Report::left_out() const { return seen_->left_out; }

void Report::write(const std::string& file, const ReportText& text) const { report::write_whole(file, page(text)); }

}  // namespace lockstep
