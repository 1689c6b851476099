// SPDX-License-Identifier: BSD-3-Clause
// Reports: a run as one HTML file for a browser.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/finding.h>
#include <lockstep/recorder.h>
#include <lockstep/solid.h>

namespace lockstep {

/// The texts of a report, besides motion and columns. Every part may be left out.
struct ReportText {
  std::string title{},                                          ///< above the page, and of the browser's window
      description{},                                            ///< below the title
      scene{},                                                  ///< the scene as it was written
      command{};                                                ///< command that makes this report again
  std::vector<std::pair<std::string, std::string>> facts{};     ///< of the run: name and value
  std::vector<Finding> findings{};                              ///< of the run, as SimulationReport::findings
  std::string failure{};                                        ///< the error that ended the run; "" if there was none
  std::vector<std::vector<std::string>> panels{};               ///< columns drawn together; empty: one panel per unit
  std::vector<std::pair<std::string, std::string>> channels{};  ///< columns with other names: name, channel
  std::vector<std::pair<std::string, std::string>> marked{};    ///< joints that are marked: name, reason
};

/// Observes a run and writes a report: one HTML file that shows the mechanism in motion, together with the columns that
/// a recorder filled. A browser opens it without a server and without a network.
///
///     Simulation run(system, {.output = 0.01});
///     run.record({"rod.angle_z", "energy.total"});
///     Report report(run.recorder());
///     run.add_observer(report);
///     run.run_until(2.0);
///     report.write("pendulum.html", {.title = "A pendulum"});
///
/// Poses are kept at every output time, and between if bodies moved far in a step; reactions and forces with them, at
/// the cost of one solution each. The page has 20 MB at most, besides its meshes: of a long run it keeps fewer times, about
/// evenly spread, and of its columns fewer rows and the extremes between them. If the recorder finds extremes
/// (Recorder::find_extremes), the page lists those of the motion.
class LOCKSTEP_API Report final : public Observer {
 public:
  /// `recorder` must outlive this. `solids` and `looks`: as those of a Mechanism; a body without a solid is drawn from
  /// its joints and its centre of mass.
  explicit Report(const Recorder& recorder, std::vector<Solid> solids = {}, std::vector<Look> looks = {});
  ~Report() override;

  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;
  void finish(const Sample&) override;
  bool saves_all() const override { return false; }  ///< poses are not saved: runs with it have no checkpoints

  /// Writes the run so far; an existing file is replaced when the new one is complete. Throws ModelError before the run
  /// began, FileError if the file cannot be written.
  void write(const std::string& file, const ReportText& text = {}) const;
  /// The same page as text.
  std::string page(const ReportText& text = {}) const;
  /// What the last page has, if not all rows and times: "1 row in 32, 1 frame in 16".
  std::string left_out() const;

 private:
  struct Seen;
  const Recorder& recorder_;
  std::vector<Solid> solids_;
  std::vector<Look> looks_;
  std::unique_ptr<Seen> seen_;
};

}  // namespace lockstep
