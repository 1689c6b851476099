// SPDX-License-Identifier: BSD-3-Clause
// One run of a scene judged against a reference: what a cell of an atlas is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/scene.h>
#include "framework/tools/precision/history.h"

namespace lockstep {

/// What became of a run.
enum class AtlasOutcome { works, inaccurate, wrong_told, wrong_untold, stopped, too_slow, untried };

/// The motion that runs are compared to, at chosen instants.
struct AtlasReference {
  History history;
  double length = 0,   ///< of the system, m
      size = 0,        ///< the largest displacement, m
      agreement = 0;   ///< difference from a run a hundred times less tight, m
  std::string method;  ///< "dop853 at 1e-11"; "": there is none, for this reason:
  std::string reason;
};

struct AtlasCell {
  AtlasOutcome outcome = AtlasOutcome::untried;
  double error = 0,  ///< largest over the instants, m (turns times the system's length)
      energy = 0,    ///< imbalance relative to the energy exchanged
      drift = 0;     ///< largest violation, m
  long passed = 0;   ///< singular positions that it passed with plain stages: the motion after them may be another
  long steps = 0, rejected = 0;
  double cpu = 0;      ///< s
  std::string reason;  ///< why it stopped
};

/// Errors relative to the largest displacement: up to `works` a run works, beyond `wrong` it is wrong.
struct AtlasLimits {
  double works = 1e-2, wrong = 0.5;
};

/// The instants at which this run is compared: at ends of steps where steps are fixed, so that outputs shorten none.
LOCKSTEP_API std::vector<double> atlas_instants(const RunSettings&, bool adaptive);

/// The scene by a tight adaptive method without limit of its step, projected. `instants`: rising. `limit`: s of CPU time
/// for each attempt. What fails is told in `reason`.
LOCKSTEP_API AtlasReference atlas_reference(const Scene&, const Registry&, const std::vector<double>& instants,
                                            double limit, const std::function<bool()>& go_on);

/// The scene as it is, compared to the reference at these of its instants. It throws nothing.
LOCKSTEP_API AtlasCell atlas_run(const Scene&, const Registry&, const AtlasReference&,
                                 const std::vector<double>& instants, const AtlasLimits&, double limit,
                                 const std::function<bool()>& go_on);

/// "works", "inaccurate", "wrong, and says so", ...
LOCKSTEP_API const char* words_of(AtlasOutcome);

}  // namespace lockstep
