// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file What every linear solver must hold: the same questions to dense, sparse and those to come.

#include <lockstep/author/solver.h>
#include "tests/support/random_kkt.h"

namespace lockstep::test {

struct Solved {
  VecX a, lambda;
  SolveReport report;
  std::unique_ptr<Factorization> factor;
};

Solved solve_once(const LinearSolver& solver, const KktSystem& system);

/// Every shape against solve_exactly(), but for one that the solver is not made for.
void check_against_truth(const LinearSolver& solver, bool redundant, double tolerance_a, double tolerance_lambda,
                         int left_out = -1);

/// Left out twins must not change a: the redundant system and the one with the twin's rows cut off have one a.
void check_redundancy_does_not_reach_a(const LinearSolver& solver, double tolerance);

/// The reaction of a redundant link must not know the axes that its translation rows are written in.
void check_axes_do_not_matter(const LinearSolver& solver, double tolerance);

/// Two different laws on one coordinate stall at half their difference.
void check_contradiction(const LinearSolver& solver);

/// A row that becomes dependent on the way, with a right side that no longer fits, is a singular place and no
/// contradiction.
void check_singular_place(const LinearSolver& solver);

/// The detector leaves out what is redundant everywhere, and falls as the square of the way to a singular place.
void check_detector(const LinearSolver& solver);

/// A flat mechanism: whole units of rows have no scale of their own, and still the rule is met. Each row of a link
/// locks one direction; all falls along the free one, then all is driven along x from rest.
void check_rows_without_scale(const LinearSolver& solver);

}  // namespace lockstep::test
