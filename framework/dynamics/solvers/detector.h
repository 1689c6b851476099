// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <lockstep/author/solver.h>

namespace lockstep {

/// Factors like solver schur, and completes a report by the detector alone: the least eigenvalue of J M^-1 J^T relative to
/// its diagonal but those of Kkt::redundant rows, at least one. Of a matrix with loops.
std::unique_ptr<Factorization> make_detector(const KktPattern&);

}  // namespace lockstep
