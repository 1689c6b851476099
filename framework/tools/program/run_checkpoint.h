// SPDX-License-Identifier: BSD-3-Clause
// The checkpoint of a run of a scene: what `lockstep run --checkpoint` writes and `lockstep resume` reads.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/simulation/checkpoint.h"

namespace lockstep {

/// A run with its command line and inputs.
struct RunCheckpoint {
  std::vector<std::string> words;        ///< of its command line
  std::string folder, csv;               ///< in which it was begun; its table
  std::uint64_t scene = 0, plugins = 0;  ///< hashes of their files
  double seconds = 0;                    ///< wall-clock time so far
  Snapshot run;                          ///< what the loop saved

  /// Throws FileError, and UsageError for the checkpoint of a simulation in C++.
  static RunCheckpoint read(const std::string& file) {
    const Snapshot saved = read_checkpoint(file);
    SnapshotReader in(saved);
    if (const std::string kind = in.get_text(); kind != "run")
      throw UsageError(fmt::format("checkpoint '{}' is of a simulation in C++; load it with Simulation::load", file));
    RunCheckpoint c;
    for (long n = in.get_count(); n > 0; --n) c.words.push_back(in.get_text());
    c.folder = in.get_text(), c.csv = in.get_text();
    c.scene = in.get_bits(), c.plugins = in.get_bits();
    c.seconds = in.get();
    c.run = in.get_part().rest();
    return c;
  }
  void write(const std::string& file) const {
    Snapshot out;
    out.put_text("run"), out.put(static_cast<double>(words.size()));
    for (const std::string& word : words) out.put_text(word);
    out.put_text(folder), out.put_text(csv);
    out.put_bits(scene), out.put_bits(plugins);
    out.put(seconds);
    out.put_part(run);
    write_checkpoint(file, out);
  }
  /// Throws FileError if the scene or a plugin has changed.
  void check(const std::string& file, const Arguments& args, const Loaded& loaded) const {
    const auto changed = [&](const std::string& what) {
      throw FileError(fmt::format("checkpoint '{}': {} has changed; restore it, or run again", file, what));
    };
    if (hash_of_files(loaded.scene) != scene) changed("scene '" + args["scene"] + "', or a file that it reads,");
    if (hash_of_plugins(loaded.scene, args.all("--plugin")) != plugins)
      changed("a plugin of scene '" + args["scene"] + "'");
  }
};

/// Writes the checkpoint of a run at intervals. Without --checkpoint it does nothing.
class Checkpoints {
 public:
  /// Throws UsageError: the file is a result or an input, the scene or the rows cannot be found again.
  Checkpoints(const Arguments& args, const Loaded& loaded, GrowingFile& rows)
      : file_(args["--checkpoint"]), rows_(rows) {
    if (file_.empty()) return;
    if (args["scene"] == "-")
      throw UsageError("--checkpoint: a scene from standard input cannot be read again to resume; give a file");
    if (rows.in_place())
      throw UsageError("--checkpoint: rows written to '" + rows.name() +
                       "' cannot be continued; record them to a file (--record)");
    if (!args["--every"].empty()) every_ = positive_number("--every", args["--every"], Unit::time);
    check_checkpoint(file_, rows.name(), loaded.scene);
    file_ = std::filesystem::absolute(file_).string();
    checkpoint_.words = args.words;
    checkpoint_.folder = std::filesystem::current_path().string(),
    checkpoint_.csv = std::filesystem::absolute(rows.name()).string();
    checkpoint_.scene = hash_of_files(loaded.scene),
    checkpoint_.plugins = hash_of_plugins(loaded.scene, args.all("--plugin"));
  }
  explicit operator bool() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  /// Before the run: throws UsageError for a method that does not save all of its history.
  void refuse_unsaved(const Integrator& method) const {
    if (!file_.empty() && !method.saves_all())
      throw UsageError(
          fmt::format("--checkpoint: integrator '{}' keeps a history that cannot be saved; use another (--integrator), "
                      "or leave out --checkpoint",
                      method.info().name));
  }
  /// Between two steps: writes it if it is due, or `now`, after the rows, which it needs on the disk. `seconds`:
  /// wall-clock time so far. Throws FileError, ModelError.
  void write_if_due(StepLoop& sim, bool now, double seconds) {
    if (file_.empty()) return;
    if (!now && std::chrono::duration<double>(Clock::now() - last_).count() < every_) return;
    rows_.sync();
    checkpoint_.run.clear();
    checkpoint_.seconds = seconds;
    sim.save(checkpoint_.run);
    checkpoint_.write(file_);
    last_ = Clock::now();
  }
  /// The run is done.
  void remove() {
    if (file_.empty()) return;
    std::error_code none;
    std::filesystem::remove(file_, none);
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string file_;
  double every_ = 60;  // s
  Clock::time_point last_ = Clock::now();
  RunCheckpoint checkpoint_;
  GrowingFile& rows_;
};

}  // namespace lockstep
