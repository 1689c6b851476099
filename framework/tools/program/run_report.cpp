// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_report.h"

#include <filesystem>
#include <fstream>

#include <lockstep/dynamics.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/files.h"
#include "framework/tools/report/page.h"

namespace lockstep {

std::string contents_of(const std::string& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return "";
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string unfinished_report(const std::string& report) {
  namespace fs = std::filesystem;
  std::error_code none;
  if (fs::exists(report, none) && !fs::is_regular_file(report, none)) return report;
  const fs::path file = report;
  return (file.parent_path() / file.stem()).string() + ".partial" + file.extension().string();
}

std::vector<std::pair<std::string, std::string>> facts_of(const std::string& lines) {
  std::vector<std::pair<std::string, std::string>> facts;
  for (const std::string& line : lines_of(lines)) {
    if (line.starts_with("   ")) {
      facts.emplace_back("", text::trimmed(line));
      continue;
    }
    const std::string fact(text::trimmed(line));
    const std::size_t end = fact.find("  ");
    facts.emplace_back(fact.substr(0, end), end == std::string::npos ? "" : text::trimmed(fact.substr(end)));
  }
  return facts;
}

ReportText text_of(const Arguments& args, const Loaded& loaded) {
  ReportText text;
  text.title = loaded.title();
  text.description = loaded.scene.description;
  const std::string written = contents_of(loaded.scene.file);  // empty if there is no file
  text.scene = written.empty() ? write_json(loaded.scene.root) : written;
  text.command = args.command;
  text.panels = loaded.scene.run.draw;
  for (const ChannelRequest& request : loaded.scene.run.record)
    if (!request.name.empty()) text.channels.emplace_back(request.name, request.channel);
  return text;
}

void write_runs_report(const std::string& file, const ReportText& text, const std::string& csv, const std::string& x,
                       const std::string& y, bool log, const report::Histories* histories, std::size_t shown) {
  const report::Points points{
      .text = text, .csv = csv, .x = x, .y = y, .log = log, .joined = log, .histories = histories, .shown = shown};
  report::write_whole(file, report::points_page(points));
}

std::vector<std::pair<std::string, std::string>> marked_links(const UniquenessReport& reactions) {
  std::vector<std::pair<std::string, std::string>> links;
  for (const std::string& row : reactions.rows) {  // "A.z", and of a stop "A.stop_rz_low.rz"
    const std::size_t dot = row.rfind('.');
    const std::string link = row.substr(0, dot), own = dot == std::string::npos ? "" : row.substr(dot + 1);
    if (links.empty() || links.back().first != link)
      links.emplace_back(link, "reaction not unique: constraint " + own);
    else
      links.back().second += ", " + own;
  }
  for (auto& [link, why] : links) why += "; constraints are redundant (lockstep check lists them)";
  return links;
}

RunReport::RunReport(const Arguments& args, const Loaded& loaded, const Mechanism& m, const Recorder& recorder,
                     const std::string& csv) {
  if (args["--report"].empty()) return;
  file_ = report_path(args["--report"], csv, loaded.scene);
  text_ = text_of(args, loaded);
  report_ = std::make_unique<Report>(recorder, m.solids, m.looks);
}

void RunReport::watch(StepLoop& sim) {
  if (report_) sim.add_observer(*report_);
}

void RunReport::mark(Dynamics& dynamics, const State& start) {
  constexpr std::size_t kMostLinks = 1000;  // for more, the search takes longer than many runs
  if (report_ && dynamics.system().links().size() <= kMostLinks)
    text_.marked = marked_links(uniqueness(dynamics, start));
}

std::string RunReport::write(const StepLoop& sim, const std::string& lines, const std::string& failure) const {
  const std::string file = failure.empty() ? file_ : unfinished_report(file_);
  ReportText text = text_;
  text.facts = facts_of(lines);
  text.findings = sim.report().findings, text.failure = failure;
  report_->write(file, text);
  return file;
}

}  // namespace lockstep
