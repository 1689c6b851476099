// SPDX-License-Identifier: BSD-3-Clause
// What is left to do of a sweep that was interrupted.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/sweep.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/simulation/checkpoint.h"

namespace lockstep {

/// NAME.sweep next to the rows of a sweep: the command and the files that they come from, as long as runs are missing.
class SweepMark {
 public:
  SweepMark(const Arguments& args, const Loaded& loaded, const GrowingFile& rows) : command_(command_of(args)) {
    if (args.has("--resume") && (rows.in_place() || args["scene"] == "-"))
      throw UsageError("--resume: scene and table must be readable again; give files for both");
    if (rows.in_place() || args["scene"] == "-") return;
    file_ = rows.name() + ".sweep";
    scene_ = hash_of_files(loaded.scene), plugins_ = hash_of_plugins(loaded.scene, args.all("--plugin"));
  }
  /// The sweep begins, or continues. Throws FileError.
  void write() const {
    if (file_.empty()) return;
    Snapshot out;
    out.put_text("sweep"), out.put_text(command_);
    out.put_bits(scene_), out.put_bits(plugins_);
    write_checkpoint(file_, out);
  }
  /// Throws FileError if there is no sweep, or one of another command or of other files.
  void check() const {
    std::error_code none;
    if (!std::filesystem::exists(file_, none))
      throw FileError(fmt::format(
          "there is no sweep to continue: '{}' is missing, as after a complete sweep; leave out --resume", file_));
    const Snapshot saved = read_checkpoint(file_);
    SnapshotReader in(saved);
    const auto refuse = [&](const std::string& why) {
      throw FileError(
          fmt::format("the sweep of '{}' cannot be continued: {}; leave out --resume to begin again", file_, why));
    };
    if (in.get_text() != "sweep") refuse("the file is not of a sweep");
    if (const std::string command = in.get_text(); command != command_)
      refuse(fmt::format("its command was `lockstep {}`", command));
    if (in.get_bits() != scene_) refuse("the scene, or a file that it reads, has changed");
    if (in.get_bits() != plugins_) refuse("a plugin has changed");
  }
  /// All runs are made.
  void remove() const {
    std::error_code none;
    if (!file_.empty()) std::filesystem::remove(file_, none);
  }

 private:
  // The words that decide what the rows are.
  static std::string command_of(const Arguments& args) {
    std::string line;
    for (std::size_t k = 0; k < args.words.size(); ++k) {
      const std::string& word = args.words[k];
      if (word == "--resume" || word == "--quiet" || word.starts_with("--jobs=")) continue;
      if (word == "--jobs")
        ++k;  // and its number
      else
        line += (line.empty() ? "" : " ") + in_quotes(word);
    }
    return line;
  }

  std::string file_;  // "": the rows cannot be read again
  std::string command_;
  std::uint64_t scene_ = 0, plugins_ = 0;
};

/// Rows that are there already; of them those of runs that failed and that were wrong (SweepRun::outcome).
struct KeptRows {
  long n = 0, failed = 0, wrong = 0;
};

/// Keeps the first rows of a file that grew: the header, and as many rows as begin with row_begin(0), row_begin(1), ...
/// The rest is cut off. Throws FileError if the header is another.
inline KeptRows keep_rows(GrowingFile& rows, const std::string& header,
                          const std::function<std::string(long)>& row_begin) {
  std::error_code none;
  const bool grew = std::filesystem::file_size(rows.partial(), none) > 0;  // else the rows have their name already
  const std::string text = contents_of(grew ? rows.partial() : rows.name());
  if (!text.starts_with(header))
    throw FileError(fmt::format("'{}' does not hold the rows of this sweep; leave out --resume to begin again",
                                grew ? rows.partial() : rows.name()));
  KeptRows kept;
  std::size_t end = header.size();
  std::vector<std::string> cells;
  for (std::size_t next; (next = text.find('\n', end)) != std::string::npos; end = next + 1, ++kept.n) {
    const std::string line = text.substr(end, next - end);
    if (!line.starts_with(row_begin(kept.n))) break;
    if (split_csv(line, ',', cells)) break;  // no row of a sweep
    const std::string& outcome = cells.back();
    if (outcome.starts_with("failed: ")) ++kept.failed;
    if (wrong_by(outcome)) ++kept.wrong;
  }
  rows.go_on(static_cast<long>(end), hash_of(std::string_view(text).substr(0, end)));
  return kept;
}

}  // namespace lockstep
