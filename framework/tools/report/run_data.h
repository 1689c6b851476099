// SPDX-License-Identifier: BSD-3-Clause
// The data of the page of a run, except for its texts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/solid.h>
#include <lockstep/step_loop.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/meshes.h"
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// Takes the frames of a run.
class LOCKSTEP_API Watcher final : public Observer {
 public:
  /// As Frames.
  explicit Watcher(std::size_t most_numbers = 16'000'000, std::size_t fewest = 100)
      : most_numbers_(most_numbers), fewest_(fewest) {}

  ~Watcher() override;
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;
  void finish(const Sample&) override;
  bool saves_all() const override { return false; }
  /// Whether there is a frame; and these.
  bool has_seen() const { return frames_ && !frames_->times().empty(); }
  const Frames& frames() const { return *frames_; }

 private:
  std::size_t most_numbers_, fewest_;
  std::optional<Frames> frames_;  // none before the start
};

/// {"rows":, "stride":, "columns": [...]}: of a table of more than `most_cells` numbers every k-th row, but at least
/// `fewest` of them.
nlohmann::ordered_json table_json(const Table&, std::size_t most_cells, std::size_t fewest, Numbers&);
/// {"frames": {"n":, "stride":, "width":, "times":, "rows":, "jumps":}, "marks":, "switches":}; of the times every
/// "stride"th is kept.
nlohmann::ordered_json frames_json(const Frames&, Numbers&);

}  // namespace lockstep::report
