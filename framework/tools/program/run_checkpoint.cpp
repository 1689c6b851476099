// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_checkpoint.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include <lockstep/error.h>
#include "framework/tools/program/files.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/simulation/checkpoint.h"

namespace lockstep {

namespace fs = std::filesystem;

RunCheckpoint RunCheckpoint::read(const std::string& file) {
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

void RunCheckpoint::write(const std::string& file) const {
  Snapshot out;
  out.put_text("run"), out.put(static_cast<double>(words.size()));
  for (const std::string& word : words) out.put_text(word);
  out.put_text(folder), out.put_text(csv);
  out.put_bits(scene), out.put_bits(plugins);
  out.put(seconds);
  out.put_part(run);
  write_checkpoint(file, out);
}

void RunCheckpoint::check(const std::string& file, const Arguments& args, const Loaded& loaded) const {
  const auto changed = [&](const std::string& what) {
    throw FileError(fmt::format("checkpoint '{}': {} has changed; restore it, or run again", file, what));
  };
  if (hash_of_files(loaded.scene) != scene) changed("scene '" + args["scene"] + "', or a file that it reads,");
  if (hash_of_plugins(loaded.scene, args.all("--plugin")) != plugins)
    changed("a plugin of scene '" + args["scene"] + "'");
}

Checkpoints::Checkpoints(const Arguments& args, const Loaded& loaded, GrowingFile& rows)
    : file_(args["--checkpoint"]), rows_(rows) {
  if (file_.empty()) return;
  if (args["scene"] == "-")
    throw UsageError("--checkpoint: a scene from standard input cannot be read again to resume; give a file");
  if (rows.in_place())
    throw UsageError("--checkpoint: rows written to '" + rows.name() +
                     "' cannot be continued; record them to a file (--record)");
  if (!args["--every"].empty()) every_ = positive_number("--every", args["--every"], Unit::time);
  check_checkpoint(file_, rows.name(), loaded.scene);
  file_ = fs::absolute(file_).string();
  checkpoint_.words = args.words;
  checkpoint_.folder = fs::current_path().string(), checkpoint_.csv = fs::absolute(rows.name()).string();
  checkpoint_.scene = hash_of_files(loaded.scene),
  checkpoint_.plugins = hash_of_plugins(loaded.scene, args.all("--plugin"));
}

// The rows first: a checkpoint needs rows that are on the disk.
void Checkpoints::write_if_due(StepLoop& sim, bool now, double seconds) {
  if (file_.empty()) return;
  if (!now && std::chrono::duration<double>(Clock::now() - last_).count() < every_) return;
  rows_.sync();
  checkpoint_.run.clear();
  checkpoint_.seconds = seconds;
  sim.save(checkpoint_.run);
  checkpoint_.write(file_);
  last_ = Clock::now();
}

void Checkpoints::refuse_unsaved(const Integrator& method) const {
  if (!file_.empty() && !method.saves_all())
    throw UsageError(fmt::format(
        "--checkpoint: integrator '{}' keeps a history that cannot be saved; use another (--integrator), or leave out "
        "--checkpoint",
        method.info().name));
}

void Checkpoints::remove() {
  if (file_.empty()) return;
  std::error_code none;
  fs::remove(file_, none);
}

}  // namespace lockstep
