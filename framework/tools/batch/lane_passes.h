// The passes over all bodies and nodes of eight copies, compiled for three instruction sets. Private to the room.
#pragma once

#include <lockstep/batch.h>
#include "framework/tools/batch/closure_plan.h"
#include "framework/tools/batch/lane_numbers.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes {

struct Passes {
  using Pass = void (*)(const Plan&, const Numbers&);
  Pass see_bodies = nullptr;        ///< y -> body: quaternions normalised, A, w in the world
  Pass free_motion = nullptr;       ///< a_f = M^-1 f, a = a_f
  Pass accelerate_rows = nullptr;   ///< J, Qhat, Y, S + E, x = J a_f - Qhat, scales
  Pass project_rows = nullptr;      ///< J, C, Ct
  Pass own_blocks = nullptr;        ///< J -> Y, the nodes' own blocks of S + E
  Pass factor_and_solve = nullptr;  ///< S + E -> L, D, and x <- (S + E)^-1 x
  Pass solve = nullptr;             ///< x <- (S + E)^-1 x
  Pass apply = nullptr;             ///< a -= Y^T x
  Pass residual = nullptr;          ///< r = J a - c
  /// J v + Ct; v: 6 per slot.
  void (*velocity_residual)(const Plan&, const Numbers&, const double* v, double* Cd) = nullptr;
  /// Largest scale of each RowKind; 3 packs.
  void (*largest_scales)(const Plan&, const Numbers&, double* out) = nullptr;
  /// For residual_floor(): the largest S_jj of each RowKind, and the energy; 4 packs.
  void (*energies)(const Plan&, const Numbers&, double* out) = nullptr;
  /// A pack, 0 where |r| <= tolerance max(scale, floor of its kind) in every row, else 1 (also for a NaN).
  void (*unmet)(const Plan&, const Numbers&, double tolerance, double* out) = nullptr;
  /// Of the pivots: how many are small, and the smallest of the others, relative to its diagonal; 2 packs. `left`: what
  /// proximal terms leave of each RowKind; 3 packs.
  void (*pivots)(const Plan&, const Numbers&, const double* left, double* out) = nullptr;
  /// The norm of Dynamics::norm for each copy: metres; L: a pack.
  void (*norm)(const Plan&, const double* c, const double* L, double* out) = nullptr;
  /// rate = d/dt of the state y: velocities, (1/2) q w by the raw quaternion, a.
  void (*rates)(const Plan&, const Numbers&, double* rate) = nullptr;
  /// out = y + h sum_i w_i k_i over n packs, h a pack; y null: from zero.
  void (*combine)(std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                  const double* w, double* out) = nullptr;

  // In joint coordinates.
  void (*half_turns)(const TreePlan&, const TreeStore&, double* half) = nullptr;  ///< y -> cosine, sine
  void (*outward)(const TreePlan&, const TreeStore&) = nullptr;  ///< y, laws -> moving, axes of the coordinates
  /// rate = d/dt of q and v under gravity and the wrenches; largest accelerations.
  void (*accelerate_tree)(const TreePlan&, const TreeStore&, double* rate) = nullptr;
  /// moving -> now, end::size packs a node, and the squares of what changed from `before` in a step of h (a pack): 4 packs.
  void (*change)(const TreePlan&, const TreeStore&, const double* before, const double* h, double* now,
                 double* out) = nullptr;
  /// An error dy of q and v -> the squares of how it moves the slots: 4 packs.
  void (*vary)(const TreePlan&, const TreeStore&, const double* dy, double* out) = nullptr;

  // The same with loops.
  /// As accelerate_tree, with the rows that close the loops: J, c, and their multipliers.
  void (*accelerate_closed)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&,
                            double* rate) = nullptr;
  /// The elimination alone, of the jacobians as found last.
  void (*factor_closures)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&) = nullptr;
  /// The change of the velocities, and of the slots', by which residuals r vanish, by the last elimination.
  void (*correct_closures)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&, const double* r,
                           double* dv) = nullptr;
  /// Adds that to the accelerations and multipliers.
  void (*add_correction)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&, const double* dv,
                         double* rate) = nullptr;
  void (*closure_errors)(const TreePlan&, const TreeStore&, const ClosurePlan&,
                         const ClosureStore&) = nullptr;  ///< J, C, Cd
  void (*closure_rates)(const TreePlan&, const TreeStore&, const ClosurePlan&,
                        const ClosureStore&) = nullptr;  ///< Cd = J v + Ct
  /// r = J a - c -> 2 packs, the largest relative to its scale, and that of rows that are not redundant; `raised`: scales
  /// are, by the slots' accelerations.
  void (*closure_residuals)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&, bool raised,
                            double* out) = nullptr;
  void (*closure_pivots)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&, const double* left,
                         double* out) = nullptr;  ///< as pivots
  void (*closure_norm)(const TreePlan&, const TreeStore&, const ClosurePlan&, const ClosureStore&, const double* x,
                       const double* L, double* out) = nullptr;  ///< as norm
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
