// SPDX-License-Identifier: BSD-3-Clause
// The page of many runs, each of which is a point of a plot, and the histories and motion of these runs.
#pragma once

#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <lockstep/report.h>
#include <lockstep/scene.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/meshes.h"

namespace lockstep::report {

/// The data of many runs for a page, within limits for all of them together:
///
///     runs      2000, evenly chosen
///     columns   16 million bytes: of each run every k-th row, at least 30 rows, and the extremes between them
///     motion    16 million bytes: of each run every k-th time, at least 30 of them
///     outlines  16 million bytes: the appearance of a mechanism, once for equal ones; a run with an outline beyond that
///               has its columns alone
///
/// Runs may be added from several threads.
class LOCKSTEP_API Histories {
 public:
  /// For runs 1 to n_runs; `most_outlines`: bytes of all outlines together.
  explicit Histories(long n_runs, std::size_t most_outlines = 16'000'000);

  /// Whether this run is kept.
  bool keeps(long run) const { return (run - 1) % stride_ == 0; }
  /// An observer that takes the motion of a run.
  std::unique_ptr<Frames> watcher() const;
  /// Adds a run: its columns, and its motion if it has begun.
  void add(long run, const Table&, const Frames&, const Mechanism&);

  /// The kept part of the runs: "1 run in 5, 1 row in 3, 1 frame in 4, no motion of 7 of them"; "" if it is all. Rows and
  /// frames are those of the run that has most of them left out.
  std::string left_out() const;
  /// {"runs": [{"run":, "table":, "mechanism": number, "frames":, "marks":, "switches":}], "mechanisms": [...],
  /// "meshes": [...]}, with numbers as those of numbers(). Runs in the order of their numbers.
  nlohmann::ordered_json json() const;
  const Numbers& numbers() const { return numbers_; }

 private:
  std::optional<std::size_t> mechanism_number(std::string outline);

  long n_runs_, stride_;
  std::size_t most_outlines_;  // bytes
  mutable std::mutex adding_;
  Numbers numbers_;
  Meshes meshes_{numbers_};
  std::vector<nlohmann::ordered_json> runs_;
  std::unordered_map<std::string, std::size_t> mechanisms_;  // numbers, by their outlines as JSON text
  std::size_t outline_bytes_ = 0;
  long n_without_motion_ = 0;  // beyond the limit of outlines
  std::size_t most_rows_left_out_ = 1, most_instants_left_out_ = 1;
};

/// Many runs, and how they are shown at first; the reader may choose otherwise.
struct Points {
  ReportText text{};
  std::string csv,     ///< their table, one row per run; "failure" and "status" give the reason of a failure
      x, y,            ///< titles of the columns on the axes; what is no column of numbers: the first ones
      color{};         ///< title of the column that gives the colour; "": the texts that distinguish the runs
  bool log = false,    ///< logarithmic axes
      joined = false;  ///< lines between the points of a group
  const Histories* histories = nullptr;  ///< of the runs, by the column "run"; null: none are shown
  std::size_t shown =
      0;  ///< the run that is shown at first, next to the first one of the histories; 0: all are, as points
};

/// The page as text.
LOCKSTEP_API std::string points_page(const Points&);

}  // namespace lockstep::report
