// Histories and motion of many runs, for the page that shows each of them as a point.
#pragma once

#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/report.h>
#include <lockstep/scene.h>
#include "framework/tools/report/run_data.h"

namespace lockstep::report {

/// What a page keeps of many runs, within limits that hold for all of them together:
///
///     runs      2000, evenly chosen
///     columns   4 million numbers: of each run every k-th row, at least 30 rows
///     motion    4 million numbers: of each run every k-th instant, at least 30 of them
///
/// Runs may be added from several threads.
class LOCKSTEP_API Histories {
 public:
  /// For runs 1 to n_runs.
  explicit Histories(long n_runs);

  /// Whether this run is kept.
  bool keeps(long run) const { return (run - 1) % stride_ == 0; }
  /// An observer that takes the motion of a run.
  std::unique_ptr<Watcher> watcher() const;
  /// Adds a run: its columns, and its motion if it has begun.
  void add(long run, const Table&, const Watcher&, const Mechanism&);

  long n_kept() const;  ///< runs that were added
  /// "every 5th run, every 3rd row": what was left out; "" for nothing.
  std::string left_out() const;
  /// {"runs": [{"run":, "table":, "mechanism": number, "frames":, "marks":, "switches":}], "mechanisms": [...],
  /// "meshes": [...]}, with numbers as those of numbers(). Runs in the order of their numbers.
  nlohmann::ordered_json json() const;
  const Numbers& numbers() const { return numbers_; }

 private:
  std::size_t mechanism_number(const nlohmann::ordered_json&);

  long n_runs_, stride_;
  mutable std::mutex adding_;
  Numbers numbers_;
  Meshes meshes_{numbers_};
  std::vector<nlohmann::ordered_json> runs_;
  std::vector<std::string> mechanisms_;  // as JSON text, each once
  std::size_t most_rows_left_out_ = 1;
};

}  // namespace lockstep::report
