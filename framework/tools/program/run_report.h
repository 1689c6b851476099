// SPDX-License-Identifier: BSD-3-Clause
// The report of a run of a scene: its file and its texts.
#pragma once

#include <memory>
#include <string>

#include <lockstep/analysis.h>
#include <lockstep/report.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/report/histories.h"

namespace lockstep {

/// Lines as the program prints them, "  energy     change 1 J", as facts of a report: label and value. A continued line
/// has no label.
std::vector<std::pair<std::string, std::string>> facts_of(const std::string& lines);

/// The texts of a report that do not depend on the run: title, description, scene, command, columns.
ReportText text_of(const Arguments&, const Loaded&);

/// The text of a file; "" if there is none.
std::string contents_of(const std::string& file);

/// "out.partial.html" of "out.html", for a run that did not reach its end. A report to no regular file keeps its name.
std::string unfinished_report(const std::string& report);

/// Writes the report of many runs, by the text of their CSV, whose columns `x` and `y` are shown first. Throws
/// FileError. `histories`: of the runs, or null; of them run `shown` is shown first, next to the first one.
void write_runs_report(const std::string& file, const ReportText&, const std::string& csv, const std::string& x,
                       const std::string& y, bool log, const report::Histories* histories = nullptr,
                       std::size_t shown = 0);

/// Joints that are marked in a report, and why: some of their constraints are redundant, so reactions are not unique.
std::vector<std::pair<std::string, std::string>> marked_links(const UniquenessReport&);

/// The report of a run, if one is requested. Without one it costs nothing.
class RunReport {
 public:
  /// Make it before the run. Throws UsageError, FileError: the file cannot be written, or is needed.
  RunReport(const Arguments&, const Loaded&, const Mechanism&, const Recorder&, const std::string& csv);
  explicit operator bool() const { return report_ != nullptr; }
  void watch(StepLoop&);                     ///< adds the observer
  void mark(Dynamics&, const State& start);  ///< marks joints whose reactions are not unique, of up to 1000
  /// Writes and returns the file: `lines` are what the program prints of the run. `failure`: why it did not reach its end;
  /// an older report stays then, and the file is unfinished_report(). Throws FileError.
  std::string write(const StepLoop&, const std::string& lines, const std::string& failure = {}) const;
  std::string left_out() const { return report_->left_out(); }  ///< of the report that was written

 private:
  std::string file_;
  ReportText text_;
  std::unique_ptr<Report> report_;
};

}  // namespace lockstep
