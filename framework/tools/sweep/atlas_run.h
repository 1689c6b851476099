// SPDX-License-Identifier: BSD-3-Clause
// One run of a scene compared with a reference solution: a cell of an atlas.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/scene.h>
#include "framework/tools/precision/history.h"

namespace lockstep {

/// The outcome of a run.
enum class AtlasOutcome {
  works,
  inaccurate,
  wrong_told,
  wrong_untold,
  stopped,
  too_slow,
  untried,
  no_reference,
  invalid
};

/// The reference solution, at chosen times.
struct AtlasReference {
  History history;
  double length = 0,   ///< of the system, m
      size = 0,        ///< the largest displacement, m
      agreement = 0;   ///< difference from a run with a tolerance a hundred times wider, m
  std::string method;  ///< "dop853 at 1e-11"; "": there is none, for this reason:
  std::string reason;
  bool invalid = false;  ///< the scene cannot be built or assembled
};

struct AtlasCell {
  AtlasOutcome outcome = AtlasOutcome::untried;
  double error = 0,  ///< largest over the times, m (rotations times the system's length)
      energy = 0,    ///< imbalance relative to the energy exchanged
      drift = 0;     ///< largest constraint violation, m
  long passed = 0;   ///< singular configurations passed with unprojected stages: the motion may have switched branch
  long steps = 0, rejected = 0;
  double cpu = 0;      ///< s
  std::string reason;  ///< why it failed, was WRONG, or has no reference
};

/// Errors relative to the largest displacement: up to `works` a run is accurate if its energy balance and constraints are
/// within their limits too, beyond `wrong` it is wrong.
struct AtlasLimits {
  double works = 1e-2, wrong = 0.5;
};

/// The times at which this run is compared: at ends of steps if steps are fixed, so that outputs shorten none.
LOCKSTEP_API std::vector<double> atlas_instants(const RunSettings&, bool adaptive);

/// The scene by an adaptive method with a tight tolerance and no limit of its step, projected. `instants`: rising. `limit`:
/// s of CPU time for each attempt. `reason` gives the cause of a failure.
LOCKSTEP_API AtlasReference atlas_reference(const Scene&, const Registry&, const std::vector<double>& instants,
                                            double limit, const std::function<bool()>& go_on);

/// The scene as it is, compared with the reference at these of its times. It throws nothing.
LOCKSTEP_API AtlasCell atlas_run(const Scene&, const Registry&, const AtlasReference&,
                                 const std::vector<double>& instants, const AtlasLimits&, double limit,
                                 const std::function<bool()>& go_on);

/// "accurate", "inaccurate", "wrong (flagged)", ...
LOCKSTEP_API const char* words_of(AtlasOutcome);

}  // namespace lockstep
