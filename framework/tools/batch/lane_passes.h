// SPDX-License-Identifier: BSD-3-Clause
// The passes over all nodes of eight copies, compiled for three instruction sets. Private to the room.
#pragma once

#include <lockstep/batch.h>
#include "framework/tools/batch/closure_plan.h"

namespace lockstep::lanes {

struct Passes {
  /// out = y + h sum_i w_i k_i over n packs, h a pack; y null: from zero.
  void (*combine)(std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                  const double* w, double* out) = nullptr;

  void (*half_turns)(const LaneData&, double* half) = nullptr;  ///< y -> cosine, sine
  void (*outward)(const LaneData&) = nullptr;                   ///< y, laws -> moving, axes of the coordinates
  /// rate = d/dt of q and v under gravity and the wrenches; largest accelerations.
  void (*accelerate_tree)(const LaneData&, double* rate) = nullptr;
  /// moving -> now, end::size packs a node, and the squares of what changed from `before` in a step of h (a pack): 4 packs.
  void (*change)(const LaneData&, const double* before, const double* h, double* now, double* out) = nullptr;
  /// An error dy of q and v -> the squares of how it moves the slots: 4 packs.
  void (*vary)(const LaneData&, const double* dy, double* out) = nullptr;

  // The same with loops.
  /// As accelerate_tree, with the rows that close the loops: J, c, and their multipliers.
  void (*accelerate_closed)(const LaneData&, double* rate) = nullptr;
  /// The elimination alone, of the Jacobians as found last.
  void (*factor_closures)(const LaneData&) = nullptr;
  /// The change of the velocities, and of the slots', by which residuals r vanish, by the last elimination.
  void (*correct_closures)(const LaneData&, const double* r, double* dv) = nullptr;
  /// Adds that to the accelerations and multipliers.
  void (*add_correction)(const LaneData&, const double* dv, double* rate) = nullptr;
  void (*closure_errors)(const LaneData&) = nullptr;  ///< J, C, Cd
  void (*closure_rates)(const LaneData&) = nullptr;   ///< Cd = J v + Ct
  /// r = J a - c -> 2 packs, the largest relative to its scale, and that of rows that are not redundant; `raised`: scales
  /// are, by the slots' accelerations.
  void (*closure_residuals)(const LaneData&, bool raised, double* out) = nullptr;
};

/// Throws ModelError if the machine does not have these instructions.
Passes passes(Instructions);

// One set of passes per instruction set, each compiled in its own file.
namespace avx512 {
Passes all_passes();
}
namespace fma {
Passes all_passes();
}
namespace plain {
Passes all_passes();
}

}  // namespace lockstep::lanes
